"""How cost grows with the number of elements: estimates, and every stage of geometry."""

from __future__ import annotations

import logging
from functools import partial

import numpy as np

from tactcad.fit import fit_samples
from tactcad.fit.fit_samples import draw_box, section
from tactcad.mechanics import ladder

from .bench_tables import table
from .exponent import fit
from .process import child, command, cost, last_line, measured
from .run_plan import RunPlan
from .timing import interleaved, of_samples

TITLE = "Scaling with the number of elements"
QUESTION = "Does any cost grow faster than the array?"

# Why a stage may grow faster than its array; what is not named here is reported as unexplained.
_PICTURES = (
    "hidden lines: up to 300 shapes exactly, every edge against every face near it; beyond, strip by strip "
    "on triangles, but plates as long as the picture reach into every strip with all their holes"
)
EXPLAINED = {"picture, above": _PICTURES, "picture, open": _PICTURES, "all of these, process": "its pictures"}
NOISE = 0.15  # by which the exponent between two single times of a linear cost may be off


def measure(plan: RunPlan) -> dict:
    logging.getLogger("skfem").setLevel(logging.ERROR)  # it warns about the order of arrays in memory
    rows = _estimates(plan) + _elements(plan) + _batches(plan) + _geometry(plan)
    exponents = _exponents(rows)
    columns = (
        "what; elements; seconds: time [ms]; median [ms]; each: time an element [us]; "
        "peak_bytes: peak memory [MB]"
    )
    fitted = (
        "what; from; to: to elements; exponent; low: 95 % from; high: to; last: last two sizes; verdict; why"
    )
    note = (
        "cost = a n^p by least squares of the logarithms, Student's interval. Fixed costs hide growth at "
        "small sizes: the last two sizes alone stand beside it."
    )
    return {
        "tables": {
            "exponents": table("Fitted exponents", fitted, exponents, note),
            "scaling": table(
                TITLE, columns, rows, "Geometry: stages of one export and check in a fresh process."
            ),
        },
        "findings": findings(exponents),
    }


def _estimates(plan: RunPlan) -> list[dict]:
    """The default closed form in this process, range checks included."""
    sizes = plan.of((10, 100), (10, 100, 1000, 10_000), (10, 30, 100, 300, 1000, 3000, 10_000))
    plan.say("estimates by the default rung")
    many = {n: section(draw_box(n, plan.seed)) for n in sizes}
    actions = {n: partial(ladder.evaluate, s) for n, s in many.items()}
    timed = interleaved(actions, plan.of(1, 5, 15))
    return [_row("estimate, rung solid", n, t.seconds, t.median) for n, t in timed.items()]


def _elements(plan: RunPlan) -> list[dict]:
    from tactcad.fem.plane_elements import solve_plane
    from tactcad.fem.shape import reference_shape

    sizes = plan.of((1, 2), (3, 10, 30), (10, 30, 100, 300))
    designs = section(draw_box(max(sizes), plan.seed))
    plan.say("plane elements, density 3")
    shapes = [reference_shape(designs.rows(i)) for i in range(max(sizes))]
    actions = {n: lambda n=n: [solve_plane(s, 1.0, 0.33, 1.0) for s in shapes[:n]] for n in sizes}
    timed = interleaved(actions, plan.of(1, 1, 3))
    return [_row("plane elements, density 3", n, t.seconds, t.median) for n, t in timed.items()]


def _batches(plan: RunPlan) -> list[dict]:
    """`tactcad estimate --batch` as a process, from CSV file to CSV file."""
    rows = []
    for n in plan.of((10, 100), (10, 100, 1000, 10_000), (10, 100, 1000, 10_000)):
        plan.say(f"tactcad estimate --batch, {n} rows")
        source = plan.folder / "batch.csv"
        drawn = draw_box(n, plan.seed)
        fit_samples.write(
            {k: drawn[k] for k in fit_samples.BOX} | {"youngs_modulus": np.full(n, 70e3)}, source
        )
        run = command("estimate", "--batch", str(source), "--out", str(plan.folder / "stiffness.csv"))
        runs = [measured(run) for _ in range(plan.of(1, 2, 5))]
        rows.append(_row("estimate --batch, process", n, **cost(runs)))
    return rows


def _geometry(plan: RunPlan) -> list[dict]:
    rows = []
    for n in plan.of((2,), (10, 20, 40, 100), (10, 30, 100, 300, 1000)):
        plan.say(f"geometry of {n} elements")
        runs = [measured(child("stages", elements=n)) for _ in range(plan.of(1, 1, 2))]
        stages = [last_line(run)["seconds"] for run in runs]
        for stage in stages[0]:
            timed = of_samples([seconds[stage] for seconds in stages])
            rows.append(_row(stage, n, timed.seconds, timed.median))
        rows.append(_row("all of these, process", n, **cost(runs)))
    return rows


def _row(what: str, n: int, seconds: float, median: float, peak_bytes: float | None = None) -> dict:
    row = {"what": what, "elements": n, "seconds": seconds, "median": median, "each": seconds / n}
    return row | {"peak_bytes": peak_bytes}


def _exponents(rows: list[dict]) -> list[dict]:
    exponents = []
    for what in dict.fromkeys(row["what"] for row in rows):
        group = [row for row in rows if row["what"] == what]
        sizes = [row["elements"] for row in group]
        if len(sizes) < 2:
            continue
        p = fit(sizes, [row["seconds"] for row in group])
        above = p.low > 1.0 or p.last > 1.0 + NOISE
        finite = np.isfinite(p.low)
        exponents.append(
            {
                "what": what,
                "from": sizes[0],
                "to": sizes[-1],
                "exponent": p.value,
                "low": p.low if finite else None,
                "high": p.high if finite else None,
                "last": p.last,
                "verdict": "above linear" if above else "at most linear",
                "why": EXPLAINED.get(what, "not explained") if above else "",
            }
        )
    return exponents


def findings(exponents: list[dict]) -> list[str]:
    above = [e for e in exponents if e["verdict"] == "above linear"]
    lines = [
        f"{e['what']}: n^{e['exponent']:.2f}, n^{e['last']:.2f} between the two largest: {e['why']}."
        for e in above
    ]
    if exponents and not above:
        lines.append("Nothing grows faster than the number of elements.")
    return lines
