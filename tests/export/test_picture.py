"""Pictures: hidden lines are hidden, extents are the descriptions', bytes do not depend on the order of
shapes."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from math import hypot, pi

import numpy as np
import pytest
from built import shape_of, shapes_of
from variants import variant

from tactcad.contour import circle, rectangle
from tactcad.design.messages import CheckFailure
from tactcad.drawing.engine import picture
from tactcad.drawing.engine.picture import VIEWS, Drawing, check_picture, drawing, svg
from tactcad.parts.language.description import Extrusion, Hole, Material, Part
from tactcad.scenes import make_scene
from tactcad.scenes.scene import Placement
from tactcad.solids.occt import placed_shape

pytestmark = pytest.mark.cad

STEEL = Material("steel", 7850.0)
FRONT, SIDE = VIEWS["front"], VIEWS["side"]


def block(x, y, z, *holes) -> Part:
    return Part(f"B{x}-{y}-{z}", "b", "milled", STEEL, Extrusion(rectangle(0, 0, x, y), z), holes)


def shown(placements, view) -> tuple[Drawing, bytes]:
    shapes = [placed_shape(shape_of(p.part), p.origin, p.rotation) for p in placements]
    drawn = drawing(shapes, view)
    return drawn, svg(drawn, "t", "d")


def length(lines) -> float:
    return sum(hypot(b[0] - a[0], b[1] - a[1]) for line in lines for a, b in zip(line, line[1:]))


def test_a_block_from_the_front_is_its_rectangle():
    drawn, _ = shown([Placement("A", block(10, 6, 4))], FRONT)
    assert drawn.box == (0.0, 0.0, 10.0, 4.0)
    assert length(drawn.sharp) == pytest.approx(2 * (10 + 4))


def test_what_is_behind_is_hidden():
    front, behind = Placement("A", block(10, 6, 4)), Placement("B", block(2, 2, 2), (4, 10, 1))
    alone, _ = shown([front], FRONT)
    both, _ = shown([front, behind], FRONT)
    assert both == alone
    half, _ = shown([front, Placement("B", block(2, 2, 2), (9, 10, 1))], FRONT)  # half of it stands out
    assert length(half.sharp) == pytest.approx(28 + 1 + 2 + 1)


def test_a_bore_shows_from_its_own_side_only():
    part = block(10, 6, 4, Hole("bore", (5, 3, 0), (0, 0, 1), 2.0, 4, True))
    drawn, _ = shown([Placement("A", part)], SIDE)
    assert length(drawn.sharp) == pytest.approx(2 * (10 + 6) + 2 * pi, rel=1e-3)
    assert length(shown([Placement("A", part)], FRONT)[0].sharp) == pytest.approx(28)


def test_curves_are_drawn_to_a_hundredth():
    drawn, _ = shown(
        [Placement("A", Part("R", "r", "turned", STEEL, Extrusion(circle((0, 0), 20), 3)))], SIDE
    )
    points = [p for line in drawn.sharp for p in line]
    assert all(abs(hypot(*p) - 10) < 1e-3 for p in points)
    middles = [((a[0] + b[0]) / 2, (a[1] + b[1]) / 2) for line in drawn.sharp for a, b in zip(line, line[1:])]
    assert all(10 - hypot(*m) < 0.012 for m in middles)


@pytest.mark.parametrize("view", VIEWS.values(), ids=VIEWS)
def test_views_look_along_right_handed_axes(view):
    x, y, z = view.right, view.up, view.eye
    assert hypot(*x) == pytest.approx(1)
    assert sum(a * b for a, b in zip(x, z)) == pytest.approx(0, abs=1e-12)
    up = (z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0])
    assert sum(a * b for a, b in zip(up, y)) > 0, "what is up is up in the picture"


def test_the_order_of_shapes_does_not_matter():
    placements = [
        Placement("A", block(10, 6, 4)),
        Placement("B", block(3, 2, 9), (3, -4, 1)),
        Placement("C", block(1, 1, 1), (20, 0, 0)),
    ]
    assert shown(placements, VIEWS["above"])[1] == shown(placements[::-1], VIEWS["above"])[1]


def test_the_file_is_xml_at_one_to_one_or_a_whole_enlargement():
    drawn, data = shown([Placement("A", block(10, 6, 4))], FRONT)
    root = ET.fromstring(svg(drawn, "a < b & 'c' \"d\" \u00e9", "d"))
    assert root[0].text == "a < b & 'c' \"d\" \u00e9"
    x, y, width, height = map(float, root.get("viewBox").split())
    assert (width, height) == (10 + 2 * picture.MARGIN, 4 + 2 * picture.MARGIN)
    scale = float(root.get("width").removesuffix("mm")) / width
    assert scale == pytest.approx(round(scale)) and scale >= 1
    wide, _ = shown([Placement("A", block(300, 6, 4))], FRONT)
    root = ET.fromstring(svg(wide, "t", "d"))
    assert float(root.get("width").removesuffix("mm")) == float(root.get("viewBox").split()[2])


def test_a_picture_of_something_else_is_not_let_out():
    placements = [Placement("A", block(10, 6, 4))]
    for view in VIEWS.values():
        check_picture(shown(placements, view)[1], placements, view)
    _, other = shown([Placement("A", block(10.1, 6, 4))], FRONT)
    with pytest.raises(CheckFailure, match="width"):
        check_picture(other, placements, FRONT)
    _, other = shown([Placement("A", block(10, 6, 4.1))], FRONT)
    with pytest.raises(CheckFailure, match="height"):
        check_picture(other, placements, FRONT)
    with pytest.raises(CheckFailure, match="nothing"):
        check_picture(re.sub(rb' d="[^"]*"', b' d=""', other), placements, FRONT)


def test_exact_and_triangle_removal_agree(monkeypatch):
    """Long arrays are drawn on triangles: the same extent, and the same length of lines within a percent."""
    scene = make_scene(variant({"array.row_arms": [[4]]}), "array")
    shapes = shapes_of(scene)
    placed = [placed_shape(shapes[p.part.part_no], p.origin, p.rotation) for p in scene.placements]
    exact = drawing(placed, VIEWS["above"])
    monkeypatch.setattr(picture, "EXACT_UP_TO", 0)
    rough = drawing(placed, VIEWS["above"])
    assert rough.box == pytest.approx(exact.box, abs=0.02)
    assert length(rough.sharp) == pytest.approx(length(exact.sharp), rel=0.02)


def test_windows_draw_what_one_window_draws(monkeypatch):
    """A long picture is drawn strip by strip: the same lines, but for where they are cut."""
    scene = make_scene(variant({"array.row_arms": [[4] * 12]}), "array")
    shapes = shapes_of(scene)
    placed = [placed_shape(shapes[p.part.part_no], p.origin, p.rotation) for p in scene.placements]
    monkeypatch.setattr(picture, "EXACT_UP_TO", 0)
    whole = drawing(placed, VIEWS["below"])
    monkeypatch.setattr(picture, "PER_WINDOW", 15)
    strips = drawing(placed, VIEWS["below"])
    assert len(strips.sharp) > len(whole.sharp), "some lines are cut"
    assert strips.box == whole.box
    for mine, other in ((strips.sharp, whole.sharp), (strips.smooth, whole.smooth)):
        assert length(mine) == pytest.approx(length(other), rel=1e-4)


def test_pieces_between_borders_make_the_line_again():
    """Random lines, cut at random borders: every piece lies inside, and no length is lost or doubled."""
    random = np.random.default_rng(1)
    for axis in (0, 1):
        line = tuple(map(tuple, np.round(random.uniform(-10, 10, (60, 2)), 3)))
        borders = [-np.inf, *(np.sort(np.round(random.uniform(-9, 9, 5), 3)) + picture.OFF_GRID), np.inf]
        pieces = []
        for left, right in zip(borders, borders[1:]):
            inside = list(picture.between_borders(line, axis, left, right))
            assert all(left - 1e-3 < p[axis] < right + 1e-3 for piece in inside for p in piece)
            pieces += inside
        assert length(pieces) == pytest.approx(length([line]), abs=0.002 * len(pieces))
        assert len(pieces) > 60
