"""Parts side by side, one of each, each at a scale of its own that fills the sheet: the last resort, where
an exploded view would be too large or too crowded. A part's item number stands above it, its scale below
it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from .balloons import RADIUS, SHORTEST, Balloon
from .boxes import Box, Point, Polyline, bounds_of
from .scale import Scale, factor, largest_fitting

GAP = 6.0  # between cells, mm of paper
ABOVE = 2 * RADIUS + 2 * SHORTEST  # for a part's balloon
BELOW = 5.0  # for its scale
SIZES = tuple(range(150, 15, -5))  # tried for the larger side of every part, mm of paper


@dataclass(frozen=True)
class Shown:
    """A part on the page: its lines (mm of paper), its balloon, its scale, and the middle below it."""

    lines: tuple[Polyline, ...]
    balloon: Balloon
    scale: Scale
    below: Point


def pages(own: Mapping[int, Sequence[Polyline]], area: Box) -> list[list[Shown]] | None:
    """The parts by number, no larger on the paper than fits one page, or on as many as they need; None where
    a part is too large for the smallest scale."""
    best = None
    for size in SIZES:
        scales = {}
        for item, lines in own.items():
            x0, y0, x1, y1 = bounds_of(lines)
            if scale := largest_fitting(x1 - x0, y1 - y0, (size, size)):
                scales[item] = scale
        if len(scales) == len(own) and (laid := _laid(own, scales, area)):
            best = laid
            if len(laid) == 1:
                break
    return best


def _laid(
    own: Mapping[int, Sequence[Polyline]], scales: Mapping[int, Scale], area: Box
) -> list[list[Shown]] | None:
    """The parts in rows from the left, the rows below each other; None where one is too large for the
    area."""
    x0, y0, x1, y1 = area
    cells = {item: _cell(lines, factor(scales[item])) for item, lines in own.items()}
    if any(w > x1 - x0 or h > y1 - y0 for w, h in cells.values()):
        return None
    rows: list[list[int]] = [[]]
    for item, (w, _) in cells.items():
        if rows[-1] and sum(cells[n][0] for n in rows[-1]) + w > x1 - x0:
            rows.append([])
        rows[-1].append(item)
    filled: list[list[Shown]] = [[]]
    top = y1
    for row in rows:
        high = max(cells[item][1] for item in row)
        if top - high < y0:
            filled.append([])
            top = y1
        x = x0
        for item in row:
            filled[-1].append(_shown(item, own[item], scales[item], (x, top - high)))
            x += cells[item][0]
        top -= high
    return filled


def _cell(lines: Sequence[Polyline], f: float) -> tuple[float, float]:
    """Width and height that a part takes with its balloon, its scale and the gap."""
    x0, y0, x1, y1 = bounds_of(lines)
    left, right = _sides(lines, f)
    return right - left + GAP, (y1 - y0) * f + ABOVE + BELOW + GAP


def _sides(lines: Sequence[Polyline], f: float) -> tuple[float, float]:
    """Of the part at its scale and the balloon over its topmost point."""
    x0, _, x1, _ = bounds_of(lines)
    tip = _topmost(lines)[0] * f
    return min(x0 * f, tip - RADIUS), max(x1 * f, tip + RADIUS)


def _topmost(lines: Sequence[Polyline]) -> Point:
    return max((p for line in lines for p in line), key=lambda p: (round(p[1], 6), -p[0]))


def _shown(item: int, lines: Sequence[Polyline], scale: Scale, corner: Point) -> Shown:
    """A part whose cell has its lower left corner there; the leader goes straight down to its topmost
    point."""
    f = factor(scale)
    left, right = _sides(lines, f)
    dx, dy = corner[0] + GAP / 2 - left, corner[1] + GAP / 2 + BELOW - f * bounds_of(lines)[1]
    placed = tuple(tuple((x * f + dx, y * f + dy) for x, y in line) for line in lines)
    tip = _topmost(placed)
    below = ((left + right) / 2 + dx, corner[1] + GAP / 2)
    return Shown(placed, Balloon(item, (tip[0], tip[1] + RADIUS + SHORTEST), tip), scale, below)
