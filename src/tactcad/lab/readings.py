"""A lab's own readings from CSV: calibration runs and grasps.

Columns may carry their unit (displacement_um, force_N, signal_mV); a plain name is in mm, N, V. With a column
of time (time_s) a state may be read any number of times: consecutive readings are averaged, and a later
return to the state is a separate reading, from which drift is estimated.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from tactcad.design.csv_table import Field, Rows, Table, numeric, read_table, refuse_duplicates
from tactcad.design.messages import InputError
from tactcad.lab.regression import steps

KIND = "readings (CSV)"
ELEMENT = Field("element", "1", 1, 100_000, integer=True)
RUN = Field("run", "1", 0, 1_000_000, integer=True)
SAMPLE = Field("sample", "1", 0, 1_000_000, integer=True)

# By quantity: suffix of a column's name -> factor to the unit that follows, and the largest value, beyond
# which a column is in another unit (no calibration travels 10 mm).
UNITS = {
    "displacement": ({"": 1.0, "_mm": 1.0, "_um": 1e-3}, "mm", 10.0),
    "force": ({"": 1.0, "_N": 1.0, "_mN": 1e-3}, "N", 1000.0),
    "load": ({"": 1.0, "_N": 1.0, "_mN": 1e-3}, "N", 1000.0),
    "signal": ({"": 1.0, "_V": 1.0, "_mV": 1e-3}, "V", 1000.0),
}
TIME = Field("time_s", "s", -1e12, 1e12)


@dataclass(frozen=True)
class CalibrationReadings:
    """Readings of a calibration; arrays, [reading]."""

    element: np.ndarray  # its number
    run: np.ndarray
    displacement: np.ndarray  # of the stage, mm
    force: np.ndarray  # N
    signal: np.ndarray  # V
    line: np.ndarray  # in the file
    path: str = "readings"
    columns: tuple[str, ...] = ("displacement", "force", "signal")  # their names in the file
    time: np.ndarray | None = None  # s


@dataclass(frozen=True)
class GraspReadings:
    """Signals of all elements at every load on one sample; a state is one load of one run."""

    sample: int
    element: np.ndarray  # numbers, [element]
    load: np.ndarray  # N, [state]
    run: np.ndarray  # [state]
    signal: np.ndarray  # V, [element, state]
    path: str = "readings"
    columns: tuple[str, ...] = ("load", "signal")  # their names in the file
    time: np.ndarray | None = None  # s, [state]


def calibration(path: str | Path) -> CalibrationReadings:
    """Read the readings for `tactcad calibrate`.

    Parameters
    ----------
    path : str or Path
        CSV with the columns element, run, displacement, force, signal.

    Returns
    -------
    CalibrationReadings
        In the order of the file.

    Raises
    ------
    InputError
        A malformed table, a displacement twice in a run, too few readings of an element, displacements with
        their sign reversed; with file, line and column.
    """
    return calibration_of(read_table(path, KIND))


def calibration_of(table: Table) -> CalibrationReadings:
    """`calibration` of a table that was read."""
    rows, scaled = _read(table, (ELEMENT, RUN), ("displacement", "force", "signal"), (TIME,))
    timed = TIME.name in rows.columns
    if not timed:
        legal = "each displacement once a run; number the ways up and down as two runs, or give time_s"
        refuse_duplicates(rows, ("element", "run", scaled["displacement"][0]), legal)
    displacement, force, signal = (rows.values(name) * factor for name, factor in scaled.values())
    element, run = (rows.values(name).astype(int) for name in ("element", "run"))
    time, named = rows.values(TIME.name) if timed else None, tuple(rows.columns)[2:5]  # behind element, run
    read = (element, run, displacement, force, signal)
    out = CalibrationReadings(*read, rows.lines, rows.path, named, time)
    if timed:
        out = _averaged(out)
    for number, own in groups(out.element):
        runs, at = len(np.unique(out.run[own])), np.unique(steps(out.displacement[own]))
        if len(own) < runs + 3 or len(at) < 3:
            what, value = f"too few readings of element {number}", len(own)
            legal = "three more than runs, at three displacements at least"
            raise InputError(table.where(int(out.line[own[-1]]), "element"), what, value=value, legal=legal)
        least = int(own[np.argmin(out.displacement[own])])
        if -out.displacement[least] > out.displacement[own].max():
            where = table.where(int(out.line[least]), scaled["displacement"][0])
            what = f"element {number} is pressed to negative displacements: the column's sign is reversed"
            legal = "displacement and force both grow as the element is pressed"
            raise InputError(where, what, value=f"{out.displacement[least]:g} mm", legal=legal)
    return out


def _averaged(r: CalibrationReadings) -> CalibrationReadings:
    """Readings of one element, run and displacement that follow each other in time as their mean."""
    assert r.time is not None
    order = np.lexsort((r.time, r.element))
    key = np.column_stack([r.element, r.run, steps(r.displacement)])[order]
    visit = np.cumsum(np.concatenate([[0], (key[1:] != key[:-1]).any(1)]))
    count, first = np.bincount(visit), np.unique(visit, return_index=True)[1]
    back = np.argsort(order[first], kind="stable")  # as the file has them

    def mean(v: np.ndarray) -> np.ndarray:
        return (np.bincount(visit, v[order]) / count)[back]

    kept = order[first][back]
    of_first = {name: getattr(r, name)[kept] for name in ("element", "run", "displacement", "line")}
    return replace(r, **of_first, force=mean(r.force), signal=mean(r.signal), time=mean(r.time))


def groups(number: np.ndarray) -> list[tuple[int, np.ndarray]]:
    """Each different number with the indices of its rows, in the order of the first of them."""
    order = np.argsort(number, kind="stable")
    numbers, first = np.unique(number[order], return_index=True)
    return sorted(zip(numbers.tolist(), np.split(order, first[1:])), key=lambda group: group[1][0])


def grasps(path: str | Path) -> list[GraspReadings]:
    """Read the readings for `tactcad stiffness`.

    Every element must be read at every load of a run, since one approach of the array moves all elements.

    Parameters
    ----------
    path : str or Path
        CSV with the columns element, load, signal; run and sample if there are several.

    Returns
    -------
    list of GraspReadings
        One for each sample, in the order of the file.

    Raises
    ------
    InputError
        A malformed table, a reading twice or missing; with file, line and column.
    """
    return grasps_of(read_table(path, KIND))


def grasps_of(table: Table) -> list[GraspReadings]:
    """`grasps` of a table that was read."""
    rows, scaled = _read(table, (ELEMENT,), ("load", "signal"), (RUN, SAMPLE, TIME))
    one = np.ones(len(rows))
    run, sample = (rows.columns.get(n, one).astype(int) for n in ("run", "sample"))
    element = rows.values("element").astype(int)
    load, signal = (rows.values(name) * factor for name, factor in scaled.values())
    timed = TIME.name in rows.columns
    if not timed:
        once = (*(n for n in ("sample", "run") if n in rows.columns), scaled["load"][0], "element")
        refuse_duplicates(rows, once, "each once, or give time_s")
    time = rows.values(TIME.name) if timed else np.zeros(len(rows))
    return [
        _grasp(
            rows, number, own, element[own], load[own], run[own], signal[own], time[own] if timed else None
        )
        for number, own in groups(sample)
    ]


def _grasp(
    rows: Rows,
    sample: int,
    own: np.ndarray,
    element: np.ndarray,
    load: np.ndarray,
    run: np.ndarray,
    signal: np.ndarray,
    time: np.ndarray | None,
) -> GraspReadings:
    """One sample's signals, [element, state], from its `own` rows; elements and states in the order of their
    first rows. With time a state is a visit to a load: of an element's readings in their order, those of one
    load that follow each other."""
    state = np.empty(len(own), [("visit", int), ("run", int), ("load", float)])
    state["visit"], state["run"], state["load"] = 0, run, load
    if time is not None:
        state["visit"] = _visits(element, state[["run", "load"]], time)
    elements, row = _numbered(element)
    states, column = _numbered(state)
    place = row * len(states) + column
    count = np.bincount(place, minlength=len(elements) * len(states))
    with np.errstate(invalid="ignore"):  # a reading that is missing
        grid = (np.bincount(place, signal, len(count)) / count).reshape(len(elements), len(states))
    if np.isnan(grid).any():
        e, s = np.argwhere(np.isnan(grid))[0]
        what = f"element {elements[e]} has no signal at load {states['load'][s]:g} N"
        raise InputError(rows.where(int(own[-1]), "element"), what, legal="every element at every load")
    columns = tuple(rows.columns)[1:3]  # behind the element
    at = None if time is None else np.bincount(column, time) / np.bincount(column)
    return GraspReadings(sample, elements, states["load"], states["run"], grid, rows.path, columns, at)


def _visits(element: np.ndarray, load: np.ndarray, time: np.ndarray) -> np.ndarray:
    """For every reading the number of its element's earlier changes of load, by time."""
    order = np.lexsort((time, element))
    another, changed = np.diff(element[order]) != 0, load[order][1:] != load[order][:-1]
    visit = np.concatenate([[0], np.cumsum(changed & ~another)])
    first = np.concatenate([[0], np.flatnonzero(another) + 1])
    counted = visit - np.repeat(visit[first], np.diff([*first, len(visit)]))
    out = np.empty(len(element), int)
    out[order] = counted
    return out


def _numbered(keys: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The different keys in the order of their first rows, and for every row the index of its key."""
    unique, first, index = np.unique(keys, return_index=True, return_inverse=True)
    order = np.argsort(first)
    return unique[order], np.argsort(order)[index]


def _read(
    table: Table, fixed: tuple[Field, ...], measured: tuple[str, ...], optional: tuple[Field, ...] = ()
) -> tuple[Rows, dict[str, tuple[str, float]]]:
    """The table's rows, and for each measured quantity its column's name and factor to mm, N or V."""
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
    """The name of the quantity's column and its factor to mm, N or V; where the table has none, the plain
    name, which `numeric` then reports as missing.

    Raises InputError if there are two: nothing says which one counts.
    """
    known = {quantity + suffix: factor for suffix, factor in UNITS[quantity][0].items()}
    names = [name for name in table.header if name in known]
    if len(names) > 1:
        where = f"{table.path}:{table.header_line}:{table.header.index(names[1]) + 1}"
        what = f"{names[0]} and {names[1]} are both the {quantity}"
        raise InputError(where, what, value=names[1], legal="one of " + ", ".join(known))
    name = names[0] if names else quantity
    return name, known[name]
