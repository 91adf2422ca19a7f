"""A table of designs in, the same table with stiffness out (CSV; mm, MPa, N/mm)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tactcad.design import csv_table
from tactcad.design.csv_table import Field, Table, numeric, require_columns
from tactcad.design.files import as_csv, write_whole
from tactcad.design.messages import CheckFailure, InputError, one_of
from tactcad.mechanics import ladder
from tactcad.mechanics.accuracy import choose_each, expected_error_of
from tactcad.mechanics.section import OPTIONAL, REQUIRED, HingeSection

SIDES = {"one": False, "two": True}
DEFAULT_SIDES = "two"
MOST_BYTES = 200_000_000  # a million designs and more
KNOWN = (*REQUIRED, *OPTIONAL, "sides")
ADDED = ("stiffness", "model", "valid", "reason", "expected_error")
ADDED_BY_ACCURACY = ("mesh",)


def estimate_file(
    source: str | Path, target: str | Path, rung: str, accuracy: Callable[[HingeSection], float] | None = None
) -> tuple[int, int]:
    """Estimate the stiffness of every row of a table of designs.

    Parameters
    ----------
    source : str or Path
        CSV with the columns of `section.REQUIRED` (mm, MPa); others are copied.
    target : str or Path
        The same table with the ADDED columns, stiffness in N/mm.
    rung : str
        Of the ladder, for every row.
    accuracy : callable, optional
        Gives the allowed relative error for all rows' dimensions; every row then gets the cheapest rung
        within it, instead of `rung`.

    Returns
    -------
    in_range, rows : int
        Rows that got a stiffness, and rows in all.

    Raises
    ------
    InputError
        The table is malformed (file:line:column); nothing is written.
    """
    header, rows, section = read_table(Path(source))
    if accuracy is None:
        stiffness, reasons = estimate_rows(section, rung)
        errors = np.broadcast_to(expected_error_of(section, rung), section.shape).ravel().tolist()
        added = [(k, rung, why, error) for k, why, error in zip(stiffness, reasons, errors)]
        table = as_csv([[*header, *ADDED], *(row + _answer(*a) for row, a in zip(rows, added))], "\n")
    else:
        if clash := set(ADDED_BY_ACCURACY) & set(header):
            column = header.index(clash.pop())
            raise InputError(
                f"{source}:1:{column + 1}", "column is one that this command adds", value=header[column]
            )
        answers = estimate_rows_to(section, accuracy(section))
        reasons = [a.reason for a in answers]
        whole = [
            [*row, *_answer(a.stiffness, a.model, a.reason, a.expected_error), str(a.mesh or "")]
            for row, a in zip(rows, answers)
        ]
        table = as_csv([[*header, *ADDED, *ADDED_BY_ACCURACY], *whole], "\n")
    write_whole(target, table)
    return sum(not r for r in reasons), len(rows)


@dataclass(frozen=True)
class Answer:
    """The estimate of one row, or the reason for its refusal."""

    stiffness: float  # N/mm; nan without one
    model: str
    mesh: int | None  # density, of rung fem-solid
    expected_error: float  # relative, at most
    reason: str  # "" with an estimate


def estimate_rows_to(section: HingeSection, accuracy: float) -> list[Answer]:
    """Every design of the section's arrays by the quickest rung that keeps to the relative accuracy."""
    choices = choose_each(section, accuracy)
    refused = [c if isinstance(c, str) else "" for c in choices]
    answers = [Answer(math.nan, "", None, math.nan, why) for why in refused]
    chosen = {i: c for i, c in enumerate(choices) if not isinstance(c, str)}
    for candidate in {c.candidate for c in chosen.values()}:
        index = [i for i, c in chosen.items() if c.candidate == candidate]
        stiffness, reasons = estimate_rows(section.rows(index), candidate.rung, candidate.mesh)
        for i, K, why in zip(index, stiffness, reasons):
            answers[i] = Answer(K, candidate.rung, candidate.mesh, chosen[i].expected_error, why)
    return answers


def estimate_rows(section: HingeSection, rung: str, mesh: int | None = None) -> tuple[list[float], list[str]]:
    """Stiffness of every design of the section's arrays (N/mm; NaN if refused) and the reason of each
    refusal ("" elsewhere). `mesh` is the density of rung fem-solid's mesh."""
    if rung not in ladder.FINITE_ELEMENTS:
        result = ladder.evaluate(section, rung)
        return result.stiffness.ravel().tolist(), result.reason.ravel().tolist()
    from tactcad.fem.fem_ladder import SOLID_MESH, stiffness

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
    """Header, rows as text, and the dimensions of all rows as one section of arrays.

    Raises InputError if the table is malformed.
    """
    table = csv_table.read_table(path, "a table of designs (CSV)", MOST_BYTES, comments=False)
    for name in [name for name in table.header if name in ADDED]:
        where = table.where(table.header_line, name)
        raise InputError(where, "column is one that this command adds", value=name)
    require_columns(table, REQUIRED, KNOWN)
    return table.header, [row for _, row in table.records], _section(table)


def _section(table: Table) -> HingeSection:
    names = [name for name in (*REQUIRED, *OPTIONAL) if name in table.header]
    rows = numeric(table, tuple(Field(name, "") for name in names))
    numbers = {name: np.full(len(rows), default) for name, default in OPTIONAL.items()} | rows.columns
    sides = [DEFAULT_SIDES] * len(rows)
    if "sides" in table.header:
        sides = [_side(table, *cell) for cell in zip(rows.lines, table.column("sides"))]
    return HingeSection.of(**numbers, two_sided=[SIDES[side] for side in sides])


def _side(table: Table, line: int, side: str) -> str:
    if side not in SIDES:
        raise InputError(
            table.where(line, "sides"), "unknown notch form", value=side, legal=one_of(side, SIDES)
        )
    return side


def _answer(stiffness: float, model: str, reason: str, error: float) -> list[str]:
    """A row's cells for the ADDED columns; the error is left blank if none was measured."""
    number = "" if reason else repr(stiffness)
    return [
        number,
        model,
        "false" if reason else "true",
        reason,
        "" if reason or math.isnan(error) else repr(error),
    ]
