"""The interval of K_obj that an array gives, predicted: what `tactcad stiffness` would say of its readings.

All pads move by one approach; s and f = K s are an element's deflection and force along it, so that by
equation (1) f + x s = c is the same for all, x = K_obj. Readings at evenly rising loads with noise sigma of
each, and K and K_v known with errors, leave f_i + x s_i with the variance

  v_i = sigma^2 (K_i + x)^2/K_v,i^2 + f_i^2 var K + c^2 var K_v - 2 f_i c cov(K, K_v)

(relative variances of K and K_v). The generalised least squares of lab/combine.py weighs with w_i, inverse to
v_i with variances averaged over elements where they are estimated; then x has the variance

  sum_i w_i^2 (s_i - s_mean)^2 v_i/S^2,  S = sum_i w_i (s_i - s_mean)^2,  mean by weights w_i,

1/S where w_i = 1/v_i.
An error that all elements share enters linearly; the load cell's compliance is in series with the object, so
its limits shift 1/x. The interval's ends are where |x' - x| sqrt(S(x')/S(x)) is t standard errors, as in
combine's misfit.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit

from tactcad.mechanics.section import Array

from .evaluation import LEVEL, Covariance, Evaluation
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


def motion(e: Elements, count: Array, x: Array, force: float, loads: int) -> InGrasp:
    """Deflections and forces of elements on separate springs x (N/mm) under `loads` even loads up to `force`
    (N); `count` says how many there are of each. x broadcasts against (..., elements)."""
    share = x / (e.stiffness + x)
    total = (count * e.stiffness * share).sum(axis=-1, keepdims=True)  # N per mm of approach
    load = force * (np.arange(loads) + 1.0) / loads
    spread = float(np.sqrt(((load - load.mean()) ** 2).sum()))
    approach = spread / total
    s = share * approach
    return InGrasp(s, e.stiffness * s, x * approach, e.stiffness * share * force / total)


def weights(
    m: InGrasp, e: Elements, known: Knowledge, count: Array, x: Array, noise: float
) -> tuple[Array, Array, Array]:
    """v_i at a K_obj, in its parts by the readings' noise (V) and by belief in K and K_v; and what stands for
    v_i in the lab's weights."""
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
        How many there are of each; broadcasts with them.
    known
        Errors of belief in them.
    x
        True K_obj, N/mm; broadcasts with (..., elements), so that (points, 1, 1) gives (points, ...).
    noise
        Of one averaged reading, V.
    force, loads
        Largest force on the array, N, and how many even loads up to it are read.
    used
        As `count`, where only some of those that carry the load are evaluated.
    """
    m = motion(e, count, x, force, loads)
    count = count if used is None else used
    by_noise, by_belief, weighed = weights(m, e, known, count, x, noise)
    S, pull = information(m, count, weighed)
    shared = sum(_shared(m, count, pull, S, k, v) ** 2 for k, v in known.common.values())
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


def _shared(m: InGrasp, count: Array, pull: Array, S: Array, k: Array, v: Array) -> Array:
    """Shift of x by errors k of ln K and v of ln K_v that all elements have at once."""
    return -(count * pull * (m.f * k - m.c * v)).sum(axis=-1) / S


def coupled_estimate(
    e: Elements, known: Knowledge, x: float, noise: float, force: float, loads: int, share: Array
) -> Array:
    """K_obj as believed, N/mm, (arrays,), where pads sink under each other's force by `share` (..., elements,
    elements; 1 on the diagonal) of what the same force on themselves does, and are taken to press on separate
    springs."""
    compliance = share / x + np.eye(e.stiffness.shape[-1]) / e.stiffness[..., np.newaxis, :]
    f = np.linalg.solve(compliance, np.ones((*compliance.shape[:-1], 1)))[..., 0]
    load = force * (np.arange(loads) + 1.0) / loads
    spread = float(np.sqrt(((load - load.mean()) ** 2).sum()))
    f = f * (spread / f.sum(axis=-1, keepdims=True))
    f = f.reshape(-1, f.shape[-1])
    of_s, of_f = noise / e.signal, noise * e.stiffness / e.signal
    belief = Covariance.of(known.of_k, known.of_v, known.cross)
    dof = (known.dof, (f.shape[1] - 1.0) * (loads - 2.0))
    return Evaluation(f / e.stiffness, f, (of_s, of_f), belief, dof).best(x)[:, 0]
