"""From a plan to a finished sheet: on the first of the preferred papers and scales on which all fits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from tactcad.design.messages import CheckFailure

from ..engine.boxes import Box, Point, bounds, bounds_of, corners, grown, overlap, scaled, shifted
from ..engine.ink import (
    CENTRE,
    THIN,
    Curve,
    DrawnArc,
    DrawnSheet,
    Hatch,
    Item,
    Stroke,
    Text,
    bounds_of_items,
    moved,
    rectangle,
    width,
)
from ..engine.layout_check import layout_faults
from ..engine.paper import (
    A3,
    A4,
    HEIGHT,
    SERIES,
    WIDTH,
    Paper,
    Scale,
    TitleBlock,
    factor,
    frame,
    notes,
    shown,
    title_block,
)
from .board import Board
from .broken import windowed
from .dimension_lines import FIRST, across, centre_lines, running, stacked
from .measures import Values
from .sections import bore_lines, letters, mark_plane
from .sheet_plan import OUTWARDS, Callout, SheetPlan, View, seen

MARGIN = 4.0  # distance of anything from the frame
APART = 12.0  # between views, their dimensions included
NARROWEST = 100.0  # column of notes next to the title block
LABEL = 3.5  # height of views' letters
PLANE = 3.0  # more between a view and its dimensions at the end of a cutting plane
DATUM = 3.0  # and at a datum's symbol between them
LARGEST = 200.0  # mm of paper, on A4 and A3: a view is not enlarged beyond
# Shares of the room for details, tried one after another.
SHRUNK = (1.0, 0.6, 0.35)


class NoPlace(CheckFailure):
    """Raised for a plan that fits at no scale."""


@dataclass(frozen=True)
class _Drawn:
    """A view's items at its scale; its (0, 0) is the paper's (0, 0)."""

    view: View
    scale: Scale
    items: tuple[Item, ...]

    @property
    def box(self) -> Box:
        return bounds_of_items(self.items)


def compose(
    plan: SheetPlan,
    curves: Mapping[str, Sequence[Curve]],
    block: TitleBlock,
    papers: Sequence[Paper],
    scales: Sequence[Scale] = SERIES,
) -> DrawnSheet:
    """The sheet of a plan at the largest preferred scale, and on the first paper, with a clean layout.

    `curves` are each view's by its name, mm of the part; the title block's scale is filled in; papers and
    scales are tried one after another. Raises NoPlace if no scale fits, or none gives a clean layout.
    """
    x0, y0, x1, y1 = plan.views[0].box
    wide, high = x1 - x0, y1 - y0
    said: list[str] = []
    for scale in scales:
        details = SHRUNK if any(v.window for v in plan.views) else SHRUNK[:1]
        for paper, beside, shrunk in ((p, b, s) for p in papers for s in details for b in (True, False)):
            if max(wide, high) * factor(scale) > (LARGEST if paper in (A4, A3) else paper.width):
                said.append(f"the views at {shown(scale)} do not fit {paper.name}")
                continue
            if beside and paper.area[2] - paper.area[0] - WIDTH < NARROWEST:
                continue
            try:
                return _attempt(plan, curves, block, paper, scale, beside, shrunk)
            except NoPlace as fault:
                said.append(f"{paper.name} {shown(scale)}: {fault}")
    nearest = [line for line in said if "do not fit" not in line] or said[-1:]
    raise NoPlace(
        f"drawings: {plan.part.part_no} ({wide:g} x {high:g} mm) finds no place on "
        f"{', '.join(p.name for p in papers)} at "
        f"{shown(SERIES[0])} to {shown(SERIES[-1])}: {'; '.join(nearest[:6])}; no drawing was written"
    )


def _attempt(
    plan: SheetPlan,
    curves: Mapping[str, Sequence[Curve]],
    block: TitleBlock,
    paper: Paper,
    scale: Scale,
    beside: bool,
    shrunk: float,
) -> DrawnSheet:
    """The sheet on one paper at one scale. Raises NoPlace with its first fault."""
    board = Board(paper.area)
    board.add(frame(paper))
    board.add(title_block(paper, replace(block, scale=shown(scale))))
    x0, y0, x1, y1 = paper.area
    board.kept.append((x1 - WIDTH, y0, x1, y0 + HEIGHT))
    # notes are left of the title block, or above it
    room = (x1 - x0 - WIDTH if beside else WIDTH) - 2 * MARGIN
    left = x0 if beside else x1 - WIDTH
    items, height = notes((0, 0), plan.notes, room)
    top = y0 + height + MARGIN + (0.0 if beside else HEIGHT)
    board.add(moved(item, left + MARGIN, top) for item in items)
    board.kept.append((left, y0, left + room + 2 * MARGIN, top + MARGIN))
    spread = {"top" if v.section.axis == 0 else "right": PLANE for v in plan.views if v.section}
    drawn = []
    for n, v in enumerate(plan.views):
        # running dimensions are further off if a datum's symbol has to fit between them and its edge
        edges = {d.away for d in v.datums}
        off = {} if n else dict(spread)
        off |= {r.side: off.get(r.side, 0.0) + DATUM for r in v.runnings if OUTWARDS[r.side] in edges}
        own = _detail_scale(v, v.window, shrunk) if v.window else scale
        drawn.append(_drawn(v, curves[v.name], own, plan.values, off))
    places = _arranged([d for d in drawn if not d.view.window], board, len(drawn))
    if places is None:
        raise NoPlace(f"the views at {shown(scale)} do not fit {paper.name}")
    for d in drawn:
        if d.view.window:
            spot = _free_spot(board, grown(d.box, APART / 2))
            if spot is None:
                raise NoPlace(f"detail {d.view.label} finds no place")
            places[d.view.name] = spot
            board.kept.append(shifted(_view_box(d), spot))
            board.taken.append(shifted(d.box, spot))
    for d in drawn:
        board.add(moved(item, *places[d.view.name]) for item in d.items)
    front = places[plan.views[0].name]
    for d in drawn:
        window = shifted(scaled(d.view.window, factor(scale)), front) if d.view.window else None
        if window and not _mark_window(board, window, d.view.label):
            raise NoPlace(f"the letter {d.view.label} finds no place")
        if section := d.view.section:
            v, k = drawn[0].view, section.axis
            on = seen(v, (section.at, 0.0, 0.0) if k == 0 else (0.0, section.at, 0.0))
            at = on[k] * factor(scale) + front[k]
            sight = -sum(a * b for a, b in zip(d.view.eye, (v.right, v.up)[k]))
            if not mark_plane(board, section, at, sight, shifted(scaled(v.box, factor(scale)), front)):
                raise NoPlace(f"the cutting plane {letters(section)} finds no place")
    lettered: dict[str, bool] = {}
    edged = [(edge, factor(d.scale), places[d.view.name]) for d in drawn for edge in d.view.datums]
    for edge, f, place in edged:
        # a letter offered by several views is on the first with room
        if not lettered.get(edge.letter):
            lettered[edge.letter] = board.datum(edge, f, place)
    for edge, f, place in edged:
        if not lettered[edge.letter]:  # at the end of a leader
            spots = tuple((edge.at(share), 0.0) for share in (0.5, 0.25, 0.75))
            lettered[edge.letter] = board.callout(Callout((), spots, datum=edge.letter), f, place)
    if not all(lettered.values()):
        raise NoPlace(f"datum {', '.join(n for n, placed in lettered.items() if not placed)} finds no place")
    for d in drawn:
        for callout in d.view.callouts:
            if not board.callout(callout, factor(d.scale), places[d.view.name]):
                cells = [
                    *callout.lines[:1],
                    *(cell for f in callout.frames for cell in f.cells),
                    callout.datum,
                ]
                raise NoPlace(f"callout {' '.join(cells).strip()!r} finds no place")
    sheet = DrawnSheet(plan.part.part_no, plan.part.name, paper.size, tuple(board.items))
    if faults := layout_faults(sheet):
        raise NoPlace(faults[0])
    return sheet


def _drawn(
    view: View, curves: Sequence[Curve], scale: Scale, values: Values, spread: Mapping[str, float]
) -> _Drawn:
    """The view at its scale; dimensions on a side are `spread` mm further off."""
    f = factor(scale)
    if view.window:
        curves = windowed([c for c in curves if not isinstance(c, Hatch)], view.window)
    items = [moved(c, 0.0, 0.0, f) for c in curves if view.hidden or c.role != "hidden"]
    paper_box = scaled(view.window or view.box, f)
    starts = {}
    for r in view.runnings:
        off = spread.get(r.side, 0.0)
        items += running(r, paper_box, f, values, FIRST - 2.0 + off)
        starts[r.side] = FIRST + 22.0 + off
    for side in OUTWARDS:
        start = starts.get(side, FIRST + spread.get(side, 0.0))
        items += stacked(view.linears, side, paper_box, f, values, start)
    for dimension in view.across:
        items += across(dimension, f, values)
    for centre, diameter in view.centres:
        items += centre_lines(centre, diameter, f)
    for centre, diameter in view.threads:
        # three quarters of a thin circle at the nominal diameter (ISO 6410-1)
        items.append(moved(DrawnArc(centre, diameter / 2, 100.0, 370.0, THIN), 0.0, 0.0, f))
    items += [moved(Stroke(axis, CENTRE, "centre"), 0.0, 0.0, f) for axis in view.axes]
    if view.section:
        face = next(item for item in items if isinstance(item, Hatch))
        items += [line for bore in view.section.bores for line in bore_lines(bore, f, face)]
    label = letters(view.section) if view.section else f"{view.label} ({shown(scale)})" if view.label else ""
    if label:
        x0, _, x1, y1 = bounds_of_items(items)
        items.append(Text(((x0 + x1) / 2, y1 + 4.0), label, LABEL, "middle"))
    return _Drawn(view, scale, tuple(items))


def _detail_scale(view: View, window: Box, shrunk: float) -> Scale:
    x0, y0, x1, y1 = window
    wide, high = (shrunk * room for room in view.room)
    for scale in SERIES:
        f = factor(scale)
        if (x1 - x0) * f <= wide and (y1 - y0) * f <= high or f <= view.least:
            return scale
    return SERIES[-1]


def _arranged(drawn: Sequence[_Drawn], board: Board, views: int) -> dict[str, Point] | None:
    """First-angle places: the first view, with others to its `right`, `below` and `above`; or None."""
    boxes = {d.view.name: d.box for d in drawn}
    front = drawn[0].view.name
    shifts: dict[str, Point] = {front: (0.0, 0.0)}
    f = boxes[front]
    if "right" in boxes:
        shifts["right"] = (f[2] + APART - boxes["right"][0], 0.0)
    if "below" in boxes:
        shifts["below"] = (0.0, f[1] - APART - boxes["below"][3])
    if "above" in boxes:
        shifts["above"] = (0.0, f[3] + APART - boxes["above"][1])
    whole = bounds_of(corners(shifted(boxes[name], s)) for name, s in shifts.items())
    spot = None
    if len(drawn) == views:  # in the middle above the title block, with room for callouts around
        x0, _, x1, y1 = board.area
        y0 = max(top for *_, top in board.kept)
        middle = ((x0 + x1 - whole[0] - whole[2]) / 2, (y0 + y1 - whole[1] - whole[3]) / 2)
        around = grown(shifted(whole, middle), APART)
        if around[0] >= x0 and around[1] >= y0 and around[2] <= x1 and around[3] <= y1:
            spot = middle
    spot = spot or _free_spot(board, grown(whole, APART))
    if spot is None:
        return None
    places = {name: (s[0] + spot[0], s[1] + spot[1]) for name, s in shifts.items()}
    board.taken.append(shifted(whole, spot))
    for name, place in places.items():
        board.kept.append(shifted(_view_box(next(d for d in drawn if d.view.name == name)), place))
    return places


def _view_box(d: _Drawn) -> Box:
    """The part's own outline in a view, kept free of callouts."""
    return grown(scaled(d.view.window or d.view.box, factor(d.scale)), 1.0)


def _free_spot(board: Board, wanted: Box) -> Point | None:
    """Shift that brings a box to the first free place, from the upper left corner, in steps of 4 mm."""
    ax0, ay0, ax1, ay1 = board.area
    w, h = wanted[2] - wanted[0], wanted[3] - wanted[1]
    y = ay1
    while y - h >= ay0:
        x = ax0
        while x + w <= ax1:
            spot = (x, y - h, x + w, y)
            if not any(overlap(spot, kept) for kept in board.kept + board.taken):
                return (x - wanted[0], y - h - wanted[1])
            x += 4.0
        y -= 4.0
    return None


def _mark_window(board: Board, window: Box, label: str) -> bool:
    """A thin frame around a detail's area (mm of paper), and its letter."""
    x0, y0, x1, y1 = window
    board.add([rectangle(x0, y0, x1 - x0, y1 - y0, THIN, "symbol")])
    w = width(label, LABEL)
    for gap in (1.5, 3.0, 5.0, 8.0, 12.0):
        for share in (0.0, 0.1, 0.25, 0.4, 0.5, 0.6, 0.75, 0.9, 1.0):
            for at in (
                (x0 + share * (x1 - x0) - w / 2, y1 + gap),
                (x0 + share * (x1 - x0) - w / 2, y0 - gap - LABEL),
                (x0 - gap - w, y0 + share * (y1 - y0) - LABEL / 2),
                (x1 + gap, y0 + share * (y1 - y0) - LABEL / 2),
            ):
                letter = Text(at, label, LABEL)
                quad = letter.corners(0.6)
                if not board.hit([quad], bounds(quad)):
                    board.add([letter])
                    return True
    return False
