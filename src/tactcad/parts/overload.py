"""Load on every hinge when the overload force acts on its element alone and its stop has closed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactcad.mechanics import ladder, strain, strength
from tactcad.mechanics.stop import back_share, deflection_share, stop_share, stress_share, tip_compliance

from .hinge_section import design_alloy, hinge_section, in_design
from .layout import ElementPlace, Layout
from .stop_gap import seat, stop_gap


@dataclass(frozen=True)
class Overload:
    """One element under the overload force, its stop's gap as wide as limits make it.

    gap               mm as assembled, tolerance and the plate's seat included
    earliest          N at the pad that close the gap at the lower limit of its tolerance
    closing_force     N at the pad that close this gap
    stop_force        reaction of the stop under the whole load, N
    deflection        by which the hinge has then turned, mm at the load line
    rated_deflection  mm that no hinge may exceed
    stress            at the fillet, MPa
    yield_factor      yield strength over that stress
    rated_force       in use, N
    refused           why the estimator refuses the element; then the numbers are NaN
    """

    place: ElementPlace
    gap: float
    earliest: float
    closing_force: float
    stop_force: float
    deflection: float
    rated_deflection: float
    stress: float
    yield_factor: float
    rated_force: float
    refused: str = ""


def overloads(layout: Layout) -> list[Overload]:
    """Every element of the layout, by number."""
    design, places = layout.design, layout.elements
    load, rating = design.rating.overload_force, design.rating
    s, alloy = hinge_section(layout, places), design_alloy(design)
    known = ladder.evaluate(s, ladder.DEFAULT_RUNG)
    K, arm, tolerance = known.stiffness, np.array([p.arm for p in places]), design.stop.tolerance
    gap, give = np.array([stop_gap(layout, p) for p in places]), layout.stop_give
    tip = tip_compliance(s, K, arm)
    earliest = (gap - tolerance) / tip
    closing = np.minimum((gap + tolerance + seat(layout)) / tip, load)
    beyond = load - closing
    # beyond the estimator's range K is NaN, and so are all figures but the gap
    forwards = closing + stress_share(s, K, arm, give) * beyond
    stress = strain.stress_beyond_the_fit(s, np.maximum(forwards, back_share(s, K, arm, give) * beyond))
    yields = strength.yield_force_where_known(s, alloy)
    figures = {
        "gap": gap + tolerance + seat(layout),
        "earliest": earliest,
        "closing_force": closing,
        "stop_force": beyond * stop_share(s, K, arm, give),
        "deflection": (closing + deflection_share(s, K, arm, give) * beyond) / K,
        "rated_deflection": yields / rating.deflection_factor / K,
        "stress": stress,
        "yield_factor": alloy.yield_strength / stress,
        "rated_force": np.minimum(rating.force, yields / rating.yield_factor),
    }
    by_name = {name: np.broadcast_to(column, s.shape).tolist() for name, column in figures.items()}
    return [
        Overload(
            place,
            **{name: column[i] for name, column in by_name.items()},
            refused=in_design(str(known.reason[i]), layout, place),
        )
        for i, place in enumerate(places)
    ]
