"""The paper's tables and single figures, as data, with the uncertainty that rounding alone leaves.

Source: "Spring-based tactile array for assistive robotic surgical applications", Tables 1 and 2 and the text.
Values are as printed, with half steps (half a unit of the last printed digit).
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from tactcad.design.csv_table import Field, Rows, half_step, read, refuse_duplicates
from tactcad.design.messages import InputError

TABLE_1_FIELDS = (
    Field("element", "1", 1, 100_000, integer=True),
    Field("stiffness_N_per_mm", "N/mm", 0, 1e6, above=True),
    Field("max_deflection_um", "um", 0, 1e5, above=True),
    Field("max_force_N", "N", 0, 1e4, above=True),
    Field("max_signal_V", "V", 0, 1e3, above=True),
    Field("signal_per_deflection_V_per_mm", "V/mm", -1e6, 1e6),
    Field("signal_per_force_V_per_N", "V/N", -1e6, 1e6),
    Field("zero_signal_V", "V", -1e3, 1e3),
    Field("arm_length_mm", "mm", 0, 1e3, above=True),
)
TABLE_2_FIELDS = (
    Field("measuring_stiffness_N_per_mm", "N/mm", 0, 1e6, above=True),
    Field("object_stiffness_N_per_mm", "N/mm", 0, 1e6, above=True),
    Field("printed_Km_over_Kobj", "1", 0, 1e6, above=True),
    Field("deflection_ratio_R", "1", 0, 1e6, above=True),
)


@dataclass(frozen=True)
class Column:
    """Printed numbers: values and half steps have the same shape."""

    value: np.ndarray
    half_step: np.ndarray

    def __getitem__(self, key: Any) -> Column:
        return Column(self.value[key], self.half_step[key])


@dataclass(frozen=True)
class Table1:
    """Calibration results by element; all arrays have one entry an element, in the file's order."""

    element: np.ndarray  # numbers
    stiffness: Column  # K, N/mm
    deflection: Column  # at the largest force, um
    force: Column  # largest, N
    signal: Column  # largest change, V
    signal_per_deflection: Column  # K_v, V/mm; negative as printed
    signal_per_force: Column  # K_v/K, V/N; negative as printed
    zero_signal: Column  # V_0, V
    arm: Column  # a, mm

    def index(self, number: int) -> int:
        """Row of an element by its number."""
        rows = np.flatnonzero(self.element == number)
        if not len(rows):
            raise InputError("table 1", f"element {number} is not there", legal=str(self.element.tolist()))
        return int(rows[0])


@dataclass(frozen=True)
class Table2:
    """Grasp readings: rows are measuring elements, columns rubber samples."""

    measuring_stiffness: Column  # K_m by row, N/mm
    object_stiffness: Column  # K_obj by column as the header prints it, N/mm
    printed_ratio: Column  # K_m/K_obj as printed, [row, column]
    ratio: Column  # R as measured, [row, column]


@dataclass(frozen=True)
class Published:
    table1: Table1
    table2: Table2
    figure: dict[str, float]  # single figures by name
    half_step: dict[str, float]

    @property
    def reference(self) -> int:
        """Row of the reference element in Table 1."""
        return self.table1.index(int(self.figure["reference_element"]))


def load(table1: str | Path | None = None, table2: str | Path | None = None) -> Published:
    """The paper's data.

    Parameters
    ----------
    table1, table2
        Files of the same form that replace the paper's tables.

    Raises
    ------
    InputError
        With file, line and column: a missing column, text for a number, a value out of range, an element
        listed twice, gaps in the grid of Table 2.
    """
    data = Path(str(files("tactcad.paper"))) / "data"
    lines = [line.split(",") for line in (data / "printed.csv").read_text("utf-8").splitlines()]
    printed = {name: text for name, text, *_ in lines if name[0] != "#" and name != "name"}
    return Published(
        _table1(read(table1 or data / "table1.csv", TABLE_1_FIELDS)),
        _table2(read(table2 or data / "table2.csv", TABLE_2_FIELDS)),
        {name: float(text) for name, text in printed.items()},
        {name: half_step(text) for name, text in printed.items()},
    )


def _column(rows: Rows, field: Field) -> Column:
    return Column(rows.values(field.name), rows.half_steps(field.name))


def _table1(rows: Rows) -> Table1:
    refuse_duplicates(rows, ("element",))
    if len(rows) < 3:
        raise InputError(
            f"{rows.path}:{rows.lines[-1]}:1", "too few elements", value=len(rows), legal="three at least"
        )
    number = rows.values("element").astype(int)
    return Table1(number, *(_column(rows, f) for f in TABLE_1_FIELDS[1:]))


def _table2(rows: Rows) -> Table2:
    measuring, sample, printed, ratio = (f.name for f in TABLE_2_FIELDS)
    refuse_duplicates(rows, (measuring, sample))
    k, x = rows.values(measuring), rows.values(sample)
    k_once, x_once = list(dict.fromkeys(k)), list(dict.fromkeys(x))
    if len(rows) != len(k_once) * len(x_once):
        what, legal = "not every measuring element has every sample", f"{len(k_once)} x {len(x_once)} rows"
        raise InputError(f"{rows.path}:{rows.lines[-1]}:1", what, value=len(rows), legal=legal)
    if len(k_once) < 3 or len(x_once) < 2:
        legal = "three measuring elements and two samples at least"
        raise InputError(f"{rows.path}:{rows.lines[-1]}:1", "too few rows", legal=legal)
    order = np.lexsort(([x_once.index(v) for v in x], [k_once.index(v) for v in k]))
    shape = (len(k_once), len(x_once))

    def grid(field: Field) -> Column:
        column = _column(rows, field)
        return Column(column.value[order].reshape(shape), column.half_step[order].reshape(shape))

    return Table2(
        grid(TABLE_2_FIELDS[0])[:, 0],
        grid(TABLE_2_FIELDS[1])[0],
        grid(TABLE_2_FIELDS[2]),
        grid(TABLE_2_FIELDS[3]),
    )
