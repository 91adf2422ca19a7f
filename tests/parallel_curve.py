"""The parallel curve of a contour, exact: lines stay lines and arcs stay arcs."""

from __future__ import annotations

from dataclasses import dataclass
from math import dist

from tactcad.contour.contour import ROUNDING_MM, Contour
from tactcad.contour.inside import self_intersections
from tactcad.contour.nearest import meeting_points
from tactcad.contour.necks import direction
from tactcad.contour.segment import Arc, Line, Point, Segment


@dataclass(frozen=True)
class _Moved:
    """A segment after its move, and the original's ends, about which gaps at corners are rounded."""

    segment: Segment
    start: Point
    end: Point


def offset(contour: Contour, by: float) -> Contour:
    """The parallel curve: every point moved along its normal.

    Corners that open are rounded about their old place (the path of a wire's centre); corners that close are
    cut where the moved pieces meet, and a fillet smaller than the move vanishes there.

    Parameters
    ----------
    contour
        A simple closed contour, mm.
    by
        How far, mm: outwards, or inwards where negative.

    Returns
    -------
    Contour
        It runs in the same direction.

    Raises
    ------
    ValueError
        Where the move closes a slot, eats a web or a piece other than a fillet.
    """
    to_the_right = by if contour.ccw else -by
    moved = [m for m in (_moved(s, to_the_right) for s in contour) if m]
    if not moved or (len(moved) == 1 and len(contour) > 1):
        raise ValueError(f"nothing is left of the contour when it is moved by {by:g} mm")
    count = len(moved)
    joints = [_joint(moved[i - 1], moved[i], to_the_right) for i in range(count)]
    pieces: list[Segment] = []
    for m, joint, following in zip(moved, joints, joints[1:] + joints[:1]):
        if joint.fillet:
            pieces.append(joint.fillet)
        pieces.append(_between(m.segment, joint.leave, following.arrive, by))
    result = Contour(tuple(pieces))
    if self_intersections(result) or result.ccw != contour.ccw:
        raise ValueError(f"moved by {by:g} mm the contour runs into itself")
    return result


def _moved(s: Segment, by: float) -> _Moved | None:
    """The segment moved to the right of its direction; None where an arc shrinks to nothing."""
    if isinstance(s, Line):
        ux, uy = direction(s, s.start)
        dx, dy = by * uy, -by * ux
        line = Line((s.start[0] + dx, s.start[1] + dy), (s.end[0] + dx, s.end[1] + dy), s.name)
        return _Moved(line, s.start, s.end)
    grown = s.radius + (by if s.ccw else -by)
    if grown <= ROUNDING_MM:
        return None
    x, y = s.centre
    k = grown / s.radius
    ends = [(x + k * (p[0] - x), y + k * (p[1] - y)) for p in (s.start, s.end)]
    return _Moved(
        Arc(ends[0], ends[1] if s.start != s.end else ends[0], s.centre, s.ccw, s.name), s.start, s.end
    )


@dataclass(frozen=True)
class _Joint:
    """Where the piece before ends and the next one starts, with an arc between them if they differ."""

    arrive: Point
    leave: Point
    fillet: Arc | None = None


def _joint(before: _Moved, after: _Moved, to_the_right: float) -> _Joint:
    end, start = before.segment.end, after.segment.start
    if dist(end, start) <= ROUNDING_MM:
        return _Joint(start, start)
    (ux, uy), (vx, vy) = direction(before.segment, end), direction(after.segment, start)
    opens = (ux * vy - uy * vx) * to_the_right > 0 and before.end == after.start
    if opens:
        return _Joint(end, start, Arc(end, start, before.end, ccw=to_the_right > 0))
    met = meeting_points(before.segment, after.segment)  # pieces that close are cut, never lengthened
    if not met:
        raise ValueError(f"the pieces beside {after.start} no longer meet")
    corner = min(met, key=lambda p: dist(p, end) + dist(p, start))
    return _Joint(corner, corner)


def _between(s: Segment, start: Point, end: Point, by: float) -> Segment:
    """The segment cut to new ends that lie on it, in its old direction."""
    cut: Segment
    if isinstance(s, Arc):
        cut = arc = Arc(start, end, s.centre, s.ccw, s.name)
        if s.start == s.end:
            return cut
        turned = abs(arc.sweep) > abs(s.sweep) + 1e-9
    else:
        cut = Line(start, end, s.name)
        ux, uy = direction(s, s.start)
        turned = (end[0] - start[0]) * ux + (end[1] - start[1]) * uy <= ROUNDING_MM
    if turned:
        raise ValueError(f"moved by {by:g} mm, nothing is left of the piece at {s.start}")
    return cut
