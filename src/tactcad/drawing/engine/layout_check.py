"""Pages made finished sheets, and the layout check: faults that a draughtsman would reject, measured on the
finished sheet.

It does not know how the sheet was composed: it sees primitives only.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tactcad.design.messages import CheckFailure

from .boxes import Chord, Point, bounds, chord_meets, crossing, quads_meet
from .ink import DrawnSheet, Fill, Hatch, Text, points_of, preliminary
from .paper import LEFT, OTHER, Page, TitleBlock, frame, title_block

# Least white between two texts, and between a text and the edge of a line, mm of paper; chosen: a thin line's
# width.
BETWEEN_TEXTS = 0.5
BESIDE_LINE = 0.25


@dataclass(frozen=True)
class _Straight:
    """A straight piece of an item: half its line's width, its purpose, and its item."""

    ends: Chord
    half: float
    role: str
    item: int


def sheets_of(block: TitleBlock, pages: Sequence[Page], draft: bool, named: str = "") -> list[DrawnSheet]:
    """The pages in frame and title block, called `named` or after their document types; a `draft` is marked.

    Raises CheckFailure if a layout is not clean.
    """
    sheets = []
    for n, page in enumerate(pages, start=1):
        own = replace(block, scale=page.scale, sheet=n, sheets=len(pages), document_type=page.document_type)
        items = (*frame(page.paper), *title_block(page.paper, own), *page.items)
        title = f"{named or page.document_type}, sheet {n} of {len(pages)}"
        sheets.append(DrawnSheet(block.number, title, page.paper.size, items))
    for sheet in sheets:
        if wrong := layout_faults(sheet):
            name = block.number if named else sheet.title
            raise CheckFailure(f"drawings: {name}: {'; '.join(wrong[:3])}; no drawing was written")
    return [preliminary(sheet) for sheet in sheets] if draft else sheets


def layout_faults(sheet: DrawnSheet) -> list[str]:
    """Faults: texts over texts, lines or hatching; items outside the frame; dimension lines across others."""
    texts = [t for t in sheet.texts if t.role != "watermark" and t.text.strip()]
    drawn = [
        _Straight(chord, 0.0 if isinstance(item, Fill) else item.line.width / 2, item.role, n)
        for n, item in enumerate(sheet.items)
        if not isinstance(item, Text)
        for chord in item.chords()
    ]
    quads = [t.corners(BETWEEN_TEXTS / 2) for t in texts]
    ends = np.array(quads).reshape(-1, 4, 2)
    low, high = ends.min(1), ends.max(1)
    near = np.triu((low[:, None] <= high).all(2) & (low <= high[:, None]).all(2), 1)
    over = [
        f"text {texts[a].text!r} over text {texts[b].text!r} at {_shown(texts[a].at)}"
        for a, b in np.argwhere(near).tolist()
        if quads_meet(quads[a], quads[b])
    ]
    # inside a hatched area, even between two lines; across its edge a text is over a line anyway
    hatches = [item for item in sheet.items if isinstance(item, Hatch)]
    hatched = [
        f"text {text.text!r} at {_shown(text.at)} over hatching"
        for text in texts
        if any(hatch.holds(corner) for hatch in hatches for corner in text.corners())
    ]
    return [*over, *_text_on_line(texts, drawn), *hatched, *_outside(sheet), *_dimension_lines(drawn)]


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


def _outside(sheet: DrawnSheet) -> Iterator[str]:
    """Everything but the frame itself lies inside it; the frame inside the paper."""
    w, h = sheet.size
    for item in sheet.items:
        whole = item.role in ("frame", "watermark")
        inside = (0.0, 0.0, w, h) if whole else (LEFT, OTHER, w - OTHER, h - OTHER)
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
