"""A run: every benchmark asked for, and what it was measured on, as one JSON document."""

from __future__ import annotations

import importlib
import time
import traceback
from collections.abc import Callable, Sequence
from dataclasses import replace
from datetime import date
from pathlib import Path
from typing import Any

from tactcad.design.extras import missing
from tactcad.design.messages import CheckFailure

from .machine import machine, peers, versions
from .run_plan import RunPlan

SCHEMA = "tactcad-bench-1"
# Name -> module, and whether it needs the CAD kernel.
BENCHMARKS = {
    "rungs": ("rung_errors", False),
    "meshes": ("meshes", False),
    "tessellation": ("tessellation", True),
    "interference": ("verdicts", True),
    "detail": ("detail_levels", True),
    "step": ("prototypes", True),
    "scaling": ("scaling", True),
    "element": ("one_element", True),
    "export": ("export_times", True),
    "sheets": ("sheet_times", True),
}


def run(plan: RunPlan, names: Sequence[str], say: Callable[[int, int, str], None]) -> dict:
    """Run benchmarks; one that fails is recorded with its reason under "failed", and the others go on.

    Parameters
    ----------
    plan
        How much each does.
    names
        Of `BENCHMARKS`.
    say
        Receives (done, total, text).

    Returns
    -------
    dict
        The run as JSON holds it.
    """
    started = time.perf_counter()
    result: dict[str, Any] = {
        "schema": SCHEMA,
        "mode": plan.mode,
        "date": date.today().isoformat(),
        "seed": plan.seed,
        "machine": machine(),
        "versions": versions(),
        "peers": peers(),
        "benchmarks": {},
    }
    for done, name in enumerate(names):
        told = replace(plan, say=lambda text: say(done, len(names), f"{name}: {text}"))  # noqa: B023
        told.say("begins")
        result["benchmarks"][name] = _one(name, told)
    say(len(names), len(names), "done")
    return result | {"seconds": round(time.perf_counter() - started, 1)}


def _one(name: str, plan: RunPlan) -> dict:
    module_name, needs_kernel = BENCHMARKS[name]
    module = importlib.import_module(f".{module_name}", __package__)
    entry = {"title": module.TITLE, "question": module.QUESTION, "tables": {}, "findings": [], "missing": []}
    if needs_kernel and missing("cad"):
        return entry | {"seconds": 0.0, "missing": ["The CAD kernel is not installed: not measured."]}
    started = time.perf_counter()
    try:
        entry |= module.measure(plan)
    except CheckFailure as failure:
        entry["failed"] = str(failure)
    except Exception as error:  # a fault in one does not lose what the others measured
        at = traceback.extract_tb(error.__traceback__)[-1]
        entry["failed"] = (
            f"{type(error).__name__} in {at.name}, line {at.lineno} of {Path(at.filename).name}: {error}"
        )
    return entry | {"seconds": round(time.perf_counter() - started, 1)}
