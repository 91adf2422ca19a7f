"""Tolerance frames (ISO 1101:2017) and datum feature symbols (ISO 5459:2011) on paper.

The symbols of characteristics are drawn as strokes (proportions of ISO 7083): no font need have them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from tactcad.parts.limits import Symbol

from .boxes import Point, corners, grown
from .fonts import width
from .ink import THIN, DrawnArc, Fill, Item, Stroke, Text, rectangle, segment
from .sheet_plan import Frame

HEIGHT = 2.5  # of letters, mm
FRAME = 2 * HEIGHT  # height of a frame, and least width of its cells
PAD = 1.0  # beside the text of a cell
STEM = 8.0  # from a datum's feature to the middle of its letter: shortest


def frame_width(frame: Frame) -> float:
    """mm of paper."""
    return FRAME + sum(map(_cell_width, frame.cells))


def tolerance_frame(frame: Frame, corner: Point) -> list[Item]:
    """Symbol, zone and datum letters in their cells, from the upper left corner."""
    x, y = corner[0], corner[1] - FRAME
    items = [_box(x, y, FRAME), *_SYMBOLS[frame.geometric.symbol]((x + FRAME / 2, y + FRAME / 2))]
    x += FRAME
    for text in frame.cells:
        w = _cell_width(text)
        items += [_box(x, y, w), Text((x + w / 2, y + HEIGHT / 2), text, HEIGHT, "middle", role="symbol")]
        x += w
    return items


def datum(at: Point, away: Point, reach: float, letter: str) -> list[Item]:
    """Filled triangle on an edge, and the letter in a square `reach` mm away from it."""
    (x, y), (ux, uy) = at, away
    tip = (x + 3.0 * ux, y + 3.0 * uy)
    end = (x + (reach - FRAME / 2) * ux, y + (reach - FRAME / 2) * uy)
    middle = (x + reach * ux, y + reach * uy)
    return [
        Fill(((x - 1.75 * uy, y + 1.75 * ux), (x + 1.75 * uy, y - 1.75 * ux), tip), "symbol"),
        segment(tip, end, THIN, "symbol"),
        Stroke(corners(grown((*middle, *middle), FRAME / 2)), THIN, "symbol", True),
        Text((middle[0], middle[1] - HEIGHT / 2), letter, HEIGHT, "middle", role="symbol"),
    ]


def block(frames: Sequence[Frame], letter: str, corner: Point, wide: float) -> list[Item]:
    """Frames below each other from the upper left corner; a datum's symbol below them, or below a line
    `wide` mm long where there are none."""
    items: list[Item] = []
    x, y = corner
    for frame in frames:
        items += tolerance_frame(frame, (x, y))
        y -= FRAME
    if not frames:
        items.append(segment((x, y), (x + wide, y), THIN, "symbol"))
    return [*items, *(datum((x + FRAME / 2, y), (0.0, -1.0), STEM, letter) if letter else ())]


def _cell_width(text: str) -> float:
    return max(FRAME, width(text, HEIGHT) + 2 * PAD)


def _box(x: float, y: float, w: float) -> Item:
    return rectangle(x, y, w, FRAME, THIN, "symbol")


def _position(at: Point) -> list[Item]:
    x, y = at
    arms = (((x - 1.8, y), (x + 1.8, y)), ((x, y - 1.8), (x, y + 1.8)))
    return [DrawnArc(at, 1.1, line=THIN, role="symbol"), *(segment(*arm, THIN, "symbol") for arm in arms)]


def _flatness(at: Point) -> list[Item]:
    x, y = at
    points = ((x - 1.9, y - 0.9), (x + 0.9, y - 0.9), (x + 1.9, y + 0.9), (x - 0.9, y + 0.9))
    return [Stroke(points, THIN, "symbol", True)]


def _parallelism(at: Point) -> list[Item]:
    x, y = at
    return [
        segment((x + off - 0.7, y - 1.3), (x + off + 0.7, y + 1.3), THIN, "symbol") for off in (-0.65, 0.65)
    ]


def _perpendicularity(at: Point) -> list[Item]:
    x, y = at
    foot, post = ((x - 1.6, y - 1.4), (x + 1.6, y - 1.4)), ((x, y - 1.4), (x, y + 1.6))
    return [segment(*foot, THIN, "symbol"), segment(*post, THIN, "symbol")]


_SYMBOLS: dict[Symbol, Callable[[Point], list[Item]]] = {
    "position": _position,
    "flatness": _flatness,
    "parallelism": _parallelism,
    "perpendicularity": _perpendicularity,
}
