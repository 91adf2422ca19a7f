"""The overload stop's gap at an arm's tip, from the estimator."""

from __future__ import annotations

from functools import lru_cache
from math import floor, sqrt

from tactcad.mechanics import ladder
from tactcad.mechanics.section import HingeSection
from tactcad.mechanics.stop import largest_closing_force

from .layout import ElementPlace, HingeShape, Layout

# Gaps are cut to a hundredth: finer steps are below the tolerance that any stop can hold.
STEP_MM = 0.01
# The ramp keeps this height of straight edge: none shorter than a wire or the kernel tells from a point.
STRAIGHT_RAMP = 0.005


def stop_gap(layout: Layout, place: ElementPlace) -> float:
    """Gap between stop land and stop plate at the tip, mm.

    [stop.gaps] where it names the arm, else yield_fraction of the nominal deflection at yield,
    carried from the load line to the tip by the rigid arm's lever a/L and rounded to 0.01 mm (below 0.1 mm
    to 0.001), but no more than there is room for under the ledge, nor than the fillet bears when the overload
    force has closed the gap with its tolerance. Where no gap could save it, `tactcad check` says so.
    Nominal yield: 6 F L/(b t^2) = yield strength. Stiffness from the solid rung; beyond the range of its fit from
    the section integral, which has none and errs to a narrower gap: where both hold, it is 0.93 to 3.8 times as
    stiff, 1.02 in the median (20 000 random designs).
    """
    design = layout.design
    if design.stop.gaps and place.arm in design.stop.gaps:
        return design.stop.gaps[place.arm]
    wanted, bearable = _before_yield(
        place.hinge.t, place.hinge.l, place.hinge.r, place.hinge.h, place.arm, place.load_arm, place.body_length,
        design.element.body_height, design.sheet.thickness, design.element.sides == "two",
        design.material.youngs_modulus, design.material.poisson, design.material.yield_strength,
        design.stop.yield_fraction, design.rating.overload_force,
    )
    most = land_room(layout, place.hinge)
    spared = bearable - design.stop.tolerance
    if spared - _step(spared) >= design.stop.tolerance:  # rounded down it is still more than its tolerance
        most = min(most, spared)
    step = _step(min(wanted, most))
    steps = min(round(wanted / step), floor(most / step + 1e-9))
    return round(steps * step, 6)


def _step(gap: float) -> float:
    return STEP_MM if gap >= 10 * STEP_MM else STEP_MM / 10


def land_room(layout: Layout, hinge: HingeShape) -> float:
    """Largest gap that leaves a stop land over the arm: ledge less arm and the ramp's least height, mm.

    The ramp rises at 45 degrees from a foot rounded by corner_radius, whose tangent length is
    r tan(22.5 deg); along the ramp's height that is r (sqrt 2 - 1)/sqrt 2.
    """
    ramp = layout.design.element.corner_radius * (sqrt(2.0) - 1.0) / sqrt(2.0)
    return layout.ledge_of(hinge) - hinge.h - ramp - STRAIGHT_RAMP


@lru_cache(maxsize=4096)  # equal elements of a long row ask for the same gap
def _before_yield(
    t, l, r, h, a, L, Lb, Hb, b, two_sided, E, nu, yield_strength, fraction, overload
) -> tuple[float, float]:
    """The wanted gap, and the one that the overload force closes when the fillet is about to yield; mm at the tip."""
    section = HingeSection(t, l, r, L, h, Hb, Lb, nu, E, b, two_sided)
    fitted = ladder.evaluate(section, "solid")
    K = float(fitted.stiffness if fitted.valid else ladder.stiffness(section, "section"))
    nominal = yield_strength * b * t**2 / (6 * L) / K
    bearable = float(largest_closing_force(section, K, a, overload, yield_strength)) / K
    return fraction * nominal * a / L, bearable * a / L
