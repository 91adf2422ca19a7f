"""Tables read from CSV: every refusal names file, line and column.

A line that starts with # is a comment. The first other line is the header, with one row at least below it;
columns may be in any order and unknown ones are ignored. Changes that spreadsheets make to a CSV file are
undone where they are unambiguous: a byte order mark, a first line "sep=;", semicolons or tabs between the
columns, empty rows, empty cells at the end, and decimal commas.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf, isfinite, isnan, nan
from pathlib import Path

import numpy as np

from tactcad.design.files import read_text
from tactcad.design.messages import InputError

from .text_values import as_number

LARGEST_FILE = 100_000_000  # bytes; a million lines of readings are 35 MB
COMMENT = re.compile(r"\s*#(?!N/A|DIV/0!|VALUE!|REF!|NAME\?|NUM!|NULL!)")  # no spreadsheet's error value
# a comma before three digits may divide thousands, unless a nought precedes it
MAY_BE_THOUSANDS = re.compile(r"[+-]?[1-9][0-9]{0,2}(,[0-9]{3})+")


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

    def allowed(self, value: np.ndarray) -> np.ndarray:
        """Mask of the values that are finite and within the range."""
        low = value > self.low if self.above else value >= self.low
        return (
            np.isfinite(value) & low & (value <= self.high) & (not self.integer or value == np.floor(value))
        )


@dataclass(frozen=True)
class Table:
    """A CSV file read up to its header; the rows below are split on demand.

    lines: those below the header, without comments; numbers: of each, as an editor counts them.
    """

    path: str
    delimiter: str
    header_line: int
    header: list[str]
    lines: list[str]
    numbers: Sequence[int]

    @cached_property
    def records(self) -> list[tuple[int, list[str]]]:
        """The rows as text, each with the line it begins on; cells without blanks around them, at the
        header's width.

        Line ends within quotes belong to their row; empty rows are left out. Raises InputError if it is
        not CSV, a row is of another length, or there is none.
        """
        rows = _split(self.path, self.lines, self.numbers, self.delimiter)
        found = [(n, _fitted(self, n, row)) for n, row in rows if any(row)]
        if not found:
            where = f"{self.path}:{self.header_line + 1}:1"
            raise InputError(where, "a header and no rows", legal="one row at least")
        return found

    def column(self, name: str) -> list[str]:
        place = self.header.index(name)
        return [row[place] for _, row in self.records]

    def where(self, line: int, name: str) -> str:
        """'file:line:column' of a cell, the column counted from 1."""
        return f"{self.path}:{line}:{self.header.index(name) + 1}"


@dataclass(frozen=True)
class Rows:
    """Numeric columns of a CSV file by name, as float64, and the line each row begins on."""

    table: Table
    columns: dict[str, np.ndarray]
    lines: np.ndarray

    def __len__(self) -> int:
        return len(self.lines)

    @property
    def path(self) -> str:
        return self.table.path

    def values(self, name: str) -> np.ndarray:
        """One column as float64."""
        return self.columns[name]

    def half_steps(self, name: str) -> np.ndarray:
        """Half a unit of each value's last printed digit, in the column's unit.

        Raises InputError if that is beyond all numbers ("0e400").
        """
        texts = [text.replace(",", ".") for text in self.table.column(name)]
        steps = np.array([half_step(text) for text in texts])
        for i in np.flatnonzero(~np.isfinite(steps))[:1]:
            raise InputError(self.where(i, name), "its last digit is beyond all numbers", value=texts[i])
        return steps

    def where(self, row: int, name: str) -> str:
        """'file:line:column' of a cell, the column counted from 1."""
        return self.table.where(self.lines[row], name)


def half_step(text: str) -> float:
    """Half a unit of a printed number's last digit; inf if that is beyond all numbers."""
    mantissa, _, exponent = text.lower().partition("e")
    try:
        return 0.5 * 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))
    except (OverflowError, ValueError):  # 10^400, or an exponent of thousands of digits
        return inf


def read(path: str | Path, fields: tuple[Field, ...], optional: tuple[Field, ...] = ()) -> Rows:
    """Numeric columns of a CSV file.

    Parameters
    ----------
    path
        The file, as the user named it.
    fields
        Columns that must be present.
    optional
        Columns that are read if present.

    Raises
    ------
    InputError
        As `numeric`.
    """
    return numeric(read_table(path, "readings (CSV)"), fields, optional)


def numeric(table: Table, fields: tuple[Field, ...], optional: tuple[Field, ...] = ()) -> Rows:
    """Numeric columns of a table.

    Parameters
    ----------
    table
        As `read_table` gives it.
    fields
        Columns that have to be there.
    optional
        Columns that are read where they are there.

    Returns
    -------
    Rows
        Each column as float64, shape (rows,), in the field's unit.

    Raises
    ------
    InputError
        With line and column: a column missing or written otherwise, no row, text for a number, a number
        outside its legal range.
    """
    require_columns(table, [f.name for f in fields], [f.name for f in optional])
    chosen = fields + tuple(f for f in optional if f.name in table.header)
    rows = _at_once(table, chosen)
    if rows is not None:
        return rows
    lines = np.array([n for n, _ in table.records])
    texts = {f.name: table.column(f.name) for f in chosen}
    if table.delimiter != "," and decimal_commas(t for column in texts.values() for t in column):
        texts = {name: [t.replace(",", ".") for t in column] for name, column in texts.items()}
    return Rows(table, {f.name: _numbers(table, f, lines, texts[f.name]) for f in chosen}, lines)


def _at_once(table: Table, chosen: tuple[Field, ...]) -> Rows | None:
    """`numeric` ten times as fast, for lines of plain legal numbers only; None if one is not."""
    width = len(table.header) - 1
    if not table.lines or any(line.count(table.delimiter) != width or '"' in line for line in table.lines):
        return None
    try:
        places = [table.header.index(f.name) for f in chosen]
        # loadtxt accepts fewer texts for a number than `number` does: if it refuses, `numeric` decides
        values = np.loadtxt(
            table.lines, delimiter=table.delimiter, usecols=places, comments=None, ndmin=2, unpack=True
        )
    except ValueError:
        return None
    if values.shape[1] != len(table.lines) or not all(f.allowed(v).all() for f, v in zip(chosen, values)):
        return None
    return Rows(table, {f.name: v for f, v in zip(chosen, values)}, np.array(table.numbers))


def read_table(path: str | Path, kind: str, most_bytes: int = LARGEST_FILE, comments: bool = True) -> Table:
    """A CSV file up to its header.

    Parameters
    ----------
    path
        The file, as the user named it.
    kind
        What was expected, for messages: "readings (CSV)".
    most_bytes
        A larger file is refused unread.
    comments
        Whether lines that start with # are left out.

    Raises
    ------
    InputError
        With line and column: file not there, not text, no header, a column named twice.
    """
    shown, text = str(path), read_text(path, most_bytes, kind)
    hint = re.match(r"sep=.\r?\n", text)  # Excel's
    first, body = (2, text[hint.end() :]) if hint else (1, text)
    lines = list(io.StringIO(body, newline=""))
    numbers: Sequence[int] = range(first, first + len(lines))
    if comments and "#" in body:
        kept = [i for i, line in enumerate(lines) if not COMMENT.match(line)]
        lines, numbers = [lines[i] for i in kept], [numbers[i] for i in kept]
    start = next((i for i, line in enumerate(lines) if line.strip(",;\t \r\n")), None)
    if start is None:
        raise InputError(f"{shown}:1:1", "no header line: the file is empty", legal=kind)
    delimiter = max(",;\t", key=lines[start].count)
    end = start + 1
    line, header = next(_split(shown, lines[start:end], numbers[start:end], delimiter))
    while not header[-1]:
        header.pop()
    if all(isfinite(number(name)) for name in header):
        raise InputError(
            f"{shown}:{line}:1", "no header line: numbers alone", value=delimiter.join(header), legal=kind
        )
    for i, name in enumerate(header):
        if name and name in header[:i]:
            raise InputError(f"{shown}:{line}:{i + 1}", "column named twice", value=name)
    return Table(shown, delimiter, line, header, lines[end:], numbers[end:])


def require_columns(table: Table, names: Sequence[str], optional: Sequence[str] = ()) -> None:
    """Raise InputError at the first of the columns that the table lacks, or that it has, as an optional one,
    with other capitals or signs: it would be ignored."""
    plain = lambda name: re.sub("[^a-z0-9]+", "_", name.lower()).strip("_")  # noqa: E731
    lacking = {plain(name): name for name in (*names, *optional) if name not in table.header}
    for name in table.header:
        if meant := lacking.get(plain(name)):
            where = table.where(table.header_line, name)
            raise InputError(where, "column is written otherwise", value=name, legal=meant)
    for name in names:
        if name not in table.header:
            alone = "; commas, semicolons or tabs between" if len(table.header) == 1 < len(names) else ""
            where = f"{table.path}:{table.header_line}:{len(table.header) + 1}"
            value, legal = table.delimiter.join(table.header), ", ".join(names) + alone
            raise InputError(where, f"column {name!r} is missing", value=value, legal=legal)


def refuse_duplicates(rows: Rows, names: tuple[str, ...], legal: str = "each once") -> None:
    """Refuse a row that repeats an earlier one's values in some columns.

    Parameters
    ----------
    rows
        As `read` gives them.
    names
        The columns that are compared.
    legal
        What would be accepted, for the message.

    Raises
    ------
    InputError
        With line and column of the second row.
    """
    columns = [rows.values(n) for n in names]
    order = np.lexsort(columns)  # stable: of equal rows the first stays first
    same = np.all([column[order[1:]] == column[order[:-1]] for column in columns], axis=0)
    if same.any():
        at = 1 + np.flatnonzero(same)
        k = at[np.argmin(order[at])]
        what = " and ".join(f"{n} {column[order[k]]:g}" for n, column in zip(names, columns))
        what = f"{what} is already on line {rows.lines[order[k - 1]]}"
        raise InputError(rows.where(order[k], names[0]), what, legal=legal)


def decimal_commas(texts: Iterable[str]) -> bool:
    """Whether the numbers were all written with a decimal comma, so that a comma has one meaning."""
    texts = list(texts)
    with_comma = [t for t in texts if "," in t]
    return (
        bool(with_comma)
        and not any("." in t for t in texts)
        and not all(MAY_BE_THOUSANDS.fullmatch(t) for t in with_comma)
    )


def number(text: str) -> float:
    """The number in ASCII digits; NaN for any other text."""
    try:
        return as_number(text)
    except ValueError:
        return nan


def _split(
    path: str, lines: list[str], numbers: Sequence[int], delimiter: str
) -> Iterator[tuple[int, list[str]]]:
    """Every record without blanks about its cells, and the line it begins on. Raises InputError if it is
    no CSV."""
    reader = csv.reader(lines, delimiter=delimiter, strict=True)
    before = 0
    try:
        for record in reader:
            yield numbers[before], [cell.strip() for cell in record]
            before = reader.line_num
    except csv.Error as error:
        raise InputError(f"{path}:{numbers[before]}:1", f"not CSV: {error}") from None


def _fitted(table: Table, line: int, row: list[str]) -> list[str]:
    """The row cut to the header's width; cells beyond must be blank."""
    width = len(table.header)
    if len(row) < width or any(row[width:]):
        what = "a row of another length than the header (cut off, or a decimal comma?)"
        legal = f"{width} columns"
        raise InputError(f"{table.path}:{line}:{min(len(row), width) + 1}", what, value=len(row), legal=legal)
    return row[:width]


def _numbers(table: Table, field: Field, lines: np.ndarray, column: list[str]) -> np.ndarray:
    """A column's numbers. Raises InputError at the first cell that is not a number, or not legal."""
    values = np.array([number(text) for text in column])
    for i in np.flatnonzero(~field.allowed(values))[:1]:
        wrong = "is not a number" if isnan(values[i]) else "is out of range"
        what = f"column {field.name!r} {wrong}"
        raise InputError(table.where(lines[i], field.name), what, value=column[i], legal=field.legal)
    return values
