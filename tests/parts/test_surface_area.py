"""Closed-form surface areas against geometry done by hand, and against the kernel on every part that
ships."""

from __future__ import annotations

from math import pi

import pytest
from built import shape_of
from variants import FACING_ROWS

from tactcad.contour import Arc, Contour, Line, circle, rectangle
from tactcad.parts.language.description import Extrusion, Hole, Material, Part, Pocket, Revolution
from tactcad.parts.language.surface import surface_area
from tactcad.parts.rules import load
from tactcad.scenes import make_scene, scene_names

UP, DOWN, X = (0, 0, 1), (0, 0, -1), (1, 0, 0)


def part(body, *features) -> Part:
    return Part("p", "part", "milled", Material("steel", 7850), body, features)


BLOCK = Extrusion(rectangle(0, 0, 20, 10), 5.0)  # 2 (200 + 100 + 50) = 700


@pytest.mark.parametrize(
    ("features", "area"),
    [
        ((), 700),
        ((Hole("through", (5, 5, 0), UP, 2, 5, True),), 700 - 2 * pi + 10 * pi),
        ((Hole("blind", (5, 5, 5), DOWN, 2, 3, False),), 700 + 6 * pi),
        # cone of 118 degrees on radius 1: its side is pi r s with s = r/sin(59 deg)
        (
            (Hole("drilled", (5, 5, 5), DOWN, 2, 3, False, drill_point=True),),
            700 + 6 * pi + pi / 0.857167300702 - pi,
        ),
        ((Hole("bored", (5, 5, 5), DOWN, 2, 5, True, counterbore=(4, 1)),), 700 + 4 * pi + 8 * pi - 2 * pi),
        ((Pocket("closed", (0, 0, 5), DOWN, X, rectangle(2, -4, 6, -2), 1),), 700 + 12),
        (
            (Pocket("island", (0, 0, 5), DOWN, X, rectangle(2, -8, 8, -2), 1, (rectangle(4, -6, 6, -4),)),),
            700 + 24 + 8,
        ),
        # a step over the block's whole end: three of its sides are open and shorten the stock's own walls
        ((Pocket("step", (0, 0, 5), DOWN, X, rectangle(0, -10, 4, 0), 1),), 700 + 10 - (4 + 10 + 4)),
    ],
    ids=lambda value: value[0].name if isinstance(value, tuple) and value else None,
)
def test_block_with_a_feature(features, area):
    assert surface_area(part(BLOCK, *features)) == pytest.approx(area, rel=1e-9)


def test_turned_bodies():
    cone = Contour((Line((0, 0), (3, 0)), Line((3, 0), (0, 4)), Line((0, 4), (0, 0))))
    assert surface_area(part(Revolution(cone))) == pytest.approx(pi * 9 + pi * 3 * 5)
    ball = Contour((Arc((0, -2), (0, 2), (0, 0), True), Line((0, 2), (0, -2))))
    assert surface_area(part(Revolution(ball))) == pytest.approx(16 * pi)
    ring = Revolution(circle((5, 0), 2))
    assert surface_area(part(ring)) == pytest.approx(4 * pi**2 * 5)
    bowl = Contour(
        (  # a quarter circle turned inwards about (2, 2): centroid of the arc at 2 - 4/pi from the axis
            Line((0, 0), (2, 0)),
            Arc((2, 0), (0, 2), (2, 2), False),
            Line((0, 2), (0, 0)),
        )
    )
    assert surface_area(part(Revolution(bowl))) == pytest.approx(4 * pi + 2 * pi * (2 - 4 / pi) * pi)


def test_a_part_with_openings():
    body = Extrusion(rectangle(-5, -5, 5, 5), 2.0, (circle((0, 0), 4),))
    assert surface_area(part(body)) == pytest.approx(2 * (100 - 4 * pi) + 2 * (40 + 4 * pi))


@pytest.mark.by_day(1, "the kernel on a whole design each")
@pytest.mark.cad
@pytest.mark.parametrize("name", [*FACING_ROWS, "jaw-array"])
def test_the_kernel_measures_the_same_on_every_part(name):
    from tactcad.solids.measure import measure

    design = load(name)
    for scene in scene_names(design):
        for p in make_scene(design, scene).parts:
            assert surface_area(p) == pytest.approx(measure(shape_of(p))["area"], rel=1e-8), p.part_no
