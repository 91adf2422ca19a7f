"""The object's stiffness that makes equation (1) agree over some elements, with its interval.

f + x s is the same for all elements, x = K_obj: two of them give Fieller's interval, more the generalised
least squares of the pairs that share a reference.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import inf, isinf, pi, tan

import numpy as np
from scipy.special import fdtrc

from tactcad.lab.regression import KNOWN, t_quantile

Misfit = Callable[[np.ndarray], np.ndarray]

DISAGREE = 0.01  # probability below which the elements are said to disagree
ANGLES = 721  # scan of the projective line of K_obj
# Weight of what the elements have in common against an element's own degrees of freedom. Chosen: ten times
# the two degrees that three runs leave, since weights that follow such variances make the interval too
# narrow.
PRIOR_DOF = 20.0
NO_VARIANCE = np.finfo(float).tiny ** 0.5  # of a slope without noise, V2/mm2 and V2/N2


@dataclass(frozen=True)
class Interval:
    """K_obj (N/mm) within [low, high]; high is inf and low 0 where the data do not bound it.

    estimate may be negative or inf: then no soft object explains the readings. empty: no K_obj >= 0 lies
    within it.
    """

    estimate: float
    low: float
    high: float
    empty: bool = False

    @property
    def bounded(self) -> bool:
        return not self.empty and self.low > 0 and not isinf(self.high)

    @property
    def verdict(self) -> str:
        if self.empty:
            return "no positive K_obj fits: calibration and grasp contradict each other"
        if self.bounded:
            return "bounded"
        if isinf(self.high):
            return "not bounded at all" if self.low <= 0 else "bounded from below only: at least this stiff"
        return "bounded from above only: at most this stiff"


@dataclass(frozen=True)
class Slopes:
    """Per unit approach: deflection s and force f by element, covariance of (f, s) by element, [n, 2, 2]."""

    element: np.ndarray
    s: np.ndarray
    f: np.ndarray
    from_signal: np.ndarray
    from_calibration: np.ndarray
    signal_dof: int
    calibration_dof: np.ndarray

    @property
    def covariance(self) -> np.ndarray:
        return self.from_signal + self.from_calibration

    def coupled(self, share: np.ndarray) -> Slopes:
        """What equation (1) sees where each pad also sinks by share[i, j] of what the force on pad j does
        there: p = s_i + sum_j share_ij f_j/x, with 1 on the diagonal.
        """
        return replace(self, f=self.f + (share - np.diag(np.diag(share))) @ self.f)


def combine(slopes: Slopes, level: float, members: list[int] | None = None) -> tuple[Interval, float, float]:
    """K_obj that makes f + x s most equal over the members (default all), its interval, p of their
    disagreement, and the factor by which that widens the standard error.

    Two members: the interval is Fieller's. The line of x is closed at infinity (x = scale tan(angle)), so
    that an interval that runs through infinity is found like any other.
    """
    m = list(range(len(slopes.s))) if members is None else members
    f, s, c = slopes.f[m], slopes.s[m], slopes.covariance[m]
    if len(m) > 2:
        c = slopes.from_signal[m] + _moderated(slopes, m)
    scale = float(np.median(np.abs(f / s)))
    # without noise in K and K_v, f + x s of an element has no variance at x = -K: hold it above zero there
    smallest = np.maximum(1e-14 * c[:, 0, 0], NO_VARIANCE)
    angle = np.linspace(-pi / 2, pi / 2, ANGLES)

    def misfit(a: np.ndarray) -> np.ndarray:
        cos, sin = np.cos(a)[:, None], scale * np.sin(a)[:, None]
        z = cos * f + sin * s
        w = 1 / np.maximum(cos**2 * c[:, 0, 0] + 2 * cos * sin * c[:, 0, 1] + sin**2 * c[:, 1, 1], smallest)
        mean = (w * z).sum(1) / w.sum(1)
        return (w * (z - mean[:, None]) ** 2).sum(1)

    best = _minimum(misfit, angle)
    least = float(misfit(np.array([best]))[0])
    extra = len(m) - 2
    inflation, dof = scatter(slopes, m, c, scale * tan(best))
    # the variances are estimates themselves: F, not chi-squared
    p = float(fdtrc(extra, dof, least / extra / inflation)) if extra > 0 else 1.0
    widened = (least / extra) ** 0.5 if p < DISAGREE else 1.0
    dof = extra if widened > 1 else dof
    limit = least + (t_quantile(level, dof) * widened) ** 2 * inflation
    return _interval(misfit, best, limit, scale), p, widened


def hull(best: Interval, others: Sequence[Interval]) -> Interval:
    """The smallest interval about all of them that are not empty, with the estimate of the first."""
    held = [i for i in (best, *others) if not i.empty]
    if not held:
        return best
    return Interval(best.estimate, min(i.low for i in held), max(i.high for i in held))


def _moderated(slopes: Slopes, m: list[int]) -> np.ndarray:
    """Covariances of (f, s) by the calibration that weigh the elements: each one's own, with few degrees of
    freedom, drawn towards what all of them have relative to their size (as Smyth 2004 does with variances).
    """
    size = np.stack([slopes.f[m], slopes.s[m]], -1)
    size = size[:, :, None] * size[:, None, :]
    dof = slopes.calibration_dof[m][:, None, None]
    own = slopes.from_calibration[m]
    common = (dof * own / size).sum(0) / dof.sum()
    return (dof * own + PRIOR_DOF * common * size) / (dof + PRIOR_DOF)


def scatter(slopes: Slopes, m: list[int], c: np.ndarray, x: float) -> tuple[float, float]:
    """Variance of the x that makes f + x s most equal under weights from c, by the elements' own covariances,
    over the one that c would give; and its degrees of freedom (Welch and Satterthwaite).
    """
    along = np.array([1.0, x]) if abs(x) < 1e12 else np.array([0.0, 1.0])
    w = 1 / np.maximum(np.einsum("i,nij,j->n", along, c, along), NO_VARIANCE)
    share = w / w.max()
    s = slopes.s[m] if abs(x) < 1e12 else slopes.f[m]
    pull = share * (s - (share * s).sum() / share.sum())  # relative, of each element's f + x s on x
    signal = pull**2 * np.einsum("i,nij,j->n", along, slopes.from_signal[m], along)
    calibration = pull**2 * np.einsum("i,nij,j->n", along, slopes.from_calibration[m], along)
    total = float((signal + calibration).sum())
    bottom = signal.sum() ** 2 / slopes.signal_dof + (calibration**2 / slopes.calibration_dof[m]).sum()
    model = float((pull**2 / w).sum())
    if not (total > 0 and model > 0 and bottom > 0):
        return 1.0, KNOWN
    return total / model, float(min(total**2 / bottom, KNOWN))


def _minimum(misfit: Misfit, angle: np.ndarray) -> float:
    """Least point of a function on the closed line of angles, by ever finer scans."""
    step = angle[1] - angle[0]
    best = float(angle[np.argmin(misfit(angle))])
    for _ in range(12):
        fine = best + np.linspace(-step, step, 41)
        best = float(fine[np.argmin(misfit(fine))])
        step /= 15
    return best


def _interval(misfit: Misfit, best: float, limit: float, scale: float) -> Interval:
    """The connected set about `best` where the misfit keeps below the limit, cut to K_obj >= 0."""
    edges = []
    for direction in (-1.0, 1.0):
        offset = np.linspace(0.0, pi, 2 * ANGLES)
        outside = np.flatnonzero(misfit(best + direction * offset) > limit)
        if not len(outside):
            return Interval(_value(best, scale), 0.0, inf)
        inner, outer = offset[max(outside[0] - 1, 0)], offset[outside[0]]
        for _ in range(12):
            fine = np.linspace(inner, outer, 33)
            first = max(int(np.argmax(misfit(best + direction * fine) > limit)), 1)
            inner, outer = fine[first - 1], fine[first]
        edges.append(direction * inner)
    estimate = _value(best, scale)
    # On the line of angles K_obj >= 0 is [0, pi/2], repeated every pi.
    start = best - pi * np.floor((best + pi / 2) / pi)
    low, high = start + edges[0], start + edges[1]
    for shift in (0.0, pi, -pi):
        a, b = max(low, shift), min(high, shift + pi / 2)
        if a <= b:
            return Interval(
                estimate,
                _value(a - shift, scale) if a > shift else 0.0,
                inf if b >= shift + pi / 2 else _value(b - shift, scale),
            )
    return Interval(estimate, inf, 0.0, empty=True)


def _value(angle: float, scale: float) -> float:
    """K_obj of an angle; inf at a right angle."""
    reduced = angle - pi * np.floor((angle + pi / 2) / pi)
    return (
        inf if abs(reduced - pi / 2) < 1e-15 or abs(reduced + pi / 2) < 1e-15 else float(scale * tan(reduced))
    )
