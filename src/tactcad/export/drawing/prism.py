"""The plan of a plate, disc or block: outline and holes by running dimensions from one corner, callouts for the rest.

What the rule-made dimensions leave open is filled by whatever coordinate or radius says something new, so that the
account of `Determined` closes for any outline of lines and arcs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import atan2, degrees

from tactcad.contour import Arc, Contour, Line
from tactcad.design.messages import CheckFailure
from tactcad.design.tree import Design
from tactcad.parts.description import Extrusion, Hole, Part, Pocket, Vector

from .contours import contours
from .holes import Group, groups, rounds
from .ink import Point
from .measure import (
    Determined,
    Difference,
    Level,
    Measure,
    Offset,
    Radius,
    Slope,
    Span,
    Width,
    conventions,
    halfway,
    in_part,
    level,
    size,
    variables,
)
from .plan import Callout, Characteristic, Datum, Dimension, Linear, Plan, Running, View, characteristic, seen
from .section import section_of, section_view

FRONT = ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0))
BACK = ((0.0, 0.0, -1.0), (0.0, 1.0, 0.0))
ALIKE = 1e-6  # mm: coordinates nearer than this are one


@dataclass(frozen=True)
class Coordinate:
    """A feature's coordinate along one axis of the part, a point of it in the part (x, y, z), and an edge's other end."""

    name: str
    level: Level
    at: Vector
    other: Vector | None = None


class Sketch:
    """A plan in the making: the account of what is determined, and what says it."""

    def __init__(self, part: Part) -> None:
        self.part = part
        self.values = variables(part)
        self.account = Determined(self.values)
        self.conventions: list[Measure] = []
        self.known: dict[int, list[Coordinate]] = {0: [], 1: [], 2: []}

    def convention(self, row: Measure) -> None:
        self.conventions.append(row)
        self.account.takes(row)

    def new(self, dimension: Dimension) -> bool:
        """Whether a dimension says something new with every one of its rows; if so it is taken up."""
        before = self.account.basis
        if all([self.account.takes(row) for row in dimension.rows]):
            return True
        self.account.basis = before
        return False

    def must(self, dimension: Dimension) -> Dimension:
        """A dimension that has to be new. Raises CheckFailure where it repeats what is said already."""
        if not self.new(dimension):
            raise CheckFailure(f"drawings: {self.part.part_no}: {dimension.name} is given twice")
        return dimension


def prism_plan(part: Part, design: Design, notes: Sequence[str], cut: bool = True) -> Plan:
    """The plan of any extruded part, with a section where it is of use and `cut` asks for it. Raises CheckFailure where a characteristic or a variable stays without dimension."""
    body = part.body
    assert isinstance(body, Extrusion)
    sketch = Sketch(part)
    for name, contour in contours(part):
        for row in conventions(name, contour):
            sketch.convention(row)
    found = rounds(part, design)
    eye, up = _front([r.axis for r in found] + [f.axis for f in part.features if isinstance(f, Pocket)] * (len(found) + 1))
    right = View("", eye, up, (0, 0, 0, 0)).right
    below = _below_eye(found, up)
    eyes = {2: eye, 1: below or up, 0: tuple(-r for r in right)}
    called = groups(found, sketch.values, eyes)
    limits = {c.name: c for c in part.characteristics}
    front = _front_view(sketch, part, eye, up, called, limits)
    views = [front]
    if below:
        views.append(_sunk_view(sketch, part, front, "below" if below == up else "above", below, called, limits))
    section = section_of(part, found, front, below) if cut else None
    aside = [g for g in called if g.axis[0]]
    if aside or not below:
        side = side_view(sketch, part, front, called if aside else [], limits, thickness=not below)
        views.append(replace(side, section=section, hidden=False) if section and section.axis == 0 else side)
    if section and (below or section.axis == 1):
        view = section_view(front, below, section)
        views.append(replace(view, box=view_box(view, part)))
    if limits:
        raise CheckFailure(f"drawings: {part.part_no}: no dimension states {', '.join(limits)}")
    closed(sketch)
    return Plan(part, sketch.values, tuple(sketch.conventions), tuple(views), tuple(notes))


def closed(sketch: Sketch) -> None:
    """Raise CheckFailure unless everything but the place on the paper is determined."""
    missing = len(sketch.values) - 2 - sketch.account.rank
    if missing:
        raise CheckFailure(f"drawings: {sketch.part.part_no}: {missing} dimensions are missing")


def _front(axes: Sequence[Vector]) -> tuple[Vector, Vector]:
    """The face from which more is made is seen from the front; axes lead into the material."""
    from_top = sum(1 for axis in axes if axis[2] < 0)
    from_below = sum(1 for axis in axes if axis[2] > 0)
    return BACK if from_below > from_top else FRONT


def _below_eye(found: Sequence, up: Vector) -> Vector | None:
    """Where holes are sunk into the y faces: the eye that sees more of them, the upper face first; else None."""
    upper = sum(1 for r in found if r.axis[1] < 0)
    lower = sum(1 for r in found if r.axis[1] > 0)
    if not upper + lower:
        return None
    return up if upper >= lower else tuple(-u for u in up)


def view_box(view: View, part: Part) -> tuple[float, float, float, float]:
    x0, y0, x1, y1 = part.body.outer.box
    points = [seen(view, (x, y, z)) for x in (x0, x1) for y in (y0, y1) for z in (0.0, part.body.thickness)]
    us, vs = zip(*points)
    return (min(us), min(vs), max(us), max(vs))


# --- front view ---


def _front_view(
    sketch: Sketch, part: Part, eye: Vector, up: Vector, called: Sequence[Group], limits: dict[str, Characteristic]
) -> View:
    view = View("front", eye, up, (0, 0, 0, 0))
    view = replace(view, box=view_box(view, part))
    along_z = [g for g in called if g.axis[2]]
    callouts = [hole_callout(sketch, view, g) for g in along_z]
    callouts += _pocket_callouts(sketch, view, part, limits)
    points = [c for name, contour in contours(part) for c in _coordinates(name, contour)]
    points += [
        Coordinate(f"{r.label} {'xy'[k]}", level(f"{r.name}.{'xy'[k]}"), r.at) for g in along_z for r in g.holes for k in (0, 1)
    ]
    disc = part.body.outer.as_circle()
    linears: list[Linear] = []
    if disc:
        callouts.insert(0, _round_outline(sketch, part))
        linears = _lands(sketch, view, part, limits)
    runnings = []
    for k, side in ((0, "top"), (1, "right")):
        mine = [c for c in points if c.level.names[0].endswith("xy"[k]) and "c" not in c.level.names[0].rsplit(".", 1)[1]]
        runnings.append(_running(sketch, view, side, k, mine, "outer" if disc else None))
    callouts += _radius_callouts(sketch, view, part)
    for k, index in ((0, 0), (1, 1)):
        rest = [c for c in points if c.level.names[0].rsplit(".", 1)[1].endswith("xy"[k])]
        runnings[index] = _filled(sketch, view, runnings[index], k, rest)
    datums = () if disc else _datums(view, part.body.outer)
    return replace(
        view, linears=tuple(linears), runnings=tuple(r for r in runnings if len(r.stops) > 1), callouts=tuple(callouts), datums=datums,
        centres=tuple((seen(view, r.at), _widest(r.hole)) for g in along_z for r in g.holes)
        + (((seen(view, (*disc[0], 0.0)), 2 * disc[1]),) if disc else ()),
        threads=_threads(view, along_z),
    )  # fmt: skip


def _datums(view: View, outer: Contour) -> tuple[Datum, ...]:
    """Letters on the two edges that the running dimensions start from: on the longest there that has room."""
    lines = [(seen(view, (*s.start, 0.0)), seen(view, (*s.end, 0.0))) for s in outer if isinstance(s, Line)]
    found = []
    for letter, k, away in (("B", 0, (-1.0, 0.0)), ("C", 1, (0.0, -1.0))):
        on = [(p, q) for p, q in lines if max(abs(p[k] - view.box[k]), abs(q[k] - view.box[k])) < ALIKE]
        longest = sorted(on, key=lambda e: -round(abs(e[0][1 - k] - e[1][1 - k]), 6))
        found += [Datum(letter, *edge, away) for edge in longest]
    return tuple(found)


def _coordinates(name: str, contour: Contour) -> list[Coordinate]:
    """Coordinates of a contour that may carry a dimension: edges first, then corners, then arcs' centres."""
    if circle := contour.as_circle():
        at = (*circle[0], 0.0)
        return [Coordinate(f"{name} {a}", level(f"{name}.{a}"), at) for a in "xy"]
    edges, corners, centres = [], [], []
    for i, s in enumerate(contour):
        label = s.name or f"{name} {i}"
        if isinstance(s, Line):
            for k, a in ((0, "x"), (1, "y")):
                if abs(s.start[k] - s.end[k]) < 1e-9:
                    edges.append(Coordinate(label, level(f"{name}.{i}.{a}"), (*s.start, 0.0), (*s.end, 0.0)))
        else:
            centres += [Coordinate(f"{label} centre", level(f"{name}.{i}.c{a}"), (*s.centre, 0.0)) for a in "xy"]
        corners += [Coordinate(f"{label} start", level(f"{name}.{i}.{a}"), (*s.start, 0.0)) for a in "xy"]
    return edges + corners + centres


def _running(sketch: Sketch, view: View, side: str, k: int, points: Sequence[Coordinate], centre: str | None) -> Running:
    """Running dimensions of edges and holes along an axis, from the view's left or lower edge (of a disc: its centre)."""
    if not points:
        return Running(side, ())
    axis = view.right if k == 0 else view.up
    way = axis[k] or 1.0
    corners = [c for c in points if not c.name.endswith(" start")]
    edges = [c for c in corners if c.level.names[0].startswith("outer")]
    origin = min(edges or corners, key=lambda c: way * c.at[k])
    sketch.known[k].append(origin)
    stops: list[tuple[Dimension | None, Point]] = [(None, _foot(view, side, origin))]
    # the outline first: what is centred on it follows from it
    for c in sorted(corners, key=lambda c: (c not in edges, round(way * c.at[k], 6), c.level.names)):
        stop = _stop(sketch, view, side, k, c, origin, way)
        if stop:
            stops.append(stop)
    return Running(side, tuple(stops))


def _stop(
    sketch: Sketch, view: View, side: str, k: int, c: Coordinate, origin: Coordinate, way: float,
    limits: Characteristic | None = None,
) -> tuple[Dimension, Point] | None:
    """One more dimension from the origin, unless the coordinate is in line with one that has it, or follows from it."""
    if c is origin:
        return None
    same = next((o for o in sketch.known[k] if abs(o.at[k] - c.at[k]) < ALIKE), None)
    if same:
        if same.level != c.level:
            sketch.convention(Span(same.level, c.level))
        return None
    row = Span(origin.level, c.level) if way > 0 else Span(c.level, origin.level)
    d = characteristic(limits, (row,)) if limits else Dimension(c.name, (row,))
    if not sketch.new(d):
        return None
    sketch.known[k].append(c)
    return d, _foot(view, side, c)


def _foot(view: View, side: str, c: Coordinate) -> Point:
    """Where the extension line starts: at the feature's end that is nearer to the side."""
    outwards = {"top": (0, 1), "bottom": (0, -1), "left": (-1, 0), "right": (1, 0)}[side]
    ends = [seen(view, p) for p in (c.at, c.other) if p]
    return max(ends, key=lambda p: p[0] * outwards[0] + p[1] * outwards[1])


def _filled(sketch: Sketch, view: View, r: Running, k: int, points: Sequence[Coordinate]) -> Running:
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


def _round_outline(sketch: Sketch, part: Part) -> Callout:
    """Outside diameter of a disc; its openings about the same axis are in line with it."""
    centre, r = part.body.outer.as_circle()
    d = sketch.must(Dimension("outside", (size("outer.d"),), "⌀"))
    return Callout((d.text(sketch.values),), ((centre, r),), (d,))


def _lands(sketch: Sketch, view: View, part: Part, limits: dict[str, Characteristic]) -> list[Linear]:
    """Length and width of a rectangular land left standing in the middle of a disc, on its centre lines."""
    linears = []
    for k, f in enumerate(part.features):
        for i, island in enumerate(f.island if isinstance(f, Pocket) else ()):
            if len(island) != 4 or island.as_circle():
                continue
            x0, y0, x1, y1 = in_part(f, island).box
            for axis, low, high, side, p, q in (
                ("x", x0, x1, "top", (x0, y1), (x1, y1)), ("y", y0, y1, "right", (x1, y0), (x1, y1)),
            ):  # fmt: skip
                a, b = (_edge_level(sketch, f"island{k}.{i}", axis, v) for v in (low, high))
                sketch.convention(Span(halfway(a, b), level(f"outer.{axis}")))
                given = limits.pop(f"{f.name.removeprefix('around_')} along {axis}", None)
                name = f"{f.name} along {axis}"
                d = characteristic(given, (Span(a, b),)) if given else Dimension(name, (Span(a, b),))
                linears.append(Linear(sketch.must(d), side, seen(view, (*p, 0.0)), seen(view, (*q, 0.0))))
    return linears


def _edge_level(sketch: Sketch, name: str, axis: str, value: float) -> Level:
    """The level of a contour's edge at a value along an axis."""
    found = [n for n, v in sketch.values.items() if n.startswith(f"{name}.") and n.endswith(f".{axis}") and abs(v - value) < ALIKE]
    return level(found[0])


# --- callouts ---


def hole_callout(sketch: Sketch, view: View, g: Group) -> Callout:
    for d in g.dimensions:
        sketch.must(d)
    targets = [(seen(view, r.at), _widest(r.hole) / 2) for r in g.holes]
    return Callout(g.lines, tuple(sorted(targets, key=lambda t: _to_outside(view, t[0]))), g.dimensions)


def _to_outside(view: View, p: Point) -> float:
    """Way from a point of the view to the nearest side of its box, mm: leaders are shortest from where it is small."""
    u0, v0, u1, v1 = view.box
    return round(min(p[0] - u0, u1 - p[0], p[1] - v0, v1 - p[1]), 6)


def _widest(h: Hole) -> float:
    return max(h.diameter, h.counterbore[0] if h.counterbore else 0.0)


def _pocket_callouts(sketch: Sketch, view: View, part: Part, limits: dict[str, Characteristic]) -> list[Callout]:
    """Depth of every pocket, with the diameters of what is round, at its edge."""
    callouts = []
    for k, f in enumerate(part.features):
        if not isinstance(f, Pocket):
            continue
        lines, used = [], []
        if flats := _regular(sketch, part, k, in_part(f, f.contour)):
            used.append(sketch.must(flats))
            lines.append(f"{sum(isinstance(s, Line) for s in f.contour)} sides, {flats.text(sketch.values)} across flats")

        def say(d: Dimension, used: list = used) -> str:
            used.append(sketch.must(d))
            return d.text(sketch.values)

        for name, c in ((f"pocket{k}", f.contour), *((f"island{k}.{i}", c) for i, c in enumerate(f.island))):
            if c.as_circle() and not (name.startswith("pocket") and _is_outline(part, f)):
                lines.append(say(Dimension(f"{f.name} diameter", (size(f"{name}.d"),), "⌀")))
            elif c.as_circle():
                sketch.convention(Span(level("outer.d"), level(f"{name}.d")))
        depth = say(Dimension(f"{f.name} depth", (size(f"pocket{k}.depth"),), "↧"))
        text = " / ".join(lines)
        label = f.name.replace("_", " ")
        if f.island:
            label = f"{label} groove" if f.island[0].as_circle() else f"faced off {label}"
        spots = _edge_targets(view, in_part(f, f.contour))
        callouts.append(Callout((f"{label} {text} {depth}".replace("  ", " "),), spots, tuple(used)))
    return callouts


def _edge_targets(view: View, contour: Contour) -> tuple[tuple[Point, float], ...]:
    """Where a leader may touch a contour: anywhere on a circle, else the middles of its segments."""
    if circle := contour.as_circle():
        return ((seen(view, (*circle[0], 0.0)), circle[1]),)
    middles = [seen(view, (*s.at(0.5), 0.0)) for s in contour]
    return tuple((p, 0.0) for p in sorted(middles, key=lambda p: _to_outside(view, p)))


def _regular(sketch: Sketch, part: Part, k: int, contour: Contour) -> Dimension | None:
    """Width across flats of a regular polygon in the middle of the outline; None where the contour is none.

    Drawn as regular: equal distances of all sides from the outline's middle, and equal angles between them.
    """
    sides = [i for i, s in enumerate(contour) if isinstance(s, Line)]
    if len(sides) < 6 or len(sides) % 2:
        return None
    name, n = f"pocket{k}", len(contour)
    x, y = (halfway(*(_edge_level(sketch, "outer", a, v) for v in part.body.outer.box[i::2])) for i, a in enumerate("xy"))
    offsets = [Offset(f"{name}.{i}", f"{name}.{(i + 1) % n}", x, y) for i in sides]
    measured = [abs(o.of(sketch.values)) for o in offsets]
    if max(measured) - min(measured) > ALIKE:
        return None
    for i, offset in zip(sides, offsets):
        if min(abs(a - b) for a, b in zip(contour.segments[i].start, contour.segments[i].end)) > ALIKE:
            sketch.convention(Slope(f"{name}.{i}", f"{name}.{(i + 1) % n}"))
        if offset is not offsets[0]:
            sketch.convention(Difference(offset, offsets[0]))
    half = len(sides) // 2
    return Dimension(f"{part.features[k].name} across flats", (Width(offsets[0], offsets[half]),))


def _is_outline(part: Part, f: Pocket) -> bool:
    return in_part(f, f.contour).as_circle() == part.body.outer.as_circle()


def _radius_callouts(sketch: Sketch, view: View, part: Part) -> list[Callout]:
    """Radii that are not determined yet, equal ones of a contour together."""
    callouts = []
    for name, contour in contours(part):
        if contour.as_circle():
            continue
        kinds: dict[float, list[int]] = {}
        for i, s in enumerate(contour):
            if isinstance(s, Arc):
                kinds.setdefault(round(s.radius, 6), []).append(i)
        for indices in kinds.values():
            rows = [Radius(name, i) for i in indices]
            new = [i for i, row in zip(indices, rows) if sketch.account.takes(row)]
            if new:
                d = Dimension(f"{name} radius", tuple(Radius(name, i) for i in new), "R")
                callouts.append(radius_callout(sketch, view, d, [contour.segments[i] for i in new]))
    return callouts


def radius_callout(sketch: Sketch, view: View, d: Dimension, arcs: Sequence[Arc]) -> Callout:
    targets, spans = [], []
    for arc in arcs:
        centre = seen(view, (*arc.centre, 0.0))
        angles = []
        for p in (arc.start, arc.end) if arc.ccw else (arc.end, arc.start):
            u, v = seen(view, (*p, 0.0))
            angles.append(_direction(u - centre[0], v - centre[1]))
        if view.right[0] < 0:
            angles.reverse()
        targets.append((centre, arc.radius))
        spans.append(tuple(angles))
    return Callout((d.text(sketch.values),), tuple(targets), (d,), tuple(spans))


def _direction(u: float, v: float) -> float:
    return degrees(atan2(v, u))


# --- the other views ---


def _sunk_view(
    sketch: Sketch, part: Part, front: View, name: str, eye: Vector, called: Sequence[Group],
    limits: dict[str, Characteristic],
) -> View:
    """The view onto a y face with its holes: x and z by running dimensions, the thickness the last of them."""
    sign = 1.0 if name == "below" else -1.0
    up = tuple(-sign * e for e in front.eye)
    view = View(name, eye, up, (0, 0, 0, 0))
    view = replace(view, box=view_box(view, part))
    mine = [g for g in called if g.axis[1]]
    callouts = [hole_callout(sketch, view, g) for g in mine]
    side = "bottom" if name == "below" else "top"
    return replace(
        view, callouts=tuple(callouts),
        runnings=(_face_running(sketch, view, part, side, 0, mine), _depth_running(sketch, view, part, "left", mine, limits)),
        centres=tuple((seen(view, r.at), _widest(r.hole)) for g in mine for r in g.holes),
        datums=_underside(view, part), threads=_threads(view, mine),
    )  # fmt: skip


def _threads(view: View, called: Sequence[Group]) -> tuple[tuple[Point, float], ...]:
    """Middles and nominal diameters of threads that are entered from the view's side or run through."""
    found = []
    for r in (r for g in called for r in g.holes if r.hole.thread):
        towards = sum(a * e for a, e in zip(r.axis, view.eye)) < 0
        if towards or r.hole.through and r.hole.thread_depth >= r.hole.depth:
            found.append((seen(view, r.at), float(r.hole.thread.removeprefix("M"))))
    return tuple(found)


def _face_running(sketch: Sketch, view: View, part: Part, side: str, k: int, called: Sequence[Group]) -> Running:
    """Holes of a side face along the face, from the same edge as in the front view."""
    origin = sketch.known[k][0]
    axis = (view.right, view.up)[0 if side in ("top", "bottom") else 1]
    way = axis[k]
    stops: list[tuple[Dimension | None, Point]] = [(None, _corner(view, part, origin, k))]
    known = sketch.known[k]
    sketch.known[k] = [origin]
    for r in sorted((r for g in called for r in g.holes), key=lambda r: (way * r.at[k], r.name)):
        c = Coordinate(f"{r.label} {'xyz'[k]}", level(f"{r.name}.{'xyz'[k]}"), r.at)
        stop = _stop(sketch, view, side, k, c, origin, way)
        if stop:
            stops.append(stop)
    sketch.known[k] = known
    return Running(side, tuple(stops))


def _corner(view: View, part: Part, c: Coordinate, k: int) -> Point:
    u0, v0, u1, v1 = view.box
    u, v = seen(view, c.at)
    return (min(max(u, u0), u1), v0 if v < v0 else v1 if v > v1 else v)


def _depth_running(
    sketch: Sketch, view: View, part: Part, side: str, called: Sequence[Group], limits: dict[str, Characteristic]
) -> Running:
    """Holes of a side face across the thickness, from the face z = 0, and the thickness itself."""
    t = part.body.thickness
    x0 = part.body.outer.box[0]
    origin = Coordinate("underside", Level(), (x0, 0.0, 0.0))
    upper = Coordinate("thickness", level("thickness"), (x0, 0.0, t))
    # z = 0 may be the upper edge of the view: the numbers still count from it
    stops: list[tuple[Dimension | None, Point]] = [(None, seen(view, origin.at))]
    sketch.known[2] = [origin]
    spots = [(f"{r.label} z", Coordinate(f"{r.label} z", level(f"{r.name}.z"), r.at)) for g in called for r in g.holes]
    for label, c in [*sorted(spots, key=lambda s: (s[1].at[2], s[1].level.names)), ("thickness", upper)]:
        wanted = {"axle z": "axles over the underside", "thickness": "thickness"}.get(label)
        given = limits.get(wanted) if wanted else None
        stop = _stop(sketch, view, side, 2, c, origin, 1.0, given)
        if stop:
            limits.pop(wanted, None) if given else None
            stops.append(stop)
    return Running(side, tuple(stops))


def side_view(
    sketch: Sketch, part: Part, front: View, called: Sequence[Group], limits: dict[str, Characteristic], thickness: bool
) -> View:
    """The view from the left, beside the front view: thickness, and holes of the x faces."""
    view = View("right", tuple(-r for r in front.right), front.up, (0, 0, 0, 0))
    view = replace(view, box=view_box(view, part))
    mine = [g for g in called if g.axis[0]]
    if mine:
        raise CheckFailure(f"drawings: {part.part_no}: holes in the x faces have no view yet")
    given = limits.pop("thickness", None)
    rows = (size("thickness"),)
    d = sketch.must(characteristic(given, rows, key_number(part, given)) if given else Dimension("thickness", rows))
    x0, y0, x1, y1 = view.box
    return replace(view, linears=(Linear(d, "bottom", (x0, y0), (x1, y0)),), datums=_underside(view, part))


def key_number(part: Part, c: Characteristic | None) -> int:
    """Number of a key characteristic on the sheet: its place among the part's; 0 for one that is not key."""
    keys = [k for k in part.characteristics if k.key]
    return keys.index(c) + 1 if c in keys else 0


def _underside(view: View, part: Part) -> tuple[Datum, ...]:
    """Letter A on the face z = 0."""
    u0, v0, u1, v1 = view.box
    zu, zv = view.right[2], view.up[2]
    if zu:
        u = u0 if zu > 0 else u1
        return (Datum("A", (u, v0), (u, v1), (-zu, 0.0)),)
    v = v0 if zv > 0 else v1
    return (Datum("A", (u0, v), (u1, v), (0.0, -zv)),)


