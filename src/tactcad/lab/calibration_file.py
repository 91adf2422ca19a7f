"""A calibration as text, CSV and JSON; reading back takes only what grasps need."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from math import inf, isfinite

import numpy as np

from tactcad.design.csv_table import LARGEST_FILE, Field, refuse_duplicates
from tactcad.design.csv_table import read as read_table
from tactcad.design.files import read_json
from tactcad.design.messages import CheckFailure, InputError
from tactcad.lab.calibration import ELEMENT, ElementCalibration
from tactcad.lab.load_cell import RIGID, LoadCell
from tactcad.lab.regression import KNOWN
from tactcad.report.figures import aligned, csv_lines
from tactcad.report.report import plain

SCHEMA = "tactcad-calibration-1"
LEAST_SENSITIVITY = 1e-6  # V/mm: a microvolt at a millimetre
# Figures that the terminal's table has; those of an estimate are followed by its interval.
SHOWN = (
    "element runs stiffness.value stiffness_as_paper.value signal_per_deflection.value "
    "signal_per_force.value zero_signal max_deflection max_force max_signal_change linearity_force "
    "linearity_signal"
).split()
UNBOUNDED = "stiffness_as_paper.value"  # shown for comparison, without its interval and unit
WRITTEN = (
    "element stiffness.value stiffness.standard_error max_deflection max_force max_signal_change "
    "signal_per_deflection.value signal_per_deflection.standard_error correlation dof "
    "signal_per_force.value zero_signal"
).split()
# Fields read back for each element, and their legal ranges.
READ = {
    "element": (1, 100_000),
    "stiffness.value": (1e-6, 1e6),
    "stiffness.standard_error": (0, 1e6),
    "signal_per_deflection.value": (-1e6, 1e6),
    "signal_per_deflection.standard_error": (0, 1e6),
    "correlation": (-1, 1),
    "dof": (1, 1e9),
}
FIELDS = tuple(Field(f.column, f.unit, *READ[f.name], integer=f.digits == "d") for f in ELEMENT.some(*READ))
NUMBER, STIFFNESS, STIFFNESS_SE, SENSITIVITY, SENSITIVITY_SE, CORRELATION, DOF = FIELDS
LOAD_CELL = Field("load_cell_N_per_mm", "N/mm", 1e-6, RIGID)
LOAD_CELL_HALF_WIDTH = Field("load_cell_half_width", "N/mm", 0, 1e9)
ZERO = Field("zero_signal_V", "V", -1e6, 1e6)


@dataclass(frozen=True)
class Sensitivity:
    """A calibration; arrays, [element]."""

    element: np.ndarray  # numbers
    stiffness: np.ndarray  # K, N/mm
    stiffness_se: np.ndarray  # standard error
    signal_per_deflection: np.ndarray  # K_v, V/mm
    signal_per_deflection_se: np.ndarray
    correlation: np.ndarray  # of K and K_v
    dof: np.ndarray  # degrees of freedom of both standard errors
    load_cell: np.ndarray  # stiffness of the load cell that was in series, N/mm
    load_cell_half_width: np.ndarray  # of its limits, N/mm
    path: str = "calibration"
    zero: np.ndarray | None = None  # unloaded signals, V, where the file has them

    def of(self, numbers: np.ndarray) -> Sensitivity:
        """The calibration of these elements, in their order. Raises InputError if one is not in it."""
        place = {int(n): i for i, n in enumerate(self.element)}
        for n in numbers:
            if int(n) not in place:
                legal = str(self.element.tolist())
                raise InputError(self.path, f"element {n} of the grasp is not in it", legal=legal)
        rows = np.array([place[int(n)] for n in numbers])
        own = {f.name: getattr(self, f.name) for f in fields(self) if f.name != "path"}
        return Sensitivity(**{n: v[rows] for n, v in own.items() if v is not None}, path=self.path)

    def at_load_cell_limit(self, sign: float) -> Sensitivity:
        """The calibration that the same readings give with the load cell at its lower (sign -1) or upper (1)
        limit.

        Raises
        ------
        InputError
            At that limit the load cell is no stiffer than element and cell in series were measured to be.
        """
        cell = self.load_cell + sign * self.load_cell_half_width
        old = 1 / (1 + self.stiffness / self.load_cell)  # 1 - k/K_c, as k = K K_c/(K + K_c)
        k, v = self.stiffness * old, self.signal_per_deflection * old
        soft = cell <= k
        if soft.any():
            what = "the softest load cell within its limits is no stiffer than cell and element together"
            legal = f"above {float(k[soft].max()):.4g} N/mm"
            raise InputError(self.path, what, value=float(cell[soft][0]), legal=legal)
        new = 1 - k / cell
        return replace(
            self,
            stiffness=k / new,
            stiffness_se=self.stiffness_se * (old / new) ** 2,
            signal_per_deflection=v / new,
            signal_per_deflection_se=self.signal_per_deflection_se * old / new,
        )


def to_text(rows: list[ElementCalibration], load_cell: LoadCell, level: float) -> str:
    """A table for the terminal with outliers and notes below it; `level` is that of the intervals."""
    columns = []
    for f in ELEMENT.some(*SHOWN):
        estimate, _, kind = f.name.partition(".")
        told = "as paper" if f.name == UNBOUNDED else f.title
        columns.append([told, *map(f.text, rows)])
        if kind and f.name != UNBOUNDED:
            low, high = ELEMENT.some(f"{estimate}.low", f"{estimate}.high")
            ends = (f"{low.text(r)} to {high.text(r)}" for r in rows)
            columns.append([f"{100 * level:.10g}% interval", *ends])
    lines = aligned([*zip(*columns)])
    lines += [
        "",
        f"load cell in series: {load_cell.stiffness:g} N/mm, and the intervals hold for every one from "
        f"{load_cell.ends[0]:.4g} to {load_cell.ends[1]:.4g} N/mm (--load-cell)",
        "K, K_v, K_v/K by weighted fit of all runs from the second displacement on (contact may begin within "
        "the first step), intervals by the scatter from run to run; 'as paper': averaged runs, force against "
        "deflection",
    ]
    for r in rows:
        lines += [
            f"outlier: element {o.element}, run {o.run}, displacement {o.displacement:g} mm, {o.quantity} "
            f"(line {o.line})"
            for o in r.outliers
        ]
        lines += [f"element {r.element}: {note}" for note in r.notes]
    return "\n".join(lines) + "\n"


def to_json(
    rows: list[ElementCalibration], load_cell: LoadCell, level: float, warnings: Sequence[str] = ()
) -> str:
    """All fields of every element as JSON, infinities as text; `level` is that of the intervals."""
    data = {
        "schema": SCHEMA,
        "load_cell_stiffness_N_per_mm": load_cell.stiffness,
        "load_cell_half_width_N_per_mm": load_cell.half_width,
        "level": level,
        "units": "mm, N, V",
        "warnings": warnings,
        "elements": rows,
    }
    return json.dumps(plain(data), indent=1, allow_nan=False) + "\n"


def to_csv(rows: list[ElementCalibration], load_cell: LoadCell) -> str:
    """Table 1's columns with standard errors as CSV, which `read` reads back.

    Raises
    ------
    CheckFailure
        The readings of an element do not bound its stiffness.
    """
    for r in rows:
        if not (0 < r.stiffness.value < inf and isfinite(r.stiffness.standard_error)):
            raise CheckFailure(
                f"element {r.element}: the readings do not give its stiffness, so there is no calibration "
                "to write"
            )
    names, *cells = csv_lines(ELEMENT.some(*WRITTEN), rows, ".9g")
    in_series = [f"{v:.9g}" for v in (min(load_cell.stiffness, RIGID), load_cell.half_width)]
    lines = [
        f"# calibration by tactcad calibrate; load cell {load_cell.stiffness:g} +- "
        f"{load_cell.half_width:.4g} N/mm in series removed",
        ",".join([*names, LOAD_CELL.name, LOAD_CELL_HALF_WIDTH.name]),
        *(",".join([*line, *in_series]) for line in cells),
    ]
    return "\n".join(lines) + "\n"


def read(path: str) -> Sensitivity:
    """A calibration from the CSV of `to_csv` or the JSON of `to_json`.

    Parameters
    ----------
    path : str
        Read as JSON where it ends in .json. Values without a column of uncertainties count as exact.

    Returns
    -------
    Sensitivity
        In the order of the file.

    Raises
    ------
    InputError
        Not such a file; an element that is listed twice; a value out of its range; a sensitivity of zero.
    """
    if path.endswith(".json"):
        return _from_json(path)
    other = (STIFFNESS_SE, SENSITIVITY_SE, CORRELATION, DOF, LOAD_CELL, LOAD_CELL_HALF_WIDTH, ZERO)
    rows = read_table(path, (NUMBER, STIFFNESS, SENSITIVITY), other)
    refuse_duplicates(rows, ("element",))
    for i in np.flatnonzero(np.abs(rows.values(SENSITIVITY.name)) < LEAST_SENSITIVITY)[:1]:
        raise _no_sensitivity(rows.where(i, SENSITIVITY.name))
    absent = {DOF.name: KNOWN, LOAD_CELL.name: RIGID}  # all else is 0, and so exact
    count = len(rows.values(NUMBER.name))
    columns = [
        rows.columns.get(f.name, np.full(count, absent.get(f.name, 0.0)))
        for f in (*FIELDS, LOAD_CELL, LOAD_CELL_HALF_WIDTH)
    ]
    return _sensitivity(columns, path, rows.columns.get(ZERO.name))


def _from_json(path: str) -> Sensitivity:
    data = read_json(path, LARGEST_FILE, "a calibration")
    try:
        elements = data["elements"]
        if data.get("schema") != SCHEMA:
            raise KeyError("schema")
        in_series = (
            min(float(data["load_cell_stiffness_N_per_mm"]), RIGID),
            float(data.get("load_cell_half_width_N_per_mm", 0.0)),
        )
        zeros = [float(e["zero_signal"]) for e in elements if e.get("zero_signal") is not None]
        values = np.array([[*(float(f.of(e)) for f in ELEMENT.some(*READ)), *in_series] for e in elements])
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError):
        raise InputError(
            path, "not a calibration by tactcad calibrate --json", legal=f"schema {SCHEMA}"
        ) from None
    if not len(values):
        raise InputError(path, "a calibration of no element", legal="one element at least")
    for field, column in zip((*FIELDS, LOAD_CELL, LOAD_CELL_HALF_WIDTH), values.T):
        for i in np.flatnonzero(~field.allowed(column))[:1]:
            raise InputError(path, f"{field.name} is not usable", value=float(column[i]), legal=field.legal)
    if (np.abs(values[:, FIELDS.index(SENSITIVITY)]) < LEAST_SENSITIVITY).any():
        raise _no_sensitivity(path)
    number = values[:, 0].astype(int)
    if len(set(number.tolist())) != len(number):
        raise InputError(path, "an element is listed twice", value=number.tolist(), legal="each once")
    return _sensitivity(list(values.T), path, np.array(zeros) if len(zeros) == len(number) else None)


def _sensitivity(columns: list[np.ndarray], path: str, zero: np.ndarray | None) -> Sensitivity:
    """From the columns of FIELDS and the load cell's, which are its fields."""
    named = dict(zip((f.name for f in fields(Sensitivity)), columns))
    return Sensitivity(**(named | {"element": columns[0].astype(int)}), path=path, zero=zero)


def _no_sensitivity(where: str) -> InputError:
    legal = f"{LEAST_SENSITIVITY:g} V/mm or more, of either sign"
    return InputError(where, "a sensitivity of zero gives no deflection", legal=legal)
