"""Object stiffness from grasp readings: per pair by Fieller, combined over all elements with their
covariance.

One approach p(load) moves every pad, so signal = offset + g p: pad height and tilt go into the offset, and
errors of the load, friction and relaxation into p, which all elements share. With s = g/K_v (deflection)
and f = K s (force) per unit approach, equation (1) is f + x s = the same for all elements, x = K_obj. A
pair gives equation (3), x = (f_r - f_m)/(s_m - s_r), with Fieller's interval. All elements together give
the x that makes f + x s most equal; pairs that share a reference element are correlated, and this is their
generalised least squares.

Two things act on all elements at once and are known within limits only: the load cell of the calibration, and how far
the pads feel each other through the object, from separate springs to an elastic half-space. Every interval
holds for all of that: it is the hull of the intervals at the limits.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, isinf, pi, tan

import numpy as np
from scipy.special import fdtrc

from tactcad.design.messages import InputError
from tactcad.lab.readings import GraspReadings
from tactcad.lab.regression import require_level, t_quantile

STRAY = 1e-4  # probability, over all elements, below which one is said not to follow the others
DISAGREE = 0.01  # probability below which the elements are said to disagree
ANGLES = 721  # scan of the projective line of K_obj
PRIOR_DOF = (
    6.0  # weight of what the elements have in common against an element's own degrees of freedom, chosen
)
KNOWN = 1e6  # degrees of freedom of what counts as known
NO_VARIANCE = np.finfo(float).tiny ** 0.5  # of a slope without noise, V2/mm2 and V2/N2
COUPLED = (
    0.25,
    0.5,
    1.0,
)  # shares of the given coupling that are tried: K_obj need not be extreme at the largest


@dataclass(frozen=True)
class Sensitivity:
    """A calibration by element: K (N/mm), K_v (V/mm), standard errors, their correlation, degrees of freedom; the load
    cell that stood in series, N/mm, and the half-width of its limits.
    """

    element: np.ndarray
    stiffness: np.ndarray
    stiffness_se: np.ndarray
    signal_per_deflection: np.ndarray
    signal_per_deflection_se: np.ndarray
    correlation: np.ndarray
    dof: np.ndarray
    load_cell: np.ndarray
    load_cell_half_width: np.ndarray
    path: str = "calibration"

    def at_load_cell_limit(self, sign: float) -> Sensitivity:
        """What the same readings give with the load cell at its lower (sign -1) or upper (1) limit.

        Raises InputError where the softest cell would have given way as much as cell and element together.
        """
        cell = self.load_cell + sign * self.load_cell_half_width
        old = 1 / (1 + self.stiffness / self.load_cell)  # 1 - k/K_c, as k = K K_c/(K + K_c)
        k, v = self.stiffness * old, self.signal_per_deflection * old
        new = 1 - k / cell
        if not (new > 0).all():
            raise InputError(
                "calibration",
                "the softest load cell within its limits is no stiffer than cell and element together",
                value=float(cell[new <= 0][0]),
                legal=f"above {float(k[new <= 0].max()):.4g} N/mm",
            )
        return replace(
            self,
            stiffness=k / new,
            stiffness_se=self.stiffness_se * (old / new) ** 2,
            signal_per_deflection=v / new,
            signal_per_deflection_se=self.signal_per_deflection_se * old / new,
        )


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
    object_by_noise: Interval  # noise and calibration alone
    condition: float  # of K_obj in R, at the estimate


@dataclass(frozen=True)
class Grasp:
    """What one sample's readings say."""

    sample: int
    pairs: tuple[Pair, ...]
    combined: Interval
    combined_by_noise: Interval  # noise and calibration alone
    combined_by_limits: tuple[tuple[str, Interval], ...]  # what is known within limits, one after the other
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

    def coupled(self, share: np.ndarray) -> Slopes:
        """What equation (1) sees where each pad also sinks by share[i, j] of what the force on pad j does there:
        p = s_i + sum_j share_ij f_j/x, with 1 on the diagonal.
        """
        return replace(self, f=self.f + (share - np.diag(np.diag(share))) @ self.f)


def evaluate(
    readings: GraspReadings,
    calibration: Sensitivity,
    *,
    reference: int | None = None,
    level: float = 0.95,
    coupling: np.ndarray | None = None,
) -> Grasp:
    """K_obj of one sample.

    Parameters
    ----------
    reference : int, optional
        Number of the reference element; by default the stiffest of those read.
    coupling : array, [element, element], optional
        Largest displacement of a pad by the force on another, over that by the same force on itself, in the order of
        `readings.element`; the object's is taken to lie between nothing and this. Without it the pads are taken
        to be on separate springs.

    Raises
    ------
    InputError
        An element without calibration, fewer than two elements or three loads in contact.
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
    signal = readings.signal[:, touching]
    slopes, noise = common_slopes(readings.element, signal, calibration)
    for still in slopes.element[slopes.s == 0][:1]:
        raise InputError(
            f"{readings.path}: sample {readings.sample}",
            f"element {still}: its signal does not change with the load",
        )
    number = int(readings.element[np.argmax(slopes.f / slopes.s)]) if reference is None else reference
    if number not in readings.element:
        raise InputError(
            f"{readings.path}: reference",
            "was not read in this grasp",
            value=number,
            legal=str(readings.element.tolist()),
        )
    r = int(np.flatnonzero(readings.element == number)[0])
    others = [i for i in np.argsort(-slopes.f / slopes.s, kind="stable") if i != r]
    limits = _limits(readings.element, signal, calibration, slopes, coupling)
    everywhere = [at for group in limits.values() for at in group]
    pairs = tuple(_pair(slopes, everywhere, int(m), r, level) for m in others)
    combined, p, widened = combine(slopes, level)
    by_limits = tuple(
        (name, hull(combined, [combine(at, level)[0] for at in group])) for name, group in limits.items()
    )
    notes = []
    dropped = int((~touching).sum())
    if dropped:
        notes.append(
            f"{dropped} of {len(touching)} loads are zero and left out: before contact the pads' heights enter"
        )
    notes += _strays(readings.element, signal)
    if widened > 1:
        notes.append(
            f"the elements disagree beyond their noise (p {p:.1g}): combined interval widened "
            f"{widened:.2g} times"
        )
    return Grasp(
        readings.sample,
        pairs,
        hull(combined, [i for _, i in by_limits]),
        combined,
        by_limits,
        noise,
        slopes.signal_dof,
        p,
        widened,
        int(touching.sum()),
        dropped,
        tuple(notes),
    )


def _limits(
    element: np.ndarray,
    signal: np.ndarray,
    calibration: Sensitivity,
    slopes: Slopes,
    coupling: np.ndarray | None,
) -> dict[str, list[Slopes]]:
    """The slopes at the limits of what acts on all elements, by name; the later names on top of the earlier ones."""
    at: dict[str, list[Slopes]] = {}
    cells = [slopes]
    if (calibration.load_cell_half_width > 0).any():
        cells += [
            common_slopes(element, signal, calibration.at_load_cell_limit(sign))[0] for sign in (-1.0, 1.0)
        ]
        at["with the load cell's limits"] = cells[1:]
    if coupling is not None:
        at["with coupling of the pads too"] = [
            there.coupled(share * shape)
            for shape in (coupling, _even(coupling))
            for share in COUPLED
            for there in cells
        ]
    return at


def _even(coupling: np.ndarray) -> np.ndarray:
    """The same coupling between any two pads, as strong as the given one is on average."""
    n = len(coupling)
    return np.full((n, n), (coupling.sum() - np.trace(coupling)) / (n * (n - 1)))


def hull(best: Interval, others: Sequence[Interval]) -> Interval:
    """The smallest interval about all of them that are not empty, with the estimate of the first."""
    held = [i for i in (best, *others) if not i.empty]
    if not held:
        return best
    return Interval(best.estimate, min(i.low for i in held), max(i.high for i in held))


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
    inflation, dof = _scatter(slopes, m, c, scale * tan(best))
    # the variances are estimates themselves: F, not chi-squared
    p = float(fdtrc(extra, dof, least / extra / inflation)) if extra > 0 else 1.0
    widened = (least / extra) ** 0.5 if p < DISAGREE else 1.0
    dof = extra if widened > 1 else dof
    limit = least + (t_quantile(level, dof) * widened) ** 2 * inflation
    return _interval(misfit, best, limit, scale), p, widened


def _moderated(slopes: Slopes, m: list[int]) -> np.ndarray:
    """Covariances of (f, s) by the calibration that weigh the elements: each one's own, with few degrees of freedom,
    drawn towards what all of them have relative to their size (as Smyth 2004 does with variances).
    """
    size = np.stack([slopes.f[m], slopes.s[m]], -1)
    size = size[:, :, None] * size[:, None, :]
    dof = slopes.calibration_dof[m][:, None, None]
    own = slopes.from_calibration[m]
    common = (dof * own / size).sum(0) / dof.sum()
    return (dof * own + PRIOR_DOF * common * size) / (dof + PRIOR_DOF)


def _scatter(slopes: Slopes, m: list[int], c: np.ndarray, x: float) -> tuple[float, float]:
    """Variance of the x that makes f + x s most equal under weights from c, by the elements' own covariances, over the
    one that c would give; and its degrees of freedom (Welch and Satterthwaite).
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


def _pair(slopes: Slopes, limits: list[Slopes], m: int, r: int, level: float) -> Pair:
    object_, _, _ = combine(slopes, level, [m, r])
    everywhere = hull(object_, [combine(at, level, [m, r])[0] for at in limits])
    ratio = slopes.s[m] / slopes.s[r]
    k_m, k_r = slopes.f[m] / slopes.s[m], slopes.f[r] / slopes.s[r]
    var = [slopes.covariance[i][1, 1] / slopes.s[i] ** 2 for i in (m, r)]
    _, dof = _scatter(slopes, [m, r], slopes.covariance[[m, r]], 0.0)
    half = t_quantile(level, dof) * sum(var) ** 0.5 * abs(ratio)
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
        everywhere,
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
