"""Sheets of paper after ISO 5457:1999: sizes, frame, centring marks, zones; A4 upright, all others lying by
default. And the preferred scales of ISO 5455:1979.
"""

from __future__ import annotations

from dataclasses import dataclass

from .boxes import Box
from .ink import FRAME, THIN, Item, Text, rectangle, segment

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
    """Fields of ZONE length either way from the middle; what is left over joins the outermost."""
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
