"""A lab's own readings from CSV: calibration runs and grasps.

Columns may carry their unit (displacement_um, force_N, signal_mV); a plain name is in mm, N, V.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tactcad.design.csv_table import Field, Rows, header, read, refuse_duplicates
from tactcad.design.messages import InputError

ELEMENT = Field("element", "1", 1, 100_000, integer=True)
RUN = Field("run", "1", 0, 1_000_000, integer=True)
SAMPLE = Field("sample", "1", 0, 1_000_000, integer=True)

# unit -> factor to mm, N, V. The ranges catch a column in another unit: no calibration travels 10 mm.
UNITS = {
    "displacement": ({"": 1.0, "_mm": 1.0, "_um": 1e-3}, "mm", 10.0),
    "force": ({"": 1.0, "_N": 1.0, "_mN": 1e-3}, "N", 1000.0),
    "load": ({"": 1.0, "_N": 1.0, "_mN": 1e-3}, "N", 1000.0),
    "signal": ({"": 1.0, "_V": 1.0, "_mV": 1e-3}, "V", 1000.0),
}


@dataclass(frozen=True)
class CalibrationReadings:
    """One row a reading; displacement of the stage (mm), force (N), signal (V), line in the file."""

    element: np.ndarray
    run: np.ndarray
    displacement: np.ndarray
    force: np.ndarray
    signal: np.ndarray
    line: np.ndarray


@dataclass(frozen=True)
class GraspReadings:
    """Signals (V) of all elements at every load of one sample: signal[element, state]."""

    sample: int
    element: np.ndarray
    load: np.ndarray  # N, by state
    run: np.ndarray  # by state
    signal: np.ndarray


def calibration(path: str | Path) -> CalibrationReadings:
    """Readings of `tactcad calibrate`. Raises InputError with file, line and column."""
    rows, scaled = _read(path, (ELEMENT, RUN), ("displacement", "force", "signal"))
    refuse_duplicates(
        rows,
        ("element", "run", scaled["displacement"][0]),
        "each displacement once a run; number an upward and a downward stroke as two runs",
    )
    out = CalibrationReadings(
        rows.values("element").astype(int),
        rows.values("run").astype(int),
        *(rows.values(name) * factor for name, factor in scaled.values()),
        np.array(rows.lines),
    )
    for number in dict.fromkeys(out.element):
        here = np.flatnonzero(out.element == number)
        runs = len(set(out.run[here]))
        if len(here) < runs + 3 or len(set(out.displacement[here])) < 3:
            raise InputError(
                rows.where(int(here[-1]), "element"),
                f"too few readings of element {number}",
                value=len(here),
                legal="three more than runs, at three displacements at least",
            )
    return out


def grasps(path: str | Path) -> list[GraspReadings]:
    """Readings of `tactcad stiffness`, one entry a sample. Raises InputError with file, line and column.

    Every element must be read at every load of a run, so that one approach of the array moves all of them.
    """
    rows, scaled = _read(path, (ELEMENT,), ("load", "signal"), optional=(RUN, SAMPLE))
    load_name = scaled["load"][0]
    key = tuple(n for n in ("sample", "run") if n in rows.columns) + (load_name, "element")
    refuse_duplicates(rows, key)
    element = rows.values("element").astype(int)
    load, signal = (rows.values(name) * factor for name, factor in scaled.values())
    run = rows.values("run").astype(int) if "run" in rows.columns else np.zeros(len(rows), int)
    sample = rows.values("sample").astype(int) if "sample" in rows.columns else np.ones(len(rows), int)
    found = []
    for number in dict.fromkeys(sample):
        here = np.flatnonzero(sample == number)
        elements = list(dict.fromkeys(element[here]))
        states = list(dict.fromkeys(zip(run[here], load[here])))
        grid = np.full((len(elements), len(states)), np.nan)
        for i in here:
            grid[elements.index(element[i]), states.index((run[i], load[i]))] = signal[i]
        if np.isnan(grid).any():
            e, s = np.argwhere(np.isnan(grid))[0]
            raise InputError(
                rows.where(int(here[-1]), "element"),
                f"element {elements[e]} has no signal at load {states[s][1]:g} N",
                legal="every element at every load",
            )
        found.append(
            GraspReadings(
                int(number),
                np.array(elements),
                np.array([s[1] for s in states]),
                np.array([s[0] for s in states]),
                grid,
            )
        )
    return found


def _read(
    path: str | Path, fixed: tuple[Field, ...], measured: tuple[str, ...], optional: tuple[Field, ...] = ()
) -> tuple[Rows, dict[str, tuple[str, float]]]:
    """Rows, and for each measured quantity its column's name and factor to mm, N, V."""
    there = header(path)
    scaled, fields = {}, []
    for quantity in measured:
        factors, unit, most = UNITS[quantity]
        names = [quantity + suffix for suffix in factors if quantity + suffix in there]
        name = names[0] if names else quantity
        factor = factors[name.removeprefix(quantity)]
        low = 0.0 if quantity == "load" else -most / factor
        fields.append(
            Field(name, name.removeprefix(quantity + "_") if "_" in name else unit, low, most / factor)
        )
        scaled[quantity] = (name, factor)
    return read(path, (*fixed, *fields), optional), scaled
