"""The layout check: faults that a draughtsman would reject, measured on the finished sheet.

It does not know how the sheet was composed: it sees primitives only.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import hypot

import numpy as np

from .boxes import Chord, Point, bounds
from .ink import DrawnArc, DrawnSheet, Fill, Hatch, Item, Stroke, Text, points_of
from .paper import LEFT, OTHER

# Least white between two texts, and between a text and the edge of a line, mm of paper; chosen: a thin line's
# width.
BETWEEN_TEXTS = 0.5
BESIDE_LINE = 0.25
# Lines that meet nearer to their ends than this are meant to touch there (mm of paper).
END = 0.3

Quad = tuple[Point, Point, Point, Point]


@dataclass(frozen=True)
class _Straight:
    """A straight piece of an item: half its line's width, what it is for, and which item it belongs to."""

    ends: Chord
    half: float
    role: str
    item: int


def layout_faults(sheet: DrawnSheet) -> list[str]:
    """Every fault, a line each: texts over texts, lines or hatching, anything outside the frame, dimension
    lines across others."""
    texts = [t for t in sheet.texts if t.role != "watermark" and t.text.strip()]
    drawn = list(_pieces(sheet.items))
    return [
        *_text_on_text(texts),
        *_text_on_line(texts, drawn),
        *_text_on_hatching(texts, sheet.items),
        *_outside(sheet),
        *_dimension_lines(drawn),
    ]


def _pieces(items: Sequence[Item]) -> Iterator[_Straight]:
    for n, item in enumerate(items):
        if isinstance(item, Stroke | DrawnArc | Fill | Hatch):
            half = 0.0 if isinstance(item, Fill) else item.line.width / 2
            for chord in item.chords():
                yield _Straight(chord, half, item.role, n)


def _text_on_text(texts: Sequence[Text]) -> Iterator[str]:
    boxes = [(t, t.corners(BETWEEN_TEXTS / 2)) for t in texts]
    for (a, quad_a), (b, quad_b) in combinations(boxes, 2):
        if quads_meet(quad_a, quad_b):
            yield f"text {a.text!r} over text {b.text!r} at {_shown(a.at)}"


def _text_on_line(texts: Sequence[Text], drawn: Sequence[_Straight]) -> Iterator[str]:
    """A text over a line, or nearer to its ink than BESIDE_LINE."""
    ends = np.array([piece.ends for piece in drawn]).reshape(-1, 2, 2)
    half = np.array([[piece.half] for piece in drawn]).reshape(-1, 1)
    low, high = ends.min(1) - half, ends.max(1) + half
    for text in texts:
        x0, y0, x1, y1 = bounds(text.corners(BESIDE_LINE))
        near = [drawn[i] for i in np.flatnonzero(((high >= (x0, y0)) & (low <= (x1, y1))).all(1)).tolist()]
        hit = {
            piece.role
            for piece in near
            if piece.role != "watermark" and chord_meets(piece.ends, text.corners(BESIDE_LINE + piece.half))
        }
        if hit:
            yield f"text {text.text!r} at {_shown(text.at)} over a line ({', '.join(sorted(hit))})"


def _text_on_hatching(texts: Sequence[Text], items: Sequence[Item]) -> Iterator[str]:
    """A text inside a hatched area, even one between two lines; across its edge it is over a line anyway."""
    for text in texts:
        if any(item.holds(corner) for item in items if isinstance(item, Hatch) for corner in text.corners()):
            yield f"text {text.text!r} at {_shown(text.at)} over hatching"


def _outside(sheet: DrawnSheet) -> Iterator[str]:
    """Everything but the frame itself lies inside it; the frame inside the paper."""
    w, h = sheet.size
    for item in sheet.items:
        inside = (
            (0.0, 0.0, w, h) if item.role in ("frame", "watermark") else (LEFT, OTHER, w - OTHER, h - OTHER)
        )
        x0, y0, x1, y1 = bounds(points_of(item))
        if x0 < inside[0] or y0 < inside[1] or x1 > inside[2] or y1 > inside[3]:
            what = f"text {item.text!r}" if isinstance(item, Text) else f"a line ({item.role})"
            beyond = "paper" if item.role == "frame" else "frame"
            yield f"{what} at {_shown((x0, y0))} lies outside the {beyond}"


def _dimension_lines(drawn: Sequence[_Straight]) -> Iterator[str]:
    """Dimension lines cross neither each other nor the part's visible edges (ISO 129-1, 5.3 and 5.4)."""
    lines = [p for p in drawn if p.role == "dimension" and p.half]
    others = [p for p in drawn if p.role in ("outline", "dimension") and p.half]
    for line in lines:
        for other in others:
            if other.item != line.item and crossing(line.ends, other.ends):
                ends = [_shown(p.ends[0]) for p in (line, other)]
                yield f"dimension line at {ends[0]} crosses a line ({other.role}) at {ends[1]}"
                break


def crossing(a: Chord, b: Chord, end: float = END) -> bool:
    """Whether two straight pieces cross away from their ends."""
    (px, py), (qx, qy) = a
    (rx, ry), (sx, sy) = b
    ux, uy, vx, vy = qx - px, qy - py, sx - rx, sy - ry
    det = ux * vy - uy * vx
    la, lb = hypot(ux, uy), hypot(vx, vy)
    if la == 0 or lb == 0 or abs(det) < 1e-9 * la * lb:
        return False
    t = ((rx - px) * vy - (ry - py) * vx) / det * la
    s = ((rx - px) * uy - (ry - py) * ux) / det * lb
    return end < t < la - end and -1e-9 <= s <= lb + 1e-9


def quads_meet(a: Quad, b: Quad) -> bool:
    """Whether two convex quadrangles share a point: no line parallel to a side separates them."""
    ax0, ay0, ax1, ay1 = bounds(a)
    bx0, by0, bx1, by1 = bounds(b)
    if ax1 < bx0 or bx1 < ax0 or ay1 < by0 or by1 < ay0:
        return False
    return not any(_separates(side, a, b) for side in _normals(a) + _normals(b))


def chord_meets(chord: Chord, quad: Quad) -> bool:
    """Whether a straight piece shares a point with a convex quadrangle."""
    (ax, ay), (bx, by) = chord
    across = (ay - by, bx - ax)
    return not any(_separates(side, chord, quad) for side in [*_normals(quad), across])


def _normals(quad: Quad) -> list[Point]:
    return [(b[1] - a[1], a[0] - b[0]) for a, b in zip(quad[:2], quad[1:3])]


def _separates(normal: Point, a: Sequence[Point], b: Sequence[Point]) -> bool:
    on_a = [p[0] * normal[0] + p[1] * normal[1] for p in a]
    on_b = [p[0] * normal[0] + p[1] * normal[1] for p in b]
    return max(on_a) < min(on_b) or max(on_b) < min(on_a)


def _shown(p: Point) -> str:
    return f"({p[0]:.1f}, {p[1]:.1f})"
