"""Plane geometry on the paper or in a view, mm: points, lines, upright boxes, quadrangles, what meets."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import dist, hypot

Point = tuple[float, float]
Polyline = tuple[Point, ...]
Chord = tuple[Point, Point]
Box = tuple[float, float, float, float]  # x_min, y_min, x_max, y_max
# Lines that meet nearer to their ends than this are meant to touch there (mm of paper).
END = 0.3
Quad = tuple[Point, Point, Point, Point]


def bounds(points: Iterable[Point]) -> Box:
    """The least box that holds the points."""
    xs, ys = zip(*points)
    return (min(xs), min(ys), max(xs), max(ys))


def bounds_of(lines: Iterable[Sequence[Point]]) -> Box:
    """The least box that holds the lines."""
    return bounds(p for line in lines for p in line)


def scaled(b: Box, f: float) -> Box:
    return (b[0] * f, b[1] * f, b[2] * f, b[3] * f)


def shifted(b: Box, by: Point) -> Box:
    return (b[0] + by[0], b[1] + by[1], b[2] + by[0], b[3] + by[1])


def grown(b: Box, margin: float) -> Box:
    """The box with `margin` mm more on every side."""
    return (b[0] - margin, b[1] - margin, b[2] + margin, b[3] + margin)


def corners(b: Box) -> tuple[Point, Point, Point, Point]:
    """Counter-clockwise from the lower left."""
    return ((b[0], b[1]), (b[2], b[1]), (b[2], b[3]), (b[0], b[3]))


def overlap(a: Box, b: Box) -> bool:
    """Whether two boxes share more than an edge."""
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


def length(line: Sequence[Point]) -> float:
    """Length of a line through points, mm."""
    return sum(dist(a, b) for a, b in zip(line, line[1:]))


def crossing(a: Chord, b: Chord, end: float = END) -> bool:
    """Whether two straight pieces cross away from their ends."""
    (px, py), (qx, qy) = a
    (rx, ry), (sx, sy) = b
    ux, uy, vx, vy = qx - px, qy - py, sx - rx, sy - ry
    det = ux * vy - uy * vx
    la, lb = hypot(ux, uy), hypot(vx, vy)
    if la == 0 or lb == 0 or abs(det) < 1e-9 * la * lb:
        return False
    t = ((rx - px) * vy - (ry - py) * vx) / det * la
    s = ((rx - px) * uy - (ry - py) * ux) / det * lb
    return end < t < la - end and -1e-9 <= s <= lb + 1e-9


def quads_meet(a: Quad, b: Quad) -> bool:
    """Whether two convex quadrangles share a point: no line parallel to a side separates them."""
    ax0, ay0, ax1, ay1 = bounds(a)
    bx0, by0, bx1, by1 = bounds(b)
    if ax1 < bx0 or bx1 < ax0 or ay1 < by0 or by1 < ay0:
        return False
    return not any(_separates(side, a, b) for side in _normals(a) + _normals(b))


def chord_meets(chord: Chord, quad: Quad) -> bool:
    """Whether a straight piece shares a point with a convex quadrangle."""
    (ax, ay), (bx, by) = chord
    across = (ay - by, bx - ax)
    return not any(_separates(side, chord, quad) for side in [*_normals(quad), across])


def _normals(quad: Quad) -> list[Point]:
    return [(b[1] - a[1], a[0] - b[0]) for a, b in zip(quad[:2], quad[1:3])]


def _separates(normal: Point, a: Sequence[Point], b: Sequence[Point]) -> bool:
    on_a = [p[0] * normal[0] + p[1] * normal[1] for p in a]
    on_b = [p[0] * normal[0] + p[1] * normal[1] for p in b]
    return max(on_a) < min(on_b) or max(on_b) < min(on_a)


def clipped(chord: Chord, window: Box) -> Chord | None:
    """The part of a straight piece in a box (Liang and Barsky); None if there is none."""
    (ax, ay), (bx, by) = chord
    dx, dy = bx - ax, by - ay
    t0, t1 = 0.0, 1.0
    for d, low, high in ((dx, window[0] - ax, window[2] - ax), (dy, window[1] - ay, window[3] - ay)):
        if abs(d) < 1e-12:
            if low > 0 or high < 0:
                return None
            continue
        enter, leave = sorted((low / d, high / d))
        t0, t1 = max(t0, enter), min(t1, leave)
    if t1 - t0 < 1e-9:
        return None
    return ((ax + t0 * dx, ay + t0 * dy), (ax + t1 * dx, ay + t1 * dy))
