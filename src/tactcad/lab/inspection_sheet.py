"""Reads a filled-in inspection sheet back. Every refusal names file, line and column.

What spreadsheets do to a CSV file is undone where it can only mean one thing: a byte order mark, a first line
"sep=;", semicolons or tabs between the columns, other order of rows and columns, further columns, empty rows
and cells at the end, and decimal commas where every number of a sheet with semicolons or tabs is written so.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from math import isclose
from pathlib import Path

from tactcad.design.csv_table import LARGEST_FILE, records
from tactcad.design.files import read_text
from tactcad.design.messages import InputError
from tactcad.export.inspection import COLUMNS, UNIT
from tactcad.parts.layout import Layout
from tactcad.parts.measurements import Measurement, measurements

NEEDED = tuple(c for c in COLUMNS if c not in ("key", "where", "how"))
LIMITS = ("nominal", "lower", "upper")
NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")
FACTOR = 5.0  # a measured value further from its nominal is no measurement of it, but another unit or a slip
SLIP = "the decimal point slipped"
UNITS_TAKEN = (
    (1e3, "in micrometres"),
    (1e-3, "in metres"),
    (1 / 25.4, "in inches"),
    (10.0, SLIP),
    (0.1, SLIP),
)
WIDEST = 5.0  # an uncertainty of more times the tolerance is another unit or a slip


@dataclass(frozen=True)
class Reading:
    """What the sheet says of one dimension of one element; mm, None where the cell is blank.

    `uncertainty` is expanded, k = 2. `line` is the sheet's.
    """

    number: int
    dimension: Measurement
    measured: float | None
    uncertainty: float | None
    line: int

    @property
    def verdict(self) -> str:
        """ "blank"; "outside" or "inside" the tolerance; "undecided" where the uncertainty reaches across a
        limit."""
        if self.measured is None:
            return "blank"
        u, d = self.uncertainty or 0.0, self.dimension
        slack = 1e-9  # 0.245 + 0.01 is no binary fraction
        if self.measured + u < d.lower - slack or self.measured - u > d.upper + slack:
            return "outside"
        if d.lower - slack <= self.measured - u and self.measured + u <= d.upper + slack:
            return "inside"
        return "undecided" if u else "outside"


def read_sheet(path: str | Path, layout: Layout) -> list[Reading]:
    """Every row of the sheet, by element number and in the order of its dimensions.

    Raises InputError where the file is not this design's sheet, whole and unchanged but for what was filled
    in.
    """
    shown, text = str(path), read_text(path, LARGEST_FILE, "an inspection sheet (CSV)")
    first, text = _without_hint(text)
    delimiter = _delimiter(text)
    lines = [(n + first, [cell.strip() for cell in row]) for n, row in records(shown, text, delimiter)]
    lines = [(n, row) for n, row in lines if any(row)]
    if not lines:
        raise InputError(
            f"{shown}:1:1", "the file is empty", legal="an inspection sheet: " + ", ".join(NEEDED)
        )
    header_line, header = lines[0][0], _stripped(lines[0][1])
    _check_header(shown, header_line, header)
    rows = [_Row(shown, n, header, _fitted(shown, n, row, len(header))) for n, row in lines[1:]]
    commas = delimiter != "," and _all_commas(rows)
    known = {
        (p.designator, m.name): (p.number, part_no, m) for p, part_no, ms in measurements(layout) for m in ms
    }
    readings: dict[tuple[str, str], Reading] = {}
    for row in rows:
        key = _identified(row, layout, known)
        if key in readings:
            raise row.refusal(
                "characteristic", f"stands already on line {readings[key].line}", legal="each once"
            )
        number, part_no, dimension = known[key]
        _check_unchanged(row, part_no, dimension, commas)
        readings[key] = _reading(row, number, dimension, commas)
    for designator, name in known:
        if (designator, name) not in readings:
            raise InputError(
                f"{shown}:{lines[-1][0] + 1}:1",
                f"the row {name!r} of element {designator} is missing",
                legal="every row of the sheet, in any order; leave cells blank where nothing was measured",
            )
    return [readings[key] for key in known]


@dataclass(frozen=True)
class _Row:
    path: str
    line: int
    header: list[str]
    cells: list[str]

    def __getitem__(self, name: str) -> str:
        return self.cells[self.header.index(name)]

    def refusal(self, name: str, what: str, legal: str = "") -> InputError:
        where = f"{self.path}:{self.line}:{self.header.index(name) + 1}"
        return InputError(where, f"{name}: {what}", value=self[name], legal=legal)


def _without_hint(text: str) -> tuple[int, str]:
    """The text without Excel's "sep=;" line, and how many lines that took."""
    hint = re.match(r"sep=.\r?\n", text)
    return (1, text[hint.end() :]) if hint else (0, text)


def _delimiter(text: str) -> str:
    """What stands most often between the names of the first line."""
    first = next((line for line in text.splitlines() if line.strip()), "")
    return max(",;\t", key=first.count)


def _stripped(header: list[str]) -> list[str]:
    """Without blank cells at its end."""
    return header[: max((i for i, name in enumerate(header, 1) if name), default=0)]


def _check_header(shown: str, line: int, header: list[str]) -> None:
    for i, name in enumerate(header):
        if name and name in header[:i]:
            raise InputError(f"{shown}:{line}:{i + 1}", "column named twice", value=name)
    for name in NEEDED:
        if name not in header:
            raise InputError(
                f"{shown}:{line}:{len(header) + 1}",
                f"column {name!r} is missing: not an inspection sheet",
                legal=", ".join(NEEDED),
            )


def _fitted(shown: str, line: int, row: list[str], width: int) -> list[str]:
    """The row at the header's width; what is over must be blank."""
    if len(row) < width or any(row[width:]):
        raise InputError(
            f"{shown}:{line}:{min(len(row), width) + 1}",
            "a row of another length than the header (cut off, or a decimal comma?)",
            value=len(row),
            legal=f"{width} columns",
        )
    return row[:width]


def _all_commas(rows: list[_Row]) -> bool:
    """Whether the sheet's own numbers were all written again with a decimal comma, so that a comma has one
    meaning."""
    own = [row[name] for row in rows for name in LIMITS]
    return any("," in text for text in own) and not any("." in text for text in own)


def _identified(row: _Row, layout: Layout, known: dict) -> tuple[str, str]:
    design = layout.design
    if row["design"] != design.name:
        raise row.refusal("design", "a sheet of another design", legal=design.name)
    if row["revision"] != design.design.revision:
        raise row.refusal("revision", "a sheet of another revision", legal=design.design.revision)
    last = layout.elements[-1].designator
    if row["element"] not in {designator for designator, _ in known}:
        raise row.refusal("element", "no such element", legal="E1" if last == "E1" else f"E1 to {last}")
    key = (row["element"], row["characteristic"])
    if key not in known:
        raise row.refusal(
            "characteristic",
            f"element {key[0]} has no such dimension",
            legal=", ".join(name for designator, name in known if designator == key[0]),
        )
    return key


def _check_unchanged(row: _Row, part_no: str, dimension: Measurement, commas: bool) -> None:
    """What the sheet came with is still there."""
    for name, meant in (("part_no", part_no), ("unit", UNIT)):
        if row[name] != meant:
            raise row.refusal(name, "not what the sheet came with", legal=meant)
    for name in LIMITS:
        meant = getattr(dimension, name)
        if not isclose(_number(row, name, commas), meant, rel_tol=0, abs_tol=1e-6):
            raise row.refusal(name, "not what the sheet came with", legal=f"{meant!r} {UNIT}")


def _reading(row: _Row, number: int, dimension: Measurement, commas: bool) -> Reading:
    measured = _number(row, "measured", commas) if row["measured"] else None
    uncertainty = _number(row, "uncertainty_k2", commas) if row["uncertainty_k2"] else None
    if measured is not None and not dimension.nominal / FACTOR < measured < dimension.nominal * FACTOR:
        raise row.refusal(
            "measured",
            f"cannot be the {dimension.name}{_guess(measured / dimension.nominal)}",
            legal=f"{UNIT}; nominal {dimension.nominal!r}",
        )
    if uncertainty is not None:
        if measured is None:
            raise row.refusal("uncertainty_k2", "belongs to no measured value")
        most = WIDEST * (dimension.upper - dimension.lower) / 2
        if not 0.0 <= uncertainty <= most:
            raise row.refusal(
                "uncertainty_k2", "cannot be its uncertainty", legal=f"0 to {most:.3g} {UNIT} (k = 2)"
            )
    return Reading(number, dimension, measured, uncertainty, row.line)


def _guess(ratio: float) -> str:
    """What such a value looks like, where that can be told."""
    found = [text for factor, text in UNITS_TAKEN if 0.8 < ratio / factor < 1.25]
    return f" ({found[0]}?)" if found else ""


def _number(row: _Row, name: str, commas: bool) -> float:
    text = row[name]
    if commas and "." in text:
        raise row.refusal(name, "not a number with a decimal comma, as this sheet has them")
    plain = text.replace(",", ".") if commas else text
    if not NUMBER.fullmatch(plain):
        raise row.refusal(name, "not a number", legal="digits with a decimal point, as 0.25")
    return float(plain)
