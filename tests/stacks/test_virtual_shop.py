"""The virtual shop: what it makes lies within limits, spread as it says, with one offset a batch."""

import numpy as np
import pytest

from tactcad.scenes.requirement import DimensionLimits, variable
from tactcad.stacks.variables import OFFSET_SHARE, made

WIDE = {
    "a": variable("a", -0.02, 0.01, 6),
    "b": DimensionLimits("b", np.array([0.0, -1.0]), np.array([0.0, 3.0])),
}


@pytest.mark.parametrize("distribution", ["normal", "uniform", "corners"])
def test_every_part_is_within_its_limits(distribution):
    out = made(WIDE, 5000, distribution, np.random.default_rng(1))
    for name, v in WIDE.items():
        assert out[name].shape == (5000, v.pieces)
        assert (out[name] >= v.lower - 1e-12).all() and (out[name] <= v.upper + 1e-12).all()


def test_normal_parts_have_their_limits_at_two_sigma():
    """A normal distribution cut at +-2 sigma: standard deviation 0.8796 sigma, 71.5 % within one sigma."""
    x = made({"x": variable("x", -2.0, 2.0)}, 200_000, "normal", np.random.default_rng(2))["x"].ravel()
    assert x.std() == pytest.approx(0.87963, abs=0.004)
    assert (abs(x) < 1.0).mean() == pytest.approx(0.682689 / 0.954500, abs=0.004)


def test_uniform_and_corner_parts():
    rng = np.random.default_rng(3)
    x = made({"x": variable("x", -1.0, 1.0)}, 100_000, "uniform", rng)["x"]
    assert np.quantile(x, [0.1, 0.5, 0.9]) == pytest.approx([-0.8, 0.0, 0.8], abs=0.01)
    assert set(np.unique(made(WIDE, 100, "corners", rng)["a"].round(9))) == {-0.02, 0.01}


def test_pieces_of_one_array_share_the_machines_offset():
    x = made({"x": variable("x", -1.0, 1.0, 2)}, 100_000, "normal", np.random.default_rng(4))["x"]
    assert np.corrcoef(x.T)[0, 1] == pytest.approx(OFFSET_SHARE, abs=0.03)
    alone = made(
        {"x": variable("x", -1.0, 1.0, 2)}, 100_000, "normal", np.random.default_rng(4), alike=False
    )["x"]
    assert abs(np.corrcoef(alone.T)[0, 1]) < 0.01


def test_only_what_is_asked_for_differs():
    out = made(WIDE, 10, "uniform", np.random.default_rng(5), only=("b",))
    assert (out["a"] == -0.005).all() and np.ptp(out["b"][:, 1]) > 0.1
