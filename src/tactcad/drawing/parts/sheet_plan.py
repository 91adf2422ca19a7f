"""Contents of a part's sheet before it has a scale: views, dimensions and their sides, callouts, notes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from tactcad.parts.language.description import Characteristic, Part, Vector, vector
from tactcad.parts.language.limits import Geometric

from ..engine.boxes import Box, Point
from .measures import Measure, Values, Variable

Side = Literal["top", "bottom", "left", "right"]
OUTWARDS: dict[Side, Point] = {
    "top": (0.0, 1.0),
    "bottom": (0.0, -1.0),
    "left": (-1.0, 0.0),
    "right": (1.0, 0.0),
}


@dataclass(frozen=True)
class Dimension:
    """One authored dimension: its value is the common value of its rows.

    `sign` is before the number, `unit` after it. `limits` are upper and lower deviation from the number
    shown, of a part modelled at `modelled` (deviation of the model from that number). `key` is the number of
    the key characteristic that it states, 0 for none. An `auxiliary` one follows from others and is in
    parentheses, for information. `characteristic` is the part's own that it states. A `basic` one
    (theoretically exact, ISO 1101) locates the zone of a position tolerance, and is framed.
    """

    name: str
    rows: tuple[Measure, ...]
    sign: str = ""
    unit: str = ""
    limits: tuple[float, float] | None = None
    modelled: float = 0.0
    fit: str = ""
    key: int = 0
    counted: bool = True
    auxiliary: bool = False
    characteristic: Characteristic | None = None
    basic: bool = False

    def value(self, values: Values) -> float:
        """mm or degrees. Raises ValueError if the rows differ: the features are not equal."""
        measured = [row.of(values) for row in self.rows]
        if max(measured) - min(measured) > 1e-6:
            raise ValueError(f"{self.name}: features of {measured} are shown as equal")
        return round(measured[0] - self.modelled, 9)

    def text(self, values: Values) -> str:
        """Its text on the sheet: "4× ⌀3.4", "0.25 ±0.005", "⌀3.012 +0.006/0"."""
        count = f"{len(self.rows)}× " if len(self.rows) > 1 and self.counted else ""
        exact = self.limits is not None
        shown = number(self.value(values), exact)
        if self.auxiliary:
            shown = f"({shown})"
        return f"{count}{self.sign}{shown}{self.unit}{self.tolerance}"

    @property
    def tolerance(self) -> str:
        envelope = ENVELOPE if self.sign == "⌀" else ""
        if self.limits is None:
            return f" {self.fit}{envelope}" if self.fit else ""
        upper, lower = (round(v, 9) for v in self.limits)
        if upper == -lower:
            return f" ±{number(upper, True)}{envelope}"
        return f" {_signed(upper)}/{_signed(lower)}{envelope}"


ENVELOPE = " Ⓔ"  # ISO 14405-1: a diameter with limits holds over its length, as a pin in it needs


def number(value: float, exact: bool = False) -> str:
    """Shortest text: up to four decimals as they are (nine if exact), otherwise rounded to three."""
    shown = round(value, 9)
    if not exact:
        shown = round(shown, 4) if abs(shown - round(shown, 4)) < 1e-6 else round(shown, 3)
    text = f"{shown:.9f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def _signed(value: float) -> str:
    return f"{'+' if value > 0 else ''}{number(value, True)}"


@dataclass(frozen=True)
class Linear:
    """A dimension line on a side of the view; its extension lines start at p and q (mm, in the view)."""

    dimension: Dimension
    side: Side
    p: Point
    q: Point


@dataclass(frozen=True)
class Across:
    """A dimension line across a web or slot from p to q in the view, arrows outside, text beyond q."""

    dimension: Dimension
    p: Point
    q: Point
    past: float = 0.0  # mm of the part from q to the text's earliest place on the line


@dataclass(frozen=True)
class Running:
    """Running dimensions from one origin (ISO 129-1): each stop with its dimension, None for the origin."""

    side: Side
    stops: tuple[tuple[Dimension | None, Point], ...]


@dataclass(frozen=True)
class Frame:
    """A tolerance frame: a geometric tolerance, and the number of holes that it holds for."""

    geometric: Geometric
    count: int

    @property
    def cells(self) -> tuple[str, ...]:
        """Texts after the symbol: the zone, of a pattern combined (CZ, ISO 5458), and the datums."""
        g = self.geometric
        combined = " CZ" if g.symbol == "position" and self.count > 1 else ""
        return (f"{'⌀' if g.round else ''}{number(g.zone)}{combined}", *g.datums)


@dataclass(frozen=True)
class Callout:
    """Texts at the end of a leader that points at one of the targets: circles, or points (radius 0), or arcs
    that are entered from their centre (`inside`). `dimensions` are those that the lines state; tolerance
    frames are below the lines, and the symbol of the feature's datum below these."""

    lines: tuple[str, ...]
    targets: tuple[tuple[Point, float], ...]
    dimensions: tuple[Dimension, ...] = ()
    spans: tuple[tuple[float, float], ...] = ()  # of arcs: start and end angle, degrees, a target each
    frames: tuple[Frame, ...] = ()
    datum: str = ""


@dataclass(frozen=True)
class Datum:
    """A datum triangle somewhere on an edge of the view, its letter `away` from it (unit vector)."""

    letter: str
    start: Point
    end: Point
    away: Point

    def at(self, share: float) -> Point:
        """The point of the edge at a share of its length from the start."""
        (x0, y0), (x1, y1) = self.start, self.end
        return (x0 + share * (x1 - x0), y0 + share * (y1 - y0))


@dataclass(frozen=True)
class Bore:
    """A hole cut along its axis, in the view's own mm: axis, nominal diameter of its thread (0: none), the
    thread's axis from its start to the end of full thread, and whether that end lies inside the hole."""

    face: Point
    end: Point
    thread: float = 0.0
    threaded: tuple[Point, Point] = ((0.0, 0.0), (0.0, 0.0))
    ends_inside: bool = False


@dataclass(frozen=True)
class SectionPlane:
    """A cut across an axis of the part (0 or 1) at a coordinate (mm), its letter, and holes in it."""

    letter: str
    axis: int
    at: float
    bores: tuple[Bore, ...] = ()


@dataclass(frozen=True)
class View:
    """One view: eye and up in the part's frame, its box in the view's own mm, and its annotations.

    A `window` is the area that a detail shows; the detail's letter is the view's `label`, and it is drawn as
    large as fits `room` (mm of paper), at least at `least` : 1. For a `section` everything before its plane
    is removed.
    """

    name: str
    eye: Vector
    up: Vector
    box: Box
    hidden: bool = True
    label: str = ""
    window: Box | None = None
    room: tuple[float, float] = (0.0, 0.0)
    least: float = 0.0
    linears: tuple[Linear, ...] = ()
    across: tuple[Across, ...] = ()
    runnings: tuple[Running, ...] = ()
    callouts: tuple[Callout, ...] = ()
    datums: tuple[Datum, ...] = ()
    centres: tuple[tuple[Point, float], ...] = ()  # circles that carry centre lines
    threads: tuple[tuple[Point, float], ...] = ()  # seen along their axis: middle, nominal diameter
    axes: tuple[tuple[Point, Point], ...] = ()  # other centre lines
    section: SectionPlane | None = None

    @property
    def right(self) -> Vector:
        (ux, uy, uz), (ex, ey, ez) = self.up, self.eye
        return (uy * ez - uz * ey, uz * ex - ux * ez, ux * ey - uy * ex)

    @property
    def dimensions(self) -> tuple[Dimension, ...]:
        """Every dimension that this view carries."""
        stops = [d for running in self.runnings for d, _ in running.stops if d]
        called = [d for callout in self.callouts for d in callout.dimensions]
        return (*(s.dimension for s in self.linears), *(s.dimension for s in self.across), *stops, *called)


def seen(view: View, p: Vector) -> Point:
    """A point of the part in the view's plane."""
    return (sum(a * b for a, b in zip(view.right, p)) + 0.0, sum(a * b for a, b in zip(view.up, p)) + 0.0)


def opposite(v: Vector, share: float = 1.0) -> Vector:
    return vector(-share * a for a in v)


@dataclass(frozen=True)
class Breaks:
    """Stretches that broken views leave out along an axis of the part (0 or 1): from where to where (mm of
    the part, ascending), and the gap (mm) that replaces each.
    """

    axis: int
    left_out: tuple[tuple[float, float], ...]
    gap: float

    def squeezed(self, at: float) -> float:
        """A coordinate's place in the broken view."""
        return at - sum(
            min(max(at - low, 0.0), high - low) * (1.0 - self.gap / (high - low))
            for low, high in self.left_out
        )

    def shows(self, at: float) -> bool:
        return not any(low < at < high for low, high in self.left_out)


@dataclass(frozen=True)
class SheetPlan:
    """The whole sheet: views, notes, and the drawing conventions that complete the dimensions."""

    part: Part
    values: dict[Variable, float]
    conventions: tuple[Measure, ...]
    views: tuple[View, ...]
    notes: tuple[str, ...] = ()
    breaks: Breaks | None = None

    @property
    def dimensions(self) -> tuple[Dimension, ...]:
        return tuple(d for view in self.views for d in view.dimensions)
