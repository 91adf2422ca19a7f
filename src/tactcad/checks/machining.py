"""Can the milled, turned and ground parts be made by their process: cutters, drills, taps, walls, slender shafts."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from math import dist, hypot, inf
from typing import Literal

from tactcad.contour import Arc, Contour
from tactcad.contour.inside import clearance, side
from tactcad.contour.nearest import distance
from tactcad.parts.description import Extrusion, Hole, Part, Pocket, Revolution, Vector, drill_point_height
from tactcad.parts.library.screws import METRIC

from .finding import Finding
from .shop import Machining

MACHINED = ("milled", "turned", "ground")
SAME = 1e-9
# Coarse pitches that are no screws of the array (ISO 261), mm.
PITCH = {name: m.pitch for name, m in METRIC.items()} | {"M6": 1.0}


# Walls: flagged where they are thinner than advised, failed where no workshop would leave them.
WALLS = ("hole-web", "hole-wall", "counterbore")


def check_machining(part: Part, limit: Machining) -> list[Finding]:
    """Findings on a part that is milled, turned or ground; nothing for others."""
    if part.process not in MACHINED:
        return []
    rules = (_corners, _narrow_pockets, _pocket_floors, _drills, _threads, _hole_walls, _slender)
    return [
        Finding(check, _severity(check, value, limit), part.part_no, place, value, least, message)
        for rule in rules
        for check, place, value, least, message in rule(part, limit)
    ]


def _severity(check: str, value: float, limit: Machining) -> Literal["fail", "flag"]:
    return "flag" if check in WALLS and value >= limit.wall_least - SAME else "fail"


Raw = tuple[str, Vector, float, float, str]


def _pockets(part: Part) -> Iterator[Pocket]:
    """Pockets that a cutter has to enter from above: those that take off the whole rim are milled from outside."""
    outer = part.body.outer if isinstance(part.body, Extrusion) else None
    for f in part.features:
        if isinstance(f, Pocket) and f.contour != outer:
            yield f


def _corners(part: Part, limit: Machining) -> Iterator[Raw]:
    """Inside corners: no tighter than the cutter that reaches the depth."""
    if isinstance(part.body, Extrusion) and part.process == "milled":
        yield from _tight("outline", part.body.outer, part.body.thickness, limit, inside=False)
        for opening in part.body.openings:
            yield from _tight("opening", opening, part.body.thickness, limit, inside=True)
    for pocket in _pockets(part):
        yield from _tight(f"pocket {pocket.name}", pocket.contour, pocket.depth, limit, inside=True)
        for island in pocket.island:
            yield from _tight(f"island in {pocket.name}", island, pocket.depth, limit, inside=False)


def _tight(name: str, contour: Contour, depth: float, limit: Machining, inside: bool) -> Iterator[Raw]:
    """Corners of a contour that the cutter meets from its inside (a pocket) or its outside (an outline)."""
    least = max(limit.cutter_radius, depth / limit.cutter_reach / 2)
    contour = contour if contour.ccw else contour.reversed()
    segments = list(contour)
    for s, after in zip(segments, segments[1:] + segments[:1]):
        turn = _turn(s, after)
        if (turn if inside else -turn) > 1e-6:
            yield (
                "mill-corner",
                (*s.end, 0.0),
                0.0,
                least,
                f"{name}: sharp inside corner, {depth:g} deep: a cutter leaves a radius of {least:.3g} mm or more",
            )
        if isinstance(s, Arc) and s.ccw == inside and s.radius < least - SAME:
            yield (
                "mill-corner",
                (*s.at(0.5), 0.0),
                s.radius,
                least,
                f"{name}: inside radius {s.radius:.3g} mm, {depth:g} deep, wants {least:.3g} mm or more",
            )


def _turn(a, b) -> float:
    """Sine of the turn from the end of a to the start of b; positive to the left."""
    ux, uy = _direction(a, 1.0)
    vx, vy = _direction(b, 0.0)
    return ux * vy - uy * vx


def _direction(s, u: float) -> tuple[float, float]:
    x, y = s.at(u)
    if isinstance(s, Arc):
        rx, ry = (x - s.centre[0]) / s.radius, (y - s.centre[1]) / s.radius
        return (-ry, rx) if s.ccw else (ry, -rx)
    return ((s.end[0] - s.start[0]) / s.length, (s.end[1] - s.start[1]) / s.length)


def _narrow_pockets(part: Part, limit: Machining) -> Iterator[Raw]:
    """Grooves around islands: as wide as the cutter that reaches their floor."""
    for pocket in _pockets(part):
        least = max(2 * limit.cutter_radius, pocket.depth / limit.cutter_reach)
        for island in pocket.island:
            wide = min(distance(a, b) for a in pocket.contour for b in island)
            if wide < least - SAME:
                yield (
                    "mill-groove",
                    pocket.at,
                    wide,
                    least,
                    f"groove {pocket.name}: {wide:.3g} mm wide and {pocket.depth:g} deep, wants {least:.3g} mm or more",
                )


def _pocket_floors(part: Part, limit: Machining) -> Iterator[Raw]:
    for pocket in _pockets(part):
        left = _material_along(part, pocket.at, pocket.axis) - pocket.depth
        if left < limit.floor - SAME:
            yield (
                "mill-floor",
                pocket.at,
                left,
                limit.floor,
                f"pocket {pocket.name} leaves a floor of {left:.3g} mm, at least {limit.floor:g}",
            )


def _holes(part: Part) -> list[Hole]:
    return [f for f in part.features if isinstance(f, Hole)]


def _drills(part: Part, limit: Machining) -> Iterator[Raw]:
    for h in _holes(part):
        if h.diameter < limit.drill - SAME:
            yield (
                "drill-diameter",
                h.at,
                h.diameter,
                limit.drill,
                f"hole {h.name}: {h.diameter:g} mm, at least {limit.drill:g}",
            )
        wide, entry = h.counterbore or (h.diameter, 0.0)
        for deep, diameter in ((h.depth - entry, h.diameter), (entry, wide)):
            if deep > limit.drill_reach * diameter + SAME:
                yield (
                    "drill-depth",
                    h.at,
                    deep,
                    limit.drill_reach * diameter,
                    f"hole {h.name}: {deep:g} mm at {diameter:g} diameter, at most {limit.drill_reach:g} diameters",
                )
        if h.counterbore and h.counterbore[1] >= h.depth - SAME:
            yield (
                "counterbore",
                h.at,
                h.depth - h.counterbore[1],
                limit.wall,
                f"hole {h.name}: counterbore as deep as the hole",
            )
        elif h.counterbore and h.through and h.depth - h.counterbore[1] < limit.wall - SAME:
            left = h.depth - h.counterbore[1]
            yield (
                "counterbore",
                h.at,
                left,
                limit.wall,
                f"hole {h.name}: {left:.3g} mm left under the head, advised {limit.wall:g}, at least {limit.wall_least:g}",
            )
        if not h.through:
            tip = drill_point_height(h.diameter) if h.drill_point else 0.0
            left = _material_along(part, h.at, h.axis) - h.depth - tip
            if left < limit.floor - SAME:
                yield (
                    "drill-floor",
                    h.at,
                    left,
                    limit.floor,
                    f"blind hole {h.name} leaves {left:.3g} mm of material, at least {limit.floor:g}",
                )


def _threads(part: Part, limit: Machining) -> Iterator[Raw]:
    for h in _holes(part):
        if not h.thread:
            continue
        d = h.thread_diameter
        if h.thread_depth > limit.thread_reach * d + SAME:
            yield (
                "thread-depth",
                h.at,
                h.thread_depth,
                limit.thread_reach * d,
                f"thread {h.name} {h.thread}: {h.thread_depth:g} mm of full thread, at most {limit.thread_reach:g} diameters",
            )
        if not h.through:
            start = h.counterbore[1] if h.counterbore else 0.0
            room, least = h.depth - start - h.thread_depth, limit.run_out * PITCH[h.thread]
            if room < least - 1e-6:
                yield (
                    "thread-run-out",
                    h.at,
                    room,
                    least,
                    f"thread {h.name} {h.thread}: {room:.3g} mm between full thread and drilled depth, at least {least:.3g}",
                )


def _hole_walls(part: Part, limit: Machining) -> Iterator[Raw]:
    """Material between holes, and between a hole and the part's sides."""
    cylinders = [c for h in _holes(part) for c in _cylinders(h)]
    for (h, a, b, r), (k, c, d, q) in combinations(cylinders, 2):
        if h is k:
            continue
        wall = _between(a, b, c, d) - r - q
        if wall < limit.wall - SAME:
            yield (
                "hole-web",
                a,
                wall,
                limit.wall,
                f"{wall:.3g} mm between {h.name} and {k.name}, advised {limit.wall:g}, at least {limit.wall_least:g}",
            )
    if not isinstance(part.body, Extrusion):
        return
    t = part.body.thickness
    for h, a, b, r in cylinders:
        if abs(h.axis[2]) > 0.5:
            inside = side(part.body.outer, a[:2]) >= 0
            wall = (clearance(part.body.outer, a[:2]) if inside else -inf) - r
        else:
            wall = min(a[2], t - a[2], b[2], t - b[2]) - r
        if wall < limit.wall - SAME:
            yield (
                "hole-wall",
                a,
                wall,
                limit.wall,
                f"{wall:.3g} mm between {h.name} and the part's side, advised {limit.wall:g}, at least {limit.wall_least:g}",
            )


def _cylinders(h: Hole) -> Iterator[tuple[Hole, Vector, Vector, float]]:
    """Axis and radius of the hole, and of its counterbore; a thread counts with its outside diameter.

    Walls are measured from the axis, with round ends: a blind hole's axis ends so that its round end reaches as
    deep as the drill's point.
    """

    def at(depth: float) -> Vector:
        return tuple(p + depth * a for p, a in zip(h.at, h.axis))

    r = max(h.diameter, h.thread_diameter) / 2
    point = drill_point_height(h.diameter) if h.drill_point else 0.0
    yield h, at(0.0), at(h.depth if h.through else max(0.0, h.depth + point - r)), r
    if h.counterbore:
        yield h, at(0.0), at(h.counterbore[1]), h.counterbore[0] / 2


def _between(a: Vector, b: Vector, c: Vector, d: Vector) -> float:
    """Smallest distance of the segments ab and cd, by their closest points (clamped projections, both ways)."""

    def sub(p: Vector, q: Vector) -> Vector:
        return tuple(x - y for x, y in zip(p, q))

    def dot(p: Vector, q: Vector) -> float:
        return sum(x * y for x, y in zip(p, q))

    def nearest(p: Vector, q0: Vector, q1: Vector) -> float:
        w = sub(q1, q0)
        u = min(1.0, max(0.0, dot(sub(p, q0), w) / dot(w, w)))
        return dist(p, tuple(x + u * y for x, y in zip(q0, w)))

    u, v, w = sub(b, a), sub(d, c), sub(a, c)
    uu, vv, uv = dot(u, u), dot(v, v), dot(u, v)
    found = [nearest(a, c, d), nearest(b, c, d), nearest(c, a, b), nearest(d, a, b)]
    cross = uu * vv - uv * uv
    if cross > 1e-12:
        s = (uv * dot(v, w) - vv * dot(u, w)) / cross
        t = (uu * dot(v, w) - uv * dot(u, w)) / cross
        if 0 <= s <= 1 and 0 <= t <= 1:
            found.append(dist(tuple(x + s * y for x, y in zip(a, u)), tuple(x + t * y for x, y in zip(c, v))))
    return min(found)


def _material_along(part: Part, at: Vector, axis: Vector) -> float:
    """How far the stock reaches from a face along an axis, by its box (a revolution's, its length)."""
    if isinstance(part.body, Revolution):
        low, high = (-inf, -inf, part.body.profile.box[1]), (inf, inf, part.body.profile.box[3])
    else:
        x0, y0, x1, y1 = part.body.outer.box
        low, high = (x0, y0, 0.0), (x1, y1, part.body.thickness)
    return min(
        ((high[i] if axis[i] > 0 else low[i]) - at[i]) / axis[i] for i in range(3) if abs(axis[i]) > 0.5
    )


def _slender(part: Part, limit: Machining) -> Iterator[Raw]:
    if part.process != "turned":
        return
    if isinstance(part.body, Extrusion):
        x0, _, x1, _ = part.body.outer.box
        length, diameter = part.body.thickness, x1 - x0
    else:
        _, z0, r, z1 = part.body.profile.box
        length, diameter = z1 - z0, 2 * r
    if length > limit.slenderness * diameter + SAME:
        yield (
            "turn-slender",
            (0.0, 0.0, length / 2),
            length / diameter,
            limit.slenderness,
            f"{length:g} mm long at {diameter:g} diameter: {length / diameter:.3g} diameters, at most {limit.slenderness:g}",
        )
    if isinstance(part.body, Extrusion):
        for opening in part.body.openings:
            bore = hypot(opening.box[2] - opening.box[0], 0.0)
            wall = (diameter - bore) / 2
            if wall < limit.ring - SAME:
                yield (
                    "turn-wall",
                    (0.0, 0.0, 0.0),
                    wall,
                    limit.ring,
                    f"ring of {wall:.3g} mm wall, at least {limit.ring:g}",
                )
