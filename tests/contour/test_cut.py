"""Cutting a contour at a line: areas add up, circles give segments of known area."""

from __future__ import annotations

from math import acos, sqrt

import pytest

from tactcad.contour import Contour, chain, circle, rectangle
from tactcad.contour.cut import between, crossings, cut

U_SHAPE = chain([(0, 0), (5, 0), (5, 4), (4, 4), (4, 1), (1, 1), (1, 4), (0, 4)])


@pytest.mark.parametrize("axis", ["x", "y"])
@pytest.mark.parametrize("at", [-0.99, -0.3, 0.0, 0.7])
def test_circle_gives_the_segment_of_known_area(axis, at):
    (below,), (above,) = (cut(circle((0.0, 0.0), 2.0), axis, at, keep) for keep in ("below", "above"))
    cap = acos(at) - at * sqrt(1 - at * at)
    assert above.area == pytest.approx(cap, rel=1e-12)
    assert below.area + above.area == pytest.approx(circle((0, 0), 2).area, rel=1e-12)


@pytest.mark.parametrize(
    "axis,at,below,above",
    [
        ("y", 2.0, [7.0], [2.0, 2.0]),
        ("y", 1.0, [5.0], [3.0, 3.0]),
        ("x", 1.0, [4.0], [7.0]),
        ("x", 2.5, [5.5], [5.5]),
    ],
)
@pytest.mark.parametrize("turned", [False, True])
def test_u_shape_falls_into_pieces(axis, at, below, above, turned):
    contour = U_SHAPE.reversed() if turned else U_SHAPE
    assert [p.area for p in cut(contour, axis, at, "below")] == pytest.approx(below)
    assert [p.area for p in cut(contour, axis, at, "above")] == pytest.approx(above)
    assert all(p.ccw for p in cut(contour, axis, at, "above"))


def test_cut_beside_the_contour_keeps_all_or_nothing():
    assert cut(U_SHAPE, "x", 9.0, "below") == (U_SHAPE,)
    assert cut(U_SHAPE, "x", 9.0, "above") == ()
    assert cut(rectangle(0, 0, 2, 1), "x", 2.0, "below") == (rectangle(0, 0, 2, 1),)


def test_new_edges_carry_the_cuts_name_and_old_ones_keep_theirs():
    piece = between(rectangle(0, 0, 4, 1), 1.0, 3.0, ("clamp", "load"))
    assert isinstance(piece, Contour) and piece.box == (1.0, 0.0, 3.0, 1.0)
    assert piece.named("clamp").length == piece.named("load").length == 1.0


def test_between_refuses_what_is_not_one_piece():
    lying_u = chain([(0, 0), (4, 0), (4, 1), (1, 1), (1, 4), (4, 4), (4, 5), (0, 5)])
    with pytest.raises(ValueError, match="2 pieces"):
        between(lying_u, 2.0, 3.0)


def test_crossings_are_sorted_heights():
    assert crossings(U_SHAPE, "y", 2.0) == [0.0, 1.0, 4.0, 5.0]
    assert crossings(circle((0, 0), 2), "x", 0.6) == pytest.approx([-0.8, 0.8])
