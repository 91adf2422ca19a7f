"""Nearest points and common points of exact segments (mm), in closed form."""

from __future__ import annotations

from collections.abc import Iterator
from math import atan2, cos, dist, hypot, sin, sqrt, tau

from .contour import ROUNDING_MM
from .segment import Arc, Line, Point, Segment


def feet(s: Segment, p: Point) -> list[Point]:
    """Feet of the perpendiculars from p on the segment; its ends count too.

    On an arc these are the nearest and the farthest point; for p at its own centre, where every point is one,
    its middle.
    """
    if isinstance(s, Line):
        foot = s.at(_along(s, p))
        return [foot] if on(s, foot) else []
    away = dist(p, s.centre)
    if away < ROUNDING_MM:
        return [s.at(0.5)]
    dx, dy = (p[0] - s.centre[0]) / away, (p[1] - s.centre[1]) / away
    sides = ((s.centre[0] + k * s.radius * dx, s.centre[1] + k * s.radius * dy) for k in (1, -1))
    return [q for q in sides if on(s, q)]


def on(s: Segment, p: Point) -> bool:
    """Whether a point of the segment's line or circle lies between its ends, within rounding."""
    if min(dist(p, s.start), dist(p, s.end)) <= ROUNDING_MM:
        return True
    if isinstance(s, Line):
        return 0.0 <= _along(s, p) <= 1.0
    return s.spans(atan2(p[1] - s.centre[1], p[0] - s.centre[0]))


def distance_to(s: Segment, p: Point) -> float:
    """Distance from a point to the segment, mm."""
    return min(dist(p, q) for q in (s.start, s.end, *feet(s, p)))


def common_normals(a: Segment, b: Segment) -> Iterator[tuple[Point, Point]]:
    """Pairs of points (on a, on b) whose connection is normal to both segments; an end counts as normal to
    all.

    The nearest points of two segments that do not meet are among them.
    """
    for p in (a.start, a.end):
        for q in (b.start, b.end, *feet(b, p)):
            yield p, q
    for q in (b.start, b.end):
        for p in feet(a, q):
            yield p, q
    if isinstance(a, Line):
        yield from _across_parallel_lines(a, b) if isinstance(b, Line) else _line_to_arc(a, b)
    elif isinstance(b, Line):
        yield from ((q, foot) for foot, q in _line_to_arc(b, a))
    elif dist(a.centre, b.centre) > ROUNDING_MM:
        for p in feet(a, b.centre):
            for q in feet(b, a.centre):
                yield p, q
    else:
        yield from _across_concentric_arcs(a, b)


def _line_to_arc(line: Line, arc: Arc) -> Iterator[tuple[Point, Point]]:
    """Points of the line, each with one of the arc, on the normals from the arc's centre."""
    for foot in feet(line, arc.centre):
        for q in _along_normal(arc, line):
            yield foot, q


def _across_parallel_lines(a: Line, b: Line) -> Iterator[tuple[Point, Point]]:
    """The middle of the stretch along which parallel lines face each other."""
    (ux, uy), (vx, vy) = ((s.end[0] - s.start[0], s.end[1] - s.start[1]) for s in (a, b))
    if abs(ux * vy - uy * vx) > ROUNDING_MM * a.length * b.length:
        return
    first, last = sorted((_along(a, b.start), _along(a, b.end)))
    first, last = max(first, 0.0), min(last, 1.0)
    if first < last:
        p = a.at((first + last) / 2)
        yield p, b.at(_along(b, p))


def _across_concentric_arcs(a: Arc, b: Arc) -> Iterator[tuple[Point, Point]]:
    """The middles of the stretches along which arcs about one centre face each other."""
    angles = sorted(angle % tau for s in (a, b) for angle in (s.start_angle, s.end_angle))
    for i, angle in enumerate(angles):
        before = angles[i - 1] - (tau if i == 0 else 0.0)
        middle = (before + angle) / 2
        c, s = cos(middle), sin(middle)
        for k in (1, -1):
            p = (a.centre[0] + a.radius * c, a.centre[1] + a.radius * s)
            q = (b.centre[0] + k * b.radius * c, b.centre[1] + k * b.radius * s)
            if on(a, p) and on(b, q):
                yield p, q


def _along_normal(arc: Arc, line: Line) -> list[Point]:
    """Points of the arc where it is parallel to the line."""
    (x, y), r = arc.centre, arc.radius
    ux, uy = (line.end[0] - line.start[0]) / line.length, (line.end[1] - line.start[1]) / line.length
    return [q for q in ((x - r * uy, y + r * ux), (x + r * uy, y - r * ux)) if on(arc, q)]


def distance(a: Segment, b: Segment) -> float:
    """Smallest distance of two segments, mm; 0 if they meet."""
    return 0.0 if meeting_points(a, b) else min(dist(p, q) for p, q in common_normals(a, b))


Box = tuple[float, float, float, float]


def box_around(s: Segment) -> Box:
    """A box, x and y from and to, that holds the segment (of an arc: its whole circle)."""
    if isinstance(s, Arc):
        (x, y), r = s.centre, s.radius
        return (x - r, y - r, x + r, y + r)
    (x, y), (u, v) = s.start, s.end
    return (min(x, u), min(y, v), max(x, u), max(y, v))


def gap(one: Box, other: Box) -> float:
    """Distance of two boxes, 0 if they overlap: what they hold is no nearer, but for rounding (mm)."""
    x = max(one[0] - other[2], other[0] - one[2], 0.0)
    y = max(one[1] - other[3], other[1] - one[3], 0.0)
    return hypot(x, y) - ROUNDING_MM if x or y else 0.0


def meeting_points(a: Segment, b: Segment) -> list[Point]:
    """Points in which two segments meet, within rounding; where they overlap, the ends of the common
    stretch.
    """
    (ax, ay, ar), (bx, by, br) = _disc(a), _disc(b)
    if hypot(ax - bx, ay - by) > ar + br + ROUNDING_MM:
        return []
    if isinstance(a, Line):
        candidates = _lines_meet(a, b) if isinstance(b, Line) else _line_and_circle(a, b)
    elif isinstance(b, Line):
        candidates = _line_and_circle(b, a)
    else:
        candidates = _circles_meet(a, b)
    return [p for p in candidates if on(a, p) and on(b, p)]


def _lines_meet(a: Line, b: Line) -> list[Point]:
    ux, uy = a.end[0] - a.start[0], a.end[1] - a.start[1]
    vx, vy = b.end[0] - b.start[0], b.end[1] - b.start[1]
    wx, wy = b.start[0] - a.start[0], b.start[1] - a.start[1]
    cross = ux * vy - uy * vx
    if abs(cross) > 1e-12 * a.length * b.length:
        return [a.at((wx * vy - wy * vx) / cross)]
    if abs(ux * wy - uy * wx) > ROUNDING_MM * a.length:  # parallel, side by side
        return []
    ends = [(p, b) for p in (a.start, a.end)] + [(p, a) for p in (b.start, b.end)]
    return [p for p, other in ends if on(other, p)]


def _line_and_circle(line: Line, arc: Arc) -> list[Point]:
    u = _along(line, arc.centre)
    foot = line.at(u)
    r, h = arc.radius, dist(foot, arc.centre)
    if abs(h - r) <= ROUNDING_MM:
        return [foot]
    if h > r:
        return []
    half = sqrt((r - h) * (r + h)) / line.length
    return [line.at(u - half), line.at(u + half)]


def _circles_meet(a: Arc, b: Arc) -> list[Point]:
    ra, rb, d = a.radius, b.radius, dist(a.centre, b.centre)
    if d <= ROUNDING_MM:
        if abs(ra - rb) > ROUNDING_MM:
            return []
        ends = [(p, b) for p in (a.start, a.end)] + [(p, a) for p in (b.start, b.end)]
        return [p for p, other in ends if on(other, p)]
    if d > ra + rb + ROUNDING_MM or d < abs(ra - rb) - ROUNDING_MM:
        return []
    ux, uy = (b.centre[0] - a.centre[0]) / d, (b.centre[1] - a.centre[1]) / d
    along = (d * d + (ra - rb) * (ra + rb)) / (2 * d)
    touch = min(abs(d - ra - rb), abs(d - abs(ra - rb))) <= ROUNDING_MM
    half = 0.0 if touch else sqrt(max(0.0, (ra - along) * (ra + along)))
    x, y = a.centre[0] + along * ux, a.centre[1] + along * uy
    return [(x - half * uy, y + half * ux)] + ([] if touch else [(x + half * uy, y - half * ux)])


def _along(line: Line, p: Point) -> float:
    """Parameter of the foot of p on the line, 0 at its start and 1 at its end."""
    ux, uy = line.end[0] - line.start[0], line.end[1] - line.start[1]
    return ((p[0] - line.start[0]) * ux + (p[1] - line.start[1]) * uy) / (ux * ux + uy * uy)


def _disc(s: Segment) -> tuple[float, float, float]:
    """Centre and radius of a disc around the segment."""
    if isinstance(s, Arc):
        return (*s.centre, s.radius)
    return (*s.at(0.5), s.length / 2)
