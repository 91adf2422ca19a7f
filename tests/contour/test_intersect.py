"""Common points and distances against constructions whose answer is known."""

from __future__ import annotations

from math import cos, pi, sin, sqrt

import pytest

from tactcad.contour import Arc, Contour, Line, chain, circle, rectangle
from tactcad.contour.inside import crossings, self_intersections, smallest_distance
from tactcad.contour.nearest import distance, distance_to, meeting_points

UNIT = Arc((1.0, 0.0), (-1.0, 0.0), (0.0, 0.0), True)  # the upper half of the unit circle


def same_points(found, expected) -> bool:
    def rounded(points):
        return sorted((round(x, 7) + 0.0, round(y, 7) + 0.0) for x, y in points)

    return rounded(found) == rounded(expected)


def turned(s, angle: float, dx: float, dy: float):
    def move(p):
        return (cos(angle) * p[0] - sin(angle) * p[1] + dx, sin(angle) * p[0] + cos(angle) * p[1] + dy)

    if isinstance(s, Line):
        return Line(move(s.start), move(s.end))
    return Arc(move(s.start), move(s.end), move(s.centre), s.ccw)


@pytest.mark.parametrize(
    "a, b, expected",
    [
        (Line((0, 0), (2, 2)), Line((0, 2), (2, 0)), [(1, 1)]),
        (Line((0, 0), (1, 1)), Line((0, 3), (3, 0)), []),
        (Line((0, 0), (2, 0)), Line((0, 1), (2, 1)), []),
        (Line((0, 0), (2, 0)), Line((1, 0), (3, 0)), [(1, 0), (2, 0)]),
        (Line((0, 0), (2, 0)), Line((2, 0), (2, 5)), [(2, 0)]),
        (Line((-2, 0.6), (2, 0.6)), UNIT, [(-0.8, 0.6), (0.8, 0.6)]),
        (Line((-2, -0.6), (2, -0.6)), UNIT, []),
        (Line((-2, 1), (2, 1)), UNIT, [(0, 1)]),
        (Line((0, 0), (0, 0.9)), UNIT, []),
        (Line((1, 0), (1, 3)), UNIT, [(1, 0)]),
        (Arc((2, 0), (0, 0), (1, 0), True), UNIT, [(0.5, sqrt(3) / 2)]),
        (Arc((3, 0), (1, 0), (2, 0), True), UNIT, [(1, 0)]),
        (Arc((4, 0), (2, 0), (3, 0), True), UNIT, []),
        (Arc((0, 1), (0, -1), (0, 0), True), UNIT, [(0, 1), (-1, 0)]),
        (Arc((0.5, 0), (-0.5, 0), (0, 0), True), UNIT, []),
    ],
)
@pytest.mark.parametrize("angle, dx, dy", [(0.0, 0.0, 0.0), (0.7, 13.0, -41.0), (2.9, -100.0, 55.5)])
def test_meeting_points(a, b, expected, angle, dx, dy):
    """Known for simple places; the same however both are turned and moved together."""
    back = [turned(Line(p, p), -angle, 0, 0).start for p in _shifted(a, b, angle, dx, dy)]
    assert same_points(back, expected)


def _shifted(a, b, angle, dx, dy):
    points = meeting_points(turned(a, angle, dx, dy), turned(b, angle, dx, dy))
    return [(x - dx, y - dy) for x, y in points]


@pytest.mark.parametrize(
    "a, b, expected",
    [
        (Line((0, 0), (4, 0)), Line((0, 1.5), (4, 1.5)), 1.5),
        (Line((0, 0), (4, 0)), Line((7, 4), (9, 9)), 5.0),
        (Line((0, 0), (4, 0)), Line((2, 0.5), (2, 3)), 0.5),
        (Line((-3, 3), (3, 3)), UNIT, 2.0),
        (Line((-3, -3), (3, -3)), UNIT, 3.0),
        (Line((-0.1, 0.2), (0.1, 0.2)), UNIT, 1 - sqrt(0.05)),
        (Arc((11, 0), (9, 0), (10, 0), True), UNIT, 8.0),
        (Arc((2.0, 0.0), (-2.0, 0.0), (0, 0), True), UNIT, 1.0),
        (Arc((0.0, 4.0), (0.0, 2.0), (0.0, 3.0), False), UNIT, 1.0),
    ],
)
def test_distances(a, b, expected):
    assert distance(a, b) == pytest.approx(expected, abs=1e-12)
    assert distance(b, a) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize(
    "p, expected", [((0, 3), 2), ((0, 0), 1), ((0, 0.25), 0.75), ((3, 0), 2), ((0, -1), sqrt(2))]
)
def test_distance_to_an_arc(p, expected):
    assert distance_to(UNIT, p) == pytest.approx(expected, abs=1e-12)


def test_distances_agree_with_dense_points():
    """A line and an arc at odd places, against 400 x 400 points on them."""
    line, arc = Line((0.3, -2.0), (4.1, 1.7)), Arc((0.0, 1.0), (1.3, 3.3), (1.0, 2.0), False)
    grid = [i / 400 for i in range(401)]
    near = min(
        sqrt((p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2) for p in map(line.at, grid) for q in map(arc.at, grid)
    )
    assert distance(line, arc) == pytest.approx(near, abs=1e-4)
    assert distance(line, arc) <= near


def test_simple_contours_do_not_meet_themselves():
    moon = Contour((Line((0.0, 0.0), (4.0, 0.0)), Arc((4.0, 0.0), (0.0, 0.0), (2.0, 0.0), True)))
    for contour in (rectangle(0, 0, 3, 1), circle((1, 1), 2), moon):
        assert self_intersections(contour) == []


def test_a_bow_tie_crosses_itself():
    assert self_intersections(chain([(0, 0), (1, 1), (1, 0), (0, 1)])) == [(0.5, 0.5)]


def test_a_spike_that_runs_back_on_itself():
    assert self_intersections(chain([(0, 0), (4, 0), (4, 2), (2, 2), (2, 5), (2, 2), (0, 2)]))


def test_an_arc_that_bulges_through_the_far_side():
    thin = Contour(
        (
            Line((0.0, 0.0), (4.0, 0.0)),
            Line((4.0, 0.0), (4.0, 1.0)),
            Arc((4.0, 1.0), (0.0, 1.0), (2.0, 1.0), False),  # sinks to y = -1
            Line((0.0, 1.0), (0.0, 0.0)),
        )
    )
    assert same_points(self_intersections(thin), [(2 - sqrt(3), 0.0), (2 + sqrt(3), 0.0)])


def test_smallest_distance_is_that_of_pieces_that_are_no_neighbours():
    assert smallest_distance(rectangle(0, 0, 3, 1)) == 1.0
    assert smallest_distance(chain([(0, 0), (1, 0), (0, 1)])) == float("inf")
    comb = chain([(0, 0), (9, 0), (9, 5), (5.2, 5), (5.2, 1), (5, 1), (5, 5), (0, 5)])
    assert smallest_distance(comb) == pytest.approx(0.2)


def test_crossings_of_two_contours():
    found = crossings(circle((0, 0), 2), circle((1, 0), 2))
    assert same_points(found, [(0.5, -sqrt(3) / 2), (0.5, sqrt(3) / 2)])
    assert crossings(rectangle(0, 0, 4, 4), circle((2, 2), 1)) == []


def test_full_turns_meet():
    whole = Arc((1.0, 0.0), (1.0, 0.0), (0.0, 0.0), True)
    assert len(meeting_points(whole, Line((-2, 0), (2, 0)))) == 2
    assert whole.length == pytest.approx(2 * pi)
