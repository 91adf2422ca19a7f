"""Dimensions of a plan: callouts, each with its leader's possible targets (equal holes together, pockets and
grooves, radii, and a disc's outside); and linear ones.

Running dimensions go from one origin to edges, holes, corners and centres, each determining something new;
each limit between two edges of the outline has a dimension line.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, product
from math import atan2, degrees, isclose

from tactcad.contour import Arc, Contour, Line
from tactcad.parts.language.description import Hole, Part, Pocket, Vector
from tactcad.parts.language.limits import FACES, Characteristic

from ..engine.boxes import Point
from .measures import (
    OUTER,
    THICKNESS,
    Distance,
    Level,
    MeasureDifference,
    Offset,
    Owner,
    Quantity,
    Round,
    Slope,
    Span,
    Spot,
    Values,
    Width,
    axis_of,
    contours,
    halfway,
    in_part,
    level,
    radius_of,
    size,
    widest,
)
from .sheet_plan import OUTWARDS, Callout, Dimension, Linear, Running, Side, View, seen
from .sketch import ALIKE, Coordinate, Sketch, edge_level
from .tolerances import frames_of, letter_of, places

LEAST_ROW = 6  # equal holes in a line that count as a regular row
# Names of a hole's variables in characteristics.
WORDS = {Quantity.DIAMETER: "diameter"}
EVEN = 5e-6  # mm: steps of a row are equal within this; places are given to a nanometre
HEIGHTS = {"axle": "axles over the underside"}
SIDES: tuple[Side, Side] = ("bottom", "left")  # of distances along x and along y


@dataclass(frozen=True)
class Group:
    """Equal holes, the lines of their callout, and the dimensions in the lines."""

    holes: tuple[Round, ...]
    lines: tuple[str, ...]
    dimensions: tuple[Dimension, ...]

    @property
    def axis(self) -> Vector:
        return self.holes[0].axis


def groups(holes: Sequence[Round], values: Values, eye_of: Mapping[int, Vector], part: Part) -> list[Group]:
    """Equal holes of the part together; `eye_of` gives the eye of the view that shows the holes along axis 0,
    1, 2 as circles. Holes that geometric tolerances or datums tell apart are not equal."""
    kinds: dict[tuple, list[Round]] = {}
    for r in holes:
        h = r.hole
        side = tuple(abs(a) for a in h.axis) if _same_from_both_sides(h) else h.axis
        depth = 0.0 if h.through else round(h.depth, 9)
        sizes = (round(h.diameter, 9), h.through, depth, h.counterbore, h.drill_point, h.tolerance)
        stated = [g.name for g in part.geometric if h.name in g.features]
        stated += [d.letter for d in part.datums if d.feature == h.name]
        key = (side, (*sizes, h.thread, round(h.thread_depth, 9), *stated))
        kinds.setdefault(key, []).append(r)
    own = {c.name: c for c in part.characteristics}
    return [_group(some, both, values, eye_of, own) for some, both in _both_ends(kinds)]


def _same_from_both_sides(h: Hole) -> bool:
    return h.through and not h.counterbore and (not h.thread or isclose(h.thread_depth, h.depth))


def _both_ends(kinds: dict[tuple, list[Round]]) -> list[tuple[list[Round], bool]]:
    """Groups that differ only in the face that they start from, at the same places, become one."""
    result: list[tuple[list[Round], bool]] = []
    left = dict(kinds)
    for (axis, spec), some in kinds.items():
        if left.pop((axis, spec), None) is None:
            continue
        k = next(i for i, a in enumerate(axis) if a)
        opposite = (tuple(-a + 0.0 for a in axis), spec)
        places = [
            {tuple(round(v, 6) for i, v in enumerate(r.at) if i != k) for r in rounds_}
            for rounds_ in (some, left.get(opposite, ()))
        ]
        both = places[0] == places[1]
        result.append((some + left.pop(opposite), True) if both else (some, False))
    return result


def _group(
    some: list[Round],
    both: bool,
    values: Values,
    eye_of: Mapping[int, Vector],
    own: Mapping[str, Characteristic],
) -> Group:
    h, label = some[0].hole, some[0].label

    def dimension(what: Quantity, sign: str, counted: bool = False) -> Dimension:
        rows = tuple(size(r.owner.size(what)) for r in some)
        return Dimension(f"{label} {WORDS.get(what, what)}", rows, sign, counted=counted)

    fit = remark = words = ""
    try:  # limits: the model is made at their middle
        upper, _, lower = h.tolerance.partition("/")
        limits = (float(upper), float(lower))
        modelled = round(sum(limits) / 2, 9)
    except ValueError:  # a fit in words
        limits, modelled, words = None, 0.0, h.tolerance
        fit, _, remark = words.partition(", ")
    if fit:
        # it belongs to the nominal size; the model is made within its field, hundredths of a millimetre away
        modelled = round(h.diameter - round(h.diameter, 1), 9)
    # the count of a thread is before the thread, or before its counterbore
    bore = dimension(Quantity.DIAMETER, "⌀", counted=not h.thread)
    bore = replace(bore, limits=limits, modelled=modelled, fit=fit)
    if c := own.get(bore.name):  # it is modelled between its limits
        remark = words if fit else remark
        bore = replace(
            bore,
            limits=(c.upper - c.nominal, c.lower - c.nominal),
            modelled=round(h.diameter - c.nominal, 9),
            characteristic=c,
            fit="",
        )
    used = [bore]
    depth = None if h.through else dimension(Quantity.DEPTH, "↧")
    ending = " through" if depth is None else f" {depth.text(values)}"
    cone = ", point 118°" if h.drill_point else ""
    used += [depth] if depth else []
    count = f"{len(some)}× " if len(some) > 1 else ""
    lines: list[str] = []
    if h.counterbore:
        wide, deep = dimension(Quantity.WIDE, "⌀"), dimension(Quantity.DEEP, "↧")
        used += [wide, deep]
        wider = f"{wide.text(values)} {deep.text(values)}"
    if h.thread:
        thread = None if h.thread_depth >= h.depth else dimension(Quantity.THREAD, "↧")
        used += [thread] if thread else []
        deep_thread = thread.text(values) if thread else ""
        if h.counterbore:
            lines += [f"{count}{wider}, below it"]
            lines += [f"{h.thread}-6H, full thread {deep_thread.removeprefix('↧')} long"]
        else:
            lines.append(f"{count}{h.thread}-6H {deep_thread or 'through'}")
        lines.append(f"drill {bore.text(values)}{ending}{cone}")
    else:
        lines.append(f"{bore.text(values)}{ending}{cone}")
        if h.counterbore:
            lines.append(f"counterbore {wider}")
    if remark:
        lines.append(remark)
    if both:
        lines.append("from both sides alike")
    elif not _same_from_both_sides(h) and sum(a * e for a, e in zip(h.axis, eye_of[axis_of(h)])) > 0:
        lines.append("from the far side")
    return Group(tuple(some), tuple(lines), tuple(used))


def regular_rows(called: Sequence[Group], k: int) -> list[list[Round]]:
    """Rows of at least LEAST_ROW equal holes along z, evenly spaced along the part's axis k, in order."""
    rows = []
    for group in called:
        lines: dict[float, list[Round]] = {}
        for r in group.holes if group.axis[2] else ():
            lines.setdefault(round(r.at[1 - k], 6), []).append(r)
        for line in lines.values():
            line.sort(key=lambda r: r.at[k])
            steps = [b.at[k] - a.at[k] for a, b in pairwise(line)]
            if len(line) >= LEAST_ROW and max(steps) - min(steps) < EVEN:
                rows.append(line)
    return rows


def round_outline(sketch: Sketch, centre: Point, radius: float) -> Callout:
    """Outside diameter of a disc; its openings about the same axis are in line with it."""
    d = sketch.must(Dimension("outside", (size(OUTER.size(Quantity.DIAMETER)),), "⌀"))
    return Callout((d.text(sketch.values),), ((centre, radius),), (d,))


def hole_callout(sketch: Sketch, view: View, g: Group) -> Callout:
    for d in g.dimensions:
        sketch.must(d)
    targets = [(seen(view, r.at), widest(r.hole) / 2) for r in g.holes]
    nearest = tuple(sorted(targets, key=lambda t: _to_outside(view, t[0])))
    names = [r.hole.name for r in g.holes]
    frames, letter = frames_of(sketch.part, names), letter_of(sketch.part, names)
    return Callout(g.lines, nearest, g.dimensions, frames=frames, datum=letter)


def _to_outside(view: View, p: Point) -> float:
    """From a point of the view to the nearest side of its box, mm; leaders are shortest if it is small."""
    u0, v0, u1, v1 = view.box
    return round(min(p[0] - u0, u1 - p[0], p[1] - v0, v1 - p[1]), 6)


def pocket_callouts(sketch: Sketch, view: View, part: Part) -> list[Callout]:
    """Depth of every pocket, with diameters of round ones, at its edge."""
    callouts = []
    for k, f in enumerate(part.features):
        if not isinstance(f, Pocket):
            continue
        lines, used = [], []
        if flats := _regular(sketch, part, k, in_part(f, f.contour)):
            used.append(sketch.must(flats))
            sides = sum(isinstance(s, Line) for s in f.contour)
            lines.append(f"{sides} sides, {flats.text(sketch.values)} across flats")

        def say(d: Dimension, used: list = used) -> str:
            used.append(sketch.must(d))
            return used[-1].text(sketch.values)

        pocket = Owner("pocket", k)
        for owner, c in ((pocket, f.contour), *((Owner("island", k, i), c) for i, c in enumerate(f.island))):
            diameter = owner.size(Quantity.DIAMETER)
            whole = owner == pocket and in_part(f, c).as_circle() == part.extrusion.outer.as_circle()
            if c.as_circle() and not whole:
                lines.append(say(Dimension(f"{f.name} diameter", (size(diameter),), "⌀")))
            elif c.as_circle():
                sketch.convention(Span(level(OUTER.size(Quantity.DIAMETER)), level(diameter)))
        depth = say(Dimension(f"{f.name} depth", (size(pocket.size(Quantity.DEPTH)),), "↧"))
        text = " / ".join(lines)
        label = f.name.replace("_", " ")
        if f.island:
            label = f"{label} groove" if f.island[0].as_circle() else f"faced off {label}"
        contour = in_part(f, f.contour)
        if circle := contour.as_circle():  # a leader may touch it anywhere
            spots = [(seen(view, (*circle[0], 0.0)), circle[1])]
        else:
            middles = [seen(view, (*s.at(0.5), 0.0)) for s in contour]
            spots = [(p, 0.0) for p in sorted(middles, key=lambda p: _to_outside(view, p))]
        callouts.append(Callout((f"{label} {text} {depth}".replace("  ", " "),), tuple(spots), tuple(used)))
    return callouts


def _regular(sketch: Sketch, part: Part, k: int, contour: Contour) -> Dimension | None:
    """Width across flats of a regular polygon in the middle of the outline; None for any other contour.

    A polygon drawn as regular counts as such: equal angles, equal distances from the outline's middle.
    """
    sides = [i for i, s in enumerate(contour) if isinstance(s, Line)]
    if len(sides) < 6 or len(sides) % 2:
        return None
    pocket, n = Owner("pocket", k), len(contour)
    x, y = (
        halfway(*(edge_level(sketch, OUTER, i, v) for v in part.extrusion.outer.box[i::2])) for i in (0, 1)
    )
    offsets = [Offset(Spot(pocket, i), Spot(pocket, (i + 1) % n), x, y) for i in sides]
    measured = [abs(o.of(sketch.values)) for o in offsets]
    if max(measured) - min(measured) > ALIKE:
        return None
    for i, offset in zip(sides, offsets):
        if min(abs(a - b) for a, b in zip(contour.segments[i].start, contour.segments[i].end)) > ALIKE:
            sketch.convention(Slope(offset.start, offset.end))
        if offset is not offsets[0]:
            sketch.convention(MeasureDifference(offset, offsets[0]))
    half = len(sides) // 2
    return Dimension(f"{part.features[k].name} across flats", (Width(offsets[0], offsets[half]),))


def radius_callouts(sketch: Sketch, view: View, part: Part) -> list[Callout]:
    """Radii that are not determined yet, equal ones of a contour together."""
    callouts = []
    for owner, contour in contours(part):
        if contour.as_circle():
            continue
        arcs = [
            (f"{owner} radius", radius_of(owner, i), s) for i, s in enumerate(contour) if isinstance(s, Arc)
        ]
        for c in part.characteristics:
            limited = [arc for arc in arcs if arc[2].name in c.between]
            callouts += equal_radii(sketch, view, limited, c.name)
            arcs = [arc for arc in arcs if arc not in limited]
        callouts += equal_radii(sketch, view, arcs)
    return callouts


def equal_radii(
    sketch: Sketch, view: View, arcs: Sequence[tuple[str, Distance, Arc]], states: str = ""
) -> list[Callout]:
    """Named arcs whose radii are not determined yet, equal ones in one callout, which `states` names."""
    kinds: dict[float, list[tuple[str, Distance, Arc]]] = {}
    for name, row, arc in arcs:
        kinds.setdefault(round(arc.radius, 6), []).append((name, row, arc))
    callouts = []
    for some in kinds.values():
        if new := [one for one in some if sketch.determined.takes(one[1])]:
            name = " and ".join(dict.fromkeys(name for name, _, _ in new))
            rows = tuple(row for _, row, _ in new)
            d = replace(sketch.stating(states, rows, plain=name), sign="R")
            if d.characteristic:
                del sketch.unstated[states]
            callouts.append(_radius_callout(sketch, view, d, [arc for _, _, arc in new]))
    return callouts


def _radius_callout(sketch: Sketch, view: View, d: Dimension, arcs: Sequence[Arc]) -> Callout:
    targets, spans = [], []
    for arc in arcs:
        centre = seen(view, (*arc.centre, 0.0))
        ends = [seen(view, (*p, 0.0)) for p in (arc.start, arc.end)]
        start, end = (degrees(atan2(v - centre[1], u - centre[0])) for u, v in ends)
        targets.append((centre, arc.radius))
        # counter-clockwise as seen
        spans.append((start, end) if arc.ccw == (view.right[0] >= 0) else (end, start))
    return Callout((d.text(sketch.values),), tuple(targets), (d,), tuple(spans))


def running_along(sketch: Sketch, view: View, side: Side, k: int, points: Sequence[Coordinate]) -> Running:
    """Running dimensions along the part's axis k (0 or 1) of the points there; mere corners are left to
    `filled`, what determines nothing new is left out.

    From the datum across the axis; without one from the view's left or lower edge, of a disc from its centre.
    """
    if not points:
        return Running(side, ())
    features = [c for c in points if not c.corner]
    edges = [c for c in features if c.contour == OUTER]
    # the first datum, if one of the points is at it
    data = [variable for d in sketch.part.datums for _, variable in places(sketch.part, (d.feature,))]
    first = next((c for variable in data for c in points if c.variable == variable and not c.corner), None)
    origin = first or min(edges or features, key=lambda c: _right_or_up(view, k) * c.at[k])
    sketch.known[k].append(origin)
    way = _way(sketch, view, k)
    # the outline first: centred features follow from it
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
    # the origin may be the upper edge of the view: the numbers still count from there
    bare = Running(side, ((None, seen(view, origin.at)),))
    return _with_stops(bare, sketch, view, 2, way, [*points, *faces.values()])


def _right_or_up(view: View, k: int) -> float:
    """1 if the part's axis k runs to the right or up in the view, -1 if it runs the other way."""
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
    """Start of the extension line: the feature's end nearer to the side."""
    (u, v), ends = OUTWARDS[side], [seen(view, p) for p in (c.at, c.other) if p]
    return max(ends, key=lambda p: p[0] * u + p[1] * v)


@dataclass(frozen=True)
class EdgeStand:
    """A dimension's reference on an outline's edge: its level along an axis, and a point of the edge, mm."""

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
    """Levels of the edges of that name along axis k: lines square to it; of a full round its summit."""
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
