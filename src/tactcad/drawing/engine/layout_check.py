"""The layout check: faults that a draughtsman would reject, measured on the finished sheet.

It does not know how the sheet was composed: it sees primitives only.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from .boxes import Chord, Point, bounds, chord_meets, crossing, quads_meet
from .ink import DrawnArc, DrawnSheet, Fill, Hatch, Item, Stroke, Text, points_of
from .paper import LEFT, OTHER

# Least white between two texts, and between a text and the edge of a line, mm of paper; chosen: a thin line's
# width.
BETWEEN_TEXTS = 0.5
BESIDE_LINE = 0.25


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


def _shown(p: Point) -> str:
    return f"({p[0]:.1f}, {p[1]:.1f})"
