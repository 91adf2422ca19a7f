"""Polygons with rounded corners, as exact chains of lines and tangent arcs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import hypot

from .contour import Contour
from .segment import Arc, Line, Point, Segment

# Lengths below this are the rounding of coordinates of the order of 100 mm, not geometry.
ROUNDING_MM = 1e-9


@dataclass(frozen=True)
class Corner:
    """A polygon's corner (mm), its fillet radius (mm, 0 for sharp), and names.

    `edge` names the line that leaves the corner, `fillet` the arc that rounds it.
    """

    at: Point
    radius: float = 0.0
    edge: str = ""
    fillet: str = ""


def rounded_polygon(corners: list[Corner]) -> Contour:
    """The closed contour through corners, each rounded by its radius.

    Where two fillets use up a whole edge the edge vanishes and the arcs meet; two that then share their
    centre (a full round) become one arc.

    Parameters
    ----------
    corners
        In their order, mm; a radius of 0 is a sharp corner.

    Returns
    -------
    Contour
        Lines and tangent arcs, in the corners' order.

    Raises
    ------
    ValueError
        If fillets do not fit an edge, two corners coincide, or the edges at a rounded corner are parallel.
    """
    count = len(corners)
    arcs = [_fillet(corners[i - 1].at, corners[i], corners[(i + 1) % count].at) for i in range(count)]
    pieces: list[Segment] = []
    for i, corner in enumerate(corners):
        after = (i + 1) % count
        arc, next_arc = arcs[i], arcs[after]
        start = arc.end if arc else corner.at
        end = next_arc.start if next_arc else corners[after].at
        room = _along(corner.at, corners[after].at, start, end)
        if room < -ROUNDING_MM:
            raise ValueError(f"fillets overlap by {-room:.6g} mm on the edge {corner.edge!r}")
        if arc:
            pieces.append(arc)
        if room > ROUNDING_MM:
            pieces.append(Line(start, end, corner.edge))
        elif next_arc and arc:  # the edge is used up: both arcs end at the same point
            arcs[after] = longer = replace(next_arc, start=start)
            if after == 0:
                pieces[0] = longer
        elif next_arc:
            arcs[after] = longer = replace(next_arc, start=corner.at)
            if after == 0:
                pieces[0] = longer
        elif arc:
            pieces[-1] = replace(arc, end=corners[after].at)
    return Contour(tuple(_merged(pieces)))


def _fillet(before: Point, corner: Corner, after: Point) -> Arc | None:
    """The arc tangent to both edges at the corner, from the one that comes in to the one that leaves."""
    if corner.radius == 0.0:
        return None
    x, y = corner.at
    ux, uy = _unit(before, corner.at)
    vx, vy = _unit(corner.at, after)
    cross, dot = ux * vy - uy * vx, ux * vx + uy * vy
    if abs(cross) < 1e-12:
        raise ValueError(f"no corner to round at {corner.at}: the edges are parallel")
    # tangent length r tan(turn/2), with tan(turn/2) = |cross|/(1 + dot), 1 for a right angle
    reach = corner.radius * abs(cross) / (1.0 + dot)
    side = 1.0 if cross > 0 else -1.0
    start = (x - ux * reach, y - uy * reach)
    end = (x + vx * reach, y + vy * reach)
    centre = (start[0] - side * uy * corner.radius, start[1] + side * ux * corner.radius)
    return Arc(start, end, centre, cross > 0, corner.fillet)


def _merged(pieces: list[Segment]) -> list[Segment]:
    """Join neighbouring arcs of one circle (a full round is one arc, not two)."""
    merged: list[Segment] = []
    for piece in pieces:
        if merged and (joined := _joined(merged[-1], piece)):
            merged[-1] = joined
        else:
            merged.append(piece)
    if len(merged) > 1 and (joined := _joined(merged[-1], merged[0])):
        merged.pop()
        merged[0] = joined
    return merged


def _joined(a: Segment, b: Segment) -> Arc | None:
    """Two neighbouring arcs joined to one if they are of one circle, else None."""
    if not (isinstance(a, Arc) and isinstance(b, Arc)):
        return None
    near = hypot(a.centre[0] - b.centre[0], a.centre[1] - b.centre[1]) < ROUNDING_MM
    same = near and abs(a.radius - b.radius) < ROUNDING_MM and a.ccw == b.ccw
    return Arc(a.start, b.end, a.centre, a.ccw, a.name) if same else None


def _unit(a: Point, b: Point) -> Point:
    dx, dy = b[0] - a[0], b[1] - a[1]
    size = hypot(dx, dy)
    if size == 0.0:
        raise ValueError(f"two corners coincide at {a}")
    # axis-parallel edges, the rule here, give exact units
    return (dx / size, dy / size)


def _along(a: Point, b: Point, start: Point, end: Point) -> float:
    """Distance from start to end, counted positive in the direction from a to b."""
    ux, uy = _unit(a, b)
    return (end[0] - start[0]) * ux + (end[1] - start[1]) * uy
