"""A whole export against a plain script that writes the same kinds of files, and what starting up costs."""

from __future__ import annotations

from pathlib import Path

from tactcad.export.manifest import read_manifest
from tactcad.parts.designs import load

from . import arrays
from .bench_tables import table
from .process import child, command, cost, in_turns, measured, python
from .run_plan import RunPlan

TITLE = "Whole exports"
QUESTION = "How long from design file to finished folder: first, again, and after a change?"
PLAIN_SCRIPT = Path(__file__).with_name("peers") / "plain_export.py"
GOALS = {"cold / plain": 1.5, "unchanged / numpy": 3.0, "STEP over smallest": 5.0}
GOAL_ESTIMATE = 3.0  # times `import numpy`


def measure(plan: RunPlan) -> dict:
    sizes = plan.of({2: 1}, {10: 1}, {10: 5, 100: 3, 1000: 1})  # elements: runs
    rows = [_row(elements, runs, plan) for elements, runs in sizes.items()]
    for row in rows:
        row["STEP over smallest"] = row["bytes"] / rows[0]["bytes"]
    starts = _starts(plan)
    columns = (
        "elements; runs; cold [s]; plain: plain script [s]; cold / plain: ratio; "
        "changed: one arm changed [s]; unchanged [s]; numpy: import numpy [s]; unchanged / numpy: ratio; "
        "peak_bytes: peak memory [MB]; bytes: assembly STEP [kB]; STEP over smallest: over the smallest"
    )
    started = (
        "what: process; seconds: time [s]; median [s]; ratio: over import numpy; peak_bytes: peak memory [MB]"
    )
    note = (
        "`tactcad export --scene array` in fresh processes, shortest of the runs. Cold: empty cache. The "
        "plain script builds each shape once, writes each file once and reads it back once, without tactcad, "
        "cache or repeatable bytes."
    )
    return {
        "tables": {
            "export": table(TITLE, columns, rows, note),
            "start-up": table("Starting up", started, starts, "Whole processes, in turns."),
        },
        "findings": findings(rows, starts),
    }


def _row(elements: int, runs: int, plan: RunPlan) -> dict:
    times: dict[str, list[float]] = {name: [] for name in ("cold", "plain", "changed", "unchanged", "numpy")}
    peaks = []
    for run in range(runs):
        folder = plan.folder / f"export-{elements}-{run}"
        folder.mkdir()
        design, out = folder / "design.toml", folder / "out"
        cache = {"TACTCAD_CACHE": str(folder / "cache")}
        export = command("export", str(design), "--scene", "array", "--out", str(out))
        design.write_text(arrays.text(elements), "utf-8")
        load(design)  # a design that breaks a rule would only measure its refusal
        plan.say(f"{elements} elements, cold, run {run + 1}")
        cold = measured(export, cache)
        times["cold"].append(cold.seconds)
        peaks.append(cold.peak_bytes)
        plan.say(f"{elements} elements, plain script, run {run + 1}")
        plain = python(str(PLAIN_SCRIPT), str(elements), str(folder / "plain"))
        times["plain"].append(measured(plain).seconds)
        for _ in range(plan.of(1, 5, 10) if run == 0 else 0):
            times["unchanged"].append(measured(export, cache).seconds)
            times["numpy"].append(measured(python("-c", "import numpy")).seconds)
        files = read_manifest(out).files
        size = sum((out / f.path).stat().st_size for f in files if f.kind == "step-assembly")
        if plan.mode != "smoke":
            plan.say(f"{elements} elements, one arm changed, run {run + 1}")
            design.write_text(arrays.text(elements, changed=True), "utf-8")
            times["changed"].append(measured(export, cache).seconds)
    row: dict[str, float | None] = {"elements": elements, "runs": runs, "bytes": size}
    row["peak_bytes"] = min(peaks)
    row |= {name: min(seconds, default=None) for name, seconds in times.items()}
    for above, below in (("cold", "plain"), ("unchanged", "numpy")):
        row[f"{above} / {below}"] = min(times[above]) / min(times[below])
    return row


def _starts(plan: RunPlan) -> list[dict]:
    commands = {
        "python -c 'import numpy'": python("-c", "import numpy"),
        "tactcad estimate": command("estimate"),
        "tactcad schema": command("schema"),
        "the CAD kernel and build123d": child("kernel"),
    }
    chosen = dict(list(commands.items())[: plan.of(2, None, None)])
    runs = in_turns(chosen, plan.of(1, 3, 15), plan.say)
    rows: list[dict] = [{"what": name} | cost(made) for name, made in runs.items()]
    for row in rows:
        row["ratio"] = row["seconds"] / rows[0]["seconds"]
    return rows


def findings(rows: list[dict], starts: list[dict]) -> list[str]:
    lines = []
    for name, goal in GOALS.items():
        missed = [f"{row['elements']} elements: {row[name]:.2f}" for row in rows if row[name] > goal]
        worst = max(row[name] for row in rows)
        lines.append(
            f"MISSED: {name} at most {goal:g}: {', '.join(missed)}."
            if missed
            else f"met: {name} {worst:.2f} (goal {goal:g})."
        )
    estimate = next(row for row in starts if row["what"] == "tactcad estimate")["ratio"]
    state = "met" if estimate <= GOAL_ESTIMATE else "MISSED"
    lines.append(
        f"{state}: `tactcad estimate` takes {estimate:.2f} times `import numpy` (goal {GOAL_ESTIMATE:g})."
    )
    return lines
