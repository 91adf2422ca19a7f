"""Fieller's interval for a ratio of two measured quantities, here K_obj from a pair's readings."""

from __future__ import annotations

from dataclasses import dataclass
from statistics import NormalDist

import numpy as np
from numpy.typing import ArrayLike

from .section import Array


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
    # a bounded set holds the estimate; rounding may put an end of a very narrow one beside it
    lower = np.where(bounded, np.minimum(lower, estimate), lower)
    upper = np.where(bounded, np.maximum(upper, estimate), upper)
    known = bounded | open_ended
    return RatioInterval(
        estimate, np.where(known, lower, -np.inf), np.where(known, upper, np.inf), bounded, open_ended
    )


def object_stiffness_interval(
    K_r: Array | float,
    K_m: Array | float,
    d_r: Array | float,
    d_m: Array | float,
    var_r: Array | float,
    var_m: Array | float,
    covariance: Array | float = 0.0,
    *,
    var_K_r: Array | float = 0.0,
    var_K_m: Array | float = 0.0,
    quantile: float | None = None,
) -> RatioInterval:
    """Fieller's interval for K_obj = (K_r d_r - K_m d_m)/(d_m - d_r), N/mm.

    Parameters
    ----------
    K_r, K_m
        Stiffness of the reference and the measuring element, N/mm.
    d_r, d_m
        Their deflections, mm.
    var_r, var_m, covariance
        Of the deflections, mm2.
    var_K_r, var_K_m
        Variances of the calibrated stiffnesses, (N/mm)^2; taken to first order, independent.
    quantile
        As for `ratio_interval`.
    """
    K_r, K_m, d_r, d_m = (np.asarray(v, dtype=float) for v in (K_r, K_m, d_r, d_m))
    numerator, denominator = K_r * d_r - K_m * d_m, d_m - d_r
    var_numerator = (
        K_r * K_r * var_r
        + K_m * K_m * var_m
        - 2.0 * K_r * K_m * covariance
        + d_r * d_r * var_K_r
        + d_m * d_m * var_K_m
    )
    var_denominator = var_r + var_m - 2.0 * np.asarray(covariance)
    cov = (K_r + K_m) * covariance - K_r * var_r - K_m * var_m
    return ratio_interval(numerator, denominator, var_numerator, var_denominator, cov, quantile=quantile)
