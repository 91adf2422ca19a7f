"""A part's surface area in closed form, so that it can be compared without a CAD kernel."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from math import hypot, pi, sin, sqrt
from typing import Literal

from tactcad.contour import Arc, Contour, Line, Point, Segment
from tactcad.contour.inside import side
from tactcad.contour.nearest import distance_to
from tactcad.design.messages import CheckFailure

from .description import (
    Extrusion,
    Hole,
    ModelFile,
    Part,
    Pocket,
    Revolution,
    Vector,
    drill_point_height,
    vector,
)
from .limits import FACES, Characteristic

ON_OUTLINE = 1e-9  # mm: a pocket whose side is nearer than this to the outline is open on that side


def surface_area(part: Part) -> float | None:
    """Area of the whole surface, mm2; None for a part whose shape is only known from a file.

    Features start and end on flat faces and do not meet each other, as for the volume; a pocket along the
    thickness may be open at the outline.
    """
    body = part.body
    if isinstance(body, ModelFile):
        return None
    stock = _extruded(body) if isinstance(body, Extrusion) else _revolved(body)
    return stock + sum(_hole_area(f) if isinstance(f, Hole) else _pocket_area(f, body) for f in part.features)


def _extruded(body: Extrusion) -> float:
    return 2 * body.section_area + body.cut_length * body.thickness


def _revolved(body: Revolution) -> float:
    """Pappus: 2 pi times the profile's integral of r along its length; what lies on the axis adds nothing."""
    return 2 * pi * sum(_radius_integral(s) for s in body.profile)


def _radius_integral(s: Segment) -> float:
    if isinstance(s, Line):
        return s.length * (s.start[0] + s.end[0]) / 2
    first, last = s.start_angle, s.start_angle + s.sweep
    r, turn = s.radius, 1.0 if s.sweep > 0 else -1.0
    return turn * (s.centre[0] * r * (last - first) + r * r * (sin(last) - sin(first)))


def _hole_area(hole: Hole) -> float:
    """Walls added less discs taken off the faces: a blind hole's flat floor replaces the disc it took."""
    r = hole.diameter / 2
    area = 2 * pi * r * hole.depth
    if hole.counterbore:
        wide, deep = hole.counterbore
        area += pi * (wide - hole.diameter) * deep  # its ring-shaped floor replaces the removed area
    if hole.drill_point:
        area += pi * r * (hypot(r, drill_point_height(hole.diameter)) - r)
    if hole.through:
        area -= 2 * pi * r * r
    return area


def _pocket_area(pocket: Pocket, body: Extrusion | Revolution) -> float:
    """Walls added, less the stock's own wall where the pocket is open; its floor replaces what it took."""
    walls = sum(c.length for c in pocket.island) + pocket.contour.length
    if isinstance(body, Extrusion) and abs(pocket.axis[2]) == 1.0:
        walls -= 2 * sum(s.length for s in pocket.contour if _on_outline(s, pocket, body.outer))
    return walls * pocket.depth


def _on_outline(s: Segment, pocket: Pocket, outline: Contour) -> bool:
    """Whether the pocket's side lies on the stock's outline: both ends and the middle do, on one segment."""
    points = [_in_section(s.at(u), pocket) for u in (0.0, 0.5, 1.0)]
    return any(all(distance_to(o, p) < ON_OUTLINE for p in points) for o in outline)


def _in_section(p: Point, pocket: Pocket) -> Point:
    """A point of the pocket's contour in the stock's x and y: at + p_x x_axis + p_y (axis x x_axis)."""
    (x0, y0, _), (ux, uy, _), up = pocket.at, pocket.x_axis, pocket.axis[2]
    return (x0 + p[0] * ux - p[1] * up * uy, y0 + p[0] * uy + p[1] * up * ux)


# mm; a tenth of the shortest edge that may be cut (contour/segment.py): nothing else lies as near
NEAR = 1e-4
PARALLEL = 1e-9  # sine of the angle up to which directions count as parallel
AGREES = 1e-6  # mm


@dataclass(frozen=True)
class LocalAxes:
    """A right-handed frame: its origin, its x axis, and its axis z."""

    at: Vector = (0.0, 0.0, 0.0)
    x_axis: Vector = (1.0, 0.0, 0.0)
    axis: Vector = (0.0, 0.0, 1.0)

    @property
    def y_axis(self) -> Vector:
        (a, b, c), (d, e, f) = self.axis, self.x_axis
        return (b * f - c * e, c * d - a * f, a * e - b * d)

    def local(self, p: Vector) -> Vector:
        """A point of the part in this frame."""
        away = vector(a - b for a, b in zip(p, self.at))
        return (_dot(away, self.x_axis), _dot(away, self.y_axis), _dot(away, self.axis))

    def along(self, u: float, v: float) -> Vector:
        """A direction in the frame's plane as the part's."""
        return vector(u * a + v * b for a, b in zip(self.x_axis, self.y_axis))

    def point(self, u: float, v: float) -> Vector:
        """A point of the frame's plane as the part's."""
        return vector(o + d for o, d in zip(self.at, self.along(u, v)))


@dataclass(frozen=True)
class Wall:
    """Surface swept by a segment in a frame's plane along the axis by the depth."""

    segment: Segment
    depth: float
    frame: LocalAxes = LocalAxes()

    def holds(self, p: Vector) -> bool:
        u, v, w = self.frame.local(p)
        return -NEAR <= w <= self.depth + NEAR and distance_to(self.segment, (u, v)) <= NEAR

    @property
    def point(self) -> Vector:
        """A point of the plane, or of the cylinder's axis."""
        s = self.segment
        return self.frame.point(*(s.centre if isinstance(s, Arc) else s.start))

    @property
    def direction(self) -> Vector:
        """The plane's normal, or the cylinder's axis."""
        s = self.segment
        if isinstance(s, Arc):
            return self.frame.axis
        (x0, y0), (x1, y1) = s.start, s.end
        return self.frame.along(-(y1 - y0) / s.length, (x1 - x0) / s.length)

    @property
    def diameter(self) -> float | None:
        """Diameter of a cylinder, mm."""
        return 2 * self.segment.radius if isinstance(self.segment, Arc) else None

    @property
    def middle(self) -> Vector:
        """Its middle point."""
        s = self.segment
        u, v = s.at(0.5)
        return vector(p + self.depth / 2 * a for p, a in zip(self.frame.point(u, v), self.frame.axis))

    @property
    def reach(self) -> float:
        """Distance from its axis to the point of measurement: a whole cylinder at its axis, a fillet at its
        surface, mm."""
        s = self.segment
        return s.radius if isinstance(s, Arc) and s.start != s.end else 0.0


@dataclass(frozen=True)
class Floor:
    """The plane z = 0 of a frame, or as much of it as lies within a contour."""

    frame: LocalAxes
    within: Contour | None = None
    diameter: None = None
    reach: float = 0.0

    def holds(self, p: Vector) -> bool:
        u, v, w = self.frame.local(p)
        return abs(w) <= NEAR and (self.within is None or side(self.within, (u, v)) >= 0)

    @property
    def point(self) -> Vector:
        return self.frame.at

    @property
    def direction(self) -> Vector:
        return self.frame.axis

    @property
    def middle(self) -> Vector:
        """The middle of its outline, or its frame's origin."""
        return self.frame.point(*self.within.centroid) if self.within else self.frame.at


Piece = Wall | Floor


def pieces(part: Part, feature: str) -> list[Piece]:
    """Every piece of the part's surface that the feature of that name bounds, of an extrusion or a turned
    part."""
    if isinstance(part.body, Revolution):
        return [_turned(s) for s in part.body.profile if s.name == feature]
    body = part.extrusion
    if feature in FACES:
        return [Floor(LocalAxes((0.0, 0.0, 0.0 if feature == FACES[0] else body.thickness)))]
    found: list[Piece] = [
        Wall(s, body.thickness) for c in (body.outer, *body.openings) for s in _edges(c) if s.name == feature
    ]
    for f in part.features:
        found += _hole(f, feature) if isinstance(f, Hole) else _pocket(f, feature)
    return found


def _turned(s: Segment) -> Piece:
    """The cylinder or plane of an edge of a turned part's profile."""
    (r, z), (r1, z1) = s.start, s.end
    if z == z1:
        return Floor(LocalAxes((0.0, 0.0, z)))
    if r != r1 or not isinstance(s, Line):
        raise CheckFailure(f"{s.name}: limits on a turned part refer to its cylinders and planes only")
    return Wall(Arc((r, 0.0), (r, 0.0), (0.0, 0.0), True), abs(z1 - z), LocalAxes((0.0, 0.0, min(z, z1))))


def _edges(contour: Contour) -> tuple[Segment, ...]:
    """Its segments; a circle is one."""
    whole = contour.as_circle()
    if whole is None:
        return contour.segments
    first = contour.segments[0]
    return (Arc(first.start, first.start, whole[0], True, first.name),)


def _hole(hole: Hole, feature: str) -> Iterator[Piece]:
    if hole.name == feature:
        r = hole.diameter / 2
        yield Wall(
            Arc((r, 0.0), (r, 0.0), (0.0, 0.0), True),
            hole.depth,
            LocalAxes(hole.at, _across(hole.axis), hole.axis),
        )


def _pocket(pocket: Pocket, feature: str) -> Iterator[Piece]:
    frame = LocalAxes(pocket.at, pocket.x_axis, pocket.axis)
    for s in (s for c in (pocket.contour, *pocket.island) for s in _edges(c)):
        if feature in (pocket.name, f"{pocket.name} {s.name}"):
            yield Wall(s, pocket.depth, frame)
    if feature == pocket.name:
        bottom = vector(p + pocket.depth * a for p, a in zip(pocket.at, pocket.axis))
        yield Floor(LocalAxes(bottom, pocket.x_axis, pocket.axis), pocket.contour)


def _across(axis: Vector) -> Vector:
    """A unit vector square to another."""
    x, y, _ = axis
    length = hypot(x, y)
    return (-y / length, x / length, 0.0) if length > PARALLEL else (1.0, 0.0, 0.0)


# --- the surfaces of a dimension ---


@dataclass(frozen=True)
class Measured:
    """The surfaces of a dimension: a diameter or radius on `first`, a distance from `first` to `second`."""

    kind: Literal["diameter", "radius", "distance"]
    first: tuple[Piece, ...]
    second: tuple[Piece, ...] = ()


def measured(part: Part, c: Characteristic) -> Measured:
    """The surfaces of a characteristic on the part: of equal names, those at its nominal size.

    Raises
    ------
    CheckFailure
        If its features have no such size.
    """
    groups = [pieces(part, feature) for feature in c.between]
    if len(groups) == 1:
        # of any size: a hole that a pin is pressed into is modelled as wide as the pin, not as its limits
        sizes = [p.diameter or 0.0 for p in groups[0]]
        if sizes and min(sizes) > 0.0 and _is(min(sizes), max(sizes)):
            return Measured("diameter", tuple(groups[0]))
    else:
        first, *others = groups
        if all(p.diameter and _is(p.diameter / 2, c.nominal) for p in (*first, *others[0])):
            return Measured("radius", (*first, *others[0]))
        pairs = [(a, b) for a, *b in product(*groups) if _at_distance(a, b, c.nominal)]
        if pairs:
            second = dict.fromkeys(piece for _, b in pairs for piece in b)
            return Measured("distance", tuple(dict.fromkeys(a for a, _ in pairs)), tuple(second))
    where = " and ".join(c.between)
    raise CheckFailure(
        f"{part.part_no}: {c.name} of {c.nominal:g} mm refers to {where}, which has no such size"
    )


def _at_distance(a: Piece, others: Sequence[Piece], distance: float) -> bool:
    """Whether a piece lies at that distance (mm) from another, or from the middle between two others."""
    if not all(_level(a, b) for b in others):
        return False
    middle = vector(sum(values) / len(others) for values in zip(*(b.point for b in others)))
    away = _away(a, others[0], vector(m - p for m, p in zip(middle, a.point)))
    reaches = (a.reach, *(b.reach / len(others) for b in others))
    return any(_is(away + sum(some), distance) for some in product(*((-r, r) for r in reaches)))


def _level(a: Piece, b: Piece) -> bool:
    """Whether planes and axes are parallel."""
    across = _dot(a.direction, b.direction)
    alike = (a.diameter is None) == (b.diameter is None)
    return abs(abs(across) - 1 if alike else across) <= PARALLEL


def _away(a: Piece, b: Piece, between: Vector) -> float:
    """Distance between parallel planes or axes whose points are `between` apart, mm."""
    for plane in (p for p in (a, b) if p.diameter is None):
        return abs(_dot(plane.direction, between))
    along = _dot(a.direction, between)
    return sqrt(max(_dot(between, between) - along * along, 0.0))


def _is(a: float, b: float) -> bool:
    return abs(a - b) <= AGREES


def _dot(a: Vector, b: Vector) -> float:
    return sum(p * q for p, q in zip(a, b))
