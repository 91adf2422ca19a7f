"""From loads in three directions to every cell's 3 x 3 matrix, with intervals, nonlinearity and crosstalk.

A run is one set-up: weights on one pad along x, along y or straight down. Its slope, field over load, is one
column of the matrix. Set-ups differ: a weight's line is not exactly the axis, which acts like a force across
it. These errors, in N a N, follow one law for all cells of a kind. One part is each cell's own, with its
covariance pooled over the cells; another part is shared by all cells of a run, if the array is turned once
for all of them, and then only the runs count.

The design's nonlinearity (`cell_response.bend`) is subtracted. Tilted magnets have another one: the rest of a
run is m q + c q (q - q_full), so that a column m holds at the largest load, and c is common to its runs.
The design's limits of tilt and place say how large c can be: by Bayes' rule, readings count against that.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tactcad.design.csv_table import Field, Rows, read
from tactcad.design.messages import InputError
from tactcad.lab.readings import ELEMENT, RUN, groups
from tactcad.lab.regression import fit_lines, require_level, steps, t_quantile

from .beam import Array, Whole
from .cell_layout import CellPlace, Kind, PlanarLayout
from .cell_matrices import AXES, CellMatrix
from .cell_response import DOWN, all_bends, bow_variance, stiffness_limit
from .sensor import chip_matrix, pad_compliance

FORCE = tuple(Field(f"f{a}", "N", -1000.0, 1000.0) for a in AXES)
FIELD = tuple(Field(f"b{a}", "mT", -1000.0, 1000.0) for a in AXES)
SINK = Field("sink", "mm", -10.0, 10.0)
ALONG = 1e-3  # of a run's largest load: across its axis, from which on it is another direction
LEAST_LOADS, LEAST_RUNS = 3, 2  # different loads of a run; runs of a cell along each axis


@dataclass(frozen=True)
class _Run:
    """One set-up on a cell: its axis, slope of the field (mT/N), deviation and sink (mm/N; nan without)."""

    number: int
    axis: int
    slope: Array
    deviation: float
    sink: float


def calibrate(layout: PlanarLayout, path: str | Path, level: float) -> list[CellMatrix]:
    """Matrices of the cells that were loaded, with intervals of that level.

    The file is CSV with the columns element, run, fx, fy, fz (N, z down on the pad) and bx, by, bz (mT); with
    `sink` (mm) the stiffness is measured too. Raises InputError for a malformed table, a load along no axis,
    a cell without two runs of three loads along each, a field beyond the chip's range or against the design's
    sign.
    """
    require_level(level)
    rows = read(path, (ELEMENT, RUN, *FORCE, *FIELD), (SINK,))
    places = {e.number: e for e in layout.elements}
    element = rows.values("element").astype(int)
    refuse_unread(layout, rows)
    force, field = (np.stack([rows.values(f.name) for f in of], axis=1) for of in (FORCE, FIELD))
    bent = all_bends(layout, [places[n].kind for n in element], force)
    given = [(places[n], rows, own, force, field, bent) for n, own in groups(element)]
    cells = [_cell_runs(*of, np.ones((3, 3))) for of in given]
    spare = sum(c.spare for c in cells)
    noise = np.sum([c.scatter for c in cells], axis=0) / max(spare, 1)
    cells = [_cell_runs(*of, _kept(layout, c, noise)) for of, c in zip(given, cells)]
    by_kind: dict[str, list[list[_Run]]] = {}
    for c in cells:
        by_kind.setdefault(c.place.kind.name, []).append(c.runs)
    laws = {name: _law(some) for name, some in by_kind.items()}
    return [_cell(layout, c, laws[c.place.kind.name], noise, level) for c in cells]


def refuse_unread(layout: PlanarLayout, rows: Rows) -> None:
    """Raise InputError if the design has no such cell, or if a chip reads its full scale: what it felt is not
    known."""
    number, count = rows.values(ELEMENT.name), len(layout.elements)
    for i in np.flatnonzero(number > count)[:1]:
        where, what = rows.where(int(i), ELEMENT.name), f"design {layout.design.name} has no such cell"
        raise InputError(where, what, value=int(number[i]), legal=f"1 to {count}")
    what, legal = f"{layout.chip.name} is out of its range", f"below {layout.chip.full_scale:g} mT"
    for f in FIELD:
        value = rows.values(f.name)
        for i in np.flatnonzero(np.abs(value) >= layout.chip.full_scale)[:1]:
            raise InputError(rows.where(int(i), f.name), what, value=float(value[i]), legal=legal)


@dataclass(frozen=True)
class _Cell:
    """A cell's runs, its readings' number, and what bends beyond the design's law, as of `CellMatrix`.

    lever      what the variance of c is over that of a reading, 1/N^4, [field, axis]
    scatter    squares of what the lines leave of the three fields, mT^2, and their degrees of freedom
    """

    place: CellPlace
    runs: list[_Run]
    readings: int
    bow: Array
    full: Array
    lever: Array
    scatter: Array
    spare: int


def _kept(layout: PlanarLayout, cell: _Cell, noise: Array) -> Array:
    """Share of what the readings say of c that is kept beside what the design's limits say."""
    limits = bow_variance(layout, cell.place.kind, cell.full)
    return np.asarray(limits / (limits + noise[:, None] * cell.lever))


def _cell_runs(
    place: CellPlace, rows: Rows, own: Whole, force: Array, field: Array, bent: Array, kept: Array
) -> _Cell:
    sinks = rows.columns.get(SINK.name, np.full(len(rows), np.nan))
    taken: list[list[tuple[int, Whole]]] = [[], [], []]
    for number, picked in groups(rows.values("run").astype(int)[own]):
        at = own[picked]
        taken[_axis(rows, number, at, force[at])].append((number, at))
    runs, bow, full, lever = [], np.zeros((3, 3)), np.zeros(3), np.zeros((3, 3))
    scatter, spare = np.zeros(3), 0
    for axis, of_axis in enumerate(taken):
        if len(of_axis) < LEAST_RUNS:
            where, what = f"{rows.path}: element {place.number}", f"too few runs along {AXES[axis]}"
            legal = f"{LEAST_RUNS} set-ups at least along each axis, whose scatter makes the interval"
            raise InputError(where, what, value=len(of_axis), legal=legal)
        every = np.concatenate([at for _, at in of_axis])
        which = np.repeat(np.arange(len(of_axis)), [len(at) for _, at in of_axis])
        q = force[every, axis]
        full[axis] = q[np.argmax(np.abs(q))]
        v, y = q * (q - full[axis]), field[every] - bent[every]
        left = np.zeros_like(v)
        for r in range(len(of_axis)):
            one = which == r
            left[one] = fit_lines(q[one], v[one, None], np.zeros(one.sum())).residual[:, 0]
        bow[:, axis], lever[:, axis] = kept[:, axis] * np.array([left @ y, np.ones(3)]) / (left @ left)
        spare += len(v) - 2 * len(of_axis) - 1
        y = y - np.outer(v, bow[:, axis])
        for r, (number, at) in enumerate(of_axis):
            one, none = which == r, np.zeros(len(at))
            raw, line = (fit_lines(q[one], values, none) for values in (field[at], y[one]))
            scatter += (line.residual**2).sum(axis=0)
            told = int(np.argmax(np.abs(raw.slope)))
            span = abs(raw.slope[told]) * float(np.ptp(q[one]))
            off = float(np.abs(raw.residual[:, told]).max()) / span if span else 0.0
            sink = _sink(place.kind, axis, q[one], sinks[at])
            runs.append(_Run(number, axis, line.slope, off, sink))
    return _Cell(place, runs, len(own), bow, full, lever, scatter, spare)


def _axis(rows: Rows, number: int, at: Whole, force: Array) -> int:
    """The axis of a run's loads. Raises InputError if they are along none, or too few."""
    load, where = np.abs(force).max(axis=0), rows.where(int(at[0]), "run")
    axis = int(np.argmax(load))
    if np.delete(load, axis).max() > ALONG * load[axis]:
        what, value = f"the loads of run {number} are along no axis", ", ".join(f"{v:g} N" for v in load)
        raise InputError(where, what, value=value, legal="of fx, fy, fz one only in a run")
    if (count := len(np.unique(steps(force[:, axis])))) < LEAST_LOADS:
        legal = f"{LEAST_LOADS} at least, the one without weight among them"
        raise InputError(where, f"too few loads in run {number}", value=count, legal=legal)
    return axis


def _sink(kind: Kind, axis: int, q: Array, sink: Array) -> float:
    """Sink over load of the cell at rest, mm/N, its stiffening taken off."""
    if axis != 2 or np.isnan(sink).any():
        return float("nan")
    straight = sink * (1.0 + kind.cell.stiffening * sink**2)
    return float(fit_lines(q, straight[:, None], np.zeros(len(q))).slope[0])


def _mean(found: Sequence[_Run]) -> Array:
    """The matrix: mean slopes along each axis as its columns."""
    return np.stack([np.mean([r.slope for r in found if r.axis == k], axis=0) for k in range(3)], axis=1)


@dataclass(frozen=True)
class _Law:
    """Covariance of a run's error, N^2 a N^2 of load, by axis [3, 3, 3]; its degrees of freedom [3]; relative
    variance of a run's sink over the force that its field tells: without what its weight is in error."""

    error: Array
    dof: Array
    sink: float


def _law(cells: Sequence[Sequence[_Run]]) -> _Law:
    laws = [_law_along(k, cells) for k in range(3)]
    sinks = []
    for found in cells:
        back = np.linalg.inv(_mean(found))
        c = np.array([r.sink / (back @ r.slope)[2] for r in found if r.axis == 2])
        sinks.append(float(c.var(ddof=1)) / float(c.mean()) ** 2)
    return _Law(np.stack([e for e, _ in laws]), np.array([d for _, d in laws]), float(np.mean(sinks)))


def _law_along(axis: int, cells: Sequence[Sequence[_Run]]) -> tuple[Array, float]:
    """Covariance of the errors of runs along an axis, and its degrees of freedom (Welch and Satterthwaite's
    of the part that a run's cells share and of their own part)."""
    numbers = {tuple(r.number for r in found if r.axis == axis) for found in cells}
    errors = []
    for found in cells:
        slopes = np.array([r.slope for r in found if r.axis == axis])
        errors.append((slopes - slopes.mean(axis=0)) @ np.linalg.inv(_mean(found)).T)
    least, many = min(map(len, errors)) - 1.0, len(cells)
    if many == 1 or len(numbers) > 1:  # the file does not group the runs: treat the error as shared
        total = sum(e.T @ e / (len(e) - 1) for e in errors) / many
        return np.asarray(total), least
    e = np.stack(errors)
    shared = e.mean(axis=0)
    own = e - shared
    by_run = shared.T @ shared / least  # it contains 1/many of each cell's own variance
    by_cell = np.einsum("cri,crj->ij", own, own) / ((many - 1) * least) * (1.0 - 1.0 / many)
    a, b = float(np.trace(by_run)), float(np.trace(by_cell))
    dof = (a + b) ** 2 / (a**2 / least + b**2 / ((many - 1) * least)) if a + b > 0.0 else least
    return by_run + by_cell, dof


def _cell(layout: PlanarLayout, cell: _Cell, law: _Law, noise: Array, level: float) -> CellMatrix:
    kind, found, m = cell.place.kind, cell.runs, _mean(cell.runs)
    drawn = chip_matrix(layout, kind) * DOWN
    for k in range(3):
        if m[k, k] * drawn[k, k] <= 0.0:
            what = f"b{AXES[k]} goes against f{AXES[k]}: a sign or two columns are exchanged"
            where, legal = f"element {cell.place.number}", f"near the design's {drawn[k, k]:.3g} mT/N"
            raise InputError(where, what, value=float(m[k, k]), legal=legal)
    each = np.array([sum(r.axis == k for r in found) for k in range(3)])
    spread = np.stack([m @ law.error[k] @ m.T / each[k] for k in range(3)])
    t = np.array([t_quantile(level, dof) for dof in law.dof])
    half = t * np.sqrt(np.stack([np.diag(spread[k]) for k in range(3)], axis=1))
    off = np.abs(m / np.diag(m)) - np.eye(3)
    sink = float(np.mean([r.sink for r in found if r.axis == 2]))
    measured = not np.isnan(sink)
    stiffness = 1.0 / sink if measured else 1.0 / float(pad_compliance(kind, layout.pad_height)[2, 2])
    return CellMatrix(
        cell.place.number,
        kind.name,
        cell.readings,
        len(found),
        m,
        cell.bow,
        noise[:, None] * cell.lever,
        cell.full,
        half,
        spread,
        law.dof,
        float(off.max()),
        max(r.deviation for r in found),
        stiffness,
        stiffness * (law.sink / each[2]) ** 0.5 if measured else 0.0,
        0.0 if measured else stiffness_limit(layout),
    )
