"""Stiffness, strain and strength of the elements as made: estimates from measured dimensions, beside those
from the nominal ones.

The intervals are for 95 %. The half-width (k = 2) of each dimension is propagated through the estimator by
itself, and the results are added as squares. The half-width of a dimension that was not measured is its
tolerance in the design's [tolerance]; that of one measured without an uncertainty is zero. What the sheet
does not ask for (fillet radius, modulus of the lot, recast layer, clamp) enters with its tolerance. The
model's own error is not included.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

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
    parameters = list(dict.fromkeys(r.dimension.enters for r in readings if r.dimension.enters))
    table = {name: [_of_dimension(of[p.number], name) for p in layout.elements] for name in parameters}
    values = {name: np.array([_value(r) for r in column]) for name, column in table.items()}
    halves = {name: np.array([_half_width(r) for r in column]) for name, column in table.items()}
    section = designed.with_(**values)
    nominal = estimate_sections(layout, designed, rung, force)
    made = estimate_sections(layout, section, rung, force)
    half_widths = _half_widths(layout, section, halves, rung, force)
    return [
        AsMade(p.number, nominal[i], made[i], _intervals(layout, made[i], half_widths[:, i]), of[p.number])
        for i, p in enumerate(layout.elements)
    ]


def _of_dimension(readings: Sequence[Reading], enters: str) -> Reading:
    return next(r for r in readings if r.dimension.enters == enters)


def _value(r: Reading) -> float:
    return r.dimension.nominal if r.measured is None else r.measured


def _half_width(r: Reading) -> float:
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
    unmeasured = {
        "fillet_radius": np.minimum(tolerance.fillet_radius, section.straight_length / 2),
        "youngs_modulus": tolerance.youngs_modulus * section.youngs_modulus,
    }

    def at(moved: HingeSection) -> Array:
        rows = estimate_sections(layout, moved, rung, force)
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
