"""Callouts of a plan: holes, pockets and grooves, radii, and a disc's outside, each with where its leader may
point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import atan2, degrees

from tactcad.contour import Arc, Contour, Line
from tactcad.parts.description import Part, Pocket

from .contours import contours, in_part
from .holes import Group, widest
from .ink import Point
from .keys import OUTER, Owner, Quantity, Spot
from .limit_marks import frames_of, letter_of
from .measures import MeasureDifference, Offset, Radius, Slope, Span, Width, halfway, level, size
from .sheet_plan import Callout, Dimension, View, seen
from .sketch import ALIKE, Sketch, edge_level


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
    """Distance from a point of the view to the nearest side of its box, mm; leaders are shortest where it
    is small.
    """
    u0, v0, u1, v1 = view.box
    return round(min(p[0] - u0, u1 - p[0], p[1] - v0, v1 - p[1]), 6)


def pocket_callouts(sketch: Sketch, view: View, part: Part) -> list[Callout]:
    """Depth of every pocket, with the diameters of what is round, at its edge."""
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
            return d.text(sketch.values)

        pocket = Owner("pocket", k)
        for owner, c in ((pocket, f.contour), *((Owner("island", k, i), c) for i, c in enumerate(f.island))):
            diameter = owner.size(Quantity.DIAMETER)
            if c.as_circle() and not (owner == pocket and _is_outline(part, f)):
                lines.append(say(Dimension(f"{f.name} diameter", (size(diameter),), "⌀")))
            elif c.as_circle():
                sketch.convention(Span(level(OUTER.size(Quantity.DIAMETER)), level(diameter)))
        depth = say(Dimension(f"{f.name} depth", (size(pocket.size(Quantity.DEPTH)),), "↧"))
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
    """Width across flats of a regular polygon in the middle of the outline; None where the contour is not
    one.

    What is drawn as regular counts as such: sides at equal distances from the outline's middle, at equal
    angles.
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


def _is_outline(part: Part, f: Pocket) -> bool:
    return in_part(f, f.contour).as_circle() == part.extrusion.outer.as_circle()


def radius_callouts(sketch: Sketch, view: View, part: Part) -> list[Callout]:
    """Radii that are not determined yet, equal ones of a contour together."""
    callouts = []
    for owner, contour in contours(part):
        if contour.as_circle():
            continue
        arcs = [(f"{owner} radius", Radius(owner, i), s) for i, s in enumerate(contour) if isinstance(s, Arc)]
        for c in part.characteristics:
            limited = [arc for arc in arcs if arc[2].name in c.between]
            callouts += equal_radii(sketch, view, limited, c.name)
            arcs = [arc for arc in arcs if arc not in limited]
        callouts += equal_radii(sketch, view, arcs)
    return callouts


def equal_radii(
    sketch: Sketch, view: View, arcs: Sequence[tuple[str, Radius, Arc]], states: str = ""
) -> list[Callout]:
    """Named arcs of a contour whose radii are not determined yet, equal ones in one callout, under the
    name of the characteristic that they state."""
    kinds: dict[float, list[tuple[str, Radius, Arc]]] = {}
    for name, row, arc in arcs:
        kinds.setdefault(round(arc.radius, 6), []).append((name, row, arc))
    callouts = []
    for some in kinds.values():
        if new := [one for one in some if sketch.account.takes(one[1])]:
            name = " and ".join(dict.fromkeys(name for name, _, _ in new))
            rows = tuple(row for _, row, _ in new)
            d = replace(sketch.stating(states, rows, plain=name), sign="R")
            if d.characteristic:
                del sketch.unstated[states]
            callouts.append(_radius_callout(sketch, view, d, [arc for _, _, arc in new]))
    return callouts


def _radius_callout(sketch: Sketch, view: View, d: Dimension, arcs: Sequence[Arc]) -> Callout:
    targets: list[tuple[Point, float]] = []
    spans: list[tuple[float, float]] = []
    for arc in arcs:
        centre = seen(view, (*arc.centre, 0.0))
        angles = []
        for p in (arc.start, arc.end) if arc.ccw else (arc.end, arc.start):
            u, v = seen(view, (*p, 0.0))
            angles.append(degrees(atan2(v - centre[1], u - centre[0])))
        if view.right[0] < 0:
            angles.reverse()
        targets.append((centre, arc.radius))
        spans.append((angles[0], angles[1]))
    return Callout((d.text(sketch.values),), tuple(targets), (d,), tuple(spans))
