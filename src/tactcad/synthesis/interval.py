"""The interval of K_obj that an array gives, predicted: what `tactcad stiffness` would say of its readings.

All pads move by one approach; s and f = K s are an element's deflection and force along it, so that by
equation (1) f + x s = c is the same for all, x = K_obj. Readings at evenly rising loads with noise sigma of
each, and K and K_v known with errors, leave f_i + x s_i with the variance

  v_i = sigma^2 (K_i + x)^2/K_v,i^2 + f_i^2 var K + c^2 var K_v - 2 f_i c cov(K, K_v)

(relative variances of K and K_v). The generalised least squares of lab/combine.py uses weights w_i inverse to
v_i, with estimated variances averaged over the elements; then x has the variance

  sum_i w_i^2 (s_i - s_mean)^2 v_i/S^2,  S = sum_i w_i (s_i - s_mean)^2,  mean by weights w_i,

1/S where w_i = 1/v_i.
An error that all elements share enters linearly; the load cell's compliance is in series with the object, so
its limits shift 1/x. The interval's ends are where |x' - x| sqrt(S(x')/S(x)) is t standard errors, as in
combine's misfit.

Readings of many arrays at once are evaluated by the rules of lab/combine.py: weights from covariances that
are averaged with the elements' common one, the interval by the elements' own, degrees of freedom by Welch and
Satterthwaite, and the widening for disagreement. All arrays are evaluated at once, near the known K_obj, so
no search is needed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import fdtrc, stdtrit

from tactcad.lab.combine import DISAGREE, PRIOR_DOF
from tactcad.mechanics.section import Array

from .knowledge import Elements, Knowledge

ROUNDS = 6  # of the fixed point for each end; each shrinks its error by about the relative half-width


@dataclass(frozen=True)
class InGrasp:
    """Elements in a grasp, arrays (..., elements): per unit of the loads' spread.

    s, f      deflection and force of each
    c         approach times K_obj, (..., 1)
    largest   force of each under the largest load, N
    """

    s: Array
    f: Array
    c: Array
    largest: Array


@dataclass(frozen=True)
class Bounds:
    """An interval of K_obj, N/mm, arrays of the candidates' shape; and its standard error's parts.

    low, high       ends at LEVEL, limits known apart included
    error           standard error by noise and belief
    own             its part by each element's own errors and noise
    """

    low: Array
    high: Array
    error: Array

    def half_width(self, x: float | Array) -> Array:
        """Half of the interval's length over x."""
        return (self.high - self.low) / 2.0 / x


def even_loads(force: float, loads: int) -> tuple[Array, float]:
    """Even loads up to `force`, N, and the root of the sum of their squares about the mean."""
    load = force * (np.arange(loads) + 1.0) / loads
    return load, float(np.sqrt(((load - load.mean()) ** 2).sum()))


def motion(e: Elements, count: Array, x: Array, force: float, loads: int) -> InGrasp:
    """Deflections and forces of elements on separate springs x (N/mm) under `loads` even loads up to `force`
    (N); `count` is the number of each. x broadcasts against (..., elements). The only place where synthesis
    uses the object's model for forces."""
    share = x / (e.stiffness + x)
    total = (count * e.stiffness * share).sum(axis=-1, keepdims=True)  # N per mm of approach
    approach = even_loads(force, loads)[1] / total
    s = share * approach
    return InGrasp(s, e.stiffness * s, x * approach, e.stiffness * share * force / total)


def weights(
    m: InGrasp, e: Elements, known: Knowledge, count: Array, x: Array, noise: float
) -> tuple[Array, Array, Array]:
    """v_i at a K_obj, in its parts by the readings' noise (V) and by the uncertainty of K and K_v; and the
    value that the lab's weights use for v_i."""
    by_noise = (noise * (e.stiffness + x) / e.signal) ** 2
    belief = Covariance.of(known.of_k, known.of_v, known.cross)
    weighed = belief.moderated(known.dof, count).along(m.f, m.s, x)
    return by_noise, belief.along(m.f, m.s, x), by_noise + weighed


def information(m: InGrasp, count: Array, v: Array) -> tuple[Array, Array]:
    """S, and the weight (s_i - s_mean)/v_i with which each element's f + x s moves x, times S."""
    w = count / v
    mean = (w * m.s).sum(axis=-1, keepdims=True) / w.sum(axis=-1, keepdims=True)
    pull = (m.s - mean) / v
    return (count * (m.s - mean) * pull).sum(axis=-1), pull


def bounds(
    e: Elements,
    count: Array,
    known: Knowledge,
    x: Array,
    noise: float,
    force: float,
    loads: int,
    used: Array | None = None,
) -> Bounds:
    """The interval of K_obj at `x`.

    Parameters
    ----------
    e
        Elements, of shape (..., elements).
    count
        Number of each; broadcasts with them.
    known
        Stated errors of K and K_v.
    x
        True K_obj, N/mm; broadcasts with (..., elements), so that (points, 1, 1) gives (points, ...).
    noise
        Of one averaged reading, V.
    force, loads
        Largest force on the array, N, and the number of even loads read up to it.
    used
        As `count`, if only some of the elements under load are evaluated.
    """
    m = motion(e, count, x, force, loads)
    count = count if used is None else used
    by_noise, by_belief, weighed = weights(m, e, known, count, x, noise)
    S, pull = information(m, count, weighed)
    # Shift of x by errors k of ln K and v of ln K_v that all elements have at once
    shared = sum(
        (-(count * pull * (m.f * k - m.c * v)).sum(axis=-1) / S) ** 2 for k, v in known.common.values()
    )
    total = (count * pull**2 * (by_noise + by_belief)).sum(axis=-1)
    error = np.sqrt(total / S**2 + shared)
    signal = (count * pull**2 * by_noise).sum(axis=-1)
    belief = (count * (pull**2 * by_belief) ** 2).sum(axis=-1)
    several = np.broadcast_to(count, pull.shape).sum(axis=-1)
    dof = total**2 / (signal**2 / np.maximum((several - 1.0) * (loads - 2.0), 1.0) + belief / known.dof)
    t = stdtrit(dof, 0.5 + LEVEL / 2.0)
    point = np.broadcast_to(x, pull.shape)[..., 0]
    ends = []
    for sign in (-1.0, 1.0):
        at = np.maximum(point + sign * t * error, 0.1 * point)
        for _ in range(ROUNDS):
            *_, v_at = weights(m, e, known, count, at[..., np.newaxis], noise)
            S_at, _ = information(m, count, v_at)
            at = np.maximum(point + sign * t * np.sqrt(total / S / S_at + shared), 0.01 * point)
        ends.append(1.0 / np.maximum(1.0 / at - sign * known.load_cell, 1e-12))
    return Bounds(ends[0], ends[1], error)


def coupled_estimate(
    e: Elements, known: Knowledge, x: float, noise: float, force: float, loads: int, share: Array
) -> Array:
    """K_obj as believed, N/mm, (arrays,), where pads sink under each other's force by `share` (..., elements,
    elements; 1 on the diagonal) of what the same force on themselves does, and are taken to press on separate
    springs."""
    compliance = share / x + np.eye(e.stiffness.shape[-1]) / e.stiffness[..., np.newaxis, :]
    f = np.linalg.solve(compliance, np.ones((*compliance.shape[:-1], 1)))[..., 0]
    f = f * (even_loads(force, loads)[1] / f.sum(axis=-1, keepdims=True))
    f = f.reshape(-1, f.shape[-1])
    of_s, of_f = noise / e.signal, noise * e.stiffness / e.signal
    belief = Covariance.of(known.of_k, known.of_v, known.cross)
    dof = (known.dof, (f.shape[1] - 1.0) * (loads - 2.0))
    return Evaluation(f / e.stiffness, f, (of_s, of_f), belief, dof).best(x)[:, 0]


LEVEL = 0.95
REWEIGHTED = 6  # fits, each weighted at the K_obj of the one before; each shrinks the change by the interval
PARABOLAS = 12  # through the misfit about its least
MOST = 50.0  # steps that a parabola moves K_obj by
HALVINGS = 20  # bisections between the best K_obj and FARTHEST times it: to 1e-6 of that range
FARTHEST = 30.0  # an interval that reaches so many times K_obj is no interval


@dataclass(frozen=True)
class Covariance:
    """Covariance of every element's ln f and ln s, stated or estimated; of one shape."""

    ff: Array
    fs: Array
    ss: Array

    @classmethod
    def of(cls, k: Array, v: Array, cross: Array) -> Covariance:
        """From the variances of ln K and ln K_v and their covariance: ln f has g K/K_v, ln s has g/K_v."""
        return cls(k - 2.0 * cross + v, v - cross, v)

    def along(self, f: Array, s: Array, x: Array) -> Array:
        """Variance of f + x s."""
        y = x * s
        return np.maximum(f * f * self.ff + 2.0 * f * y * self.fs + y * y * self.ss, 0.0)

    def moderated(self, dof: float, count: Array) -> Covariance:
        """Averaged with the common covariance of all elements, as in the lab's weights; unchanged for two
        elements or if it is known. `count` is the number of each."""
        if dof >= 1e6:
            return self
        total = np.broadcast_to(count, self.ss.shape).sum(axis=-1, keepdims=True)
        prior = np.where(total > 2, PRIOR_DOF, 0.0)

        def mean(c: Array) -> Array:
            return (dof * c + prior * (count * c).sum(axis=-1, keepdims=True) / total) / (dof + prior)

        return Covariance(mean(self.ff), mean(self.fs), mean(self.ss))


@dataclass(frozen=True)
class Evaluated:
    """Results of every array, N/mm."""

    estimate: Array
    low: Array
    high: Array

    def with_load_cell(self, limits: float) -> Evaluated:
        """With limits of the load cell's compliance (half-width, mm/N): it is in series with the object."""
        low = self.low / (1.0 + limits * self.low)
        return Evaluated(self.estimate, low, 1.0 / np.maximum(1.0 / self.high - limits, 1e-12))


@dataclass(frozen=True)
class Evaluation:
    """Arrays read once each; (arrays, elements) but noise, (arrays, 1), and what all share.

    s, f          deflection and force per unit approach, as believed
    by_signal     standard deviation of a signal, as estimated, over K_v and over K_v/K: of s and of f
    belief        covariance of their errors, as estimated
    dof           its degrees of freedom, and the signal's
    shared        by quantity that all elements share: shift of ln f and ln s for one standard deviation
    """

    s: Array
    f: Array
    by_signal: tuple[Array, Array]
    belief: Covariance
    dof: tuple[float, float]
    shared: tuple[tuple[Array, Array], ...] = ()

    def signal(self, x: Array) -> Array:
        of_s, of_f = self.by_signal
        return (of_f + x * of_s) ** 2

    def weighed(self, x: Array, weights: Covariance) -> tuple[Array, Array, Array, Array]:
        """At K_obj x, (arrays, 1): each element's weight and their sum; s and f about their weighed means."""
        w = 1.0 / (self.signal(x) + weights.along(self.f, self.s, x))
        all_w = w.sum(axis=1, keepdims=True)
        s, f = (of - (w * of).sum(axis=1, keepdims=True) / all_w for of in (self.s, self.f))
        return w, all_w, s, f

    def scattered(self, x: Array, factor: Array) -> tuple[Array, Array]:
        """Variance of the sum of f + x s, each times the root of its factor, and Welch and Satterthwaite's
        degrees of freedom of it."""
        own = factor * self.belief.along(self.f, self.s, x)
        signal = (factor * self.signal(x)).sum(axis=1, keepdims=True)
        total = signal + own.sum(axis=1, keepdims=True)
        return total, total**2 / (signal**2 / self.dof[1] + (own**2).sum(axis=1, keepdims=True) / self.dof[0])

    def fit(self, x: Array, weights: Covariance) -> tuple[Array, Array, Array]:
        """At K_obj x, (arrays, 1): the least-squares x, the misfit of f + x s, and each element's pull on x
        (over S), with S = sum of pull (s - mean)."""
        w, _, s, f = self.weighed(x, weights)
        pull = w * s
        best = -(pull * f).sum(axis=1, keepdims=True) / (pull * s).sum(axis=1, keepdims=True)
        return best, (w * (f + x * s) ** 2).sum(axis=1, keepdims=True), pull

    def evaluated(self, near: float) -> Evaluated:
        """Estimate and interval of each array, K_obj being near `near` (N/mm)."""
        n, weights, best = self.s.shape[1], self.weights, self.best(near)
        _, least, pull = self.fit(best, weights)
        total, dof = self.scattered(best, pull**2)
        S = (pull * self.s).sum(axis=1, keepdims=True)  # pulls add up to zero, so the mean does not matter
        inflation = total / S
        t = stdtrit(dof, 0.5 + LEVEL / 2.0)
        if n > 2:
            away, misfit_dof = self._disagreement(best, least, weights)
            widened = np.where(
                fdtrc(n - 2.0, misfit_dof, away) < DISAGREE, np.sqrt(np.maximum(away, 1.0)), 1.0
            )
            t = np.where(widened > 1.0, widened * stdtrit(n - 2.0, 0.5 + LEVEL / 2.0), t)
        for f, s in self.shared:
            shift = (pull * (self.f * f + best * self.s * s)).sum(axis=1, keepdims=True)
            inflation = inflation + shift**2 / S
        limit = least + t**2 * inflation
        return Evaluated(best[:, 0], *(self._end(sign, best, limit, weights) for sign in (-1.0, 1.0)))

    def _disagreement(self, x: Array, least: Array, weights: Covariance) -> tuple[Array, Array]:
        """The misfit over the one expected of elements that agree, and that one's degrees of freedom."""
        w, all_w, s, _ = self.weighed(x, weights)
        left = w * (1.0 - w / all_w - w * s**2 / (w * s**2).sum(axis=1, keepdims=True))
        total, dof = self.scattered(x, left)
        return least / total, dof

    @property
    def weights(self) -> Covariance:
        """From which the elements' weights are made."""
        return self.belief.moderated(self.dof[0], np.ones(1))

    def best(self, near: float) -> Array:
        """K_obj, (arrays, 1), for which f + x s is most equal."""
        weights = self.weights
        x = np.full((len(self.s), 1), near)
        for _ in range(REWEIGHTED):
            x = np.clip(self.fit(x, weights)[0], near / FARTHEST, near * FARTHEST)
        _, _, pull = self.fit(x, weights)
        step = 0.1 / np.sqrt((pull * self.s).sum(axis=1, keepdims=True))  # of x's standard error
        for _ in range(PARABOLAS):
            step = np.minimum(step, 0.1 * x)
            below, at, above = (self.fit(x + d * step, weights)[1] for d in (-1.0, 0.0, 1.0))
            bend, fall = below - 2.0 * at + above, 0.5 * (below - above)
            move = np.where(bend > 0.0, fall / np.where(bend > 0.0, bend, 1.0), MOST * np.sign(fall))
            x = np.clip(x + step * np.clip(move, -MOST, MOST), near / FARTHEST, near * FARTHEST)
        return x

    def _end(self, sign: float, best: Array, limit: Array, weights: Covariance) -> Array:
        """K_obj at which the misfit passes the limit; 0 or inf if it does not."""
        inner, outer = np.zeros_like(best), np.full_like(best, np.log(FARTHEST))
        for _ in range(HALVINGS):
            middle = 0.5 * (inner + outer)
            beyond = self.fit(best * np.exp(sign * middle), weights)[1] > limit
            inner, outer = np.where(beyond, inner, middle), np.where(beyond, middle, outer)
        far = inner[:, 0] > np.log(FARTHEST) - 1e-5
        return np.where(far, 0.0 if sign < 0.0 else np.inf, best[:, 0] * np.exp(sign * inner[:, 0]))
