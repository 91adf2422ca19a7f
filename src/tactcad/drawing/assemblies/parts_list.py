"""The parts list of an assembly sheet (ISO 7573): its rows are the scene's bill of materials."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import cycle

from tactcad.scenes.bom import BomRow

from ..engine.fonts import width
from ..engine.ink import FRAME, THIN, Item, Point, Text, rectangle, segment
from ..engine.title import wrapped

HEADS = ("Item", "Qty", "Part number", "Description", "Material or standard")
WIDTHS = (10.0, 14.0, 60.0, 50.0, 46.0)  # 180: the title block's width
SIZES = (2.5, 1.8)  # heights of the text, ISO 3098
PAD = 1.0
LINE = 1.75  # from line to line, of the text's height


@dataclass(frozen=True)
class Laid:
    """Rows as lines of text in cells, and each row's height (mm)."""

    size: float
    cells: tuple[tuple[tuple[str, ...], ...], ...]

    def height(self, row: int) -> float:
        return LINE * self.size * max(len(cell) for cell in self.cells[row]) + 0.6 * self.size

    @property
    def total(self) -> float:
        """Of all rows, without the heading."""
        return sum(self.height(n) for n in range(len(self.cells)))


def laid(rows: Sequence[BomRow], size: float) -> Laid:
    """The bill's rows with texts broken to the columns."""
    cells = []
    for row in rows:
        quantity = f"{row.qty:g}" if row.unit == "pcs" else f"{row.qty:g} {row.unit}"
        bought = row.standard_designation or row.mpn or row.material  # what it is ordered by
        material = row.material if row.make_buy == "make" else bought
        texts = (str(row.item), quantity, row.part_no, row.description, material)
        cells.append(tuple(tuple(_broken(t, size, w - 2 * PAD)) for t, w in zip(texts, WIDTHS)))
    return Laid(size, tuple(cells))


def _broken(text: str, size: float, room: float) -> list[str]:
    """Lines no wider than `room`, broken at blanks, a long part number behind a hyphen."""
    if " " in text or width(text, size) <= room:
        return wrapped(text, size, room) or [""]
    *pieces, last = (f"{piece}-" for piece in text.split("-"))
    lines = [""]
    for piece in (*pieces, last[:-1]):
        if lines[-1] and width(lines[-1] + piece, size) > room:
            lines.append("")
        lines[-1] += piece
    return [short for line in lines for short in wrapped(line, size, room)]


def heading(size: float) -> float:
    """Height of the heading row, mm."""
    return 2.4 * size


def columns(list_: Laid, rooms: Sequence[float]) -> list[range]:
    """The rows of each column of the list, which have `rooms` mm in turn."""
    turns = cycle(rooms)
    ranges, start, left = [], 0, next(turns) - heading(list_.size)
    for n in range(len(list_.cells)):
        if list_.height(n) > left:
            ranges.append(range(start, n))
            start, left = n, next(turns) - heading(list_.size)
        left -= list_.height(n)
    return [*ranges, range(start, len(list_.cells))]


def drawn(list_: Laid, rows: range, at: Point) -> tuple[list[Item], float]:
    """The rows under a heading, from the upper left corner `at`; the items, and their height (mm)."""
    x0, top = at
    size = list_.size
    y = top - heading(size)
    xs = [x0 + sum(WIDTHS[:i]) for i in range(len(WIDTHS) + 1)]
    items: list[Item] = [
        Text((x + PAD, y + 0.7 * size), head, size, role="table") for x, head in zip(xs, HEADS)
    ]
    items.append(segment((x0, y), (xs[-1], y), FRAME, "table"))
    for n in rows:
        for x, lines in zip(xs, list_.cells[n]):
            for i, line in enumerate(lines):
                items.append(
                    Text((x + PAD, y - LINE * size * (i + 1) + 0.15 * size), line, size, role="table")
                )
        y -= list_.height(n)
        items.append(segment((x0, y), (xs[-1], y), THIN, "table"))
    items += [segment((x, y), (x, top), THIN, "table") for x in xs[1:-1]]
    return [*items, rectangle(x0, y, sum(WIDTHS), top - y, FRAME, "table")], top - y
