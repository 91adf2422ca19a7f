"""What every hinge bears when the overload force stands on one element and its stop has closed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactcad.mechanics import ladder, strain, strength
from tactcad.mechanics.stop import equivalent_force

from .hinge_section import design_alloy, hinge_section
from .layout import ElementPlace, Layout
from .stop_gap import stop_gap


@dataclass(frozen=True)
class Overload:
    """One element under the overload force, its stop's gap as large as the tolerance lets it be.

    Forces in N, stress in MPa at the fillet. `refused` says why the estimator has nothing to say; then the
    numbers are NaN.
    """

    place: ElementPlace
    gap: float  # mm, tolerance included
    closing_force: float
    stress: float
    yield_factor: float
    rated_force: float
    refused: str = ""


def overloads(layout: Layout) -> list[Overload]:
    """Every element of the layout, by number."""
    design, places = layout.design, layout.elements
    s, alloy = hinge_section(layout, places), design_alloy(design)
    known = ladder.evaluate(s, ladder.DEFAULT_RUNG)
    arm = np.array([p.arm for p in places])
    gap = np.array([stop_gap(layout, p) for p in places]) + design.stop.tolerance
    # the rigid arm's lever carries the gap at the tip to the load line
    closing = np.minimum(known.stiffness * gap * s.load_arm / arm, design.rating.overload_force)
    beyond = design.rating.overload_force - closing
    stress, rated = (np.full(s.shape, np.nan) for _ in range(2))
    ok = known.valid
    if ok.any():
        reached = s.rows(ok)
        bent_by = closing[ok] + equivalent_force(reached, known.stiffness[ok], arm[ok], beyond[ok])
        stress[ok] = strain.peak_stress(reached, bent_by)
        rated[ok] = strength.rated_force(reached, alloy, design.rating.force)
    return [
        Overload(
            p, float(gap[i]), float(closing[i]), float(stress[i]), float(alloy.yield_strength / stress[i]),
            float(rated[i]), str(known.reason[i]),
        )
        for i, p in enumerate(places)
    ]  # fmt: skip
