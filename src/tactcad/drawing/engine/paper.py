"""The common parts of all sheets: paper after ISO 5457:1999 (sizes, frame, centring marks, zones; A4 upright,
all others lying by default) and the preferred scales of ISO 5455:1979; the title block after ISO 7200:2004,
180 mm wide, in the lower right corner; numbered notes; and the pages of assembly and circuit drawings before
they have frame and title block.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from tactcad.design.messages import CheckFailure
from tactcad.design.tree import Identity
from tactcad.scenes.scene import Placement

from .boxes import Box, Polyline
from .ink import (
    CENTRE,
    FRAME,
    THIN,
    VISIBLE,
    DrawnArc,
    Item,
    LineType,
    Point,
    Stroke,
    Text,
    rectangle,
    segment,
    width,
)

LEFT, OTHER = 20.0, 10.0  # borders outside the frame: filing margin, and the others
ZONE = 50.0  # length of a zone, from the centring marks outwards
MARK = 10.0  # length of the centring marks, outwards from the frame
GRID = 5.0  # width of the strip that carries the zones' letters
ZONE_LETTERS = "ABCDEFGHJKLMNPQRSTUVWXYZ"  # without I and O
Scale = tuple[int, int]
# paper : part, the largest first
SERIES = ((50, 1), (20, 1), (10, 1), (5, 1), (2, 1), (1, 1), (1, 2), (1, 5), (1, 10))
ASSEMBLIES = (*SERIES, (1, 20), (1, 50), (1, 100))


@dataclass(frozen=True)
class Paper:
    """A trimmed sheet, mm."""

    name: str
    width: float
    height: float

    @property
    def size(self) -> tuple[float, float]:
        return (self.width, self.height)

    @property
    def area(self) -> Box:
        """Inside of the frame."""
        return (LEFT, OTHER, self.width - OTHER, self.height - OTHER)


A4 = Paper("A4", 210.0, 297.0)
A4_LYING = Paper("A4", 297.0, 210.0)
A3 = Paper("A3", 420.0, 297.0)
A3_UPRIGHT = Paper("A3", 297.0, 420.0)
A2 = Paper("A2", 594.0, 420.0)
A1 = Paper("A1", 841.0, 594.0)
A0 = Paper("A0", 1189.0, 841.0)


def frame(paper: Paper) -> list[Item]:
    """Frame, border of the zones, centring marks, letters from the top and numbers from the left."""
    x0, y0, x1, y1 = paper.area
    xm, ym = paper.width / 2, paper.height / 2
    items: list[Item] = [
        rectangle(x0, y0, x1 - x0, y1 - y0, FRAME, "frame"),
        rectangle(x0 - GRID, y0 - GRID, x1 - x0 + 2 * GRID, y1 - y0 + 2 * GRID, THIN, "frame"),
    ]
    for a, b in (
        ((xm, y1), (xm, y1 + MARK)),
        ((xm, y0), (xm, y0 - MARK)),
        ((x0, ym), (x0 - MARK, ym)),
        ((x1, ym), (x1 + MARK, ym)),
    ):
        items.append(segment(a, b, FRAME, "frame"))
    for n, (west, east) in enumerate(_zones(x0, x1, xm)):
        for y in (y1, y0 - GRID):
            items.append(Text(((west + east) / 2, y + 1.4), str(n + 1), 2.5, "middle", role="frame"))
            if east < x1:
                items.append(segment((east, y), (east, y + GRID), THIN, "frame"))
    for n, (south, north) in enumerate(reversed(_zones(y0, y1, ym))):
        for x in (x0 - GRID, x1):
            middle = (x + GRID / 2, (south + north) / 2 - 1.25)
            items.append(Text(middle, ZONE_LETTERS[n], 2.5, "middle", role="frame"))
            if south > y0:
                items.append(segment((x, south), (x + GRID, south), THIN, "frame"))
    items.append(Text((x1, y0 - GRID - 3.7), paper.name, 2.5, "end", role="frame"))
    return items


def _zones(low: float, high: float, middle: float) -> list[tuple[float, float]]:
    """Fields of ZONE length either way from the middle; the remainder joins the outermost."""
    # ISO 5457 counts them on the whole sheet: 8 x 6 on A3, 24 x 16 on A0. It has no turned sheets: there the
    # filing margin counts, so that no outermost field is much shorter than the others.
    turned = low == LEFT and 2 * middle == A4.height
    half = int((middle - low) / ZONE + 0.4) if turned else round(middle / ZONE)
    inner = [middle + ZONE * i for i in range(1 - half, round(middle / ZONE))]
    stops = [low, *inner, high]
    return list(zip(stops, stops[1:]))


def shown(scale: Scale) -> str:
    return f"{scale[0]}:{scale[1]}"


def factor(scale: Scale) -> float:
    return scale[0] / scale[1]


def largest_fitting(width: float, height: float, room: tuple[float, float]) -> Scale | None:
    """The largest scale at which width x height (mm of an assembly) fits the room (mm of paper), or None."""
    return next(
        (s for s in ASSEMBLIES if width * factor(s) <= room[0] and height * factor(s) <= room[1]), None
    )


WIDTH, HEIGHT = 180.0, 62.0  # ISO 7200: 180 wide, so that it fits A4
LABEL = 1.8  # height of the cells' headings, ISO 3098 series
TOLERANCING = "tolerancing ISO 8015"  # each limit by itself
# General tolerances: sizes by ISO 2768-1:1989-m, surfaces in a zone of about its two middle ranges; chosen:
# ordinary milling and wire-cutting keep it.
GENERAL_TOLERANCES = (
    "ISO 22081; sizes to 6 ±0.1, to 30 ±0.2,",
    "to 120 ±0.3, to 400 ±0.5, above ±0.8;",
    "surfaces: profile 0.4, to datums if any",
)
SAMPLE = "sample, not for order"  # document status of what has no owner
EDGE = LineType("edge", 0.35)  # visible edges of an assembly: the thinner line group of ISO 128-2
MARGIN = 5.0  # distance of anything from the frame
# a view has at most this many: repeated parts beyond are left out, since the kernel compares them pair by
# pair
MOST_DRAWN = 150


@dataclass(frozen=True)
class TitleBlock:
    """Contents of the title block. `mass` in g, None if it is not stated; `scale` as text, "5:1"."""

    legal_owner: str
    number: str
    revision: str
    date: str
    title: str
    supplementary: str  # the design that the sheet belongs to
    creator: str
    status: str
    document_type: str = ""
    scale: str = ""
    sheet: int = 1
    sheets: int = 1
    material: str = ""
    mass: float | None = None
    finish: str = ""
    dimensioned: bool = True  # a sheet without a dimension states no general tolerance and no projection


def block_of(identity: Identity, number: str, title: str, draft: bool, sample: bool = False) -> TitleBlock:
    """The entries common to the title blocks of a design's sheets; blank if not stated."""
    return TitleBlock(
        legal_owner=identity.organisation or "",
        number=number,
        revision=identity.revision,
        date=identity.date,
        title=title,
        supplementary=identity.title,
        creator=identity.author or "",
        status=SAMPLE if sample else "draft" if draft else "for manufacture",
    )


def title_block(paper: Paper, t: TitleBlock) -> list[Item]:
    """The block's lines and texts. Raises CheckFailure if a text does not fit its cell."""
    x0, y0 = paper.area[2] - WIDTH, paper.area[1]
    items: list[Item] = [rectangle(x0, y0, WIDTH, HEIGHT, FRAME, "table")]
    mass = "" if t.mass is None else f"{t.mass:.3g} g" if t.mass < 1000 else f"{t.mass / 1000:.3g} kg"
    limits, units = (
        (GENERAL_TOLERANCES, ("mm, angles in degrees", TOLERANCING)) if t.dimensioned else ("", "mm")
    )
    material = (
        (54, "Material and temper", tuple(t.material.split(", "))),
        (24, "Mass", mass),
        (64, "General tolerances", limits),
    )
    finish = ((96, "Surface finish", t.finish), (54, "Dimensions", units))
    signed = ((46, "Created by", t.creator), (46, "Approved by", ""))  # by hand
    kind = ((44, "Document type", t.document_type), (44, "Document status", t.status))
    titles = (92, "Title, supplementary title", (t.title, t.supplementary))
    issue = ((92, "Legal owner", t.legal_owner), (18, "Revision", t.revision), (40, "Date of issue", t.date))
    rows = (  # height, cells of width, heading, value
        (15, (*material, (18, "Scale", t.scale), (20, "Projection", ""))),
        (12, (*finish, (15, "Paper", paper.name), (15, "Language", "en"))),
        (10, (*signed, *kind)),
        (15, (titles, (88, "Identification number", t.number))),
        (10, (*issue, (30, "Sheet", f"{t.sheet}/{t.sheets}"))),
    )
    y = y0 + HEIGHT
    for height, cells in rows:
        y -= height
        x = x0
        for w, heading, value in cells:
            items += _cell(x, y, w, height, heading, value)
            x += w
    return items + (_first_angle((x0 + 170.0, y0 + HEIGHT - 7.6)) if t.dimensioned else [])


def _cell(x: float, y: float, w: float, h: float, heading: str, value: str | tuple[str, ...]) -> list[Item]:
    items: list[Item] = [
        rectangle(x, y, w, h, THIN, "table"),
        Text((x + 1.0, y + h - LABEL - 0.9), heading, LABEL, role="table"),
    ]
    given = [line for line in ((value,) if isinstance(value, str) else value) if line]
    room, high = w - 2.0, h - LABEL - 2.4
    # the largest size at which all fits, broken rather than in the headings' letters
    for size, whole in ((3.5, True), (2.5, True), (2.5, False), (1.8, True), (1.8, False)):
        lines = given if whole else [piece for line in given for piece in wrapped(line, size, room)]
        high_enough = size * (1.6 * len(lines) - 0.3) <= high
        if high_enough and all(width(line, size) <= room for line in lines):
            step, base = 1.6 * size, y + 1.1 + 0.25 * size
            at = [(x + 1.0, base + step * (len(lines) - 1 - i)) for i in range(len(lines))]
            return items + [Text(p, line, size, role="table") for p, line in zip(at, lines)]
    raise CheckFailure(f"drawings: {heading.lower()} {' '.join(value)!r} does not fit the title block")


def _first_angle(at: Point) -> list[Item]:
    """Symbol of first-angle projection (ISO 5456-2): truncated cone to the left of its end view."""
    x, y = at
    small, large = 1.4, 2.8
    left, right, circle = x - 7.2, x - 1.8, x + 3.6
    cone = ((left, y - small), (right, y - large), (right, y + large), (left, y + small))
    return [
        Stroke(cone, VISIBLE, "symbol", True),
        segment((left - 1.0, y), (right + 1.0, y), CENTRE, "symbol"),
        DrawnArc((circle, y), small, line=VISIBLE, role="symbol"),
        DrawnArc((circle, y), large, line=VISIBLE, role="symbol"),
        segment((circle - large - 1.0, y), (circle + large + 1.0, y), CENTRE, "symbol"),
        segment((circle, y - large - 1.0), (circle, y + large + 1.0), CENTRE, "symbol"),
    ]


def wrapped(text: str, height: float, room: float) -> list[str]:
    """The text in lines no wider than `room` mm, broken at blanks, or inside a word that is too long."""
    lines, line = [], ""
    for word in text.split():
        longer = f"{line} {word}" if line else word
        if width(longer, height) <= room:
            line = longer
            continue
        if line:
            lines.append(line)
        while width(word, height) > room:
            fits = max(n for n in range(1, len(word)) if n == 1 or width(word[:n], height) <= room)
            lines.append(word[:fits])
            word = word[fits:]
        line = word
    return [*lines, line] if line else lines


def notes(at: Point, lines: Sequence[str], room: float, height: float = 2.5) -> tuple[list[Item], float]:
    """Numbered notes from the upper left corner `at`, `room` mm wide; the items, and their height (mm)."""
    items: list[Item] = []
    indent = width("00. ", height)
    x, y = at
    for n, line in enumerate(lines, start=1):
        for i, piece in enumerate(wrapped(line, height, room - indent)):
            y -= 1.7 * height
            if i == 0:
                items.append(Text((x, y), f"{n}.", height))
            items.append(Text((x + indent, y), piece, height))
        y -= 0.3 * height
    return items, at[1] - y


@dataclass(frozen=True)
class Page:
    """A page's items, its scale as text, and its kind."""

    paper: Paper
    scale: str
    items: tuple[Item, ...]
    document_type: str


def edges(lines: Sequence[Polyline], f: float, shift: tuple[float, float]) -> list[Stroke]:
    """Lines of a view (mm of the assembly) on the paper, at the scale f."""
    return [Stroke(tuple((x * f + shift[0], y * f + shift[1]) for x, y in line), EDGE) for line in lines]


def fewer(placements: Sequence[Placement]) -> tuple[Placement, ...]:
    """All of them, or the first few of every part if there are too many."""
    most = len(placements)
    while True:
        count: dict[str, int] = {}
        kept = []
        for p in placements:
            count[p.part.part_no] = count.get(p.part.part_no, 0) + 1
            if count[p.part.part_no] <= most:
                kept.append(p)
        if len(kept) <= MOST_DRAWN or most == 1:
            return tuple(kept)
        most = max(1, most // 2)
