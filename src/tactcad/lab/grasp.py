"""Object stiffness from grasp readings: per pair by Fieller, combined over all elements with their
covariance.

One approach p(load) moves every pad, so signal = offset + g p: pad height and tilt go into the offset, and
errors of the load, friction and relaxation into p, which all elements share. With s = g/K_v (deflection)
and f = K s (force) per unit approach, equation (1) is f + x s = the same for all elements, x = K_obj. A
pair gives equation (3), x = (f_r - f_m)/(s_m - s_r), with Fieller's interval. All elements together give
the x that makes f + x s most equal; pairs that share a reference element are correlated, and this is their
generalised least squares.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isinf, pi, tan

import numpy as np
from scipy.special import chdtrc, fdtrc

from tactcad.design.messages import InputError
from tactcad.lab.readings import GraspReadings
from tactcad.lab.regression import require_level, t_quantile

STRAY = 1e-4  # probability, over all elements, below which one is said not to follow the others
DISAGREE = 0.01  # probability below which the elements are said to disagree
ANGLES = 721  # scan of the projective line of K_obj


@dataclass(frozen=True)
class Sensitivity:
    """A calibration by element: K (N/mm), K_v (V/mm), standard errors, their correlation, degrees of
    freedom.
    """

    element: np.ndarray
    stiffness: np.ndarray
    stiffness_se: np.ndarray
    signal_per_deflection: np.ndarray
    signal_per_deflection_se: np.ndarray
    correlation: np.ndarray
    dof: np.ndarray
    path: str = "calibration"


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
class Pair:
    """One measuring element against the reference: R with its interval, K_obj with Fieller's."""

    measuring: int
    reference: int
    ratio: float  # R
    ratio_low: float
    ratio_high: float
    object: Interval
    condition: float  # of K_obj in R, at the estimate


@dataclass(frozen=True)
class Grasp:
    """What one sample's readings say."""

    sample: int
    pairs: tuple[Pair, ...]
    combined: Interval
    noise: float  # of one signal about the common approach, V
    dof: int
    disagreement_p: float  # of so much disagreement between the elements by noise alone
    widened: float  # factor on the combined standard error for it
    loads: int
    dropped_loads: int
    notes: tuple[str, ...]


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


def evaluate(
    readings: GraspReadings, calibration: Sensitivity, *, reference: int | None = None, level: float = 0.95
) -> Grasp:
    """K_obj of one sample. The reference is the stiffest element of those read, unless given.

    Raises InputError: an element without calibration, fewer than two elements or three loads in contact.
    """
    require_level(level)
    touching = readings.load > 0
    if touching.sum() < 3 or len(readings.element) < 2:
        raise InputError(
            f"{readings.path}: sample {readings.sample}",
            "too little to tell a slope from noise",
            value=f"{len(readings.element)} elements at {int(touching.sum())} loads above zero",
            legal="two elements and three loads at least",
        )
    for stranger in np.setdiff1d(readings.element, calibration.element)[:1]:
        raise InputError(
            f"{readings.path}: sample {readings.sample}",
            f"element {stranger} of the grasp is not in {calibration.path}",
            legal=str(calibration.element.tolist()),
        )
    slopes, noise = common_slopes(readings.element, readings.signal[:, touching], calibration)
    for still in slopes.element[slopes.s == 0][:1]:
        raise InputError(
            f"{readings.path}: sample {readings.sample}",
            f"element {still}: its signal does not change with the load",
        )
    stiffness = slopes.f / slopes.s
    number = int(readings.element[np.argmax(stiffness)]) if reference is None else reference
    if number not in readings.element:
        raise InputError(
            f"{readings.path}: reference",
            "was not read in this grasp",
            value=number,
            legal=str(readings.element.tolist()),
        )
    r = int(np.flatnonzero(readings.element == number)[0])
    others = [i for i in np.argsort(-stiffness, kind="stable") if i != r]
    pairs = tuple(_pair(slopes, int(m), r, level) for m in others)
    combined, p, widened = combine(slopes, level)
    notes = []
    dropped = int((~touching).sum())
    if dropped:
        notes.append(
            f"{dropped} of {len(touching)} loads are zero and left out: before contact the pads' heights "
            "enter"
        )
    notes += _strays(readings.element, readings.signal[:, touching])
    if widened > 1:
        notes.append(
            f"the elements disagree beyond their noise (p {p:.1g}): combined interval widened "
            f"{widened:.2g} times"
        )
    return Grasp(
        readings.sample,
        pairs,
        combined,
        noise,
        slopes.signal_dof,
        p,
        widened,
        int(touching.sum()),
        dropped,
        tuple(notes),
    )


def common_slopes(element: np.ndarray, signal: np.ndarray, calibration: Sensitivity) -> tuple[Slopes, float]:
    """Slopes of all elements against their common approach, and the noise of one signal (V).

    signal[element, state] less each element's mean is g p + noise, equal noise in every channel: its best
    rank-one approximation. Errors of p are errors of all g alike, which K_obj does not see.
    """
    rows = [_row(calibration, int(n)) for n in element]
    centred = signal - signal.mean(1, keepdims=True)
    u, size, vt = np.linalg.svd(centred, full_matrices=False)
    dof = (len(element) - 1) * (signal.shape[1] - 2)
    variance = float((size[1:] ** 2).sum()) / dof
    k_v, k = calibration.signal_per_deflection[rows], calibration.stiffness[rows]
    p = vt[0] * np.sign((u[:, 0] / k_v).sum() or 1.0)
    g = centred @ p  # V per unit approach; p has unit length, so each g has the variance of one signal
    s, f = g / k_v, g * k / k_v
    signal_part = np.array([[[b * b, b * a], [a * b, a * a]] for a, b in zip(1 / k_v, k / k_v)]) * variance
    se_k, se_v = calibration.stiffness_se[rows], calibration.signal_per_deflection_se[rows]
    cross = calibration.correlation[rows] * se_k * se_v
    part = np.empty_like(signal_part)
    for i in range(len(rows)):
        jacobian = np.array([[g[i] / k_v[i], -f[i] / k_v[i]], [0.0, -s[i] / k_v[i]]])  # of (f, s) in (K, K_v)
        part[i] = jacobian @ np.array([[se_k[i] ** 2, cross[i]], [cross[i], se_v[i] ** 2]]) @ jacobian.T
    return Slopes(element, s, f, signal_part, part, dof, calibration.dof[rows]), variance**0.5


def _strays(element: np.ndarray, signal: np.ndarray) -> list[str]:
    """Elements whose signals do not follow the approach that the others share (F test against the others'
    noise).
    """
    n, each = len(element), signal.shape[1] - 2
    if n < 3:
        return []
    centred = signal - signal.mean(1, keepdims=True)
    notes = []
    for i, number in enumerate(element):
        rest = np.delete(centred, i, 0)
        _, size, vt = np.linalg.svd(rest, full_matrices=False)
        noise = (size[1:] ** 2).sum() / (each * (n - 2))
        g = centred[i] @ vt[0]
        # the others' approach is known to noise/size[0] at each load, and g carries that over
        own = ((centred[i] - g * vt[0]) ** 2).sum() / each / (1 + (g / size[0]) ** 2)
        if noise > 0 and fdtrc(each, each * (n - 2), own / noise) < STRAY / n:
            notes.append(
                f"element {number} does not follow the approach of the others: late contact, a limit of "
                "the read-out, or a bad gauge"
            )
    return notes


def combine(slopes: Slopes, level: float, members: list[int] | None = None) -> tuple[Interval, float, float]:
    """K_obj that makes f + x s most equal over the members (default all), its interval, p of their
    disagreement, and the factor by which that widens the standard error.

    Two members: the interval is Fieller's. The line of x is closed at infinity (x = scale tan(angle)), so
    that an interval that runs through infinity is found like any other.
    """
    m = list(range(len(slopes.s))) if members is None else members
    f, s, c = slopes.f[m], slopes.s[m], slopes.covariance[m]
    scale = float(np.median(np.abs(f / s)))
    # without noise in K and K_v, f + x s of an element has no variance at x = -K: hold it above zero there
    smallest = np.maximum(1e-14 * c[:, 0, 0], np.finfo(float).tiny)
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
    p = float(chdtrc(extra, least)) if extra > 0 else 1.0
    widened = (least / extra) ** 0.5 if p < DISAGREE else 1.0
    dof = extra if widened > 1 else _satterthwaite(slopes, m, scale * tan(best))
    limit = least + (t_quantile(level, dof) * widened) ** 2
    return _interval(misfit, best, limit, scale), p, widened


def _pair(slopes: Slopes, m: int, r: int, level: float) -> Pair:
    object_, _, _ = combine(slopes, level, [m, r])
    ratio = slopes.s[m] / slopes.s[r]
    k_m, k_r = slopes.f[m] / slopes.s[m], slopes.f[r] / slopes.s[r]
    var = [slopes.covariance[i][1, 1] / slopes.s[i] ** 2 for i in (m, r)]
    half = t_quantile(level, _satterthwaite(slopes, [m, r], 0.0)) * sum(var) ** 0.5 * abs(ratio)
    x = object_.estimate
    condition = (
        inf
        if x == 0 or k_r == k_m
        else abs((k_r + x) * (k_m + x) / (x * (k_r - k_m)))
        if not isinf(x)
        else inf
    )
    return Pair(
        int(slopes.element[m]),
        int(slopes.element[r]),
        float(ratio),
        float(ratio - half),
        float(ratio + half),
        object_,
        float(condition),
    )


def _row(calibration: Sensitivity, number: int) -> int:
    found = np.flatnonzero(calibration.element == number)
    if not len(found):
        raise InputError(
            calibration.path,
            f"element {number} of the grasp is not there",
            legal=str(calibration.element.tolist()),
        )
    return int(found[0])


def _satterthwaite(slopes: Slopes, m: list[int], x: float) -> float:
    """Effective degrees of freedom of f + x s, signal and calibration together (Welch-Satterthwaite)."""
    along = np.array([1.0, x]) if abs(x) < 1e12 else np.array([0.0, 1.0])
    signal = np.array([along @ slopes.from_signal[i] @ along for i in m])
    parts = np.array([along @ slopes.from_calibration[i] @ along for i in m])
    weight = 1 / np.maximum(signal + parts, np.finfo(float).tiny)
    weight = weight * (
        1 - weight / weight.sum()
    )  # what each element's noise does to the contrast between them
    bottom = (weight * signal).sum() ** 2 / slopes.signal_dof + (
        (weight * parts) ** 2 / slopes.calibration_dof[m]
    ).sum()
    if bottom == 0:  # readings and calibration without any scatter
        return float(slopes.signal_dof)
    return float((weight * (signal + parts)).sum() ** 2 / bottom)


def _minimum(misfit, angle: np.ndarray) -> float:
    """Least point of a function on the closed line of angles, by ever finer scans."""
    step = angle[1] - angle[0]
    best = float(angle[np.argmin(misfit(angle))])
    for _ in range(12):
        fine = best + np.linspace(-step, step, 41)
        best = float(fine[np.argmin(misfit(fine))])
        step /= 15
    return best


def _interval(misfit, best: float, limit: float, scale: float) -> Interval:
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
