"""The plan of a turned part: one view along its axis, which lies level; diameters, and lengths between its
faces."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from tactcad.contour import Arc, Line
from tactcad.design.messages import CheckFailure
from tactcad.parts.language.description import Part, Revolution

from .callouts import equal_radii
from .measures import PROFILE, Level, Radius, Span, Spot, conventions, level
from .sheet_plan import Callout, Dimension, Linear, SheetPlan, Side, View
from .sketch import ALIKE, Sketch, closed

EYE, UP = (0.0, 1.0, 0.0), (1.0, 0.0, 0.0)  # z to the right


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
    view = View("front", EYE, UP, (z0, -r, z1, r), hidden=False)
    linears, callouts = _lengths(sketch, part, levels[1], r), []
    for radius, own in sorted(levels[0], key=lambda pair: pair[0]):
        ends = {s: [abs(p[0] - radius) for p in (s.start, s.end)] for s in profile}
        # the cylinder of that radius, or else what ends there
        s = min((s for s in profile if min(ends[s]) < ALIKE), key=lambda s: max(ends[s]))
        d = sketch.stating(f"{s.name} diameter", (Span(Level(), Level(((own.terms[0][0], 2.0),))),))
        d = Dimension(d.name, d.rows, "⌀", limits=d.limits, key=d.key, characteristic=d.characteristic)
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
    arcs = [("radius", Radius(PROFILE, i), s) for i, s in enumerate(profile) if isinstance(s, Arc)]
    callouts += equal_radii(sketch, view, arcs)
    margin = 0.04 * (z1 - z0)
    view = View(
        "front",
        EYE,
        UP,
        view.box,
        hidden=not all(any(p == (0.0, z) for s in profile for p in (s.start, s.end)) for z in (z0, z1)),
        linears=tuple(linears),
        callouts=tuple(callouts),
        axes=(((z0 - margin, 0.0), (z1 + margin, 0.0)),),
    )
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
