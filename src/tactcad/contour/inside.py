"""What lies inside a contour, and whether contours cross or touch themselves or each other."""

from __future__ import annotations

import heapq
from bisect import bisect_right
from collections import defaultdict
from collections.abc import Iterator, Sequence
from itertools import combinations, product
from math import atan2, cos, dist, inf, pi, sqrt, tau

from .contour import ROUNDING_MM, Contour
from .nearest import box_around, distance, distance_to, gap, meeting_points
from .segment import Line, Point, Segment, direction


def side(contour: Contour, p: Point) -> int:
    """1 if p is inside, 0 on the contour within rounding, -1 outside; the direction of the chain does
    not matter.
    """
    if min(distance_to(s, p) for s in contour) <= ROUNDING_MM:
        return 0
    return 1 if round(sum(_turn(s, p) for s in contour) / tau) else -1


def encloses(outer: Contour, inner: Contour) -> bool:
    """Whether the inner contour lies wholly inside the outer one, without touching it."""
    return side(outer, inner.segments[0].start) == 1 and not crossings(outer, inner)


def clearance(contour: Contour, p: Point) -> float:
    """Distance from p to the contour, negative outside, mm."""
    return min(distance_to(s, p) for s in contour) * (1 if side(contour, p) >= 0 else -1)


def place_for_circle(contour: Contour, diameter: float, within: float = 1e-3) -> Point | None:
    """A centre at which a circle fits inside a contour.

    Squares are quartered, the most promising first: clearance changes at most by the distance moved, so a
    square of half side h holds nothing better than its centre's clearance + sqrt(2) h.

    Parameters
    ----------
    contour
        A simple closed contour, mm.
    diameter
        Of the circle, mm.
    within
        Less than this to spare (mm) may count as no place.

    Returns
    -------
    Point or None
        The centroid if the circle fits there; None if no place was found.
    """
    needed = diameter / 2 - ROUNDING_MM
    if clearance(contour, contour.centroid) >= needed:
        return contour.centroid
    x0, y0, x1, y1 = contour.box
    squares = [(-inf, ((x0 + x1) / 2, (y0 + y1) / 2), max(x1 - x0, y1 - y0) / 2)]
    while -squares[0][0] >= needed + within / 2:
        _, (x, y), half = heapq.heappop(squares)
        half /= 2
        for p in ((x - half, y - half), (x + half, y - half), (x - half, y + half), (x + half, y + half)):
            room = clearance(contour, p)
            if room >= needed:
                return p
            heapq.heappush(squares, (-room - sqrt(2) * half, p, half))
    return None


def _turn(s: Segment, p: Point) -> float:
    """Turn of the direction from p to a point moving along the segment, radians, positive ccw.

    For an arc it is that of its chord, and a full turn more where p lies between arc and chord.
    """
    if not isinstance(s, Line) and s.start == s.end:
        inside = dist(p, s.centre) < s.radius
        return s.sweep if inside else 0.0
    ax, ay = s.start[0] - p[0], s.start[1] - p[1]
    bx, by = s.end[0] - p[0], s.end[1] - p[1]
    left, ahead = ax * by - ay * bx, ax * bx + ay * by  # left > 0: p lies left of the chord
    if isinstance(s, Line) or dist(p, s.centre) >= s.radius:
        return atan2(left, ahead)
    if left == 0.0:  # on the chord
        return pi if s.ccw else -pi
    beyond = (left < 0) == s.ccw
    return atan2(left, ahead) + (tau * (1 if s.ccw else -1) if beyond else 0.0)


# Neighbours that are tangent within rounding are found to meet again up to sqrt(2 r x rounding) from their
# joint.
JOINT_MM = 1e-4


def self_intersections(contour: Contour) -> list[Point]:
    """Points (mm) in which pieces meet, other than the joint of two neighbours."""
    return [
        p
        for (i, a), (j, b) in combinations(enumerate(contour), 2)
        for p in meeting_points(a, b)
        if all(dist(p, joint) > JOINT_MM for joint in _joints(contour, i, j))
    ]


def crossings(one: Contour, other: Contour) -> list[Point]:
    """Points in which two contours meet (mm)."""
    return [p for a, b in product(one, other) for p in meeting_points(a, b)]


def smallest_distance(contour: Contour) -> float:
    """Smallest distance of two pieces that are not neighbours, mm; infinite if there are none."""
    boxes, least = [box_around(s) for s in contour], float("inf")
    for (i, a), (j, b) in combinations(enumerate(contour), 2):
        if gap(boxes[i], boxes[j]) < least and not _joints(contour, i, j):
            least = min(least, distance(a, b))
    return least


def _joints(contour: Contour, i: int, j: int) -> list[Point]:
    """The joints that pieces i < j share: none, one, or both if there are only two."""
    pieces: tuple[Segment, ...] = contour.segments
    shared = [pieces[j].start] if j == i + 1 else []
    return shared + ([pieces[i].start] if (j + 1) % len(pieces) == i else [])


FOLDED = 1e-3  # radians between two pieces of one corner, under which one lies back on the other; chosen


def keep_clear(segments: Sequence[Segment], least: float) -> bool:
    """Whether pieces with a common end meet there only, at an angle, and all others are at least that far
    (mm) from each other."""
    return all(_clear(segments[i], segments[j], least) for i, j in _close_pairs(segments, least))


def bound_one_area(segments: Sequence[Segment]) -> bool:
    """Whether pieces that keep clear of each other are one outline with openings side by side in it."""
    outer, *openings = sorted(_loops(segments), key=lambda c: c.area, reverse=True)
    within = [(*c.box, c) for c in openings]
    for opening in openings:
        x, y = opening.segments[0].start
        if side(outer, (x, y)) != 1:
            return False
        around = (c for x0, y0, x1, y1, c in within if x0 < x < x1 and y0 < y < y1 and c is not opening)
        if any(side(other, (x, y)) == 1 for other in around):
            return False
    return True


def _loops(segments: Sequence[Segment]) -> Iterator[Contour]:
    """Pieces joined at common ends, whichever way they run."""
    at = defaultdict(list)
    for s in segments:
        at[s.start].append(s)
        at[s.end].append(s)
    waiting = dict.fromkeys(segments)
    while waiting:
        loop = [waiting.popitem()[0]]
        while loop[-1].end != loop[0].start:
            s = next(s for s in at[loop[-1].end] if s in waiting)
            del waiting[s]
            loop.append(s if s.start == loop[-1].end else s.reversed())
        yield Contour(tuple(loop))


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
    sign, (x, y) = 1 if s.start == joint else -1, direction(s, joint)
    return sign * x, sign * y


def _close_pairs(segments: Sequence[Segment], reach: float) -> Iterator[tuple[int, int]]:
    """Index pairs whose boxes come within reach: a sweep along x."""
    boxes = sorted((box_around(s), i) for i, s in enumerate(segments))
    first = [box[0] for box, _ in boxes]
    for n, ((_, y0, x1, y1), i) in enumerate(boxes):
        low, high = y0 - reach, y1 + reach
        for box, j in boxes[n + 1 : bisect_right(first, x1 + reach)]:
            if box[1] <= high and box[3] >= low:
                yield i, j
