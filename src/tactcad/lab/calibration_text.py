"""A calibration as text for people, as CSV and as JSON, and read back."""

from __future__ import annotations

import json
from collections.abc import Sequence
from math import inf, isfinite

import numpy as np

from tactcad.design.csv_table import LARGEST_FILE, Field, refuse_duplicates
from tactcad.design.csv_table import read as read_table
from tactcad.design.files import read_json
from tactcad.design.messages import CheckFailure, InputError
from tactcad.lab.calibration import ElementCalibration
from tactcad.lab.load_cell import RIGID, LoadCell
from tactcad.lab.regression import KNOWN
from tactcad.lab.sensitivity import Sensitivity
from tactcad.lab.series_spring import Estimate
from tactcad.report.plain import plain

SCHEMA = "tactcad-calibration-1"
ELEMENT = Field("element", "1", 1, 100_000, integer=True)
STIFFNESS = Field("stiffness_N_per_mm", "N/mm", 1e-6, 1e6)
STIFFNESS_SE = Field("stiffness_se", "N/mm", 0, 1e6)
SENSITIVITY = Field("signal_per_deflection_V_per_mm", "V/mm", -1e6, 1e6)
SENSITIVITY_SE = Field("signal_per_deflection_se", "V/mm", 0, 1e6)
CORRELATION = Field("correlation", "1", -1, 1)
DOF = Field("dof", "1", 1, 1e9)
LEAST_SENSITIVITY = 1e-6  # V/mm: a microvolt at a millimetre
LOAD_CELL = Field("load_cell_N_per_mm", "N/mm", 1e-6, RIGID)
LOAD_CELL_HALF_WIDTH = Field("load_cell_half_width", "N/mm", 0, 1e9)


def to_text(rows: list[ElementCalibration], load_cell: LoadCell, level: float) -> str:
    """A table for the terminal with outliers and notes below it; `level` is that of the intervals."""
    head = (
        "element",
        "runs",
        "K N/mm",
        f"{100 * level:.10g}% interval",
        "as paper",
        "K_v V/mm",
        f"{100 * level:.10g}% interval",
        "K_v/K V/N",
        f"{100 * level:.10g}% interval",
        "V_0 V",
        "max d um",
        "max F N",
        "max dV V",
        "lin F %",
        "lin V %",
    )
    body = [
        (
            str(r.element),
            str(r.runs),
            f"{r.stiffness.value:.3f}",
            _range(r.stiffness),
            f"{r.stiffness_as_paper.value:.3f}",
            f"{r.signal_per_deflection.value:.3f}",
            _range(r.signal_per_deflection),
            f"{r.signal_per_force.value:.4f}",
            _range(r.signal_per_force, 4),
            f"{r.zero_signal:.3f}",
            f"{r.max_deflection * 1e3:.1f}",
            f"{r.max_force:.3f}",
            f"{r.max_signal_change:.3f}",
            f"{r.linearity_force * 100:.2f}",
            f"{r.linearity_signal * 100:.2f}",
        )
        for r in rows
    ]
    width = [max(len(line[i]) for line in [head, *body]) for i in range(len(head))]
    lines = ["  ".join(cell.rjust(w) for cell, w in zip(line, width)) for line in [head, *body]]
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


def _range(e: Estimate, digits: int = 3) -> str:
    return f"{e.low:.{digits}f} to {e.high:.{digits}f}"


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
    names = (
        "element",
        "stiffness_N_per_mm",
        "stiffness_se",
        "max_deflection_um",
        "max_force_N",
        "max_signal_V",
        "signal_per_deflection_V_per_mm",
        "signal_per_deflection_se",
        "correlation",
        "dof",
        "signal_per_force_V_per_N",
        "zero_signal_V",
        "load_cell_N_per_mm",
        "load_cell_half_width",
    )
    lines = [
        f"# calibration by tactcad calibrate; load cell {load_cell.stiffness:g} +- "
        f"{load_cell.half_width:.4g} N/mm in series removed",
        ",".join(names),
    ]
    for r in rows:
        lines.append(
            f"{r.element},"
            + ",".join(
                f"{v:.9g}"
                for v in (
                    r.stiffness.value,
                    r.stiffness.standard_error,
                    r.max_deflection * 1e3,
                    r.max_force,
                    r.max_signal_change,
                    r.signal_per_deflection.value,
                    r.signal_per_deflection.standard_error,
                    r.correlation,
                    r.dof,
                    r.signal_per_force.value,
                    r.zero_signal,
                    min(load_cell.stiffness, RIGID),
                    load_cell.half_width,
                )
            )
        )
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
    rows = read_table(
        path,
        (ELEMENT, STIFFNESS, SENSITIVITY),
        (STIFFNESS_SE, SENSITIVITY_SE, CORRELATION, DOF, LOAD_CELL, LOAD_CELL_HALF_WIDTH),
    )
    refuse_duplicates(rows, ("element",))
    for i in np.flatnonzero(np.abs(rows.values(SENSITIVITY.name)) < LEAST_SENSITIVITY)[:1]:
        raise _no_sensitivity(rows.where(i, SENSITIVITY.name))
    number = rows.values("element").astype(int)

    def pick(name: str, default: float) -> np.ndarray:
        return rows.values(name) if name in rows.columns else np.full(len(number), default)

    return Sensitivity(
        number,
        rows.values("stiffness_N_per_mm"),
        pick("stiffness_se", 0.0),
        rows.values("signal_per_deflection_V_per_mm"),
        pick("signal_per_deflection_se", 0.0),
        pick("correlation", 0.0),
        pick("dof", KNOWN),
        pick("load_cell_N_per_mm", RIGID),
        pick("load_cell_half_width", 0.0),
        path,
    )


def _from_json(path: str) -> Sensitivity:
    data = read_json(path, LARGEST_FILE, "a calibration")
    try:
        elements = data["elements"]
        if data.get("schema") != SCHEMA:
            raise KeyError("schema")
        columns = [
            [
                float(e["element"]),
                e["stiffness"]["value"],
                e["stiffness"]["standard_error"],
                e["signal_per_deflection"]["value"],
                e["signal_per_deflection"]["standard_error"],
                e["correlation"],
                e["dof"],
                min(float(data["load_cell_stiffness_N_per_mm"]), RIGID),
                float(data.get("load_cell_half_width_N_per_mm", 0.0)),
            ]
            for e in elements
        ]
        values = np.array(columns, dtype=float).reshape(-1, 9)
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError):
        raise InputError(
            path, "not a calibration by tactcad calibrate --json", legal=f"schema {SCHEMA}"
        ) from None
    if not len(values):
        raise InputError(path, "a calibration of no element", legal="one element at least")
    fields = (
        ELEMENT,
        STIFFNESS,
        STIFFNESS_SE,
        SENSITIVITY,
        SENSITIVITY_SE,
        CORRELATION,
        DOF,
        LOAD_CELL,
        LOAD_CELL_HALF_WIDTH,
    )
    for field, column in zip(fields, values.T):
        for i in np.flatnonzero(~field.allowed(column))[:1]:
            raise InputError(path, f"{field.name} is not usable", value=float(column[i]), legal=field.legal)
    if (np.abs(values[:, 3]) < LEAST_SENSITIVITY).any():
        raise _no_sensitivity(path)
    number = values[:, 0].astype(int)
    if len(set(number.tolist())) != len(number):
        raise InputError(path, "an element stands twice", value=number.tolist(), legal="each once")
    K, K_se, k_v, k_v_se, correlation, dof, cell, cell_half = values[:, 1:].T
    return Sensitivity(number, K, K_se, k_v, k_v_se, correlation, dof, cell, cell_half, path)


def _no_sensitivity(where: str) -> InputError:
    return InputError(
        where,
        "a sensitivity of zero gives no deflection",
        legal=f"{LEAST_SENSITIVITY:g} V/mm or more, of either sign",
    )
