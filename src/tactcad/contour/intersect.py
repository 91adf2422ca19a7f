"""Whether contours cross or touch themselves or each other."""

from __future__ import annotations

from itertools import combinations, product
from math import dist

from .contour import Contour
from .nearest import distance, meeting_points
from .segment import Point, Segment

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
    """Smallest distance of two pieces that are not neighbours, mm; infinite where there are none."""
    pairs = combinations(enumerate(contour), 2)
    return min(
        (distance(a, b) for (i, a), (j, b) in pairs if not _joints(contour, i, j)), default=float("inf")
    )


def _joints(contour: Contour, i: int, j: int) -> list[Point]:
    """The joints that pieces i < j share: none, one, or both where there are only two."""
    pieces: tuple[Segment, ...] = contour.segments
    shared = [pieces[j].start] if j == i + 1 else []
    return shared + ([pieces[i].start] if (j + 1) % len(pieces) == i else [])
