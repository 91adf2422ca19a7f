"""Largest error of every rung by zone of the envelope, against solid elements: data/accuracy.json."""

from __future__ import annotations

import math
import os
import platform
import time
from collections.abc import Callable
from datetime import date

import numpy as np

from tactcad.mechanics import accuracy, validity
from tactcad.mechanics.accuracy import CANDIDATES, Candidate
from tactcad.mechanics.plane import compliance_by
from tactcad.mechanics.register import REGISTER
from tactcad.mechanics.section import Array, HingeSection

from .accuracy_samples import SECONDS, SEED, with_width_factor
from .corner_samples import DEEP, DRAWS, LESS_NARROW, NARROW
from .fit import NEXT_TO_NONE
from .fit_samples import Columns, joined, section

# The promised error is the largest measured one times this: a new design can always be somewhat worse, the
# more so the fewer were measured. The closed forms are fitted to least eighth powers, corners included, so
# that many designs have errors near the largest.
# Of designs drawn later (benchmarks/budgets.py) one erred 1.54 times the largest by rung solid. Refined
# meshes, on which the fewest were solved, erred 3.7 and 8.7 times it where an arm is hardly longer than high.
MARGIN, MARGIN_OF_FEW, FEW, MARGIN_OF_REFINED = 2.0, 2.5, 60, 7.0
# Below l/t = 0.5 the hinge is so short that its two roots act as one; from 2 on they are independent.
Bounds = dict[str, list[float | None]]


def _zones(*deep: list[float | None]) -> tuple[Bounds, ...]:
    """Bounds of a notch form's zones; `deep`: of b/l, where fillets are deep."""
    return (
        {"b/l": [NARROW, None], "l/t": [0.0, NEXT_TO_NONE]},
        {"b/l": [NARROW, None], "l/t": [NEXT_TO_NONE, 2.0]},
        {"b/l": [NARROW, None], "l/t": [2.0, None], "r/t": [0.0, DEEP]},
        *({"b/l": widths, "l/t": [2.0, None], "r/t": [DEEP, None]} for widths in deep),
        {"b/l": [0.0, NARROW], "r/t": [0.0, DEEP]},
        {"b/l": [0.0, NARROW], "r/t": [DEEP, None]},
    )


# Of one-sided hinges with deep fillets too few were measured to tell widths apart, and they err less.
ZONES = {"two": _zones([LESS_NARROW, None], [NARROW, LESS_NARROW]), "one": _zones([NARROW, None])}
TIMED = 10_000  # designs in the table that closed forms are timed on
REFERENCE = (
    "three-dimensional linear elasticity of the element cut at load line and clamp edge, "
    "by solid elements refined to their limit (fem-solid)"
)

Errors = dict[str, np.ndarray]


def accuracy_table(samples: dict[str, Columns], ladder_data: dict, today: date) -> dict:
    """The contents of data/accuracy.json.

    Parameters
    ----------
    samples
        Computed designs, by the names of fit_samples.FILES.
    ladder_data
        Constants and range, as data/ladder.json.
    today
        Date of the table.
    """
    clock = closed_form_seconds(ladder_data)
    columns = joined(list((samples | {"range": with_width_factor(samples["range"])}).values()))
    errors = candidate_errors(columns, ladder_data)
    groups, two_sided = validity.groups(section(columns)), columns["two_sided"] == 1.0
    zones = []
    for sides, bounds in ((sides, bounds) for sides, all_ in ZONES.items() for bounds in all_):
        zone = {"sides": sides, "bounds": bounds}
        narrow = bounds["b/l"][0] == 0.0  # too few to tell the notch forms apart
        form = np.full_like(two_sided, sides == "two") if narrow else two_sided
        inside = accuracy.in_zone(zone, groups, form)
        zones.append(zone | _measured(columns, errors, inside, clock))
    return {
        "reference": REFERENCE,
        "margin": {
            "usual": MARGIN,
            f"of fewer than {FEW} designs": MARGIN_OF_FEW,
            "of refined meshes": MARGIN_OF_REFINED,
        },
        "date": today.isoformat(),
        "machine": f"{platform.machine()}, {platform.system()}, Python {platform.python_version()}, numpy "
        f"{np.__version__}, "
        f"{os.cpu_count()} cores, one used",
        "samples": {name: len(c["poisson"]) for name, c in samples.items()}
        | {"seed of range": SEED}
        | {f"seeds of {name}": [draw.seed for draw in draws] for name, draws in DRAWS.items()},
        "seconds a call": {c.name: clock.get(c.name, (0.0, 0.0))[0] for c in CANDIDATES},
        "zones": zones,
    }


def candidate_errors(columns: Columns, ladder_data: dict) -> Errors:
    """|K/K_solid - 1| of every candidate for every design, NaN where it was not measured.

    K_solid is that of fem-solid on the finest meshes on which the design was solved. A closed form that
    models the width is made of the plane rung's parts; where only the plane was solved, the error of these
    counts.
    """
    s = section(columns)
    plane = columns["plane_stiffness"] * columns["width"]
    truth = plane * columns["width_factor"]
    errors = {
        rung.name: np.abs(1.0 / (rung.compliance(s, ladder_data) * truth) - 1.0)
        for rung in REGISTER
        if rung.compliance
    }
    flat = np.abs(1.0 / (compliance_by(s, ladder_data) * plane) - 1.0)
    for rung in REGISTER:
        if rung.compliance and "width" in rung.fitted:
            errors[rung.name] = np.fmax(errors[rung.name], flat)
    errors["fem-plane"] = np.abs(plane / truth - 1.0)
    finest = np.where(np.isfinite(columns["solid_mesh_4"]), columns["solid_mesh_4"], np.nan)
    errors["fem-solid, mesh 3"] = np.abs(columns["solid_mesh_3"] / finest - 1.0)
    finer = np.where(np.isfinite(finest), finest, columns["solid_mesh_3"])
    errors["fem-solid, mesh 2"] = np.abs(columns["solid_mesh_2"] / finer - 1.0)
    return errors


def closed_form_seconds(ladder_data: dict, repeats: int = 7) -> dict[str, tuple[float, float]]:
    """(seconds of a call, seconds a design in a long table) of every closed form, shortest of several
    runs."""
    from .fit_samples import draw_box

    many = section(draw_box(200, seed=0)).rows(np.arange(TIMED) % 200)
    one = many.rows(0)
    seconds = {}
    for rung in REGISTER:
        if form := rung.compliance:
            call, table = (min(_seconds(form, s, ladder_data) for _ in range(repeats)) for s in (one, many))
            seconds[rung.name] = (call, table / TIMED)
    return {rung: (float(f"{alone:.2g}"), float(f"{each:.2g}")) for rung, (alone, each) in seconds.items()}


def _seconds(form: Callable[[HingeSection, dict], Array], s: HingeSection, ladder_data: dict) -> float:
    start = time.perf_counter()
    form(s, ladder_data)
    return time.perf_counter() - start


def _measured(
    columns: Columns, errors: Errors, inside: np.ndarray, clock: dict[str, tuple[float, float]]
) -> dict:
    """A zone's largest errors, the errors promised for it, and the seconds of an element."""
    worst, counts, seconds = {}, {}, {}
    for candidate in CANDIDATES:
        # few designs are solved on refined meshes: every zone uses those of all zones
        e = errors[candidate.name][inside] if candidate.mesh is None else errors[candidate.name]
        e = e[np.isfinite(e)]
        worst[candidate.name] = float(f"{e.max():.3g}")
        counts[candidate.name] = (
            len(e) if candidate.mesh else int(np.isfinite(errors["fem-plane"][inside]).sum())
        )
        closed = clock.get(candidate.name)
        seconds[candidate.name] = closed[1] if closed else _median(candidate, columns, inside)
    own = worst["fem-solid, mesh 3"]  # possible error of the reference itself
    promised = {c.name: _rounded_up(_margin(c, counts[c.name]) * (worst[c.name] + own)) for c in CANDIDATES}
    return {"designs": counts, "worst": worst, "promised": promised, "seconds": seconds}


def _margin(candidate: Candidate, count: int) -> float:
    if candidate.mesh:
        return MARGIN_OF_REFINED
    return MARGIN if count >= FEW else MARGIN_OF_FEW


def _rounded_up(value: float) -> float:
    """To two digits, upwards."""
    step = 10.0 ** (math.floor(math.log10(value)) - 1)
    return float(f"{math.ceil(value / step - 1e-9) * step:.2g}")


def _median(candidate: Candidate, columns: Columns, inside: np.ndarray) -> float:
    """Of the zone's designs, or of all where none of the zone was timed."""
    seconds = columns[SECONDS[candidate.name]]
    timed = seconds[inside] if np.isfinite(seconds[inside]).any() else seconds
    return float(f"{np.nanmedian(timed):.2g}")
