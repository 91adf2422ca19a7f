"""The lumped pair from K_r/K_m = 1 + 1e-12 to 1e12 and from no object to a rigid one: 50 digits, or a named marker."""

from __future__ import annotations

import warnings

import mpmath as mp
import numpy as np
import pytest

from tactcad.mechanics import lumped
from tactcad.mechanics.fieller import object_stiffness_interval, ratio_interval

EPS = np.finfo(float).eps
RATIOS = {
    "one and a millionth of a millionth": 1 + 1e-12,
    "one and a millionth": 1 + 1e-6,
    "two": 2.0,
    "ten": 10.0,
    "a millionth of a millionth apart upwards": 1e12,
}
OBJECTS = {
    "none": 0.0,
    "gossamer": 1e-12,
    "soft": 1e-3,
    "like the element": 1.0,
    "hard": 1e3,
    "stone": 1e12,
    "rigid": np.inf,
}
K_M = {"N/mm": 8.0, "given in N/m": 8e3, "given in kN/mm": 8e-3}


@pytest.fixture(autouse=True)
def loud():
    with (
        warnings.catch_warnings(),
        np.errstate(over="raise", divide="raise", invalid="raise"),
        mp.workdps(50),
    ):
        warnings.simplefilter("error")
        yield


def limit(f, r, m, x):
    """f at x; at infinity its limit, by a number beyond which 50 digits see no change."""
    return f(mp.mpf(r), mp.mpf(m), mp.mpf(10) ** 200 if np.isinf(x) else mp.mpf(x))


FORWARD = {
    "deflection_ratio": lambda r, m, x: (r + x) / (m + x),
    "ratio_excess": lambda r, m, x: (r - m) / (m + x),
    "ratio_deficit": lambda r, m, x: r / m - (r + x) / (m + x),
}
CONDITIONS = {
    "condition_in_ratio": lambda r, m, x: -(r + x) * (m + x) / (x * (r - m)),
    "condition_in_reference": lambda r, m, x: r * (m + x) / (x * (r - m)),
    "condition_in_measuring": lambda r, m, x: -m * (r + x) / (x * (r - m)),
}


@pytest.fixture(params=K_M, ids=str)
def K_m(request):
    return K_M[request.param]


@pytest.fixture(params=RATIOS, ids=str)
def K_r(request, K_m):
    return K_m * RATIOS[request.param]


@pytest.fixture(params=OBJECTS, ids=str)
def K_obj(request, K_m):
    return K_m * OBJECTS[request.param]


def near(found, truth):
    return abs(mp.mpf(float(found)) - truth) <= 10 * EPS * abs(truth) + mp.mpf(10) ** -150


def test_forward(K_r, K_m, K_obj):
    for name, f in FORWARD.items():
        assert near(getattr(lumped, name)(K_r, K_m, K_obj), limit(f, K_r, K_m, K_obj)), name
    for K in (K_r, K_m):
        assert near(
            lumped.element_deflection(K, K_obj, 0.1),
            limit(lambda k, _, x: mp.mpf(0.1) * x / (k + x), K, 0, K_obj),
        )
        assert near(
            lumped.object_indentation(K, K_obj, 0.1),
            limit(lambda k, _, x: mp.mpf(0.1) * k / (k + x), K, 0, K_obj),
        )


def test_conditions(K_r, K_m, K_obj):
    for name, f in CONDITIONS.items():
        found = float(getattr(lumped, name)(K_r, K_m, K_obj))
        if K_obj == 0.0 or (np.isinf(K_obj) and name == "condition_in_ratio"):
            assert np.isinf(found), "nothing of the object can be told there"
        else:
            assert near(found, limit(f, K_r, K_m, K_obj)), name


def test_differences_and_back(K_r, K_m, K_obj):
    """From force and deflection differences every object comes back, the rigid one by its compliance 0."""
    force, deflection = lumped.differences(K_r, K_m, K_obj, 0.1)
    assert near(
        deflection, limit(lambda r, m, x: mp.mpf(0.1) * x * (r - m) / ((r + x) * (m + x)), K_r, K_m, K_obj)
    )
    assert near(
        force, limit(lambda r, m, x: mp.mpf(0.1) * x * (x / (m + x) * (r - m) / (r + x)), K_r, K_m, K_obj)
    )
    if K_obj == 0.0:  # nothing is pressed: no reading differs, and no stiffness can be told
        assert np.isnan(lumped.object_stiffness_from_differences(force, deflection))
    elif np.isinf(K_obj):
        assert np.isinf(lumped.object_stiffness_from_differences(force, deflection))
        assert lumped.object_compliance_from_differences(force, deflection) == 0.0
    else:
        assert float(lumped.object_stiffness_from_differences(force, deflection)) == pytest.approx(
            K_obj, rel=8 * EPS
        )


def test_ratio_and_back(K_r, K_m, K_obj):
    """From R - 1 stiff objects come back, from K_r/K_m - R soft ones, whatever the two stiffnesses."""
    if K_obj >= K_m:
        back = lumped.object_stiffness_from_excess(K_r, K_m, lumped.ratio_excess(K_r, K_m, K_obj))
    else:
        back = lumped.object_stiffness_from_deficit(K_r, K_m, lumped.ratio_deficit(K_r, K_m, K_obj))
    assert float(back) == pytest.approx(K_obj, rel=40 * EPS)


def test_equal_elements_tell_nothing():
    assert np.isnan(lumped.object_stiffness(8.0, 8.0, 1.0))
    assert lumped.object_stiffness(80.0, 8.0, 1.0) == np.inf
    assert np.isinf(lumped.condition_in_ratio(8.0, 8.0, 2.0))


@pytest.mark.parametrize("ratio", RATIOS.values(), ids=RATIOS)
@pytest.mark.parametrize(
    "x", [v for v in OBJECTS.values() if v > 0], ids=[k for k, v in OBJECTS.items() if v > 0]
)
@pytest.mark.parametrize("noise", [0.0, 1e-15, 1e-4, 1e3], ids=lambda n: f"noise {n:g} mm")
def test_interval_holds_the_estimate_or_says_that_it_is_none(ratio, x, noise):
    K_m, K_r = 8.0, 8.0 * ratio
    d_r, d_m = (float(lumped.element_deflection(K, x * K_m, 0.1)) for K in (K_r, K_m))
    found = object_stiffness_interval(K_r, K_m, d_r, d_m, noise**2, noise**2)
    assert int(found.bounded) + int(found.open_ended) + int(found.unknown) == 1
    assert not np.isnan(found.lower) and not np.isnan(found.upper)
    if found.bounded:
        assert found.lower <= found.estimate <= found.upper
    elif found.open_ended:
        assert not found.lower < found.estimate < found.upper
    else:
        assert (found.lower, found.upper) == (-np.inf, np.inf)
    if noise >= 1e3:  # no object is ruled out: where the pair is one element, x = -K alone is
        assert found.unknown or (found.open_ended and found.upper <= 0.0)


def test_interval_of_ratios_from_nothing_to_everything():
    """Numerator and denominator over 200 decades, certain: the interval is the ratio."""
    for N in (1e-100, 1.0, 1e100):
        for D in (1e-50, 1.0, 1e50):
            found = ratio_interval(N, D, 0.0, 0.0, 0.0)
            assert bool(found.bounded) and float(found.lower) == pytest.approx(N / D) == float(found.upper)
