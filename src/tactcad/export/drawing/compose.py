"""From a plan to a finished sheet: paper and scale are the first of the preferred ones at which everything fits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from tactcad.design.messages import CheckFailure

from .board import Board
from .dimension_lines import FIRST, across, centre_lines, running, stacked
from .fonts import width
from .ink import CENTRE, THIN, Arc, Item, Point, Sheet, Stroke, Text, box, moved
from .layout import bounds, layout_faults
from .paper import Paper, frame
from .plan import Box, Callout, Plan, View
from .scale import SERIES, factor, shown
from .title import HEIGHT, WIDTH, TitleBlock, notes, title_block

Curve = Stroke | Arc
MARGIN = 4.0  # from the frame to anything
APART = 12.0  # between views, their dimensions included
NARROWEST = 100.0  # column of notes beside the title block
LABEL = 3.5  # height of views' letters
LARGEST = 200.0  # mm of paper: a view is not enlarged beyond


# Shares of the room that details may take, tried in turn.
SHRUNK = (1.0, 0.6, 0.35)


class NoPlace(CheckFailure):
    """A plan that finds no place at any scale."""


@dataclass(frozen=True)
class _Drawn:
    """A view's items at its scale, its (0, 0) at the paper's (0, 0)."""

    view: View
    scale: tuple[int, int]
    items: tuple[Item, ...]

    @property
    def box(self) -> Box:
        return bounds([p for item in self.items for p in _points(item)])


def compose(
    plan: Plan, curves: Mapping[str, Sequence[Curve]], block: TitleBlock, papers: Sequence[Paper]
) -> Sheet:
    """The sheet at the largest preferred scale, and on the first paper, at which its layout is clean.

    Raises NoPlace where no scale down to 1:10 fits, or none leaves a clean layout.
    """
    width_, height_ = _main_size(plan)
    said: list[str] = []
    for scale in SERIES:
        if max(width_, height_) * factor(scale) > LARGEST:
            continue
        details = SHRUNK if any(v.window for v in plan.views) else SHRUNK[:1]
        for paper, beside, shrunk in ((p, b, s) for p in papers for s in details for b in (True, False)):
            if beside and paper.area[2] - paper.area[0] - WIDTH < NARROWEST:
                continue
            sheet, faults = _attempt(plan, curves, block, paper, scale, beside, shrunk)
            if sheet and not faults:
                return sheet
            said.append(f"{paper.name} {shown(scale)}: {faults[0]}")
    nearest = [line for line in said if "do not fit" not in line] or said[-1:]
    raise NoPlace(
        f"drawings: {plan.part.part_no} ({width_:g} x {height_:g} mm) finds no place on {', '.join(p.name for p in papers)} at "
        f"{shown(SERIES[0])} to {shown(SERIES[-1])}: {'; '.join(nearest[:6])}; no drawing was written"
    )


def _main_size(plan: Plan) -> tuple[float, float]:
    x0, y0, x1, y1 = plan.views[0].box
    return (x1 - x0, y1 - y0)


def _attempt(
    plan: Plan, curves: Mapping[str, Sequence[Curve]], block: TitleBlock, paper: Paper, scale: tuple[int, int],
    beside: bool, shrunk: float,
) -> tuple[Sheet | None, list[str]]:
    board = Board(paper.area)
    board.add(frame(paper))
    board.add(title_block(paper, replace(block, scale=shown(scale))))
    x0, y0, x1, y1 = paper.area
    board.keep_out((x1 - WIDTH, y0, x1, y0 + HEIGHT))
    _place_notes(board, plan.notes, paper, beside)
    drawn = [_drawn(v, curves[v.name], scale if not v.window else _detail_scale(v, shrunk), plan.values) for v in plan.views]
    places = _arranged([d for d in drawn if not d.view.window], board, len(drawn))
    if places is None:
        return None, [f"the views at {shown(scale)} do not fit {paper.name}"]
    for d in drawn:
        if d.view.window:
            spot = _free_spot(board, _with_margin(d.box, APART / 2))
            if spot is None:
                return None, [f"detail {d.view.label} finds no place"]
            places[d.view.name] = spot
            board.keep_out(_shifted(_view_box(d), spot))
            board.taken.append(_shifted(d.box, spot))
    for d in drawn:
        board.add(moved(item, *places[d.view.name]) for item in d.items)
    for d in drawn:
        if d.view.window and not _mark_window(board, d.view, factor(scale), places[plan.views[0].name]):
            return None, [f"the letter {d.view.label} finds no place"]
    lettered = {}
    for d in drawn:
        for edge in d.view.datums:
            # a letter that several views offer stands on the first of them that has room
            if not lettered.get(edge.letter):
                lettered[edge.letter] = board.datum(edge, factor(d.scale), places[d.view.name])
    for d in drawn:
        for edge in d.view.datums:
            if not lettered[edge.letter]:  # by words at the end of a leader
                spots = [((edge.start[0] + s * (edge.end[0] - edge.start[0]), edge.start[1] + s * (edge.end[1] - edge.start[1])), 0.0)
                         for s in (0.5, 0.25, 0.75)]
                said = Callout((f"datum {edge.letter}",), tuple(spots))
                lettered[edge.letter] = board.callout(said, factor(d.scale), places[d.view.name])
    if not all(lettered.values()):
        return None, [f"datum {', '.join(n for n, placed in lettered.items() if not placed)} finds no place"]
    for d in drawn:
        for callout in d.view.callouts:
            if not board.callout(callout, factor(d.scale), places[d.view.name]):
                return None, [f"callout {callout.lines[0]!r} finds no place"]
    keys = tuple(d.text(plan.values) for d in plan.dimensions if d.key)
    sheet = Sheet(plan.part.part_no, plan.part.name, paper.size, tuple(board.items), keys)
    return sheet, layout_faults(sheet)


def _place_notes(board: Board, lines: Sequence[str], paper: Paper, beside: bool) -> None:
    """Left of the title block, or above it."""
    x0, y0, x1, _ = paper.area
    room = (x1 - x0 - WIDTH if beside else WIDTH) - 2 * MARGIN
    left = x0 if beside else x1 - WIDTH
    items, height = notes((0, 0), lines, room)
    top = y0 + height + MARGIN + (0.0 if beside else HEIGHT)
    board.add(moved(item, left + MARGIN, top) for item in items)
    board.keep_out((left, y0, left + room + 2 * MARGIN, top + MARGIN))


def _drawn(view: View, curves: Sequence[Curve], scale: tuple[int, int], values: dict[str, float]) -> _Drawn:
    f = factor(scale)
    if view.window:
        curves = windowed(curves, view.window)
    items: list[Item] = [_scaled(c, f) for c in curves if view.hidden or c.role != "hidden"]
    paper_box = tuple(v * f for v in (view.window or view.box))
    starts = {}
    for r in view.runnings:
        some = running(r, paper_box, f, values)
        items += some
        starts[r.side] = FIRST + 22.0
    for side in ("top", "bottom", "left", "right"):
        items += stacked(view.linears, side, paper_box, f, values, starts.get(side, FIRST))
    for a in view.across:
        items += across(a, f, values)
    for centre, diameter in view.centres:
        items += centre_lines(centre, diameter, f)
    for centre, diameter in view.threads:
        # three quarters of a thin circle at the nominal diameter (ISO 6410-1)
        items.append(Arc((centre[0] * f, centre[1] * f), diameter / 2 * f, 100.0, 370.0, THIN, "outline"))
    for a, b in view.axes:
        items.append(Stroke(((a[0] * f, a[1] * f), (b[0] * f, b[1] * f)), CENTRE, "centre"))
    if view.label:
        x0, _, x1, y1 = bounds([p for item in items for p in _points(item)])
        items.append(Text(((x0 + x1) / 2, y1 + 4.0), f"{view.label} ({shown(scale)})", LABEL, "middle"))
    return _Drawn(view, scale, tuple(items))


def _detail_scale(view: View, shrunk: float) -> tuple[int, int]:
    x0, y0, x1, y1 = view.window
    for scale in SERIES:
        f = factor(scale)
        if (x1 - x0) * f <= shrunk * view.room[0] and (y1 - y0) * f <= shrunk * view.room[1] or f <= view.least:
            return scale
    return SERIES[-1]


def _arranged(drawn: Sequence[_Drawn], board: Board, views: int) -> dict[str, Point] | None:
    """First-angle places: the first view, `right` beside it, `below` and `above` it; None where they do not fit."""
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
    whole = bounds([p for name, s in shifts.items() for p in _corner_points(_shifted(boxes[name], s))])
    spot = _middle_spot(board, whole) if len(drawn) == views else None
    spot = spot or _free_spot(board, _with_margin(whole, APART))
    if spot is None:
        return None
    places = {name: (s[0] + spot[0], s[1] + spot[1]) for name, s in shifts.items()}
    board.taken.append(_shifted(whole, spot))
    for name, place in places.items():
        board.keep_out(_shifted(_view_box(next(d for d in drawn if d.view.name == name)), place))
    return places


def _middle_spot(board: Board, wanted: Box) -> Point | None:
    """Shift to the middle of the area above the title block, with room for callouts around; None where it does not fit."""
    x0, y0, x1, y1 = board.area
    y0 = max([y0, *(kept[3] for kept in board.kept)])
    spot = ((x0 + x1 - wanted[0] - wanted[2]) / 2, (y0 + y1 - wanted[1] - wanted[3]) / 2)
    there = _with_margin(_shifted(wanted, spot), APART)
    return spot if there[0] >= x0 and there[1] >= y0 and there[2] <= x1 and there[3] <= y1 else None


def _view_box(d: _Drawn) -> Box:
    """The part's own outline in a view, on which no callout may stand."""
    f = factor(d.scale)
    return _with_margin(tuple(v * f for v in (d.view.window or d.view.box)), 1.0)


def _free_spot(board: Board, wanted: Box) -> Point | None:
    """Shift that brings a box to the first free place, from the upper left corner, in steps of 4 mm."""
    ax0, ay0, ax1, ay1 = board.area
    w, h = wanted[2] - wanted[0], wanted[3] - wanted[1]
    y = ay1
    while y - h >= ay0:
        x = ax0
        while x + w <= ax1:
            spot = (x, y - h, x + w, y)
            if not any(_overlap(spot, kept) for kept in board.kept + board.taken):
                return (x - wanted[0], y - h - wanted[1])
            x += 4.0
        y -= 4.0
    return None


def _mark_window(board: Board, view: View, f: float, origin: Point) -> bool:
    """A thin frame around what a detail shows, and its letter beside it."""
    x0, y0, x1, y1 = (v * f for v in view.window)
    x0, x1, y0, y1 = x0 + origin[0], x1 + origin[0], y0 + origin[1], y1 + origin[1]
    board.add([box(x0, y0, x1 - x0, y1 - y0, THIN, "symbol")])
    w = width(view.label, LABEL)
    for gap in (1.5, 3.0, 5.0, 8.0, 12.0):
        for share in (0.0, 0.1, 0.25, 0.4, 0.5, 0.6, 0.75, 0.9, 1.0):
            for at in (
                (x0 + share * (x1 - x0) - w / 2, y1 + gap), (x0 + share * (x1 - x0) - w / 2, y0 - gap - LABEL),
                (x0 - gap - w, y0 + share * (y1 - y0) - LABEL / 2), (x1 + gap, y0 + share * (y1 - y0) - LABEL / 2),
            ):  # fmt: skip
                letter = Text(at, view.label, LABEL)
                quad = letter.corners(0.6)
                if not board.hit([quad], bounds(quad)):
                    board.add([letter])
                    return True
    return False


def windowed(curves: Sequence[Curve], window: Box) -> list[Curve]:
    """What of the curves lies in the window, and thin lines where it cuts through the material."""
    kept: list[Curve] = []
    ends: list[Point] = []
    for curve in curves:
        if isinstance(curve, Arc) and all(_inside(p, window) for chord in curve.chords() for p in chord):
            kept.append(curve)
            continue
        chords = _fine(curve) if isinstance(curve, Arc) else curve.chords()
        for chord in chords:
            cut = _clipped(chord, window)
            if cut:
                kept.append(Stroke(cut, curve.line, curve.role))
                ends += [p for p in cut if curve.role == "outline" and _on_edge(p, window)]
    return kept + _breaks(ends, window)


def _fine(arc: Arc) -> list[tuple[Point, Point]]:
    points = [arc.at(arc.start + arc.sweep * i / 64) for i in range(65)]
    return list(zip(points, points[1:]))


def _breaks(ends: Sequence[Point], window: Box) -> list[Curve]:
    """Break lines between pairs of cut edges on each side of the window, with a zigzag in the middle."""
    x0, y0, x1, y1 = window
    lines: list[Curve] = []
    for fixed, k in ((x0, 0), (x1, 0), (y0, 1), (y1, 1)):
        along = sorted({round(p[1 - k], 6) for p in ends if abs(p[k] - fixed) < 1e-9})
        for low, high in zip(along[::2], along[1::2]):
            m, z = (low + high) / 2, min((high - low) / 8, (x1 - x0) / 40)
            track = [(0, low), (0, m - z), (z, m - z / 2), (-z, m + z / 2), (0, m + z), (0, high)]
            points = tuple((fixed + u, v) if k == 0 else (v, fixed + u) for u, v in track)
            lines.append(Stroke(points, THIN, "leader"))
    return lines


def _clipped(chord: tuple[Point, Point], window: Box) -> tuple[Point, Point] | None:
    """Liang and Barsky's clipping of a straight piece."""
    (ax, ay), (bx, by) = chord
    dx, dy = bx - ax, by - ay
    t0, t1 = 0.0, 1.0
    for d, low, high in ((dx, window[0] - ax, window[2] - ax), (dy, window[1] - ay, window[3] - ay)):
        if abs(d) < 1e-12:
            if low > 0 or high < 0:
                return None
            continue
        enter, leave = sorted((low / d, high / d))
        t0, t1 = max(t0, enter), min(t1, leave)
    if t1 - t0 < 1e-9:
        return None
    return ((ax + t0 * dx, ay + t0 * dy), (ax + t1 * dx, ay + t1 * dy))


def _scaled(curve: Curve, f: float) -> Curve:
    if isinstance(curve, Arc):
        return replace(curve, centre=(curve.centre[0] * f, curve.centre[1] * f), radius=curve.radius * f)
    return replace(curve, points=tuple((x * f, y * f) for x, y in curve.points))


def _inside(p: Point, window: Box) -> bool:
    return window[0] <= p[0] <= window[2] and window[1] <= p[1] <= window[3]


def _on_edge(p: Point, window: Box) -> bool:
    return min(abs(p[0] - window[0]), abs(p[0] - window[2]), abs(p[1] - window[1]), abs(p[1] - window[3])) < 1e-9


def _points(item: Item) -> list[Point]:
    return list(item.corners()) if isinstance(item, Text) else [p for chord in item.chords() for p in chord]


def _corner_points(b: Box) -> list[Point]:
    return [(b[0], b[1]), (b[2], b[3])]


def _shifted(b: Box, by: Point) -> Box:
    return (b[0] + by[0], b[1] + by[1], b[2] + by[0], b[3] + by[1])


def _with_margin(b: Box, m: float) -> Box:
    return (b[0] - m, b[1] - m, b[2] + m, b[3] + m)


def _overlap(a: Box, b: Box) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]
