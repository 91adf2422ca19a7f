"""Closed forms of many designs, one vector call for each rung and element; and which designs are refused."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tactcad.design.family import taken_as
from tactcad.design.load import from_table
from tactcad.design.materials import differences
from tactcad.design.messages import InputError
from tactcad.design.tree import CommonTables, Design
from tactcad.mechanics import ladder, strain, strength
from tactcad.mechanics.accuracy import expected_error_of
from tactcad.mechanics.section import HingeSection
from tactcad.parts.array.hinge_section import element_section
from tactcad.parts.array.layout import Layout

from .designs_taken import Column, table_of, with_value
from .study import STRENGTH, Study

Floats = NDArray[np.float64]

STIFFNESS = ("stiffness", "expected_error")  # N/mm; relative, at most
FORCES = ("yield_force", "rated_force", "rated_deflection")  # N, N, mm


# Designs of a chunk: all, as views instead of copies, or those of an index.
Rows = slice | NDArray[np.int64]
ALL = slice(None)


class Refused:
    """Mask of the `valid` ones of `count` designs, and `reason` of the others ("" for a valid one)."""

    def __init__(self, count: int) -> None:
        self.valid = np.ones(count, bool)
        self._reason: NDArray[Any] | None = None  # made only when one is refused, which is rare

    @property
    def reason(self) -> NDArray[Any]:
        if self._reason is None:
            self._reason = np.full(len(self.valid), "", object)
        return self._reason

    def add(self, rows: Rows, why: NDArray[Any] | str) -> None:
        """Refuse those of the rows that are not refused yet and have a reason that is not ""."""
        index = np.arange(len(self.valid))[rows]
        first = self.valid[index]
        self.reason[index[first]] = np.broadcast_to(why, len(index))[first]
        self.valid[index] = self.reason[index] == ""

    def left(self, rows: Rows) -> Rows:
        """Those of the rows that are not refused."""
        if isinstance(rows, slice) and self.valid.all():
            return rows
        index = np.arange(len(self.valid))[rows]
        return index[self.valid[index]]


def names_of(study: Study, rung: str, number: int) -> list[str]:
    """Columns of one element's results by one rung."""
    return [f"{rung}.E{number}.{name}" for name in STIFFNESS + FORCES * (STRENGTH in study.measure.what)]


def closed_forms(
    study: Study, columns: dict[str, Column], refused: Refused, results: Mapping[str, Floats]
) -> None:
    """Fill in what closed forms say of these designs.

    Parameters
    ----------
    study
        The study.
    columns
        The designs.
    refused
        Mask of those not to be measured; those refused by closed forms are added.
    results
        By column, NaN if nothing is known: filled in.
    """
    rungs = [rung for rung in study.measure.rungs if rung in ladder.CLOSED_FORMS]
    if not rungs:
        return
    for rows, many in alike(study, columns, refused):
        for number in study.elements:
            if number > len(many.elements):
                refused.add(rows, f"the design has no element {number}")
                continue
            section = element_section(many, many.elements[number - 1])
            for rung in rungs:
                result = ladder.evaluate(section, rung)
                all_valid = result.valid.all()
                if not all_valid:
                    said = [why and f"{rung} E{number}: {why}" for why in result.reason.flat]
                    refused.add(rows, np.array(said, object))
                values = [result.stiffness, expected_error_of(section, rung)]
                if STRENGTH in study.measure.what:
                    values += _forces(many.design, section, rung, result)
                for name, column in zip(names_of(study, rung, number), values):
                    results[name][rows] = column if all_valid else np.where(result.valid, column, np.nan)


def _forces(d: Design, section: HingeSection, rung: str, result: ladder.Result) -> list[Floats]:
    """In the order of FORCES, each over all designs; NaN if out of the rung's range."""
    per_newton = np.full(section.shape, np.nan)
    if result.valid.any():
        per_newton[result.valid] = strain.leaf_stress(section.rows(result.valid.reshape(-1)), 1.0, rung)
    at_yield = d.material.yield_strength / per_newton
    deflection = strength.rated_deflection(at_yield, result.stiffness, d.rating)
    return [at_yield, strength.rated_force(at_yield, d.rating), deflection]


def alike(study: Study, columns: dict[str, Column], refused: Refused) -> Iterator[tuple[Rows, Layout]]:
    """Rows that differ in numbers only, and the layout of all of them at once. Designs that cannot be read
    are refused."""
    numbers = {path: column for path, column in columns.items() if column.dtype != object}
    others = {path: column for path, column in columns.items() if column.dtype == object}
    alike: dict[str, list[int]] = {}
    for i, row in enumerate(zip(*others.values())):
        alike.setdefault(json.dumps(row), []).append(i)
    groups: list[Rows] = [np.array(rows) for rows in alike.values()] if others else [ALL]
    for rows in groups:
        try:
            first = {path: column[rows] for path, column in others.items()}
            design = from_table(table_of(study, first, 0)) if others else study.design
        except InputError as error:
            refused.add(rows, str(error))
            continue
        material = {path: column[rows] for path, column in numbers.items() if path.startswith("material.")}
        if material:
            refused.add(rows, _misnamed(design, material))
        rows = refused.left(rows)
        if refused.valid[rows].any():
            for path, column in numbers.items():
                design = with_value(design, path, column[rows])
            yield rows, Layout(taken_as(design, Design, "measure.what: a rung"))


def _misnamed(design: CommonTables, material: dict[str, Floats]) -> Column:
    """Why these values may not bear the material's name, as when their file is read; "" if they may."""
    why = []
    for values in zip(*material.values()):
        own = {path.partition(".")[2]: float(value) for path, value in zip(material, values)}
        try:
            differences(design.material.alloy, vars(design.material) | own, design.origin)
            why.append("")
        except InputError as error:
            why.append(str(error))
    return np.array(why, object)
