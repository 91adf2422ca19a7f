"""A plan in the making: its dimensions, and what they determine so far."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import count, product

from tactcad.design.messages import CheckFailure
from tactcad.parts.language.description import Part, Revolution, Vector
from tactcad.parts.language.limits import FACES

from ..engine.boxes import bounds
from .measures import THICKNESS, Determined, Level, Measure, Owner, Quantity, Spot, Variable, level, variables
from .sheet_plan import Dimension, View, seen
from .tolerances import places, times

ALIKE = 1e-6  # mm: coordinates nearer than this are one


@dataclass(frozen=True)
class Coordinate:
    """A feature's coordinate along one axis of the part, a point of it in the part (x, y, z), and an edge's
    other end; whether it is a mere corner between edges. None is the coordinate 0. `states` names the part's
    characteristic for it."""

    name: str
    variable: Variable | None
    at: Vector
    other: Vector | None = None
    corner: bool = False
    states: str = ""

    @property
    def contour(self) -> Owner | None:
        """Its owner."""
        return self.variable.contour if self.variable else None

    @property
    def centre(self) -> bool:
        """Whether it is of an arc's centre."""
        return self.variable is not None and isinstance(self.variable.of, Spot) and self.variable.of.centre

    @property
    def quantity(self) -> Quantity | None:
        return self.variable.quantity if self.variable else None

    @property
    def level(self) -> Level:
        return level(self.variable) if self.variable else Level()


class Sketch:
    """A plan in the making: its dimensions, and what they determine so far."""

    def __init__(self, part: Part) -> None:
        self.part = part
        self.values = variables(part)
        self.determined = Determined(self.values)
        self.conventions: list[Measure] = []
        self.known: dict[int, list[Coordinate]] = {0: [], 1: [], 2: []}
        self.unstated = {c.name: c for c in part.characteristics}
        # (axis, coordinate) of datums, of what has a position tolerance, and what of it is not located
        faces = dict(zip(FACES, (0.0, self.values.get(THICKNESS, 0.0))))
        self.bases = {(2, faces[d.feature]) for d in part.datums if d.feature in faces}
        self.bases |= self._spots(d.feature for d in part.datums)
        self.exact = self._spots(f for g in part.geometric if g.symbol == "position" for f in g.features)
        self.unlocated = self.exact - self.bases

    def convention(self, row: Measure) -> None:
        self.conventions.append(row)
        self.determined.takes(row)

    def new(self, dimension: Dimension) -> bool:
        """Add a dimension if every one of its rows determines something new; returns whether it did."""
        before = self.determined.basis
        if all([self.determined.takes(row) for row in dimension.rows]):
            if dimension.characteristic:
                del self.unstated[dimension.characteristic.name]
            return True
        self.determined.basis = before
        return False

    def _spots(self, features: Iterable[str]) -> set[tuple[int, float]]:
        return {(k, _rounded(self.values[v])) for k, v in places(self.part, tuple(features))}

    def locates(self, origin: Coordinate, c: Coordinate, k: int) -> bool:
        """Whether a dimension along axis k locates something with a position tolerance from a datum."""
        start, end = ((k, _rounded(spot.at[k])) for spot in (origin, c))
        if start not in self.bases or end not in self.exact:
            return False
        self.unlocated.discard(end)
        return True

    def stating(self, name: str, rows: tuple[Measure, ...], plain: str = "") -> Dimension:
        """The dimension that states the characteristic of that name; a plain one if none is left."""
        c = self.unstated.get(name)
        if c is None:
            return Dimension(plain or name, rows)
        keys = [k for k in self.part.characteristics if k.key]
        number = keys.index(c) + 1 if c in keys else 0
        limits = (c.upper - c.nominal, c.lower - c.nominal)
        return Dimension(c.name, rows, limits=limits, key=number, characteristic=c)

    def must(self, dimension: Dimension) -> Dimension:
        """A dimension that has to determine something new, with the limits of the characteristic of its name.
        Raises CheckFailure if it repeats others."""
        if dimension.characteristic is None and dimension.name in self.unstated:
            s = self.stating(dimension.name, dimension.rows)
            dimension = replace(dimension, limits=s.limits, key=s.key, characteristic=s.characteristic)
        if not self.new(dimension):
            raise CheckFailure(f"drawings: {self.part.part_no}: {dimension.name} is given twice")
        return dimension


def _rounded(value: float) -> float:
    return round(value, 6) + 0.0


def closed(sketch: Sketch, views: Sequence[View]) -> None:
    """Raise CheckFailure unless every limit is stated, geometric tolerances and datums once each, and
    everything but the place on the paper determined."""
    number = sketch.part.part_no
    if sketch.unstated:
        raise CheckFailure(f"drawings: {number}: no dimension states {', '.join(sketch.unstated)}")
    free = 1 if isinstance(sketch.part.body, Revolution) else 2  # a turned part moves along its axis alone
    missing = len(sketch.values) - free - sketch.determined.rank
    if missing:
        raise CheckFailure(f"drawings: {number}: {missing} dimensions are missing")
    if sketch.unlocated:
        open_ = ", ".join(f"{'xyz'[k]} = {at:g}" for k, at in sorted(sketch.unlocated))
        raise CheckFailure(f"drawings: {number}: nothing locates {open_} from a datum")
    part, called = sketch.part, [c for view in views for c in view.callouts]
    framed = Counter(f.geometric.name for c in called for f in c.frames)
    # of a letter that several views offer one is drawn
    lettered = Counter(c.datum for c in called) + Counter({d.letter for view in views for d in view.datums})
    shown = [(f"tolerance of {g.symbol} ({g.name})", framed[g.name], times(part, g)) for g in part.geometric]
    shown += [(f"datum {d.letter}", lettered[d.letter], 1) for d in part.datums]
    if wrong := [
        f"{what} appears {found} times, not {meant}" for what, found, meant in shown if found != meant
    ]:
        raise CheckFailure(f"drawings: {number}: {'; '.join(wrong)}")


def view_of(part: Part, name: str, eye: Vector, up: Vector) -> View:
    """The bare view of a part, as large as the part is."""
    view = View(name, eye, up, (0.0, 0.0, 0.0, 0.0))
    body = part.extrusion
    x0, y0, x1, y1 = body.outer.box
    corners = product((x0, x1), (y0, y1), (0.0, body.thickness))
    return replace(view, box=bounds(seen(view, corner) for corner in corners))


def edge_level(sketch: Sketch, contour: Owner, k: int, value: float) -> Level:
    """The level of a contour's edge at a value along axis k (0 or 1)."""
    starts = (Spot(contour, i).place(k) for i in count())
    return level(next(v for v in starts if abs(sketch.values[v] - value) < ALIKE))


# Characteristics of parts that are a hole's height over the underside, by the hole's label.
