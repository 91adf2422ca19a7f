"""What `tactcad stiffness` says of the readings of many arrays at once: the rules of lab/combine.py.

Weights from covariances that are averaged with the elements' common one, the interval by the elements' own,
Welch and Satterthwaite's degrees of freedom, and the widening where elements disagree: all as there, over
arrays instead of in a loop, and near a K_obj that is known, so that nothing is searched.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import fdtrc, stdtrit

from tactcad.lab.combine import DISAGREE, PRIOR_DOF
from tactcad.mechanics.section import Array

LEVEL = 0.95
REWEIGHTED = 6  # fits, each weighted at the K_obj of the one before; each shrinks the change by the interval
PARABOLAS = 12  # through the misfit about its least
MOST = 50.0  # steps that a parabola moves K_obj by
HALVINGS = 20  # of the way from the best K_obj to FARTHEST times it: to 1e-6 of it
FARTHEST = 30.0  # an interval that reaches so many times K_obj is no interval


@dataclass(frozen=True)
class Covariance:
    """Of ln f and ln s of every element by what is believed of it, or by estimates of that; one shape."""

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
        """Averaged with that of all elements in common, as the lab makes its weights; with two elements, and
        where it is known, as it is. `count` says how many there are of each."""
        if dof >= 1e6:
            return self
        total = np.broadcast_to(count, self.ss.shape).sum(axis=-1, keepdims=True)
        prior = np.where(total > 2, PRIOR_DOF, 0.0)

        def mean(c: Array) -> Array:
            return (dof * c + prior * (count * c).sum(axis=-1, keepdims=True) / total) / (dof + prior)

        return Covariance(mean(self.ff), mean(self.fs), mean(self.ss))


@dataclass(frozen=True)
class Evaluated:
    """Of every array, N/mm."""

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

    def fit(self, x: Array, weights: Covariance) -> tuple[Array, Array, Array]:
        """At K_obj x, (arrays, 1): the least-squares x, the misfit of f + x s, and each element's pull on x
        (over S), with S = sum of pull (s - mean)."""
        w = 1.0 / (self.signal(x) + weights.along(self.f, self.s, x))
        all_w = w.sum(axis=1, keepdims=True)
        s = self.s - (w * self.s).sum(axis=1, keepdims=True) / all_w
        f = self.f - (w * self.f).sum(axis=1, keepdims=True) / all_w
        pull = w * s
        best = -(pull * f).sum(axis=1, keepdims=True) / (pull * s).sum(axis=1, keepdims=True)
        return best, (w * (f + x * s) ** 2).sum(axis=1, keepdims=True), pull

    def evaluated(self, near: float) -> Evaluated:
        """Estimate and interval of each array, K_obj being near `near` (N/mm)."""
        n, weights, best = self.s.shape[1], self.weights, self.best(near)
        _, least, pull = self.fit(best, weights)
        own = pull**2 * self.belief.along(self.f, self.s, best)
        signal = (pull**2 * self.signal(best)).sum(axis=1, keepdims=True)
        total = signal + own.sum(axis=1, keepdims=True)
        dof = total**2 / (signal**2 / self.dof[1] + (own**2).sum(axis=1, keepdims=True) / self.dof[0])
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
        w = 1.0 / (self.signal(x) + weights.along(self.f, self.s, x))
        all_w = w.sum(axis=1, keepdims=True)
        s = self.s - (w * self.s).sum(axis=1, keepdims=True) / all_w
        left = w * (1.0 - w / all_w - w * s**2 / (w * s**2).sum(axis=1, keepdims=True))
        own = left * self.belief.along(self.f, self.s, x)
        signal = (left * self.signal(x)).sum(axis=1, keepdims=True)
        total = signal + own.sum(axis=1, keepdims=True)
        dof = total**2 / (signal**2 / self.dof[1] + (own**2).sum(axis=1, keepdims=True) / self.dof[0])
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
        """Where the misfit passes the limit; 0 or inf where it does not."""
        inner, outer = np.zeros_like(best), np.full_like(best, np.log(FARTHEST))
        for _ in range(HALVINGS):
            middle = 0.5 * (inner + outer)
            beyond = self.fit(best * np.exp(sign * middle), weights)[1] > limit
            inner, outer = np.where(beyond, inner, middle), np.where(beyond, middle, outer)
        far = inner[:, 0] > np.log(FARTHEST) - 1e-5
        return np.where(far, 0.0 if sign < 0.0 else np.inf, best[:, 0] * np.exp(sign * inner[:, 0]))
