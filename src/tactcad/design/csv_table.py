"""Tables read from CSV: every refusal names file, line and column.

A line that starts with # is a comment. The first other line is the header; columns may stand in any
order and unknown ones are left alone.
"""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from math import inf, isfinite
from pathlib import Path

import numpy as np

from tactcad.design.files import read_text
from tactcad.design.messages import InputError
from tactcad.design.plain_numbers import as_number

LARGEST_FILE = 50_000_000  # bytes; a calibration of 10 000 elements is 15 MB


@dataclass(frozen=True)
class Field:
    """One numeric column: its name, unit, and the legal range [low, high] (or (low, high] where `above`)."""

    name: str
    unit: str
    low: float = -inf
    high: float = inf
    above: bool = False
    integer: bool = False

    @property
    def legal(self) -> str:
        kind = "a whole number" if self.integer else "a finite number"
        unit = f" {self.unit}" if self.unit not in ("", "1") else ""
        low = "" if self.low == -inf else f" {'above' if self.above else 'from'} {self.low:g}{unit}"
        high = "" if self.high == inf else f" up to {self.high:g}{unit}"
        return kind + low + high

    def allows(self, value: float) -> bool:
        low = value > self.low if self.above else value >= self.low
        return isfinite(value) and low and value <= self.high and (not self.integer or value == int(value))


@dataclass(frozen=True)
class Cell:
    """One number with the text it was printed as; half_step is half a unit of its last digit."""

    text: str
    value: float

    @property
    def half_step(self) -> float:
        mantissa, _, exponent = self.text.lower().partition("e")
        decimals = len(mantissa.partition(".")[2])
        return 0.5 * 10.0 ** (int(exponent or 0) - decimals)


@dataclass(frozen=True)
class Rows:
    """Numeric rows of a CSV file: cells by column name, and the line each row stands on."""

    path: str
    columns: dict[str, tuple[Cell, ...]]
    lines: tuple[int, ...]
    header: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.lines)

    def values(self, name: str) -> np.ndarray:
        """One column as float64."""
        return np.array([c.value for c in self.columns[name]], dtype=float)

    def half_steps(self, name: str) -> np.ndarray:
        """Half a unit of each value's last printed digit, in the column's unit."""
        return np.array([c.half_step for c in self.columns[name]], dtype=float)

    def where(self, row: int, name: str) -> str:
        """'file:line:column' of a cell, the column counted from 1."""
        return f"{self.path}:{self.lines[row]}:{self.header.index(name) + 1}"


def read(path: str | Path, fields: tuple[Field, ...], optional: tuple[Field, ...] = ()) -> Rows:
    """The numeric columns `fields` (and `optional` where present) of a CSV file.

    Raises InputError: file not there, not text, no header, column missing or twice, a row of another
    length, text for a number, a number outside its legal range.
    """
    shown = str(path)
    lines = _lines(Path(path), shown)
    if not lines:
        raise InputError(f"{shown}:1:1", "no header line", legal="a header with " + _names(fields))
    header_line, header = lines[0]
    _check_header(shown, header_line, header, fields)
    chosen = fields + tuple(f for f in optional if f.name in header)
    places = [header.index(f.name) for f in chosen]
    cells: dict[str, list[Cell]] = {f.name: [] for f in chosen}
    for number, row in lines[1:]:
        if len(row) != len(header):
            raise InputError(
                f"{shown}:{number}:{min(len(row), len(header)) + 1}",
                "a row of another length than the header",
                value=len(row),
                legal=f"{len(header)} columns",
            )
        for field, place in zip(chosen, places):
            cells[field.name].append(_cell(row[place], field, f"{shown}:{number}:{place + 1}"))
    if len(lines) == 1:
        raise InputError(f"{shown}:{header_line + 1}:1", "no rows below the header")
    return Rows(shown, {k: tuple(v) for k, v in cells.items()}, tuple(n for n, _ in lines[1:]), tuple(header))


def header(path: str | Path) -> tuple[str, ...]:
    """Column names of a CSV file; empty where it has none."""
    lines = _lines(Path(path), str(path))
    return tuple(lines[0][1]) if lines else ()


def refuse_duplicates(rows: Rows, names: tuple[str, ...], legal: str = "each once") -> None:
    """Raise InputError at the second row that has the same values in the columns `names`."""
    seen: dict[tuple[float, ...], int] = {}
    for i, key in enumerate(zip(*(rows.values(n) for n in names))):
        if key in seen:
            what = " and ".join(f"{n} {v:g}" for n, v in zip(names, key))
            raise InputError(
                rows.where(i, names[0]), f"{what} stands already on line {rows.lines[seen[key]]}", legal=legal
            )
        seen[key] = i


def records(shown: str, text: str, delimiter: str = ",") -> list[tuple[int, list[str]]]:
    """Every record of CSV text (line ends within quotes belong to it) with the line it begins on.

    Raises InputError where it is no CSV.
    """
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter, strict=True)
    found, before = [], 0
    try:
        for record in reader:
            found.append((before + 1, record))
            before = reader.line_num
    except csv.Error as error:
        raise InputError(f"{shown}:{before + 1}:1", f"not CSV: {error}") from None
    return found


def _lines(path: Path, shown: str) -> list[tuple[int, list[str]]]:
    found = []
    for number, line in enumerate(read_text(path, LARGEST_FILE, "readings (CSV)").splitlines(), 1):
        if line.strip() and not line.lstrip().startswith("#"):
            found.append((number, [field.strip() for field in _split(line, f"{shown}:{number}:1")]))
    return found


def _split(line: str, where: str) -> list[str]:
    try:
        return next(csv.reader([line], strict=True))
    except csv.Error as error:
        raise InputError(where, f"not CSV: {error}") from None


def _check_header(shown: str, line: int, header: list[str], fields: tuple[Field, ...]) -> None:
    for i, name in enumerate(header):
        if name in header[:i]:
            raise InputError(f"{shown}:{line}:{i + 1}", "column named twice", value=name)
    for field in fields:
        if field.name not in header:
            raise InputError(
                f"{shown}:{line}:{len(header) + 1}", f"column {field.name!r} is missing", legal=_names(fields)
            )


def _names(fields: tuple[Field, ...]) -> str:
    return ", ".join(f.name for f in fields)


def _cell(text: str, field: Field, where: str) -> Cell:
    try:
        value = as_number(text)
    except ValueError:
        raise InputError(
            where, f"column {field.name!r} is not a number", value=text, legal=field.legal
        ) from None
    if not field.allows(value):
        raise InputError(where, f"column {field.name!r} is out of range", value=text, legal=field.legal)
    return Cell(text, value)
