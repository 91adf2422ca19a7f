"""Every rung of the ladder: its error over the envelope, and its time per element."""

from __future__ import annotations

import logging
from collections.abc import Callable, Hashable

import numpy as np

from tactcad.fit import fit_samples
from tactcad.fit.fit_samples import Columns, draw_box, section
from tactcad.mechanics import ladder
from tactcad.mechanics.register import BY_NAME
from tactcad.paper.report import sig

from . import truth
from .bench_tables import table
from .front import told
from .run_plan import RunPlan
from .timing import interleaved

TITLE = "Rungs of the model ladder"
QUESTION = "How wrong is each rung against converged finite elements, and what does it cost?"
GOAL_MILLION = 0.3  # s for a million designs by a closed form on one core


def measure(plan: RunPlan) -> dict:
    logging.getLogger("skfem").setLevel(logging.ERROR)  # it warns about the order of arrays in memory
    held_out, fine = fit_samples.shipped()["held out"], truth.of_run(plan)
    rows = [_closed_form(rung, held_out, fine) for rung in ladder.CLOSED_FORMS]
    rows += [
        _elements("fem-plane", fine, plan, plan.of(1, 20, 120)),
        _elements("fem-solid", fine, plan, plan.of(1, 4, 40)),
    ]
    seconds = _times(plan)
    for row in rows:
        row |= seconds[row["rung"]] | {"when": BY_NAME[row["rung"]].when}
        row["time ratio"] = row["seconds"] / seconds[ladder.DEFAULT_RUNG]["seconds"]
    columns = (
        "rung; solid mean: solid: mean error [%]; solid worst: worst [%]; solid designs: designs; plane "
        "mean: plane stress: mean error [%]; plane worst: worst [%]; plane designs: designs; seconds: time "
        "per element [us]; median [us]; alone: one element alone [us]; time ratio: time over solid's"
    )
    worst = max(float(np.nanmax(fine["plane_error"])), float(np.nanmax(fine["width_error"])))
    note = (
        "Errors of stiffness against converged elements, in three dimensions and in plane stress. These are "
        f"themselves within about {worst:.1g} on the {len(fine['width'])} designs solved for this (largest "
        "estimate), within 1e-4 on the held-out ones; no error of finite elements smaller than that estimate "
        "is claimed."
    )
    return {"tables": {"rungs": table(TITLE, columns, rows, note)}, "findings": findings(rows)}


def errors(stiffness: np.ndarray, exact: np.ndarray, label: str, own: np.ndarray | float = 0.0) -> dict:
    """Mean and worst size of the relative error, over the designs that have a result; none smaller than the
    `own` estimated error of what it is measured against."""
    error = np.maximum(np.abs(stiffness / exact - 1.0), own)
    error = error[np.isfinite(error)]
    mean, worst = (float(error.mean()), float(error.max())) if len(error) else (None, None)
    return {f"{label} mean": mean, f"{label} worst": worst, f"{label} designs": len(error)}


def _closed_form(rung: str, *samples: Columns) -> dict:
    K = np.concatenate([ladder.evaluate(section(c), rung).stiffness for c in samples])
    solid = np.concatenate([truth.solid_stiffness(c) for c in samples])
    row = {"rung": rung} | errors(K, solid, "solid")
    if BY_NAME[rung].against == "solid":  # not comparable with plane stress
        return row
    return row | errors(K, np.concatenate([c["plane_stiffness"] * c["width"] for c in samples]), "plane")


def _elements(rung: str, fine: Columns, plan: RunPlan, count: int) -> dict:
    from tactcad.fem.fem_ladder import stiffness

    K = np.full(len(fine["width"]), np.nan)
    for i, one in enumerate(truth.sections(fine)[:count]):
        plan.say(f"{rung}, design {i + 1} of {count}")
        K[i] = stiffness(one, rung)
    flat = fine["plane_error"]
    row = {"rung": rung} | errors(K, truth.solid_stiffness(fine), "solid", flat + fine["width_error"])
    return row | (
        errors(K, fine["plane_stiffness"] * fine["width"], "plane", flat) if rung == "fem-plane" else {}
    )


def _times(plan: RunPlan) -> dict[str, dict]:
    """Seconds per element: closed forms among many, element rungs one after the other."""
    from tactcad.fem.fem_ladder import stiffness

    many = section(draw_box(plan.of(1_000, 20_000, 200_000), plan.seed))
    count = many.shape[0]
    few = [many.rows(i) for i in range(plan.of(1, 3, 10))]
    plan.say("times, in turns")
    batch: dict[Hashable, Callable] = {r: lambda r=r: ladder.stiffness(many, r) for r in ladder.CLOSED_FORMS}
    alone: dict[Hashable, Callable] = {
        ("alone", r): lambda r=r: ladder.stiffness(few[0], r) for r in ladder.CLOSED_FORMS
    }
    elements: dict[Hashable, Callable] = {
        r: lambda r=r: [stiffness(one, r) for one in few] for r in ladder.FINITE_ELEMENTS
    }
    per = dict.fromkeys(ladder.CLOSED_FORMS, count) | dict.fromkeys(ladder.FINITE_ELEMENTS, len(few))
    timed = interleaved({**batch, **alone}, plan.of(1, 5, 9)) | interleaved(elements, plan.of(1, 2, 3))
    return {
        r: {
            "seconds": timed[r].seconds / n,
            "median": timed[r].median / n,
            "runs": timed[r].runs,
            "alone": timed["alone", r].seconds if ("alone", r) in timed else timed[r].seconds / n,
        }
        for r, n in per.items()
    }


def findings(rows: list[dict]) -> list[str]:
    by = {row["rung"]: row for row in rows}
    slowest = max(by[r]["seconds"] for r in ladder.CLOSED_FORMS) * 1e6
    default, plane, solid = by["solid"], by["fem-plane"], by["fem-solid"]
    return [
        "Against solid elements: "
        + told([r["rung"] for r in rows], [(r["seconds"], r["solid worst"]) for r in rows]),
        f"{'met' if slowest <= GOAL_MILLION else 'MISSED'}: a million designs by the slowest closed form in "
        f"{slowest:.2f} s (goal {GOAL_MILLION} s).",
        f"The solid rung errs by {100 * default['solid worst']:.2f} % at worst, fem-plane by "
        f"{100 * plane['solid worst']:.0f} % at {sig(plane['seconds'] / default['seconds'], 2)} times the "
        "time: for a real sheet plane elements are dominated by a closed form.",
        f"fem-solid errs by {sig(100 * solid['solid worst'], 2)} % at worst, at "
        f"{sig(solid['seconds'] / default['seconds'], 2)} times the solid rung's time.",
    ]
