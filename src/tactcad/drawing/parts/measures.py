"""A part's coordinates and sizes as variables with typed keys, and what dimensions and drawing conventions
say about them.

Variables are x and y of the start of each segment of a contour, and of an arc's centre; a contour that is one
circle has only x, y and a diameter. Holes have the coordinates across their axis, and their sizes.

A dimension takes its value from these variables. Together with the conventions (lines drawn level are level,
arcs drawn tangent are tangent, features on one extension line are in line) the dimensions of a sheet have to
determine all variables, up to the part's place on the paper; `Determined` keeps track of that by the rank of
their derivatives.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from math import atan2, degrees, hypot

import numpy as np

from tactcad.contour import Arc, Contour, Line
from tactcad.contour.segment import direction, mapped
from tactcad.parts.language.description import Extrusion, Hole, Part, Pocket, Revolution, Vector


class Quantity(StrEnum):
    """A variable's quantity, mm."""

    X = "x"
    Y = "y"
    Z = "z"
    DIAMETER = "d"
    DEPTH = "depth"
    WIDE = "wide"  # diameter of a counterbore
    DEEP = "deep"  # its depth
    THREAD = "thread"  # depth of full thread
    THICKNESS = "thickness"


PLACES = (Quantity.X, Quantity.Y, Quantity.Z)


@dataclass(frozen=True)
class Owner:
    """A contour or hole that variables belong to: which of its kind, and which island of a pocket."""

    kind: str
    number: int | None = None
    island: int | None = None

    def __str__(self) -> str:
        return self.kind + ".".join(str(n) for n in (self.number, self.island) if n is not None)

    def place(self, k: int) -> Variable:
        """Coordinate k (0, 1, 2) of a hole or a circle."""
        return Variable(self, PLACES[k])

    def size(self, quantity: Quantity) -> Variable:
        return Variable(self, quantity)


@dataclass(frozen=True)
class Spot:
    """A point of a contour: a segment's start, or the centre of its arc."""

    contour: Owner
    segment: int
    centre: bool = False

    def place(self, k: int) -> Variable:
        """Coordinate k (0 or 1)."""
        return Variable(self, PLACES[k])


@dataclass(frozen=True)
class Variable:
    """One number that the part is described by."""

    of: Owner | Spot
    quantity: Quantity

    def __str__(self) -> str:
        """Text such as "outer.3.cx", by which variables are sorted."""
        if isinstance(self.of, Spot):
            return f"{self.of.contour}.{self.of.segment}.{'c' if self.of.centre else ''}{self.quantity}"
        return f"{self.of}.{self.quantity}".removeprefix(".")

    @property
    def contour(self) -> Owner:
        """Its outermost owner."""
        return self.of.contour if isinstance(self.of, Spot) else self.of


OUTER, PROFILE = Owner("outer"), Owner("profile")
THICKNESS = Owner("").size(Quantity.THICKNESS)
Values = Mapping[Variable, float]


def contours(part: Part) -> list[tuple[Owner, Contour]]:
    """Every contour of the part by its variables' owner; of a turned part its profile (radius, z)."""
    if isinstance(part.body, Revolution):
        return [(PROFILE, part.body.profile)]
    body = part.extrusion
    named = [(OUTER, body.outer), *((Owner("opening", i), c) for i, c in enumerate(body.openings))]
    for k, f in enumerate(part.features):
        if isinstance(f, Pocket):
            named.append((Owner("pocket", k), in_part(f, f.contour)))
            named += [(Owner("island", k, i), in_part(f, c)) for i, c in enumerate(f.island)]
    return named


def axis_of(feature: Hole | Pocket) -> int:
    """0, 1 or 2: the axis that a feature is sunk along. Raises ValueError for a slanting one."""
    along = [i for i, a in enumerate(feature.axis) if a]
    if len(along) != 1:
        raise ValueError(f"{feature.name}: axis {feature.axis} is not along x, y or z")
    return along[0]


def in_part(pocket: Pocket, contour: Contour) -> Contour:
    """A contour of a pocket along z, in the part's x and y."""
    if axis_of(pocket) != 2:
        raise ValueError(f"{pocket.name}: pockets in side faces have no sheet yet")
    (ux, uy, _), sign = pocket.x_axis, pocket.axis[2]
    vx, vy = -uy * sign, ux * sign  # y_axis = axis x x_axis

    def at(p: tuple[float, float]) -> tuple[float, float]:
        # rounded to a picometre: rotation may leave 1e-17 for a coordinate of 0
        x, y, _ = pocket.at
        return (round(x + p[0] * ux + p[1] * vx, 12), round(y + p[0] * uy + p[1] * vy, 12))

    return Contour(tuple(mapped(s, at, ux * vy - uy * vx < 0) for s in contour))


def xy(point: Spot) -> tuple[Variable, Variable]:
    return (point.place(0), point.place(1))


def variables(part: Part) -> dict[Variable, float]:
    """Every variable of an extruded or turned part with its value (mm)."""
    values = {THICKNESS: part.body.thickness} if isinstance(part.body, Extrusion) else {}
    for owner, contour in contours(part):
        if circle := contour.as_circle():
            (x, y), r = circle
            values |= {owner.place(0): x, owner.place(1): y, owner.size(Quantity.DIAMETER): 2 * r}
            continue
        for i, s in enumerate(contour):
            values |= zip(xy(Spot(owner, i)), s.start)
            if isinstance(s, Arc):
                values |= zip(xy(Spot(owner, i, True)), s.centre)
    for k, f in enumerate(part.features):
        if isinstance(f, Pocket):
            values[Owner("pocket", k).size(Quantity.DEPTH)] = f.depth
            continue
        owner = Owner("hole", k)
        values |= {owner.place(i): f.at[i] for i in range(3) if i != axis_of(f)}
        values[owner.size(Quantity.DIAMETER)] = f.diameter
        if not f.through:
            values[owner.size(Quantity.DEPTH)] = f.depth
        if f.counterbore:
            values |= zip((owner.size(Quantity.WIDE), owner.size(Quantity.DEEP)), f.counterbore)
        if f.thread and f.thread_depth < f.depth:
            values[owner.size(Quantity.THREAD)] = f.thread_depth
    return values


@dataclass(frozen=True)
class Round:
    """One round hole: its variables' owner, middle on its face, direction, and feature."""

    owner: Owner
    label: str
    at: Vector
    axis: Vector
    hole: Hole


def rounds(part: Part) -> list[Round]:
    """Round openings and holes of an extruded part."""
    if isinstance(part.body, Revolution):
        return []
    body = part.extrusion
    holes = []
    for i, opening in enumerate(body.openings):
        if circle := opening.as_circle():
            (x, y), r = circle
            label = opening.segments[0].name
            hole = Hole(label, (x, y, body.thickness), (0, 0, -1), 2 * r, body.thickness, True)
            holes.append(Round(Owner("opening", i), label.replace("_", " "), hole.at, hole.axis, hole))
    for k, f in enumerate(part.features):
        if isinstance(f, Hole):
            holes.append(Round(Owner("hole", k), f.name.replace("_", " "), f.at, f.axis, f))
    return holes


def widest(h: Hole) -> float:
    """Diameter of a hole, or of its counterbore, mm."""
    return max(h.diameter, h.counterbore[0] if h.counterbore else 0.0)


STEP = 1e-6  # mm, for derivatives by central differences; measures are smooth at this size
INDEPENDENT = 1e-6  # a row is independent where more than this share of its length is


class OfVariables:
    """A quantity on variables: those named by its fields, points by x and y."""

    @property
    def names(self) -> tuple[Variable, ...]:
        return tuple(_named(tuple(vars(self).values())))


def _named(value: object) -> Iterator[Variable]:
    if isinstance(value, tuple):
        for one in value:
            yield from _named(one)
    elif isinstance(value, Variable):
        yield value
    elif isinstance(value, Spot):
        yield from xy(value)
    elif isinstance(value, OfVariables):
        yield from value.names


@dataclass(frozen=True)
class Level(OfVariables):
    """A coordinate along one axis, mm: the sum of coefficient x variable."""

    terms: tuple[tuple[Variable, float], ...] = ()

    def of(self, values: Values) -> float:
        return sum(c * values[name] for name, c in self.terms)


def level(variable: Variable) -> Level:
    return Level(((variable, 1.0),))


def halfway(a: Level, b: Level) -> Level:
    return Level(tuple((name, c / 2) for name, c in a.terms + b.terms))


@dataclass(frozen=True)
class Span(OfVariables):
    """From one level to another, mm, positive if the second is larger; without a first level a size."""

    a: Level
    b: Level

    def of(self, values: Values) -> float:
        return self.b.of(values) - self.a.of(values)


def size(variable: Variable) -> Span:
    """A variable that is a size by itself: a diameter, a depth."""
    return Span(Level(), level(variable))


@dataclass(frozen=True)
class Given:
    """A value of no variable, mm, such as an assembly's overall size."""

    value: float
    names = ()

    def of(self, values: Values) -> float:
        return self.value


@dataclass(frozen=True)
class Slope(OfVariables):
    """Direction of a line from start to end, degrees from the x axis."""

    start: Spot
    end: Spot

    def of(self, values: Values) -> float:
        x0, y0, x1, y1 = (values[n] for n in self.names)
        return degrees(atan2(y1 - y0, x1 - x0))


@dataclass(frozen=True)
class Distance(OfVariables):
    """From one point to another, mm."""

    a: Spot
    b: Spot

    def of(self, values: Values) -> float:
        x0, y0, x1, y1 = (values[n] for n in self.names)
        return hypot(x1 - x0, y1 - y0)


def radius_of(contour: Owner, i: int) -> Distance:
    """Radius of segment i of a contour, from its start to its centre, mm."""
    return Distance(Spot(contour, i), Spot(contour, i, True))


@dataclass(frozen=True)
class MeasureDifference(OfVariables):
    """Difference of two measures: 0 if they are drawn as equal."""

    a: Measure
    b: Measure

    def of(self, values: Values) -> float:
        return self.a.of(values) - self.b.of(values)


@dataclass(frozen=True)
class CrossProduct(OfVariables):
    """Cross product of two directions, each from point to point: 0 if they are parallel."""

    points: tuple[Spot, Spot, Spot, Spot]
    along: bool = False  # the scalar product instead: 0 if they are at right angles

    def of(self, values: Values) -> float:
        a, b, c, d = ([values[n] for n in xy(p)] for p in self.points)
        ux, uy, vx, vy = b[0] - a[0], b[1] - a[1], d[0] - c[0], d[1] - c[1]
        return ux * vx + uy * vy if self.along else ux * vy - uy * vx


@dataclass(frozen=True)
class Offset(OfVariables):
    """Distance of a point, given by its levels, from the line through two points, mm; left of it positive."""

    start: Spot
    end: Spot
    x: Level
    y: Level

    def of(self, values: Values) -> float:
        x0, y0, x1, y1 = (values[n] for n in (*xy(self.start), *xy(self.end)))
        ux, uy = x1 - x0, y1 - y0
        return (ux * (self.y.of(values) - y0) - uy * (self.x.of(values) - x0)) / hypot(ux, uy)


@dataclass(frozen=True)
class Width(OfVariables):
    """Sum of a point's offsets from two lines, mm: the width between parallel lines on either side of it."""

    a: Offset
    b: Offset

    def of(self, values: Values) -> float:
        return abs(self.a.of(values)) + abs(self.b.of(values))


Measure = Given | Span | Offset | Width | Slope | Distance | MeasureDifference | CrossProduct


def conventions(owner: Owner, contour: Contour) -> list[Measure]:
    """Conventions implied by a drawn contour: level and upright lines, circular arcs, tangent joints."""
    if contour.as_circle():
        return []
    count = len(contour)
    rows: list[Measure] = []
    for i, s in enumerate(contour):
        start, end, centre = Spot(owner, i), Spot(owner, (i + 1) % count), Spot(owner, i, True)
        if isinstance(s, Line):
            for k in (1, 0):
                if abs(s.start[k] - s.end[k]) < 1e-9:
                    rows.append(Span(level(start.place(k)), level(end.place(k))))
        else:
            rows.append(MeasureDifference(Distance(start, centre), Distance(end, centre)))
    return rows + [row for i in range(count) if (row := _tangent(owner, contour, i))]


def _tangent(owner: Owner, contour: Contour, i: int) -> Measure | None:
    """The convention that segment i is tangent to the previous one, if it is."""
    before, after = contour.segments[i - 1], contour.segments[i]
    (ux, uy), (vx, vy) = direction(before, before.end), direction(after, after.start)
    both_straight = isinstance(before, Line) and isinstance(after, Line)
    if both_straight or abs(ux * vy - uy * vx) >= 1e-6:
        return None
    count = len(contour)
    p, q, r = (Spot(owner, n % count) for n in (i - 1, i, i + 1))
    centre_before, centre_after = Spot(owner, p.segment, True), Spot(owner, i, True)
    if isinstance(before, Line):
        return CrossProduct((p, q, q, centre_after), along=True)
    if isinstance(after, Line):
        return CrossProduct((q, r, q, centre_before), along=True)
    return CrossProduct((q, centre_before, q, centre_after))


@dataclass
class Determined:
    """The combinations of variables determined so far: an orthonormal basis of the rows' gradients."""

    values: dict[Variable, float]

    def __post_init__(self) -> None:
        self.columns = {name: i for i, name in enumerate(self.values)}
        self.basis = np.zeros((0, len(self.values)))

    @property
    def rank(self) -> int:
        return len(self.basis)

    def takes(self, row: Measure) -> bool:
        """Add a row if it is independent of the earlier ones; returns whether it is."""
        new = gradient(row, self.values, self.columns)
        whole = np.linalg.norm(new)
        for _ in range(2):  # done twice, the rows are orthogonal to rounding
            new = new - self.basis.T @ (self.basis @ new)
        left = np.linalg.norm(new)
        if left < INDEPENDENT * whole or left == 0:
            return False
        self.basis = np.vstack([self.basis, new / left])
        return True


def gradient(row: Measure, values: Values, columns: Mapping[Variable, int]) -> np.ndarray:
    """Derivatives of a measure by all variables, shape (len(columns),)."""
    result = np.zeros(len(columns))
    moved = dict(values)
    for name in dict.fromkeys(row.names):
        at = moved[name]
        moved[name] = at + STEP
        above = row.of(moved)
        moved[name] = at - STEP
        result[columns[name]] = (above - row.of(moved)) / (2 * STEP)
        moved[name] = at
    return result
