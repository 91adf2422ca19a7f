"""Lumped pair: equations (1) to (3) of the paper and their condition numbers, in forms without cancellation.

Symbols as in the paper: K_r, K_m stiffness of the reference and the measuring element, K_obj of the
object (all N/mm), Delta the approach of sensor and object (mm); d_r, d_m are the elements' own
deflections Delta - delta_r, Delta - delta_m (mm). All arguments broadcast.
"""

from __future__ import annotations

import numpy as np

from .section import Array


def _share(x: Array | float, K: Array | float) -> Array:
    """x/(x + K) for x from 0 to infinity, where it is 1."""
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

    Infinite for R = 1; NaN where also K_r = K_m, since R is then 1 for every object. Near R = 1 the result
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
