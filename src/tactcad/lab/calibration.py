"""From force, deflection and signal readings to Table 1's columns with intervals.

The stage's displacement X is shared by two springs, element K and load cell K_c, so F = k X + c with k = K
K_c/(K + K_c). Force and signal are regressed on X, which the micrometer sets, and the series spring is
removed from the slopes: K = k K_c/(K_c - k), K_v = v/(1 - k/K_c), K_v/K = v/k. Regressing on d = X - F/K_c,
as the paper did, puts the force's noise on both axes; that estimate is given beside it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, isinf

import numpy as np

from tactcad.design.messages import InputError
from tactcad.lab.readings import CalibrationReadings, groups
from tactcad.lab.regression import (
    Lines,
    extreme_deviates,
    fit_lines,
    ratio_interval,
    require_level,
    rounding,
    t_quantile,
    variance_weights,
)

RUNS_DIFFER = 0.01  # probability below which runs are said to have different slopes


@dataclass(frozen=True)
class Estimate:
    """A value with its interval; standard error as used for the interval. Same unit throughout."""

    value: float
    low: float
    high: float
    standard_error: float


@dataclass(frozen=True)
class Outlier:
    """A reading that the line does not explain."""

    element: int
    run: int
    displacement: float  # mm
    quantity: str  # force or signal
    line: int  # in the file


@dataclass(frozen=True)
class ElementCalibration:
    """Table 1's row of one element. Stiffness N/mm, deflection mm, force N, signal V."""

    element: int
    readings: int
    runs: int
    stiffness: Estimate
    stiffness_as_paper: Estimate  # average of the runs, F against d
    signal_per_deflection: Estimate
    signal_per_deflection_as_paper: Estimate
    signal_per_force: Estimate
    correlation: float  # of stiffness and signal_per_deflection
    dof: float
    zero_signal: float  # at zero force
    max_deflection: float
    max_force: float
    max_signal_change: float
    linearity_force: float  # largest deviation of the averaged readings over full scale, ratio
    linearity_signal: float
    outliers: tuple[Outlier, ...]
    notes: tuple[str, ...]


def calibrate(
    readings: CalibrationReadings,
    load_cell: float,
    *,
    level: float = 0.95,
    drop_outliers: bool = False,
    tell: Callable[[int, int, str], None] = lambda done, total, what: None,
) -> list[ElementCalibration]:
    """One row an element, in the order of the file.

    load_cell: stiffness of the force sensor, N/mm (inf for a rigid one). level: of every interval. tell:
    hears of every element before it is fitted. Raises InputError where an element's readings are those of no
    spring.
    """
    if not load_cell > 0:
        raise InputError(
            "load cell", "stiffness must be positive", value=load_cell, legal="above 0 N/mm, or inf"
        )
    require_level(level)
    found, parts = [], groups(readings.element)
    for number, here in parts:
        tell(len(found), len(parts), f"element {number}")
        found.append(_element(readings, number, here, load_cell, level, drop_outliers))
    return found


def series_removed(slope: float, load_cell: float) -> float:
    """Stiffness of the element behind a load cell: k K_c/(K_c - k), N/mm; inf where k reaches K_c."""
    if isinf(load_cell):
        return slope
    return slope * load_cell / (load_cell - slope) if slope < load_cell else inf


def _element(
    all_: CalibrationReadings, number: int, here: np.ndarray, load_cell: float, level: float, drop: bool
) -> ElementCalibration:
    x, run = all_.displacement[here], all_.run[here]
    y = np.column_stack([all_.force[here], all_.signal[here]])
    bad = [extreme_deviates(x, y[:, k], run) for k in (0, 1)]
    outliers = tuple(
        Outlier(number, int(run[i]), float(x[i]), name, int(all_.line[here[i]]))
        for name, found in zip(("force", "signal"), bad)
        for i in found
    )
    notes = []
    if drop and outliers:
        keep = np.setdiff1d(np.arange(len(x)), np.union1d(*bad).astype(int))
        x, run, y = x[keep], run[keep], y[keep]
    lines = fit_lines(x, y, run)
    lines = fit_lines(x, y, run, variance_weights(lines, x, 0))
    covariance, dof = _covariance(lines, notes)
    t = t_quantile(level, dof)
    k, v = lines.slope
    _require_spring(f"{all_.path}: element {number}", x, y, k, t * covariance[0, 0] ** 0.5, load_cell)
    stiffness = _stiffness(k, covariance[0, 0] ** 0.5, load_cell, t, notes)
    per_deflection, per_force = _sensitivities(k, v, covariance, load_cell, t)
    averaged = _averaged(x, y, run)
    paper = _as_paper(*averaged, load_cell, level, notes)
    return ElementCalibration(
        number,
        len(x),
        len(set(run.tolist())),
        stiffness,
        paper[0],
        per_deflection,
        paper[1],
        per_force,
        _correlation(k, v, covariance, load_cell),
        dof,
        float(lines.intercept[1] - v * lines.intercept[0] / k),
        *_extremes(*averaged, load_cell),
        *_linearity(*averaged),
        outliers,
        tuple(notes),
    )


def _covariance(lines: Lines, notes: list[str]) -> tuple[np.ndarray, float]:
    """Covariance of the two slopes; from the scatter between the runs where they differ beyond noise."""
    if lines.run_p.min() >= RUNS_DIFFER:
        return lines.covariance, lines.dof
    slopes = lines.run_slope[np.isfinite(lines.run_slope).all(1)]
    which = "force" if lines.run_p.argmin() == 0 else "signal"
    notes.append(
        f"the runs' {which} slopes differ beyond noise (p {lines.run_p.min():.1g}): interval from "
        f"{len(slopes)} runs"
    )
    return np.cov(slopes.T) / len(slopes), len(slopes) - 1


def _require_spring(
    where: str, x: np.ndarray, y: np.ndarray, k: float, half_width: float, load_cell: float
) -> None:
    """Raise InputError where the force (y[:, 0], N) cannot be that of a spring and a load cell in series.

    k, half_width: slope of force over displacement with its interval, N/mm.
    """
    if abs(k) * np.ptp(x) <= rounding(y)[0]:
        raise InputError(
            where,
            "the force does not change with displacement",
            legal="force in N that rises with displacement",
        )
    if k + half_width < 0:
        raise InputError(
            where,
            f"the force falls with displacement, by {-k:.4g} N/mm: the sign of one column is reversed",
            legal="force and displacement both grow as the element is pressed",
        )
    if k - half_width >= load_cell:
        raise InputError(
            where,
            f"the force rises by {k:.4g} N/mm, which the load cell of {load_cell:g} N/mm cannot: another "
            "unit "
            "of displacement or force, or another load cell",
            legal="displacement in mm (displacement_um for micrometres), force in N, --load-cell",
        )


def _stiffness(k: float, se: float, load_cell: float, t: float, notes: list[str]) -> Estimate:
    """The transform of k is monotonic, so the interval's ends transform exactly."""
    low, high = k - t * se, k + t * se
    if low <= 0:
        notes.append(
            "the force does not rise with displacement beyond noise: the data do not tell the stiffness "
            "from zero"
        )
    if high >= load_cell:
        notes.append("as stiff as the load cell within noise: the data bound the stiffness from below only")
    slope = (1 - k / load_cell) ** -2 if k < load_cell else inf
    return Estimate(
        series_removed(k, load_cell),
        max(series_removed(low, load_cell), 0.0),
        series_removed(high, load_cell),
        se * slope,
    )


def _sensitivities(
    k: float, v: float, covariance: np.ndarray, load_cell: float, t: float
) -> tuple[Estimate, Estimate]:
    """K_v = v/(1 - k/K_c) and K_v/K = v/k, both by Fieller."""
    share = 1 - k / load_cell
    to_share = np.array([[0.0, 1.0], [-1 / load_cell, 0.0]])  # (k, v) -> (v, share)
    to_force = np.array([[0.0, 1.0], [1.0, 0.0]])
    found = []
    for matrix, bottom in ((to_share, share), (to_force, k)):
        c = matrix @ covariance @ matrix.T
        ratio = v / bottom
        se = np.sqrt(max(c[0, 0] - 2 * ratio * c[0, 1] + ratio * ratio * c[1, 1], 0.0)) / abs(bottom)
        found.append(Estimate(ratio, *ratio_interval(v, bottom, c, t), float(se)))
    return found[0], found[1]


def _correlation(k: float, v: float, covariance: np.ndarray, load_cell: float) -> float:
    """Correlation of K and K_v by their derivatives."""
    share = 1 - k / load_cell
    jacobian = np.array([[1 / share**2, 0.0], [v / load_cell / share**2, 1 / share]])
    c = jacobian @ covariance @ jacobian.T
    scale = (c[0, 0] * c[1, 1]) ** 0.5
    return float(np.clip(c[0, 1] / scale, -1, 1)) if scale > 0 else 0.0


def _averaged(x: np.ndarray, y: np.ndarray, run: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean readings at each displacement (equal within 1e-9 mm) that every run has; all readings where none
    is shared.
    """
    step, index = np.unique(np.round(x, 9), return_inverse=True)
    count = np.bincount(index)
    shared = count == len(np.unique(run))
    if shared.sum() < 3:
        return x, y
    mean = np.column_stack([np.bincount(index, column) / count for column in y.T])
    return step[shared], mean[shared]


def _as_paper(
    x: np.ndarray, y: np.ndarray, load_cell: float, level: float, notes: list[str]
) -> tuple[Estimate, Estimate]:
    """Slopes with intercept of the averaged readings against d = X - F/K_c, each with its own t interval."""
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
