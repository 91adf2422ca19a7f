"""A table of designs in, the same table with stiffness out (CSV; mm, MPa, N/mm)."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tactcad.design.csv_table import records
from tactcad.design.files import read_text, write_whole
from tactcad.design.messages import CheckFailure, InputError, one_of
from tactcad.mechanics import ladder
from tactcad.mechanics.accuracy import choose_each
from tactcad.mechanics.section import OPTIONAL, REQUIRED, HingeSection

SIDES = {"one": False, "two": True}
DEFAULT_SIDES = "two"
MOST_BYTES = 200_000_000  # a million designs and more
ADDED = ("stiffness", "model", "valid", "reason")
ADDED_BY_ACCURACY = ("mesh", "expected_error")


def estimate_file(
    source: str | Path, target: str | Path, rung: str, accuracy: float | None = None
) -> tuple[int, int]:
    """Estimate every row of `source` into `target`; returns how many are in range, and how many there are.

    With an `accuracy` every row is answered by the quickest rung that keeps it there, whatever `rung` says.
    Raises InputError (file:line:column) where the table is malformed; nothing is then written.
    """
    header, rows, section = read_table(Path(source))
    if accuracy is None:
        stiffness, reasons = estimate_rows(section, rung)
        added = [(k, rung, why) for k, why in zip(stiffness, reasons)]
        table = _table_bytes([*header, *ADDED], [row + _answer(*a) for row, a in zip(rows, added)])
    else:
        if clash := set(ADDED_BY_ACCURACY) & set(header):
            column = header.index(clash.pop())
            raise InputError(
                f"{source}:1:{column + 1}", "column is one that this command adds", value=header[column]
            )
        answers = estimate_rows_to(section, accuracy)
        reasons = [a.reason for a in answers]
        whole = [row + _answer(a.stiffness, a.model, a.reason) + _promise(a) for row, a in zip(rows, answers)]
        table = _table_bytes([*header, *ADDED, *ADDED_BY_ACCURACY], whole)
    write_whole(target, table)
    return sum(not r for r in reasons), len(rows)


@dataclass(frozen=True)
class Answer:
    """Of one row: stiffness (N/mm), the chosen model and what it promises, or the reason why there is
    none."""

    stiffness: float
    model: str
    mesh: int | None
    expected_error: float
    reason: str


def estimate_rows_to(section: HingeSection, accuracy: float) -> list[Answer]:
    """Every design by the quickest rung that keeps the relative accuracy there."""
    choices = choose_each(section, accuracy)
    refused = [c if isinstance(c, str) else "" for c in choices]
    answers = [Answer(math.nan, "", None, math.nan, why) for why in refused]
    for candidate in {c.candidate for c in choices if not isinstance(c, str)}:
        index = [i for i, c in enumerate(choices) if not isinstance(c, str) and c.candidate == candidate]
        stiffness, reasons = estimate_rows(section.rows(index), candidate.rung, candidate.mesh)
        for i, K, why in zip(index, stiffness, reasons):
            answers[i] = Answer(K, candidate.rung, candidate.mesh, choices[i].expected_error, why)
    return answers


def estimate_rows(section: HingeSection, rung: str, mesh: int | None = None) -> tuple[list[float], list[str]]:
    """Stiffness (N/mm, NaN where refused) and reason ("" where not) of every design; `mesh` as
    fem-solid's."""
    if rung not in ladder.FINITE_ELEMENTS:
        result = ladder.evaluate(section, rung)
        return result.stiffness.ravel().tolist(), result.reason.ravel().tolist()
    from tactcad.fem.convergence import SOLID_MESH
    from tactcad.fem.ladder import stiffness

    values, reasons = [], []
    for i in range(section.hinge_thickness.size):
        try:
            values.append(stiffness(section.rows(i), rung, mesh or SOLID_MESH))
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
    return HingeSection.of(**numbers, two_sided=[SIDES[side] for side in sides])


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


def _answer(stiffness: float, model: str, reason: str) -> list[str]:
    """The ADDED columns of a row."""
    return ["" if reason else repr(stiffness), model, "false" if reason else "true", reason]


def _promise(answer: Answer) -> list[str]:
    """The ADDED_BY_ACCURACY columns of a row."""
    return ["", ""] if answer.reason else [str(answer.mesh or ""), repr(answer.expected_error)]


def _table_bytes(header: list[str], rows: list[list[str]]) -> bytes:
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(rows)
    return text.getvalue().encode()
