"""Straight lines through repeated runs: one slope, an intercept for each run, several responses at once.

Sources: weighted least squares and its t interval (any statistics text); Rosner 1983 for the generalised
extreme Studentized deviate (ESD) test.

The variance of a reading is one law for all elements of a file, since the same sensors read them:
variance = a + b slope^2 + c (slope travel)^2 with a, b, c >= 0: the read-out's own noise, the stage's (the
same error of displacement gives more force on a stiff element), and noise that grows with the reading (a
sensor's per cent of value). One element has too few readings to distinguish noise that grows from an outlier
at its largest reading.

A run read on the way up only bows to one side, by hysteresis and friction: force lags behind, most in the
middle of the travel. The bow repeats in every run, so the scatter does not show it, and it shifts the slope:
the first displacement is left out, and over the rest the line is not the chord. The bow is estimated from all
elements of a file, which share stage and sensors, and from each element alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np
from scipy.optimize import nnls
from scipy.special import stdtrit

from tactcad.design.messages import InputError

KNOWN = 1e6  # degrees of freedom of a variance that counts as known
# Squared residuals are capped at so many variances (three standard deviations), so that a bad reading is not
# taken for noise that grows. For normal noise the cap lowers the mean square by 1 %.
STRANGE = 9.0
FITS = 2  # of the lines: with equal weights, then with the law's, so that noisy readings do not tilt them
ROUNDS = 6  # fits of the law, each weighted and capped by the one before; it stops changing after five
RANGE = 100.0  # largest over smallest variance allowed within one element
MEDIAN = 0.455  # of chi-squared with one degree of freedom, over its mean


@dataclass(frozen=True)
class Lines:
    """Slopes of the responses y[:, k] over x, common to all runs, with an intercept for each run."""

    slope: np.ndarray  # [k]
    covariance: np.ndarray  # of the slopes, from the scatter about the lines, [k, k]
    intercept: np.ndarray  # mean of the runs' intercepts, [k]
    residual: np.ndarray  # [reading, k]
    leverage: np.ndarray  # [reading]
    weight: np.ndarray  # [reading], 1 on average
    dof: int  # degrees of freedom of `covariance`
    run_slope: np.ndarray  # each run's own slopes, [run, k]
    run_share: np.ndarray  # weight of each run in the common slopes, [run], 1 in sum
    # covariance of the common slopes from the scatter of the runs' own, [k, k], with one degree of freedom
    # fewer than runs; nan with one run
    between: np.ndarray

    @property
    def runs(self) -> int:
        """Runs that have a slope of their own."""
        return len(self.run_slope)


def steps(x: np.ndarray) -> np.ndarray:
    """Displacements (mm) rounded to 1e-9 mm, so that those of one step are equal."""
    return np.round(x, 9)


def spare_steps(x: np.ndarray, run: np.ndarray) -> int:
    """Number of steps, counted in every run, less the number of parameters of the lines: an intercept for
    each run and a common slope. Below 0 there is no line, at 0 no scatter about it."""
    at = steps(x)
    order = np.lexsort((at, run))
    another_run = np.diff(run[order]) != 0
    different = another_run | (np.diff(at[order]) != 0)
    return int(different.sum()) - int(another_run.sum()) - 1


def fit_lines(
    x: np.ndarray,
    y: np.ndarray,
    run: np.ndarray,
    weight: np.ndarray | None = None,
    time: np.ndarray | None = None,
) -> Lines:
    """Weighted least squares of y[:, k] = intercept[run, k] + slope[k] x, and + drift[k] time if there is
    time.

    Parameters
    ----------
    x : array, [reading]
    y : array, [reading, k]
        k responses.
    run : array, [reading]
        Number of the reading's run.
    weight : array, [reading], optional
        Proportional to 1/variance; by default equal.
    time : array, [reading], optional
        With it, every response drifts at a rate of its own, one for all runs. Displacement and responses are
        then what time leaves of them (Frisch and Waugh), and the slopes the same as with time in the fit.

    Returns
    -------
    Lines
        Slopes in units of y over those of x.
    """
    w = np.ones(len(x)) if weight is None else weight / weight.mean()
    runs, index = np.unique(run, return_inverse=True)
    total = np.bincount(index, w)

    def centred(v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        mean = np.bincount(index, w * v) / total
        return v - mean[index], mean

    xc, x_mean = centred(x)
    parts = [centred(column) for column in y.T]
    yc = np.column_stack([p[0] for p in parts])
    y_mean = np.column_stack([p[1] for p in parts])
    of_time: np.ndarray | float = 0.0
    if time is not None:
        tc, t_mean = centred(time)
        stt = float(w @ tc**2)
        x_rate, y_rate = (w * tc) @ xc / stt, (w * tc) @ yc / stt
        xc, yc, of_time = xc - x_rate * tc, yc - np.outer(tc, y_rate), w * tc**2 / stt
        x_mean, y_mean = x_mean - x_rate * t_mean, y_mean - np.outer(t_mean, y_rate)
    sxx = np.bincount(index, w * xc * xc)
    sxy = np.column_stack([np.bincount(index, w * xc * column) for column in yc.T])
    slope = sxy.sum(0) / sxx.sum()
    residual = yc - np.outer(xc, slope)
    dof = len(x) - len(runs) - 1 - (time is not None)
    scatter = (residual * w[:, None]).T @ residual / dof
    has_slope = sxx > 0
    run_slope = sxy[has_slope] / sxx[has_slope, None]
    share = sxx[has_slope] / sxx.sum()
    off = run_slope - slope
    between = (off * share[:, None]).T @ off / max(len(share) - 1, 1) if len(share) > 1 else scatter * np.nan
    intercept, covariance = (y_mean - np.outer(x_mean, slope)).mean(0), scatter / sxx.sum()
    leverage = w / total[index] + w * xc * xc / sxx.sum() + of_time
    return Lines(slope, covariance, intercept, residual, leverage, w, dof, run_slope, share, between)


# Largest factor on the variance of a slope by fitting drift too. Beyond that factor, displacement or load
# goes with time, and drift cannot be separated. Chosen: twice the standard error.
TOLD_FROM_TIME = 4.0


def told_from_time(x: np.ndarray, time: np.ndarray, run: np.ndarray) -> bool:
    """Whether readings at displacements x tell a drift from a slope, with an intercept for each run."""
    index = np.unique(run, return_inverse=True)[1]
    xc, tc = (v - (np.bincount(index, v) / np.bincount(index))[index] for v in (x, time))
    stt, sxx = float(tc @ tc), float(xc @ xc)
    return stt > 0 and sxx < TOLD_FROM_TIME * (sxx - float(xc @ tc) ** 2 / stt)


def drifts(x: np.ndarray, y: np.ndarray, run: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Rate of every response y[:, k], in its unit a second, by least squares with `fit_lines`' slope; [k]."""
    left = fit_lines(time, y, run, time=x)  # the same fit: what displacement leaves of time
    return left.slope


def rounding(y: np.ndarray) -> np.ndarray:
    """Difference below which readings of a response y[:, k] differ by rounding only; array, [k]."""
    return np.maximum(1e-13 * np.abs(y).max(0), np.finfo(float).tiny ** 0.5)


def require_level(level: float) -> None:
    """Raise InputError for a confidence level outside 0.5 to 1."""
    if not 0.5 <= level < 1:
        raise InputError("level", "out of range", value=level, legal="from 0.5 to below 1")


def t_quantile(level: float, dof: float) -> float:
    """Half-width of a two-sided interval of that level, in standard errors."""
    return float(stdtrit(dof, 0.5 + level / 2))


def extreme_deviates(
    x: np.ndarray, y: np.ndarray, run: np.ndarray, weight: np.ndarray, alpha: float = 0.01
) -> list[int]:
    """Outliers about the line, by the generalised ESD test.

    The search ends after PATIENCE removed readings in a row that are no outliers.

    Parameters
    ----------
    x, y, run, weight : arrays, [reading]
        As for `fit_lines`, with one response.
    alpha : float
        Probability that a reading is reported although all are good.

    Returns
    -------
    list of int
        Indices of at most a tenth of the readings, the furthest off first.
    """
    n, left = len(x), np.arange(len(x))
    smallest = float(rounding(y[:, None])[0])
    removed: list[int] = []
    outliers = 0
    for step in range(max(1, n // 10)):
        dof = len(left) - len(np.unique(run[left])) - 1
        if dof < 2 or step - outliers > PATIENCE or spare_steps(x[left], run[left]) < 0:
            break
        lines = fit_lines(x[left], y[left, None], run[left], weight[left])
        residual = lines.residual[:, 0] * np.sqrt(lines.weight)
        scale = sqrt(float(residual @ residual) / dof)
        if scale <= smallest:
            break
        deviate = np.abs(residual) / np.sqrt(np.maximum(1 - lines.leverage, 1e-12))
        worst = int(deviate.argmax())
        removed.append(int(left[worst]))
        t = float(stdtrit(dof - 1, 1 - alpha / (2 * (n - step))))
        if deviate[worst] / scale > t * sqrt(dof / (dof - 1 + t * t)):
            outliers = step + 1
        left = np.delete(left, worst)
    return removed[:outliers]


# Largest number of bad readings that may mask one another; more costs time and finds nothing in good data. Of
# up to 200 readings a tenth is tried.
PATIENCE = 20


@dataclass(frozen=True)
class Readings:
    """One element's readings of force or signal; arrays, [reading]."""

    x: np.ndarray  # displacement, mm
    travel: np.ndarray  # displacement from the element's smallest one, mm
    y: np.ndarray  # force, N, or signal, V
    run: np.ndarray


def weights(elements: Sequence[Readings]) -> list[np.ndarray]:
    """1/variance of every reading (1/N2 or 1/V2), one array for each element."""
    weight = [np.ones(len(e.x)) for e in elements]
    for _ in range(FITS):
        weight = _by_law(elements, weight)
    return weight


def _by_law(elements: Sequence[Readings], weight: list[np.ndarray]) -> list[np.ndarray]:
    lines = [fit_lines(e.x, e.y[:, None], e.run, w) for e, w in zip(elements, weight)]
    square = [line.residual[:, 0] ** 2 / np.maximum(1 - line.leverage, 0.1) for line in lines]
    slope = np.concatenate([np.full(len(e.x), line.slope[0]) for e, line in zip(elements, lines)])
    grown = slope * np.concatenate([e.travel for e in elements])
    terms = np.column_stack([np.ones_like(slope), slope, grown]) ** 2
    terms /= np.maximum(terms.max(0), np.finfo(float).tiny)
    ends = np.cumsum([len(e.x) for e in elements])[:-1]
    measured = np.concatenate(square)
    smallest = np.finfo(float).tiny ** 0.5
    variance = np.concatenate([np.full(len(s), _start(s)) for s in square])
    for _ in range(ROUNDS):
        variance = np.maximum(variance, smallest)
        held = np.minimum(measured / variance, STRANGE)
        least = variance.min()
        law = least * nnls(*_normal_form(terms * (least / variance)[:, None], held))[0]
        variance = np.concatenate([np.maximum(v, v.max() / RANGE) for v in np.split(terms @ law, ends)])
    return np.split(1 / np.maximum(variance, smallest), ends)


def _normal_form(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Square r, and c, such that |r v - c|^2 and |a v - b|^2 differ by a constant: least squares of many
    readings as one of few.

    By the eigenvalues of a^T a, since columns can be equal: with one element those of a and b are.
    """
    eigenvalue, vector = np.linalg.eigh(a.T @ a)
    root = np.sqrt(np.maximum(eigenvalue, np.finfo(float).eps * eigenvalue[-1]))
    return root[:, None] * vector.T, vector.T @ (a.T @ b) / root


def _start(square: np.ndarray) -> float:
    """First guess of an element's variance, from the median of its squared residuals; their mean if the
    median is zero."""
    return float(np.median(square)) / MEDIAN or float(square.mean())


@dataclass(frozen=True)
class Bow:
    """Height of the bow in the middle of the travel over the change along the travel, with its standard error
    and degrees of freedom; below 0 for a hollow line, such as a force that rises late."""

    height: float
    standard_error: float
    dof: int

    def told(self, chance: float) -> bool:
        """Whether noise gives such a bow with less than that probability."""
        return abs(self.height) > t_quantile(1.0 - chance, self.dof) * self.standard_error

    @property
    def most(self) -> float:
        """Upper end of its 95 % interval, whatever its side."""
        return abs(self.height) + t_quantile(0.95, self.dof) * self.standard_error


def bow(x: np.ndarray, y: np.ndarray, run: np.ndarray, weight: np.ndarray) -> Bow | None:
    """The bow of one response.

    Parameters
    ----------
    x, y, run, weight : arrays, [reading]
        As for `regression.fit_lines`, with one response.

    Returns
    -------
    Bow or None
        y = intercept[run] + slope x + curvature x^2 by weighted least squares; the height over the full scale
        is then -curvature range/(4 slope). None if there are too few displacements to tell a parabola.
    """
    if len(np.unique(np.round(x, 9))) < 4:
        return None
    square = (x - x.mean()) ** 2
    both = fit_lines(x, np.column_stack([square, y]), run, weight)
    w, (q, left), travel = both.weight, both.residual.T, np.ptp(x)
    sqq, dof = float(w @ q**2), both.dof - 1
    if dof < 1 or both.slope[1] == 0.0 or sqq <= 1e-12 * travel**4:
        return None
    curvature = float(w @ (q * left)) / sqq
    noise = float(w @ (left - curvature * q) ** 2) / dof
    share = travel / (4.0 * both.slope[1])
    return Bow(-curvature * share, abs(share) * (noise / sqq) ** 0.5, dof)


def common(bows: Sequence[Bow | None]) -> Bow | None:
    """The mean of the elements' bows, weighted by their variances; None if none is known. Its variance is
    Meier's (Biometrics 9, 1953), which allows for estimated weights."""
    known = [b for b in bows if b and b.standard_error > 0.0]
    if not known:
        return None
    weight = np.array([b.standard_error**-2 for b in known])
    mean = float(weight @ [b.height for b in known] / weight.sum())
    share = weight / weight.sum()
    guessed = 1.0 + 4.0 * float((share * (1.0 - share) / [b.dof for b in known]).sum())
    return Bow(mean, (guessed / weight.sum()) ** 0.5, sum(b.dof for b in known))


def off_the_chord(height: float, x: np.ndarray, start: float) -> float:
    """Relative deviation, for a bow of that height, of the slope of readings at x (mm) from that of the chord
    from `start`, where contact began, to the largest x.

    The slope of a parabola is linear in x: over evenly spread readings the line has that of their middle, the
    chord that of its own.
    """
    return 4.0 * abs(height) * max(float(x.min()) - start, 0.0) / max(float(np.ptp(x)), 1e-12)
