"""The plan of a sheet of cells: foil and spacers. The whole outline in one view, with the places of its holes
and of the cells; a cell of each kind enlarged, with its dimensions, which hold for all cells of the kind.

A foil of 36 cells has 6,000 points. The sheet dimensions the first cell of each kind; that the others repeat
it, on a regular grid and alternating like a chessboard, is looked at point by point.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, product
from math import dist
from typing import cast

from tactcad.contour import Arc, Contour, Line
from tactcad.design.messages import CheckFailure
from tactcad.drawing.assemblies.arrangement import given
from tactcad.drawing.engine.boxes import Box
from tactcad.drawing.parts.callouts import equal_radii, groups, hole_callout, running_along
from tactcad.drawing.parts.measures import (
    OUTER,
    Level,
    MeasureDifference,
    Owner,
    Span,
    Spot,
    conventions,
    level,
    radius_of,
    rounds,
)
from tactcad.drawing.parts.prism import FRONT, side_view
from tactcad.drawing.parts.sheet_plan import Dimension, Linear, SheetPlan, Side, View
from tactcad.drawing.parts.sketch import ALIKE, Coordinate, Sketch, closed, view_of
from tactcad.drawing.parts.tolerances import with_marks
from tactcad.parts.language.description import Part

from .cell_layout import PlanarLayout

LABELS = ("X", "Z")  # of the kinds' details
ROOM = (95.0, 95.0)  # mm of paper for a cell; of one that is to be spared
SPARE_ROOM = (72.0, 72.0)
AROUND = 0.06  # detail of a cell's opening
SPIGOT = "spigot"  # name of the holes in the middle of cells

Point = tuple[float, float]


@dataclass(frozen=True)
class SheetCell:
    """A cell of the sheet: its middle, mm; its openings by number; its contours about its middle."""

    at: Point
    openings: tuple[int, ...]
    shape: frozenset


def cells_of(part: Part) -> list[SheetCell]:
    """The cells by y and x: openings around their spigot's hole; without such holes each opening is one."""
    found = part.extrusion.openings
    middles = [(f.at[0], f.at[1]) for f in part.features if f.name == SPIGOT] or [_middle(c) for c in found]
    own: dict[Point, list[int]] = {at: [] for at in middles}
    for n, contour in enumerate(found):
        middle = _middle(contour)
        own[min(middles, key=lambda at: dist(at, middle))].append(n)
    cells = (SheetCell(at, tuple(ns), frozenset(_about(found[n], at) for n in ns)) for at, ns in own.items())
    return sorted(cells, key=lambda cell: (round(cell.at[1], 9), round(cell.at[0], 9)))


def _middle(contour: Contour) -> Point:
    x0, y0, x1, y1 = contour.box
    return ((x0 + x1) / 2.0, (y0 + y1) / 2.0)


def _about(contour: Contour, at: Point) -> tuple:
    """Every point of a contour, about a point."""
    points = [(*s.start, *(s.centre if isinstance(s, Arc) else ())) for s in contour]
    return tuple(tuple(round(v - at[i % 2], 9) + 0.0 for i, v in enumerate(p)) for p in points)


def kinds_of(part: Part) -> list[list[SheetCell]]:
    """Cells grouped by kind, that of the first cell first. Raises CheckFailure unless they form a regular
    grid in which two kinds alternate."""
    cells = cells_of(part)
    xs, ys = (sorted({round(c.at[k], 9) for c in cells}) for k in (0, 1))
    steps = [b - a for values in (xs, ys) for a, b in pairwise(values)]
    kinds: dict[frozenset, list[SheetCell]] = {}
    for cell in cells:
        kinds.setdefault(cell.shape, []).append(cell)
    order = list(kinds)
    wanted = [(x, y, (i + j) % len(order)) for (j, y), (i, x) in product(enumerate(ys), enumerate(xs))]
    there = [(round(c.at[0], 9), round(c.at[1], 9), order.index(c.shape)) for c in cells]
    if len(order) > len(LABELS) or wanted != there or (steps and max(steps) - min(steps) > ALIKE):
        raise CheckFailure(f"drawings: {part.part_no}: its cells are no regular grid of two kinds in turn")
    return list(kinds.values())


def pad_places(layout: PlanarLayout, plan: Box) -> tuple[Linear, ...]:
    """The pads' pitch both ways, in the plan whose box that is."""
    x0, y0 = plan[:2]
    at = {(e.row, e.column): (e.x - x0, e.y - y0) for e in layout.elements}
    first, pitch = at[1, 1], layout.design.planar.pitch
    sides: tuple[tuple[Side, tuple[int, int]], ...] = (("bottom", (1, 2)), ("left", (2, 1)))
    return tuple(given(side, pitch, first, at[next_]) for side, next_ in sides if next_ in at)


def cell_plan(part: Part, notes: Sequence[str], spare: bool = False) -> SheetPlan:
    """The sheet of a foil or a spacer; `spare` asks for smaller details.

    Raises CheckFailure if its cells do not repeat, or a dimension is missing or given twice.
    """
    kinds = kinds_of(part)
    cells = [cell for some in kinds for cell in some]
    last = [max(cells, key=lambda c: (-abs(c.at[1 - k] - cells[0].at[1 - k]), c.at[k])) for k in (0, 1)]
    shown = _shown(part, [some[0] for some in kinds], last)
    sketch = Sketch(shown)
    for row in conventions(OUTER, shown.extrusion.outer):
        sketch.convention(row)
    front = _front_view(sketch, part, shown, len(cells))
    views = [front, replace(side_view(sketch, shown, front), hidden=False)]
    owners = [Owner("opening", n) for n in range(len(shown.extrusion.openings))]
    for label, some in zip(LABELS, kinds):
        own, owners = owners[: len(some[0].openings)], owners[len(some[0].openings) :]
        views.append(_cell_view(sketch, shown, some[0], own, label, SPARE_ROOM if spare else ROOM))
    for owner in owners:
        _repeated(sketch, shown, owner)
    marked = with_marks(shown, views)
    closed(sketch, marked)
    counts = [len({round(c.at[k], 9) for c in cells}) - 1 for k in (0, 1)]
    pitch = [round(abs(last[k].at[k] - cells[0].at[k]) / n, 6) for k, n in enumerate(counts) if n]
    told = (*notes, _pattern_note(kinds, pitch))
    return SheetPlan(shown, sketch.values, tuple(sketch.conventions), marked, told)


def _pattern_note(kinds: Sequence[Sequence[SheetCell]], pitch: Sequence[float]) -> str:
    """A note on the cells that the details describe."""
    at = f", at a pitch of {pitch[0]:g} exactly" if pitch else ""
    if len(kinds) == 1:
        return f"All {len(kinds[0])} openings as X{at}"
    x, z = (len(some) for some in kinds)
    return (
        f"{x} cells as X, the first at lower left, and {z} as Z, alternating like a chessboard{at}; the four "
        "beams of a cell are alike, each a quarter turn on"
    )


def _shown(part: Part, first: Sequence[SheetCell], last: Sequence[SheetCell]) -> Part:
    """The part with its first cells alone, in their order; of the last ones of the first row and column the
    hole in their middle, or their opening."""
    body, spigots = part.extrusion, {cell.at for cell in (*first, *last)}
    features = tuple(f for f in part.features if f.name != SPIGOT or f.at[:2] in spigots)
    openings = [n for cell in first for n in cell.openings]
    if not any(f.name == SPIGOT for f in features):
        openings += [n for cell in last for n in cell.openings if n not in openings]
    return replace(
        part,
        body=replace(body, openings=tuple(body.openings[n] for n in dict.fromkeys(openings))),
        features=features,
    )


def _front_view(sketch: Sketch, part: Part, shown: Part, count: int) -> View:
    """The whole sheet: outline, places of holes and cells."""
    view = view_of(shown, "front", *FRONT)
    callouts = []
    called = groups(rounds(shown), sketch.values, {2: FRONT[0]}, shown)
    for group in called:
        callout = hole_callout(sketch, view, group)
        if group.holes[0].hole.name == SPIGOT:
            text = callout.lines[0].partition("× ")[2] or callout.lines[0]
            some = f"{count}× " if count > 1 else ""
            callout = replace(callout, lines=(f"{some}{text}", *callout.lines[1:]))
        callouts.append(callout)
    holes = [r for group in called for r in group.holes]
    points = [
        Coordinate(s.name, Spot(OUTER, i).place(k), (*s.start, 0.0), (*s.end, 0.0))
        for i, s in enumerate(shown.extrusion.outer)
        for k in (0, 1)
        if isinstance(s, Line) and abs(s.start[k] - s.end[k]) < ALIKE
    ]
    points += [Coordinate(f"{r.label} {'xy'[k]}", r.owner.place(k), r.at) for r in holes for k in (0, 1)]
    if not any(r.hole.name == SPIGOT for r in holes):
        points += _edges(shown)
    sides, runnings = cast(tuple[Side, Side], ("top", "right")), []
    for k, side in enumerate(sides):
        own = [c for c in points if c.variable and c.variable.quantity == "xy"[k]]
        runnings.append(running_along(sketch, view, side, k, own))
    return replace(
        view,
        hidden=False,
        runnings=tuple(r for r in runnings if len(r.stops) > 1),
        callouts=tuple(callouts),
        centres=tuple((r.at[:2], r.hole.diameter) for r in holes if r.hole.name != SPIGOT),
    )


def _edges(shown: Part) -> Iterator[Coordinate]:
    """Left and lower edge of every opening."""
    for n, contour in enumerate(shown.extrusion.openings):
        for i, s in enumerate(contour):
            for k in (0, 1):
                if isinstance(s, Line) and max(abs(p[k] - contour.box[k]) for p in (s.start, s.end)) < ALIKE:
                    spot = Spot(Owner("opening", n), i)
                    yield Coordinate("opening", spot.place(k), (*s.start, 0.0), (*s.end, 0.0))


def _repeated(sketch: Sketch, shown: Part, owner: Owner) -> None:
    """The opening is the first one, elsewhere."""
    first, contour = Owner("opening", 0), shown.extrusion.openings[owner.number or 0]
    for i, s in enumerate(contour):
        for k, centre in product((0, 1), (False, True) if isinstance(s, Arc) else (False,)):
            spans = (
                Span(level(Spot(o, 0).place(k)), level(Spot(o, i, centre).place(k))) for o in (first, owner)
            )
            if i or centre:
                sketch.convention(MeasureDifference(*spans))


def _cell_view(
    sketch: Sketch, shown: Part, cell: SheetCell, owners: Sequence[Owner], label: str, room: Point
) -> View:
    """A cell enlarged: a foil's with beams, island and ears, a spacer's opening."""
    openings = [shown.extrusion.openings[owner.number or 0] for owner in owners]
    for owner, contour in zip(owners, openings):
        for row in conventions(owner, contour):
            sketch.convention(row)
    low_x, low_y, high_x, high_y = zip(*(contour.box for contour in openings))
    x0, y0, x1, y1 = min(low_x), min(low_y), max(high_x), max(high_y)
    away = AROUND * (x1 - x0)
    window = (x0 - away, y0 - away, x1 + away, y1 + away)
    view = View(label, *FRONT, (x0, y0, x1, y1), label=label, window=window, room=room, hidden=False)
    turns, first, name = len(owners), owners[0], f"{label} radius"
    square = turns == 1
    linears = _square(sketch, first, openings[0]) if square else _beams(sketch, shown, cell, owners)
    arcs = [(name, radius_of(first, i), s) for i, s in enumerate(openings[0]) if isinstance(s, Arc)]
    callouts = []
    for callout in equal_radii(sketch, view, arcs):  # as the radius of as many equal openings
        count, _, text = callout.lines[0].rpartition("× ")
        whole = turns * int(count or 1)
        callouts.append(replace(callout, lines=(f"{whole}× {text}" if whole > 1 else text,)))
    x, y = cell.at
    axes = (((x0, y), (x1, y)), ((x, y0), (x, y1)))
    return replace(view, linears=tuple(linears), callouts=tuple(callouts), axes=() if square else axes)


def _square(sketch: Sketch, owner: Owner, contour: Contour) -> list[Linear]:
    """Length and width of an opening."""
    x0, y0, x1, y1 = contour.box
    linears = []
    for k, (side, p) in enumerate((("top", (x0, y1)), ("right", (x1, y0)))):
        ends = [_level(sketch, owner, contour, k, end) for end in (contour.box[k], contour.box[k + 2])]
        d = sketch.must(Dimension(f"opening along {'xy'[k]}", (Span(*ends),)))
        linears.append(Linear(d, side, p, (x1, y1)))  # type: ignore[arg-type]
    return linears


def _level(sketch: Sketch, owner: Owner, contour: Contour, k: int, value: float) -> Level:
    """The level of the line at a value along axis k."""
    for i, s in enumerate(contour):
        if isinstance(s, Line) and max(abs(p[k] - value) for p in (s.start, s.end)) < ALIKE:
            return level(Spot(owner, i).place(k))
    raise CheckFailure(f"drawings: {sketch.part.part_no}: there is no edge at {'xy'[k]} = {value:g}")


def _beams(sketch: Sketch, shown: Part, cell: SheetCell, owners: Sequence[Owner]) -> list[Linear]:
    """A cell's dimensions: opening, beams, island; of a pinwheel also slot and ear."""
    first = shown.extrusion.openings[owners[0].number or 0]
    spigot = next(
        Owner("hole", n) for n, f in enumerate(shown.features) if f.name == SPIGOT and f.at[:2] == cell.at
    )
    cx, cy = (level(spigot.place(k)) for k in (0, 1))
    (x, y) = cell.at
    for before, after in pairwise(owners):
        for i, s in enumerate(first):
            for centre in (False, True) if isinstance(s, Arc) else (False,):
                a, b = Spot(before, i, centre), Spot(after, i, centre)
                # (x, y) turns to (-y, x) about the middle
                sketch.convention(MeasureDifference(Span(cx, level(b.place(0))), Span(level(a.place(1)), cy)))
                sketch.convention(MeasureDifference(Span(cy, level(b.place(1))), Span(cx, level(a.place(0)))))

    def at(turn: int, edge: str, k: int) -> tuple[Level, Point]:
        """Level along axis k, and a point, of the slot's first edge of that name across the axis."""
        contour = shown.extrusion.openings[owners[turn].number or 0]
        found = [
            (level(Spot(owners[turn], i).place(k)), max(s.start, s.end, key=lambda p: dist(p, cell.at)))
            for i, s in enumerate(contour)
            if isinstance(s, Line) and s.name.endswith(f" {edge}") and abs(s.start[k] - s.end[k]) < ALIKE
        ]
        return found[0]

    def line(name: str, side: Side, k: int, a: tuple, b: tuple, auxiliary: bool = False) -> Linear:
        d = Dimension(f"{name}, {kind}", (Span(a[0], b[0]),), auxiliary=auxiliary)
        return Linear(d if auxiliary else sketch.must(d), side, a[1], b[1])

    kind = next(s.name for s in first if s.name).split()[0]
    pinwheel = any(s.name.endswith(" ear") for s in first)
    sketch.convention(MeasureDifference(Span(cx, at(0, "frame", 0)[0]), Span(cy, at(0, "frame", 1)[0])))
    opening = line("opening", "top", 0, at(2, "frame", 0), at(0, "frame", 0))
    width = line("beam width", "right", 1, at(3, "beam b", 1), at(0, "beam a", 1))
    if not pinwheel:
        # even about the beams' axes and the diagonals
        sketch.convention(MeasureDifference(Span(cx, at(0, "beam b", 0)[0]), Span(cy, at(0, "beam a", 1)[0])))
        sketch.convention(MeasureDifference(Span(cx, at(0, "root", 0)[0]), Span(cy, at(0, "root", 1)[0])))
        return [
            opening,
            width,
            line("beam length", "bottom", 0, at(3, "root", 0), at(3, "frame", 0)),
            line("island", "bottom", 0, at(2, "root", 0), at(3, "root", 0), auxiliary=True),
        ]
    # the end of an ear lies on both sides of its beam
    sketch.convention(Span(at(0, "root", 1)[0], at(1, "root", 1)[0]))
    return [
        opening,
        width,
        line("beam length", "bottom", 0, at(2, "frame", 0), at(2, "root", 0)),
        line("island", "bottom", 0, at(0, "island", 0), at(2, "island", 0)),
        line("slot", "left", 1, at(1, "beam b", 1), at(1, "island", 1)),
        line("ear over beam", "left", 1, at(0, "beam a", 1), at(0, "ear", 1)),
        line("ear", "top", 0, at(0, "island", 0), at(0, "root", 0), auxiliary=True),
    ]
