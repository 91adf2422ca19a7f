"""A plan in the making: the account of what is determined, and what says it."""

from __future__ import annotations

from dataclasses import dataclass

from tactcad.design.messages import CheckFailure
from tactcad.parts.description import Part, Vector

from .measure import Determined, Level, Measure, level, variables
from .plan import Dimension, View, seen

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


def closed(sketch: Sketch) -> None:
    """Raise CheckFailure unless everything but the place on the paper is determined."""
    missing = len(sketch.values) - 2 - sketch.account.rank
    if missing:
        raise CheckFailure(f"drawings: {sketch.part.part_no}: {missing} dimensions are missing")


def view_box(view: View, part: Part) -> tuple[float, float, float, float]:
    x0, y0, x1, y1 = part.body.outer.box
    points = [seen(view, (x, y, z)) for x in (x0, x1) for y in (y0, y1) for z in (0.0, part.body.thickness)]
    us, vs = zip(*points)
    return (min(us), min(vs), max(us), max(vs))


def edge_level(sketch: Sketch, name: str, axis: str, value: float) -> Level:
    """The level of a contour's edge at a value along an axis."""
    found = [
        n
        for n, v in sketch.values.items()
        if n.startswith(f"{name}.") and n.endswith(f".{axis}") and abs(v - value) < ALIKE
    ]
    return level(found[0])
