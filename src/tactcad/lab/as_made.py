"""Stiffness, strain and strength of the elements as made: estimates from measured dimensions, beside those
from the nominal ones.

The intervals are for 95 %. The half-width (k = 2) of each dimension is propagated through the estimator by
itself, and the results are added as squares. The half-width of a dimension that was not measured is its
tolerance in the design's [tolerance]; that of one measured without an uncertainty is zero. A load arm that
was not measured itself follows from arm and pad where both were. What the sheet does not ask for (modulus of
the lot, recast layer, clamp) enters with its tolerance. The model's own error is not included.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import hypot

import numpy as np

from tactcad.design.present import present
from tactcad.mechanics.as_built import in_clamp, without_layer
from tactcad.mechanics.section import Array, HingeSection
from tactcad.parts.hinge_section import hinge_section
from tactcad.parts.layout import Layout

from .array_estimate import ElementEstimate, estimate_sections
from .inspection_sheet import Reading

INTERVALS = ("stiffness", "gauge_strain", "yield_force")


@dataclass(frozen=True)
class AsMade:
    """One element, estimated from the design's dimensions and from its measured ones."""

    number: int
    nominal: ElementEstimate
    made: ElementEstimate
    # low and high of `made`'s stiffness, gauge_strain, yield_force, rated_force; None where the value is None
    intervals: dict[str, tuple[float, float] | None]
    readings: tuple[Reading, ...]


def as_made(
    layout: Layout, readings: Sequence[Reading], rung: str, force: float | None = None
) -> list[AsMade]:
    """Estimates of every element as designed and as made.

    Parameters
    ----------
    layout : Layout
    readings : sequence of Reading
        Every dimension of every element, as `read_sheet` gives them.
    rung : str
        A closed form of the ladder.
    force : float, optional
        On each pad, N; by default the design's rating.

    Returns
    -------
    list of AsMade
        In the order of the layout's elements.

    Raises
    ------
    CheckFailure
        An element, as designed or as made, lies outside the rung's range.
    """
    force = layout.design.rating.force if force is None else force
    designed = hinge_section(layout, layout.elements)
    of = {p.number: tuple(r for r in readings if r.number == p.number) for p in layout.elements}
    entering = {number: _entering(own) for number, own in of.items()}
    parameters = list(dict.fromkeys(r.dimension.enters for r in readings if r.dimension.enters))
    table = {name: [entering[p.number].get(name) for p in layout.elements] for name in parameters}
    drawn = {name: np.broadcast_to(getattr(designed, name), designed.shape) for name in parameters}
    values = {name: np.array([_value(r, n) for r, n in zip(table[name], drawn[name])]) for name in parameters}
    halves = {name: np.array([_half_width(r) for r in column]) for name, column in table.items()}
    section = _rounded(designed.with_(**values))
    nominal = estimate_sections(layout, designed, rung, force)
    made = estimate_sections(layout, section, rung, force)
    half_widths = _half_widths(layout, section, halves, rung, force)
    return [
        AsMade(p.number, nominal[i], made[i], _intervals(layout, made[i], half_widths[:, i]), of[p.number])
        for i, p in enumerate(layout.elements)
    ]


def _rounded(section: HingeSection) -> HingeSection:
    """No fillet is rounder than half its slot: a full round has no radius of its own."""
    return section.with_(fillet_radius=np.minimum(section.fillet_radius, section.hinge_length / 2))


def _entering(readings: Sequence[Reading]) -> dict[str, Reading]:
    """One element's readings by the parameter that they set; the load arm's from arm and pad where it is
    blank."""
    named = {r.dimension.name: r for r in readings}
    arm, pad = named["arm length"], named["pad length"]
    load = named["load arm"]
    if load.measured is None and arm.measured is not None and pad.measured is not None:
        known = (arm.uncertainty or 0.0, (pad.uncertainty or 0.0) / 2)
        load = replace(load, measured=arm.measured - pad.measured / 2, uncertainty=hypot(*known))
    return {r.dimension.enters: r for r in (*readings, load) if r.dimension.enters}


def _value(r: Reading | None, drawn: float) -> float:
    """mm; as drawn where there is no such dimension, or it was not measured."""
    return drawn if r is None or r.measured is None else r.measured


def _half_width(r: Reading | None) -> float:
    if r is None:
        return 0.0
    if r.measured is None:
        return (r.dimension.upper - r.dimension.lower) / 2
    return r.uncertainty or 0.0


def _half_widths(
    layout: Layout, section: HingeSection, halves: dict[str, Array], rung: str, force: float
) -> Array:
    """Half-widths of the estimates in INTERVALS, shape (len(INTERVALS), elements).

    A dimension contributes half the difference between the estimates with it at either end of its half-width.
    """
    tolerance = layout.design.tolerance
    unmeasured = {"youngs_modulus": tolerance.youngs_modulus * section.youngs_modulus}
    if "fillet_radius" in halves:  # no rounder than the slot
        halves = halves | {"fillet_radius": np.minimum(halves["fillet_radius"], section.straight_length / 2)}

    def at(moved: HingeSection) -> Array:
        rows = estimate_sections(layout, _rounded(moved), rung, force)
        # None becomes NaN
        return np.array([[getattr(row, name) for row in rows] for name in INTERVALS], dtype=float)

    squares = np.zeros((len(INTERVALS), len(layout.elements)))
    for dimension, half in (halves | unmeasured).items():
        low, high = (
            at(section.with_(**{dimension: getattr(section, dimension) + sign * half}))
            for sign in (-1.0, 1.0)
        )
        squares += ((high - low) / 2) ** 2
    made = at(section)
    squares += (at(without_layer(section, tolerance.recast_layer)) - made) ** 2
    K = made[INTERVALS.index("stiffness")]
    squares[INTERVALS.index("stiffness")] += (K - in_clamp(section, K, tolerance.clamp_compliance)) ** 2
    return np.sqrt(squares)


def _intervals(
    layout: Layout, made: ElementEstimate, half_widths: Array
) -> dict[str, tuple[float, float] | None]:
    intervals: dict[str, tuple[float, float] | None] = {}
    for name, half in zip(INTERVALS, half_widths.tolist()):
        value = getattr(made, name)
        intervals[name] = None if value is None or half != half else (value - half, value + half)
    safety = layout.design.rating.yield_factor
    low, high = present(intervals["yield_force"])
    intervals["rated_force"] = (min(made.force, low / safety), min(made.force, high / safety))
    return intervals
