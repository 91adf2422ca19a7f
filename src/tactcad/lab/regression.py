"""Straight lines through repeated runs: common slope, an intercept a run, two responses at once.

Sources: weighted least squares and its t interval (any statistics text); Fieller 1954 for the ratio of two
normal estimates; Rosner 1983 for the generalised extreme Studentized deviate test.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, sqrt

import numpy as np
from scipy.special import stdtrit

from tactcad.design.messages import InputError

KNOWN = 1e6  # degrees of freedom of what counts as known


@dataclass(frozen=True)
class Lines:
    """Common slopes of the responses y[:, k] against x, with one intercept a run.

    covariance: of the slopes by the scatter about the lines, [k, k], with dof degrees of freedom; residual:
    [reading, k]; leverage: by reading. run_slope: [run, k]; between: covariance of the common slopes by the
    scatter of the runs' own slopes, [k, k], with one degree of freedom fewer than runs (nan with one run).
    """

    slope: np.ndarray
    covariance: np.ndarray
    intercept: np.ndarray  # mean of the runs' intercepts, by k
    residual: np.ndarray
    leverage: np.ndarray
    weight: np.ndarray
    dof: int
    run_slope: np.ndarray
    run_share: np.ndarray  # of each run in the common slopes
    between: np.ndarray

    @property
    def runs(self) -> int:
        """Runs that have a slope of their own."""
        return len(self.run_slope)


def steps(x: np.ndarray) -> np.ndarray:
    """Displacements, mm: those that agree within 1e-9 mm are one step."""
    return np.round(x, 9)


def spare_steps(x: np.ndarray, run: np.ndarray) -> int:
    """How many steps there are, each counted in every run, beyond those that give every run its intercept and
    all of them a slope; below 0 there is no line.
    """
    at = steps(x)
    order = np.lexsort((at, run))
    another_run = np.diff(run[order]) != 0
    different = another_run | (np.diff(at[order]) != 0)
    return int(different.sum()) - int(another_run.sum()) - 1


def fit_lines(x: np.ndarray, y: np.ndarray, run: np.ndarray, weight: np.ndarray | None = None) -> Lines:
    """Weighted least squares of y[:, k] = intercept[run, k] + slope[k] x; weights need only be right in
    proportion.
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
    """Scatter below which the readings of each response y[:, k] differ by rounding only."""
    return np.maximum(1e-13 * np.abs(y).max(0), np.finfo(float).tiny ** 0.5)


def require_level(level: float) -> None:
    """Raises InputError for a level of intervals that is none."""
    if not 0.5 <= level < 1:
        raise InputError("level", "out of range", value=level, legal="from 0.5 to below 1")


def t_quantile(level: float, dof: float) -> float:
    """Half-width factor of a two-sided interval of that level."""
    return float(stdtrit(dof, 0.5 + level / 2))


def ratio_interval(top: float, bottom: float, covariance: np.ndarray, t: float) -> tuple[float, float]:
    """Fieller's interval of top/bottom from two normal estimates with their 2 x 2 covariance.

    (-inf, inf) where the data do not tell the bottom from zero.
    """
    a = bottom * bottom - t * t * covariance[1, 1]
    b = top * bottom - t * t * covariance[0, 1]
    if a <= 0:
        return -inf, inf
    (tt, tb), (_, bb) = covariance
    # b b - a c with c = top^2 - t^2 tt, without the difference of (top bottom)^2 from itself
    along = top * top * bb - 2 * top * bottom * tb + bottom * bottom * tt
    root = t * sqrt(max(along + t * t * (tb * tb - tt * bb), 0.0))
    return (b - root) / a, (b + root) / a


def extreme_deviates(
    x: np.ndarray, y: np.ndarray, run: np.ndarray, weight: np.ndarray, alpha: float = 0.01
) -> list[int]:
    """Readings that the line does not explain (generalised ESD), at most a tenth of them; largest first.

    x, y, run, weight: as fit_lines, one response. alpha is the chance of naming any reading where all are
    good. The search ends after PATIENCE readings in a row that the line does explain.
    """
    n = len(x)
    left = _Left(x, y, run, weight)
    smallest = float(rounding(y[:, None])[0])
    removed: list[int] = []
    named = 0
    for step in range(max(1, n // 10)):
        dof = n - step - left.runs - 1
        if dof < 2 or step - named > PATIENCE or left.sxx <= np.finfo(float).tiny:
            break
        scale = sqrt(left.sum_of_squares() / dof)
        if scale <= smallest:
            break
        worst, deviate = left.worst()
        t = float(stdtrit(dof - 1, 1 - alpha / (2 * (n - step))))
        removed.append(worst)
        if deviate / scale > t * sqrt(dof / (dof - 1 + t * t)):
            named = step + 1
        left.remove(worst)
    return removed[:named]


# A cluster of so many bad readings may hide one another; each further one costs time on good data only. All
# of a tenth are tried where an element has up to 200 readings.
PATIENCE = 20


class _Left:
    """A line with an intercept a run through the readings that are left, brought up to date as one is taken
    out.

    Means of a run and the common slope move in closed form (deletion of one row of least squares), so that a
    step costs a few sums and no fit.
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
        """The reading with the largest weighted residual for its leverage, and that ratio."""
        unexplained = np.maximum(1 - self.w * (1 / self.total + self.x**2 / self.sxx), 1e-12)
        square = self.w * self.residual**2 / unexplained
        i = int(square.argmax())
        return i, sqrt(square[i])

    def remove(self, i: int) -> None:
        """Take reading i out; it stays in the arrays as a run of its own without residual."""
        x, r, w, total = (float(v[i]) for v in (self.x, self.residual, self.w, self.total))
        here = self.run == self.run[i]
        self.run[i], self.x[i], self.residual[i], self.total[i] = -1 - i, 0.0, 0.0, w
        here[i] = False
        if not here.any():
            self.runs -= 1
            return
        rest = total - w
        self.sxx -= w * x * x * total / rest
        turned = -w * x * r * total / rest / self.sxx if self.sxx > 0 else 0.0  # what the slope gains
        self.residual -= turned * self.x
        self.residual[here] += w * (r - turned * x) / rest
        self.x[here] += w * x / rest
        self.total[here] = rest
