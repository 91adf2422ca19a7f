"""From force, deflection and signal readings to Table 1's columns with intervals.

The stage's displacement X is shared by two springs, element K and load cell K_c, so F = k X + c with k = K
K_c/(K + K_c). Force and signal are regressed on X, which the micrometer sets, and the series spring is
removed from the slopes: K = k K_c/(K_c - k), K_v = v/(1 - k/K_c), K_v/K = v/k, with k and v the slopes of
force and signal. Regressing on d = X - F/K_c, as the paper did, puts the force's noise on both axes; that
estimate is given beside it.

Every interval covers more than noise. Runs differ: the slopes' variance is taken from the runs' own slopes
(Student's t with one degree of freedom fewer than runs); with a single run it is assumed. The load cell's
stiffness is known within limits: the interval holds for every value within them. Readings before contact are
detected and left out.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf

import numpy as np

from tactcad.design.messages import InputError
from tactcad.lab import noise
from tactcad.lab.contact import first_in_contact
from tactcad.lab.load_cell import LoadCell, series_removed
from tactcad.lab.readings import CalibrationReadings, groups
from tactcad.lab.regression import (
    KNOWN,
    Lines,
    extreme_deviates,
    fit_lines,
    ratio_interval,
    require_level,
    rounding,
    spare_steps,
    steps,
    t_quantile,
)

FALSE_ALARM = 0.01  # probability that an outlier is reported in a file that has none
# Assumed standard deviation of an element's slope from run to run, relative, where there is a single run.
# Chosen: a micrometer read to 1 um over the 100 to 150 um of a calibration's travel.
RUN_SCATTER = 0.01


@dataclass(frozen=True)
class Estimate:
    """A value with its interval; standard error as used for the interval. Same unit throughout."""

    value: float
    low: float
    high: float
    standard_error: float


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
    _require_spring(e.where, x, y, lines.slope, t * covariance[0, 0] ** 0.5, load_cell, outliers)
    stiffness = _stiffness(k, covariance[0, 0] ** 0.5, load_cell, t, notes)
    per_deflection, per_force = _sensitivities(k, v, covariance, load_cell, t)
    averaged = _averaged(x, y, run)
    cell = load_cell.stiffness
    paper = _as_paper(*averaged, cell, level, notes)
    return ElementCalibration(
        e.number,
        len(x),
        len(set(run.tolist())),
        stiffness,
        paper[0],
        per_deflection,
        paper[1],
        per_force,
        _correlation(k, v, covariance, cell),
        dof,
        float(lines.intercept[1] - v * lines.intercept[0] / k),
        *_extremes(*averaged, cell),
        *_linearity(*averaged),
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


def _require_spring(
    where: str,
    x: np.ndarray,
    y: np.ndarray,
    slope: np.ndarray,
    half_width: float,
    load_cell: LoadCell,
    outliers: tuple[Outlier, ...],
) -> None:
    """Raise InputError where the force (y[:, 0], N) cannot be that of a spring and a load cell in series, or
    the signal (y[:, 1], V) that of a gauge on the spring.

    `slope` is of force and signal over displacement (N/mm, V/mm), `half_width` that of the force's slope.
    """
    constant = np.abs(slope) * np.ptp(x) <= rounding(y)
    for name, unit, unchanged in zip(("force", "signal"), "NV", constant):
        if unchanged:
            raise InputError(
                where,
                f"the {name} does not change with displacement",
                legal=f"{name} in {unit} that {'rises' if unit == 'N' else 'changes'} with displacement",
            )
    k = float(slope[0])
    if k + half_width < 0:
        raise InputError(
            where,
            f"the force falls with displacement, by {-k:.4g} N/mm: the sign of one column is reversed",
            legal="force and displacement both grow as the element is pressed",
        )
    if k - half_width >= load_cell.ends[1]:
        raise InputError(
            where,
            f"the force rises by {k:.4g} N/mm, which the load cell of {load_cell.stiffness:g} N/mm cannot: "
            "another unit of displacement or force, or another load cell",
            legal="displacement in mm (displacement_um for micrometres), force in N, --load-cell",
        )
    far = [str(o.line) for o in outliers if o.quantity == "force"]
    if far and not 0 < k < load_cell.ends[1]:  # without outliers noise alone can bring k there: no refusal
        does = "falls with displacement" if k <= 0 else "rises by more than the load cell can"
        raise InputError(
            where,
            f"the force {does}, because of what lies far from the other readings: line {', '.join(far)}",
            value=f"{k:.4g} +-{half_width:.4g} N/mm",
            legal="force in N that rises with displacement; --drop-outliers leaves those lines out",
        )


def _stiffness(k: float, se: float, load_cell: LoadCell, t: float, notes: list[str]) -> Estimate:
    """K = k K_c/(K_c - k), N/mm. It rises with k and falls with K_c, so each end of the interval comes from
    that end of k and the load cell at the limit that widens it."""
    low, high = k - t * se, k + t * se
    softest, stiffest = load_cell.ends
    if low <= 0:
        notes.append(
            "the force does not rise with displacement beyond noise: the data do not tell the stiffness "
            "from zero"
        )
    if high >= softest:
        notes.append("as stiff as the load cell within noise: the data bound the stiffness from below only")
    cell = load_cell.stiffness
    slope = (1 - k / cell) ** -2 if k < cell else inf
    return Estimate(
        series_removed(k, cell),
        max(series_removed(low, stiffest), 0.0),
        series_removed(high, softest),
        se * slope,
    )


def _sensitivities(
    k: float, v: float, covariance: np.ndarray, load_cell: LoadCell, t: float
) -> tuple[Estimate, Estimate]:
    """K_v = v/(1 - k/K_c) for every load cell within its limits, and K_v/K = v/k: ratios of two estimates,
    with Fieller's interval."""
    to_force = np.array([[0.0, 1.0], [1.0, 0.0]])

    def ratio(matrix: np.ndarray, bottom: float) -> Estimate:
        c = matrix @ covariance @ matrix.T
        value = v / bottom
        se = np.sqrt(max(c[0, 0] - 2 * value * c[0, 1] + value * value * c[1, 1], 0.0)) / abs(bottom)
        return Estimate(value, *ratio_interval(v, bottom, c, t), float(se))

    def per_deflection(cell: float) -> Estimate:
        return ratio(np.array([[0.0, 1.0], [-1 / cell, 0.0]]), 1 - k / cell)  # (k, v) -> (v, 1 - k/K_c)

    best, *ends = (per_deflection(cell) for cell in (load_cell.stiffness, *load_cell.ends))
    low, high = (min(e.low for e in ends), max(e.high for e in ends))
    return Estimate(best.value, low, high, best.standard_error), ratio(to_force, k)


def _correlation(k: float, v: float, covariance: np.ndarray, load_cell: float) -> float:
    """Correlation of K and K_v, linearised in k and v."""
    share = 1 - k / load_cell
    jacobian = np.array([[1 / share**2, 0.0], [v / load_cell / share**2, 1 / share]])
    c = jacobian @ covariance @ jacobian.T
    scale = (c[0, 0] * c[1, 1]) ** 0.5
    return float(np.clip(c[0, 1] / scale, -1, 1)) if scale > 0 else 0.0


def _averaged(x: np.ndarray, y: np.ndarray, run: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean over the runs at each displacement (equal within 1e-9 mm) that every run has; all readings as they
    are where fewer than three displacements are shared."""
    step, index = np.unique(steps(x), return_inverse=True)
    count = np.bincount(index)
    shared = count == len(np.unique(run))
    if shared.sum() < 3:
        return x, y
    mean = np.column_stack([np.bincount(index, column) / count for column in y.T])
    return step[shared], mean[shared]


def _as_paper(
    x: np.ndarray, y: np.ndarray, load_cell: float, level: float, notes: list[str]
) -> tuple[Estimate, Estimate]:
    """K and K_v as the paper took them: slopes of the averaged force and signal over d = X - F/K_c, each with
    its t interval."""
    d = x - y[:, 0] / load_cell
    lines = fit_lines(d, y, np.zeros(len(d), int))
    t = t_quantile(level, lines.dof)
    se = np.sqrt(np.diag(lines.covariance))
    if len(x) == len(np.unique(x)) and lines.dof < 3:
        notes.append(f"as the paper did it leaves {lines.dof} degrees of freedom")
    first, second = (
        Estimate(float(b), float(b - t * s), float(b + t * s), float(s)) for b, s in zip(lines.slope, se)
    )
    return first, second


def _extremes(x: np.ndarray, y: np.ndarray, load_cell: float) -> tuple[float, float, float]:
    """Largest deflection (mm), force (N) and change of signal (V) of the averaged readings."""
    deflection = x - y[:, 0] / load_cell
    return float(deflection.max()), float(y[:, 0].max()), float(np.ptp(y[:, 1]))


def _linearity(x: np.ndarray, y: np.ndarray) -> tuple[float, float]:
    """Largest deviation from the least-squares line over the full scale of the averaged readings."""
    lines = fit_lines(x, y, np.zeros(len(x), int))
    scale = np.ptp(y, axis=0)
    force, signal = np.where(scale > 0, np.abs(lines.residual).max(0) / np.where(scale > 0, scale, 1), inf)
    return float(force), float(signal)
