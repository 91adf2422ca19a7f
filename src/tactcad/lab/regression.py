"""Straight lines through repeated runs: one slope, an intercept for each run, several responses at once.

Sources: weighted least squares and its t interval (any statistics text); Rosner 1983 for the generalised
extreme Studentized deviate (ESD) test.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np
from scipy.special import stdtrit

from tactcad.design.messages import InputError

KNOWN = 1e6  # degrees of freedom of a variance that counts as known


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


def fit_lines(x: np.ndarray, y: np.ndarray, run: np.ndarray, weight: np.ndarray | None = None) -> Lines:
    """Weighted least squares of y[:, k] = intercept[run, k] + slope[k] x.

    Parameters
    ----------
    x : array, [reading]
    y : array, [reading, k]
        k responses.
    run : array, [reading]
        Number of the reading's run.
    weight : array, [reading], optional
        Proportional to 1/variance; by default equal.

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
    sxx = np.bincount(index, w * xc * xc)
    sxy = np.column_stack([np.bincount(index, w * xc * column) for column in yc.T])
    slope = sxy.sum(0) / sxx.sum()
    residual = yc - np.outer(xc, slope)
    dof = len(x) - len(runs) - 1
    scatter = (residual * w[:, None]).T @ residual / dof
    has_slope = sxx > 0
    run_slope = sxy[has_slope] / sxx[has_slope, None]
    share = sxx[has_slope] / sxx.sum()
    off = run_slope - slope
    between = (off * share[:, None]).T @ off / max(len(share) - 1, 1) if len(share) > 1 else scatter * np.nan
    return Lines(
        slope,
        scatter / sxx.sum(),
        (y_mean - np.outer(x_mean, slope)).mean(0),
        residual,
        w / total[index] + w * xc * xc / sxx.sum(),
        w,
        dof,
        run_slope,
        share,
        between,
    )


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
        Probability that a reading is reported where all are good.

    Returns
    -------
    list of int
        Indices of at most a tenth of the readings, the furthest off first.
    """
    n = len(x)
    left = _Left(x, y, run, weight)
    smallest = float(rounding(y[:, None])[0])
    removed: list[int] = []
    outliers = 0
    for step in range(max(1, n // 10)):
        dof = n - step - left.runs - 1
        if dof < 2 or step - outliers > PATIENCE or left.sxx <= np.finfo(float).tiny:
            break
        scale = sqrt(left.sum_of_squares() / dof)
        if scale <= smallest:
            break
        worst, deviate = left.worst()
        t = float(stdtrit(dof - 1, 1 - alpha / (2 * (n - step))))
        removed.append(worst)
        if deviate / scale > t * sqrt(dof / (dof - 1 + t * t)):
            outliers = step + 1
        left.remove(worst)
    return removed[:outliers]


# So many bad readings close together may hide one another; trying more costs time and, on good data, finds
# nothing. Of up to 200 readings a whole tenth is tried.
PATIENCE = 20


class _Left:
    """The fit of one response to the readings that are left, updated as readings are removed one by one.

    The runs' means and the slope change in closed form (least squares with one row deleted), so that a
    removal costs a few sums and no fit.
    """

    def __init__(self, x: np.ndarray, y: np.ndarray, run: np.ndarray, weight: np.ndarray) -> None:
        runs, self.run = np.unique(run, return_inverse=True)
        self.runs = len(runs)
        self.w = weight / weight.mean()
        self.total = np.bincount(self.run, self.w)[self.run]  # weight of each one's run
        self.x, yc = (v - np.bincount(self.run, self.w * v)[self.run] / self.total for v in (x, y))
        self.sxx = float(self.w @ self.x**2)
        self.residual = yc - ((self.w * self.x) @ yc / self.sxx if self.sxx else 0.0) * self.x

    def sum_of_squares(self) -> float:
        return float(self.w @ self.residual**2)

    def worst(self) -> tuple[int, float]:
        """Index of the reading with the largest weighted residual after scaling by its leverage, and that
        residual."""
        unexplained = np.maximum(1 - self.w * (1 / self.total + self.x**2 / self.sxx), 1e-12)
        square = self.w * self.residual**2 / unexplained
        i = int(square.argmax())
        return i, sqrt(square[i])

    def remove(self, i: int) -> None:
        """Remove reading i: it stays in the arrays as a run of its own without residual."""
        x, r, w, total = (float(v[i]) for v in (self.x, self.residual, self.w, self.total))
        same_run = self.run == self.run[i]
        self.run[i], self.x[i], self.residual[i], self.total[i] = -1 - i, 0.0, 0.0, w
        same_run[i] = False
        if not same_run.any():
            self.runs -= 1
            return
        rest = total - w
        self.sxx -= w * x * x * total / rest
        change = -w * x * r * total / rest / self.sxx if self.sxx > 0 else 0.0  # of the slope
        self.residual -= change * self.x
        self.residual[same_run] += w * (r - change * x) / rest
        self.x[same_run] += w * x / rest
        self.total[same_run] = rest
