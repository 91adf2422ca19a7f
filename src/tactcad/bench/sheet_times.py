"""What the drawings' sheets add to an export: on one core, on all cores, and where nothing changed."""

from __future__ import annotations

import shutil
from typing import Any

from . import arrays
from .bench_tables import table
from .process import Run, command, cost, measured
from .run_plan import RunPlan

TITLE = "Drawing sheets"
QUESTION = "What do dimensioned sheets of every part add to an export?"
ONE_CORE = ("taskset", "-c", "0")


def measure(plan: RunPlan) -> dict:
    design = plan.folder / "sheets.toml"
    design.write_text(arrays.text(plan.of(2, 10, 10)), "utf-8")
    scenes = plan.of(("--scene", "array"), ("--scene", "array"), ())
    pinned = shutil.which(ONE_CORE[0]) is not None
    kinds = {"without sheets": (), "sheets, all cores": ("--drawings",)} | (
        {"sheets, one core": ("--drawings",)} if pinned else {}
    )
    if plan.mode == "smoke":
        kinds = {"sheets, all cores": kinds["sheets, all cores"]}
    runs: dict[str, list[Run]] = {kind: [] for kind in (*kinds, "sheets, unchanged")}
    for turn in range(plan.of(1, 1, 3)):
        for kind, options in kinds.items():
            plan.say(f"{kind}, run {turn + 1}")
            folder = plan.folder / f"{kind}-{turn}"
            export = command("export", str(design), *scenes, *options, "--out", str(folder / "out"))
            cache = {"TACTCAD_CACHE": str(folder / "cache")}
            runs[kind].append(measured([*(ONE_CORE if kind == "sheets, one core" else ()), *export], cache))
            if kind == "sheets, all cores":
                runs["sheets, unchanged"].append(measured(export, cache))
                count = len(list((folder / "out" / "drawings").glob("*.pdf")))
    without = min((run.seconds for run in runs.get("without sheets", ())), default=None)
    rows = []
    for kind, made in runs.items():
        row: dict[str, Any] = {"what": kind} | cost(made)
        drawn = kind != "without sheets"
        row["sheets"] = count if drawn else 0
        row["added"] = row["seconds"] - without if kind in kinds and drawn and without else None
        rows.append(row)
    columns = (
        "what: export; sheets; seconds: time [s]; median [s]; added: over without [s]; "
        "peak_bytes: peak memory [MB]"
    )
    note = (
        f"`tactcad export {' '.join(scenes)}` of the published design, empty cache but for the unchanged "
        "one; one core keeps the whole export on it."
    )
    missing = [] if pinned else ["taskset is not installed: one core was not measured."]
    return {
        "tables": {"sheets": table(TITLE, columns, rows, note)},
        "findings": findings(rows),
        "missing": missing,
    }


def findings(rows: list[dict]) -> list[str]:
    drawn = next(row for row in rows if row["what"] == "sheets, all cores")
    if drawn["added"] is None:
        return []
    return [
        f"{drawn['sheets']} sheets add {drawn['added']:.1f} s to an export of "
        f"{drawn['seconds'] - drawn['added']:.1f} s on all cores."
    ]
