"""A lab's own readings from CSV: calibration runs and grasps.

Columns may carry their unit (displacement_um, force_N, signal_mV); a plain name is in mm, N, V.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tactcad.design.csv_table import Field, Rows, Table, numeric, read_table, refuse_duplicates
from tactcad.design.messages import InputError
from tactcad.lab.regression import steps

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
    path: str = "readings"


@dataclass(frozen=True)
class GraspReadings:
    """Signals (V) of all elements at every load of one sample: signal[element, state]."""

    sample: int
    element: np.ndarray
    load: np.ndarray  # N, by state
    run: np.ndarray  # by state
    signal: np.ndarray
    path: str = "readings"


def calibration(path: str | Path) -> CalibrationReadings:
    """Readings of `tactcad calibrate`. Raises InputError with file, line and column."""
    rows, scaled = _read(path, (ELEMENT, RUN), ("displacement", "force", "signal"))
    refuse_duplicates(
        rows,
        ("element", "run", scaled["displacement"][0]),
        "each displacement once a run; number an upward and a downward stroke as two runs",
    )
    displacement, force, signal = (rows.values(name) * factor for name, factor in scaled.values())
    out = CalibrationReadings(
        rows.values("element").astype(int),
        rows.values("run").astype(int),
        displacement,
        force,
        signal,
        rows.lines,
        rows.path,
    )
    for number, here in groups(out.element):
        runs, at = len(np.unique(out.run[here])), np.unique(steps(out.displacement[here]))
        if len(here) < runs + 3 or len(at) < 3:
            raise InputError(
                rows.where(int(here[-1]), "element"),
                f"too few readings of element {number}",
                value=len(here),
                legal="three more than runs, at three displacements at least",
            )
        least = int(here[np.argmin(out.displacement[here])])
        if -out.displacement[least] > out.displacement[here].max():
            raise InputError(
                rows.where(least, scaled["displacement"][0]),
                f"element {number} is pressed to negative displacements: the column's sign is reversed",
                value=f"{out.displacement[least]:g} mm",
                legal="displacement and force both grow as the element is pressed",
            )
    return out


def groups(number: np.ndarray) -> list[tuple[int, np.ndarray]]:
    """Every number in the order of its first row, with its rows."""
    order = np.argsort(number, kind="stable")
    numbers, first = np.unique(number[order], return_index=True)
    found = list(zip(numbers.tolist(), np.split(order, first[1:])))
    return sorted(found, key=lambda group: group[1][0])


def grasps(path: str | Path) -> list[GraspReadings]:
    """Readings of `tactcad stiffness`, one entry a sample. Raises InputError with file, line and column.

    Every element must be read at every load of a run, so that one approach of the array moves all of them.
    """
    rows, scaled = _read(path, (ELEMENT,), ("load", "signal"), optional=(RUN, SAMPLE))
    run, sample = (
        rows.values(n).astype(int) if n in rows.columns else np.ones(len(rows), int)
        for n in ("run", "sample")
    )
    (load_name, _), _ = scaled.values()
    refuse_duplicates(rows, (*(n for n in ("sample", "run") if n in rows.columns), load_name, "element"))
    element = rows.values("element").astype(int)
    load, signal = (rows.values(name) * factor for name, factor in scaled.values())
    return [
        _grasp(rows, number, here, element[here], load[here], run[here], signal[here])
        for number, here in groups(sample)
    ]


def _grasp(
    rows: Rows,
    sample: int,
    here: np.ndarray,
    element: np.ndarray,
    load: np.ndarray,
    run: np.ndarray,
    signal: np.ndarray,
) -> GraspReadings:
    """The grid of one sample's signals; elements and states in the order of their first rows."""
    state = np.empty(len(here), [("run", int), ("load", float)])
    state["run"], state["load"] = run, load
    elements, row = _numbered(element)
    states, column = _numbered(state)
    grid = np.full((len(elements), len(states)), np.nan)
    grid[row, column] = signal
    if np.isnan(grid).any():
        e, s = np.argwhere(np.isnan(grid))[0]
        raise InputError(
            rows.where(int(here[-1]), "element"),
            f"element {elements[e]} has no signal at load {states['load'][s]:g} N",
            legal="every element at every load",
        )
    return GraspReadings(sample, elements, states["load"], states["run"], grid, rows.path)


def _numbered(keys: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The different keys in the order of their first rows, and the place of every row's key among them."""
    unique, first, index = np.unique(keys, return_index=True, return_inverse=True)
    order = np.argsort(first)
    return unique[order], np.argsort(order)[index]


def _read(
    path: str | Path, fixed: tuple[Field, ...], measured: tuple[str, ...], optional: tuple[Field, ...] = ()
) -> tuple[Rows, dict[str, tuple[str, float]]]:
    """Rows, and for each measured quantity its column's name and factor to mm, N, V."""
    table = read_table(path, "readings (CSV)")
    scaled = {quantity: _column_of(table, quantity) for quantity in measured}
    fields = []
    for quantity, (name, factor) in scaled.items():
        _, unit, most = UNITS[quantity]
        low = 0.0 if quantity == "load" else -most / factor
        fields.append(
            Field(name, name.removeprefix(quantity + "_") if "_" in name else unit, low, most / factor)
        )
    return numeric(table, (*fixed, *fields), optional), scaled


def _column_of(table: Table, quantity: str) -> tuple[str, float]:
    """The quantity's column and its factor to mm, N, V; the plain name where there is none.

    Raises InputError where there are two: nothing would say which one counts.
    """
    known = {quantity + suffix: factor for suffix, factor in UNITS[quantity][0].items()}
    names = [name for name in table.header if name in known]
    if len(names) > 1:
        raise InputError(
            f"{table.path}:{table.header_line}:{table.header.index(names[1]) + 1}",
            f"{names[0]} and {names[1]} are both the {quantity}",
            value=names[1],
            legal="one of " + ", ".join(known),
        )
    name = names[0] if names else quantity
    return name, known[name]
