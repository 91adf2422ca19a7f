"""What dimensions and drawing conventions say about a part's variables.

A dimension takes its value from these variables. Together with the conventions (lines drawn level are level,
arcs drawn tangent are tangent, features on one extension line are in line) the dimensions of a sheet have to
determine all variables, up to the part's place on the paper; `Determined` keeps track of that by the rank of
their derivatives.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import atan2, degrees, hypot

import numpy as np

from tactcad.contour import Contour, Line
from tactcad.contour.necks import direction

from .part_variables import Owner, Spot, Values, Variable, xy

STEP = 1e-6  # mm, for derivatives by central differences; measures are smooth at this size
INDEPENDENT = 1e-6  # a row is independent where more than this share of its length is


class OfVariables:
    """What is measured on variables: those that its fields name, points by x and y."""

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
    """From one level to another, mm, positive where the second is larger; without a first level a size."""

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
class Radius(OfVariables):
    """Radius of segment i of a contour, from its centre to its start, mm."""

    contour: Owner
    i: int

    @property
    def names(self) -> tuple[Variable, ...]:
        return (*xy(Spot(self.contour, self.i)), *xy(Spot(self.contour, self.i, True)))

    def of(self, values: Values) -> float:
        x, y, cx, cy = (values[n] for n in self.names)
        return hypot(x - cx, y - cy)


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


@dataclass(frozen=True)
class MeasureDifference(OfVariables):
    """Of two measures: 0 where they are drawn as equal."""

    a: Measure
    b: Measure

    def of(self, values: Values) -> float:
        return self.a.of(values) - self.b.of(values)


@dataclass(frozen=True)
class CrossProduct(OfVariables):
    """Cross product of two directions, each from point to point: 0 where they are parallel."""

    points: tuple[Spot, Spot, Spot, Spot]
    along: bool = False  # the scalar product instead: 0 where they are at right angles

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


Measure = Given | Span | Offset | Width | Radius | Slope | Distance | MeasureDifference | CrossProduct


def conventions(owner: Owner, contour: Contour) -> list[Measure]:
    """What a drawn contour implies: level and upright lines, circular arcs, tangent joints."""
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
    """The convention that segment i is tangent to the one before it, where it is."""
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
    """Which combinations of variables are determined so far: an orthonormal basis of the rows' gradients."""

    values: dict[Variable, float]

    def __post_init__(self) -> None:
        self.columns = {name: i for i, name in enumerate(self.values)}
        self.basis = np.zeros((0, len(self.values)))

    @property
    def rank(self) -> int:
        return len(self.basis)

    def takes(self, row: Measure) -> bool:
        """Add a row where it is independent of those before; returns whether it is."""
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
