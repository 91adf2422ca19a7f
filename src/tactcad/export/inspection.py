"""The measurements, as CSV to fill in and send back: every dimension of every numbered element, and of the
other parts every limit on which a requirement of the assembled sensor depends, the largest share of a
requirement's variance first.

The first line names the columns and every row has its design and revision, so that a spreadsheet can sort,
filter and print it. `measured` and `uncertainty_k2` are left blank; tactcad.lab.inspection_sheet reads it
back.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from tactcad.design.family import family_of
from tactcad.design.files import as_csv
from tactcad.design.tree import CommonTables
from tactcad.parts.language.description import Part
from tactcad.parts.language.limits import FACES, Characteristic, Geometric
from tactcad.scenes.requirement import DimensionLimits
from tactcad.stacks.stack import StackLine

NAME = "inspection.csv"
_LIMITS = ("nominal", "lower", "upper", "unit", "measured", "uncertainty_k2", "where", "how")
COLUMNS = ("design", "revision", "element", "part_no", "characteristic", "key", *_LIMITS)
UNIT = "mm"


def inspection_bytes(layout: Any) -> bytes:
    """The sheet of the numbered elements (RFC 4180, UTF-8), rows by element number."""
    identity = layout.design.design
    rows: list[tuple[object, ...]] = [COLUMNS]
    for place, part_no, dimensions in family_of(layout.design).parts(layout):
        head = (identity.name, identity.of_part(part_no).revision)
        for m in dimensions:
            name = (place.designator, part_no, m.name, "yes" if m.key else "")
            limits = (round(v, 6) for v in (m.nominal, m.lower, m.upper))  # 0.25 - 0.005 is a binary fraction
            rows.append((*head, *name, *limits, UNIT, "", "", m.where, m.how))
    return as_csv(rows)


PART_COLUMNS = ("design", "revision", "part_no", "characteristic", *_LIMITS, "requirement", "share")

# mm; of micrometers, height gauges and microscopes, coordinate measuring machines and lever indicators.
READS = (0.01, 0.002, 0.001, 0.0005)


def part_inspection_bytes(
    design: CommonTables,
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
    known, identity = {p.part_no: p for p in parts}, design.design
    rows: list[tuple[object, ...]] = [PART_COLUMNS]
    for (part_no, name), (share, requirement) in ranked(variables, lines):
        if part_no in known:
            limits = _limits(known[part_no], name)
            head = (identity.name, identity.of_part(part_no).revision, part_no, name)
            rows.append((*head, *limits[:3], UNIT, "", "", *limits[3:], requirement, f"{share:.3f}"))
    return as_csv(rows)


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
    """Nominal, lower and upper limit, mm; place of measurement, and instrument."""
    for c in part.characteristics:
        if c.name == name:
            nominal, lower, upper = (round(v, 6) for v in (c.nominal, c.lower, c.upper))
            where, how = _size(part, c)
            return nominal, lower, upper, f"{where}: {c.remark}" if c.remark else where, how
    g = next(g for g in part.geometric if g.name == name)
    return 0.0, 0.0, g.zone, *_zone(part, g)


def _size(part: Part, c: Characteristic) -> tuple[str, str]:
    """A size's place of measurement, and instrument."""
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
    if {*c.between} & {"bore", *(f.name for f in part.features)}:
        return "across the hole, at both faces", f"plug gauges, {c.lower:g} goes and {c.upper:g} does not"
    return (
        f"across the {_plain(c.between[0]).removesuffix(' side')}, at both ends",
        f"micrometer, {_reads(width)}",
    )


def _zone(part: Part, g: Geometric) -> tuple[str, str]:
    """A geometric tolerance's place of measurement, and instrument."""
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
    """The instrument's resolution, mm: a tenth of the limits' width, rounded to a usual one."""
    read = next((r for r in READS if r <= width / 10 + 1e-9), READS[-1])
    return f"{read:g} or better"
