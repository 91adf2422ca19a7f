"""A page of an assembly drawing before it has frame and title block."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from tactcad.scenes.scene import Placement

from .boxes import Polyline
from .ink import Item, LineType, Stroke
from .paper import Paper

EDGE = LineType("edge", 0.35)  # visible edges of an assembly: the thinner line group of ISO 128-2
MARGIN = 5.0  # distance of anything from the frame
# a view has at most this many: repeated parts beyond are left out, since the kernel compares them pair by
# pair
MOST_DRAWN = 150


@dataclass(frozen=True)
class Page:
    """What a page has inside its frame, its scale as text, and what it is."""

    paper: Paper
    scale: str
    items: tuple[Item, ...]
    document_type: str


def edges(lines: Sequence[Polyline], f: float, shift: tuple[float, float]) -> list[Stroke]:
    """Lines of a view (mm of the assembly) on the paper, at the scale f."""
    return [Stroke(tuple((x * f + shift[0], y * f + shift[1]) for x, y in line), EDGE) for line in lines]


def fewer(placements: Sequence[Placement]) -> tuple[Placement, ...]:
    """All of them, or where they are too many the first few of every part."""
    most = len(placements)
    while True:
        count: dict[str, int] = {}
        kept = []
        for p in placements:
            count[p.part.part_no] = count.get(p.part.part_no, 0) + 1
            if count[p.part.part_no] <= most:
                kept.append(p)
        if len(kept) <= MOST_DRAWN or most == 1:
            return tuple(kept)
        most = max(1, most // 2)
