"""Sections: whether and where a part has one, decided by its features, not by its name; and a section's
symbols besides its curves (ISO 128-3, ISO 6410-1).

A section is cut if a depth would otherwise be in hidden lines only: a pocket, a groove, a blind hole, a
counterbore. Its plane is upright on the front view's paper, through axes of such features: x = constant, seen
from the left, so that it is to the right of the front view (first angle); or, if no such plane is possible, y
= constant, seen from the side with free space above or below the front view.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import hypot, isclose

from tactcad.contour import Arc
from tactcad.parts.language.description import Feature, Hole, Part, Pocket, Vector, drill_point_height, vector

from ..engine.boxes import Box, Chord, Point
from ..engine.ink import CENTRE, CUTTING, THIN, VISIBLE, Hatch, Item, Stroke, Text, arrow, segment
from .board import AROUND, FORBIDDEN, Board
from .dimension_lines import ABOVE
from .measures import Round, axis_of, contours, in_part, widest
from .sheet_plan import Bore, SectionPlane, View, opposite, seen
from .sketch import view_of

SECTION = "S"  # neither a datum's (A, B, C) nor a detail's (X, Z)
ON_AXIS = 1e-6  # mm: a plane nearer to an axis than this goes through it
LETTER = 3.5  # height of the letters: a size above that of the dimensions (ISO 128-3)
PAST = 2.0  # of an axis beyond its hole
OFF = 1.5  # from the outline to a cutting plane's thick ends
HEAD = 3.5  # length of the arrows' heads
OUT = (6.5, 6.0, 7.0, 8.0, 9.5, 11.0, 13.0, 17.0)  # from the outline to the arrows
TAILS = (6.0, 7.5, 9.0, 11.0, 13.0, 16.0, 20.0)  # lengths of the arrows


def section_of(part: Part, holes: Sequence[Round], front: View, below: Vector | None) -> SectionPlane | None:
    """The plane that shows most kinds of sunk features, then the deepest, then most of them, then nearest to
    the middle.

    None if no feature is sunk, or every plane through an axis would cut another hole off its axis or run
    along a wall. `below` is the eye of a view onto a y face, which occupies that place on the sheet.
    """
    # Whether a feature ends or changes inside the part.
    sunk = [f for f in part.features if (isinstance(f, Pocket) or not f.through or bool(f.counterbore))]
    for k in (0, 1):
        at = _best(part, sunk, holes, k, (front.right, front.up)[k][k])
        if at is None:
            continue
        bare = View("", *_sight(front, below, k), (0, 0, 0, 0))
        bores = [_bore(bare, r.hole) for r in holes if not r.hole.axis[k] and abs(r.at[k] - at) < ON_AXIS]
        return SectionPlane(SECTION, k, at, tuple(bores))
    return None


def section_view(part: Part, front: View, below: Vector | None, section: SectionPlane) -> View:
    """The bare view of a section, where first-angle projection puts it."""
    eye, up = _sight(front, below, section.axis)
    name = "right" if section.axis == 0 else "below" if eye == front.up else "above"
    return replace(view_of(part, name, eye, up), hidden=False, section=section)


def _sight(front: View, below: Vector | None, k: int) -> tuple[Vector, Vector]:
    """Eye and up of a section across axis k."""
    if k == 0:
        return opposite(front.right), front.up
    if below is None or below != front.up:
        return front.up, opposite(front.eye)
    return opposite(front.up), front.eye


def _best(part: Part, sunk: Sequence[Feature], holes: Sequence[Round], k: int, way: float) -> float | None:
    box = part.extrusion.outer.box
    low, high = box[k], box[k + 2]
    walls = []
    for s in (s for _, contour in contours(part) for s in contour):
        if isinstance(s, Arc):
            walls += [s.centre[k] - s.radius, s.centre[k] + s.radius]
        elif abs(s.start[k] - s.end[k]) < ON_AXIS:
            walls.append(s.start[k])
    middles = {f: middle for f in sunk if (middle := _middle(f, k)) is not None}
    planes = sorted({round(v, 9) for v in middles.values() if low + ON_AXIS < v < high - ON_AXIS})

    def worth(v: float) -> tuple[int, float, int, float, float]:
        shown = [f for f, middle in middles.items() if abs(middle - v) < ON_AXIS]
        off_middle = round(abs(v - (low + high) / 2), 6)
        return (len(set(map(_kind, shown))), max(map(_depth, shown)), len(shown), -off_middle, -way * v)

    # no plane that would show a hole too narrow
    across = [(r.at[k], max(widest(r.hole), r.hole.thread_diameter) / 2) for r in holes if not r.hole.axis[k]]
    clean = [
        v
        for v in planes
        if not any(ON_AXIS < abs(at - v) < radius + ON_AXIS for at, radius in across)
        and not any(abs(wall - v) < ON_AXIS for wall in walls)
    ]
    return max(clean, key=worth, default=None)


def _middle(f: Feature, k: int) -> float | None:
    """Coordinate k of a hole's axis or of a pocket's middle; None for a hole along k."""
    if isinstance(f, Hole):
        return None if f.axis[k] else f.at[k]
    box = in_part(f, f.contour).box
    return (box[k] + box[k + 2]) / 2


def _kind(f: Feature) -> tuple:
    if isinstance(f, Pocket):
        return (f.name,)
    return (axis_of(f), f.diameter, f.depth, f.counterbore, f.thread, f.thread_depth)


def _depth(f: Feature) -> float:
    """Depth of the floor that hidden lines would show, mm."""
    return f.counterbore[1] if isinstance(f, Hole) and f.through and f.counterbore else f.depth


def _bore(view: View, h: Hole) -> Bore:
    """A hole's axis and thread as the section shows them."""
    counterbore = h.counterbore[1] if h.counterbore else 0.0
    cone = drill_point_height(h.diameter) if h.drill_point else 0.0

    def at(depth: float) -> Point:
        return seen(view, vector(p + depth * a for p, a in zip(h.at, h.axis)))

    full = min(counterbore + h.thread_depth, h.depth) if h.thread else 0.0
    ends_inside = not (h.through and isclose(full, h.depth))
    return Bore(at(0.0), at(h.depth + cone), h.thread_diameter, (at(counterbore), at(full)), ends_inside)


def letters(section: SectionPlane) -> str:
    return f"{section.letter}-{section.letter}"


def bore_lines(bore: Bore, f: float, face: Hatch) -> list[Item]:
    """Axis of a hole in a section at the scale f, and its thread: thin lines at the nominal diameter where
    there is material, hatched up to the drilled hole, and a thick line at the end of full thread (ISO
    6410-1)."""
    (ax, ay), (bx, by) = ((x * f, y * f) for x, y in (bore.face, bore.end))
    length = hypot(bx - ax, by - ay)
    ux, uy = (bx - ax) / length, (by - ay) / length
    items: list[Item] = [
        segment((ax - PAST * ux, ay - PAST * uy), (bx + PAST * ux, by + PAST * uy), CENTRE, "centre")
    ]
    if not bore.thread:
        return items
    r = bore.thread / 2 * f
    (sx, sy), (ex, ey) = ((x * f, y * f) for x, y in bore.threaded)
    for side in (r, -r):
        for a, b in inside(face, (sx - side * uy, sy + side * ux), (ex - side * uy, ey + side * ux)):
            items.append(segment(a, b, THIN, "outline"))
    if bore.ends_inside:
        items.append(segment((ex - r * uy, ey + r * ux), (ex + r * uy, ey - r * ux), VISIBLE, "outline"))
    return items


def inside(face: Hatch, a: Point, b: Point) -> list[Chord]:
    """The parts of a straight line that lie in a face."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    shares = {0.0, 1.0}
    for (px, py), (qx, qy) in face.outlines():
        det = dx * (qy - py) - dy * (qx - px)
        if abs(det) < 1e-12:
            continue
        t = ((px - a[0]) * (qy - py) - (py - a[1]) * (qx - px)) / det
        s = ((px - a[0]) * dy - (py - a[1]) * dx) / det
        if 0 < t < 1 and -1e-9 <= s <= 1 + 1e-9:
            shares.add(t)
    stops = sorted(shares)
    kept = [
        (low, high)
        for low, high in zip(stops, stops[1:])
        if high - low > 1e-9 and face.holds((a[0] + (low + high) / 2 * dx, a[1] + (low + high) / 2 * dy))
    ]
    return [((a[0] + low * dx, a[1] + low * dy), (a[0] + high * dx, a[1] + high * dy)) for low, high in kept]


def mark_plane(board: Board, section: SectionPlane, at: float, sight: float, view: Box) -> bool:
    """The cutting plane in the view that it is taken from (its box on the paper), at a coordinate of the
    section's axis: a chain line with thick ends, arrows along that axis in the direction of `sight` (1 or
    -1), a letter at each; False if an end finds no place."""
    k = section.axis

    def point(across: float, along: float) -> Point:
        return (across, along) if k == 0 else (along, across)

    low, high = view[1 - k], view[3 - k]
    for edge, out in ((high, 1.0), (low, -1.0)):
        inner = point(at, edge + out * OFF)
        places = [
            _end(board, section.letter, (inner, point(at, edge + out * away)), point(sight, 0.0), tail)
            for away in OUT
            for tail in TAILS
        ]
        free = [place for place in places if place]
        if not free:
            return False
        board.add(min(free, key=lambda place: place[0])[1])
    board.add([segment(point(at, low - OFF), point(at, high + OFF), CENTRE, "centre")])
    return True


def _end(
    board: Board, letter: str, thick: Chord, sight: Point, tail: float
) -> tuple[float, Sequence[Item]] | None:
    """One end of the plane's line, an arrow at its outer point, and what it costs; None if it is not free."""
    (x, y), (ux, uy) = thick[1], sight
    start, tip = (x - tail * ux, y - tail * uy), (x - CUTTING.width / 2 * ux, y - CUTTING.width / 2 * uy)
    beyond = ABOVE + (LETTER / 2 if uy else 0.0)
    at = (start[0] - beyond * ux, start[1] - beyond * uy - LETTER / 2)
    text = Text(at, letter, LETTER, "middle" if uy else "end" if ux > 0 else "start")
    tried = [board.passed(chord) for chord in (thick, (start, tip))]
    costs = [cost for cost in tried if cost is not None and cost < FORBIDDEN]
    if not board.free([text.corners(AROUND)]) or len(costs) < len(tried):
        return None
    line = Stroke(thick, CUTTING, "cutting")
    items: list[Item] = [line, segment(start, tip, THIN, "cutting"), arrow(tip, start, HEAD, "cutting"), text]
    return tail + hypot(thick[1][0] - thick[0][0], thick[1][1] - thick[0][1]) + sum(costs), items
