"""How surely a yield is known, against scipy's own binomial test."""

from __future__ import annotations

import pytest
from scipy.stats import binomtest

from tactcad.costs.grades import COUNTS
from tactcad.stacks.virtual_build import of_share, widest


def test_a_shares_interval_is_clopper_and_pearsons():
    for n, k in ((10, 0), (50, 49), (200, 200), (1000, 730)):
        exact = binomtest(k, n).proportion_ci(0.95, "exact")
        assert of_share(k, n) == pytest.approx((exact.low, exact.high), abs=1e-12)


@pytest.mark.parametrize("count", [1, 2, 7, 100, 501])
def test_no_yield_is_known_less_surely_than_promised(count):
    halves = []
    for k in range(count + 1):
        exact = binomtest(k, count).proportion_ci(0.95, "exact")
        halves.append((exact.high - exact.low) / 2.0)
    assert widest(count) == pytest.approx(max(halves), rel=1e-9)


def test_more_arrays_promise_more():
    halves = [widest(n) for n in COUNTS]
    assert halves == sorted(halves, reverse=True)
    assert halves[-1] == pytest.approx(1.96 * 0.5 / COUNTS[-1] ** 0.5, rel=0.01)  # the normal approximation
