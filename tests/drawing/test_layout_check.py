"""`layout_faults` sees every kind of fault: one bad sheet each, and its good neighbour."""

from __future__ import annotations

import re

import pytest

from tactcad.drawing.engine.ink import THIN, VISIBLE, DrawnArc, DrawnSheet, Hatch, Text, arrow, segment
from tactcad.drawing.engine.layout_check import layout_faults
from tactcad.drawing.engine.paper import A4, frame


def faults(*items) -> list[str]:
    return layout_faults(DrawnSheet("n", "t", A4.size, (*frame(A4), *items)))


def square(x0: float, y0: float, x1: float, y1: float) -> tuple:
    return ((x0, y0), (x1, y0), (x1, y1), (x0, y1))


WIDE = square(40, 120, 90, 170)  # hatched 3 mm apart
TEXT = Text((60, 100), "12.5", 2.5)
LENGTH = TEXT.width

BAD = {
    "text over text": (Text((60 + LENGTH - 1, 100), "7"), "over text"),
    "text against text with no gap": (Text((60 + LENGTH - 0.2, 100), "7"), "over text"),
    "turned text over text": (Text((62, 98), "7", angle=45), "over text"),
    "dimension line through a text": (segment((50, 101), (90, 101)), r"over a line \(dimension\)"),
    "line that grazes the letters": (segment((50, 99.85), (90, 99.85)), r"over a line"),
    "slanted leader through a text": (
        segment((58, 95), (66, 108), THIN, "leader"),
        r"over a line \(leader\)",
    ),
    "circle through a text": (DrawnArc((60, 112), 11.0, line=VISIBLE), r"over a line \(outline\)"),
    "arrow head over a text": (arrow((61, 101), (70, 101)), "over a line"),
    "text outside the frame": (Text((195, 50), "12345"), "outside the frame"),
    "line outside the frame": (segment((30, 30), (10, 30)), "outside the frame"),
    "frame outside the paper": (segment((30, 30), (-1, 30), role="frame"), "outside the paper"),
    "text in hatching": (Hatch((WIDE,)), Text((60, 140), "12.5", 2.5), "over hatching"),
    "small text between two hatching lines": (Hatch((WIDE,)), Text((60, 142.9), ".", 1.8), "over hatching"),
    "dimension lines that cross": (
        (segment((30, 50), (50, 50)), segment((40, 40), (40, 60))),
        "crosses a line",
    ),
    "dimension line through the part": (
        (segment((30, 50), (50, 50)), segment((40, 40), (40, 60), VISIBLE, "outline")),
        "crosses",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_sheet_fails(name):
    *bad, said = BAD[name]
    found = faults(
        TEXT, *(item for items in bad for item in (items if isinstance(items, tuple) else (items,)))
    )
    assert [fault for fault in found if re.search(said, fault)], found


GOOD = {
    "texts a gap apart": (Text((60 + LENGTH + 1, 100), "7"),),
    "line under a text": (segment((50, 99.0), (90, 99.0)),),
    "turned text beside a text": (Text((58, 100), "7", angle=90),),
    "text inside a circle": (DrawnArc((60 + LENGTH / 2, 101.2), 7.0, line=VISIBLE),),
    "dimension line that ends at an edge": (
        segment((30, 50), (40, 50)),
        segment((40, 40), (40, 60), VISIBLE, "outline"),
    ),
    "centre line across a dimension line": (
        segment((30, 50), (50, 50)),
        segment((40, 40), (40, 60), THIN, "centre"),
    ),
    "text in a hatched face's hole": (Hatch((WIDE, square(55, 135, 75, 155))), Text((60, 143), "12.5", 2.5)),
    "text beside hatching": (Hatch((WIDE,)), Text((91, 140), "12.5", 2.5)),
    "watermark under everything": (Text((60, 100), "PRELIMINARY", 10, role="watermark"),),
}


def test_a_small_text_between_hatching_lines_touches_none_of_them():
    """So that it is the hatched area that the check goes by, not its lines."""
    found = faults(*BAD["small text between two hatching lines"][:-1])
    assert len(found) == 1 and "over hatching" in found[0]


@pytest.mark.parametrize("name", GOOD)
def test_its_good_neighbour_passes(name):
    assert faults(TEXT, *GOOD[name]) == []
