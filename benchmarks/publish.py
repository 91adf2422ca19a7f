"""A run's report becomes the published one: `python benchmarks/publish.py REPORT [FURTHER]...` in the
checkout.

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

from choice import choice
from ladder_tables import filled

from tactcad.bench import bench_tables, render, truth
from tactcad.bench.figures import figures
from tactcad.bench.session import BENCHMARKS, SCHEMA
from tactcad.design.messages import InputError
from tactcad.paper.report import standalone

REFERENCE = "benchmarks/results/reference.json"
DOCUMENTS = ("docs/benchmarks.md", "docs/rigs.md", "docs/mechanics.md", "docs/checks.md")


def load(*paths: Path) -> dict:
    """The JSON of a report, with that of further ones in its place. Raises InputError where one is no report,
    they do not belong together, or a benchmark is lacking or failed."""
    first, *further = map(_read, paths)
    result = first
    for more in further:
        result = replaced(result, more)
    lacking = [n for n in BENCHMARKS if "tables" not in result["benchmarks"].get(n, {})]
    failed = [n for n, entry in result["benchmarks"].items() if "failed" in entry]
    if lacking or failed:
        raise InputError(
            str(paths[0]), "not a whole report", value=", ".join(lacking + failed), legal="every benchmark"
        )
    return result


def _read(path: Path) -> dict:
    try:
        result = json.loads(path.read_text("utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(str(path), f"cannot be read: {error}") from None
    if result.get("schema") != SCHEMA:
        raise InputError(str(path), "not a report", value=str(result.get("schema")), legal=f"schema {SCHEMA}")
    return result


def replaced(result: dict, more: dict) -> dict:
    """The report with what `more` measured in the place of its own, under "further" from which run.

    Raises InputError where they are not from one machine with the same versions.
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
    return result | {
        "benchmarks": {name: both[name] for name in BENCHMARKS if name in both},
        "further": [*result.get("further", []), run],
    }


def blocks(result: dict) -> dict[str, str]:
    """What stands between a document's marks, by name."""
    found = {"bench choose": choice(result), "bench made on": render.made_on(result)}
    for name, entry in result["benchmarks"].items():
        found[f"bench findings {name}"] = "\n".join(f"- {line}" for line in render.remarks(entry))
        for key, data in entry["tables"].items():
            found[f"bench {key}"] = bench_tables.markdown(data) + (
                f"\n\n{data['note']}" if data["note"] else ""
            )
    return found


def images(result: dict) -> dict[str, bytes]:
    return {f"{f.name}.svg": standalone(f).encode() for shown in figures(result).values() for f in shown}


def publish(report: Path, further: Sequence[Path], root: Path) -> list[Path]:
    """Write everything that is published into the checkout `root`; returns what was written."""
    result = load(*(folder / "report.json" for folder in (report, *further)))
    files = {
        REFERENCE: render.to_json(result),
        REFERENCE.replace(".json", ".md"): render.to_markdown(result, "../../docs/images"),
    }
    files |= {f"docs/images/{name}": data.decode() for name, data in images(result).items()}
    if (report / truth.SHIPPED).is_file():
        files[f"src/tactcad/bench/data/{truth.SHIPPED}"] = (report / truth.SHIPPED).read_text("utf-8")
    for document in DOCUMENTS:
        text = (root / document).read_text("utf-8")
        for name, block in blocks(result).items():
            text = filled(text, name, block)
        files[document] = text
    for name, text in files.items():
        (root / name).write_text(text, "utf-8")
    return [root / name for name in files]


if __name__ == "__main__":
    for path in publish(Path(sys.argv[1]), [Path(more) for more in sys.argv[2:]], Path.cwd()):
        print(path)
