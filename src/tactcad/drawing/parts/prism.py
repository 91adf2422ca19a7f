"""The plans of a plate, disc or block, and of a turned part.

Of a plate, disc or block: outline and holes by running dimensions from one corner, callouts for the rest.
Variables that these leave undetermined get a dimension on whichever coordinate or radius determines more, so
that every outline of lines and arcs is fully dimensioned. Of a turned part: one view along its axis, which
lies level; diameters, and lengths between its faces.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

from tactcad.contour import Arc, Contour, Line
from tactcad.design.messages import CheckFailure
from tactcad.parts.language.description import Part, Pocket, Revolution, Vector

from ..engine.boxes import Point, bounds
from .broken import breaks_of
from .callouts import (
    Group,
    depth_running,
    edge_spans,
    equal_radii,
    face_running,
    filled,
    groups,
    hole_callout,
    pocket_callouts,
    radius_callouts,
    regular_rows,
    round_outline,
    running_along,
)
from .measures import (
    OUTER,
    PLACES,
    PROFILE,
    THICKNESS,
    Level,
    MeasureDifference,
    Owner,
    Round,
    Span,
    Spot,
    contours,
    conventions,
    halfway,
    level,
    radius_of,
    rounds,
    size,
    widest,
)
from .sections import section_of, section_view
from .sheet_plan import Callout, Dimension, Linear, SheetPlan, Side, View, opposite, seen
from .sketch import ALIKE, Coordinate, Sketch, closed, edge_level, view_of
from .tolerances import with_marks

FRONT = ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0))
BACK = ((0.0, 0.0, -1.0), (0.0, 1.0, 0.0))


def prism_plan(
    part: Part, notes: Sequence[str], cut: bool = True, shortened: bool = False
) -> SheetPlan | None:
    """The plan of any extruded part, `cut` with a section if useful; `shortened` with broken views and
    regular rows of holes by their ends and their number; None if too little could be left out.

    Raises CheckFailure if a variable or a limit of the part is missing on the sheet, or a limit is there
    twice.
    """
    body = part.extrusion
    sketch = Sketch(part)
    for name, contour in contours(part):
        for row in conventions(name, contour):
            sketch.convention(row)
    holes = rounds(part)
    # the front view shows the face with more features, pockets first; their axes lead into the material
    pockets = [f.axis[2] for f in part.features if isinstance(f, Pocket)]
    sunk = [r.axis[2] for r in holes] + pockets * (len(holes) + 1)
    eye, up = BACK if sum(z > 0 for z in sunk) > sum(z < 0 for z in sunk) else FRONT
    right = View("", eye, up, (0, 0, 0, 0)).right
    # if holes are sunk into the y faces: the eye that sees more of them, the upper face first
    upper, lower = sum(r.axis[1] < 0 for r in holes), sum(r.axis[1] > 0 for r in holes)
    below = None if not upper + lower else up if upper >= lower else opposite(up)
    eyes = {2: eye, 1: below or up, 0: opposite(right)}
    called = groups(holes, sketch.values, eyes, part)
    breaks, rows = None, []
    if shortened:
        x0, y0, x1, y1 = body.outer.box
        rows = regular_rows(called, 0 if x1 - x0 > y1 - y0 else 1)
        breaks = breaks_of(part, holes, {r.owner for row in rows for r in row[2:-2]})
        if breaks is None:
            return None
        notes = (*notes, "Views are broken; dimensions are those of the whole part")
    front = _front_view(sketch, view_of(part, "front", eye, up), part, called, rows)
    views = [*_with_detail(front, sketch)]
    if below:
        views.append(_sunk_view(sketch, part, front, below, called))
    section = section_of(part, holes, front, below) if cut else None
    if section and breaks and section.axis == breaks.axis and not breaks.shows(section.at):
        section = None
    if any(g.axis[0] for g in called):
        raise CheckFailure(f"drawings: {part.part_no}: holes in the x faces have no view yet")
    if not below:
        side = side_view(sketch, part, front)
        views.append(replace(side, section=section, hidden=False) if section and section.axis == 0 else side)
    if section and (below or section.axis == 1):
        views.append(section_view(part, front, below, section))
    marked = with_marks(part, views)
    closed(sketch, marked)
    return SheetPlan(part, sketch.values, tuple(sketch.conventions), marked, tuple(notes), breaks)


def _front_view(
    sketch: Sketch, view: View, part: Part, called: Sequence[Group], rows: Sequence[Sequence[Round]]
) -> View:
    along_z = [g for g in called if g.axis[2]]
    callouts = [hole_callout(sketch, view, g) for g in along_z]
    callouts += pocket_callouts(sketch, view, part)
    points = [c for name, contour in contours(part) for c in _coordinates(name, contour)]
    round_ones = [r for g in along_z for r in g.holes]
    points += [Coordinate(f"{r.label} {'xy'[k]}", r.owner.place(k), r.at) for r in round_ones for k in (0, 1)]
    centres = [(seen(view, r.at), widest(r.hole)) for r in round_ones]
    disc = part.extrusion.outer.as_circle()
    linears: list[Linear] = []
    if disc:
        callouts.insert(0, round_outline(sketch, *disc))
        centres.append((seen(view, (*disc[0], 0.0)), 2 * disc[1]))
        linears = _lands(sketch, view, part)
    linears += edge_spans(sketch, view, part)
    along = 0 if rows and rows[0][0].at[1] == rows[0][1].at[1] else 1
    repeated = {r.owner.place(along) for row in rows for r in row[1:-1]}
    repeated |= {r.owner.place(1 - along) for row in rows for r in row[:-1]}
    runnings = []
    sides: tuple[Side, Side] = ("top", "right")
    for k, side in enumerate(sides):
        new = [c for c in points if c.quantity == PLACES[k] and not c.centre and c.variable not in repeated]
        runnings.append(running_along(sketch, view, side, k, new))
    if rows:
        linears += _spaces(sketch, view, rows, along)
    callouts += radius_callouts(sketch, view, part)
    for k in (0, 1):
        rest = [c for c in points if c.quantity == PLACES[k]]
        runnings[k] = filled(sketch, view, runnings[k], k, rest)
    return replace(
        view,
        linears=tuple(linears),
        runnings=tuple(r for r in runnings if len(r.stops) > 1),
        callouts=tuple(callouts),
        centres=tuple(centres),
        threads=_threads(view, along_z),
    )


SMALL, DETAIL_ROOM = 1.0, (60.0, 50.0)  # mm: smaller sizes have a detail; share of paper for the detail
AROUND_SMALL = 0.8  # of their extent that a detail shows around them


def _with_detail(front: View, sketch: Sketch) -> list[View]:
    """The front view, and a detail of its small toleranced sizes: distances and radii that state a
    characteristic, and the radii among them."""

    def limited(d: Dimension) -> bool:
        return d.characteristic is not None and abs(d.value(sketch.values)) <= SMALL

    linears = [s for s in front.linears if limited(s.dimension)]
    callouts = [c for c in front.callouts if c.spans and any(map(limited, c.dimensions))]
    spots = [p for s in linears for p in (s.p, s.q)] + [
        (at[0] + way * r, at[1] + way * r) for c in callouts for at, r in c.targets for way in (-1, 1)
    ]
    if not spots:
        return [front]
    (u0, v0, u1, v1) = bounds(spots)
    away = AROUND_SMALL * max(u1 - u0, v1 - v0, SMALL)
    window = (u0 - away, v0 - away, u1 + away, v1 + away)
    detail = View(
        "detail",
        front.eye,
        front.up,
        front.box,
        label="X",
        window=window,
        room=DETAIL_ROOM,
        linears=tuple(linears),
        callouts=tuple(callouts),
    )
    rest = replace(
        front,
        linears=tuple(s for s in front.linears if s not in linears),
        callouts=tuple(c for c in front.callouts if c not in callouts),
    )
    return [rest, detail]


def _spaces(sketch: Sketch, view: View, rows: Sequence[Sequence[Round]], k: int) -> list[Linear]:
    """Number of equal spaces of regular rows along the part's axis k, and for information how wide one is."""
    shown: dict[tuple, Linear] = {}
    for row in rows:
        places = [level(r.owner.place(k)) for r in row]
        for a, b, c in zip(places, places[1:], places[2:]):
            sketch.convention(MeasureDifference(Span(a, b), Span(b, c)))
        beside = [level(r.owner.place(1 - k)) for r in row]
        for a in beside[:-1]:
            sketch.convention(Span(beside[-1], a))
        count = len(row) - 1
        ends = [Level(((places[n].names[0], 1 / count),)) for n in (0, -1)]
        name, sign = f"{row[0].label} spaces", f"{count} equal spaces "
        space = Dimension(name, (Span(*ends),), sign=sign, auxiliary=True)
        p, q = (seen(view, r.at) for r in (row[0], row[-1]))
        # neighbouring rows of equal spacing state it once
        key = (count, round(row[0].at[k], 6), round(row[-1].at[k], 6))
        shown.setdefault(key, Linear(space, "bottom" if k == 0 else "left", p, q))
    return list(shown.values())


def _coordinates(owner: Owner, contour: Contour) -> list[Coordinate]:
    """Coordinates of a contour that may carry a dimension: edges first, then corners, then arcs' centres."""
    if circle := contour.as_circle():
        at = (*circle[0], 0.0)
        return [Coordinate(f"{owner} {a}", owner.place(k), at) for k, a in enumerate("xy")]
    edges, corners, centres = [], [], []
    for i, s in enumerate(contour):
        label = s.name or f"{owner} {i}"
        start, centre = Spot(owner, i), Spot(owner, i, centre=True)
        if isinstance(s, Line):
            for k in (0, 1):
                if abs(s.start[k] - s.end[k]) < 1e-9:
                    edges.append(Coordinate(label, start.place(k), (*s.start, 0.0), (*s.end, 0.0)))
        else:
            centres += [Coordinate(f"{label} centre", centre.place(k), (*s.centre, 0.0)) for k in (0, 1)]
        corner = (*s.start, 0.0)
        corners += [Coordinate(f"{label} start", start.place(k), corner, corner=True) for k in (0, 1)]
    return edges + corners + centres


def _lands(sketch: Sketch, view: View, part: Part) -> list[Linear]:
    """Length and width of a rectangular land in the middle of a disc, on its centre lines."""
    linears = []
    for owner, contour in contours(part):
        if owner.kind != "island" or len(contour) != 4 or contour.as_circle():
            continue
        name = part.features[owner.number or 0].name.removeprefix("around_")
        x0, y0, x1, y1 = contour.box
        sides: tuple[tuple[Side, Point], ...] = (("top", (x0, y1)), ("right", (x1, y0)))
        for k, (side, p) in enumerate(sides):
            q = (x1, y1)
            a, b = (edge_level(sketch, owner, k, end[k]) for end in (p, q))
            sketch.convention(Span(halfway(a, b), level(OUTER.place(k))))
            d = sketch.must(sketch.stating(f"{name} along {'xy'[k]}", (Span(a, b),)))
            linears.append(Linear(d, side, seen(view, (*p, 0.0)), seen(view, (*q, 0.0))))
    return linears


def _sunk_view(sketch: Sketch, part: Part, front: View, eye: Vector, called: Sequence[Group]) -> View:
    """The view onto a y face with its holes: x and z by running dimensions, the thickness the last."""
    name, sign = ("below", 1.0) if eye == front.up else ("above", -1.0)
    view = view_of(part, name, eye, opposite(front.eye, sign))
    mine = [g for g in called if g.axis[1]]
    callouts = [hole_callout(sketch, view, g) for g in mine]
    side: Side = "bottom" if name == "below" else "top"
    return replace(
        view,
        callouts=tuple(callouts),
        runnings=(face_running(sketch, view, side, 0, mine), depth_running(sketch, view, part, "left", mine)),
        centres=tuple((seen(view, r.at), widest(r.hole)) for g in mine for r in g.holes),
        threads=_threads(view, mine),
    )


def _threads(view: View, called: Sequence[Group]) -> tuple[tuple[Point, float], ...]:
    """Middles and nominal diameters of threads that are entered from the view's side or run through."""
    threads = []
    for r in (r for g in called for r in g.holes if r.hole.thread):
        towards = sum(a * e for a, e in zip(r.axis, view.eye)) < 0
        if towards or r.hole.through and r.hole.thread_depth >= r.hole.depth:
            threads.append((seen(view, r.at), r.hole.thread_diameter))
    return tuple(threads)


def side_view(sketch: Sketch, part: Part, front: View, thickness: Dimension | None = None) -> View:
    """The view from the left, next to the front view, with the thickness."""
    view = view_of(part, "right", opposite(front.right), front.up)
    d = sketch.must(thickness or sketch.stating("thickness", (size(THICKNESS),)))
    x0, y0, x1, y1 = view.box
    return replace(view, linears=(Linear(d, "bottom", (x0, y0), (x1, y0)),))


def turned_plan(part: Part, notes: Sequence[str]) -> SheetPlan:
    """The sheet of a part that is turned about z: limits between two of its faces first, then the rest. Edges
    inside show where an end is bored.

    Raises CheckFailure if it has holes or pockets, or a dimension is missing or given twice.
    """
    if part.features or not isinstance(part.body, Revolution):
        raise CheckFailure(f"drawings: {part.part_no}: holes in a turned part have no sheet yet")
    profile, sketch = part.body.profile, Sketch(part)
    for row in conventions(PROFILE, profile):
        sketch.convention(row)
    levels: list[list[tuple[float, Level]]] = [[], []]  # of radii, of heights: each once
    for i, s in enumerate(profile):
        for k in (0, 1):
            own = level(Spot(PROFILE, i).place(k))
            same = next((other for value, other in levels[k] if abs(value - s.start[k]) < ALIKE), None)
            if same:
                sketch.convention(Span(same, own))
            elif k == 0 and abs(s.start[0]) < ALIKE:
                sketch.convention(Span(Level(), own))
            else:
                levels[k].append((s.start[k], own))
    _, z0, r, z1 = profile.box
    view = View("front", (0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (z0, -r, z1, r))  # z to the right
    linears, callouts = _lengths(sketch, part, levels[1], r), []
    for radius, own in sorted(levels[0], key=lambda pair: pair[0]):
        ends = {s: [abs(p[0] - radius) for p in (s.start, s.end)] for s in profile}
        # the cylinder of that radius, or else what ends there
        s = min((s for s in profile if min(ends[s]) < ALIKE), key=lambda s: max(ends[s]))
        d = sketch.stating(f"{s.name} diameter", (Span(Level(), Level(((own.terms[0][0], 2.0),))),))
        d = replace(d, sign="⌀")
        if not sketch.new(d):
            continue
        z = s.at(0.5)[1]
        if d.limits:  # its envelope's sign is drawn with a leader
            callouts.append(
                Callout((d.text(sketch.values),), (((z, radius), 0.0), ((z, -radius), 0.0)), (d,))
            )
        else:
            side: Side = "right" if z > (z0 + z1) / 2.0 else "left"
            linears.append(Linear(d, side, (z, -radius), (z, radius)))
    arcs = [("radius", radius_of(PROFILE, i), s) for i, s in enumerate(profile) if isinstance(s, Arc)]
    callouts += equal_radii(sketch, view, arcs)
    margin = 0.04 * (z1 - z0)
    bored = not all(any(p == (0.0, z) for s in profile for p in (s.start, s.end)) for z in (z0, z1))
    axis = ((z0 - margin, 0.0), (z1 + margin, 0.0))
    view = replace(view, hidden=bored, linears=tuple(linears), callouts=tuple(callouts), axes=(axis,))
    closed(sketch, (view,))
    return SheetPlan(part, sketch.values, tuple(sketch.conventions), (view,), tuple(notes))


def _lengths(sketch: Sketch, part: Part, levels: Sequence[tuple[float, Level]], r: float) -> list[Linear]:
    """Limits between faces above the view, the rest below it."""
    assert isinstance(part.body, Revolution)
    profile = part.body.profile
    at = {
        s.name: (s.start, Spot(PROFILE, i).place(1))
        for i, s in enumerate(profile)
        if isinstance(s, Line) and abs(s.start[1] - s.end[1]) < ALIKE
    }
    linears = []
    for c in (c for c in part.characteristics if {*c.between} <= {*at} and len(c.between) == 2):
        (p, a), (q, b) = sorted((at[name] for name in c.between), key=lambda pair: pair[0][1])
        d = sketch.must(sketch.stating(c.name, (Span(level(a), level(b)),)))
        linears.append(Linear(d, "top", (p[1], r), (q[1], r)))
    ascending = sorted(levels, key=lambda pair: pair[0])
    for (low, lower), (high, upper) in pairwise(ascending):
        d = Dimension(f"length from {low:g}", (Span(lower, upper),))
        if sketch.new(d):
            linears.append(Linear(d, "bottom", (low, -r), (high, -r)))
    return linears
