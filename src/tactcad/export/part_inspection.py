"""What to measure on parts other than the numbered elements: every limit on which a requirement of the
assembled sensor depends, those with the largest share of a requirement's variance first.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping, Sequence

from tactcad.assembly.stack import StackLine
from tactcad.assembly.variables import DimensionLimits
from tactcad.design.tree import Design
from tactcad.parts.description import Part

from .inspection import UNIT

COLUMNS = (
    "design",
    "revision",
    "part_no",
    "characteristic",
    "nominal",
    "lower",
    "upper",
    "unit",
    "measured",
    "uncertainty_k2",
    "where",
    "requirement",
    "share",
)


def part_inspection_bytes(
    design: Design,
    parts: Iterable[Part],
    variables: Mapping[str, DimensionLimits],
    lines: Sequence[StackLine],
) -> bytes:
    """The sheet (RFC 4180, UTF-8).

    Parameters
    ----------
    design, parts
        The design, and the parts of its scenes.
    variables, lines
        Its variables, and the stack of every requirement.
    """
    text = io.StringIO(newline="")
    writer = csv.writer(text)
    writer.writerow(COLUMNS)
    known, identity = {p.part_no: p for p in parts}, design.design
    for (part_no, name), (share, requirement) in ranked(variables, lines):
        limits = _limits(known[part_no], name)
        row = (identity.name, identity.revision, part_no, name, *limits[:3], UNIT, "", "", limits[3])
        writer.writerow((*row, requirement, f"{share:.3f}"))
    return text.getvalue().encode()


def ranked(
    variables: Mapping[str, DimensionLimits], lines: Sequence[StackLine]
) -> list[tuple[tuple[str, str], tuple[float, str]]]:
    """Part number and limit, with its largest share and of which requirement it is; the largest first."""
    most: dict[tuple[str, str], tuple[float, str]] = {}
    for line in lines:
        for c in line.contributors:
            for stated in variables[c.name].stated:
                share, requirement = c.share, line.requirement.name
                if share > most.get(stated, (0.0, ""))[0]:
                    most[stated] = (share, requirement)
    return sorted(most.items(), key=lambda item: (-round(item[1][0], 3), item[0]))


def _limits(part: Part, name: str) -> tuple[float, float, float, str]:
    """Nominal, lower and upper limit, mm, and where it is measured."""
    for c in part.characteristics:
        if c.name == name:
            nominal, lower, upper = (round(v, 6) for v in (c.nominal, c.lower, c.upper))
            return nominal, lower, upper, _spoken(c.between)
    g = next(g for g in part.geometric if g.name == name)
    return (
        0.0,
        0.0,
        g.zone,
        f"{g.symbol} of {_spoken(g.features)}" + f", from {' '.join(g.datums)}" * bool(g.datums),
    )


def _spoken(features: Sequence[str]) -> str:
    return ", ".join(f.replace("_", " ") for f in features)
