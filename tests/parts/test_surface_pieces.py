"""Where limits stand on a part's surface, by points and sizes worked out by hand."""

from __future__ import annotations

from dataclasses import replace
from math import sqrt

import pytest
from sound_designs import as_table, sound_table
from variants import variant

from tactcad.contour import circle, rectangle
from tactcad.design.load import from_table
from tactcad.design.messages import CheckFailure
from tactcad.parts.array.element import element
from tactcad.parts.array.layout import Layout
from tactcad.parts.language.description import Extrusion, Hole, Material, Part, Pocket
from tactcad.parts.language.limits import FACES, within
from tactcad.parts.language.surface import measured, pieces
from tactcad.parts.rules import broken_rules
from tactcad.scenes import make_scene

SLANTED = (0.0, -sqrt(0.5), sqrt(0.5))
BODY = Extrusion(rectangle(0, 0, 10, 8), 5.0, (circle((5, 4), 3.0, "opening"),))
PLATE = Part(
    "P-1",
    "Plate",
    "milled",
    Material("steel", 7850),
    BODY,
    (
        Hole("bore", (2, 2, 0), (0, 0, 1), 2.0, 5.0, True),
        Hole("bore", (7, 2, 0), (0, 0, 1), 2.0, 5.0, True),
        Hole("slanted", (2, 8, 2), SLANTED, 1.0, 1.0, False),
        Pocket("slot", (8, 6, 5), (0, 0, -1), (0, 1, 0), rectangle(-1, 0, 1, 0.5), 2.0),
    ),
)


@pytest.mark.parametrize(
    ("feature", "on", "off"),
    [
        (FACES[0], [(1, 1, 0)], [(1, 1, 5), (1, 1, 0.01)]),
        (FACES[1], [(1, 1, 5)], [(1, 1, 0)]),
        ("left edge", [(0, 0, 0), (0, 8, 5), (0, 4, 2)], [(0, 4, 5.1), (0, 8.1, 1), (0.1, 4, 1)]),
        ("opening", [(6.5, 4, 1), (5, 2.5, 5)], [(5, 4, 1), (6.5, 4, -0.1)]),
        ("bore", [(3, 2, 1), (7, 3, 4)], [(2, 2, 1), (5, 2, 1)]),
        # half a millimetre deep along the axis, and half across it
        ("slanted", [(1.5, 8 - sqrt(0.125), 2 + sqrt(0.125))], [(2, 8, 2), (1.5, 8 - sqrt(2), 2 + sqrt(2))]),
        # its y axis is (0, 0, -1) x (0, 1, 0) = (1, 0, 0): x from 8 to 8.5, y from 5 to 7
        ("slot", [(8, 6, 4), (8.5, 7, 3), (8.2, 6, 3)], [(8.2, 6, 4), (9, 6, 3), (8, 6, 2)]),
        ("slot left edge", [(8.2, 5, 4)], [(8.2, 7, 4), (8.2, 6, 3)]),
    ],
)
def test_what_lies_on_a_feature(feature, on, off):
    assert feature in PLATE.feature_names
    assert all(any(piece.holds(p) for piece in pieces(PLATE, feature)) for p in on)
    assert not any(piece.holds(p) for piece in pieces(PLATE, feature) for p in off)


@pytest.mark.parametrize(
    ("size", "between", "kind", "counts"),
    [
        (5.0, FACES, "distance", (1, 1)),
        (10.0, ("left edge", "right edge"), "distance", (1, 1)),
        (7.0, ("left edge", "bore"), "distance", (1, 1)),  # of two bores the one that is 7 away
        (2.0, ("lower edge", "bore"), "distance", (1, 2)),
        (5.0, ("bore", "bore"), "distance", (2, 2)),
        (sqrt(13), ("bore", "opening"), "distance", (1, 1)),
        (5.0, ("left edge", "left edge", "right edge"), "distance", (1, 2)),  # to the middle
        (3.0, ("opening",), "diameter", (1, 0)),
        (1.0, ("bore", "bore"), "radius", (4, 0)),
        (2.0, ("slot left edge", "slot right edge"), "distance", (1, 1)),
    ],
)
def test_what_a_dimension_stands_on(size, between, kind, counts):
    on = measured(PLATE, within("size", size, 0.1, between=between))
    assert (on.kind, (len(on.first), len(on.second))) == (kind, counts)


@pytest.mark.parametrize(
    ("size", "between"),
    [
        (5.001, FACES),
        (5.0, ("left edge", "upper edge")),
        (1.0, ("left edge", "slanted")),
        (3.0, ("left edge",)),
    ],
)
def test_a_size_that_is_not_there(size, between):
    with pytest.raises(CheckFailure, match=r"P-1: width of .* has no such size"):
        measured(PLATE, within("width", size, 0.1, between=between))


@pytest.mark.parametrize("sides", ["one", "two"])
@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"element.hinge_length": 0.6},  # full round: both fillets are one arc
        {"element.pad_root_radius": 0.5, "element.pad_height": 0.5},  # the side of the pad is used up
        {"element.arm_height": 0.55, "element.hinge_length": 0.8},  # the slot's wall on the arm is
    ],
)
def test_every_limit_of_an_element_stands_on_its_outline(sides, changes):
    changes = {"element.sides": sides} | changes
    if sides == "two" and "element.arm_height" in changes:
        changes["element.arm_height"] = 0.85
    layout = Layout(variant(changes))
    part = element(layout, layout.elements[0], 0.1)
    for c in part.characteristics:
        assert c.between and set(c.between) <= part.feature_names
        assert measured(part, c).first
    shifted = [replace(c, nominal=c.nominal + 0.001) for c in part.characteristics if len(c.between) > 1]
    for c in shifted:
        with pytest.raises(CheckFailure):
            measured(part, c)


@pytest.mark.parametrize("seed", range(12))
def test_every_limit_of_a_drawn_array_stands_on_its_part(seed):
    """Holes of one size at several places differ by rounding."""
    design = from_table(as_table(sound_table(seed, (3, 2), False)))
    assert not broken_rules(design)
    for part in make_scene(design, "array").parts:
        for c in part.characteristics:
            assert measured(part, c).first, (part.part_no, c.name)
