"""Limits between two edges of an outline: a dimension line each, beside the running dimensions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from tactcad.contour import Arc, Line, Segment
from tactcad.parts.description import Characteristic, Part

from .boxes import Point
from .keys import OUTER, Spot
from .measures import Level, Span, level
from .sheet_plan import Linear, Side, View, seen
from .sketch import ALIKE, Sketch

SIDES: tuple[Side, Side] = ("bottom", "left")  # of distances along x and along y


@dataclass(frozen=True)
class EdgeStand:
    """Where a dimension stands on an outline's edge: its level along an axis, and a point of it, mm."""

    level: Level
    value: float
    at: Point


def edge_spans(sketch: Sketch, view: View, part: Part) -> list[Linear]:
    """Dimension lines for what the part limits between two edges of its outline that are square to x or y."""
    linears = []
    for c in part.characteristics:
        found = _between(part, c)
        if found is None:
            continue
        k, (a, b) = found
        a, b = sorted((a, b), key=lambda stand: stand.value)
        d = sketch.must(sketch.stating(c.name, (Span(a.level, b.level),)))
        linears.append(Linear(d, SIDES[k], seen(view, (*a.at, 0.0)), seen(view, (*b.at, 0.0))))
    return linears


def _between(part: Part, c: Characteristic) -> tuple[int, tuple[EdgeStand, EdgeStand]] | None:
    """Axis and stands of a limit between two edges that are its nominal size apart; None where it is no such
    limit."""
    if len(c.between) != 2:
        return None
    for k in (0, 1):
        firsts, seconds = (list(_stands(part, name, k)) for name in c.between)
        for a in firsts:
            for b in seconds:
                if abs(abs(a.value - b.value) - c.nominal) < ALIKE:
                    return k, (a, b)
    return None


def _stands(part: Part, name: str, k: int) -> Iterator[EdgeStand]:
    """Where edges of that name stand along axis k: lines square to it; of a full round its summit."""
    for i, s in enumerate(part.extrusion.outer):
        if s.name != name:
            continue
        if isinstance(s, Line) and abs(s.start[k] - s.end[k]) < ALIKE:
            yield EdgeStand(level(Spot(OUTER, i).place(k)), s.start[k], s.start)
        elif isinstance(s, Arc) and _half_turn(s, k):
            yield _summit(s, i, k)


def _half_turn(s: Segment, k: int) -> bool:
    """Whether an arc is half a turn about axis k: it starts and ends beside its centre."""
    return isinstance(s, Arc) and all(abs(p[k] - s.centre[k]) < ALIKE for p in (s.start, s.end))


def _summit(s: Arc, i: int, k: int) -> EdgeStand:
    """The summit of half a turn: its centre and its radius, which its start has across the axis."""
    start, centre = Spot(OUTER, i), Spot(OUTER, i, centre=True)
    across = 1 - k
    out = 1.0 if s.start[across] > s.centre[across] else -1.0
    top = s.at(0.5)
    way = 1.0 if top[k] > s.centre[k] else -1.0
    terms = ((centre.place(k), 1.0), (start.place(across), way * out), (centre.place(across), -way * out))
    return EdgeStand(Level(terms), top[k], top)
