"""Datums and geometric tolerances: their places (below the callout of their hole, or on the edge or face of
their name), and their frames (ISO 1101:2017) and symbols (ISO 5459:2011) on paper.

The symbols of characteristics are drawn as strokes (proportions of ISO 7083): no font need have them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import atan2, degrees, dist, hypot

from tactcad.contour import Line
from tactcad.parts.language.description import Part
from tactcad.parts.language.limits import FACES, Geometric, Symbol

from ..engine.boxes import Chord, Point, clipped, corners, grown
from ..engine.ink import LETTERS, THIN, DrawnArc, Fill, Item, Stroke, Text, rectangle, segment, width
from .measures import OUTER, Spot, Variable, rounds
from .sheet_plan import Callout, Datum, Frame, View, seen

# Possible ends of a frame's leader along an edge; near the edge's ends, so that broken views also show them.
SHARES = (0.5, 0.25, 0.75, 0.1, 0.9, 0.05, 0.95)
LONG, LONG_SHARES = 600.0, (0.01, 0.99)  # mm: so long an edge is broken off, and this is no corner yet
ASIDE = 60.0  # degrees from the normal that its leader may lie
FRAME = 2 * LETTERS  # height of a frame, and least width of its cells
PAD = 1.0  # on either side of a cell's text
STEM = 8.0  # from a datum's feature to the middle of its letter: shortest


def frames_of(part: Part, names: Sequence[str]) -> tuple[Frame, ...]:
    """Frames of the geometric tolerances for one of these features."""
    return tuple(frame_of(part, g) for g in part.geometric if set(g.features) & {*names})


def frame_of(part: Part, g: Geometric) -> Frame:
    return Frame(g, len(_holes(part, g)))


def times(part: Part, g: Geometric) -> int:
    """Number of a tolerance's frames on the sheet: one for all its holes, one at each edge and face."""
    holes = _holes(part, g)
    return bool(holes) + len({*g.features} - {*holes})


def _holes(part: Part, g: Geometric) -> list[str]:
    return [r.hole.name for r in rounds(part) if r.hole.name in g.features]


def letter_of(part: Part, names: Sequence[str]) -> str:
    """Letter of the datum on one of these features; "" if none."""
    return next((d.letter for d in part.datums if d.feature in names), "")


def with_marks(part: Part, views: Sequence[View]) -> tuple[View, ...]:
    """The views with the datums that each can show, and frames of edges and faces where first seen."""
    marked = []
    framed: set[str] = set()
    for view in views:
        datums = tuple(
            Datum(d.letter, *line, away) for d in part.datums for line, away in _lines(part, view, d.feature)
        )
        callouts = []
        # a view that shows all of the part's edge, not a detail
        names = [n for g in part.geometric for n in g.features if n not in framed and view.window is None]
        for name in dict.fromkeys(names):
            for (start, end), away in _lines(part, view, name):
                framed.add(name)
                shares = (*SHARES, *LONG_SHARES) if dist(start, end) > LONG else SHARES
                spots = tuple((Datum("", start, end, away).at(share), 0.0) for share in shares)
                out = degrees(atan2(away[1], away[0]))
                spans = ((out - ASIDE, out + ASIDE),) * len(spots)
                callouts.append(Callout((), spots, spans=spans, frames=frames_of(part, (name,))))
        # an edge's frame has less choice than the callout of equal holes: it is placed first
        marked.append(replace(view, datums=datums, callouts=(*callouts, *view.callouts)))
    return tuple(marked)


def _lines(part: Part, view: View, feature: str) -> Iterator[tuple[Chord, Point]]:
    """A view's lines for a straight edge, or for a face seen edge-on; and the outward direction."""
    if feature in FACES and not view.eye[2]:
        # if the face lies along the view's own axes
        k = 0 if view.right[2] else 1
        z = part.extrusion.thickness if feature == FACES[1] else 0.0
        way = (view.right, view.up)[k][2]
        (u0, v0, u1, v1), at = view.box, z * way
        out = way if z else -way
        yield (((at, v0), (at, v1)), (out, 0.0)) if k == 0 else (((u0, at), (u1, at)), (0.0, out))
    if not view.eye[2]:
        return
    turn = 1.0 if part.extrusion.outer.signed_area > 0 else -1.0
    for s in part.extrusion.outer:
        if s.name == feature and isinstance(s, Line):
            dx, dy = s.end[0] - s.start[0], s.end[1] - s.start[1]
            size = turn * hypot(dx, dy)
            line = (seen(view, (*s.start, 0.0)), seen(view, (*s.end, 0.0)))
            shown = clipped(line, view.window) if view.window else line
            if shown:
                yield shown, seen(view, (dy / size, -dx / size, 0.0))


def places(part: Part, features: Sequence[str]) -> Iterator[tuple[int, Variable]]:
    """Coordinates (axis, variable) of features: of holes across their axis, of level edges."""
    for r in rounds(part):
        if r.hole.name in features:
            yield from ((k, r.owner.place(k)) for k in range(3) if not r.axis[k])
    for i, s in enumerate(part.extrusion.outer if features else ()):
        if s.name in features and isinstance(s, Line):
            yield from ((k, Spot(OUTER, i).place(k)) for k in (0, 1) if abs(s.start[k] - s.end[k]) < 1e-9)


def frame_width(frame: Frame) -> float:
    """mm of paper."""
    return FRAME + sum(map(_cell_width, frame.cells))


def tolerance_frame(frame: Frame, corner: Point) -> list[Item]:
    """Symbol, zone and datum letters in their cells, from the upper left corner."""
    x, y = corner[0], corner[1] - FRAME
    items = [_box(x, y, FRAME), *_symbol(frame.geometric.symbol, x + FRAME / 2, y + FRAME / 2)]
    x += FRAME
    for text in frame.cells:
        w = _cell_width(text)
        items += [_box(x, y, w), Text((x + w / 2, y + LETTERS / 2), text, LETTERS, "middle", role="symbol")]
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
        Text((middle[0], middle[1] - LETTERS / 2), letter, LETTERS, "middle", role="symbol"),
    ]


def block(frames: Sequence[Frame], letter: str, corner: Point, wide: float) -> list[Item]:
    """Frames from the upper left corner down, a datum's symbol below them, or below a line `wide` mm long."""
    items: list[Item] = []
    x, y = corner
    for frame in frames:
        items += tolerance_frame(frame, (x, y))
        y -= FRAME
    if not frames:
        items.append(segment((x, y), (x + wide, y), THIN, "symbol"))
    return [*items, *(datum((x + FRAME / 2, y), (0.0, -1.0), STEM, letter) if letter else ())]


def _cell_width(text: str) -> float:
    return max(FRAME, width(text, LETTERS) + 2 * PAD)


def _box(x: float, y: float, w: float) -> Item:
    return rectangle(x, y, w, FRAME, THIN, "symbol")


def _symbol(symbol: Symbol, x: float, y: float) -> list[Item]:
    """The symbol of a characteristic about its middle."""
    ways = {
        "position": (((x - 1.8, y), (x + 1.8, y)), ((x, y - 1.8), (x, y + 1.8))),
        "flatness": (((x - 1.9, y - 0.9), (x + 0.9, y - 0.9), (x + 1.9, y + 0.9), (x - 0.9, y + 0.9)),),
        "parallelism": tuple(((x + u - 0.7, y - 1.3), (x + u + 0.7, y + 1.3)) for u in (-0.65, 0.65)),
        "perpendicularity": (((x - 1.6, y - 1.4), (x + 1.6, y - 1.4)), ((x, y - 1.4), (x, y + 1.6))),
    }
    circle = [DrawnArc((x, y), 1.1, line=THIN, role="symbol")] if symbol == "position" else []
    return [*circle, *(Stroke(points, THIN, "symbol", len(points) > 2) for points in ways[symbol])]
