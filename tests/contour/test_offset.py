"""Parallel curves against Steiner's formulas: area + length d + pi d2, length + 2 pi d."""

from __future__ import annotations

from math import pi

import pytest
from parallel_curve import offset

from tactcad.contour import Corner, chain, circle, rectangle, rounded_polygon
from tactcad.contour.inside import clearance

L_SHAPE = chain([(0, 0), (9, 0), (9, 1), (1, 1), (1, 9), (0, 9)])
SLOT = rounded_polygon(
    [
        Corner(p, r)
        for p, r in [
            ((0, 0), 0.3),
            ((7, 0), 0),
            ((7, 8), 0.7),
            ((3, 8), 0),
            ((3, 4), 0.3),
            ((2, 4), 0.3),
            ((2, 8), 0),
            ((0, 8), 0),
        ]
    ]
)
SHAPES = {
    "rectangle": rectangle(0, 0, 3, 2),
    "triangle": chain([(0, 0), (4, 0), (0, 3)]),
    "disc": circle((1, 2), 3),
    "slot": SLOT,
}


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("by", [1e-3, 0.1, 0.25])
def test_outwards_after_steiner(name, by):
    """Holds for every contour whose inside corners are rounder than the move."""
    shape = SHAPES[name]
    for run in (shape, shape.reversed()):
        moved = offset(run, by)
        assert moved.area == pytest.approx(shape.area + shape.length * by + pi * by**2, rel=1e-12)
        assert moved.length == pytest.approx(shape.length + 2 * pi * by, rel=1e-12)
        assert moved.ccw == run.ccw


@pytest.mark.parametrize("name", SHAPES)
def test_every_point_moves_by_the_same_amount(name):
    moved = offset(SHAPES[name], 0.2)
    for s in moved:
        for u in (0.0, 0.3, 0.5, 0.9):
            assert clearance(SHAPES[name], s.at(u)) == pytest.approx(-0.2, abs=1e-12)


def test_inwards_from_sharp_corners():
    assert offset(rectangle(0, 0, 3, 2), -0.5).area == pytest.approx(2 * 1)
    triangle = SHAPES["triangle"]  # the inscribed radius 1 shrinks, so do all lengths
    assert offset(triangle, -0.25).area == pytest.approx(6 * 0.75**2)
    # five corners close and take 2 d off each, the inside corner opens and adds a quarter circle
    assert offset(L_SHAPE, -0.25).length == pytest.approx(36 - 5 * 2 * 0.25 + 0.25 * pi / 2)


def test_a_fillet_smaller_than_the_move_vanishes():
    """Out by 0.4 the 0.3 fillets of the slot's floor are gone: a sharp floor, 1 - 0.8 wide."""
    moved = offset(SLOT, 0.4)
    floor = [s for s in moved if s.length == pytest.approx(0.2)]
    assert len(floor) == 1
    steiner = SLOT.area + SLOT.length * 0.4 + pi * 0.16
    # the formula adds each loop beyond the sharp corner: a square of side d - r less its quarter disc
    assert steiner - moved.area == pytest.approx(2 * (0.4 - 0.3) ** 2 * (1 - pi / 4), abs=1e-12)


def test_there_and_back():
    assert offset(offset(SLOT, 0.2), -0.2).area == pytest.approx(SLOT.area, rel=1e-12)
    assert len(offset(offset(SLOT, 0.2), -0.2)) == len(SLOT)


@pytest.mark.parametrize(
    "shape, by",
    [
        (rectangle(0, 0, 3, 2), -1.0),
        (rectangle(0, 0, 3, 2), -1.3),
        (circle((0, 0), 2), -1.0),
        (circle((0, 0), 2), -1.5),
        (SLOT, 0.5),  # closes the slot of 1 mm
        (SLOT, 0.6),
        (L_SHAPE, -0.5),  # eats the legs of 1 mm
    ],
)
def test_moves_that_cannot_be_made(shape, by):
    with pytest.raises(ValueError, match="moved by"):
        offset(shape, by)
