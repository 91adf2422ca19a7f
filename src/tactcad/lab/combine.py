"""The object stiffness for which equation (1) agrees best over some elements, with its interval.

Equation (1): f + x s is the same for all elements, x = K_obj. Two elements give Fieller's interval; more give
the generalised least squares of the pairs that share a reference.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import inf, isinf, pi, tan

import numpy as np
from scipy.special import fdtrc

from tactcad.lab.regression import KNOWN, t_quantile

Misfit = Callable[[np.ndarray], np.ndarray]  # of angles, (case, angle)

DISAGREE = 0.01  # probability below which the elements are reported to disagree
ANGLES = 721  # of the first scan over all K_obj from -inf to inf
# Degrees of freedom given to the elements' common covariance, against those of an element's own. Chosen: ten
# times the two that three runs leave; weights from variances that uncertain make the interval too narrow.
PRIOR_DOF = 20.0
NO_VARIANCE = np.finfo(float).tiny ** 0.5  # of a slope without noise, V2/mm2 and V2/N2


@dataclass(frozen=True)
class Interval:
    """K_obj (N/mm) within [low, high]; high is inf and low 0 if the data do not bound it.

    A negative or infinite `estimate` means that no object of finite positive stiffness fits the readings
    best; `empty`, that no K_obj >= 0 lies within the interval.
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
    """Deflection s (mm) and force f (N) of each element per unit approach, with the covariance of (f, s),
    [element, 2, 2], in its two parts and the degrees of freedom of each."""

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
        """The slopes that satisfy equation (1) if the pads are coupled through the object.

        Pad i sinks by share[i, j] of what the same force on i itself would do: the approach is
        s_i + sum_j share_ij f_j/x, with 1 on the diagonal, so the sum takes the place of f_i.
        """
        return replace(self, f=self.f + (share - np.diag(np.diag(share))) @ self.f)


def combine(slopes: Slopes, level: float) -> tuple[Interval, float, float]:
    """The K_obj (N/mm) that makes f + x s most equal over all elements.

    With two elements the interval is Fieller's. The search runs over an angle, x = scale tan(angle), so that
    an interval that runs through infinity is treated like any other.

    Parameters
    ----------
    slopes : Slopes
    level : float
        Confidence level of the interval.

    Returns
    -------
    interval : Interval
    disagreement_p : float
        Probability that noise alone makes the elements disagree this much; 1 with two elements.
    widened : float
        Factor on the standard error for the elements' disagreement; 1 if they agree.
    """
    return combine_each([(slopes, None)], level)[0]


def combine_each(
    cases: Sequence[tuple[Slopes, list[int] | None]], level: float
) -> list[tuple[Interval, float, float]]:
    """`combine` of several slopes, each with its members, as many of each: searched together they take half
    of the time."""
    of = [(at, list(range(len(at.s))) if m is None else m) for at, m in cases]
    extra = len(of[0][1]) - 2
    # without noise in K and K_v, f + x s of an element has no variance at x = -K: keep it above zero there
    f, s = np.array([at.f[m] for at, m in of]), np.array([at.s[m] for at, m in of])
    c = np.array([at.from_signal[m] + _moderated(at, m) if extra > 0 else at.covariance[m] for at, m in of])
    scale = np.median(np.abs(f / s), axis=1)
    smallest = np.maximum(1e-14 * c[..., 0, 0], NO_VARIANCE)
    c_ff, c_fs, c_ss = (np.ascontiguousarray(c[:, None, :, i, j]) for i, j in ((0, 0), (0, 1), (1, 1)))

    def misfit(a: np.ndarray) -> np.ndarray:
        """Of each case, (case, angle), at its own angles."""
        cos, sin = np.cos(a)[..., None], scale[:, None, None] * np.sin(a)[..., None]
        z = cos * f[:, None] + sin * s[:, None]
        w = 1 / np.maximum(cos**2 * c_ff + 2 * cos * sin * c_fs + sin**2 * c_ss, smallest[:, None])
        mean = (w * z).sum(-1) / w.sum(-1)
        return (w * (z - mean[..., None]) ** 2).sum(-1)

    best = _minimum(misfit, len(cases))
    least = misfit(best[:, None])[:, 0].tolist()
    limits, said = [], []
    for (at, m), angle, own, size, low in zip(of, best, c, scale, least):
        x = float(size) * tan(angle)
        inflation, dof = scatter(at, m, own, x)
        expected, of_misfit = expected_misfit(at, m, own, x)
        # the variances are estimated too, hence F and not chi-squared
        p = float(fdtrc(extra, of_misfit, low / expected)) if extra > 0 else 1.0
        widened = max(low / expected, 1.0) ** 0.5 if p < DISAGREE else 1.0
        dof = extra if widened > 1 else dof
        limits.append(low + (t_quantile(level, dof) * widened) ** 2 * inflation)
        said.append((p, widened))
    edges = _edges(misfit, best, np.array(limits))
    found = [_interval(float(a), e, float(size)) for a, e, size in zip(best, edges, scale)]
    return [(interval, *more) for interval, more in zip(found, said)]


def hull(best: Interval, others: Sequence[Interval]) -> Interval:
    """The smallest interval that covers all that are not empty, with the estimate of `best`."""
    covered = [i for i in (best, *others) if not i.empty]
    if not covered:
        return best
    return Interval(best.estimate, min(i.low for i in covered), max(i.high for i in covered))


def _moderated(slopes: Slopes, m: list[int]) -> np.ndarray:
    """Covariances of (f, s) by the calibration, [element, 2, 2], from which the elements' weights are made.

    An element's own covariance has few degrees of freedom; it is averaged with the one that all elements
    have in common relative to their size (as Smyth 2004 does with variances).
    """
    size = np.stack([slopes.f[m], slopes.s[m]], -1)
    size = size[:, :, None] * size[:, None, :]
    dof = slopes.calibration_dof[m][:, None, None]
    own = slopes.from_calibration[m]
    common = (dof * own / size).sum(0) / dof.sum()
    return (dof * own + PRIOR_DOF * common * size) / (dof + PRIOR_DOF)


def scatter(slopes: Slopes, m: list[int], c: np.ndarray, x: float) -> tuple[float, float]:
    """Factor by which weights from c understate the variance of x, and that variance's degrees of freedom.

    Parameters
    ----------
    slopes : Slopes
    m : list of int
        Indices of the elements.
    c : array, [element, 2, 2]
        Covariances of (f, s) from which the weights are made.
    x : float
        K_obj, N/mm, at which f + x s is most equal.

    Returns
    -------
    inflation : float
        Variance of x by the elements' own covariances, over the one by `c`.
    dof : float
        Welch and Satterthwaite's.
    """
    along, share, s, heaviest = _weighed(slopes, m, c, x)
    pull = share * (s - (share * s).sum() / share.sum())  # relative, of each element's f + x s on x
    signal, calibration = _own(slopes, m, along, pull**2)
    total = float((signal + calibration).sum())
    model = float((pull**2 / share).sum()) / heaviest
    dof = _dof(slopes, m, signal, calibration)
    return (total / model, dof) if total > 0 and model > 0 and dof > 0 else (1.0, KNOWN)


def expected_misfit(slopes: Slopes, m: list[int], c: np.ndarray, x: float) -> tuple[float, float]:
    """The misfit to be expected of elements that agree, by their own covariances, and its degrees of freedom.

    With weights from those very covariances it is the number of elements less two. Parameters as of
    `scatter`.
    """
    along, share, s, heaviest = _weighed(slopes, m, c, x)
    s = s - (share * s).sum() / share.sum()
    spread = (share * s**2).sum()
    left = share * (1.0 - share / share.sum() - (share * s**2 / spread if spread > 0 else 0.0))
    signal, calibration = _own(slopes, m, along, left)
    total = float((signal + calibration).sum()) * heaviest
    dof = _dof(slopes, m, signal, calibration)
    return (total, dof) if total > 0 and dof > 0 else (float(max(len(m) - 2, 1)), KNOWN)


def _weighed(
    slopes: Slopes, m: list[int], c: np.ndarray, x: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """The direction of f + x s, the elements' weights in it from c over the largest, s (at an infinite x: f),
    and the largest weight."""
    along = np.array([1.0, x]) if abs(x) < 1e12 else np.array([0.0, 1.0])
    w = 1 / np.maximum(np.einsum("i,nij,j->n", along, c, along), NO_VARIANCE)
    return along, w / w.max(), slopes.s[m] if abs(x) < 1e12 else slopes.f[m], float(w.max())


def _own(
    slopes: Slopes, m: list[int], along: np.ndarray, factor: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Variances of f + x s by signal and by calibration, each times its element's factor."""
    parts = slopes.from_signal[m], slopes.from_calibration[m]
    signal, calibration = (factor * np.einsum("i,nij,j->n", along, part, along) for part in parts)
    return signal, calibration


def _dof(slopes: Slopes, m: list[int], signal: np.ndarray, calibration: np.ndarray) -> float:
    """Welch and Satterthwaite's degrees of freedom of the sum of all; 0 if it has no variance."""
    bottom = signal.sum() ** 2 / slopes.signal_dof + (calibration**2 / slopes.calibration_dof[m]).sum()
    return float(min((signal + calibration).sum() ** 2 / bottom, KNOWN)) if bottom > 0 else 0.0


def _minimum(misfit: Misfit, cases: int) -> np.ndarray:
    """The angle at which each case's function, of period pi, is least, by ever finer scans."""
    angle, row = np.linspace(-pi / 2, pi / 2, ANGLES), np.arange(cases)
    step = angle[1] - angle[0]
    best = angle[np.argmin(misfit(np.tile(angle, (cases, 1))), axis=1)]
    for _ in range(12):
        fine = best[:, None] + np.linspace(-step, step, 41)
        best = fine[row, np.argmin(misfit(fine), axis=1)]
        step /= 15
    return best


def _edges(misfit: Misfit, best: np.ndarray, limit: np.ndarray) -> np.ndarray:
    """How far the connected set around each `best` with a misfit below its limit reaches to both sides,
    (case, 2); NaN where the limit is never passed."""
    ways = np.array([-1.0, 1.0])

    def beyond(offset: np.ndarray) -> np.ndarray:
        """Of offsets to both sides, (case, 2, offset)."""
        angle = best[:, None, None] + ways[:, None] * offset
        return misfit(angle.reshape(len(best), -1)).reshape(angle.shape) > limit[:, None, None]

    def at(offset: np.ndarray, index: np.ndarray) -> np.ndarray:
        return offset.reshape(index.size, -1)[np.arange(index.size), index.ravel()].reshape(index.shape)

    fine = np.broadcast_to(np.linspace(0.0, pi, 2 * ANGLES), (len(best), 2, 2 * ANGLES))
    outside = beyond(fine)
    first = np.argmax(outside, axis=2)
    inner, outer = at(fine, np.maximum(first - 1, 0)), at(fine, first)
    for _ in range(12):
        fine = np.arange(33.0) * ((outer - inner) / 32)[..., None] + inner[..., None]
        fine[..., -1] = outer
        first = np.maximum(np.argmax(beyond(fine), axis=2), 1)
        inner, outer = at(fine, first - 1), at(fine, first)
    return np.where(outside.any(axis=2), ways * inner, np.nan)


def _interval(best: float, edges: np.ndarray, scale: float) -> Interval:
    """The angles between the edges around `best`, cut to K_obj >= 0."""
    estimate = _value(best, scale)
    if np.isnan(edges).any():
        return Interval(estimate, 0.0, inf)
    # K_obj >= 0 is the angles from 0 to pi/2, repeated every pi
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
    """K_obj (N/mm) at an angle; inf at a right angle."""
    reduced = angle - pi * np.floor((angle + pi / 2) / pi)
    return (
        inf if abs(reduced - pi / 2) < 1e-15 or abs(reduced + pi / 2) < 1e-15 else float(scale * tan(reduced))
    )
