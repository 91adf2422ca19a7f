"""From force, deflection and signal readings to Table 1's columns with intervals.

Force and signal are regressed on the stage's displacement X, which the micrometer sets; the load cell in
series is removed from the slopes (`series_spring`). What the paper's own regression gives stands beside it
(`averaged`).

Every interval covers more than noise. Runs differ: the slopes' variance is taken from the runs' own slopes
(Student's t with one degree of freedom fewer than runs); with a single run it is assumed. Readings before
contact are detected and left out.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tactcad.design.messages import InputError
from tactcad.lab import averaged, noise
from tactcad.lab.contact import first_in_contact
from tactcad.lab.load_cell import LoadCell
from tactcad.lab.readings import CalibrationReadings, groups
from tactcad.lab.regression import (
    KNOWN,
    Lines,
    extreme_deviates,
    fit_lines,
    require_level,
    spare_steps,
    steps,
    t_quantile,
)
from tactcad.lab.series_spring import Estimate, correlation, element_stiffness, require_spring, sensitivities

FALSE_ALARM = 0.01  # probability that an outlier is reported in a file that has none
# Assumed standard deviation of an element's slope from run to run, relative, where there is a single run.
# Chosen: a micrometer read to 1 um over the 100 to 150 um of a calibration's travel.
RUN_SCATTER = 0.01


@dataclass(frozen=True)
class Outlier:
    """A reading too far from the fitted line to be noise."""

    element: int
    run: int
    displacement: float  # mm
    quantity: str  # force or signal
    line: int  # in the file


@dataclass(frozen=True)
class ElementCalibration:
    """Table 1's row of one element. Stiffness N/mm, deflection mm, force N, signal V."""

    element: int
    readings: int  # number used
    runs: int
    stiffness: Estimate
    stiffness_as_paper: Estimate  # runs averaged, F regressed on d
    signal_per_deflection: Estimate
    signal_per_deflection_as_paper: Estimate
    signal_per_force: Estimate
    correlation: float  # of stiffness and signal_per_deflection
    dof: float
    zero_signal: float  # at zero force
    max_deflection: float
    max_force: float
    max_signal_change: float
    linearity_force: float  # largest deviation of the averaged readings from their line, over full scale
    linearity_signal: float
    outliers: tuple[Outlier, ...]
    notes: tuple[str, ...]


def calibrate(
    readings: CalibrationReadings,
    load_cell: LoadCell,
    *,
    level: float = 0.95,
    drop_outliers: bool = False,
    run_scatter: float | None = None,
    tell: Callable[[int, int, str], None] = lambda done, total, what: None,
) -> list[ElementCalibration]:
    """Stiffness and sensitivity of every element, with intervals.

    Parameters
    ----------
    readings : CalibrationReadings
        Displacement (mm), force (N) and signal (V) of all elements.
    load_cell : LoadCell
        Stiffness of the force sensor with its limits (N/mm); inf for a rigid one.
    level : float
        Confidence level of every interval, from 0.5 to below 1.
    drop_outliers : bool
        Leave outliers out of the fit; they are reported either way.
    run_scatter : float, optional
        Relative standard deviation of an element's slope from run to run, where it is known. By default it
        is estimated from the file's runs; for an element with a single run `RUN_SCATTER` is assumed.
    tell : callable
        Called with (elements done, elements in all, name of the next one) before each element.

    Returns
    -------
    list of ElementCalibration
        One for each element, in the order of the file.

    Raises
    ------
    InputError
        A level or a scatter out of range; readings in contact too few for a line; readings that an elastic
        element behind this load cell cannot give.
    """
    require_level(level)
    if run_scatter is not None and not 0 <= run_scatter < 1:
        raise InputError("run scatter", "out of range", value=run_scatter, legal="from 0 to below 1")
    parts = groups(readings.element)
    ready: list[_InContact] = []
    for number, rows in parts:
        tell(len(ready), len(parts), f"element {number}")
        ready.append(_in_contact(readings, number, rows))
    by_force, by_signal = (
        noise.weights([noise.Readings(e.x, e.travel, e.y[:, k], e.run) for e in ready]) for k in (0, 1)
    )
    alarm = FALSE_ALARM / (2 * len(parts))  # each element is tested twice, for force and for signal
    return [
        _element(e, (w_force, w_signal), load_cell, level, drop_outliers, run_scatter, alarm)
        for e, w_force, w_signal in zip(ready, by_force, by_signal)
    ]


@dataclass(frozen=True)
class _InContact:
    """An element's readings in contact, and the notes made so far."""

    number: int
    where: str  # file and element, for messages
    x: np.ndarray  # displacement, mm
    travel: np.ndarray  # displacement from the element's smallest one, mm
    y: np.ndarray  # force N, signal V
    run: np.ndarray
    line: np.ndarray  # in the file
    notes: tuple[str, ...]


def _in_contact(all_: CalibrationReadings, number: int, rows: np.ndarray) -> _InContact:
    notes: list[str] = []
    where = f"{all_.path}: element {number}"
    start = all_.displacement[rows].min()
    rows = _touching(all_, rows, notes)
    x, run = all_.displacement[rows], all_.run[rows]
    y = np.column_stack([all_.force[rows], all_.signal[rows]])
    _require_line(where, x, run)
    return _InContact(number, where, x, x - start, y, run, all_.line[rows], tuple(notes))


def _element(
    e: _InContact,
    weight: tuple[np.ndarray, np.ndarray],
    load_cell: LoadCell,
    level: float,
    drop: bool,
    run_scatter: float | None,
    alarm: float,
) -> ElementCalibration:
    notes = list(e.notes)
    x, y, run, by_force = e.x, e.y, e.run, weight[0]
    bad = [extreme_deviates(x, y[:, k], run, weight[k], alarm) for k in (0, 1)]
    outliers = tuple(
        Outlier(e.number, int(run[i]), float(x[i]), name, int(e.line[i]))
        for name, strange in zip(("force", "signal"), bad)
        for i in strange
    )
    if drop and outliers:
        keep = np.setdiff1d(np.arange(len(x)), np.union1d(*bad).astype(int))
        x, run, y, by_force = x[keep], run[keep], y[keep], by_force[keep]
        _require_line(e.where, x, run)
    lines = fit_lines(x, y, run, by_force)
    covariance, dof = _covariance(lines, run_scatter, notes)
    t = t_quantile(level, dof)
    k, v = lines.slope
    far = [str(o.line) for o in outliers if o.quantity == "force"]
    require_spring(e.where, x, y, lines.slope, t * covariance[0, 0] ** 0.5, load_cell, far)
    stiffness = element_stiffness(k, covariance[0, 0] ** 0.5, load_cell, t, notes)
    per_deflection, per_force = sensitivities(k, v, covariance, load_cell, t)
    means = averaged.over_runs(x, y, run)
    cell = load_cell.stiffness
    paper = averaged.as_paper(*means, cell, level, notes)
    return ElementCalibration(
        e.number,
        len(x),
        len(set(run.tolist())),
        stiffness,
        paper[0],
        per_deflection,
        paper[1],
        per_force,
        correlation(k, v, covariance, cell),
        dof,
        float(lines.intercept[1] - v * lines.intercept[0] / k),
        *averaged.extremes(*means, cell),
        *averaged.linearity(*means),
        outliers,
        tuple(notes),
    )


def _touching(all_: CalibrationReadings, rows: np.ndarray, notes: list[str]) -> np.ndarray:
    """The rows, out of an element's, that are surely in contact."""
    x = all_.displacement[rows]
    first, left_out = first_in_contact(x, all_.force[rows], all_.run[rows])
    kept = rows[steps(x) >= first]
    if left_out > 1:
        above = len(rows) - len(kept)
        what = f"the force of {above} readings lies above the line of the others; they are left out"
        notes.append(f"no contact before {first * 1e3:g} um: {what}")
    if not left_out:
        notes.append(
            "three displacements only: the first is kept, and a gap before contact would bias the slope"
        )
    return kept


def _require_line(where: str, x: np.ndarray, run: np.ndarray) -> None:
    """Raise InputError where the readings in contact are too few to show any scatter about their line."""
    if spare_steps(x, run) < 1:
        raise InputError(
            where,
            "too few readings in contact",
            value=f"{len(x)} in {len(np.unique(run))} runs",
            legal="after the first displacement two more than runs, in one run at two displacements at least",
        )


def _covariance(lines: Lines, run_scatter: float | None, notes: list[str]) -> tuple[np.ndarray, float]:
    """Covariance of the slopes of force and signal, and its degrees of freedom: from the runs' own slopes, or
    from the noise about the line and a scatter from run to run that is given or assumed."""
    if run_scatter is None and lines.runs > 1:
        return lines.between, lines.runs - 1
    assumed = RUN_SCATTER if run_scatter is None else run_scatter
    if run_scatter is None:
        notes.append(
            f"one run: {assumed:.1%} of scatter from run to run is assumed, not measured (--run-scatter)"
        )
    known = np.diag((assumed * lines.slope) ** 2) * float((lines.run_share**2).sum())
    noise = lines.covariance
    total = noise + known
    with np.errstate(divide="ignore"):  # Welch and Satterthwaite; an assumed scatter counts as known
        dof = lines.dof * float((np.diag(total) / np.diag(noise)).min()) ** 2
    return total, min(dof, KNOWN)
