"""Equations (1) to (3) against 50 digits of mpmath, over extreme ranges, and their named limits."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator

import mpmath as mp
import numpy as np
import pytest

from tactcad.mechanics import lumped

EPS = np.finfo(float).eps
K_M = (1e-9, 8e-3, 1.0, 8.0, 40.12, 8e3)  # N/mm, also as if given in kN/mm and N/m
RATIOS = (1 + 1e-12, 1 + 1e-6, 2.0034895314057826, 10.0, 1e12)  # K_r/K_m; one is the paper's 80.38/40.12
OBJECTS = (0.0, 1e-12, 1e-6, 1e-3, 0.3, 1.0, 17.0, 1e3, 1e6, 1e12, np.inf)  # K_obj/K_m

EXACT: dict[str, Callable] = {
    "deflection_ratio": lambda r, m, x: (r + x) / (m + x),
    "ratio_excess": lambda r, m, x: (r - m) / (m + x),
    "condition_in_ratio": lambda r, m, x: -(r + x) * (m + x) / (x * (r - m)),
    "condition_in_reference": lambda r, m, x: r * (m + x) / (x * (r - m)),
    "condition_in_measuring": lambda r, m, x: -m * (r + x) / (x * (r - m)),
}


@pytest.fixture(autouse=True)
def fifty_digits():
    with mp.workdps(50):
        yield


def pairs_and_objects() -> Iterator[tuple[float, float, float]]:
    """K_r, K_m and K_obj, N/mm."""
    for m, ratio, x in itertools.product(K_M, RATIOS, OBJECTS):
        yield m * ratio, m, m * x


def exact(f: Callable, *values: float) -> mp.mpf:
    """f of the numbers as they are; at infinity its limit, by a number beyond which 50 digits see no
    change."""
    return f(*(mp.mpf(10) ** 200 if np.isinf(v) else mp.mpf(float(v)) for v in values))


def near(found: float, truth: mp.mpf, roundings: int = 10) -> bool:
    return abs(mp.mpf(float(found)) - truth) <= roundings * EPS * abs(truth) + mp.mpf(10) ** -150


def relative_condition(f: Callable, values: list[mp.mpf]) -> float:
    """Sum of |x_i df/dx_i / f|: how many times its inputs' rounding a result may carry."""
    at, total = f(*values), mp.mpf(0)
    for i, x in enumerate(values):
        step = x * mp.mpf(10) ** -20
        moved = [*values[:i], x + step, *values[i + 1 :]]
        total += abs((f(*moved) - at) / step * x / at)
    return float(total)


def test_all_forms_keep_their_digits_from_no_object_to_a_rigid_one():
    wrong = []
    for name, f in EXACT.items():
        for r, m, x in pairs_and_objects():
            if "condition" in name and (x == 0.0 or (np.isinf(x) and name == "condition_in_ratio")):
                good = np.isinf(getattr(lumped, name)(r, m, x))  # nothing of the object can be told there
            else:
                good = near(getattr(lumped, name)(r, m, x), exact(f, r, m, x))
            wrong += [] if good else [(name, r, m, x)]
    assert wrong == []


def test_the_object_takes_its_share_of_the_approach():
    share = lambda k, x: mp.mpf(0.1) * x / (k + x)  # noqa: E731
    wrong = [
        (K, x)
        for r, m, x in pairs_and_objects()
        for K in (r, m)
        if not near(lumped.element_deflection(K, x, 0.1), exact(share, K, x))
    ]
    assert wrong == []
    assert lumped.element_deflection(8.0, 1e-300, 1.0) == pytest.approx(1.25e-301, rel=1e-12)
    assert lumped.element_deflection(8.0, np.inf, 0.15) == 0.15


def test_object_stiffness_errs_by_its_condition_in_the_ratio_and_no_more():
    solve = lambda r, m, q: (r - q * m) / (q - 1)  # noqa: E731
    wrong = []
    for r, m, x in pairs_and_objects():
        R = float(lumped.deflection_ratio(r, m, x))
        got = float(lumped.object_stiffness(r, m, R))
        if R == 1.0:
            good = np.isinf(got)
        else:
            values = [mp.mpf(v) for v in (r, m, R)]
            truth = solve(*values)
            good = got == truth or near(got, truth, 4 * (1 + relative_condition(solve, values)))
        wrong += [] if good else [(r, m, x)]
    assert wrong == []


def test_ratio_goes_from_that_of_the_stiffnesses_to_one():
    assert lumped.deflection_ratio(80.0, 8.0, 0.0) == 10.0
    assert lumped.deflection_ratio(80.0, 8.0, np.inf) == 1.0


def test_two_equal_elements_tell_nothing_about_the_object():
    excess = lumped.ratio_excess(np.nextafter(8.0, 9.0), 8.0, 2.0)
    assert 0.0 < excess < 2e-16
    assert abs(lumped.condition_in_ratio(np.nextafter(8.0, 9.0), 8.0, 2.0)) > 1e15
    assert np.isinf(lumped.condition_in_ratio(8.0, 8.0, 2.0))
    assert np.isnan(lumped.object_stiffness(8.0, 8.0, 1.0))
    assert lumped.object_stiffness(80.0, 8.0, 1.0) == np.inf


def test_conditions_are_the_logarithmic_derivatives_and_those_in_k_add_up_to_one():
    K_r, K_m, x = mp.mpf(80), mp.mpf(12), mp.mpf(5)
    values = [K_r, K_m, (K_r + x) / (K_m + x)]
    solve = lambda r, m, q: (r - q * m) / (q - 1)  # noqa: E731
    for i, name in enumerate(("condition_in_reference", "condition_in_measuring", "condition_in_ratio")):
        along = lambda v, i=i: solve(*values[:i], v, *values[i + 1 :])  # noqa: E731
        slope = mp.diff(along, values[i]) * values[i] / x
        assert float(getattr(lumped, name)(80.0, 12.0, 5.0)) == pytest.approx(float(slope), rel=1e-12)
    total = lumped.condition_in_reference(80.0, 12.0, 5.0) + lumped.condition_in_measuring(80.0, 12.0, 5.0)
    assert total == pytest.approx(1.0, rel=1e-14)


def test_condition_in_the_ratio_is_least_at_the_geometric_mean():
    """(sqrt q + 1)/(sqrt q - 1), q = K_r/K_m, at K_obj = sqrt(K_r K_m)."""
    least = (np.sqrt(10) + 1) / (np.sqrt(10) - 1)
    assert abs(lumped.condition_in_ratio(10.0, 1.0, np.sqrt(10.0))) == pytest.approx(least)
    others = np.abs(lumped.condition_in_ratio(10.0, 1.0, np.geomspace(0.01, 1000, 2001)))
    assert others.min() >= least * (1 - 1e-12)
