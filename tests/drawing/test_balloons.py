"""Balloons: one an item, outside the outlines, leaders that neither cross nor come close; on drawn-up and
random views."""

from __future__ import annotations

from itertools import combinations
from math import cos, dist, hypot, pi, sin

import numpy as np
import pytest

from tactcad.drawing.assemblies.balloons import APART, CLEAR, RADIUS, SHORTEST, Balloon, drawn, faults, place

AREA = (0.0, 0.0, 200.0, 270.0)


def square(x: float, y: float, a: float):
    corners = [(x, y), (x + a, y), (x + a, y + a), (x, y + a), (x, y)]
    return [tuple(pair) for pair in zip(corners, corners[1:])]


def cross(p, q, r, s) -> bool:
    """Orientation test, not the layout's own."""

    def side(a, b, c):
        return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])

    return side(p, q, r) * side(p, q, s) < 0 and side(r, s, p) * side(r, s, q) < 0


def assert_clean(balloons, own):
    assert sorted(b.item for b in balloons) == sorted(own)
    for a, b in combinations(balloons, 2):
        assert not cross(*a.leader, *b.leader), (a, b)
        assert dist(a.centre, b.centre) > 2 * RADIUS + 1
    for b in balloons:
        assert any(_on(b.tip, line) for line in own[b.item])  # ends on its own item
        assert dist(b.centre, b.tip) >= RADIUS + SHORTEST
        assert AREA[0] < b.centre[0] - RADIUS and b.centre[0] + RADIUS < AREA[2]
        # the circle is clear of every line, sampled finely
        for lines in own.values():
            for line in lines:
                for (x0, y0), (x1, y1) in zip(line, line[1:]):
                    for u in np.linspace(0, 1, 50):
                        assert (
                            hypot(x0 + u * (x1 - x0) - b.centre[0], y0 + u * (y1 - y0) - b.centre[1])
                            > RADIUS + CLEAR - 1.0
                        )


def _on(p, line) -> bool:
    return any(abs(dist(a, p) + dist(p, b) - dist(a, b)) < 1e-9 for a, b in zip(line, line[1:]))


@pytest.mark.by_day(3, "half a second each")
@pytest.mark.parametrize("seed", range(6))
def test_random_views(seed):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(3, 40))
    own = {}
    for item in range(1, count + 1):
        x, y = rng.uniform(60, 130), rng.uniform(80, 190)
        own[item] = square(float(x), float(y), float(rng.uniform(2, 14)))
    balloons = place(own, [line for lines in own.values() for line in lines], AREA)
    assert balloons is not None
    assert_clean(balloons, own)
    assert faults(balloons) == []


def test_a_ring_of_parts_gets_its_balloons_outside_where_the_inside_is_closed():
    outline = [(100 + 45 * cos(2 * pi * i / 90), 135 + 45 * sin(2 * pi * i / 90)) for i in range(91)]
    own = {n: [tuple(outline[15 * n : 15 * n + 16])] for n in range(6)}
    balloons = place(own, [line for lines in own.values() for line in lines], AREA)
    assert balloons and all(dist(b.centre, (100, 135)) > 45 for b in balloons)


def test_no_place_is_said_and_not_made():
    own = {n: square(30.0 + n, 30.0, 1.0) for n in range(30)}
    assert place(own, [line for lines in own.values() for line in lines], (0.0, 0.0, 60.0, 60.0)) is None


def test_faults_see_crossings_near_misses_and_leaders_through_circles():
    a = Balloon(1, (0, 0), (20, 0))
    assert faults([a, Balloon(2, (12, 15), (12, -15))]) == [(0, 1)]  # across
    assert faults([a, Balloon(2, (0, 10), (20, APART / 2))]) == [(0, 1)]  # tips too close
    assert faults([a, Balloon(2, (12, RADIUS), (30, 30))]) == [(0, 1)]  # through the circle
    assert faults([a, Balloon(2, (0, 12), (20, 12))]) == []


def test_drawn_balloons_end_in_arrows_at_their_tips():
    items = drawn([Balloon(7, (0.0, 0.0), (20.0, 5.0))])
    circle, text, leader, head = items
    assert circle.radius == RADIUS and text.text == "7" and text.role == "note"
    assert leader.points[1] == (20.0, 5.0) == head.points[0]
    assert dist(leader.points[0], (0, 0)) == pytest.approx(RADIUS)
