"""Limits: the standards' codes against printed values, and contradictions that are refused."""

import pytest

from tactcad.contour import rectangle
from tactcad.design.messages import CheckFailure
from tactcad.parts.array.element import element
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.measurements import measurements
from tactcad.parts.language.description import Extrusion, Material, Part
from tactcad.parts.language.limits import Characteristic, DatumFeature, Geometric, deviations, general, within
from tactcad.parts.rules import load

# Micrometres as printed in ISO 286-2:2010, tables 2 to 32.
PRINTED = {
    ("H7", 3): (0, 10),
    ("H7", 25): (0, 21),
    ("H6", 16): (0, 11),
    ("H8", 60): (0, 46),
    ("D10", 3): (20, 60),
    ("F8", 10): (13, 35),
    ("G7", 20): (7, 28),
    ("E9", 40): (50, 112),
    ("N7", 3): (-14, -4),
    ("N7", 5): (-16, -4),
    ("M7", 5): (-12, 0),
    ("K7", 5): (-9, 3),
    ("P7", 20): (-35, -14),
    ("m6", 3): (2, 8),
    ("m6", 5): (4, 12),
    ("k6", 8): (1, 10),
    ("n6", 50): (17, 33),
    ("p6", 30): (22, 35),
    ("g6", 20): (-20, -7),
    ("f7", 12): (-34, -16),
    ("h11", 100): (-220, 0),
    ("js15", 8): (-290, 290),
}


@pytest.mark.parametrize(("code", "size"), PRINTED)
def test_iso_286_agrees_with_printed_limits(code, size):
    assert deviations(code, size) == pytest.approx(tuple(v / 1e3 for v in PRINTED[code, size]), abs=1e-12)


def test_holes_mirror_shafts_at_every_size():
    for size in (1, 5, 9, 15, 25, 45, 70, 110):
        for letter in "defgh":
            low, high = deviations(f"{letter}8", size)
            assert deviations(f"{letter.upper()}8", size) == (-high, -low)


@pytest.mark.parametrize("code", ["", "Z7", "H4", "H99", "to7", "h", "7"])
def test_a_code_that_the_tables_lack_is_refused_with_what_is_legal(code):
    with pytest.raises(ValueError, match="legal"):
        deviations(code, 10)


def test_sizes_beyond_the_tables_are_refused():
    for size in (0.0, -1.0, 121.0):
        with pytest.raises(ValueError, match="legal"):
            deviations("H7", size)


def test_general_tolerances_are_iso_2768s():
    assert [general(v) for v in (2, 5, 13.3, 60, 200)] == [0.1, 0.1, 0.2, 0.3, 0.5]


def part(**limits):
    return Part("block", "Block", "milled", Material("x", 1), Extrusion(rectangle(0, 0, 4, 4), 1.0), **limits)


@pytest.mark.parametrize(
    ("limits", "why"),
    [
        ({"characteristics": (Characteristic("width", 4, 3.9, 4.1),)}, "lower <= upper"),
        ({"characteristics": (within("width", 4, 0.1, between=("nose", "")),)}, "no feature 'nose'"),
        ({"characteristics": (within("width", 4, 0.1),)}, "width: refers to no feature; legal: .*face z=0"),
        ({"datums": (DatumFeature("A", "nose"),)}, "no feature 'nose'"),
        ({"geometric": (Geometric("place", "position", 0.1, ("face z=0",)),)}, "without datum"),
        ({"geometric": (Geometric("flat", "flatness", 0.0, ("face z=0",)),)}, "more than 0"),
        ({"geometric": (Geometric("place", "position", 0.1, ("face z=0",), ("A",)),)}, "no datum A"),
    ],
)
def test_limits_that_contradict_are_refused_with_part_feature_and_what_is_legal(limits, why):
    with pytest.raises(CheckFailure, match=f"block: .*{why}.*"):
        part(**limits)


@pytest.mark.parametrize("name", ["macro-array", "soft-tissue", "double-sample", "smallest-bearing"])
def test_the_inspection_list_says_what_the_sheet_says(name):
    """Every limit of an element's part stands in its list; the load arm's follow from arm and pad, and are
    the budget's."""
    layout = Layout(load(name))
    for place, _, listed in measurements(layout):
        rows = {m.name: m for m in listed}
        own = element(layout, place).characteristics
        assert set(rows) == {c.name for c in own} | {"load arm"}
        for c in own:
            assert (rows[c.name].lower, rows[c.name].upper) == pytest.approx((c.lower, c.upper), abs=1e-6)
        allowed = layout.design.tolerance.load_arm
        assert rows["load arm"].upper == pytest.approx(place.load_arm + allowed, abs=1e-6)
        assert rows["load arm"].lower == pytest.approx(place.load_arm - allowed, abs=1e-6)


def test_ledge_and_pad_are_held_to_each_other():
    """Every element's ledge over its pad has its own limits, so that one plate can lie on all of them."""
    layout = Layout(load("macro-array"))
    for place in layout.elements:
        ledge = next(c for c in element(layout, place).characteristics if c.name.startswith("ledge"))
        assert ledge.nominal == pytest.approx(layout.ledge + layout.design.element.pad_height)
        assert ledge.upper - ledge.lower <= 0.0101
