"""A run's JSON as text, Markdown and files."""

from __future__ import annotations

import json

from tactcad.paper.report import standalone

from . import bench_tables
from .figures import figures


def to_json(result: dict) -> str:
    return json.dumps(result, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def made_on(result: dict) -> str:
    """Machine, versions, date in a sentence; a further one for every run that some of the benchmarks are
    from."""
    m, v = result["machine"], result["versions"]
    peers = ", ".join(f"{name} {version}" for name, version in result["peers"].items())
    said = (
        f"{result['mode'].capitalize()} run of {result['date']}, seed {result['seed']}, "
        f"{result['seconds'] / 60:.0f} minutes on {m['processor']}, {m['cores']} cores, {m['memory_GB']:g} "
        f"GB, {m['system']}, load {m['load']:g} when it began; Python {v['python']}, tactcad {v['tactcad']}, "
        f"numpy {v['numpy']}, scipy {v['scipy']}, scikit-fem {v['scikit-fem']}, OCP {v['cadquery-ocp']}, "
        f"build123d {v['build123d']}; {peers}."
    )
    for more in result.get("further", ()):
        said += (
            f" From a {more['mode']} run of {more['date']} on it, seed {more['seed']}, "
            f"{more['seconds'] / 60:.0f} minutes, load {more['load']:g}: {', '.join(more['benchmarks'])}."
        )
    return said


def to_text(result: dict) -> str:
    lines = ["tactcad bench", made_on(result)]
    for name, entry in result["benchmarks"].items():
        lines += ["", f"{name}: {entry['question']}"]
        for data in entry["tables"].values():
            lines += ["", bench_tables.text(data)]
        lines += ["", *(f"  - {line}" for line in remarks(entry))]
    return "\n".join(lines)


def to_markdown(result: dict, plots: str = "plots") -> str:
    """`plots` is the folder of the pictures, as seen from the file."""
    lines = ["# Speed against accuracy, measured", "", made_on(result)]
    shown = figures(result)
    for name, entry in result["benchmarks"].items():
        lines += [
            "",
            f"## {entry['title']}",
            "",
            entry["question"],
            "",
            *(f"- {line}" for line in remarks(entry)),
        ]
        lines += [f"\n![{f.caption}]({plots}/{f.name}.svg)" for f in shown.get(name, ())]
        for data in entry["tables"].values():
            lines += [
                "",
                f"### {data['title']}",
                "",
                bench_tables.markdown(data),
                *(["", data["note"]] if data["note"] else []),
            ]
    return "\n".join(lines) + "\n"


def remarks(entry: dict) -> list[str]:
    """What was found, what could not be measured, what failed."""
    return [
        *entry["findings"],
        *entry["missing"],
        *([f"FAILED: {entry['failed']}"] if "failed" in entry else []),
    ]


def files(result: dict) -> dict[str, bytes]:
    """Every file of a report's folder, by name."""
    made = {
        "report.json": to_json(result),
        "report.md": to_markdown(result),
        "report.txt": to_text(result) + "\n",
    }
    for entry in result["benchmarks"].values():
        made |= {f"tables/{key}.csv": bench_tables.as_csv(data) for key, data in entry["tables"].items()}
    for shown in figures(result).values():
        made |= {f"plots/{f.name}.svg": standalone(f) for f in shown}
    return {name: text.encode() for name, text in made.items()}
