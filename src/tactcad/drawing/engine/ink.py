"""The items that a sheet is made of: lines, arcs, filled areas and texts, in mm of paper, x to the right, y
up.

Line types and widths of ISO 128-2:2020, group 0.5 (thick 0.5, thin 0.25); dashes in multiples of the width.
The font is DejaVu Sans from the pinned matplotlib; heights are those of ISO 3098-1: the height h of capital
letters, in mm.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cache, cached_property, lru_cache
from importlib.util import find_spec
from io import BytesIO
from math import ceil, cos, hypot, radians, sin, sqrt
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from tactcad.design.messages import CheckFailure, InputError

from .boxes import Box, Chord, Point, bounds, bounds_of, corners, grown, scaled

if TYPE_CHECKING:
    from matplotlib.ft2font import FT2Font

# Role of a line or text. Texts of the part and texts of the paper may not touch any line; a watermark may.
Role = (
    Literal["outline", "hidden", "cutting", "hatch", "centre", "extension", "dimension", "leader", "symbol"]
    | Literal["frame", "table", "note", "watermark"]
)
HATCHING = (1.0, 3.0)  # least and largest distance of hatching lines; ISO 128-2 asks for 0.7 at least
LETTERS = 2.5  # height of the usual letters, mm (ISO 3098)
Anchor = Literal["start", "middle", "end"]


@dataclass(frozen=True)
class LineType:
    """Width and dash pattern, mm (drawn, gap, drawn, gap ...; none: continuous)."""

    name: str
    width: float
    dashes: tuple[float, ...] = ()


VISIBLE = LineType("visible", 0.5)  # 01.2: visible edges and outlines
THIN = LineType("thin", 0.25)  # 01.1: dimension, extension, leader lines
HIDDEN = LineType("hidden", 0.25, (3.0, 0.75))  # 02.1: 12 d and 3 d
CENTRE = LineType("centre", 0.25, (6.0, 0.75, 0.25, 0.75))  # 04.1: 24 d, 3 d, dot, 3 d
CUTTING = LineType("cutting", 0.5)  # ends of a cutting plane's line, a dash each: 04.2
FRAME = LineType("frame", 0.7)  # ISO 5457


FAMILY = "DejaVu Sans"
_FILE = Path("mpl-data", "fonts", "ttf", "DejaVuSans.ttf")


def font_file() -> Path:
    """The font's file in the matplotlib package. Raises CheckFailure if it is missing."""
    spec = find_spec("matplotlib")
    for folder in (spec.submodule_search_locations if spec else None) or ():
        if (Path(folder) / _FILE).is_file():
            return Path(folder) / _FILE
    raise CheckFailure(
        f"drawings: the font {FAMILY} ({_FILE.as_posix()} of the package matplotlib) is missing; "
        "no drawing was written; install matplotlib again"
    )


@cache
def _face() -> FT2Font:
    from matplotlib.ft2font import FT2Font

    # from memory: processes that are forked would share an open file, and move each other's place in it
    return FT2Font(BytesIO(font_file().read_bytes()))


@cache
def _glyph(letter: str) -> tuple[float, Box]:
    """Advance and ink box of one letter, in units of the em."""
    from matplotlib.ft2font import LoadFlags

    face = _face()
    if not face.get_char_index(ord(letter)):
        raise CheckFailure(f"drawings: the font {FAMILY} has no letter {letter!r} (U+{ord(letter):04X})")
    glyph = face.load_char(ord(letter), LoadFlags.NO_SCALE)
    em = face.units_per_EM
    x0, y0, x1, y1 = glyph.bbox
    return glyph.horiAdvance / em, (x0 / em, y0 / em, x1 / em, y1 / em)


def refuse_letters_it_lacks(texts: Mapping[str, str]) -> None:
    """Raises InputError for the first letter of a design's texts, by their path, that the font lacks."""
    for path, text in texts.items():
        for letter in text:
            if not _face().get_char_index(ord(letter)):
                raise InputError(
                    path,
                    f"the drawings' font {FAMILY} lacks a letter of it",
                    value=f"{letter} (U+{ord(letter):04X})",
                    legal="letters of the font, or an export without drawings",
                )


@cache
def em(height: float) -> float:
    """Size of the font (mm) whose capital letters are `height` mm high."""
    return height / _glyph("H")[1][3]


@lru_cache(maxsize=4096)  # a sheet's layout is tried in many ways
def width(text: str, height: float) -> float:
    """Sum of the letters' advances, mm."""
    return sum(_glyph(letter)[0] for letter in text) * em(height)


@lru_cache(maxsize=4096)
def ink_box(text: str, height: float) -> Box:
    """x_min, y_min, x_max, y_max of the ink (mm), baseline from (0, 0); a text of blanks has no area.

    Raises CheckFailure if the font lacks a letter.
    """
    pen, corners = 0.0, []
    for letter in text:
        advance, (x0, y0, x1, y1) = _glyph(letter)
        if x1 > x0:
            corners += [(pen + x0, y0), (pen + x1, y1)]
        pen += advance
    return scaled(bounds(corners), em(height)) if corners else (0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Stroke:
    """A line through points; closed if the last one joins the first."""

    points: tuple[Point, ...]
    line: LineType = VISIBLE
    role: Role = "outline"
    closed: bool = False

    def chords(self) -> tuple[Chord, ...]:
        """Its straight pieces."""
        ends = self.points[1:] + (self.points[:1] if self.closed else ())
        return tuple(zip(self.points, ends))


@dataclass(frozen=True)
class DrawnArc:
    """A circular arc from angle `start` counter-clockwise to `end`, degrees; 0 to 360 is the full circle."""

    centre: Point
    radius: float
    start: float = 0.0
    end: float = 360.0
    line: LineType = VISIBLE
    role: Role = "outline"

    @property
    def sweep(self) -> float:
        """Degrees, in (0, 360]."""
        return (self.end - self.start) % 360.0 or 360.0

    def at(self, angle: float) -> Point:
        """The point in the direction `angle`, degrees."""
        return polar(self.centre, self.radius, angle)

    def chords(self) -> tuple[Chord, ...]:
        """Straight pieces within a hundredth of a millimetre of the arc."""
        step = 2 * (2 * 0.01 / max(self.radius, 0.02)) ** 0.5  # sagitta r w^2/8
        count = max(4, ceil(radians(self.sweep) / step))
        points = [self.at(self.start + self.sweep * i / count) for i in range(count + 1)]
        return tuple(zip(points, points[1:]))


@dataclass(frozen=True)
class Fill:
    """A filled polygon: arrow heads, datum triangles, dots."""

    points: tuple[Point, ...]
    role: Role = "dimension"

    def chords(self) -> tuple[Chord, ...]:
        return tuple(zip(self.points, self.points[1:] + self.points[:1]))


@dataclass(frozen=True)
class Text:
    """One line of text: `height` of its capitals in mm, turned by `angle` degrees about `at`, which is on the
    baseline at its start, middle or end."""

    at: Point
    text: str
    height: float = 2.5
    anchor: Anchor = "start"
    angle: float = 0.0
    role: Role = "note"

    @property
    def width(self) -> float:
        """Sum of advances, mm."""
        return width(self.text, self.height)

    @property
    def origin(self) -> Point:
        """Start of the baseline."""
        back = {"start": 0.0, "middle": 0.5, "end": 1.0}[self.anchor] * self.width
        return polar(self.at, -back, self.angle)

    def corners(self, around: float = 0.0) -> tuple[Point, Point, Point, Point]:
        """Corners of the ink's box, counter-clockwise, `around` mm larger on every side."""
        ink = ink_box(self.text, self.height)
        x, y = self.origin
        c, s = cos(radians(self.angle)), sin(radians(self.angle))

        def turned(p: Point) -> Point:
            return (x + c * p[0] - s * p[1], y + s * p[0] + c * p[1])

        first, second, third, fourth = map(turned, corners(grown(ink, around)))
        return (first, second, third, fourth)


@dataclass(frozen=True)
class Hatch:
    """A cut face between closed polygons (even-odd: holes are among them), hatched at 45 degrees."""

    loops: tuple[tuple[Point, ...], ...]
    line: LineType = THIN
    role: Role = "hatch"

    @cached_property
    def spacing(self) -> float:
        """mm between lines: an eighth of the face's narrower extent, in HATCHING."""
        x0, y0, x1, y1 = bounds_of(self.loops)
        return min(max(min(x1 - x0, y1 - y0) / 8, HATCHING[0]), HATCHING[1])

    def chords(self) -> tuple[Chord, ...]:
        """The hatching lines, y - x = k sqrt(2) spacing: one pattern for all areas of the face."""
        return self._lines

    @cached_property
    def _lines(self) -> tuple[Chord, ...]:
        step = self.spacing * sqrt(2.0)
        met: dict[int, list[float]] = {}  # x + y at the outlines' intersections with line k
        for (ax, ay), (bx, by) in self.outlines():
            a, b = (ay - ax) / step, (by - bx) / step
            for k in range(ceil(min(a, b)), ceil(max(a, b))):
                share = (k - a) / (b - a)
                met.setdefault(k, []).append(ax + ay + share * (bx + by - ax - ay))
        lines: list[Chord] = []
        for k, places in sorted(met.items()):
            places.sort()
            points = [((w - k * step) / 2, (w + k * step) / 2) for w in places]
            lines += zip(points[::2], points[1::2])
        return tuple(lines)

    def outlines(self) -> list[Chord]:
        """Sides of the polygons."""
        return [side for loop in self.loops for side in zip(loop, loop[1:] + loop[:1])]

    def holds(self, p: Point) -> bool:
        """Whether a point lies in the hatched area."""
        x, y = p
        passed = [(a, b) for a, b in self.outlines() if (a[1] > y) != (b[1] > y)]
        return sum(x < a[0] + (y - a[1]) * (b[0] - a[0]) / (b[1] - a[1]) for a, b in passed) % 2 == 1


Curve = Stroke | DrawnArc | Hatch
Item = Stroke | DrawnArc | Fill | Hatch | Text


@dataclass(frozen=True)
class DrawnSheet:
    """One sheet: its paper's size (mm), number and title, and everything on it in drawing order."""

    number: str
    title: str
    size: tuple[float, float]
    items: tuple[Item, ...]

    @property
    def texts(self) -> tuple[Text, ...]:
        return tuple(item for item in self.items if isinstance(item, Text))


def points_of(item: Item) -> list[Point]:
    """Points that the item's bounds follow from."""
    if isinstance(item, Text):
        return list(item.corners())
    if isinstance(item, Hatch):
        return [p for loop in item.loops for p in loop]
    return [p for chord in item.chords() for p in chord]


def polar(origin: Point, distance: float, angle: float) -> Point:
    """The point at a distance (mm) in a direction (degrees)."""
    return (origin[0] + distance * cos(radians(angle)), origin[1] + distance * sin(radians(angle)))


def segment(a: Point, b: Point, line: LineType = THIN, role: Role = "dimension") -> Stroke:
    return Stroke((a, b), line, role)


def rectangle(x: float, y: float, w: float, h: float, line: LineType = THIN, role: Role = "table") -> Stroke:
    """A rectangle from its lower left corner."""
    return Stroke(corners((x, y, x + w, y + h)), line, role, closed=True)


def arrow(tip: Point, towards: Point, length: float = 2.5, role: Role = "dimension") -> Fill:
    """A closed filled arrow head of 15 degrees (ISO 129-1, annex A) whose tip points away from `towards`."""
    dx, dy = towards[0] - tip[0], towards[1] - tip[1]
    size = hypot(dx, dy)
    ux, uy = dx / size * length, dy / size * length
    half = 0.131652  # tan(7.5 deg)
    return Fill(
        (
            tip,
            (tip[0] + ux - half * uy, tip[1] + uy + half * ux),
            (tip[0] + ux + half * uy, tip[1] + uy - half * ux),
        ),
        role,
    )


def moved(item: Item, dx: float, dy: float, f: float = 1.0) -> Item:
    """The same item `f` times as large about (0, 0), then elsewhere; letters and lines keep their size."""

    def at(p: Point) -> Point:
        return (p[0] * f + dx, p[1] * f + dy)

    if isinstance(item, DrawnArc):
        return replace(item, centre=at(item.centre), radius=item.radius * f)
    if isinstance(item, Text):
        return replace(item, at=at(item.at))
    if isinstance(item, Hatch):
        return replace(item, loops=tuple(tuple(map(at, loop)) for loop in item.loops))
    return replace(item, points=tuple(map(at, item.points)))


def bounds_of_items(items: Iterable[Item]) -> Box:
    """The least box that holds the items."""
    return bounds_of(map(points_of, items))


def preliminary(sheet: DrawnSheet) -> DrawnSheet:
    """The sheet as a draft: PRELIMINARY across it, under everything else."""
    w, h = sheet.size
    angle = 35.0 if w > h else 55.0
    mark = Text((w / 2, h / 2), "PRELIMINARY", 0.11 * min(w, h), "middle", angle, "watermark")
    return replace(sheet, items=(mark, *sheet.items))
