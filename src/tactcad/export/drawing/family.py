"""One of each part beside the next, with its item number above it: where an exploded view would be too large or too crowded."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from . import balloons
from .balloons import RADIUS, SHORTEST, Balloon

Polyline = Sequence[tuple[float, float]]
Box = tuple[float, float, float, float]

GAP = 6.0  # between cells, mm of paper
ABOVE = 2 * RADIUS + 2 * SHORTEST  # for a part's balloon


@dataclass(frozen=True)
class Shown:
    """A part on the page: its lines (mm of paper) and its balloon."""

    lines: tuple[tuple[tuple[float, float], ...], ...]
    balloon: Balloon


def rows_of(own: Mapping[int, Sequence[Polyline]], f: float, room: tuple[float, float]) -> list[list[int]] | None:
    """Items in rows from the left, by number, for a room of width x height mm; several pages follow each other in rows'
    order. None where one part alone does not fit."""
    rows: list[list[int]] = [[]]
    used = 0.0
    for item, lines in own.items():
        w, h = _cell(lines, f)
        if w > room[0] or h > room[1]:
            return None
        if rows[-1] and used + w > room[0]:
            rows.append([])
            used = 0.0
        rows[-1].append(item)
        used += w
    return rows


def pages(own: Mapping[int, Sequence[Polyline]], f: float, area: Box) -> list[list[Shown]] | None:
    """The parts at the scale f on as many pages as they need; None where one part alone does not fit."""
    x0, y0, x1, y1 = area
    rows = rows_of(own, f, (x1 - x0, y1 - y0))
    if rows is None:
        return None
    found: list[list[Shown]] = [[]]
    top = y1
    for row in rows:
        high = max(_cell(own[item], f)[1] for item in row)
        if top - high < y0:
            found.append([])
            top = y1
        x = x0
        for item in row:
            found[-1].append(_shown(item, own[item], f, (x, top - high)))
            x += _cell(own[item], f)[0]
        top -= high
    return found


def _cell(lines: Sequence[Polyline], f: float) -> tuple[float, float]:
    x0, y0, x1, y1 = _box(lines)
    return max((x1 - x0) * f, 2 * RADIUS) + GAP, (y1 - y0) * f + ABOVE + GAP


def _box(lines: Sequence[Polyline]) -> Box:
    xs, ys = zip(*(p for line in lines for p in line))
    return (min(xs), min(ys), max(xs), max(ys))


def _shown(item: int, lines: Sequence[Polyline], f: float, corner: tuple[float, float]) -> Shown:
    """A part whose cell has its lower left corner there; the leader goes straight down to its topmost point."""
    x0, y0, x1, y1 = _box(lines)
    width, _ = _cell(lines, f)
    dx = corner[0] + width / 2 - f * (x0 + x1) / 2
    dy = corner[1] + GAP / 2 - f * y0
    placed = tuple(tuple((x * f + dx, y * f + dy) for x, y in line) for line in lines)
    tip = max((p for line in placed for p in line), key=lambda p: (round(p[1], 6), -p[0]))
    return Shown(placed, Balloon(item, (tip[0], tip[1] + RADIUS + SHORTEST), tip))


def drawn(page: Sequence[Shown]) -> list[balloons.Item]:
    """The balloons of a page."""
    return balloons.drawn([shown.balloon for shown in page])
