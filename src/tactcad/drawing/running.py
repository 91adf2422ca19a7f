"""Running dimensions of a plan: edges, holes, corners and centres from one origin, each that says something
new."""

from __future__ import annotations

from collections.abc import Sequence

from tactcad.parts.description import Part

from .holes import Group
from .ink import Point
from .keys import OUTER, THICKNESS
from .measure import Span
from .plan import Dimension, Running, View, seen
from .sketch import ALIKE, Coordinate, Sketch

# Characteristics of parts that are a hole's height over the underside, by the hole's label.
HEIGHTS = {"axle": "axles over the underside"}


def running_along(
    sketch: Sketch, view: View, side: str, k: int, points: Sequence[Coordinate], centre: str | None
) -> Running:
    """Running dimensions of edges and holes along an axis, from the view's left or lower edge (of a disc: its
    centre)."""
    if not points:
        return Running(side, ())
    axis = view.right if k == 0 else view.up
    way = axis[k] or 1.0
    features = [c for c in points if not c.corner]
    edges = [c for c in features if c.variable.contour == OUTER]
    origin = min(edges or features, key=lambda c: way * c.at[k])
    sketch.known[k].append(origin)
    stops: list[tuple[Dimension | None, Point]] = [(None, _foot(view, side, origin))]
    # the outline first: what is centred on it follows from it
    for c in sorted(features, key=lambda c: (c not in edges, round(way * c.at[k], 6), str(c.variable))):
        stop = _stop(sketch, view, side, k, c, origin, way)
        if stop:
            stops.append(stop)
    return Running(side, tuple(stops))


def _stop(
    sketch: Sketch,
    view: View,
    side: str,
    k: int,
    c: Coordinate,
    origin: Coordinate,
    way: float,
    stated: str = "",
) -> tuple[Dimension, Point] | None:
    """One more dimension from the origin, unless the coordinate is in line with one that has it, or follows
    from it. `stated` names the part's characteristic that it is."""
    if c is origin:
        return None
    same = next((o for o in sketch.known[k] if abs(o.at[k] - c.at[k]) < ALIKE), None)
    if same:
        if same.level != c.level:
            sketch.convention(Span(same.level, c.level))
        return None
    row = Span(origin.level, c.level) if way > 0 else Span(c.level, origin.level)
    d = sketch.stating(stated, (row,), plain=c.name)
    if not sketch.new(d):
        return None
    sketch.known[k].append(c)
    return d, _foot(view, side, c)


def _foot(view: View, side: str, c: Coordinate) -> Point:
    """Where the extension line starts: at the feature's end that is nearer to the side."""
    outwards = {"top": (0, 1), "bottom": (0, -1), "left": (-1, 0), "right": (1, 0)}[side]
    ends = [seen(view, p) for p in (c.at, c.other) if p]
    return max(ends, key=lambda p: p[0] * outwards[0] + p[1] * outwards[1])


def filled(sketch: Sketch, view: View, r: Running, k: int, points: Sequence[Coordinate]) -> Running:
    """The running dimensions with what corners and centres still have to say."""
    if not r.stops:
        return r
    origin = sketch.known[k][0]
    way = (view.right if k == 0 else view.up)[k] or 1.0
    stops = list(r.stops)
    for c in points:
        stop = _stop(sketch, view, r.side, k, c, origin, way)
        if stop:
            stops.append(stop)
    return Running(r.side, tuple(stops))


def face_running(
    sketch: Sketch, view: View, part: Part, side: str, k: int, called: Sequence[Group]
) -> Running:
    """Holes of a side face along the face, from the same edge as in the front view."""
    origin = sketch.known[k][0]
    axis = (view.right, view.up)[0 if side in ("top", "bottom") else 1]
    way = axis[k]
    stops: list[tuple[Dimension | None, Point]] = [(None, _corner(view, part, origin, k))]
    known = sketch.known[k]
    sketch.known[k] = [origin]
    for r in sorted((r for g in called for r in g.holes), key=lambda r: (way * r.at[k], str(r.owner))):
        c = Coordinate(f"{r.label} {'xyz'[k]}", r.owner.place(k), r.at)
        stop = _stop(sketch, view, side, k, c, origin, way)
        if stop:
            stops.append(stop)
    sketch.known[k] = known
    return Running(side, tuple(stops))


def _corner(view: View, part: Part, c: Coordinate, k: int) -> Point:
    u0, v0, u1, v1 = view.box
    u, v = seen(view, c.at)
    return (min(max(u, u0), u1), v0 if v < v0 else v1 if v > v1 else v)


def depth_running(sketch: Sketch, view: View, part: Part, side: str, called: Sequence[Group]) -> Running:
    """Holes of a side face across the thickness, from the face z = 0, and the thickness itself."""
    t = part.body.thickness
    x0 = part.body.outer.box[0]
    origin = Coordinate("underside", None, (x0, 0.0, 0.0))
    upper = Coordinate("thickness", THICKNESS, (x0, 0.0, t))
    # z = 0 may be the upper edge of the view: the numbers still count from it
    stops: list[tuple[Dimension | None, Point]] = [(None, seen(view, origin.at))]
    sketch.known[2] = [origin]
    holes = sorted((r for g in called for r in g.holes), key=lambda r: (r.at[2], str(r.owner)))
    heights = [(Coordinate(f"{r.label} z", r.owner.place(2), r.at), HEIGHTS.get(r.label, "")) for r in holes]
    for c, stated in [*heights, (upper, "thickness")]:
        stop = _stop(sketch, view, side, 2, c, origin, 1.0, stated)
        if stop:
            stops.append(stop)
    return Running(side, tuple(stops))
