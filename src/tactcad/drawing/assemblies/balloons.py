"""Item numbers: in balloons around a view (ISO 6433:2012), with the places of balloon and leader's end; and
in the parts list (ISO 7573), whose rows are the scene's bill of materials.

Each balloon takes a place of a square grid, outside the parts' outlines and clear of every line. Places and
leader ends are chosen for the least total length of the leaders: then no two leaders cross, for exchanging
their places would shorten them (the assignment problem, by scipy). A fault of the shortest solution, such as
a leader close to another balloon, is forbidden and the next best solution is tried.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, cycle
from math import dist, hypot

import numpy as np

from tactcad.scenes.bom import BomRow

from ..engine.boxes import Box, Chord, Point, crossing, length
from ..engine.ink import FRAME, THIN, DrawnArc, Fill, Item, Text, arrow, rectangle, segment, width
from ..engine.paper import wrapped

RADIUS = 4.5  # of a balloon
TEXT, SMALLER = 3.5, 2.5  # height of its number, larger than dimensions are (ISO 6433); of three digits
PITCH = 12.0  # of the places
CLEAR = 3.0  # from a balloon to any line of the parts
CELL = 0.5  # of the raster on which outlines are filled
SHORTEST = 4.0  # leader outside its balloon
APART = 1.2  # between leaders, and from a leader to another balloon or another leader's end
TIPS = 60  # places tried for the end of an item's leader
ROUNDS = 120  # rounds of forbidding and trying again
FORBIDDEN = 1e6
# the parts list
HEADS = ("Item", "Qty", "Part number", "Description", "Material or standard")
WIDTHS = (10.0, 14.0, 60.0, 50.0, 46.0)  # 180: the title block's width
SIZES = (2.5, 1.8)  # heights of the text, ISO 3098
PAD = 1.0
LINE = 1.75  # from line to line, of the text's height


@dataclass(frozen=True)
class Balloon:
    """An item number or a view's letter; the middle of its circle, and its leader's end, mm of paper."""

    item: int | str
    centre: Point
    tip: Point

    @property
    def leader(self) -> Chord:
        """From the circle to the tip."""
        (cx, cy), (tx, ty) = self.centre, self.tip
        share = RADIUS / hypot(tx - cx, ty - cy)
        return ((cx + share * (tx - cx), cy + share * (ty - cy)), self.tip)


def height(number: str) -> float:
    """Height of the number in its balloon, mm."""
    return TEXT if len(number) < 3 else SMALLER


def place(
    own: Mapping[int | str, Sequence[Sequence[Point]]], lines: Sequence[Sequence[Point]], area: Box
) -> list[Balloon] | None:
    """A balloon in the area (mm of paper) for each item, at its own visible lines and clear of all `lines`;
    None if they find no place."""
    places = _places(lines, area)
    shared = Counter(line for some in own.values() for line in {*map(tuple, some)})
    tips = {}
    for item, some in own.items():
        # middles of its visible lines, the longest first; lines that are another item's too come last
        ranked = sorted(
            some, key=lambda line: (shared[tuple(line)] > 1, -round(length(line), 6), tuple(line))
        )
        tips[item] = [_middle(line) for line in ranked[:TIPS]]
    if len(places) < len(own) or not all(tips.values()):
        return None
    lengths = []  # from each place to each of an item's tips
    for ends in tips.values():
        leaders = np.hypot(*(np.array(places)[:, None, :] - np.array(ends)[None, :, :]).transpose(2, 0, 1))
        lengths.append(np.where(leaders < RADIUS + SHORTEST, FORBIDDEN, leaders))
    return _without_faults(list(own), lengths, list(tips.values()), places)


def _places(lines: Sequence[Sequence[Point]], area: Box) -> list[Point]:
    """Grid points of the area outside the outlines, clear of every line."""
    from scipy import ndimage

    x0, y0, x1, y1 = area
    shape = (int((x1 - x0) / CELL) + 1, int((y1 - y0) / CELL) + 1)
    drawn = np.zeros(shape, dtype=bool)
    for line in lines:
        for a, b in zip(line, line[1:]):
            count = int(dist(a, b) / (CELL / 2)) + 2
            xs, ys = (np.linspace(a[k], b[k], count) for k in (0, 1))
            i, j = ((xs - x0) / CELL).astype(int), ((ys - y0) / CELL).astype(int)
            inside = (i >= 0) & (j >= 0) & (i < shape[0]) & (j < shape[1])
            drawn[i[inside], j[inside]] = True
    framed = np.pad(drawn, 1)
    regions, _ = ndimage.label(~framed)
    outside = (regions == regions[0, 0])[1:-1, 1:-1]
    # distance to lines and to the inside of outlines
    room = ndimage.distance_transform_edt(outside) * CELL
    places = []
    for x in np.arange(x0 + RADIUS + 1.0, x1 - RADIUS - 1.0 + 1e-9, PITCH):
        for y in np.arange(y0 + RADIUS + 1.0, y1 - RADIUS - 1.0 + 1e-9, PITCH):
            if room[int((x - x0) / CELL), int((y - y0) / CELL)] >= RADIUS + CLEAR:
                places.append((round(float(x), 3), round(float(y), 3)))
    return places


def _middle(line: Sequence[Point]) -> Point:
    left = round(length(line), 6) / 2
    for a, b in zip(line, line[1:]):
        step = dist(a, b)
        if left <= step and step > 0:
            return (a[0] + left / step * (b[0] - a[0]), a[1] + left / step * (b[1] - a[1]))
        left -= step
    return line[-1]


def _without_faults(
    items: Sequence[int | str],
    lengths: Sequence[np.ndarray],
    tips: Sequence[Sequence[Point]],
    places: Sequence[Point],
) -> list[Balloon] | None:
    """The shortest solution without faults; of two leaders that meet the longer one is forbidden."""
    from scipy.optimize import linear_sum_assignment

    cost = np.array([own.min(axis=1) for own in lengths])
    for _ in range(ROUNDS):
        rows, columns = linear_sum_assignment(cost)
        if cost[rows, columns].max() >= FORBIDDEN:
            return None
        used = [int(lengths[i][k].argmin()) for i, k in zip(rows, columns)]
        balloons = [Balloon(items[i], places[k], tips[i][t]) for i, k, t in zip(rows, columns, used)]
        wrong = faults(balloons)
        if not wrong:
            return balloons
        for worse in {max(pair, key=lambda n: cost[rows[n], columns[n]]) for pair in wrong}:
            i, k = rows[worse], columns[worse]
            lengths[i][k, used[worse]] = FORBIDDEN
            cost[i, k] = lengths[i][k].min()
    return None


def faults(balloons: Sequence[Balloon]) -> list[tuple[int, int]]:
    """Pairs (by index) of balloons whose leaders meet, or of a leader near the other's circle."""
    return [
        (i, k)
        for (i, a), (k, b) in combinations(enumerate(balloons), 2)
        if crossing(a.leader, b.leader, 0.0)
        or min(_to_segment(p, other.leader) for one, other in ((a, b), (b, a)) for p in one.leader) < APART
        or _to_segment(a.centre, b.leader) < RADIUS + APART
        or _to_segment(b.centre, a.leader) < RADIUS + APART
    ]


def _to_segment(p: Point, s: Chord) -> float:
    (ax, ay), (bx, by) = s
    dx, dy = bx - ax, by - ay
    t = min(1.0, max(0.0, ((p[0] - ax) * dx + (p[1] - ay) * dy) / (dx * dx + dy * dy)))
    return dist(p, (ax + t * dx, ay + t * dy))


def drawn(balloons: Sequence[Balloon]) -> list[Item]:
    """Circles, numbers, leaders and their arrows."""
    items: list[Item] = []
    for b in balloons:
        start, tip = b.leader
        head: Fill = arrow(tip, start, role="leader")
        number = str(b.item)
        size = height(number)
        items += [
            DrawnArc(b.centre, RADIUS, line=THIN, role="symbol"),
            Text((b.centre[0], b.centre[1] - size / 2), number, size, "middle"),
            segment(start, tip, THIN, "leader"),
            head,
        ]
    return items


@dataclass(frozen=True)
class Laid:
    """Rows as lines of text in cells, and each row's height (mm)."""

    size: float
    cells: tuple[tuple[tuple[str, ...], ...], ...]

    def height(self, row: int) -> float:
        return LINE * self.size * max(len(cell) for cell in self.cells[row]) + 0.6 * self.size

    @property
    def total(self) -> float:
        """Height of all rows, without the heading."""
        return sum(self.height(n) for n in range(len(self.cells)))


def laid(rows: Sequence[BomRow], size: float) -> Laid:
    """The bill's rows with texts broken to the columns."""
    cells = []
    for row in rows:
        quantity = f"{row.qty:g}" if row.unit == "pcs" else f"{row.qty:g} {row.unit}"
        bought = row.standard_designation or row.mpn or row.material  # order designation
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


def laid_columns(list_: Laid, rooms: Sequence[float]) -> list[range]:
    """The rows of each column of the list, which have `rooms` mm in turn."""
    turns = cycle(rooms)
    ranges, start, left = [], 0, next(turns) - heading(list_.size)
    for n in range(len(list_.cells)):
        if list_.height(n) > left:
            ranges.append(range(start, n))
            start, left = n, next(turns) - heading(list_.size)
        left -= list_.height(n)
    return [*ranges, range(start, len(list_.cells))]


def list_drawn(list_: Laid, rows: range, at: Point) -> tuple[list[Item], float]:
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
