"""A part's coordinates and sizes as variables with typed keys, its contours and round holes by what their
variables belong to.

Variables are x and y of the start of each segment of a contour, and of an arc's centre; a contour that is one
circle has only x, y and a diameter. Holes have the coordinates across their axis, and their sizes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

from tactcad.contour import Arc, Contour, Line
from tactcad.parts.description import Hole, Part, Pocket, Vector


class Quantity(StrEnum):
    """What a variable measures, mm."""

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
    """A point of a contour: where a segment starts, or the centre of its arc."""

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
        """As in "outer.3.cx"; variables are sorted by this text."""
        if isinstance(self.of, Spot):
            return f"{self.of.contour}.{self.of.segment}.{'c' if self.of.centre else ''}{self.quantity}"
        return f"{self.of}.{self.quantity}".removeprefix(".")

    @property
    def contour(self) -> Owner:
        """What it belongs to in the end."""
        return self.of.contour if isinstance(self.of, Spot) else self.of


OUTER = Owner("outer")
THICKNESS = Owner("").size(Quantity.THICKNESS)
Values = Mapping[Variable, float]


def contours(part: Part) -> list[tuple[Owner, Contour]]:
    """Every contour of the part by what its variables belong to."""
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
        # rounded to a picometre: turning may leave 1e-17 where a coordinate is 0
        x, y, _ = pocket.at
        return (round(x + p[0] * ux + p[1] * vx, 12), round(y + p[0] * uy + p[1] * vy, 12))

    turned = ux * vy - uy * vx < 0
    return Contour(
        tuple(
            Line(at(s.start), at(s.end), s.name)
            if isinstance(s, Line)
            else Arc(at(s.start), at(s.end), at(s.centre), s.ccw != turned, s.name)
            for s in contour
        )
    )


def xy(point: Spot) -> tuple[Variable, Variable]:
    return (point.place(0), point.place(1))


def variables(part: Part) -> dict[Variable, float]:
    """Every variable of an extruded part with its value (mm)."""
    values = {THICKNESS: part.extrusion.thickness}
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
    """One round hole: what its variables belong to, middle on its face, direction, and what is made there."""

    owner: Owner
    label: str
    at: Vector
    axis: Vector
    hole: Hole


def rounds(part: Part) -> list[Round]:
    """Round openings and holes of an extruded part."""
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
