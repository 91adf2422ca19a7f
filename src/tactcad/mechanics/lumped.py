"""Lumped pair: equations (1) to (6) of the paper, forward and back, in forms that keep their digits.

Symbols as in the paper: K_r, K_m stiffness of the reference and the measuring element, K_obj of the
object (all N/mm), Delta the approach of sensor and object (mm); d_r, d_m are the elements' own
deflections Delta - delta_r, Delta - delta_m (mm). All arguments broadcast.
"""

from __future__ import annotations

import numpy as np

from .section import Array


def _share(x, K) -> Array:
    """x/(x + K), for x from 0 to infinity: 1 there."""
    x = np.asarray(x, dtype=float)
    finite = np.where(np.isinf(x), 1.0, x)
    return np.where(np.isinf(x), 1.0, finite / (finite + K))


def object_indentation(K, K_obj, approach) -> Array:
    """Equation (1): delta = K/(K_obj + K) Delta, how far the element presses the object in, mm."""
    return K / (K_obj + K) * approach


def element_deflection(K, K_obj, approach) -> Array:
    """Delta - delta = K_obj/(K_obj + K) Delta, without the difference, mm; K_obj from 0 to infinity."""
    return approach * _share(K_obj, K)


def deflection_ratio(K_r, K_m, K_obj) -> Array:
    """Equation (2): R = (K_r + K_obj)/(K_m + K_obj)."""
    return 1.0 + ratio_excess(K_r, K_m, K_obj)


def ratio_excess(K_r, K_m, K_obj) -> Array:
    """R - 1 = (K_r - K_m)/(K_m + K_obj), which keeps its digits where R is close to 1."""
    return (np.asarray(K_r) - K_m) / (np.asarray(K_m) + K_obj)


def ratio_deficit(K_r, K_m, K_obj) -> Array:
    """K_r/K_m - R = K_obj (K_r - K_m)/(K_m (K_m + K_obj)), for objects much softer than the elements."""
    K_m = np.asarray(K_m)
    return _share(K_obj, K_m) * ((np.asarray(K_r) - K_m) / K_m)


def object_stiffness(K_r, K_m, R) -> Array:
    """Equation (3): K_obj = (K_r - R K_m)/(R - 1), N/mm. Its digits are those that R carries.

    Infinite for R = 1; NaN where K_r = K_m too, since then R tells nothing.
    """
    R = np.asarray(R)
    with np.errstate(divide="ignore", invalid="ignore"):
        return (K_r - R * K_m) / (R - 1.0)


def object_stiffness_from_excess(K_r, K_m, excess) -> Array:
    """Equation (3) from R - 1: (K_r - K_m)/(R - 1) - K_m, for R close to 1 (stiff objects), N/mm."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return (np.asarray(K_r) - K_m) / excess - K_m


def object_stiffness_from_deficit(K_r, K_m, deficit) -> Array:
    """Equation (3) from D = K_r/K_m - R: K_m D/((K_r - K_m)/K_m - D), for soft objects, N/mm."""
    K_m = np.asarray(K_m)
    return K_m * (deficit / ((np.asarray(K_r) - K_m) / K_m - deficit))


def differences(K_r, K_m, K_obj, approach) -> tuple[Array, Array]:
    """What a pair reads: (F_r - F_m in N, d_m - d_r in mm), each without cancellation.

    d_m - d_r = Delta x (K_r - K_m)/((K_r + x)(K_m + x)), x = K_obj, and F_r - F_m is x times that.
    """
    K_r, K_m, x = (np.asarray(v, dtype=float) for v in (K_r, K_m, K_obj))
    per_force = approach * _share(x, K_r) * (K_r - K_m)
    return per_force * _share(x, K_m), per_force / (K_m + x)


def object_stiffness_from_differences(force_difference, deflection_difference) -> Array:
    """K_obj = (F_r - F_m)/(d_m - d_r), N/mm; infinite for equal deflections, NaN where nothing differs."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.divide(force_difference, deflection_difference)


def object_compliance_from_differences(force_difference, deflection_difference) -> Array:
    """1/K_obj, mm/N: what to report for a very stiff object."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.divide(deflection_difference, force_difference)


def object_stiffness_from_deflections(K_r, K_m, d_r, d_m) -> Array:
    """K_obj = (K_r d_r - K_m d_m)/(d_m - d_r), N/mm, from the elements' own deflections in mm."""
    K_r, K_m, d_r, d_m = (np.asarray(v, dtype=float) for v in (K_r, K_m, d_r, d_m))
    return object_stiffness_from_differences(K_r * d_r - K_m * d_m, d_m - d_r)


def condition_in_ratio(K_r, K_m, K_obj) -> Array:
    """dln K_obj/dln R = -(K_r + x)(K_m + x)/(x (K_r - K_m)), x = K_obj; infinite at x = 0 and infinity."""
    K_r, K_m, x = (np.asarray(v, dtype=float) for v in (K_r, K_m, K_obj))
    with np.errstate(divide="ignore"):
        return -(K_r + x) / (K_r - K_m) / _share(x, K_m)


def condition_in_reference(K_r, K_m, K_obj) -> Array:
    """dln K_obj/dln K_r = K_r (K_m + x)/(x (K_r - K_m)); infinite at x = 0."""
    K_r, K_m, x = (np.asarray(v, dtype=float) for v in (K_r, K_m, K_obj))
    with np.errstate(divide="ignore"):
        return K_r / (K_r - K_m) / _share(x, K_m)


def condition_in_measuring(K_r, K_m, K_obj) -> Array:
    """dln K_obj/dln K_m = -K_m (K_r + x)/(x (K_r - K_m)); with `condition_in_reference` it adds up to 1."""
    K_r, K_m, x = (np.asarray(v, dtype=float) for v in (K_r, K_m, K_obj))
    with np.errstate(divide="ignore"):
        return -K_m / (K_r - K_m) / _share(x, K_r)


def least_condition(K_r, K_m) -> tuple[Array, Array]:
    """The K_obj (N/mm) at which |dln K_obj/dln R| is least, sqrt(K_r K_m), and that least value.

    (sqrt q + 1)/(sqrt q - 1), q = K_r/K_m, written as (sqrt K_r + sqrt K_m)^2/(K_r - K_m).
    """
    K_r, K_m = np.asarray(K_r, dtype=float), np.asarray(K_m, dtype=float)
    root_r, root_m = np.sqrt(K_r), np.sqrt(K_m)
    return root_r * root_m, (root_r + root_m) ** 2 / (K_r - K_m)


def deflection_from_signal(signal, zero_signal, K_v) -> Array:
    """Equation (4): Delta = (V - V_0)/K_v, mm, with K_v in V/mm."""
    return (np.asarray(signal) - zero_signal) / K_v


def signal_from_deflection(deflection, zero_signal, K_v) -> Array:
    """Equation (4) turned round: V = V_0 + K_v Delta, V."""
    return zero_signal + np.asarray(K_v) * deflection


def force_from_deflection(K, deflection) -> Array:
    """Equation (5): F = K Delta, N."""
    return np.asarray(K) * deflection


def force_from_signal(signal, zero_signal, K, K_v) -> Array:
    """Equation (6): F = (K/K_v)(V - V_0), N."""
    return np.asarray(K) / K_v * (np.asarray(signal) - zero_signal)


def signal_from_force(force, zero_signal, K, K_v) -> Array:
    """Equation (6) turned round: V = V_0 + (K_v/K) F, V."""
    return zero_signal + np.asarray(K_v) / K * force
