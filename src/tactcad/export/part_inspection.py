"""What to measure on parts other than the numbered elements: every limit on which a requirement of the
assembled sensor depends, those with the largest share of a requirement's variance first.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping, Sequence

from tactcad.assembly.stack import StackLine
from tactcad.design.tree import Design
from tactcad.parts.description import Part
from tactcad.parts.limits import FACES, Characteristic, Geometric
from tactcad.scenes.requirement import DimensionLimits

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
    "how",
    "requirement",
    "share",
)

# mm; of micrometers, height gauges and microscopes, coordinate measuring machines and lever indicators.
READS = (0.01, 0.002, 0.001, 0.0005)


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
        The design, and the parts to list: of its scenes, or of some.
    variables, lines
        Its variables, and the stack of every requirement.
    """
    text = io.StringIO(newline="")
    writer = csv.writer(text)
    writer.writerow(COLUMNS)
    known, identity = {p.part_no: p for p in parts}, design.design
    for (part_no, name), (share, requirement) in ranked(variables, lines):
        if part_no not in known:
            continue
        limits = _limits(known[part_no], name)
        row = (identity.name, identity.revision, part_no, name, *limits[:3], UNIT, "", "", *limits[3:])
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


def _limits(part: Part, name: str) -> tuple[float, float, float, str, str]:
    """Nominal, lower and upper limit, mm; where it is measured, and with what."""
    for c in part.characteristics:
        if c.name == name:
            nominal, lower, upper = (round(v, 6) for v in (c.nominal, c.lower, c.upper))
            where, how = _size(part, c)
            return nominal, lower, upper, f"{where}: {c.remark}" if c.remark else where, how
    g = next(g for g in part.geometric if g.name == name)
    return 0.0, 0.0, g.zone, *_zone(part, g)


def _size(part: Part, c: Characteristic) -> tuple[str, str]:
    """Where a size is measured, and with what."""
    width = round(c.upper - c.lower, 6)
    if {*c.between} == {*FACES}:
        return "between the two faces, in the middle and at the corners", f"micrometer, {_reads(width)}"
    if any(f in FACES for f in c.between):
        face = next(f for f in c.between if f in FACES)
        other = _plain(next(f for f in c.between if f not in FACES))
        where = f"{_face(part, face)} to the middle of each {other} hole"
        return where, f"height gauge over a pin in the hole, {_reads(width)}"
    if c.name.endswith("radius"):
        where = f"radius of the {_plain(c.between[0])}, at both faces"
        pins = f"pins, {2 * c.lower:g} enters and {2 * c.upper:g} does not"
        return where, f"measuring microscope, {_reads(width)}, or {pins}"
    if len(c.between) == 2:
        a, b = (_plain(f) for f in c.between)
        return f"from {a} to {b}, at both faces", f"measuring microscope or height gauge, {_reads(width)}"
    return "across the hole, at both faces", f"plug gauges, {c.lower:g} goes and {c.upper:g} does not"


def _zone(part: Part, g: Geometric) -> tuple[str, str]:
    """Where a geometric tolerance is measured, and with what."""
    named = f"datum{'s' * (len(g.datums) > 1)} {', '.join(g.datums)}"
    faces = {*g.features} & {*FACES}
    if faces:
        what = "both faces" if len(faces) == 2 else _face(part, *faces)
        where = f"{what}, {named} below" if g.datums else f"{what}, the part lying free on three points"
        return where, f"lever indicator on a surface plate, {_reads(g.zone)}"
    if g.symbol == "position":
        what = "centre of every hole" if g.round else f"the {_plain(g.features[0])}, along its length"
        return f"{what}, from {named}", f"coordinate measuring machine, {_reads(g.zone)}"
    return (
        f"axis of every hole, against {named}",
        f"lever indicator along a pin in the hole, {_reads(g.zone)}",
    )


def _face(part: Part, face: str) -> str:
    """A face by its datum letter, or by the other's."""
    letters = {d.feature: d.letter for d in part.datums}
    if face in letters:
        return f"face of datum {letters[face]}"
    across = next((letters[f] for f in FACES if f in letters), "")
    return f"face across from datum {across}" if across else "face"


def _plain(feature: str) -> str:
    return feature.replace("_", " ")


def _reads(width: float) -> str:
    """What the instrument reads to, mm: a tenth of the limits' width, of what instruments read."""
    read = next((r for r in READS if r <= width / 10 + 1e-9), READS[-1])
    return f"{read:g} or better"
