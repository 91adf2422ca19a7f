"""The overload stop's gap at an arm's tip, from the estimator, and the load on every hinge once it has
closed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import floor, hypot, sqrt

import numpy as np

from tactcad.design.materials import ALLOYS
from tactcad.mechanics import ladder, strain, strength, validity
from tactcad.mechanics.section import HingeSection
from tactcad.mechanics.strength import (
    deflection_share,
    largest_closing_force,
    largest_overload,
    overload_stress,
    stop_share,
    tip_compliance,
)

from ..bought.standard_parts import dowel_diameter
from .clamp import STOP_PLATE_FLAT, lean
from .hinge_section import design_alloy, hinge_section, in_design, own_parameters, shared_parameters
from .layout import ElementPlace, HingeShape, Layout

# Gaps are cut in steps of half their usual tolerance; below ten of them, finer.
STEP_MM = 0.005
# Least height (mm) of the ramp's straight edge: a shorter one is no longer an edge to wire and CAD kernel.
STRAIGHT_RAMP = 0.005


@dataclass(frozen=True)
class StopLimit:
    """The widest gap that an element's stop may have, and the largest overload that any gap protects from."""

    gap: float  # mm at the tip, as made: it keeps the hinge within its rated deflection
    overload: float  # N, with the narrowest gap worth cutting: its tolerance both ways and a step


def stop_gap(layout: Layout, place: ElementPlace) -> float:
    """Gap between stop land and stop plate at the arm's tip.

    Parameters
    ----------
    layout : Layout
    place : ElementPlace
        One of its elements.

    Returns
    -------
    float
        mm. The value of [stop.gaps] if it lists the arm; else, rounded down to a step, the widest that with
        its tolerance keeps the hinge within its rated deflection under the overload force (`stop_limit`) and
        leaves a land under the ledge (`land_room`).
    """
    stop = layout.design.stop
    if stop.gaps and place.arm in stop.gaps:
        return stop.gaps[place.arm]
    closing = stop_limit(layout, place).gap - stop.tolerance - seat(layout)
    widest = min(closing, land_room(layout, place.hinge))
    step = STEP_MM if widest >= 10 * STEP_MM else STEP_MM / 10
    return round(floor(widest / step + 1e-9) * step, 6)


def unrated_gap(layout: Layout, place: ElementPlace) -> tuple[str, ...]:
    """A note for the element's sheet if its gap does not follow from its rating: its row of strength.csv is
    blank, since it is out of the estimator's range. No note if [stop.gaps] lists the arm."""
    if layout.design.stop.gaps and place.arm in layout.design.stop.gaps:
        return ()
    (why,) = validity.first_broken(hinge_section(layout, (place,)), ladder.DEFAULT_RUNG)
    if why is None:
        return ()
    return (
        "stop gap not rated, ask before cutting: the estimator does not reach this element: "
        + in_design(why, layout, place),
    )


def seat(layout: Layout) -> float:
    """Largest height of the stop plate above an element's own ledge at its land, mm.

    Other ledges at their upper limit, this one at its lower; the plate's flatness; and gaps of some pads to
    the surface plate, once their heights and the pins' lean use up the dowels' play.
    """
    d = layout.design
    t, h = d.tolerance, d.holes
    # a hole smaller than its dowel is refused for that, not for the gap
    play = max(0.0, h.dowel_hole + h.dowel_hole_upper / 2 - dowel_diameter(d.clamp.dowel))
    off = max(0.0, hypot(t.pad_height, lean(layout) / 2) - play / 2)
    return round(2.0 * t.ledge + STOP_PLATE_FLAT + 1.5 * off, 6)


def stop_limit(layout: Layout, place: ElementPlace, give: float | None = None) -> StopLimit:
    """The limits of an element's stop, at the hinge's rated deflection.

    That is d_y/rating.deflection_factor, with d_y the deflection at which the fillet yields, converted from
    the load line to the tip (`tip_compliance`). The stiffness is the solid rung's; beyond the range of its
    fit it is the section integral's, which has no range and errs to a narrower gap: where both hold, it is
    0.93 to 3.8 times as stiff, 1.02 in the median (20 000 random designs).

    Parameters
    ----------
    layout : Layout
    place : ElementPlace
        One of its elements.
    give : float, optional
        Compliance of the stop, mm/N; by default that of the stop plate's beams.

    Returns
    -------
    StopLimit
    """
    design = layout.design
    own = own_parameters(place.hinge, place.load_arm, place.body_length)
    parameters = own | shared_parameters(design)
    return _limit(
        tuple(parameters.items()),
        place.arm,
        design.material.yield_strength / design.rating.deflection_factor,
        design.rating.overload_force,
        2.0 * design.stop.tolerance + seat(layout) + STEP_MM,
        layout.stop_give if give is None else give,
    )


def land_room(layout: Layout, hinge: HingeShape) -> float:
    """Largest gap that leaves a stop land over the arm: ledge less arm and the ramp's least height, mm.

    The ramp rises at 45 degrees from a foot rounded by corner_radius, whose tangent length is
    r tan(22.5 deg); along the ramp's height that is r (sqrt 2 - 1)/sqrt 2.
    """
    ramp = layout.design.element.corner_radius * (sqrt(2.0) - 1.0) / sqrt(2.0)
    return layout.ledge_of(hinge) - hinge.h - ramp - STRAIGHT_RAMP


@lru_cache(maxsize=4096)  # equal elements of a long row ask for the same gap
def _limit(
    parameters: tuple[tuple[str, float], ...],
    arm: float,
    stress: float,
    overload: float,
    narrowest: float,
    give: float,
) -> StopLimit:
    """`stop_limit` of the section with these parameters, whose fillet may have `stress` (MPa)."""
    section = HingeSection.of(**dict(parameters))
    fitted = ladder.evaluate(section, "solid")
    K = fitted.stiffness if fitted.valid else ladder.stiffness(section, "section")
    length = np.array(arm)
    rated = stress / strain.stress_beyond_the_fit(section, 1.0)
    closing = largest_closing_force(section, K, length, give, overload, rated)
    tip = tip_compliance(section, K, length)
    narrow = narrowest / tip
    most = largest_overload(section, K, length, give, narrow, rated)
    return StopLimit(float(closing * tip), float(most))


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
    endured           N at the pad, put on and off, that it bears as often as the fatigue strength holds
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
    endured: float
    refused: str = ""

    @property
    def measurable(self) -> float:
        """N at the pad up to which it measures: rated, and before its stop can close."""
        return min(self.rated_force, self.earliest)


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
    stress = overload_stress(s, K, arm, give, closing, load)
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
        "endured": strength.goodman(alloy, alloy.yield_strength / yields),
    }
    by_name = {name: np.broadcast_to(column, s.shape).tolist() for name, column in figures.items()}
    return [
        Overload(
            place,
            **{name: column[i] for name, column in by_name.items()},
            refused=in_design(known.broken[i], layout, place),
        )
        for i, place in enumerate(places)
    ]


def endurance(layout: Layout, states: Sequence[Overload]) -> str:
    """Endured forces of the elements with finite life at their rated force; "" if there are none."""
    tired = [state for state in states if state.endured < state.rated_force]
    if not tired:
        return ""
    row = ALLOYS.get(layout.design.material.alloy)
    known = row and row.fatigue_cycles
    cycles = f"{known:.0e}".replace("e+0", "e") if known else "the fatigue strength's"
    return (
        f"finite life at the rated force (Goodman factor below 1); {cycles} cycles are borne up to "
        + by_force(tired, lambda state: state.endured)
    )


def reach(states: Sequence[Overload]) -> str:
    """Measuring limit of each element whose stop may close below the rated force; "" if none may."""
    if not any(state.earliest < state.rated_force for state in states):
        return ""
    return "a stop may close below the rated force; measures up to " + by_force(
        states, lambda s: s.measurable
    )


def by_force(states: Sequence[Overload], force: Callable[[Overload], float]) -> str:
    """ "1.2 N (E1, E8), 0.9 N (E4)": elements by force, the largest first."""
    groups: dict[str, list[str]] = {}
    for state in sorted(states, key=force, reverse=True):
        groups.setdefault(f"{force(state):.3g} N", []).append(state.place.designator)
    return ", ".join(f"{value} ({', '.join(names)})" for value, names in groups.items())
