"""Points, lines and upright boxes on the paper or in a view, mm."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import dist

Point = tuple[float, float]
Polyline = tuple[Point, ...]
Chord = tuple[Point, Point]
Box = tuple[float, float, float, float]  # x_min, y_min, x_max, y_max


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
    """Of a line through points, mm."""
    return sum(dist(a, b) for a, b in zip(line, line[1:]))
