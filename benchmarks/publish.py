"""A run's report becomes the published one.

    python benchmarks/publish.py REPORT [FURTHER]...    in the checkout

What further runs on the same machine measured (of --only some benchmarks) takes the place of the report's
own, and is named.

Writes benchmarks/results/reference.json and .md, docs/images/bench-*.svg, the converged results that short
runs compare with, and the tables between `<!-- table bench NAME -->` and `<!-- end -->` in docs/.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path

from bench import SCHEMA, images, made_on, remarks, to_json, to_markdown
from bench_elements import TRUTH
from bench_plots import figures
from measuring import BENCHMARKS
from tables import filled, lines, markdown

from tactcad.design.messages import InputError
from tactcad.mechanics.register import rungs
from tactcad.report.figures import sig

REFERENCE = "benchmarks/results/reference.json"
DOCUMENT = "docs/benchmarks.md"

# --- one table to choose from: rung, tessellation, detail level ---

TESSELLATION = {
    0.5: "a first look",
    0.35: "pictures of long arrays",
    0.2: "the mesh check",
    0.1: "printing",
    0.05: "volumes from meshes",
}
DETAIL = {"full": "review, manufacture", "envelope": "layout and collision: no holes, pockets, threads"}
UNITS = ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns"))


def duration(seconds: float) -> str:
    """Two digits in the unit that suits."""
    scale, unit = next((pair for pair in UNITS if seconds >= pair[0]), UNITS[-1])
    return f"{sig(seconds / scale, 2)} {unit}"


def choice(result: dict) -> str:
    """The choices, their worst errors, costs, and uses."""

    def rows(name: str) -> list[dict]:
        return result["benchmarks"][name]["tables"][name]["rows"]

    shown: list[tuple[str, ...]] = []
    for r in rows("rungs"):
        error, when = f"{sig(100 * r['solid worst'], 2)} %", rungs()[r["rung"]].when
        shown.append(("rung, per element", f"`{r['rung']}`", error, duration(r["seconds"]) + " |", when))
    for r in rows("tessellation"):
        when = TESSELLATION.get(r["angular"])
        if when and r["linear"] == rows("tessellation")[0]["linear"]:
            error, size = f"{sig(100 * r['worst'], 2)} % of volume", f"{sig(r['stl_bytes'] / 1e3, 2)} kB"
            what = ("triangles, array's parts", f"{r['angular']:g} rad")
            shown.append((*what, error, duration(r["seconds"]), size, when))
    for r in rows("detail"):
        if r["scene"] in ("array", "grasping"):
            size = f"{sig(r['bytes'] / 1e3, 2)} kB"
            what = (f"scene {r['scene']}", f"{r['detail']} |", duration(r["seconds"]))
            shown.append((*what, size, DETAIL[r["detail"]]))
    return lines("choose | setting | worst error | time | file | when", shown)


# --- reports ---


def load(*paths: Path) -> dict:
    """The JSON of a report, with that of further ones in its place. Raises InputError if one is no report,
    they do not belong together, or a benchmark is lacking or failed."""
    result, *further = map(_read, paths)
    for more in further:
        result = replaced(result, more)
    lacking = [n for n in BENCHMARKS if "tables" not in result["benchmarks"].get(n, {})]
    wrong = lacking + [n for n, entry in result["benchmarks"].items() if "failed" in entry]
    if wrong:
        raise InputError(str(paths[0]), "not a whole report", value=", ".join(wrong), legal="every benchmark")
    return result


def _read(path: Path) -> dict:
    result = json.loads(path.read_text("utf-8"))
    if result.get("schema") != SCHEMA:
        raise InputError(str(path), "not a report", value=str(result.get("schema")), legal=f"schema {SCHEMA}")
    return result


def replaced(result: dict, more: dict) -> dict:
    """The report with what `more` measured in the place of its own, under "further" from which run.

    Raises InputError if they are not from one machine with the same versions.
    """
    for key in ("machine", "versions", "peers"):
        ours, theirs = ({k: v for k, v in r[key].items() if k != "load"} for r in (result, more))
        if ours != theirs:
            raise InputError(
                "report",
                f"the further run is from another place: its {key} differ",
                value=theirs,
                legal=str(ours),
            )
    run = {key: more[key] for key in ("mode", "date", "seed", "seconds")}
    run |= {"load": more["machine"]["load"], "benchmarks": list(more["benchmarks"])}
    both = result["benchmarks"] | more["benchmarks"]
    ordered = {name: both[name] for name in BENCHMARKS if name in both}
    earlier = [r for r in result.get("further", []) if not set(r["benchmarks"]) <= set(run["benchmarks"])]
    return result | {"benchmarks": ordered, "further": [*earlier, run]}


def blocks(result: dict) -> dict[str, str]:
    """What lies between a document's marks, by name."""
    found = {"bench choose": choice(result), "bench made on": made_on(result)}
    for name, entry in result["benchmarks"].items():
        found[f"bench findings {name}"] = "\n".join(f"- {line}" for line in remarks(entry))
        for key, data in entry["tables"].items():
            note = f"\n\n{data['note']}" if data["note"] else ""
            found[f"bench {key}"] = markdown(data) + note
    return found


def publish(report: Path, further: Sequence[Path], root: Path) -> list[Path]:
    """Write everything that is published into the checkout `root`; returns what was written."""
    result = load(*(folder / "report.json" for folder in (report, *further)))
    shown = figures(result)
    files = {
        REFERENCE: to_json(result),
        REFERENCE.replace(".json", ".md"): to_markdown(result, shown, "../../docs/images"),
    }
    files |= {f"docs/images/{name}": text for name, text in images(shown).items()}
    if (report / TRUTH).is_file():
        files[f"benchmarks/data/{TRUTH}"] = (report / TRUTH).read_text("utf-8")
    files[DOCUMENT] = (root / DOCUMENT).read_text("utf-8")
    for name, block in blocks(result).items():
        files[DOCUMENT] = filled(files[DOCUMENT], name, block)
    for name, text in files.items():
        (root / name).write_text(text, "utf-8")
    return [root / name for name in files]


if __name__ == "__main__":
    for path in publish(Path(sys.argv[1]), [Path(more) for more in sys.argv[2:]], Path.cwd()):
        print(path)
