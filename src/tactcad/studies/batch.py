"""A table of designs in, the same table with stiffness out (CSV; mm, MPa, N/mm)."""

from __future__ import annotations

import csv
import io
import math
from pathlib import Path

import numpy as np

from tactcad.design.files import read_text, write_whole
from tactcad.design.messages import CheckFailure, InputError, one_of
from tactcad.mechanics import ladder
from tactcad.mechanics.section import HingeSection

from .csv_table import records

REQUIRED = (
    "hinge_thickness",
    "hinge_length",
    "fillet_radius",
    "load_arm",
    "arm_height",
    "body_height",
    "body_length",
    "poisson",
    "youngs_modulus",
    "width",
)
OPTIONAL = {"pad_height": 0.0, "friction": 0.0}
SIDES = {"one": False, "two": True}
DEFAULT_SIDES = "two"
MOST_BYTES = 200_000_000  # a million designs and more
ADDED = ("stiffness", "model", "valid", "reason")


def estimate_file(source: str | Path, target: str | Path, rung: str) -> tuple[int, int]:
    """Estimate every row of `source` into `target`; returns how many are in range, and how many there are.

    Raises InputError (file:line:column) where the table is malformed; nothing is then written.
    """
    header, rows, section = read_table(Path(source))
    stiffness, reasons = estimate_rows(section, rung)
    write_whole(target, _table_bytes(header, rows, stiffness, reasons, rung))
    return sum(not r for r in reasons), len(rows)


def estimate_rows(section: HingeSection, rung: str) -> tuple[list[float], list[str]]:
    """Stiffness (N/mm, NaN where refused) and reason ("" where not) of every design."""
    if rung not in ladder.FINITE_ELEMENTS:
        result = ladder.evaluate(section, rung)
        return result.stiffness.tolist(), result.reason.tolist()
    from tactcad.fem.ladder import stiffness

    values, reasons = [], []
    for i in range(section.hinge_thickness.size):
        try:
            values.append(stiffness(section.rows(i), rung))
            reasons.append("")
        except CheckFailure as refusal:
            values.append(math.nan)
            reasons.append(str(refusal))
    return values, reasons


def read_table(path: Path) -> tuple[list[str], list[list[str]], HingeSection]:
    """Header, rows as text, and the section of arrays. Raises InputError where the table is malformed."""
    lines = records(str(path), read_text(path, MOST_BYTES, "a table of designs (CSV)"))
    if not lines:
        raise InputError(f"{path}:1:1", "the file is empty", legal="a header line of column names")
    header = [name.strip() for name in lines[0][1]]
    _check_header(path, header)
    rows = []
    for number, row in lines[1:]:
        if not row:  # an empty line
            continue
        if len(row) != len(header):
            raise InputError(
                f"{path}:{number}:{min(len(row), len(header)) + 1}",
                f"{len(row)} fields where the header has {len(header)}",
            )
        rows.append((number, row))
    return header, [row for _, row in rows], _section(path, header, rows)


def _check_header(path: Path, header: list[str]) -> None:
    for column, name in enumerate(header, 1):
        if header.index(name) != column - 1:
            raise InputError(f"{path}:1:{column}", "column stands twice", value=name)
        if name in ADDED:
            raise InputError(f"{path}:1:{column}", "column is one that this command adds", value=name)
    missing = [name for name in REQUIRED if name not in header]
    if missing:
        raise InputError(
            f"{path}:1:{len(header) + 1}",
            f"column {missing[0]} is missing",
            legal=", ".join(REQUIRED) + "; optional sides, " + ", ".join(OPTIONAL),
        )


def _section(path: Path, header: list[str], rows: list[tuple[int, list[str]]]) -> HingeSection:
    numbers = {}
    for name in (*REQUIRED, *OPTIONAL):
        if name in header:
            column = header.index(name)
            numbers[name] = np.array(
                [_number(path, line, column, row[column]) for line, row in rows], dtype=float
            )
        else:
            numbers[name] = np.full(len(rows), OPTIONAL[name])
    sides = [DEFAULT_SIDES] * len(rows)
    if "sides" in header:
        column = header.index("sides")
        sides = [_side(path, line, column, row[column]) for line, row in rows]
    return HingeSection(**numbers, two_sided=[SIDES[side] for side in sides])


def _number(path: Path, line: int, column: int, text: str) -> float:
    try:
        value = float(text) if "_" not in text else math.nan
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{path}:{line}:{column + 1}", "expected a finite number", value=text)
    return value


def _side(path: Path, line: int, column: int, text: str) -> str:
    side = text.strip()
    if side not in SIDES:
        raise InputError(
            f"{path}:{line}:{column + 1}", "unknown notch form", value=text, legal=one_of(side, SIDES)
        )
    return side


def _table_bytes(
    header: list[str], rows: list[list[str]], stiffness: list[float], reasons: list[str], rung: str
) -> bytes:
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([*header, *ADDED])
    for row, value, reason in zip(rows, stiffness, reasons):
        writer.writerow([*row, "" if reason else repr(value), rung, "false" if reason else "true", reason])
    return text.getvalue().encode()
