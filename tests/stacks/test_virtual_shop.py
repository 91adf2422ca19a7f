"""The virtual shop: what it makes lies within limits, spread as it says, with one offset a batch."""

import numpy as np
import pytest
from parallel_curve import offset

from tactcad.parts.array.element import WIRE, element
from tactcad.parts.array.layout import Layout
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


def sizes_of(outer, hole):
    """Of an element's contour and dowel hole, by limit: from its lines and arcs."""
    at = {s.name: s for s in reversed(outer.segments)}
    z = {name: s.start[1] for name, s in at.items()}
    x = {name: s.start[0] for name, s in at.items()}
    (xd, zd), r = hole.as_circle()
    return {
        "hinge thickness": z["slot_floor"] - z["flat_face"],
        "pad height over the dowel hole's centre": zd - z["pad_face"],
        "stop gap": z["ledge"] - z["stop_land"],
        "ledge over the pad face": z["ledge"] - z["pad_face"],
        "slot length": x["slot_body_wall"] - x["slot_arm_wall"],
        "arm length": (x["slot_body_wall"] + x["slot_arm_wall"]) / 2 - x["tip"],
        "pad length": x["pad_side"] - x["tip"],
        "arm height": z["arm_back"] - z["flat_face"],
        "fillet radius": at["slot_arm_fillet"].radius,
        "tip from dowel hole": xd - x["tip"],
        "dowel hole diameter": 2 * r,
    }


def test_one_offset_of_the_wire_moves_every_size_as_a_parallel_curve_does(macro):
    """Contour 2 um out, holes 2 um in."""
    layout = Layout(macro)
    body = element(layout, layout.elements[0]).extrusion
    hole = next(o for o in body.openings if o.segments[0].name == "dowel_hole")
    drawn, moved = sizes_of(body.outer, hole), sizes_of(offset(body.outer, 0.002), offset(hole, -0.002))
    for name, size in drawn.items():
        assert (moved[name] - size) / 0.002 == pytest.approx(WIRE.get(name, 0), abs=1e-6), name


def test_sizes_of_a_piece_share_the_wires_offset_in_mm():
    """Of b, twice as wide, a quarter of the variance is the wire's, the other way; c is not cut by it. What
    pieces share stays."""

    def limits(name, half, wire):
        return DimensionLimits(name, np.full(2, -half), np.full(2, half), wire=wire)

    v = {v.name: v for v in (limits("a", 0.004, 2), limits("b", 0.004, -1), limits("c", 0.004, 0))}
    x = made(v, 100_000, "normal", np.random.default_rng(4))
    one = np.corrcoef(np.hstack([x["a"], x["b"], x["c"]]).T)
    assert one[0, 2] == pytest.approx(-0.5 * 0.5, abs=0.02)
    assert one[0, 3] == pytest.approx(-0.5 * 0.5 * OFFSET_SHARE, abs=0.02)
    assert [one[0, 1], one[2, 3]] == pytest.approx([OFFSET_SHARE, OFFSET_SHARE], abs=0.03)
    assert np.abs(one[4:, :4]).max() < 0.02
    assert [x[name].std() for name in v] == pytest.approx([0.87963 * 0.002] * 3, rel=0.01)
    apart = made(v, 100_000, "normal", np.random.default_rng(4), alike=False)
    assert abs(np.corrcoef(apart["a"][:, 0], apart["b"][:, 0])[0, 1]) < 0.02
