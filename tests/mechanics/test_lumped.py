"""Equations (1) to (6) against 50 digits of mpmath, over extreme ranges, and their named limits."""

from __future__ import annotations

import itertools

import mpmath as mp
import numpy as np
import pytest

from tactcad.mechanics import lumped

EPS = np.finfo(float).eps
PAIRS = [(80.38, 40.12), (10.0, 1.0), (1.0 + 1e-12, 1.0), (1.0 + 1e-6, 1.0), (1e12, 1.0), (3.0, 1e-9)]
OBJECTS = [1e-12, 1e-6, 1e-3, 0.3, 1.0, 17.0, 1e3, 1e6, 1e12]


@pytest.fixture(autouse=True)
def fifty_digits():
    with mp.workdps(50):
        yield


def exact(*values):
    return [mp.mpf(float(v)) for v in values]


def relative_condition(f, values):
    """Sum of |x_i df/dx_i / f|: how many times its inputs' rounding a result may carry."""
    at = f(*values)
    total = mp.mpf(0)
    for i, x in enumerate(values):
        step = x * mp.mpf(10) ** -20
        moved = list(values)
        moved[i] = x + step
        total += abs((f(*moved) - at) / step * x / at)
    return float(total)


CASES = {
    "deflection_ratio": (lambda r, m, x: (r + x) / (m + x)),
    "ratio_excess": (lambda r, m, x: (r - m) / (m + x)),
    "ratio_deficit": (lambda r, m, x: r / m - (r + x) / (m + x)),
    "condition_in_ratio": (lambda r, m, x: -(r + x) * (m + x) / (x * (r - m))),
    "condition_in_reference": (lambda r, m, x: r * (m + x) / (x * (r - m))),
    "condition_in_measuring": (lambda r, m, x: -m * (r + x) / (x * (r - m))),
}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("pair,x", list(itertools.product(PAIRS, OBJECTS)))
def test_forward_forms_keep_their_digits(name, pair, x):
    K_r, K_m = pair
    x = x * K_m
    values = exact(K_r, K_m, x)
    truth = CASES[name](*values)
    got = float(getattr(lumped, name)(K_r, K_m, x))
    # K_r - K_m of two given floats is exact or as good as exact, so it costs no condition
    assert abs(mp.mpf(got) / truth - 1) <= 8 * EPS


@pytest.mark.parametrize("pair,x", list(itertools.product(PAIRS, OBJECTS)))
def test_object_stiffness_errs_by_its_condition_in_the_ratio_and_no_more(pair, x):
    K_r, K_m = pair
    x = x * K_m
    R = float(lumped.deflection_ratio(K_r, K_m, x))
    if R == 1.0:
        assert np.isinf(lumped.object_stiffness(K_r, K_m, R))
        return
    f = lambda r, m, q: (r - q * m) / (q - 1)  # noqa: E731
    values = exact(K_r, K_m, R)
    truth = f(*values)
    got = mp.mpf(float(lumped.object_stiffness(K_r, K_m, R)))
    if truth == 0:
        assert got == 0
        return
    assert abs(got / truth - 1) <= 4 * EPS * (1 + relative_condition(f, values))


@pytest.mark.parametrize("pair,x", list(itertools.product(PAIRS, OBJECTS)))
def test_excess_returns_a_stiff_object_and_deficit_a_soft_one(pair, x):
    K_r, K_m = pair
    x = x * K_m
    if x >= K_m:
        back = lumped.object_stiffness_from_excess(K_r, K_m, lumped.ratio_excess(K_r, K_m, x))
    else:
        back = lumped.object_stiffness_from_deficit(K_r, K_m, lumped.ratio_deficit(K_r, K_m, x))
    assert abs(float(back) / x - 1) <= 16 * EPS


@pytest.mark.parametrize("pair,x", list(itertools.product(PAIRS, OBJECTS)))
def test_differences_carry_every_object_stiffness_to_the_end(pair, x):
    K_r, K_m = pair
    x = x * K_m
    force, deflection = lumped.differences(K_r, K_m, x, 0.1)
    r, m, q = exact(K_r, K_m, x)
    approach = mp.mpf(0.1)
    true_deflection = approach * q * (1 / (m + q) - 1 / (r + q))
    true_force = approach * q * (r / (r + q) - m / (m + q))
    assert abs(mp.mpf(float(deflection)) / true_deflection - 1) <= 8 * EPS
    assert abs(mp.mpf(float(force)) / true_force - 1) <= 8 * EPS
    assert float(lumped.object_stiffness_from_differences(force, deflection)) == pytest.approx(x, rel=4 * EPS)
    assert float(lumped.object_compliance_from_differences(force, deflection)) == pytest.approx(
        1 / x, rel=4 * EPS
    )


def test_limit_k_obj_to_zero_gives_the_ratio_of_the_stiffnesses():
    assert lumped.deflection_ratio(80.0, 8.0, 0.0) == 10.0
    assert lumped.element_deflection(8.0, 1e-300, 1.0) == pytest.approx(1.25e-301, rel=1e-12)


def test_limit_k_obj_to_infinity_gives_ratio_one_and_the_whole_approach():
    assert lumped.deflection_ratio(80.0, 8.0, np.inf) == 1.0
    assert lumped.element_deflection(8.0, np.inf, 0.15) == 0.15
    assert np.isinf(lumped.object_stiffness_from_excess(80.0, 8.0, 0.0))


def test_limit_k_r_to_k_m_tells_nothing_about_the_object():
    excess = lumped.ratio_excess(np.nextafter(8.0, 9.0), 8.0, 2.0)
    assert 0.0 < excess < 2e-16
    assert abs(lumped.condition_in_ratio(np.nextafter(8.0, 9.0), 8.0, 2.0)) > 1e15
    assert np.isnan(lumped.object_stiffness_from_differences(*lumped.differences(8.0, 8.0, 2.0, 0.1)))


def test_element_and_object_share_the_approach_and_the_force():
    K, x, approach = np.array([0.5, 5.0, 50.0]), 3.0, 0.2
    pressed, bent = lumped.object_indentation(K, x, approach), lumped.element_deflection(K, x, approach)
    np.testing.assert_allclose(pressed + bent, approach, rtol=4 * EPS)
    np.testing.assert_allclose(K * bent, x * pressed, rtol=4 * EPS)


def test_conditions_are_the_logarithmic_derivatives_and_those_in_k_add_up_to_one():
    K_r, K_m, x = mp.mpf(80), mp.mpf(12), mp.mpf(5)
    R = (K_r + x) / (K_m + x)
    solve = lambda r, m, q: (r - q * m) / (q - 1)  # noqa: E731
    for i, name in enumerate(("condition_in_reference", "condition_in_measuring", "condition_in_ratio")):
        values = [K_r, K_m, R]
        slope = mp.diff(lambda v: solve(*values[:i], v, *values[i + 1 :]), values[i]) * values[i] / x  # noqa: B023
        assert float(getattr(lumped, name)(80.0, 12.0, 5.0)) == pytest.approx(float(slope), rel=1e-12)
    total = lumped.condition_in_reference(80.0, 12.0, 5.0) + lumped.condition_in_measuring(80.0, 12.0, 5.0)
    assert total == pytest.approx(1.0, rel=1e-14)


def test_condition_is_least_at_the_geometric_mean():
    at, least = lumped.least_condition(10.0, 1.0)
    assert at == pytest.approx(np.sqrt(10.0))
    assert least == pytest.approx((np.sqrt(10) + 1) / (np.sqrt(10) - 1))
    others = np.abs(lumped.condition_in_ratio(10.0, 1.0, np.geomspace(0.01, 1000, 2001)))
    assert others.min() >= least * (1 - 1e-12)


def test_equations_four_to_six_go_forward_and_back():
    signal = np.array([-1.01, -0.8, -0.46])  # element 1 of Table 1: K 40.12, K_v -7.3, V_0 -1.01
    deflection = lumped.deflection_from_signal(signal, -1.01, -7.3)
    np.testing.assert_allclose(deflection, [0.0, 0.21 / -7.3, 0.55 / -7.3], atol=1e-15)
    force = lumped.force_from_signal(signal, -1.01, 40.12, -7.3)
    np.testing.assert_allclose(force, lumped.force_from_deflection(40.12, deflection), rtol=1e-14)
    np.testing.assert_allclose(lumped.signal_from_deflection(deflection, -1.01, -7.3), signal, rtol=1e-14)
    np.testing.assert_allclose(lumped.signal_from_force(force, -1.01, 40.12, -7.3), signal, rtol=1e-14)
