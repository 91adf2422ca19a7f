"""Cut a contour at a line parallel to an axis: exact pieces of its lines and arcs."""

from __future__ import annotations

from math import acos, asin, pi, tau
from typing import Literal

from .contour import Contour
from .segment import Arc, Line, Point, Segment

ON_LINE_MM = 1e-9  # nearer to the cut than this counts as on it: rounding, not geometry


def cut(
    contour: Contour, axis: Literal["x", "y"], at: float, keep: Literal["below", "above"], name: str = "cut"
) -> tuple[Contour, ...]:
    """The parts of the enclosed area on one side of a line parallel to an axis.

    Parameters
    ----------
    contour
        Outline to cut.
    axis, at
        The line x = at or y = at, mm.
    keep
        Which side is kept.
    name
        Of the lines that then lie along the cut.

    Returns
    -------
    tuple of Contour
        Counter-clockwise; none if the whole contour lies on the other side.
    """
    i = 0 if axis == "x" else 1
    side = -1.0 if keep == "below" else 1.0
    outline = contour if contour.ccw else contour.reversed()
    pieces = [_snapped(piece, i, at) for s in outline for piece in _split(s, i, at)]
    kept = [p for p in pieces if side * (p.at(0.5)[i] - at) > ON_LINE_MM]
    if kept and all(side * (p.at(0.5)[i] - at) > -ON_LINE_MM for p in pieces):
        return (outline,)  # nothing lies beyond the line
    # the area lies to the left of the cut: up at the right-hand end of what is kept "below" in x
    forward = -side if axis == "x" else side
    return _closed(_chains(kept), 1 - i, forward, name)


def between(contour: Contour, x0: float, x1: float, names: tuple[str, str] = ("cut", "cut")) -> Contour:
    """The part of a contour between two lines parallel to y, as one closed contour.

    Parameters
    ----------
    contour
        Outline to cut.
    x0, x1
        The lines, mm; x0 < x1.
    names
        Of the lines that then lie along the two cuts.

    Raises
    ------
    ValueError
        If that is not one piece.
    """
    parts = [q for p in cut(contour, "x", x0, "above", names[0]) for q in cut(p, "x", x1, "below", names[1])]
    if len(parts) != 1:
        raise ValueError(f"between x = {x0:.6g} and {x1:.6g} the contour has {len(parts)} pieces")
    return parts[0]


def crossings(contour: Contour, axis: Literal["x", "y"], at: float) -> list[float]:
    """Crossings of a contour with a line parallel to an axis.

    Parameters
    ----------
    contour
        A closed contour, mm.
    axis, at
        The line x = at or y = at, mm.

    Returns
    -------
    list of float
        The other coordinates (mm), sorted; a vertex on the line counts once for each segment that ends there.
    """
    i = 0 if axis == "x" else 1
    crossed = [p[1 - i] for s in contour for p in _crossings(s, i, at)]
    crossed += [p[1 - i] for s in contour for p in (s.start, s.end) if p[i] == at]
    return sorted(crossed)


def _split(s: Segment, i: int, at: float) -> list[Segment]:
    """The segment's pieces between its crossings with the line."""
    points = [s.start, *_crossings(s, i, at), s.end]
    points = [points[0]] + [b for a, b in zip(points, points[1:]) if _far(a, b)]
    if len(points) < 2 or (not _far(points[-1], s.end) and len(points) == 2):
        return [s]
    points[-1] = s.end
    if isinstance(s, Line):
        return [Line(a, b, s.name) for a, b in zip(points, points[1:])]
    return [Arc(a, b, s.centre, s.ccw, s.name) for a, b in zip(points, points[1:])]


def _crossings(s: Segment, i: int, at: float) -> list[Point]:
    """Inner points of the segment on the line, in the order in which it passes them."""
    if isinstance(s, Line):
        a, b = s.start[i] - at, s.end[i] - at
        return [_on(s.at(a / (a - b)), i, at)] if a * b < 0.0 else []
    offset = (at - s.centre[i]) / s.radius
    if abs(offset) >= 1.0:
        return []
    angles = (acos(offset), -acos(offset)) if i == 0 else (asin(offset), pi - asin(offset))
    turns = [((a - s.start_angle) if s.ccw else (s.start_angle - a)) % tau for a in angles]
    return [_on(s.at(t / abs(s.sweep)), i, at) for t in sorted(turns) if 0.0 < t < abs(s.sweep)]


def _on(p: Point, i: int, at: float) -> Point:
    return (at, p[1]) if i == 0 else (p[0], at)


def _snapped(s: Segment, i: int, at: float) -> Segment:
    start, end = (_on(p, i, at) if abs(p[i] - at) < ON_LINE_MM else p for p in (s.start, s.end))
    return Line(start, end, s.name) if isinstance(s, Line) else Arc(start, end, s.centre, s.ccw, s.name)


def _far(a: Point, b: Point) -> bool:
    return abs(a[0] - b[0]) > ON_LINE_MM or abs(a[1] - b[1]) > ON_LINE_MM


def _chains(pieces: list[Segment]) -> list[list[Segment]]:
    """Runs of pieces that follow one another."""
    chains: list[list[Segment]] = []
    for piece in pieces:
        if chains and chains[-1][-1].end == piece.start:
            chains[-1].append(piece)
        else:
            chains.append([piece])
    if len(chains) > 1 and chains[-1][-1].end == chains[0][0].start:
        chains[0] = chains.pop() + chains[0]
    return chains


def _closed(chains: list[list[Segment]], j: int, forward: float, name: str) -> tuple[Contour, ...]:
    """Join chains along the cut, from each end to the next start in the forward direction."""
    contours, waiting = [], list(chains)
    while waiting:
        loop = waiting.pop(0)
        while True:
            end = loop[-1].end
            starts = [loop, *waiting]
            ahead = [c for c in starts if forward * (c[0].start[j] - end[j]) >= 0.0]
            following = min(ahead, key=lambda c: forward * (c[0].start[j] - end[j]))
            if following[0].start != end:
                loop = loop + [Line(end, following[0].start, name)]
            if following is starts[0]:
                break
            waiting = [c for c in waiting if c is not following]
            loop = loop + following
        contours.append(Contour(tuple(loop)))
    return tuple(contours)
