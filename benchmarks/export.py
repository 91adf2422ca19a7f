"""Export times of tactcad against a plain script that writes the same kinds of files, in one run on one machine.

For 10, 100 and 1000 elements, each in a fresh process, no time taken off. Runs that are compared alternate, and
the shortest of each kind counts: what else the machine does only ever adds time.

    cold        the first export, with an empty cache
    unchanged   the same command again
    one arm     the same again after one arm length was changed
    baseline    baseline_export.py: every distinct shape once through the kernel, each file written and read back once
    numpy       python -c "import numpy": the yardstick for a command that does nothing

usage: export.py [--smoke] [--scenes] [--drawings] [--json FILE]
       --smoke: 10 elements only, each command once; --scenes: each rig's scene alone, full and as envelopes;
       --drawings: what the sheets of the shipped design add to its export, on one core and on all
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import resource
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]
DESIGN = ROOT / "hardware" / "macro-array.toml"
BASELINE = Path(__file__).with_name("baseline_export.py")
SCENES = ("array", "calibration", "sample-stiffness", "grasping")
SIZES = (10, 100, 1000)
GOALS = {"cold / baseline": 1.5, "unchanged / numpy": 3.0, "STEP size / that of 10": 5.0}
RUNS = {10: 5, 100: 3, 1000: 1}  # of what takes seconds to minutes
QUICK_RUNS = 10  # of what takes a fraction of a second


def design_text(elements: int, changed: bool = False) -> str:
    """The published design with its rows repeated to the number of elements; `changed` makes one arm 0.5 mm longer."""
    text = DESIGN.read_text(encoding="utf-8")
    (line,) = (line for line in text.splitlines() if line.startswith("row_arms"))
    rows = tomllib.loads(line)["row_arms"]
    arms = [[row[i % len(row)] for i in range(elements // 2)] for row in rows]
    if changed:
        arms[0][0] += 0.5
    return text.replace(line, f"row_arms = {arms}")


def seconds(command: list[str], cache: Path) -> float:
    """Wall-clock time of a command in a fresh process."""
    environment = {**os.environ, "TACTCAD_CACHE": str(cache), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    start = time.perf_counter()
    run = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    taken = time.perf_counter() - start
    if run.returncode:
        sys.exit(f"{' '.join(command)} failed:\n{run.stderr}")
    return taken


def assembly_bytes(folder: Path) -> int:
    files = json.loads((folder / "manifest.json").read_text())["files"]
    return sum((folder / f["path"]).stat().st_size for f in files if f["kind"] == "step-assembly")


def measure(elements: int, runs: int, quick_runs: int) -> dict[str, float]:
    """Shortest times (s) of all commands and the assembly's size (bytes) for one number of elements."""
    times: dict[str, list[float]] = {name: [] for name in ("cold", "unchanged", "one arm", "baseline", "numpy")}
    with tempfile.TemporaryDirectory() as name:
        for run in range(runs):
            folder = Path(name, str(run))
            folder.mkdir()
            design, out, cache = folder / "design.toml", folder / "out", folder / "cache"
            export = [sys.executable, "-m", "tactcad", "export", str(design), "--scene", "array", "--out", str(out)]
            plain = [sys.executable, str(BASELINE), str(elements), str(folder / "baseline")]
            design.write_text(design_text(elements))
            times["cold"].append(seconds(export, cache))
            times["baseline"].append(seconds(plain, cache))
            for _ in range(quick_runs if run == 0 else 0):
                times["unchanged"].append(seconds(export, cache))
                times["numpy"].append(seconds([sys.executable, "-c", "import numpy"], cache))
            size = assembly_bytes(out)
            design.write_text(design_text(elements, changed=True))
            times["one arm"].append(seconds(export, cache))
    return {"elements": elements, "runs": runs, "step_bytes": size, **{name: min(t) for name, t in times.items()}}


def measure_scenes() -> list[dict[str, float | str]]:
    """Cold and unchanged export (s) of each rig's scene alone, in fresh processes, full and as envelopes, with the
    parts it built, the largest memory (MB) and the size of its STEP assembly (bytes)."""
    rows: list[dict[str, float | str]] = []
    for scene in SCENES:
        for detail in ("full", "envelope"):
            with tempfile.TemporaryDirectory() as name:
                folder = Path(name)
                export = [
                    sys.executable, "-m", "tactcad", "export", str(DESIGN), "--scene", scene, "--detail", detail,
                    "--out", str(folder / "out"),
                ]
                cold = seconds(export, folder / "cache")
                unchanged = min(seconds(export, folder / "cache") for _ in range(3))
                parts = json.loads((folder / "out" / "manifest.json").read_text())["parts"]
                rows.append({
                    "scene": scene, "detail": detail, "parts": len(parts), "cold": cold, "unchanged": unchanged,
                    "memory": resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024,
                    "step_bytes": assembly_bytes(folder / "out"),
                })
    return rows


def measure_drawings(runs: int = 3) -> dict[str, float]:
    """Shortest export (s) of the shipped design with all its scenes: without drawings, with them on one core, with them
    on all cores, and unchanged with them; and how many PDF files the drawings are."""
    times: dict[str, list[float]] = {"without": [], "one core": [], "all cores": [], "unchanged": []}
    for _ in range(runs):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            export = [sys.executable, "-m", "tactcad", "export", str(DESIGN), "--out"]
            times["without"].append(seconds([*export, str(folder / "without")], folder / "a"))
            one = ["taskset", "-c", "0", *export, str(folder / "one"), "--drawings"]
            times["one core"].append(seconds(one, folder / "b"))
            drawn = [*export, str(folder / "all"), "--drawings"]
            times["all cores"].append(seconds(drawn, folder / "c"))
            times["unchanged"].append(seconds(drawn, folder / "c"))
            sheets = len(list((folder / "all" / "drawings").glob("*.pdf")))
    return {"sheets": sheets, **{name: min(t) for name, t in times.items()}}


def drawing_table(row: dict[str, float]) -> str:
    """Markdown. On one core the whole export, not the sheets alone, is kept on it."""
    names = ("without", "one core", "all cores", "unchanged")
    cells = " | ".join(f"{row[name]:.1f}" for name in names)
    return "\n".join([
        "| drawings | " + " | ".join(f"{name}, s" for name in names) + " |", "|" + "---|" * (1 + len(names)), f"| {row['sheets']} | {cells} |",
    ])


def scene_table(rows: list[dict[str, float | str]]) -> str:
    """Markdown. Memory is the largest of this and every process before it."""
    lines = ["| scene | detail | parts | cold, s | unchanged, s | STEP, kB |", "|---|---|---|---|---|---|"]
    lines += [
        f"| {r['scene']} | {r['detail']} | {r['parts']} | {r['cold']:.1f} | {r['unchanged']:.2f} | {r['step_bytes'] / 1e3:.0f} |"
        for r in rows
    ]
    return "\n".join([*lines, "", f"Most memory of any: {max(r['memory'] for r in rows):.0f} MB."])


def with_ratios(rows: list[dict[str, float]]) -> list[dict[str, float]]:
    return [
        {
            **row,
            "cold / baseline": row["cold"] / row["baseline"],
            "unchanged / numpy": row["unchanged"] / row["numpy"],
            "STEP size / that of 10": row["step_bytes"] / rows[0]["step_bytes"],
        }
        for row in rows
    ]


def table(rows: list[dict[str, float]]) -> str:
    """Markdown, as it stands in README."""
    columns = ["cold", "unchanged", "one arm", "baseline", "numpy"]
    lines = [
        "| elements | " + " | ".join(f"{c}, s" for c in columns) + " | " + " | ".join(GOALS) + " |",
        "|" + "---|" * (1 + len(columns) + len(GOALS)),
    ]
    for row in rows:
        cells = [f"{row[c]:.2f}" for c in (*columns, *GOALS)]
        lines.append(f"| {row['elements']} | " + " | ".join(cells) + " |")
    goals = "; ".join(f"{name} at most {goal:g}" for name, goal in GOALS.items())
    missed = [f"{row['elements']}: {name}" for row in rows for name, goal in GOALS.items() if row[name] > goal]
    lines += ["", f"Goals: {goals}.", f"Missed: {', '.join(missed) or 'none'}."]
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--smoke", action="store_true", help="10 elements only, each command once")
    parser.add_argument("--scenes", action="store_true", help="the rigs' scenes instead of the array's sizes")
    parser.add_argument("--drawings", action="store_true", help="what the sheets of the shipped design cost")
    parser.add_argument("--json", metavar="FILE", help="write all figures to FILE")
    args = parser.parse_args()
    if args.scenes:
        print(scene_table(measure_scenes()))
        return
    if args.drawings:
        print(drawing_table(measure_drawings()))
        return
    rows = []
    for elements in SIZES[:1] if args.smoke else SIZES:
        print(f"{elements} elements ...", file=sys.stderr)
        rows.append(measure(elements, *((1, 1) if args.smoke else (RUNS[elements], QUICK_RUNS))))
    rows = with_ratios(rows)
    print(table(rows))
    if args.json:
        machine = {"python": platform.python_version(), "machine": platform.machine(), "cores": os.cpu_count()}
        Path(args.json).write_text(json.dumps({"machine": machine, "goals": GOALS, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
