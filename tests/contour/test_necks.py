"""Narrow places of shapes whose widths are known by construction."""

from __future__ import annotations

from math import cos, pi, sin, sqrt

import pytest

from tactcad.contour import Arc, Contour, Corner, Line, chain, circle, rectangle, rounded_polygon
from tactcad.contour.necks import necks


def widths(within: str, outer: Contour, *openings: Contour, below: float = float("inf")) -> list[float]:
    return [n.width for n in necks(outer, openings, below) if n.within == within]


def slotted(width: float, radius: float) -> Contour:
    """A 20 x 8 block with a slot from above, 2.5 mm of material below it."""
    half = width / 2
    points = [
        (0, 0, 0),
        (20, 0, 0),
        (20, 8, 0),
        (10 + half, 8, 0),
        (10 + half, 2.5, radius),
        (10 - half, 2.5, radius),
        (10 - half, 8, 0),
        (0, 8, 0),
    ]
    return rounded_polygon([Corner((x, y), r) for x, y, r in points])


def turned(contour: Contour, angle: float) -> Contour:
    c, s = cos(angle), sin(angle)
    return chain([(c * x - s * y, s * x + c * y) for x, y in (piece.start for piece in contour)])


@pytest.mark.parametrize("width, radius", [(0.4, 0.0), (0.4, 0.1), (0.4, 0.2), (1.0, 0.3), (3.0, 0.3)])
def test_a_slot_and_the_web_below_it(width, radius):
    found = necks(slotted(width, radius))
    assert {round(n.width, 12) for n in found if n.within == "void"} == {width}
    assert min(n.width for n in found if n.within == "material") == pytest.approx(2.5)


def test_a_fillet_is_no_neck():
    """The ends of two walls stand r sqrt 2 apart across their fillet, and that is no slot."""
    corner = [(0, 0, 0), (9, 0, 0), (9, 2, 0), (2, 2, 0.2), (2, 9, 0), (0, 9, 0)]
    assert widths("void", rounded_polygon([Corner((x, y), r) for x, y, r in corner])) == []


def test_convex_shapes_have_no_void():
    for shape in (rectangle(0, 0, 3, 1), circle((0, 0), 4), chain([(0, 0), (4, 0), (0, 3)])):
        assert widths("void", shape) == []


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.1, pi / 2])
def test_a_rectangle_turned_by_any_angle(angle):
    found = necks(turned(rectangle(0, 0, 3, 1), angle))
    assert {round(n.width, 9) for n in found if n.within == "material"} == {1.0, 3.0}


def test_webs_between_holes_and_edges():
    found = widths("material", rectangle(0, 0, 20, 10), circle((4, 3), 2), circle((8, 3), 3), below=2.5)
    assert sorted(round(w, 9) for w in found) == [1.5, 1.5, 2.0]
    assert min(
        widths("void", rectangle(0, 0, 20, 10), circle((4, 3), 2), circle((8, 3), 3))
    ) == pytest.approx(2.0)


def test_a_corner_that_points_at_a_wall():
    """A notch whose 90 degree inside corner stands 1 mm over the lower edge."""
    notched = chain([(0, 0), (10, 0), (10, 5), (9, 5), (5, 1), (1, 5), (0, 5)])
    assert min(widths("material", notched)) == pytest.approx(1.0)


def test_two_corners_that_point_at_each_other():
    waist = chain([(0, 0), (4, 3), (8, 0), (8, 8), (4, 4), (0, 8)])
    assert min(widths("material", waist)) == pytest.approx(1.0)


def test_what_something_else_crosses_is_no_neck():
    """A hole stands between the long edges: no neck of the full width runs through it."""
    found = necks(rectangle(0, 0, 2, 6), [rectangle(0.5, 1, 1.5, 5)])
    assert [round(n.width, 9) for n in found if n.within == "material"][:2] == [0.5, 0.5]
    assert all(n.p[1] <= 1 or n.p[1] >= 5 for n in found if n.within == "material" and n.width > 1.5)


def test_rings_and_discs():
    ring = widths("material", circle((0, 0), 10), circle((0, 0), 7))
    assert min(ring) == pytest.approx(1.5)
    assert min(widths("void", circle((0, 0), 10), circle((0, 0), 7))) == pytest.approx(7)
    assert widths("material", circle((3, 4), 2.5)) == [pytest.approx(2.5)]


def test_a_curved_wall_with_square_ends():
    """A quarter of a ring: all its corners are sharp, and it is 0.4 thick."""
    inner, outer = 5.0, 5.4
    quarter = Contour(
        (
            Line((inner, 0.0), (outer, 0.0)),
            Arc((outer, 0.0), (0.0, outer), (0.0, 0.0), True),
            Line((0.0, outer), (0.0, inner)),
            Arc((0.0, inner), (inner, 0.0), (0.0, 0.0), False),
        )
    )
    assert min(widths("material", quarter)) == pytest.approx(0.4)


def test_the_direction_of_the_chain_does_not_matter():
    shape, hole = slotted(0.6, 0.2), circle((3, 4), 1)
    forth = [(round(n.width, 9), n.within) for n in necks(shape, [hole])]
    back = [(round(n.width, 9), n.within) for n in necks(shape.reversed(), [hole.reversed()])]
    assert sorted(forth) == sorted(back)


def test_against_dense_points():
    """Narrowest web between a slanted notch and an arc-shaped hole, by brute force."""
    outer = chain([(0, 0), (12, 0), (12, 9), (8, 9), (5.3, 4.1), (4, 9), (0, 9)])
    hole = circle((5, 2), 2.2)
    floor = [s.at(i / 300) for s in outer for i in range(300)]
    brute = min(sqrt((x - 5) ** 2 + (y - 2) ** 2) - 1.1 for x, y in floor)
    assert min(widths("material", outer, hole)) == pytest.approx(brute, abs=1e-3)


def test_names_say_where():
    outer = Contour(
        tuple(
            Line(s.start, s.end, name)
            for s, name in zip(rectangle(0, 0, 8, 0.5), ("below", "right", "above", "left"))
        )
    )
    narrowest = necks(outer)[0]
    assert set(narrowest.names) == {"below", "above"}
    assert narrowest.middle[1] == 0.25
