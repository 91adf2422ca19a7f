"""Whether many (thousands of) segments in a plane keep clear of each other."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from math import cos, dist, pi, sin

from .inside import JOINT_MM
from .nearest import box_around, distance, meeting_points
from .segment import Line, Point, Segment

FOLDED = 1e-3  # radians between two pieces of one corner, under which one lies back on the other; chosen


def keep_clear(segments: Sequence[Segment], least: float) -> bool:
    """Whether pieces with a common end meet there only, at an angle, and all others are at least that far
    (mm) from each other."""
    return all(_clear(segments[i], segments[j], least) for i, j in _close_pairs(segments, least))


def _clear(a: Segment, b: Segment, least: float) -> bool:
    shared = [p for p in (a.start, a.end) if p in (b.start, b.end)]
    if not shared:
        return distance(a, b) >= least
    if any(_folded(a, b, p) for p in shared):
        return False
    return all(min(dist(p, q) for q in shared) <= JOINT_MM for p in meeting_points(a, b))


def _folded(a: Segment, b: Segment, joint: Point) -> bool:
    """Whether both leave a joint in one direction."""
    (ax, ay), (bx, by) = (_leaving(s, joint) for s in (a, b))
    return ax * bx + ay * by > cos(FOLDED)


def _leaving(s: Segment, joint: Point) -> Point:
    """Unit direction in which a segment leaves one of its ends."""
    at_start = s.start == joint
    if isinstance(s, Line):
        (x, y), (u, v) = (s.start, s.end) if at_start else (s.end, s.start)
        return (u - x) / s.length, (v - y) / s.length
    along = pi / 2 if (s.sweep > 0) == at_start else -pi / 2
    angle = (s.start_angle if at_start else s.end_angle) + along
    return cos(angle), sin(angle)


def _close_pairs(segments: Sequence[Segment], reach: float) -> Iterator[tuple[int, int]]:
    """Index pairs whose boxes come within reach: a sweep along x."""
    boxes = sorted((box_around(s), i) for i, s in enumerate(segments))
    first = [box[0] for box, _ in boxes]
    for n, ((_, y0, x1, y1), i) in enumerate(boxes):
        low, high = y0 - reach, y1 + reach
        for box, j in boxes[n + 1 : bisect_right(first, x1 + reach)]:
            if box[1] <= high and box[3] >= low:
                yield i, j
