"""Lumped pair: equations (1) to (3) of the paper and their condition numbers, in forms without cancellation;
Fieller's interval for a ratio of two measured quantities, such as K_obj from a pair's readings.

Symbols as in the paper: K_r, K_m stiffness of the reference and the measuring element, K_obj of the
object (all N/mm), Delta the approach of sensor and object (mm); d_r, d_m are the elements' own
deflections Delta - delta_r, Delta - delta_m (mm). All arguments broadcast.

The pads are coupled through one continuous rubber sample: an elastic layer bonded to a rigid base (or a
half-space), each pad a rectangle of even pressure. In the plane of wave numbers a normal load gives the
surface 2 (1 - nu^2)/E phi(k h)/k, with (bonded layer) phi = ((3 - 4 nu) sinh 2c - 2c)/((3 - 4 nu) cosh 2c +
2 c^2 + 5 - 12 nu + 8 nu^2), c = k h; phi = 1 for the half-space. Source: Johnson, Contact Mechanics, and
Gladwell, Contact Problems in the Classical Theory of Elasticity.
"""

from __future__ import annotations

from dataclasses import dataclass
from statistics import NormalDist

import numpy as np
from numpy.typing import ArrayLike

from .section import Array


def _share(x: Array | float, K: Array | float) -> Array:
    """x/(x + K) for x from 0 to infinity (then 1)."""
    x = np.asarray(x, dtype=float)
    finite = np.where(np.isinf(x), 1.0, x)
    return np.where(np.isinf(x), 1.0, finite / (finite + K))


def element_deflection(K: Array | float, K_obj: Array | float, approach: Array | float) -> Array:
    """Delta - delta = K_obj/(K_obj + K) Delta, mm; K_obj from 0 to infinity. No cancellation."""
    return approach * _share(K_obj, K)


def deflection_ratio(K_r: Array | float, K_m: Array | float, K_obj: Array | float) -> Array:
    """Equation (2): R = (K_r + K_obj)/(K_m + K_obj)."""
    return 1.0 + ratio_excess(K_r, K_m, K_obj)


def ratio_excess(K_r: Array | float, K_m: Array | float, K_obj: Array | float) -> Array:
    """R - 1 = (K_r - K_m)/(K_m + K_obj), which keeps its digits where R is close to 1."""
    return (np.asarray(K_r) - K_m) / (np.asarray(K_m) + K_obj)


def object_stiffness(K_r: Array | float, K_m: Array | float, R: Array | float) -> Array:
    """Equation (3): K_obj = (K_r - R K_m)/(R - 1), N/mm.

    Infinite for R = 1; NaN if also K_r = K_m, since R is then 1 for every object. Near R = 1 the result
    has only as many correct digits as R - 1.
    """
    R = np.asarray(R)
    with np.errstate(divide="ignore", invalid="ignore"):
        return (K_r - R * K_m) / (R - 1.0)


def condition_in_ratio(K_r: Array | float, K_m: Array | float, K_obj: Array | float) -> Array:
    """Relative error of K_obj per relative error of R, dln K_obj/dln R.

    -(K_r + x)(K_m + x)/(x (K_r - K_m)) with x = K_obj; infinite at x = 0 and at infinity.
    """
    K_r, K_m, x = (np.asarray(v, dtype=float) for v in (K_r, K_m, K_obj))
    with np.errstate(divide="ignore"):
        return -(K_r + x) / (K_r - K_m) / _share(x, K_m)


def condition_in_reference(K_r: Array | float, K_m: Array | float, K_obj: Array | float) -> Array:
    """Relative error of K_obj per relative error of K_r, dln K_obj/dln K_r.

    K_r (K_m + x)/(x (K_r - K_m)) with x = K_obj; infinite at x = 0.
    """
    K_r, K_m, x = (np.asarray(v, dtype=float) for v in (K_r, K_m, K_obj))
    with np.errstate(divide="ignore"):
        return K_r / (K_r - K_m) / _share(x, K_m)


def condition_in_measuring(K_r: Array | float, K_m: Array | float, K_obj: Array | float) -> Array:
    """Relative error of K_obj per relative error of K_m, dln K_obj/dln K_m.

    -K_m (K_r + x)/(x (K_r - K_m)) with x = K_obj. It and `condition_in_reference` add up to 1.
    """
    K_r, K_m, x = (np.asarray(v, dtype=float) for v in (K_r, K_m, K_obj))
    with np.errstate(divide="ignore"):
        return -K_m / (K_r - K_m) / _share(x, K_r)


@dataclass(frozen=True)
class RatioInterval:
    """Set of ratios that the data do not reject, for each reading.

    Where `bounded`, the interval lower..upper. Where `open_ended`, all but lower..upper: two rays, so
    that the ratio may be infinite. Otherwise (`unknown`) every value, and lower, upper are -inf, inf.
    """

    estimate: Array
    lower: Array
    upper: Array
    bounded: np.ndarray
    open_ended: np.ndarray

    @property
    def unknown(self) -> np.ndarray:
        """Neither numerator nor denominator differs from zero."""
        return ~(self.bounded | self.open_ended)


def ratio_interval(
    numerator: ArrayLike,
    denominator: ArrayLike,
    var_numerator: ArrayLike,
    var_denominator: ArrayLike,
    covariance: ArrayLike,
    *,
    quantile: float | None = None,
) -> RatioInterval:
    """Fieller's set {x : (N - x D)^2 <= q^2 Var(N - x D)} for the ratio x = N/D.

    Parameters
    ----------
    numerator, denominator
        N and D; all arguments broadcast.
    var_numerator, var_denominator, covariance
        Of N and D, in squared units.
    quantile
        q, by default the normal 0.975 (95 % two-sided); pass Student's for estimated variances.
    """
    q = NormalDist().inv_cdf(0.975) if quantile is None else quantile
    N, D, vN, vD, c = np.broadcast_arrays(
        *(
            np.asarray(v, dtype=float)
            for v in (numerator, denominator, var_numerator, var_denominator, covariance)
        )
    )
    # a x^2 - 2 h x + k <= 0
    a, h, k = D * D - q * q * vD, N * D - q * q * c, N * N - q * q * vN
    # h^2 - a k with N^2 D^2 cancelled by hand: for exact readings it is 0, not a rounding error
    discriminant = q * q * (N * N * vD - 2.0 * N * D * c + D * D * vN - q * q * (vN * vD - c * c))
    real = discriminant >= 0.0
    root = np.sqrt(np.where(real, discriminant, 0.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        # one root by the sum that does not cancel, the other from the product of roots k/a
        far = h + np.where(h >= 0.0, root, -root)
        first, second = far / a, np.where(far == 0.0, 0.0, k / far)
        estimate = N / D
    lower, upper = np.minimum(first, second), np.maximum(first, second)
    bounded, open_ended = real & (a > 0.0), real & (a < 0.0)
    # a bounded set contains the estimate; by rounding, a very narrow one may miss it
    lower = np.where(bounded, np.minimum(lower, estimate), lower)
    upper = np.where(bounded, np.maximum(upper, estimate), upper)
    known = bounded | open_ended
    return RatioInterval(
        estimate, np.where(known, lower, -np.inf), np.where(known, upper, np.inf), bounded, open_ended
    )


WAVES = 1200  # wave numbers, to LARGEST/pad size
ANGLES = 96
LARGEST = 60.0
FAR = 50.0  # mm


@dataclass(frozen=True)
class Coupling:
    """Elements on one continuous sample compared with the same elements each on an independent spring.

    stiffness: the array's stiffness over that on independent springs. ratio: R of each element over equation
    (2).
    """

    stiffness: float
    ratio: np.ndarray


def layer_factor(c: np.ndarray, poisson: float) -> np.ndarray:
    """phi of a bonded layer, c = k h; 1 if c is large."""
    m = 3 - 4 * poisson
    small = np.minimum(c, 40.0)
    top = m * np.sinh(2 * small) - 2 * small
    bottom = m * np.cosh(2 * small) + 2 * small**2 + 5 - 12 * poisson + 8 * poisson**2
    return np.where(c > 40.0, 1.0, top / bottom)


def _waves(
    length: float, width: float, thickness: float, poisson: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Share of each wave in a pad's mean displacement under its own even pressure, [number, angle]; the
    waves' numbers along x and y, and their step, 1/mm."""
    k = (np.arange(WAVES) + 0.5) * LARGEST / (length * width) ** 0.5 / WAVES
    angle = (np.arange(ANGLES) + 0.5) * (np.pi / 2) / ANGLES
    kx, ky = np.outer(k, np.cos(angle)), np.outer(k, np.sin(angle))
    phi = 1.0 if np.isinf(thickness) else layer_factor(k * thickness, poisson)[:, None]
    share = phi * (np.sinc(kx * length / 2 / np.pi) * np.sinc(ky * width / 2 / np.pi)) ** 2
    return share, kx, ky, float(k[1] - k[0])


def influence(
    dx: np.ndarray, dy: np.ndarray, length: float, width: float, thickness: float, poisson: float
) -> np.ndarray:
    """Mean displacement of a pad under a force on another one, over that under the same force on itself.

    Parameters
    ----------
    dx, dy : ndarray, shape (n,)
        From the loaded pad to the other one, mm.
    length, width
        Of every pad along x and y, mm.
    thickness
        Of the sample, mm; inf for a half-space.
    poisson
        Of the sample.

    Returns
    -------
    ndarray, shape (n,)
        1 at distance 0.
    """
    weight, kx, ky, _ = _waves(length, width, thickness, poisson)
    own = weight.sum()

    def share(x: float, y: float) -> float:
        """Beyond FAR the sum over waves would alias: a layer transmits nothing there, a half-space as 1/r."""
        r = float(np.hypot(x, y))
        if r > FAR and np.isfinite(thickness):
            return 0.0
        near = FAR / max(r, FAR)
        return near * float((weight * np.cos(kx * x * near) * np.cos(ky * y * near)).sum() / own)

    return np.array([share(x, y) for x, y in zip(dx, dy)])


def shares_between(
    x: np.ndarray, y: np.ndarray, length: float, width: float, thickness: float, poisson: float
) -> np.ndarray:
    """`influence` of every pad on every other.

    Parameters
    ----------
    x, y : ndarray, shape (n,)
        Centres of the pads, mm.
    length, width, thickness, poisson
        As for `influence`.

    Returns
    -------
    ndarray, shape (n, n)
        1 on the diagonal.
    """
    dx, dy = np.abs(x[:, None] - x[None, :]), np.abs(y[:, None] - y[None, :])
    places, index = np.unique(
        np.round(np.column_stack([dx.ravel(), dy.ravel()]), 6), axis=0, return_inverse=True
    )
    return influence(places[:, 0], places[:, 1], length, width, thickness, poisson)[index].reshape(dx.shape)


def coupling(
    K: np.ndarray,
    x: np.ndarray,
    y: np.ndarray,
    object_stiffness: float,
    reference: int,
    length: float,
    width: float,
    thickness: float,
    poisson: float,
) -> Coupling:
    """Elements pressed together into one sample, compared with independent springs of the same stiffness.

    Parameters
    ----------
    K : ndarray, shape (n,)
        Stiffness of the elements, N/mm.
    x, y : ndarray, shape (n,)
        Centres of their pads, mm.
    object_stiffness
        Of the sample under one pad alone, N/mm.
    reference
        Index of the reference element.
    length, width, thickness, poisson
        As for `influence`.
    """
    A = shares_between(x, y, length, width, thickness, poisson) / object_stiffness
    force = np.linalg.solve(np.diag(1 / K) + A, np.ones(len(K)))
    alone = element_deflection(K, object_stiffness, 1.0)
    deflection = force / K
    ratio = (deflection / deflection[reference]) / (alone / alone[reference])
    return Coupling(float(force.sum() / (K * alone).sum()), ratio)


def pad_stiffness(modulus: float, length: float, width: float, thickness: float, poisson: float) -> float:
    """Force on one pad over its mean displacement on an elastic layer, N/mm: K_obj of a modulus.

    The pressure is even; a rigid pad of 2 x 3 mm is 8.8 % stiffer on a half-space, 10.3 % on a layer of
    10 mm, 11.4 % on 6 mm and 13.1 % on 3 mm (finer patches than contact.press, nu 0.49).

    Parameters
    ----------
    modulus
        E of the layer, MPa.
    length, width
        Of the pad, mm.
    thickness
        Of the layer, bonded to a rigid base, mm; inf for a half-space.
    poisson
        Of the layer.
    """
    weight, _, _, step = _waves(length, width, thickness, poisson)
    area = step * (np.pi / 2 / ANGLES)
    return float(np.pi**2 * modulus / (2 * (1 - poisson**2)) / (weight.sum() * area))
