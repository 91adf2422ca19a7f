"""From force, deflection and signal readings to Table 1's columns with intervals.

Force and signal are regressed on the stage's displacement X, which the micrometer sets; the load cell in
series is removed from the slopes. The paper's own regression is reported for comparison (`load_cell`).

Every interval covers more than noise. Runs differ: the slopes' variance is taken from the runs' own slopes
(Student's t with one degree of freedom fewer than runs); with a single run it is assumed. Readings before
contact are detected and left out.

The point of contact within the first step is not known. A gap of a few micrometres biases a slope by per
cents if that step's reading is kept, and a statistical test misses gaps about as large as the noise, so that
intervals would cover the truth less often than their level. Hence the first displacement is always left out.
A gap beyond the first step is large, and a test detects it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil

import numpy as np
from scipy.special import stdtr

from tactcad.design.messages import InputError
from tactcad.lab.load_cell import (
    Estimate,
    LoadCell,
    as_paper,
    correlation,
    element_stiffness,
    extremes,
    linearity,
    over_runs,
    require_spring,
    sensitivities,
)
from tactcad.lab.readings import CalibrationReadings, groups
from tactcad.lab.regression import (
    KNOWN,
    Lines,
    Readings,
    drifts,
    extreme_deviates,
    fit_lines,
    require_level,
    spare_steps,
    steps,
    t_quantile,
    told_from_time,
    weights,
)
from tactcad.report.figures import Figure, Figures

from .regression import Bow, bow, common, off_the_chord

# Bow of the way up that one element alone is assumed to have, of full scale, since its readings seldom show
# it. Chosen: what gauges, glue and set screws are usually said to keep.
HYSTERESIS = 0.01
FALSE_ALARM = 0.01  # probability that an outlier is reported in a file that has none
# Assumed standard deviation of an element's slope from run to run, relative, if there is a single run.
# Chosen: a micrometer read to 1 um over the 100 to 150 um of a calibration's travel.
RUN_SCATTER = 0.01
BEFORE = 0.001  # probability that a test leaves out a step that was in contact
IN_CONTACT = 0.6  # share of the steps, the largest ones, that are assumed to be in contact
FEWEST = 4  # displacements at which the first can be left out
# A ramp read at more displacements is grouped into so many steps: each step tested costs a fit of all
# readings and can raise a false alarm. With IN_CONTACT, 16 of 40 are tested: 1.6 % in all.
MOST = 40


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


def _estimate(name: str, heading: str, unit: str, digits: str) -> tuple[Figure, ...]:
    """Figures of an estimate: the value; its limits and standard error, in their own columns."""
    return (
        Figure(f"{name}.value", heading, unit, 1.0, digits),
        Figure(f"{name}.low", f"{heading} from", unit, 1.0, digits),
        Figure(f"{name}.high", f"{heading} to", unit, 1.0, digits),
        Figure(f"{name}.standard_error", f"{heading} s.e.", unit, 1.0, digits, column=f"{name}_se"),
    )


ELEMENT = Figures(
    ElementCalibration,
    Figure("element", "element", "", 1.0, "d"),
    Figure("readings", "readings", "", 1.0, "d"),
    Figure("runs", "runs", "", 1.0, "d"),
    *_estimate("stiffness", "K", "N/mm", ".3f"),
    *_estimate("stiffness_as_paper", "K as paper", "N/mm", ".3f"),
    *_estimate("signal_per_deflection", "K_v", "V/mm", ".3f"),
    *_estimate("signal_per_deflection_as_paper", "K_v as paper", "V/mm", ".3f"),
    *_estimate("signal_per_force", "K_v/K", "V/N", ".4f"),
    Figure("correlation", "correlation of K and K_v", "", 1.0, ".3f"),
    Figure("dof", "degrees of freedom", "", 1.0, ".1f"),
    Figure("zero_signal", "V_0", "V", 1.0, ".3f"),
    Figure("max_deflection", "max d", "um", 1e3, ".1f"),
    Figure("max_force", "max F", "N", 1.0, ".3f"),
    Figure("max_signal_change", "max dV", "V", 1.0, ".3f", column="max_signal_V"),
    Figure("linearity_force", "lin F", "%", 100.0, ".2f"),
    Figure("linearity_signal", "lin V", "%", 100.0, ".2f"),
)


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
        Relative standard deviation of an element's slope from run to run, if it is known. By default it
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
        weights([Readings(e.x, e.travel, e.y[:, k], e.run) for e in ready]) for k in (0, 1)
    )
    alarm = FALSE_ALARM / (2 * len(parts))  # each element is tested twice, for force and for signal
    own = [
        [bow(e.x, e.y[:, k], e.run, w[i]) for i, e in enumerate(ready)]
        for k, w in enumerate((by_force, by_signal))
    ]
    of_all = [common(bows) for bows in own]
    out = []
    for i, (e, *bows) in enumerate(zip(ready, *own)):
        heights = [_height(b, all_, alarm) for b, all_ in zip(bows, of_all)]
        unseen = [0.0, 0.0]
        if len(parts) == 1 and _up_only(e):
            unseen = [min(b.most if b else HYSTERESIS, HYSTERESIS) for b in bows]
        told = (load_cell, level, drop_outliers, run_scatter, alarm, heights, unseen)
        out.append(_element(e, (by_force[i], by_signal[i]), *told))
    return out


def _height(own: Bow | None, of_all: Bow | None, alarm: float) -> float:
    """Height of the bow assumed for an element's slope: of all elements together, or its own if noise does
    not explain that; else 0."""
    heights = [0.0]
    if of_all and of_all.told(FALSE_ALARM / 2):  # tested twice, for force and for signal
        heights.append(of_all.most)
    if own and own.told(alarm):
        heights.append(own.most)
    return max(heights)


def _up_only(e: _InContact) -> bool:
    """Whether no run comes back, by the order of the file."""
    in_order = np.lexsort((e.line, e.run))
    x, run = e.x[in_order], e.run[in_order]
    return not ((np.diff(x) < 0) & (np.diff(run) == 0)).any()


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
    time: np.ndarray | None = None  # s, if a drift can be estimated from it


def _in_contact(all_: CalibrationReadings, number: int, rows: np.ndarray) -> _InContact:
    notes: list[str] = []
    where = f"{all_.path}: element {number}"
    start = all_.displacement[rows].min()
    rows = _touching(all_, rows, notes)
    x, run = all_.displacement[rows], all_.run[rows]
    y = np.column_stack([all_.force[rows], all_.signal[rows]])
    _require_line(where, x, run)
    time = None if all_.time is None else all_.time[rows]
    if time is not None and (spare_steps(x, run) < 2 or not told_from_time(x, time, run)):
        notes.append(
            "displacement goes with time in every run, so drift cannot be separated from the slope; "
            "also read the way back"
        )
        time = None
    if time is not None:  # what follows sees force and signal without their drift
        y = y - np.outer(time - time.mean(), drifts(x, y, run, time))
    return _InContact(number, where, x, x - start, y, run, all_.line[rows], tuple(notes), time)


def _element(
    e: _InContact,
    weight: tuple[np.ndarray, np.ndarray],
    load_cell: LoadCell,
    level: float,
    drop: bool,
    run_scatter: float | None,
    alarm: float,
    heights: list[float],
    unseen: list[float],
) -> ElementCalibration:
    notes = list(e.notes)
    x, y, run, by_force, time = e.x, e.y, e.run, weight[0], e.time
    bad = [extreme_deviates(x, y[:, k], run, weight[k], alarm) for k in (0, 1)]
    outliers = tuple(
        Outlier(e.number, int(run[i]), float(x[i]), name, int(e.line[i]))
        for name, strange in zip(("force", "signal"), bad)
        for i in strange
    )
    if drop and outliers:
        keep = np.setdiff1d(np.arange(len(x)), np.union1d(*bad).astype(int))
        x, run, y, by_force = x[keep], run[keep], y[keep], by_force[keep]
        time = None if time is None else time[keep]
        _require_line(e.where, x, run)
    lines = fit_lines(x, y, run, by_force, time)
    covariance, dof = _covariance(lines, run_scatter, notes)
    t = t_quantile(level, dof)
    k, v = lines.slope
    covariance = _bowed(e, heights, unseen, lines.slope, covariance, t, notes)
    far = [str(o.line) for o in outliers if o.quantity == "force"]
    require_spring(e.where, x, y, lines.slope, t * covariance[0, 0] ** 0.5, load_cell, far)
    stiffness = element_stiffness(k, covariance[0, 0] ** 0.5, load_cell, t, notes)
    per_deflection, per_force = sensitivities(k, v, covariance, load_cell, t)
    means = over_runs(x, y, run)
    cell = load_cell.stiffness
    paper = as_paper(*means, cell, level, notes)
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
        *extremes(*means, cell),
        *linearity(*means),
        outliers,
        tuple(notes),
    )


def _bowed(
    e: _InContact,
    heights: list[float],
    unseen: list[float],
    slope: np.ndarray,
    covariance: np.ndarray,
    t: float,
    notes: list[str],
) -> np.ndarray:
    """The slopes' covariance, widened so that t standard errors also cover the slope error by the bow."""
    start, first = float((e.x - e.travel)[0]), float(e.x.min())
    start -= (first - start) if start > 0 else 0.0  # a file that leaves out zero begins a step after contact
    off = np.array([off_the_chord(height, e.x, start) for height in heights])
    for name, height, share in zip(("force", "signal"), heights, off):
        if height:
            notes.append(
                f"the {name} bows by up to {height:.1%} of its full scale (hysteresis, friction): the "
                f"interval of its slope is {share:.1%} wider either way; readings of the way back would tell"
            )
    se, wider = np.sqrt(np.diag(covariance)), off * np.abs(slope) / t
    # a bow that is only possible counts as one more independent error
    possible = np.array(
        [0.0 if height else off_the_chord(u, e.x, start) for height, u in zip(heights, unseen)]
    )
    if possible.any():
        notes.append(
            f"one element alone seldom shows hysteresis: {max(unseen):.1%} of full scale is assumed; "
            "read the way back, or several elements"
        )
    return covariance + np.diag((se + wider) ** 2 - se**2 + (possible * slope / t) ** 2)


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
    """Raise InputError if the readings in contact are too few to show any scatter about their line."""
    if spare_steps(x, run) < 1:
        value = f"{len(x)} in {len(np.unique(run))} runs"
        legal = "after the first displacement two more than runs, in one run at two displacements at least"
        raise InputError(where, "too few readings in contact", value=value, legal=legal)


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


def first_in_contact(x: np.ndarray, force: np.ndarray, run: np.ndarray) -> tuple[float, int]:
    """The smallest displacement at which the readings are surely in contact.

    Before contact the force lies above the line of the later readings, extended to smaller displacements.
    Going down from the largest displacements, the first step whose readings lie above that line in any run
    (one-sided t test) is left out with all before it. At least three steps and 60 % of all are kept; with
    three displacements none is left out.

    Parameters
    ----------
    x, force, run : arrays, [reading]
        Displacement of the stage (mm), force (N), number of the run.

    Returns
    -------
    first : float
        mm; the second displacement unless the test leaves out more.
    left_out : int
        Number of steps before it.
    """
    step, index = np.unique(steps(x), return_inverse=True)
    if len(step) > MOST:
        group = np.arange(len(step)) * MOST // len(step)
        step, index = step[np.searchsorted(group, np.arange(MOST))], group[index]
    run = np.unique(run, return_inverse=True)[1]
    start = len(step) - max(ceil(IN_CONTACT * len(step)), 3)
    for i in range(start - 1, 0, -1):
        beyond = index > i
        if not _on_line(x, force, run, beyond, index == i):
            return float(step[i + 1]), i + 1
    return (float(step[1]), 1) if len(step) >= FEWEST else (float(step[0]), 0)


def _on_line(x: np.ndarray, force: np.ndarray, run: np.ndarray, beyond: np.ndarray, at: np.ndarray) -> bool:
    """Whether the readings `at` one step lie on or below the line through those `beyond` it in every run.

    `at` and `beyond` mark readings (True or False each); runs are numbered from 0.
    """
    at_step, later = (np.bincount(run[rows], minlength=run.max() + 1) for rows in (at, beyond))
    both = (at_step > 0) & (later > 0)
    if not both.any() or spare_steps(x[beyond], run[beyond]) < 1:
        return True
    lines = fit_lines(x[beyond], force[beyond, None], run[beyond])
    noise = float((lines.residual[:, 0] ** 2).sum()) / lines.dof  # variance of one reading about the lines

    def apart(v: np.ndarray) -> np.ndarray:
        """Mean at the step less that beyond it, by run."""
        sums = [np.bincount(run[rows], v[rows], len(both))[both] for rows in (at, beyond)]
        return sums[0] / at_step[both] - sums[1] / later[both]

    away = apart(x)
    excess = apart(force) - lines.slope[0] * away
    spread = (noise * (1 / at_step[both] + 1 / later[both]) + lines.covariance[0, 0] * away**2) ** 0.5
    above = excess > 1e-12 * np.abs(force).max()  # readings without noise differ from the line by rounding
    chance = stdtr(lines.dof, -excess / np.maximum(spread, 1e-300))
    return not (above & (chance < BEFORE / both.sum())).any()
