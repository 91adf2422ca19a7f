"""Linear dimensions of a plan: running ones from one origin to edges, holes, corners and centres, each
determining something new; and a dimension line for each limit between two edges of the outline.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product

from tactcad.contour import Arc, Line
from tactcad.parts.description import Part
from tactcad.parts.limits import FACES

from ..engine.boxes import Point
from .callouts import Group
from .measures import Level, Span, level
from .part_variables import OUTER, THICKNESS, Spot
from .sheet_plan import OUTWARDS, Linear, Running, Side, View, seen
from .sketch import ALIKE, Coordinate, Sketch
from .tolerances import places

# Characteristics of parts that are a hole's height over the underside, by the hole's label.
HEIGHTS = {"axle": "axles over the underside"}
SIDES: tuple[Side, Side] = ("bottom", "left")  # of distances along x and along y


def running_along(sketch: Sketch, view: View, side: Side, k: int, points: Sequence[Coordinate]) -> Running:
    """Running dimensions along the part's axis k (0 or 1) of the points there; mere corners are left to
    `filled`, what determines nothing new is left out.

    From the datum across the axis; without one from the view's left or lower edge, of a disc from its centre.
    """
    if not points:
        return Running(side, ())
    features = [c for c in points if not c.corner]
    edges = [c for c in features if c.contour == OUTER]
    # the first datum, where one of the points is at it
    data = [variable for d in sketch.part.datums for _, variable in places(sketch.part, (d.feature,))]
    first = next((c for variable in data for c in points if c.variable == variable and not c.corner), None)
    origin = first or min(edges or features, key=lambda c: _right_or_up(view, k) * c.at[k])
    sketch.known[k].append(origin)
    way = _way(sketch, view, k)
    # the outline first: what is centred on it follows from it
    features.sort(key=lambda c: (c not in edges, round(way * c.at[k], 6), str(c.variable)))
    start = _foot(view, side, origin)
    return _with_stops(Running(side, ((None, start),)), sketch, view, k, way, features)


def filled(sketch: Sketch, view: View, r: Running, k: int, points: Sequence[Coordinate]) -> Running:
    """The running dimensions, with stops for corners and centres that still determine something."""
    if not r.stops:
        return r
    return _with_stops(r, sketch, view, k, _way(sketch, view, k), points)


def face_running(sketch: Sketch, view: View, side: Side, k: int, called: Sequence[Group]) -> Running:
    """Holes of a side face along the face (axis k), from the same edge as in the front view."""
    known, origin = sketch.known[k], sketch.known[k][0]
    way = _way(sketch, view, k)
    holes = sorted((r for g in called for r in g.holes), key=lambda r: (way * r.at[k], str(r.owner)))
    points = [Coordinate(f"{r.label} {'xyz'[k]}", r.owner.place(k), r.at) for r in holes]
    sketch.known[k] = [origin]
    u0, v0, u1, v1 = view.box
    u, v = seen(view, origin.at)
    foot = (min(max(u, u0), u1), v0 if v < v0 else v1 if v > v1 else v)
    r = _with_stops(Running(side, ((None, foot),)), sketch, view, k, way, points)
    sketch.known[k] = known
    return r


def depth_running(sketch: Sketch, view: View, part: Part, side: Side, called: Sequence[Group]) -> Running:
    """Holes of a side face across the thickness, from a datum face or z = 0; and the thickness."""
    body = part.extrusion
    x0 = body.outer.box[0]
    faces = {
        FACES[0]: Coordinate("thickness", None, (x0, 0.0, 0.0), states="thickness"),
        FACES[1]: Coordinate("thickness", THICKNESS, (x0, 0.0, body.thickness), states="thickness"),
    }
    origin = faces.pop(next((d.feature for d in part.datums if d.feature in faces), FACES[0]))
    way = 1.0 if origin.variable is None else -1.0
    sketch.known[2] = [origin]
    holes = sorted((r for g in called for r in g.holes), key=lambda r: (way * r.at[2], str(r.owner)))
    heights = [(r, HEIGHTS.get(r.label, "")) for r in holes]
    points = [Coordinate(f"{r.label} z", r.owner.place(2), r.at, states=states) for r, states in heights]
    # the origin may be the upper edge of the view: the numbers still count from it
    bare = Running(side, ((None, seen(view, origin.at)),))
    return _with_stops(bare, sketch, view, 2, way, [*points, *faces.values()])


def _right_or_up(view: View, k: int) -> float:
    """1 where the part's axis k runs to the right or up in the view, -1 where it runs the other way."""
    return (view.right if k == 0 else view.up)[k] or 1.0


def _way(sketch: Sketch, view: View, k: int) -> float:
    """Sign of counting along axis k: to the right or up, from an edge at that end the other way."""
    way, box = _right_or_up(view, k), sketch.part.extrusion.outer.box
    last = max(way * box[k], way * box[k + 2])
    return -way if abs(way * sketch.known[k][0].at[k] - last) < ALIKE else way


def _with_stops(
    r: Running, sketch: Sketch, view: View, k: int, way: float, points: Sequence[Coordinate]
) -> Running:
    """One more dimension from the origin for every point that does not follow from those that have one."""
    origin, stops = sketch.known[k][0], list(r.stops)
    for c in points:
        if c is origin:
            continue
        same = next((o for o in sketch.known[k] if abs(o.at[k] - c.at[k]) < ALIKE), None)
        if same:
            if same.level != c.level:
                sketch.convention(Span(same.level, c.level))
            continue
        row = Span(origin.level, c.level) if way > 0 else Span(c.level, origin.level)
        d = sketch.stating(c.states, (row,), plain=c.name)
        d = replace(d, basic=d.characteristic is None and sketch.locates(origin, c, k))
        if sketch.new(d):
            sketch.known[k].append(c)
            stops.append((d, _foot(view, r.side, c)))
    return Running(r.side, tuple(stops))


def _foot(view: View, side: Side, c: Coordinate) -> Point:
    """Where the extension line starts: at the feature's end that is nearer to the side."""
    (u, v), ends = OUTWARDS[side], [seen(view, p) for p in (c.at, c.other) if p]
    return max(ends, key=lambda p: p[0] * u + p[1] * v)


@dataclass(frozen=True)
class EdgeStand:
    """Where a dimension stands on an outline's edge: its level along an axis, and a point of it, mm."""

    level: Level
    value: float
    at: Point


def edge_spans(sketch: Sketch, view: View, part: Part) -> list[Linear]:
    """Dimension lines for limits between two edges of the outline that are the nominal size apart."""
    linears = []
    for c in (c for c in part.characteristics if len(c.between) == 2):
        for k in (0, 1):
            firsts, seconds = (list(_stands(part, name, k)) for name in c.between)
            pairs = [sorted(pair, key=lambda stand: stand.value) for pair in product(firsts, seconds)]
            apart = [(a, b) for a, b in pairs if abs(b.value - a.value - c.nominal) < ALIKE]
            if apart:
                a, b = apart[0]
                d = sketch.must(sketch.stating(c.name, (Span(a.level, b.level),)))
                linears.append(Linear(d, SIDES[k], seen(view, (*a.at, 0.0)), seen(view, (*b.at, 0.0))))
                break
    return linears


def _stands(part: Part, name: str, k: int) -> Iterator[EdgeStand]:
    """Where edges of that name stand along axis k: lines square to it; of a full round its summit."""
    for i, s in enumerate(part.extrusion.outer):
        if s.name != name:
            continue
        if isinstance(s, Line) and abs(s.start[k] - s.end[k]) < ALIKE:
            yield EdgeStand(level(Spot(OUTER, i).place(k)), s.start[k], s.start)
        elif isinstance(s, Arc) and all(abs(p[k] - s.centre[k]) < ALIKE for p in (s.start, s.end)):
            # half a turn: its summit is a radius, which its start has across the axis, from its centre
            start, centre, across = Spot(OUTER, i), Spot(OUTER, i, centre=True), 1 - k
            out = 1.0 if s.start[across] > s.centre[across] else -1.0
            top = s.at(0.5)
            way = out if top[k] > s.centre[k] else -out
            terms = ((centre.place(k), 1.0), (start.place(across), way), (centre.place(across), -way))
            yield EdgeStand(Level(terms), top[k], top)
