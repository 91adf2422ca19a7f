"""Where a part's datums and geometric tolerances stand: below the callout of their hole, or on the edge or
face of their name, with nothing beside them but what the part states.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import atan2, degrees, hypot

from tactcad.contour import Line
from tactcad.parts.description import Part
from tactcad.parts.limits import FACES, Geometric

from .boxes import Chord, Point
from .holes import rounds
from .keys import OUTER, Spot, Variable
from .sheet_plan import Callout, Datum, Frame, View, seen
from .window import clipped

# Where along an edge a frame's leader may end; so near to its ends broken views show it, too.
SHARES = (0.5, 0.25, 0.75, 0.1, 0.9, 0.008, 0.992)

ASIDE = 60.0  # degrees from the normal that its leader may lie


def frames_of(part: Part, names: Sequence[str]) -> tuple[Frame, ...]:
    """Of the geometric tolerances that hold for one of these features."""
    return tuple(frame_of(part, g) for g in part.geometric if set(g.features) & {*names})


def frame_of(part: Part, g: Geometric) -> Frame:
    return Frame(g, len(_holes(part, g)))


def times(part: Part, g: Geometric) -> int:
    """How often the frame of a geometric tolerance stands on the sheet: once for all its holes, and once at
    each of its edges and faces."""
    holes = _holes(part, g)
    return bool(holes) + len({*g.features} - {*holes})


def _holes(part: Part, g: Geometric) -> list[str]:
    return [r.hole.name for r in rounds(part) if r.hole.name in g.features]


def letter_of(part: Part, names: Sequence[str]) -> str:
    """Of the datum that stands on one of these features; none: ""."""
    return next((d.letter for d in part.datums if d.feature in names), "")


def with_marks(part: Part, views: Sequence[View]) -> tuple[View, ...]:
    """The views with the datums that each can show on an edge or face, and with the frames of edges and faces
    where these are seen first."""
    marked = []
    framed: set[str] = set()
    for view in views:
        datums = tuple(
            Datum(d.letter, *line, away) for d in part.datums for line, away in _lines(part, view, d.feature)
        )
        callouts = []
        # a view that shows all of the part's edge, not a detail of it
        names = [n for g in part.geometric for n in g.features if n not in framed and view.window is None]
        for name in dict.fromkeys(names):
            for (start, end), away in _lines(part, view, name):
                framed.add(name)
                spots = tuple((Datum("", start, end, away).at(share), 0.0) for share in SHARES)
                out = degrees(atan2(away[1], away[0]))
                spans = ((out - ASIDE, out + ASIDE),) * len(spots)
                callouts.append(Callout((), spots, spans=spans, frames=frames_of(part, (name,))))
        # an edge's frame has less choice than the callout of equal holes: it is placed first
        marked.append(replace(view, datums=datums, callouts=(*callouts, *view.callouts)))
    return tuple(marked)


def _lines(part: Part, view: View, feature: str) -> Iterator[tuple[Chord, Point]]:
    """The lines as which a view shows a straight edge of the outline, or a face, seen along it; with the
    direction out of the material."""
    if feature in FACES and not view.eye[2]:
        # where the face lies along the view's own axes
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
    """Coordinates (axis, variable) that features stand at: of holes across their axis, of level edges."""
    for r in rounds(part):
        if r.hole.name in features:
            yield from ((k, r.owner.place(k)) for k in range(3) if not r.axis[k])
    for i, s in enumerate(part.extrusion.outer):
        if s.name in features and isinstance(s, Line):
            yield from ((k, Spot(OUTER, i).place(k)) for k in (0, 1) if abs(s.start[k] - s.end[k]) < 1e-9)
