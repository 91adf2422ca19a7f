"""Forces on every cell in three directions, and what they say of the object: K_obj by neighbours, slip.

The fields of all chips less those without load are one linear system in all forces: each cell's own matrix as
calibrated, its neighbours' magnets by the design. What bends is taken off in rounds.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tactcad.design.csv_table import Field, Rows, read
from tactcad.design.messages import InputError
from tactcad.lab.calibration_file import Sensitivity
from tactcad.lab.combine import Interval
from tactcad.lab.readings import ELEMENT, RUN, SAMPLE, GraspReadings, groups
from tactcad.lab.regression import KNOWN, steps, t_quantile

from .beam import Array, Whole
from .cell_calibration import FIELD, refuse_unread
from .cell_layout import CellPlace, PlanarLayout, beside
from .cell_matrices import Matrices
from .cell_response import all_bends, neighbours
from .sensor import closing_force, reading_noise

LOAD = Field("load", "N", 0.0, 1000.0)
ROUNDS = 5  # in which what bends is taken off: each leaves a tenth of the one before, at the rated force
ENOUGH = 20  # degrees of freedom of repeated readings from which on they tell the noise, not the chip's sheet
SURELY = 3.0  # standard errors of a pad's normal force from which on it presses; chosen


@dataclass(frozen=True)
class CellFields:
    """Fields of one sample; arrays. field [cell, state, 3], less that without load, and noise, mT, [3]."""

    sample: int
    element: Whole
    load: Array
    run: Whole
    field: Array
    noise: Array
    path: str


@dataclass(frozen=True)
class CellForces:
    """Forces on the cells, N: fx, fy, and z down on the pad.

    force, half_width  [cell, state, 3]
    error              standard error of the normal force by the chip's noise alone, N, [cell]
    stopped, slips     [cell, state]
    """

    force: Array
    half_width: Array
    error: Array
    stopped: NDArray[np.bool_]
    slips: NDArray[np.bool_]


def fields(layout: PlanarLayout, path: str | Path) -> list[CellFields]:
    """Read the fields for `tactcad stiffness`.

    The file is CSV with the columns element, load (N), bx, by, bz (mT); run and sample if there are several.
    Every cell at every load, and without load in every run; repeated readings are averaged. Raises InputError
    for a malformed table, a reading missing, a cell that the design does not have, a chip out of its range.
    """
    rows = read(path, (ELEMENT, LOAD, *FIELD), (RUN, SAMPLE))
    refuse_unread(layout, rows)
    sample = rows.columns.get(SAMPLE.name, np.ones(len(rows))).astype(int)
    return [_sample(layout, rows, number, own) for number, own in groups(sample)]


def _sample(layout: PlanarLayout, rows: Rows, number: int, own: Whole) -> CellFields:
    element, where = rows.values("element").astype(int)[own], f"{rows.path}: sample {number}"
    run = rows.columns.get(RUN.name, np.ones(len(rows))).astype(int)[own]
    load = steps(rows.values("load")[own])
    b = np.stack([rows.values(f.name)[own] for f in FIELD], axis=1)
    cells = np.unique(element)
    states, which = np.unique(np.stack([run, load], axis=1), axis=0, return_inverse=True)
    place = np.searchsorted(cells, element) * len(states) + which.ravel()
    count = np.bincount(place, minlength=len(cells) * len(states))
    if not count.all():
        c, s = divmod(int(np.argmin(count)), len(states))
        what = f"element {cells[c]} has no reading at load {states[s][1]:g} N"
        raise InputError(where, what, legal="every cell at every load")
    total = np.zeros((len(count), 3))
    np.add.at(total, place, b)
    mean = total / count[:, None]
    spare = len(b) - len(count)
    noise = reading_noise(layout.chip)
    if spare >= ENOUGH:
        noise = np.sqrt(((b - mean[place]) ** 2).sum(axis=0) / spare)
    noise = noise / count.min() ** 0.5
    grid = mean.reshape(len(cells), len(states), 3)
    kept, change = [], np.empty_like(grid)
    for r in np.unique(states[:, 0]):
        of_run = states[:, 0] == r
        zero = np.flatnonzero(of_run & (states[:, 1] == 0.0))
        if not len(zero):
            raise InputError(where, f"run {r:g} has no reading without load", legal="load 0 in every run")
        change[:, of_run] = grid[:, of_run] - grid[:, zero[:1]]
        kept += np.flatnonzero(of_run & (states[:, 1] > 0.0)).tolist()
    if not kept:
        raise InputError(where, "no load above zero", legal="one at least")
    runs, loads = states[kept].T
    return CellFields(number, cells, loads, runs.astype(int), change[:, kept], noise, rows.path)


def forces(layout: PlanarLayout, read: CellFields, known: Matrices, level: float) -> CellForces:
    """Forces of all cells at all loads, with intervals.

    Raises InputError if a cell was not calibrated.
    """
    cells, rows = places(layout, read), _rows(read, known)
    n, states = read.field.shape[:2]
    own = known.matrix[rows]
    system = neighbours(layout, cells)
    for i in range(n):
        system[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] = own[i]
    back = np.linalg.inv(system)
    force = np.zeros_like(read.field)
    for _ in range(ROUNDS):
        bent = all_bends(layout, [e.kind for e in cells], force)
        further = force * (force - known.full[rows][:, None])
        bent += np.einsum("nij,nsj->nsi", known.bow[rows], further)
        force = (back @ (read.field - bent).swapaxes(0, 1).reshape(states, 3 * n).T).T
        force = force.reshape(states, n, 3).swapaxes(0, 1)
    inverse = np.linalg.inv(own)
    # twice the noise: of the reading, and of the one without load
    by_noise = 2.0 * np.einsum("nij,j->ni", inverse**2, read.noise**2)
    columns = np.einsum("nij,nkjl,nil->nki", inverse, known.spread[rows], inverse)
    by_matrix = np.einsum("nsk,nki->nski", force**2, columns)
    by_bow = np.einsum("nij,njk,nsk->nsi", inverse**2, known.bow_variance[rows], further**2)
    variance = by_noise[:, None] + by_matrix.sum(axis=2) + by_bow
    with np.errstate(divide="ignore"):  # Welch and Satterthwaite; the noise counts as known
        dof = variance**2 / (by_matrix**2 / known.dof[rows][:, None, :, None]).sum(axis=2)
    t = np.array([t_quantile(level, min(d, KNOWN)) for d in dof.ravel()]).reshape(dof.shape)
    closing = np.array([closing_force(layout, e.kind) for e in cells])
    error = np.sqrt(by_noise[:, 2])
    presses = force[..., 2] > SURELY * error[:, None]
    sideways = np.hypot(force[..., 0], force[..., 1])
    slips = presses & (sideways > layout.design.rating.slip * force[..., 2])
    return CellForces(force, t * np.sqrt(variance), error, force[..., 2] > closing[:, None], slips)


def places(layout: PlanarLayout, read: CellFields) -> list[CellPlace]:
    at = {e.number: e for e in layout.elements}
    return [at[int(n)] for n in read.element]


def _rows(read: CellFields, known: Matrices) -> Whole:
    at = {n: i for i, n in enumerate(known.element.tolist())}
    for n in read.element.tolist():
        if n not in at:
            where = f"{read.path}: sample {read.sample}"
            raise InputError(where, f"element {n} was not calibrated", legal=str([*at]))
    return np.array([at[n] for n in read.element.tolist()])


def as_rows(read: CellFields, found: CellForces, known: Matrices) -> tuple[GraspReadings, Sensitivity]:
    """Normal forces as the estimators of one component take them: signals of equal noise on springs K.

    A wrong weight changes force and measured K by the same factor, but no sink: the signal over the sink then
    has the sinks' own error. If K is the design's, it has the matrix' error.
    """
    rows = _rows(read, known)
    k, own = known.stiffness[rows], known.stiffness_se[rows] / known.stiffness[rows]
    per_newton = float(np.median(found.error)) / found.error  # so that all are as noisy as the middle one
    inverse = np.linalg.inv(known.matrix[rows])
    of_matrix = np.sqrt(np.einsum("ni,nij,nj->n", inverse[:, 2], known.spread[rows][:, 2], inverse[:, 2]))
    per_sink = np.where(own > 0.0, own, of_matrix)
    of_k = np.where(own > 0.0, np.hypot(own, of_matrix), 0.0)
    correlation = np.divide(own, of_k, out=np.zeros_like(own), where=of_k > 0)
    s, dof, many, none = per_newton * k, known.dof[rows][:, 2], np.full(len(k), 1e12), np.zeros(len(k))
    sensitivity = Sensitivity(read.element, k, k * of_k, s, s * per_sink, correlation, dof, many, none)
    signal = found.force[..., 2] * per_newton[:, None]
    return GraspReadings(read.sample, read.element, read.load, read.run, signal, read.path), sensitivity


def with_rest(readings: GraspReadings) -> GraspReadings:
    """The same with the readings without load, from which all others are counted, in front."""
    runs = np.unique(readings.run)
    return replace(
        readings,
        load=np.concatenate([np.zeros(len(runs)), readings.load]),
        run=np.concatenate([runs, readings.run]),
        signal=np.pad(readings.signal, ((0, 0), (len(runs), 0))),
    )


def by_neighbours(
    layout: PlanarLayout, read: CellFields, found: CellForces, known: Matrices, level: float
) -> list[Interval | None]:
    """K_obj at every cell from it and its neighbours of the other kind, N/mm; None without a neighbour or
    where the cell was read at fewer than two loads.

    All pads move by one approach, so g (1 + x/K) is the same at the cell and in its neighbours' mean, g the
    rise of the normal force: equation (3) with Fieller's interval, at the limits of K.
    """
    cells, rows = places(layout, read), _rows(read, known)
    if len(read.load) < 2 or np.ptp(read.load) == 0.0:
        return [None] * len(cells)
    at = {(e.row, e.column): i for i, e in enumerate(cells)}
    away = read.load - read.load.mean()
    g = found.force[..., 2] @ away / (away @ away)
    inverse = np.linalg.inv(known.matrix[rows])
    of_matrix = np.einsum("ni,nij,nj->n", inverse[:, 2], known.spread[rows][:, 2], inverse[:, 2])
    normal = found.force[..., 2]
    bow = (normal * (normal - known.full[rows][:, 2:])) @ away / (away @ away)
    of_bow = np.einsum("nj,nj->n", inverse[:, 2] ** 2, known.bow_variance[rows][:, :, 2]) * bow**2
    # half of a force's noise is the zero's, which a slope does not feel
    variance = found.error**2 / 2.0 / (away @ away) + of_bow
    k, limit = known.stiffness[rows], known.stiffness_limit[rows]
    own = (known.stiffness_se[rows] / k) ** 2
    # a measured K shares the matrix' error, the sink does not: as in `as_rows`
    measured = own > 0.0
    by_force, both = g**2 * of_matrix, np.where(measured, 0.0, g**2 * of_matrix)
    by_sink = g**2 * np.where(measured, own, of_matrix)
    dof = float(known.dof[rows][:, 2].min())
    out: list[Interval | None] = []
    for i, e in enumerate(cells):
        others = [at[p] for p in beside(e) if p in at]
        if not others:
            out.append(None)
            continue
        w = np.zeros(len(cells))
        w[i], w[others] = 1.0, -1.0 / len(others)
        # h(x) = a + b x is nought; its variance is a polynomial, by noise and by the calibration
        a, b, w = float(w @ g), float(w @ (g / k)), w**2
        noise = np.array([w @ (variance / k**2), 2.0 * w @ (variance / k), w @ variance])
        of_cal = np.array([w @ (by_sink / k**2), 2.0 * w @ (both / k), w @ by_force])
        at_it = max(-a / b, 0.0) if b else 0.0
        share = float(np.polyval(of_cal, at_it) / np.polyval(noise + of_cal, at_it))
        t = t_quantile(level, min(dof / share**2, KNOWN) if share else KNOWN)
        out.append(_fieller(a, b, noise + of_cal, t, float(limit[i])))
    return out


def _fieller(a: float, b: float, variance: Array, t: float, limit: float) -> Interval:
    """Range of x >= 0 with (a + b x)^2 <= t^2 variance(x), a common factor of x known within the limit."""
    two, one, nought = (float(v) for v in np.array([b * b, 2.0 * a * b, a * a]) - t * t * variance)
    estimate, low, high = (-a / b if b else inf), 0.0, inf
    if two != 0.0 and (root := one * one - 4.0 * two * nought) > 0.0:
        first, last = sorted((-one + s * root**0.5) / (2.0 * two) for s in (-1.0, 1.0))
        if two > 0.0:
            low, high = first, last
        elif first <= 0.0:  # beyond the last: b may be nought, and K_obj infinite
            low = last
    if high <= 0.0:
        return Interval(estimate, 0.0, 0.0, empty=True)
    return Interval(estimate, max(low, 0.0) / (1.0 + limit), high * (1.0 + limit))
