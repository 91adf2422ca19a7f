"""Whether milled, turned and ground parts can be made: cutters, drills, taps, walls, slender shafts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations
from math import dist, inf

from tactcad.checks.shop import Machining
from tactcad.contour import Arc, Contour
from tactcad.contour.inside import clearance, side
from tactcad.contour.nearest import distance
from tactcad.contour.segment import direction
from tactcad.parts.language.description import (
    Extrusion,
    Hole,
    Part,
    Pocket,
    Revolution,
    Vector,
    drill_point_height,
    vector,
)
from tactcad.parts.language.finding import SAME, Finding, at_least, at_most
from tactcad.parts.language.metric import METRIC

from ..check import Check

MACHINED = ("milled", "turned", "ground")
# Coarse pitches of threads that the array's screws do not have (ISO 261), mm.
PITCH = {name: m.pitch for name, m in METRIC.items()} | {"M6": 1.0}


def check_machining(part: Part, limit: Machining) -> list[Finding]:
    """Findings on a part that is milled, turned or ground; nothing for others."""
    if part.process not in MACHINED:
        return []
    rules = (_corners, _narrow_pockets, _pocket_floors, _drills, _threads, _hole_walls, _slender)
    return [finding for rule in rules for finding in rule(part, limit)]


def _thin(check: str, part: Part, at: Vector, wall: float, limit: Machining, what: str) -> Iterator[Finding]:
    """A wall is flagged if it is thinner than advised, and fails if no workshop would make it."""
    message = f"{what}, advised {limit.wall:g}, at least {limit.wall_least:g}"
    for finding in at_least(check, part.part_no, wall, limit.wall, message, at):
        yield finding if wall < limit.wall_least - SAME else replace(finding, severity="flag")


def _pockets(part: Part) -> Iterator[Pocket]:
    """Pockets that a cutter has to enter from above: those that take off the whole rim are milled from
    outside."""
    outer = part.body.outer if isinstance(part.body, Extrusion) else None
    for f in part.features:
        if isinstance(f, Pocket) and f.contour != outer:
            yield f


def _corners(part: Part, limit: Machining) -> Iterator[Finding]:
    """Inside corners: no tighter than the cutter that reaches the depth."""
    if isinstance(part.body, Extrusion) and part.process == "milled":
        yield from _tight(part, "outline", part.body.outer, part.body.thickness, limit, inside=False)
        for opening in part.body.openings:
            yield from _tight(part, "opening", opening, part.body.thickness, limit, inside=True)
    for pocket in _pockets(part):
        yield from _tight(part, f"pocket {pocket.name}", pocket.contour, pocket.depth, limit, inside=True)
        for island in pocket.island:
            yield from _tight(part, f"island in {pocket.name}", island, pocket.depth, limit, inside=False)


def _tight(
    part: Part, name: str, contour: Contour, depth: float, limit: Machining, inside: bool
) -> Iterator[Finding]:
    """Corners of a contour that the cutter meets from its inside (a pocket) or its outside (an outline)."""
    least = max(limit.cutter_radius, depth / limit.cutter_reach / 2)
    contour = contour if contour.ccw else contour.reversed()
    segments = list(contour)
    for s, after in zip(segments, segments[1:] + segments[:1]):
        # Sine of the turn from the end of a to the start of b; positive to the left.
        ux, uy = direction(s, s.end)
        vx, vy = direction(after, after.start)
        turn = ux * vy - uy * vx
        if (turn if inside else -turn) > 1e-6:
            what = (
                f"{name}: sharp inside corner, {depth:g} deep: a cutter leaves a radius of "
                f"{least:.3g} mm or more"
            )
            yield from at_least("mill-corner", part.part_no, 0.0, least, what, (*s.end, 0.0))
        if isinstance(s, Arc) and s.ccw == inside:
            what = f"{name}: inside radius {s.radius:.3g} mm, {depth:g} deep, needs {least:.3g} mm or more"
            yield from at_least("mill-corner", part.part_no, s.radius, least, what, (*s.at(0.5), 0.0))


def _narrow_pockets(part: Part, limit: Machining) -> Iterator[Finding]:
    """Grooves around islands: as wide as the cutter that reaches their floor."""
    for pocket in _pockets(part):
        least = max(2 * limit.cutter_radius, pocket.depth / limit.cutter_reach)
        for island in pocket.island:
            wide = min(distance(a, b) for a in pocket.contour for b in island)
            what = (
                f"groove {pocket.name}: {wide:.3g} mm wide and {pocket.depth:g} deep, needs "
                f"{least:.3g} mm or more"
            )
            yield from at_least("mill-groove", part.part_no, wide, least, what, pocket.at)


def _pocket_floors(part: Part, limit: Machining) -> Iterator[Finding]:
    for pocket in _pockets(part):
        left = _material_along(part, pocket.at, pocket.axis) - pocket.depth
        what = f"pocket {pocket.name} leaves a floor of {left:.3g} mm, at least {limit.floor:g}"
        yield from at_least("mill-floor", part.part_no, left, limit.floor, what, pocket.at)


def _holes(part: Part) -> list[Hole]:
    return [f for f in part.features if isinstance(f, Hole)]


def _drills(part: Part, limit: Machining) -> Iterator[Finding]:
    for h in _holes(part):
        what = f"hole {h.name}: {h.diameter:g} mm, at least {limit.drill:g}"
        yield from at_least("drill-diameter", part.part_no, h.diameter, limit.drill, what, h.at)
        wide, entry = h.counterbore or (h.diameter, 0.0)
        for deep, diameter in ((h.depth - entry, h.diameter), (entry, wide)):
            what = (
                f"hole {h.name}: {deep:g} mm at {diameter:g} diameter, at most {limit.drill_reach:g} "
                "diameters"
            )
            yield from at_most("drill-depth", part.part_no, deep, limit.drill_reach * diameter, what, h.at)
        if h.counterbore:
            yield from _under_head(part, h, h.depth - h.counterbore[1], limit)
        if not h.through:
            tip = drill_point_height(h.diameter) if h.drill_point else 0.0
            left = _material_along(part, h.at, h.axis) - h.depth - tip
            what = f"blind hole {h.name} leaves {left:.3g} mm of material, at least {limit.floor:g}"
            yield from at_least("drill-floor", part.part_no, left, limit.floor, what, h.at)


def _under_head(part: Part, h: Hole, left: float, limit: Machining) -> Iterator[Finding]:
    """A counterbore leaves material under the screw's head."""
    if left <= SAME:
        what = f"hole {h.name}: counterbore as deep as the hole"
        yield from at_least("counterbore", part.part_no, left, limit.wall, what, h.at)
    elif h.through:
        yield from _thin(
            "counterbore", part, h.at, left, limit, f"hole {h.name}: {left:.3g} mm left under the head"
        )


def _threads(part: Part, limit: Machining) -> Iterator[Finding]:
    for h in _holes(part):
        if not h.thread:
            continue
        name, deepest = f"thread {h.name} {h.thread}", limit.thread_reach * h.thread_diameter
        what = f"{name}: {h.thread_depth:g} mm of full thread, at most {limit.thread_reach:g} diameters"
        yield from at_most("thread-depth", part.part_no, h.thread_depth, deepest, what, h.at)
        wide, start = h.counterbore or (0.0, 0.0)
        if h.thread in METRIC:
            tap = METRIC[h.thread]
            deep = h.thread_depth + (0.0 if tap.tap_shank < wide else start)
            what = (
                f"{name}: {deep:g} mm to the end of full thread below {wide:g} mm: the tap's shank of "
                f"{tap.tap_shank:g} follows {tap.tap_reach:g} mm behind its end"
            )
            yield from at_most("tap-reach", part.part_no, deep, tap.tap_reach, what, h.at)
        if not h.through:
            room, least = h.depth - start - h.thread_depth, limit.run_out * PITCH[h.thread]
            if room < least - 1e-6:  # mm: depths are rounded to that
                what = f"{name}: {room:.3g} mm between full thread and drilled depth, at least {least:.3g}"
                yield from at_least("thread-run-out", part.part_no, room, least, what, h.at)


def _hole_walls(part: Part, limit: Machining) -> Iterator[Finding]:
    """Material between holes, and between a hole and the part's sides."""
    cylinders = [c for h in _holes(part) for c in _cylinders(h)]
    for (h, a, b, r), (k, c, d, q) in combinations(cylinders, 2):
        if h is k or dist(a, c) - dist(a, b) - dist(c, d) - r - q >= limit.wall:  # too far to measure
            continue
        wall = _between(a, b, c, d) - r - q
        yield from _thin("hole-web", part, a, wall, limit, f"{wall:.3g} mm between {h.name} and {k.name}")
    if not isinstance(part.body, Extrusion):
        return
    t = part.body.thickness
    for h, a, b, r in cylinders:
        if abs(h.axis[2]) > 0.5:
            inside = side(part.body.outer, a[:2]) >= 0
            wall = (clearance(part.body.outer, a[:2]) if inside else -inf) - r
        else:
            wall = min(a[2], t - a[2], b[2], t - b[2]) - r
        yield from _thin(
            "hole-wall", part, a, wall, limit, f"{wall:.3g} mm between {h.name} and the part's side"
        )


def _cylinders(h: Hole) -> Iterator[tuple[Hole, Vector, Vector, float]]:
    """Axis and radius of the hole, and of its counterbore; a thread counts with its outside diameter.

    Walls are measured from the axis, with round ends: a blind hole's axis ends so that its round end reaches
    as deep as the drill's point.
    """

    def at(depth: float) -> Vector:
        return vector(p + depth * a for p, a in zip(h.at, h.axis))

    r = max(h.diameter, h.thread_diameter) / 2
    point = drill_point_height(h.diameter) if h.drill_point else 0.0
    yield h, at(0.0), at(h.depth if h.through else max(0.0, h.depth + point - r)), r
    if h.counterbore:
        yield h, at(0.0), at(h.counterbore[1]), h.counterbore[0] / 2


def _between(a: Vector, b: Vector, c: Vector, d: Vector) -> float:
    """Smallest distance of the segments ab and cd, by their closest points (clamped projections, both
    ways)."""

    def sub(p: Vector, q: Vector) -> Vector:
        return vector(x - y for x, y in zip(p, q))

    def dot(p: Vector, q: Vector) -> float:
        return sum(x * y for x, y in zip(p, q))

    def nearest(p: Vector, q0: Vector, q1: Vector) -> float:
        w = sub(q1, q0)
        u = min(1.0, max(0.0, dot(sub(p, q0), w) / (dot(w, w) or 1.0)))  # a flat blind hole has no axis
        return dist(p, tuple(x + u * y for x, y in zip(q0, w)))

    u, v, w = sub(b, a), sub(d, c), sub(a, c)
    uu, vv, uv = dot(u, u), dot(v, v), dot(u, v)
    distances = [nearest(a, c, d), nearest(b, c, d), nearest(c, a, b), nearest(d, a, b)]
    cross = uu * vv - uv * uv
    if cross > 1e-12:
        s = (uv * dot(v, w) - vv * dot(u, w)) / cross
        t = (uu * dot(v, w) - uv * dot(u, w)) / cross
        if 0 <= s <= 1 and 0 <= t <= 1:
            distances.append(
                dist(tuple(x + s * y for x, y in zip(a, u)), tuple(x + t * y for x, y in zip(c, v)))
            )
    return min(distances)


def _material_along(part: Part, at: Vector, axis: Vector) -> float:
    """Reach of the stock from a face along an axis, by its box (a revolution's, its length)."""
    if isinstance(part.body, Revolution):
        low, high = (-inf, -inf, part.body.profile.box[1]), (inf, inf, part.body.profile.box[3])
    else:
        x0, y0, x1, y1 = part.extrusion.outer.box
        low, high = (x0, y0, 0.0), (x1, y1, part.extrusion.thickness)
    return min(
        ((high[i] if axis[i] > 0 else low[i]) - at[i]) / axis[i] for i in range(3) if abs(axis[i]) > 0.5
    )


def _slender(part: Part, limit: Machining) -> Iterator[Finding]:
    if part.process != "turned":
        return
    if isinstance(part.body, Revolution):
        _, z0, r, z1 = part.body.profile.box
        length, diameter = z1 - z0, 2 * r
    else:
        x0, _, x1, _ = part.extrusion.outer.box
        length, diameter = part.extrusion.thickness, x1 - x0
    slender = length / diameter
    what = (
        f"{length:g} mm long at {diameter:g} diameter: {slender:.3g} diameters, at most {limit.slenderness:g}"
    )
    yield from at_most("turn-slender", part.part_no, slender, limit.slenderness, what, (0.0, 0.0, length / 2))
    if isinstance(part.body, Extrusion):
        for opening in part.body.openings:
            wall = (diameter - (opening.box[2] - opening.box[0])) / 2
            what = f"ring of {wall:.3g} mm wall, at least {limit.ring:g}"
            yield from at_least("turn-wall", part.part_no, wall, limit.ring, what, (0.0, 0.0, 0.0))


CHECKS = (
    Check(
        "machining",
        "part",
        lambda part, job: check_machining(part, job.shop.machining),
        place=50,
        applies=lambda part: part.process in MACHINED,
    ),
)
