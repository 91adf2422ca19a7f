"""The interval of K_obj from K_r/K_m = 1 + 1e-12 to 1e12 and from gossamer to a rigid object."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from pair_interval import object_stiffness_interval

from tactcad.mechanics import lumped
from tactcad.mechanics.lumped import ratio_interval

RATIOS = {
    "one and a millionth of a millionth": 1 + 1e-12,
    "one and a millionth": 1 + 1e-6,
    "two": 2.0,
    "ten": 10.0,
    "a millionth of a millionth apart upwards": 1e12,
}
OBJECTS = {
    "gossamer": 1e-12,
    "soft": 1e-3,
    "like the element": 1.0,
    "hard": 1e3,
    "stone": 1e12,
    "rigid": np.inf,
}


@pytest.fixture(autouse=True)
def loud():
    with warnings.catch_warnings(), np.errstate(over="raise", divide="raise", invalid="raise"):
        warnings.simplefilter("error")
        yield


@pytest.mark.parametrize("ratio", RATIOS.values(), ids=RATIOS)
@pytest.mark.parametrize("x", OBJECTS.values(), ids=OBJECTS)
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
