"""Bearings and O-rings against bd_warehouse's tables, and against their own closed forms."""

from __future__ import annotations

import csv
from importlib.util import find_spec
from math import pi
from pathlib import Path

import pytest

from tactcad.parts.bought import standard_parts
from tactcad.parts.bought.screws import CAP_SCREW_LENGTHS
from tactcad.parts.bought.standard_parts import BEARINGS, bearing
from tactcad.parts.language.metric import METRIC
from tactcad.solids.build import build
from tactcad.solids.measure import bounding_box, volume


def rows(name: str) -> list[dict[str, str]]:
    folder = Path(find_spec("bd_warehouse").origin).parent / "data"
    with (folder / name).open(encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


@pytest.mark.parametrize("size", ["623-2Z", "624-2Z"])
def test_bearings_are_those_of_the_makers_list(size):
    (row,) = (
        r
        for r in rows("single_row_capped_deep_groove_ball_bearing_parameters.csv")
        if r["SKT:Designation"].strip("* ") == size
    )
    ours = BEARINGS[size]
    assert (ours.d, ours.D, ours.B) == tuple(float(row[f"SKT:{k}"]) for k in ("d", "D", "B"))
    assert ours.inner == float(row["SKT:d1"])
    assert ours.mass == pytest.approx(1e3 * float(row["SKT:mass"]))


@pytest.mark.parametrize("size", BEARINGS)
def test_a_bearing_is_a_ring_of_its_dimensions(size):
    b, part = BEARINGS[size], bearing(size)
    assert volume(build(part)) == pytest.approx(pi / 4 * (b.D**2 - b.d**2) * b.B, rel=1e-9)
    assert b.d < b.inner < b.D
    assert f"M{b.d:g}" in METRIC  # its axle is a standard screw


def test_the_estimate_of_the_inner_shoulder_keeps_to_the_known_ones():
    for b in (BEARINGS["623-2Z"], BEARINGS["624-2Z"]):
        assert b.d + 0.3 * (b.D - b.d) == pytest.approx(b.inner, abs=0.11)


def test_o_rings_are_those_of_the_standard():
    known = {r["Size"]: r for r in rows("o-ring_parameters.csv")}
    for code, inside in standard_parts.INSIDE.items():
        assert (inside, standard_parts.SECTION) == (
            float(known[code]["iso3601:id"]),
            float(known[code]["iso3601:w"]),
        ), code


def test_the_groove_is_that_of_a_static_face_seal():
    (gland,) = (
        r for r in rows("o-ring_static_gland_parameters.csv") if float(r["w"]) == standard_parts.SECTION
    )
    assert float(gland["d_a_min"]) <= standard_parts.GROOVE_DEPTH <= float(gland["d_a_max"])
    assert standard_parts.GROOVE_WIDTH == pytest.approx(float(gland["g_w_0"]), abs=0.02)
    low, high = float(gland["sq_a_p_min"]) / 100, float(gland["sq_a_p_max"]) / 100
    assert low <= 1 - standard_parts.GROOVE_DEPTH / standard_parts.SECTION <= high


@pytest.mark.parametrize("code", ["010", "025", "040"])
def test_a_squeezed_ring_keeps_its_rubber_and_fits_its_groove(code):
    inside, w = standard_parts.INSIDE[code], standard_parts.SECTION
    torus = pi * w**2 / 4 * pi * (inside + w)
    solid = build(standard_parts.o_ring(code))
    assert volume(solid) == pytest.approx(torus, rel=1e-9)
    low, high = bounding_box(solid)
    inner, outer = standard_parts.groove(code)
    assert high[2] - low[2] == pytest.approx(standard_parts.GROOVE_DEPTH)
    assert high[0] < outer / 2
    assert inner == inside


def test_the_smallest_ring_that_reaches_around_is_taken():
    assert standard_parts.size_around(29.7) == "025"
    assert standard_parts.size_around(29.87) == "025"
    assert standard_parts.size_around(29.88) == "026"
    assert standard_parts.size_around(100.0) is None


def test_axles_have_a_plain_shank_under_the_bearing():
    """ISO 4762: a screw has 2 d + 12 of thread; shorter ones are threaded to the head."""
    from variants import variant

    from tactcad.parts.rigs.cart import cart_layout

    for size, b in BEARINGS.items():
        rig = cart_layout(variant({"cart.bearing": size, "cart.shim": 0.3}))
        shank = rig.axle_length - (2 * b.d + 12)
        assert shank >= 0.3 + b.B
        shorter = [n for n in CAP_SCREW_LENGTHS[rig.axle_thread] if n < rig.axle_length]
        assert all(n - (2 * b.d + 12) < 0.3 + b.B for n in shorter)
