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
from tactcad.mechanics import ladder, strain, strength
from tactcad.mechanics.section import Array
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
from .hinge_section import arms, design_alloy, hinges, in_design
from .layout import ElementPlace, HingeShape, Layout

# Gaps are cut in steps of half their usual tolerance; below ten of them, finer.
STEP_MM = 0.005
# Least height (mm) of the ramp's straight edge: a shorter one is no longer an edge to wire and CAD kernel.
STRAIGHT_RAMP = 0.005


@dataclass(frozen=True)
class StopLimits:
    """The widest gap that each element's stop may have, and the largest overload that a gap protects from."""

    gap: Array  # mm at the tip, as made: it keeps the hinge within its rated deflection
    overload: Array  # N, with the narrowest gap worth cutting: its tolerance both ways and a step


def stop_gap(layout: Layout, place: ElementPlace) -> float:
    """Gap between stop land and stop plate at the tip of one of the layout's arms, mm: of `stop_gaps`."""
    return stop_gaps(layout)[place.number - 1]


@lru_cache(maxsize=16)
def stop_gaps(layout: Layout) -> tuple[float, ...]:
    """Gap between stop land and stop plate at every arm's tip, by number, mm.

    The value of [stop.gaps] if it lists the arm; else, rounded down to a step, the widest that with its
    tolerance keeps the hinge within its rated deflection under the overload force (`stop_limits`) and leaves
    a land under the ledge (`land_room`).
    """
    stop, gaps, given = layout.design.stop, [], layout.design.stop.gaps or {}
    for place in layout.elements:
        if place.arm in given:
            gaps.append(given[place.arm])
            continue
        closing = float(stop_limits(layout).gap[place.number - 1]) - stop.tolerance - seat(layout)
        widest = min(closing, land_room(layout, place.hinge))
        step = STEP_MM if widest >= 10 * STEP_MM else STEP_MM / 10
        gaps.append(round(floor(widest / step + 1e-9) * step, 6))
    return tuple(gaps)


def unrated_gap(layout: Layout, place: ElementPlace) -> tuple[str, ...]:
    """A note for the element's sheet if its gap does not follow from its rating: its row of strength.csv is
    blank, since it is out of the estimator's range. No note if [stop.gaps] lists the arm."""
    if layout.design.stop.gaps and place.arm in layout.design.stop.gaps:
        return ()
    why = hinges(layout).broken[place.number - 1]
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


@lru_cache(maxsize=16)
def stop_limits(layout: Layout, give: float | None = None) -> StopLimits:
    """The limits of every element's stop, by number, at the hinge's rated deflection.

    That is d_y/rating.deflection_factor, with d_y the deflection at which the fillet yields, converted from
    the load line to the tip (`tip_compliance`). Beyond the range of the fit the stiffness errs to a narrower
    gap (`ladder.stiffness_beyond_the_fit`).

    Parameters
    ----------
    layout : Layout
    give : float, optional
        Compliance of the stop, mm/N; by default that of the stop plate's beams.

    Raises
    ------
    CheckFailure
        If an element has no hinge.
    """
    d = layout.design
    s, arm, overload = hinges(layout).section, arms(layout), d.rating.overload_force
    ladder.require_range(s, "section")
    K, give = ladder.stiffness_beyond_the_fit(s), layout.stop_give if give is None else give
    rated = d.material.yield_strength / d.rating.deflection_factor / strain.stress_beyond_the_fit(s, 1.0)
    tip = tip_compliance(s, K, arm)
    narrowest = 2.0 * d.stop.tolerance + seat(layout) + STEP_MM
    return StopLimits(
        largest_closing_force(s, K, arm, give, overload, rated) * tip,
        largest_overload(s, K, arm, give, narrowest / tip, rated),
    )


def land_room(layout: Layout, hinge: HingeShape) -> float:
    """Largest gap that leaves a stop land over the arm: ledge less arm and the ramp's least height, mm.

    The ramp rises at 45 degrees from a foot rounded by corner_radius, whose tangent length is
    r tan(22.5 deg); along the ramp's height that is r (sqrt 2 - 1)/sqrt 2.
    """
    ramp = layout.design.element.corner_radius * (sqrt(2.0) - 1.0) / sqrt(2.0)
    return layout.ledge_of(hinge) - hinge.h - ramp - STRAIGHT_RAMP


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
    design, places, known = layout.design, layout.elements, hinges(layout)
    load, rating = design.rating.overload_force, design.rating
    s, K, yields, alloy, arm = (
        known.section,
        known.stiffness,
        known.yield_force,
        design_alloy(design),
        arms(layout),
    )
    gap, give = np.array(stop_gaps(layout)), layout.stop_give
    tip, tolerance = tip_compliance(s, K, arm), design.stop.tolerance
    largest = gap + tolerance + seat(layout)
    closing = np.minimum(largest / tip, load)
    beyond = load - closing
    # beyond the estimator's range K is NaN, and so are all figures but the gap
    stress = overload_stress(s, K, arm, give, closing, load)
    figures = {
        "gap": largest,
        "earliest": (gap - tolerance) / tip,
        "closing_force": closing,
        "stop_force": beyond * stop_share(s, K, arm, give),
        "deflection": (closing + deflection_share(s, K, arm, give) * beyond) / K,
        "rated_deflection": strength.rated_deflection(yields, K, rating),
        "stress": stress,
        "yield_factor": alloy.yield_strength / stress,
        "rated_force": strength.rated_force(yields, rating),
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
