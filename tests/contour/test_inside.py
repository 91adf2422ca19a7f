"""Inside and outside, against a polygon of many corners and the known geometry of simple shapes."""

from __future__ import annotations

import random
from math import sqrt

import pytest

from tactcad.contour import Arc, Contour, Corner, Line, chain, circle, rectangle, rounded_polygon
from tactcad.contour.inside import clearance, encloses, place_for_circle, side

MOON = Contour((Line((0.0, 0.0), (4.0, 0.0)), Arc((4.0, 0.0), (0.0, 0.0), (2.0, 0.0), True)))
BITE = Contour(  # a square with a bite of more than half a circle
    (
        Line((0.0, 0.0), (6.0, 0.0)),
        Line((6.0, 0.0), (6.0, 6.0)),
        Line((6.0, 6.0), (4.0, 6.0)),
        Arc((4.0, 6.0), (2.0, 6.0), (3.0, 4.5), False),
        Line((2.0, 6.0), (0.0, 6.0)),
        Line((0.0, 6.0), (0.0, 0.0)),
    )
)
SLOT = rounded_polygon(
    [
        Corner(p, r)
        for p, r in [
            ((0, 0), 0.3),
            ((7, 0), 0),
            ((7, 8), 0.7),
            ((3, 8), 0),
            ((3, 4), 0.5),
            ((2, 4), 0.5),
            ((2, 8), 0),
            ((0, 8), 0),
        ]
    ]
)
SHAPES = {"disc": circle((3, 3), 5), "moon": MOON, "bite": BITE, "slot": SLOT}


def in_polygon(corners: list, p) -> bool:
    """Ray casting to the right."""
    inside = False
    for a, b in zip(corners, corners[1:] + corners[:1]):
        if (a[1] > p[1]) != (b[1] > p[1]) and p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]):
            inside = not inside
    return inside


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("backwards", [False, True])
def test_against_a_polygon_of_many_corners(name, backwards):
    shape = SHAPES[name].reversed() if backwards else SHAPES[name]
    corners = [s.at(i / 200) for s in shape for i in range(200)]
    points = random.Random(1)
    tried = 0
    while tried < 300:
        p = (points.uniform(-1, 9), points.uniform(-3, 9))
        if abs(clearance(shape, p)) < 1e-3:  # the polygon's own error
            continue
        assert side(shape, p) == (1 if in_polygon(corners, p) else -1), p
        tried += 1


@pytest.mark.parametrize(
    "shape, p, expected",
    [
        (circle((0, 0), 2), (0, 0), 1),
        (circle((0, 0), 2), (0.999, 0), 1),
        (circle((0, 0), 2), (1.001, 0), -1),
        (circle((0, 0), 2), (0.6, 0.8), 0),
        (MOON, (2, 0), 0),
        (MOON, (2, 1e-6), 1),
        (MOON, (2, -1e-6), -1),
        (MOON, (5, 0), -1),
        (BITE, (3, 5.9), -1),
        (BITE, (3, 4.5), -1),
        (BITE, (3, 2), 1),
        (rectangle(0, 0, 3, 1), (3, 1), 0),
    ],
)
def test_known_places(shape, p, expected):
    assert side(shape, p) == expected
    assert side(shape.reversed(), p) == expected


@pytest.mark.parametrize(
    "inner, expected",
    [
        (circle((1.5, 0.5), 0.9), True),
        (circle((1.5, 0.5), 1.0), False),  # touches
        (circle((1.5, 0.5), 1.1), False),
        (circle((9, 9), 0.5), False),
        (rectangle(-1, -1, 4, 2), False),
    ],
)
def test_contour_inside_contour(inner, expected):
    assert encloses(rectangle(0, 0, 3, 1), inner) == expected


def test_clearance():
    assert clearance(rectangle(0, 0, 3, 1), (1, 0.25)) == 0.25
    assert clearance(circle((0, 0), 2), (0.25, 0)) == pytest.approx(0.75)
    assert clearance(rectangle(0, 0, 3, 1), (4, 2)) == pytest.approx(-sqrt(2))


TRIANGLE = chain([(0, 0), (4, 0), (0, 3)])  # 3-4-5: inscribed circle of radius 1
RAISED = Contour((Arc((4.0, 0.0), (0.0, 0.0), (2.0, 1.0), True), Line((0.0, 0.0), (4.0, 0.0))))


@pytest.mark.parametrize(
    "shape, largest",
    [
        (rectangle(0, 0, 3, 1), 1.0),
        (circle((5, 5), 0.8), 0.8),
        (MOON, 2.0),
        (TRIANGLE, 2.0),
        (RAISED, 1 + sqrt(5)),
        (
            chain([(0, 0), (9, 0), (9, 1), (1, 1), (1, 9), (0, 9)]),
            4 - 2 * sqrt(2),
        ),  # an L: its corner is widest
    ],
)
def test_the_largest_circle_that_fits(shape, largest):
    place = place_for_circle(shape, largest - 2e-3)
    assert clearance(shape, place) >= largest / 2 - 1e-3 - 1e-9
    assert place_for_circle(shape, largest + 2e-3) is None
