"""Stiffness, strain and strength of the elements as made: estimates from measured and from nominal
dimensions.

The intervals are for 95 %. The half-width of each dimension is propagated through the estimator by itself,
and
the results are put together (`as_built.together`). A dimension that was not measured lies anywhere within its
tolerance in the design's [tolerance]; the half-width of one that was is two standard deviations (k = 2), zero
if no uncertainty is given. A load arm that
was not measured itself follows from arm and pad where both were. What the sheet does not ask for (modulus of
the lot, recast layer, clamp) enters with its tolerance. The model's own error is not included.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from math import hypot
from typing import Any

import numpy as np

from tactcad.design.fields import present
from tactcad.design.tree import Design
from tactcad.mechanics.as_built import in_clamp, together, without_layer
from tactcad.mechanics.section import Array, HingeSection
from tactcad.parts.array.hinge_section import hinge_section
from tactcad.parts.array.layout import Layout
from tactcad.report.figures import Figure, aligned

from .array_estimate import ELEMENT, ElementEstimate, by_closed_form, material_lines, material_record
from .inspection_sheet import Reading

NO, ARM, K, STRAIN, RATED = ELEMENT.some("number", "arm", "stiffness", "gauge_strain", "rated_force")
COLUMNS = (
    (NO.heading, NO.unit),
    (ARM.heading, ARM.unit),
    ("t", "mm"),
    (K.heading, K.unit),
    *((heading, K.unit) for heading in ("from", "to", "nominal")),
    ("as made", "%"),
    (STRAIN.heading, STRAIN.unit),
    ("nominal", STRAIN.unit),
    (RATED.heading, RATED.unit),
    *((heading, RATED.unit) for heading in ("from", "to", "nominal")),
)
INTERVALS = ("stiffness", "gauge_strain", "yield_force")


@dataclass(frozen=True)
class AsMade:
    """One element, estimated from the design's dimensions and from its measured ones."""

    number: int
    nominal: ElementEstimate
    made: ElementEstimate
    # low and high of `made`'s stiffness, gauge_strain, yield_force, rated_force; None if the value is None
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
    known = {
        name: np.array([r is not None and r.measured is not None for r in table[name]]) for name in halves
    }
    section = _rounded(designed.with_(**values))
    nominal = by_closed_form(layout, layout.elements, designed, rung, force)
    made = by_closed_form(layout, layout.elements, section, rung, force)
    half_widths = _half_widths(layout, section, halves, known, rung, force)
    return [
        AsMade(p.number, nominal[i], made[i], _intervals(layout, made[i], half_widths[:, i]), of[p.number])
        for i, p in enumerate(layout.elements)
    ]


def _rounded(section: HingeSection) -> HingeSection:
    """No fillet is rounder than half its slot: a full round has no radius of its own."""
    return section.with_(fillet_radius=np.minimum(section.fillet_radius, section.hinge_length / 2))


def _entering(readings: Sequence[Reading]) -> dict[str, Reading]:
    """One element's readings by the parameter that they set; a blank load arm follows from arm and pad."""
    named = {r.dimension.name: r for r in readings}
    arm, pad = named["arm length"], named["pad length"]
    load = named["load arm"]
    if load.measured is None and arm.measured is not None and pad.measured is not None:
        known = (arm.uncertainty or 0.0, (pad.uncertainty or 0.0) / 2)
        load = replace(load, measured=arm.measured - pad.measured / 2, uncertainty=hypot(*known))
    return {r.dimension.enters: r for r in (*readings, load) if r.dimension.enters}


def _value(r: Reading | None, drawn: float) -> float:
    """mm; as drawn if there is no such dimension, or it was not measured."""
    return drawn if r is None or r.measured is None else r.measured


def _half_width(r: Reading | None) -> float:
    if r is None:
        return 0.0
    if r.measured is None:
        return (r.dimension.upper - r.dimension.lower) / 2
    return r.uncertainty or 0.0


def _half_widths(
    layout: Layout,
    section: HingeSection,
    halves: dict[str, Array],
    known: dict[str, np.ndarray],
    rung: str,
    force: float,
) -> Array:
    """Half-widths of the estimates in INTERVALS, shape (len(INTERVALS), elements).

    A dimension contributes half the difference between the estimates with it at either end of its half-width.
    """
    tolerance = layout.design.tolerance
    unmeasured = {"youngs_modulus": tolerance.youngs_modulus * section.youngs_modulus}
    if "fillet_radius" in halves:  # no rounder than the slot
        halves = halves | {"fillet_radius": np.minimum(halves["fillet_radius"], section.straight_length / 2)}

    def at(moved: HingeSection) -> Array:
        rows = by_closed_form(layout, layout.elements, _rounded(moved), rung, force)
        # None becomes NaN
        return np.array([[getattr(row, name) for row in rows] for name in INTERVALS], dtype=float)

    limits, measured = [], []
    for dimension, half in (halves | unmeasured).items():
        middle = getattr(section, dimension)
        low, high = (at(section.with_(**{dimension: middle + sign * half})) for sign in (-1.0, 1.0))
        read = known.get(dimension, np.zeros(len(layout.elements), bool))
        limits.append(np.where(read, 0.0, (high - low) / 2))
        measured.append(np.where(read, (high - low) / 2, 0.0))
    made = at(section)
    limits.append(at(without_layer(section, tolerance.recast_layer)) - made)
    K = made[INTERVALS.index("stiffness")]
    turned = np.zeros_like(made)
    turned[INTERVALS.index("stiffness")] = K - in_clamp(section, K, tolerance.clamp_compliance)
    return together([*limits, turned], measured)


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


def report(design: Design, rung: str, rows: Sequence[AsMade]) -> str:
    """A table of the elements; below it, dimensions outside their tolerance, undecided ones, those that were
    not measured, and elements above yield."""
    lines = [
        f"{design.name} {design.design.revision} as made, {design.material.alloy}, rung {rung}, "
        f"{rows[0].made.force:g} N on each pad; from and to: 95 %, without the model's error",
        *aligned([*zip(*COLUMNS), *map(_cells, rows)]),
    ]
    lines += material_lines(design, [row.made.stiffness for row in rows])
    readings = [r for row in rows for r in row.readings]
    outside, undecided = ([r for r in readings if r.verdict == v] for v in ("outside", "undecided"))
    lines += [f"outside its tolerance: {_reading_text(r)}" for r in outside]
    lines += [f"undecided, the uncertainty reaches across a limit: {_reading_text(r)}" for r in undecided]
    lines += _missing(readings)
    if plastic := ", ".join(str(row.number) for row in rows if not row.made.elastic):
        lines.append(f"invalid: above yield at this force as made: no. {plastic}")
    return "\n".join(lines)


def _cells(row: AsMade) -> list[str]:
    made, nominal = row.made, row.nominal
    t = next(r for r in row.readings if r.dimension.enters == "hinge_thickness")

    def ranged(figure: Figure) -> list[str]:
        ends = [figure.written(end) for end in present(row.intervals[figure.name])]
        return [figure.text(made), *ends, figure.text(nominal)]

    return [
        NO.text(row),
        ARM.text(made),
        "blank" if t.measured is None else f"{t.measured:g}",
        *ranged(K),
        f"{made.stiffness / nominal.stiffness - 1:+.1%}".removesuffix("%"),
        STRAIN.text(made, "invalid"),
        STRAIN.text(nominal, "invalid"),
        *ranged(RATED),
    ]


def _reading_text(r: Reading) -> str:
    d = r.dimension
    spread = "" if r.uncertainty is None else f" +-{r.uncertainty:g}"
    return f"no. {r.number}, {d.name} {r.measured:g}{spread}, {d.lower:g} to {d.upper:g} mm (line {r.line})"


def _missing(readings: Sequence[Reading]) -> list[str]:
    """A line for each dimension that was left blank, or measured without an uncertainty, on any element."""
    lines = []
    for name in dict.fromkeys(r.dimension.name for r in readings):
        named = [r for r in readings if r.dimension.name == name]
        blank = [r for r in named if r.measured is None]
        bare = [r for r in named if r.measured is not None and r.uncertainty is None]
        used = "nominal, with its tolerance" if named[0].dimension.enters else "not judged"
        if blank:
            lines.append(f"not measured: {name}, {_which(blank, named)}: {used}")
        if bare and named[0].dimension.enters:
            lines.append(f"no uncertainty given: {name}, {_which(bare, named)}: taken as exact")
    return lines


def _which(some: Sequence[Reading], all_: Sequence[Reading]) -> str:
    return "every element" if len(some) == len(all_) else "no. " + ", ".join(str(r.number) for r in some)


def document(design: Design, rung: str, rows: Sequence[AsMade]) -> dict[str, Any]:
    """The record for JSON: elements with the fields of `tactcad estimate --json` as made, their `nominal`
    estimates and `intervals` (95 %), and every reading."""
    readings = [r for row in rows for r in row.readings]
    return {
        "design": design.name,
        "revision": design.design.revision,
        "model": rung,
        "alloy": design.material.alloy,
        "force_N": rows[0].made.force,
        "units": {"length": "mm", "force": "N", "stiffness": "N/mm", "stress": "MPa", "strain": "1"},
        "elements": [
            {**asdict(row.made), "nominal": asdict(row.nominal), "intervals": row.intervals} for row in rows
        ],
        "readings": [_record(r) for r in readings],
        **{v: sum(r.verdict == v for r in readings) for v in ("inside", "outside", "undecided", "blank")},
        **material_record(design),
    }


def _record(r: Reading) -> dict[str, Any]:
    drawn = {name: getattr(r.dimension, name) for name in ("key", "nominal", "lower", "upper")}
    read = {name: getattr(r, name) for name in ("measured", "uncertainty", "verdict", "line")}
    return {"number": r.number, "characteristic": r.dimension.name, **drawn, **read}
