"""What a section view has beside its curves: label, axes and threads of the holes that it cuts (ISO 128-3,
ISO 6410-1), and its cutting plane in the view that it is taken from."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot

from .board import AROUND, FORBIDDEN, Board
from .boxes import Box, Chord, Point
from .dimension_lines import ABOVE
from .ink import CENTRE, CUTTING, THIN, VISIBLE, Hatch, Item, Stroke, Text, arrow, segment
from .sheet_plan import Bore, SectionPlane

LETTER = 3.5  # height of the letters: a size above that of the dimensions (ISO 128-3)
PAST = 2.0  # of an axis beyond its hole
OFF = 1.5  # from the outline to a cutting plane's thick ends
HEAD = 3.5  # length of the arrows' heads
OUT = (6.5, 6.0, 7.0, 8.0, 9.5, 11.0, 13.0, 17.0)  # from the outline to the arrows
TAILS = (6.0, 7.5, 9.0, 11.0, 13.0, 16.0, 20.0)  # lengths of the arrows


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
    -1), a letter at each; False where an end finds no place."""
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
    """One end of the plane's line with an arrow at its outer point, and what it costs; None where it is not
    free."""
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
