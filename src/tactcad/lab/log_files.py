"""A lab's log as it was written: a wide table of time and channels, from CSV with any separator, LabVIEW's
.lvm or National Instruments' .tdms.

Of CSV the separator, the decimal sign and the line of names are found from the file: the names are directly
above the first line of numbers, with at most a line of units between. Lines above the names are skipped.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import date, datetime
from math import isfinite, nan
from pathlib import Path
from typing import Any

import numpy as np

from tactcad.design.csv_table import COMMENT, number
from tactcad.design.files import read_bytes
from tactcad.design.messages import InputError, one_of, refuse_missing

LARGEST_LOG = 1_000_000_000  # bytes; ten channels at 1 kHz for an hour are 0.4 GB as text
KIND = "a log (CSV, .lvm or .tdms)"
SEPARATORS = ("\t", ";", ",", "|", " ")
LOOKED_AT = 200  # lines from which the separator is found
SAME_TIME = 1e-9  # s


@dataclass(frozen=True)
class LabLog:
    """A log's columns by name, each of equal length: numbers, or texts (marks). `time`: s from the first row,
    if the file has it; `line`: line of each row in the file, or its number; `other`: rows of channels that
    have more or fewer than most."""

    path: str
    columns: dict[str, np.ndarray]
    time: np.ndarray | None
    line: np.ndarray
    other: Mapping[str, int] = field(default_factory=dict)

    def column(self, name: str) -> np.ndarray:
        """Raises InputError if the log has none of that name and of its length."""
        if name in self.other:
            what = f"has {self.other[name]} rows, most channels have {len(self.line)}"
            raise InputError(f"{self.path}: {name}", what, legal="channels of equal length")
        if name not in self.columns:
            raise InputError(self.path, f"has no column {name!r}", legal=one_of(name, self.columns))
        return self.columns[name]

    def where(self, row: int, column: str = "") -> str:
        return f"{self.path}:{self.line[row]}" + (f": {column}" if column else "")


def read_log(path: str | Path) -> LabLog:
    """Read a log; the format goes by the file's ending, all else than .lvm and .tdms is CSV.

    Raises
    ------
    InputError
        Not such a file; a row of another length; a column named twice.
    """
    ending = Path(path).suffix.lower()
    if ending == ".tdms":
        return _tdms(path)
    text = _text(path)
    return _lvm(str(path), text) if ending == ".lvm" else _csv(str(path), text)


def _text(path: str | Path) -> str:
    """The file as text: UTF-8, UTF-16 with its mark, or else Windows' western code page, as instruments
    write."""
    data = read_bytes(path, LARGEST_LOG, KIND)
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return data.decode("utf-16", "replace")
    if b"\0" in data:
        raise InputError(str(path), "a NUL character: not a text file", legal=KIND)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("cp1252", "replace")


def _cells(line: str, separator: str) -> list[str]:
    if separator == " ":
        return line.split()
    if '"' in line:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=separator))]
    return [cell.strip() for cell in line.rstrip("\r\n").split(separator)]


def _value(comma: bool) -> Callable[[str], float]:
    return (lambda text: number(text.replace(",", "."))) if comma else number


def _dialect(path: str, lines: Sequence[str]) -> tuple[str, bool]:
    """Separator and whether decimals have a comma: those that give most numbers."""
    middle = lines[len(lines) // 2 :][:LOOKED_AT]
    best, found = ("", False), 1
    for separator in SEPARATORS:
        for comma in (False, True) if separator != "," else (False,):
            read = _value(comma)
            count = sum(isfinite(read(cell)) for line in middle for cell in _cells(line, separator))
            if count > found:
                best, found = (separator, comma), count
    if not best[0] or found < 2 * len(middle):
        raise InputError(path, "no table of numbers in it", legal=KIND)
    return best


def _csv(path: str, text: str) -> LabLog:
    numbered = [
        (n, line)
        for n, line in enumerate(text.splitlines(), 1)
        if line.strip(",;\t |") and not COMMENT.match(line)
    ]
    if not numbered:
        raise InputError(path, "empty", legal=KIND)
    separator, comma = _dialect(path, [line for _, line in numbered])
    return _table(path, numbered, separator, comma)


def _table(path: str, numbered: list[tuple[int, str]], separator: str, comma: bool) -> LabLog:
    """The table in numbered lines: names, a line of units at most, rows."""
    read = _value(comma)
    width = max(len(_cells(line, separator)) for _, line in numbered[len(numbered) // 2 :][:LOOKED_AT])
    numeric = lambda cells: sum(isfinite(read(c)) for c in cells)  # noqa: E731
    first = next(
        (
            i
            for i, (_, line) in enumerate(numbered)
            if len(cells := _cells(line, separator)) >= width - 1 and 2 * numeric(cells) >= len(cells) > 1
        ),
        0,
    )
    above = [
        [*filter(None, cells)] if separator == " " else cells
        for _, line in numbered[max(first - 2, 0) : first]
        if len(cells := _cells(line, separator)) >= width - 1 and not numeric(cells)
    ]
    if not above:
        line = numbered[first][0]
        raise InputError(f"{path}:{line}", "no names of columns above the first row of numbers", legal=KIND)
    names = _names(above[0], path, numbered[first][0] - 1)
    rows: list[list[str]] = []
    lines: list[int] = []
    for n, text in numbered[first:]:
        cells = _cells(text, separator)
        if len(cells) > len(names) and not any(cells[len(names) :]):
            cells = cells[: len(names)]
        if len(cells) + 1 == len(names) and separator != " ":
            cells.append("")  # LabVIEW leaves out an empty comment
        if len(cells) != len(names):
            what = "a row of another length than the names (cut off, or another separator?)"
            raise InputError(f"{path}:{n}", what, value=len(cells), legal=f"{len(names)} columns")
        rows.append(cells)
        lines.append(n)
    columns = {name: _column(cells, read) for name, cells in zip(names, zip(*rows)) if name}
    return LabLog(path, columns, None, np.array(lines))


def _names(cells: Sequence[str], path: str, line: int) -> list[str]:
    cells = list(cells)
    while cells and not cells[-1]:
        cells.pop()
    for i, name in enumerate(cells):
        if name and name in cells[:i]:
            raise InputError(f"{path}:{line}", "column named twice", value=name)
    return cells


def _column(cells: Sequence[str], read: Callable[[str], float]) -> np.ndarray:
    """Numbers (an empty cell is none), seconds of the day's times, or the texts."""
    values = np.array([read(cell) if cell else nan for cell in cells])
    written = np.array([bool(cell) for cell in cells])
    if not (written & np.isnan(values)).any() and written.any():
        return values
    with_seconds = [_seconds(cell) for cell in cells]
    if all(s is not None for s in with_seconds):
        return np.array(with_seconds, dtype=float)
    return np.array(cells)


def _seconds(text: str) -> float | None:
    """Seconds of a time of day, or of a date with one; None if it is neither."""
    plain = text.strip().replace(",", ".").replace("/", "-")
    if re.fullmatch(r"\d{1,2}:\d{2}(:\d{2}(\.\d+)?)?", plain):
        parts = [float(p) for p in plain.split(":")] + [0.0]
        return 3600 * parts[0] + 60 * parts[1] + parts[2]
    plain = re.sub(r"^(\d{2})\.(\d{2})\.(\d{4})(?=[ T])", r"\3-\2-\1", plain)
    if us := re.fullmatch(r"(\d{1,2})-(\d{1,2})-(\d{4}) (\d{1,2}):(\d{2}:\d{2}(?:\.\d+)?) ([AP])M", plain):
        month, day, year, hour, rest, half = us.groups()
        plain = f"{year}-{month:0>2}-{day:0>2} {int(hour) % 12 + 12 * (half == 'P'):02}:{rest}"
    if not re.match(r"\d{4}-\d{2}-\d{2}[ T]\d{2}:\d{2}", plain):
        return None
    plain = re.sub(r"(\.\d{1,6})\d*", lambda m: m[1].ljust(7, "0"), plain)
    try:
        return (datetime.fromisoformat(plain).replace(tzinfo=None) - datetime(2000, 1, 1)).total_seconds()
    except ValueError:
        return None


END, X = "***End_of_Header***", "X_Value"


def _lvm(path: str, text: str) -> LabLog:
    """LabVIEW's measurement file: a header of names and values, then segments, each with one of its own."""
    lines = [line.rstrip("\r") for line in text.split("\n")]
    if not lines[0].startswith("LabVIEW Measurement"):
        raise InputError(f"{path}:1", "no LabVIEW measurement file", value=lines[0][:40], legal=KIND)
    separator = "," if any(re.match(r"Separator,Comma", line) for line in lines[:30]) else "\t"

    def header(start: int) -> tuple[dict[str, list[str]], int]:
        found: dict[str, list[str]] = {}
        for i in range(start, len(lines)):
            if lines[i].startswith(END):
                return found, i + 1
            name, *values = lines[i].split(separator)
            found[name.strip()] = values
        raise InputError(f"{path}:{start + 1}", f"a header without {END}", legal=KIND)

    whole, at = header(1)
    comma = whole.get("Decimal_Separator", ["."])[0].strip() == ","
    layout = whole.get("X_Columns", ["One"])[0].strip()
    parts: list[tuple[LabLog, dict[str, list[str]]]] = []
    while (start := next((i for i in range(at, len(lines)) if lines[i].strip()), None)) is not None:
        own, at = header(start)
        stop = next((i for i in range(at + 1, len(lines)) if not lines[i].strip()), len(lines))
        rows = [(n + 1, lines[n]) for n in range(at, stop)]
        if layout == "No":  # its rows begin with an empty cell, or with none
            rows = [(n, line.removeprefix(X).removeprefix(separator)) for n, line in rows]
        if layout == "Multi":
            rows = _with_one_time(path, rows, separator)
        if len(rows) < 2:
            raise InputError(f"{path}:{at + 1}", "a segment without rows", legal=KIND)
        parts.append((_table(path, rows, separator, comma), own))
        at = stop
    if not parts:
        raise InputError(path, "no segment of data", legal=KIND)
    read = _value(comma)
    times = [_lvm_time(log, own, layout, read) for log, own in parts]
    for k, (log, _) in enumerate(parts[1:], 1):
        if list(log.columns) != list(parts[0][0].columns):
            raise InputError(log.where(0), "a segment of other channels", legal="the first segment's")
        if times[k][0] <= times[k - 1][-1] + SAME_TIME:  # each segment counts from its own beginning
            starts = [_lvm_start(own) for _, own in parts[k - 1 : k + 1]]
            times[k] = times[k] - times[k][0] + times[k - 1][0] + (starts[1] - starts[0])
    columns = {
        name: np.concatenate([log.columns[name] for log, _ in parts])
        for name in parts[0][0].columns
        if name not in (X, "Comment") or (name == "Comment" and parts[0][0].columns[name].dtype.kind == "U")
    }
    return LabLog(path, columns, np.concatenate(times), np.concatenate([log.line for log, _ in parts]))


def _with_one_time(path: str, rows: list[tuple[int, str]], separator: str) -> list[tuple[int, str]]:
    """Rows in which every channel has its time before it, with the first channel's alone. Raises InputError
    where another differs."""
    names = _cells(rows[0][1], separator)
    more = [i for i, name in enumerate(names) if name == X][1:]
    kept = []
    for n, line in rows:
        cells = _cells(line, separator)
        if any(i < len(cells) and cells[i] != cells[0] for i in more):
            raise InputError(f"{path}:{n}", "channels of different times", legal="one time in each row")
        kept.append((n, separator.join(cell for i, cell in enumerate(cells) if i not in more)))
    return kept


def _lvm_time(
    log: LabLog, own: dict[str, list[str]], layout: str, read: Callable[[str], float]
) -> np.ndarray:
    if layout != "No" and X in log.columns:
        return log.columns[X]
    step = read(own.get("Delta_X", ["1"])[0])
    start = read(own.get("X0", ["0"])[0])
    return start + step * np.arange(len(log.line))


def _lvm_start(own: dict[str, list[str]]) -> float:
    day = own.get("Date", ["2000/01/01"])[0].strip()
    clock = _seconds(own.get("Time", ["00:00:00"])[0].strip().replace(",", ".")) or 0.0
    return date(*map(int, re.split(r"[/.-]", day))).toordinal() * 86400.0 + clock


def _tdms(path: str | Path) -> LabLog:
    refuse_missing(str(path), "logs")
    from io import BytesIO
    from logging import ERROR

    from nptdms import TdmsFile
    from nptdms.log import log_manager

    data = read_bytes(path, LARGEST_LOG, KIND)
    log_manager.set_level(ERROR)  # what is wrong is said in one line below
    try:
        file = TdmsFile.read(BytesIO(data))
        groups = [(group, channel) for group in file.groups() for channel in group.channels() if len(channel)]
        found = [(group.name, channel.name, np.asarray(channel[:]), channel) for group, channel in groups]
    except Exception as error:  # its reader raises whatever a broken file brings about
        raise InputError(str(path), f"is no TDMS file: {error}", legal=KIND) from None
    if not found:
        raise InputError(str(path), "no channel in it", legal=KIND)
    count = {name: sum(n == name for _, n, _, _ in found) for _, name, _, _ in found}
    lengths = [len(values) for _, _, values, _ in found]
    usual = max(lengths, key=lambda n: (lengths.count(n), n))
    columns: dict[str, np.ndarray] = {}
    other: dict[str, int] = {}
    for group, name, values, _ in found:
        shown = name if count[name] == 1 else f"{group}/{name}"
        if len(values) == usual:
            columns[shown] = _plain(values)
        else:
            other[shown] = len(values)
    time = _tdms_time([channel for *_, channel in found if len(channel) == usual])
    return LabLog(str(path), columns, time, np.arange(1, usual + 1), other)


def _plain(values: np.ndarray) -> np.ndarray:
    if values.dtype.kind == "M":
        return (values - np.datetime64("2000-01-01")) / np.timedelta64(1, "ns") * 1e-9
    return values.astype(str) if values.dtype.kind in "OU" else values.astype(float)


def _tdms_time(channels: Sequence[Any]) -> np.ndarray | None:
    """From the start and increment of the first channel that has them."""
    for channel in channels:
        step = channel.properties.get("wf_increment")
        if step:
            return channel.properties.get("wf_start_offset", 0.0) + step * np.arange(len(channel))
    return None
