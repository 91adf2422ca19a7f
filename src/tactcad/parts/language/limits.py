"""Limits of a part: sizes with their limits, and geometric tolerances on named features and datums.

A part states each limit once. Its sheet, the inspection list, the model with its annotations and the
assembly's stack read it here. Features are named: an edge of the contour ("ledge"), an
opening or a hole ("dowel_hole"), an edge of a
pocket ("slot left edge"), or one of the two faces of an extrusion (FACES).
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from functools import cache
from typing import Literal

from tactcad.design.text_values import data_rows

FACES = ("face z=0", "face z=thickness")
Symbol = Literal["position", "flatness", "parallelism", "perpendicularity"]
# Symbols that say nothing without a datum (ISO 1101:2017, table 1).
NEED_DATUM = ("position", "parallelism", "perpendicularity")


@dataclass(frozen=True)
class Characteristic:
    """A toleranced dimension: its value with limits (mm), and whether it is a key characteristic.

    Of a fit (ISO 286) the nominal size may lie outside its limits.
    `between` names the two features that it connects, or the one feature of size; with three, it ends midway
    between the last two. `remark`: the value to make if that is not the drawn one.
    """

    name: str
    nominal: float
    upper: float
    lower: float
    key: bool = False
    between: tuple[str, ...] = ()
    remark: str = ""


@dataclass(frozen=True)
class DatumFeature:
    """A datum letter, and its feature."""

    letter: str
    feature: str


@dataclass(frozen=True)
class Geometric:
    """A geometric tolerance (ISO 1101).

    symbol    what is controlled
    zone      width of its zone, mm; its diameter if `round`
    features  that it holds for, a pattern of several together
    datums    letters, in order of precedence
    """

    name: str
    symbol: Symbol
    zone: float
    features: tuple[str, ...]
    datums: tuple[str, ...] = ()
    round: bool = False


def within(
    name: str, nominal: float, tolerance: float, key: bool = False, between: tuple[str, ...] = ()
) -> Characteristic:
    """A dimension with plus and minus `tolerance`, mm."""
    return Characteristic(name, nominal, nominal + tolerance, nominal - tolerance, key, between)


def contradictions(
    characteristics: Collection[Characteristic],
    geometric: Collection[Geometric],
    datums: Collection[DatumFeature],
    features: Collection[str],
) -> Iterator[str]:
    """Faults in a part's limits, a line each, with the legal values.

    Parameters
    ----------
    characteristics, geometric, datums
        As the part states them.
    features
        Names of the part's features; datums and geometric tolerances may refer to these only.
    """
    known = ", ".join(sorted(set(features) - {""}))
    for c in characteristics:
        if c.lower > c.upper:
            yield f"{c.name}: lower limit {c.lower:g} above the upper one, {c.upper:g}; legal: lower <= upper"
        if not c.between:
            yield f"{c.name}: refers to no feature; legal: {known}"
        for feature in (f for f in c.between if f not in features):
            yield f"{c.name}: the part has no feature {feature!r}; legal: {known}"
    letters = [d.letter for d in datums]
    for d in datums:
        if letters.count(d.letter) > 1:
            yield f"datum {d.letter} refers to several features; legal: one feature a letter"
        if d.feature not in features:
            yield f"datum {d.letter}: the part has no feature {d.feature!r}; legal: {known}"
    for g in geometric:
        if g.zone <= 0:
            yield f"{g.name}: zone of {g.zone:g} mm; legal: more than 0"
        for feature in (f for f in g.features if f not in features):
            yield f"{g.name}: the part has no feature {feature!r}; legal: {known}"
        for letter in (x for x in g.datums if x not in letters):
            yield f"{g.name}: there is no datum {letter}; legal: {', '.join(letters) or 'none is defined'}"
        if g.symbol in NEED_DATUM and not g.datums:
            yield f"{g.name}: {g.symbol} of {', '.join(g.features)} without datum; legal: at least one datum"


_GRADES, _DEVIATIONS, _GENERAL = (
    data_rows(__file__, name) for name in ("it_grades", "deviations", "general")
)
_CODE = re.compile(r"(js|JS|[a-hk-pA-HK-P])(\d{1,2})")
# Shafts whose fundamental deviation is the upper one; the others' is the lower one.
_BELOW = "defgh"


def _row(table: list[dict[str, str]], size: float, what: str) -> dict[str, str]:
    if size <= 0:
        raise ValueError(f"{what}: a size of {size:g} mm; legal: more than 0")
    for row in table:
        if size <= float(row["to"]):
            return row
    raise ValueError(f"{what}: no limits for {size:g} mm; legal: up to {table[-1]['to']} mm")


@cache
def deviations(code: str, size: float) -> tuple[float, float]:
    """Lower and upper deviation of an ISO 286 tolerance class, mm.

    Parameters
    ----------
    code
        Fundamental deviation and grade, capitals for holes: d to p, D to P, js, JS.
    size
        Nominal size, mm.

    Raises
    ------
    ValueError
        If the tables do not have the code or the size.
    """
    match = _CODE.fullmatch(code)
    letter, grade = (match[1], match[2]) if match else ("", "")
    width_row, shaft_row = _row(_GRADES, size, code), _row(_DEVIATIONS, size, code)
    hole = letter.isupper()
    if grade not in width_row or letter.lower() not in {"js", *shaft_row} - {"to"}:
        raise ValueError(f"{code!r} is not in the tables; legal: d to p and D to P, js, JS, grades 5 to 16")
    width = int(width_row[grade])
    if letter.lower() == "js":
        return (-width / 2e3, width / 2e3)
    if letter == "k" and int(grade) > 7:
        return (0.0, width / 1e3)
    own = int(shaft_row[letter.lower()])
    lower, upper = (own - width, own) if letter.lower() in _BELOW else (own, own + width)
    if not hole:
        return (lower / 1e3, upper / 1e3)
    # press holes of fine grades lie higher by the step to the next finer grade (ISO 286-1, 4.1.2.3)
    fine = letter in "KMNP" and size > 3 and int(grade) <= (7 if letter == "P" else 8) and grade != "5"
    raised = width - int(width_row[str(int(grade) - 1)]) if fine else 0
    return ((raised - upper) / 1e3, (raised - lower) / 1e3)


def general(size: float, grade: str = "m") -> float:
    """Plus and minus of a linear size without its own tolerance, mm (ISO 2768-1:1989, fine, medium, coarse).

    Raises ValueError if the table ends.
    """
    return float(_row(_GENERAL, abs(size), f"ISO 2768-{grade}")[grade])
