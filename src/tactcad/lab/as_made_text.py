"""The elements as made, as a table for people and as plain data for JSON."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from tactcad.design.present import present
from tactcad.design.tree import Design

from . import material_text
from .as_made import AsMade
from .inspection_sheet import Reading

HEADINGS = (
    ("no.", ""),
    ("arm", "mm"),
    ("t", "mm"),
    ("K", "N/mm"),
    ("from", "N/mm"),
    ("to", "N/mm"),
    ("nominal", "N/mm"),
    ("as made", "%"),
    ("strain gauge", "1e-6"),
    ("nominal", "1e-6"),
    ("rated", "N"),
    ("from", "N"),
    ("to", "N"),
    ("nominal", "N"),
)
THICKNESS = "hinge thickness"


def report(design: Design, rung: str, rows: Sequence[AsMade]) -> str:
    """A table of the elements; below it, dimensions outside their tolerance, undecided ones, those that were
    not measured, and elements above yield."""
    cells = [[h for h, _ in HEADINGS], [u for _, u in HEADINGS], *map(_cells, rows)]
    widths = [max(len(line[i]) for line in cells) for i in range(len(HEADINGS))]
    lines = [
        f"{design.name} {design.design.revision} as made, {design.material.alloy}, rung {rung}, "
        f"{rows[0].made.force:g} N on each pad; from and to: 95 %, without the model's error",
        *("  ".join(cell.rjust(width) for cell, width in zip(line, widths)).rstrip() for line in cells),
    ]
    lines += material_text.lines(design, [row.made.stiffness for row in rows])
    readings = [r for row in rows for r in row.readings]
    outside, undecided = ([r for r in readings if r.verdict == v] for v in ("outside", "undecided"))
    lines += [f"outside its tolerance: {_said(r)}" for r in outside]
    lines += [f"undecided, the uncertainty reaches across a limit: {_said(r)}" for r in undecided]
    return "\n".join(lines + _missing(readings) + _plastic(rows))


def _cells(row: AsMade) -> list[str]:
    made, nominal, intervals = row.made, row.nominal, row.intervals
    t = next(r for r in row.readings if r.dimension.name == THICKNESS)
    micro = lambda value: "invalid" if value is None else f"{1e6 * value:.0f}"  # noqa: E731
    return [
        str(row.number),
        f"{made.arm:g}",
        "blank" if t.measured is None else f"{t.measured:g}",
        *(f"{value:.4g}" for value in (made.stiffness, *present(intervals["stiffness"]), nominal.stiffness)),
        f"{made.stiffness / nominal.stiffness - 1:+.1%}".removesuffix("%"),
        micro(made.gauge_strain),
        micro(nominal.gauge_strain),
        *(
            f"{value:.3g}"
            for value in (made.rated_force, *present(intervals["rated_force"]), nominal.rated_force)
        ),
    ]


def _said(r: Reading) -> str:
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


def _plastic(rows: Sequence[AsMade]) -> list[str]:
    numbers = ", ".join(str(row.number) for row in rows if not row.made.elastic)
    return [f"invalid: above yield at this force as made: no. {numbers}"] if numbers else []


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
        **material_text.record(design),
    }


def _record(r: Reading) -> dict[str, Any]:
    d = r.dimension
    return {
        "number": r.number,
        "characteristic": d.name,
        "key": d.key,
        "nominal": d.nominal,
        "lower": d.lower,
        "upper": d.upper,
        "measured": r.measured,
        "uncertainty": r.uncertainty,
        "verdict": r.verdict,
        "line": r.line,
    }
