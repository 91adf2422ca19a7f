"""Fieller's interval for a ratio of two measured quantities, such as K_obj from a pair's readings."""

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
