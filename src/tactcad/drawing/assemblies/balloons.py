"""Item numbers in balloons around a view (ISO 6433:2012): where each stands and where its leader ends.

Each balloon takes a place of a square grid, outside the parts' outlines and clear of every line. Places and
leader ends are chosen for the least total length of the leaders: then no two leaders cross, for exchanging
their places would shorten them (the assignment problem, by scipy). A fault of the shortest solution, such as
a leader close to another balloon, is forbidden and the next best solution is tried.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import dist, hypot

import numpy as np

from ..engine.boxes import Box, Chord, Point, crossing, length
from ..engine.ink import THIN, DrawnArc, Fill, Item, Text, arrow, segment

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


@dataclass(frozen=True)
class Balloon:
    """An item number or a view's letter; the middle of its circle, and where its leader ends, mm of paper."""

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
    """Of the number in its balloon, mm."""
    return TEXT if len(number) < 3 else SMALLER


def place(
    own: Mapping[int | str, Sequence[Sequence[Point]]], lines: Sequence[Sequence[Point]], area: Box
) -> list[Balloon] | None:
    """A balloon in the area (mm of paper) for each item, at its own visible lines and clear of all `lines`;
    None where they find no place."""
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
    # distance to what is drawn or lies inside an outline
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
    """Pairs (by index) of balloons whose leaders meet, or one's that comes near the other's circle."""
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
