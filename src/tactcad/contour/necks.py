"""Narrow places of a part, or of the space around it: webs, walls and slots, in closed form.

A neck is a straight connection of two boundary points that is normal to the boundary at both (at a sharp
corner: lies between the normals of its two edges) and that nothing else crosses. The smallest wall and the
narrowest slot are necks.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement
from math import dist, pi
from typing import Literal

from .contour import ROUNDING_MM, Contour
from .nearest import Box, box_around, common_normals, gap, meeting_points
from .segment import Arc, Line, Point, Segment, direction

# Directions closer than this are taken as equal: sine of the angle, above the rounding of short tangents.
SAME_DIRECTION = 1e-6


@dataclass(frozen=True)
class Neck:
    """A narrow place: its width (mm) from p to q on the two segments, in material or in the void."""

    width: float
    p: Point
    q: Point
    within: Literal["material", "void"]
    segments: tuple[Segment, Segment]

    @property
    def names(self) -> tuple[str, str]:
        return (self.segments[0].name, self.segments[1].name)

    @property
    def middle(self) -> Point:
        return ((self.p[0] + self.q[0]) / 2, (self.p[1] + self.q[1]) / 2)


@dataclass(frozen=True)
class _Piece:
    """A segment run with the material on its left, and the directions in which its neighbours join."""

    segment: Segment
    arriving: Point  # unit direction of the one before, where it ends
    leaving: Point  # unit direction of the one after, where it starts
    box: Box  # that holds it


def necks(outer: Contour, openings: Sequence[Contour] = (), below: float = float("inf")) -> list[Neck]:
    """Narrow places of the material or of the space around it.

    Parameters
    ----------
    outer, openings
        Outline and openings of the part, mm; the direction in which they run does not matter.
    below
        Only necks narrower than this, mm.

    Returns
    -------
    list of Neck
        The narrowest first; where walls run side by side, one for the pair.
    """
    contours = [outer if outer.ccw else outer.reversed()]
    contours += [c.reversed() if c.ccw else c for c in openings]
    pieces = [piece for contour in contours for piece in _pieces(contour)]
    candidates = []
    for a, b in combinations_with_replacement(pieces, 2):
        if gap(a.box, b.box) >= below:
            continue
        for p, q in _facing(a, b):
            width = dist(p, q)
            if ROUNDING_MM < width < below:
                side = _side(a, p, q)
                if side and side == _side(b, q, p) and _is_free(p, q, pieces):
                    candidates.append(Neck(width, p, q, side, (a.segment, b.segment)))
    different: list[Neck] = []
    for neck in sorted(candidates, key=lambda n: (round(n.width / ROUNDING_MM), n.middle)):
        if not any(_same(neck, other) for other in different):
            different.append(neck)
    return different


def _same(a: Neck, b: Neck) -> bool:
    """Whether two necks are the same place: equally wide, and on the same segments or on their neighbours."""

    def joined(s: Segment, t: Segment) -> bool:
        return s == t or s.end == t.start or s.start == t.end

    (a1, a2), (b1, b2) = a.segments, b.segments
    beside = (joined(a1, b1) and joined(a2, b2)) or (joined(a1, b2) and joined(a2, b1))
    return beside and a.within == b.within and abs(a.width - b.width) <= 2 * ROUNDING_MM


def _facing(a: _Piece, b: _Piece) -> Iterator[tuple[Point, Point]]:
    """Candidates between two pieces, and across an arc of half a turn or more."""
    if a is not b:
        yield from common_normals(a.segment, b.segment)
    elif isinstance(a.segment, Arc):
        rest = 1 - pi / abs(a.segment.sweep)
        if rest >= -SAME_DIRECTION:
            yield a.segment.at(max(rest, 0.0) / 2), a.segment.at(1 - max(rest, 0.0) / 2)


def _pieces(contour: Contour) -> list[_Piece]:
    run = contour.segments
    return [
        _Piece(
            s, direction(run[i - 1], run[i - 1].end), direction(run[(i + 1) % len(run)], s.end), box_around(s)
        )
        for i, s in enumerate(run)
    ]


def _side(piece: _Piece, p: Point, q: Point) -> Literal["material", "void"] | None:
    """Side of the piece on which the connection from p to q leaves it; None if it does not leave along a
    normal.
    """
    s = piece.segment
    here = direction(s, p)
    before = piece.arriving if dist(p, s.start) <= ROUNDING_MM else here
    after = piece.leaving if dist(p, s.end) <= ROUNDING_MM else here
    size = dist(p, q)
    v = ((q[0] - p[0]) / size, (q[1] - p[1]) / size)
    outward = [(t[1], -t[0]) for t in (before, after)]  # the material is on the left
    corner = _cross(before, after)
    if abs(corner) <= SAME_DIRECTION:
        lean = v[0] * outward[0][0] + v[1] * outward[0][1]
        if abs(_cross(v, outward[0])) > SAME_DIRECTION:
            return None
        return "void" if lean > 0 else "material"
    sign = 1 if corner > 0 else -1  # the material's corner opens to the void, an inside one to the material
    shares = _cross(v, outward[1]) / corner * sign, _cross(outward[0], v) / corner * sign
    if min(shares) < -SAME_DIRECTION:
        return None
    return "void" if sign > 0 else "material"


def _is_free(p: Point, q: Point, pieces: Sequence[_Piece]) -> bool:
    """Whether nothing crosses the connection between its ends."""
    connection = Line(p, q)
    near = 10 * ROUNDING_MM
    return all(
        min(dist(x, p), dist(x, q)) <= near
        for piece in pieces
        for x in meeting_points(connection, piece.segment)
    )


def _cross(a: Point, b: Point) -> float:
    return a[0] * b[1] - a[1] * b[0]
