"""Fieller's interval of K_obj = (K_r d_r - K_m d_m)/(d_m - d_r) from a pair's deflections, for tests."""

from __future__ import annotations

from tactcad.mechanics.lumped import RatioInterval, ratio_interval


def object_stiffness_interval(
    K_r, K_m, d_r, d_m, var_r, var_m, covariance=0.0, *, var_K_r=0.0, var_K_m=0.0
) -> RatioInterval:
    """K in N/mm and d in mm with their variances; the calibrated K to first order, independent."""
    numerator = K_r**2 * var_r + K_m**2 * var_m - 2 * K_r * K_m * covariance
    return ratio_interval(
        K_r * d_r - K_m * d_m,
        d_m - d_r,
        numerator + d_r**2 * var_K_r + d_m**2 * var_K_m,
        var_r + var_m - 2 * covariance,
        (K_r + K_m) * covariance - K_r * var_r - K_m * var_m,
    )
