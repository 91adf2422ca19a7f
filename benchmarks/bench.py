"""Speed against accuracy, measured on the machine that it runs on.

    python benchmarks/bench.py --out bench                everything in short: four minutes on two cores
    python benchmarks/bench.py --out bench --full         for publication
    python benchmarks/bench.py --out bench --only rungs --only meshes
    python benchmarks/bench.py --out bench --smoke        does everything run? its figures mean nothing

Alternatives are measured alternately, in one run. CalculiX and FreeCAD are measured too if they are
installed, and reported as missing if not. Written are report.json, report.md, tables/*.csv and plots/*.svg,
all from the JSON.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import os
import secrets
import shutil
import sys
import tempfile
import time
import traceback
from collections.abc import Sequence
from dataclasses import replace
from datetime import date
from pathlib import Path
from typing import Any

import bench_elements
import bench_files  # noqa: F401  registers its benchmarks, as do the others
import bench_geometry  # noqa: F401
import bench_object  # noqa: F401
import tables
from bench_plots import figures
from measuring import BENCHMARKS, RunPlan, environment, machine, peers, versions

from tactcad.design.messages import CheckFailure
from tactcad.report.report import Picture, standalone

SCHEMA = "tactcad-bench-1"
SHORT_SEED = 8  # any; a full run draws its own unless it is given one


def run(plan: RunPlan, names: Sequence[str]) -> dict:
    """Run benchmarks of these names; one that fails is recorded with its reason under "failed", and the
    others go on. Returns the run as JSON holds it."""
    started = time.perf_counter()
    result: dict[str, Any] = {
        "schema": SCHEMA,
        "mode": plan.mode,
        "date": date.today().isoformat(),
        "seed": plan.seed,
        "machine": machine(),
        "versions": versions(),
        "peers": peers(),
    }
    result["benchmarks"] = {
        name: _one(name, replace(plan, say=lambda text, name=name: plan.say(f"{name}: {text}")))
        for name in names
    }
    return result | {"seconds": round(time.perf_counter() - started, 1)}


def _one(name: str, plan: RunPlan) -> dict:
    it = BENCHMARKS[name]
    entry: dict[str, Any] = {"title": it.title, "question": it.question}
    entry |= {"tables": {}, "findings": [], "missing": []}
    if it.kernel and not _kernel():
        return entry | {"seconds": 0.0, "missing": ["The CAD kernel is not installed: not measured."]}
    plan.say("begins")
    started = time.perf_counter()
    try:
        entry |= it.measure(plan)
    except CheckFailure as failure:
        entry["failed"] = str(failure)
    except Exception as error:  # a fault in one does not lose what the others measured
        at = traceback.extract_tb(error.__traceback__)[-1]
        entry["failed"] = (
            f"{type(error).__name__} in {at.name}, line {at.lineno} of {Path(at.filename).name}: {error}"
        )
    for data in entry["tables"].values():
        data["title"] = data["title"] or it.title
    return entry | {"seconds": round(time.perf_counter() - started, 1)}


def _kernel() -> bool:
    return all(importlib.util.find_spec(name) for name in ("OCP", "build123d", "manifold3d"))


# --- the results shown ---


def to_json(result: dict) -> str:
    return json.dumps(result, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def made_on(result: dict) -> str:
    """Machine, versions, date in a sentence; a further one for every run that some of the benchmarks are
    from."""
    m, v = result["machine"], result["versions"]
    others = ", ".join(f"{name} {version}" for name, version in result["peers"].items())
    said = (
        f"{result['mode'].capitalize()} run of {result['date']}, seed {result['seed']}, "
        f"{result['seconds'] / 60:.0f} minutes on {m['processor']}, {m['cores']} cores, {m['memory_GB']:g} "
        f"GB, {m['system']}, load {m['load']:g} when it began; Python {v['python']}, tactcad {v['tactcad']}, "
        f"numpy {v['numpy']}, scipy {v['scipy']}, scikit-fem {v['scikit-fem']}, OCP {v['cadquery-ocp']}, "
        f"build123d {v['build123d']}; {others}."
    )
    for more in result.get("further", ()):
        said += (
            f" From a {more['mode']} run of {more['date']} on it, seed {more['seed']}, "
            f"{more['seconds'] / 60:.0f} minutes, load {more['load']:g}: {', '.join(more['benchmarks'])}."
        )
    return said


def remarks(entry: dict) -> list[str]:
    """What was found, what could not be measured, what failed."""
    failed = [f"FAILED: {entry['failed']}"] if "failed" in entry else []
    return [*entry["findings"], *entry["missing"], *failed]


def to_markdown(result: dict, shown: dict[str, list[Picture]], plots: str = "plots") -> str:
    """`shown`: its figures; `plots` is the folder of the pictures, as seen from the file."""
    lines = ["# Speed against accuracy, measured", "", made_on(result)]
    for name, entry in result["benchmarks"].items():
        lines += ["", f"## {entry['title']}", "", entry["question"], ""]
        lines += [f"- {line}" for line in remarks(entry)]
        lines += [f"\n![{f.caption}]({plots}/{f.name}.svg)" for f in shown.get(name, ())]
        for data in entry["tables"].values():
            lines += ["", f"### {data['title']}", "", tables.markdown(data)]
            lines += ["", data["note"]] if data["note"] else []
    return "\n".join(lines) + "\n"


def images(shown: dict[str, list[Picture]]) -> dict[str, str]:
    """Each of the figures as a file of its own, by its name."""
    return {f"{f.name}.svg": standalone(f) for pictures in shown.values() for f in pictures}


def files(result: dict) -> dict[str, str]:
    """Every file of a report's folder, by name."""
    shown = figures(result)
    made = {"report.json": to_json(result), "report.md": to_markdown(result, shown)}
    for entry in result["benchmarks"].values():
        made |= {f"tables/{key}.csv": tables.as_csv(data) for key, data in entry["tables"].items()}
    return made | {f"plots/{name}": text for name, text in images(shown).items()}


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    mode = parser.add_mutually_exclusive_group()
    mode.add_argument("--full", action="store_true", help="elements converged anew, all sizes, more repeats")
    mode.add_argument("--smoke", action="store_true", help="the least of everything, once")
    parser.add_argument("--only", action="append", choices=BENCHMARKS, help="this one; may be repeated")
    parser.add_argument("--seed", type=int, help="of the random designs and pairs (full: a new one)")
    parser.add_argument("--out", type=Path, required=True, help="folder of the report; an earlier one goes")
    asked = parser.parse_args(arguments)
    out, seed = asked.out, SHORT_SEED if asked.seed is None else asked.seed
    if asked.full and asked.seed is None:
        seed = secrets.randbelow(2**31)
    if out.exists() and any(out.iterdir()) and not (out / "report.json").is_file():
        parser.error(f"--out {out}: holds something else than an earlier report")
    with tempfile.TemporaryDirectory() as scratch:
        say = lambda text: print(text, file=sys.stderr, flush=True)  # noqa: E731
        kind = "full" if asked.full else "smoke" if asked.smoke else "short"
        plan = RunPlan(kind, seed, Path(scratch), say)
        result = run(plan, [name for name in BENCHMARKS if name in (asked.only or BENCHMARKS)])
        made = files(result)
        truth = plan.folder / bench_elements.TRUTH
        made |= {truth.name: truth.read_text("utf-8")} if truth.is_file() else {}
    shutil.rmtree(out, ignore_errors=True)
    for name, text in made.items():
        (out / name).parent.mkdir(parents=True, exist_ok=True)
        (out / name).write_text(text, "utf-8")
    print(made["report.md"])
    return 1 if any("failed" in entry for entry in result["benchmarks"].values()) else 0


if __name__ == "__main__":
    if os.environ.get("OMP_NUM_THREADS") != "1":  # numpy is loaded by now: one thread, as every child
        os.execve(sys.executable, [sys.executable, *sys.argv], environment())
    raise SystemExit(main())
