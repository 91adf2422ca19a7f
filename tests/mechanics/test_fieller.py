"""Fieller's interval: coverage by simulation, and the cases in which it is no interval."""

from __future__ import annotations

import numpy as np
import pytest
from pair_interval import object_stiffness_interval

from tactcad.mechanics.lumped import ratio_interval


@pytest.mark.parametrize("x", [2.0, 20.0, 300.0])
def test_interval_covers_the_truth_in_95_of_100(x):
    rng = np.random.default_rng(7)
    K_r, K_m, approach, noise, runs = 80.0, 10.0, 0.15, 2e-4, 40_000
    d_r, d_m = (approach * x / (K + x) + noise * rng.standard_normal(runs) for K in (K_r, K_m))
    found = object_stiffness_interval(K_r, K_m, d_r, d_m, noise**2, noise**2)
    inside = (found.lower <= x) & (x <= found.upper)
    covered = np.where(found.bounded, inside, np.where(found.open_ended, ~inside, True)).mean()
    assert covered == pytest.approx(0.95, abs=3.5 * np.sqrt(0.95 * 0.05 / runs))


def test_correlated_deflections_are_taken_into_account():
    rng = np.random.default_rng(8)
    K_r, K_m, x, runs = 60.0, 9.0, 6.0, 40_000
    cov = 1e-8 * np.array([[1.0, 0.8], [0.8, 2.0]])
    noise = rng.multivariate_normal([0, 0], cov, runs)
    d_r, d_m = 0.1 * x / (K_r + x) + noise[:, 0], 0.1 * x / (K_m + x) + noise[:, 1]
    found = object_stiffness_interval(K_r, K_m, d_r, d_m, cov[0, 0], cov[1, 1], cov[0, 1])
    covered = ((found.lower <= x) & (x <= found.upper))[found.bounded].mean()
    assert covered == pytest.approx(0.95, abs=0.005)


def test_ends_are_where_numerator_less_x_times_denominator_just_differs_from_zero():
    q = 1.959963984540054
    N, D, vN, vD, c = 3.0, 1.5, 0.01, 0.004, 0.002
    found = ratio_interval(N, D, vN, vD, c)
    for x in (float(found.lower), float(found.upper)):
        assert abs(N - x * D) == pytest.approx(q * np.sqrt(vN - 2 * x * c + x * x * vD), rel=1e-12)
    assert found.lower < found.estimate < found.upper


def test_denominator_lost_in_noise_leaves_two_rays():
    found = ratio_interval(1.0, 0.001, 1e-4, 1e-4, 0.0)
    assert found.open_ended and not found.bounded
    assert found.lower < 0.0 < found.upper  # all but what lies between


def test_all_lost_in_noise_leaves_every_value():
    found = ratio_interval(1e-4, 1e-4, 1e-2, 1e-2, 0.0)
    assert found.unknown and found.lower == -np.inf and found.upper == np.inf


def test_small_noise_gives_the_linear_interval():
    N, D, sN, sD = 8.0, 2.0, 1e-6, 2e-6
    found = ratio_interval(N, D, sN**2, sD**2, 0.0)
    half = 1.959963984540054 * 4.0 * np.hypot(sN / N, sD / D)
    assert float(found.upper - found.lower) / 2 == pytest.approx(half, rel=1e-5)


def test_doubtful_calibration_widens_the_interval():
    args = (80.0, 10.0, 0.01, 0.04, 1e-10, 1e-10)
    plain, doubtful = (
        object_stiffness_interval(*args),
        object_stiffness_interval(*args, var_K_r=1.0, var_K_m=0.01),
    )
    assert doubtful.upper - doubtful.lower > 2 * (plain.upper - plain.lower)
