"""Long and large parts: broken views say the whole part, and larger sheets are as clean as small ones."""

from __future__ import annotations

import re

import pytest
from built import shape_of
from variants import variant

from tactcad.contour import rectangle
from tactcad.drawing.engine.ink import DrawnArc, Stroke
from tactcad.drawing.engine.layout_check import layout_faults
from tactcad.drawing.engine.paper import A0, A1, A2, A3, A4, frame
from tactcad.drawing.engine.sheet_files import pdf_bytes, pdf_runs
from tactcad.drawing.parts.part_sheet import MadeFrom, Order, drawing_faults, part_sheet
from tactcad.drawing.parts.sheet_plan import Breaks
from tactcad.parts.language.description import Extrusion, Hole, Material, Part
from tactcad.scenes import make_scene

pytestmark = pytest.mark.cad

FILE = MadeFrom("dxf/x.dxf", "0" * 64)
# Number of fields along the long and the short side: ISO 5457:1999, table 2.
FIELDS = {"A4": (4, 6), "A3": (8, 6), "A2": (12, 8), "A1": (16, 12), "A0": (24, 16)}


@pytest.fixture(scope="module")
def design():
    return variant({"array.row_arms": [[4, 7] * 250, [8, 5] * 250]})


@pytest.fixture(scope="module")
def long_parts(design):
    return {p.name: p for p in make_scene(design, "array").parts if p.name in ("Carrier", "Stop plate")}


def sheet_of(design, part):
    """Its finished sheet, and the texts that another library reads in its PDF."""
    from tactcad.solids.step import to_bytes

    sheet = part_sheet(Order(design, part, to_bytes(shape_of(part)), (FILE,)))
    pdf = pdf_bytes([sheet], "title", "author", design.design.date)
    assert layout_faults(sheet) == []
    assert drawing_faults(pdf, sheet, part, design.design.revision) == []
    return sheet, pdf_runs(pdf)[0]


@pytest.mark.parametrize("paper", [A4, A3, A2, A1, A0], ids=lambda p: p.name)
def test_fields_are_those_of_the_standard(paper):
    texts = [t.text for t in frame(paper) if hasattr(t, "text")]
    numbers = {int(t) for t in texts if t.isdigit()}
    letters = {t for t in texts if len(t) == 1 and t.isalpha()}
    assert (max(numbers), len(letters)) == FIELDS[paper.name]


@pytest.mark.slow  # a sheet of two metres
def test_a_two_metre_plate_is_shown_broken(design, long_parts):
    """Its length stands on a small sheet at a scale at which the whole would be longer than the sheet."""
    part = long_parts["Stop plate"]
    x0, y0, x1, y1 = part.body.outer.box
    sheet, runs = sheet_of(design, part)
    assert f"{y1 - y0:g}" in runs and f"{x1 - x0:g}" in runs
    up, down = (float(v) for v in next(r for r in runs if re.fullmatch(r"\d+:\d+", r)).split(":"))
    assert sheet.size in (A4.size, A3.size) and (y1 - y0) * up / down > sheet.size[1]
    assert sum("broken" in r for r in runs) == 1


def test_a_regular_row_is_said_by_its_ends_and_its_number(design, long_parts):
    part = long_parts["Carrier"]
    rows = {}
    for hole in part.features:
        if hole.name == "hold_down":
            rows.setdefault(hole.at[0], []).append(hole.at[1])
    _, runs = sheet_of(design, part)
    places = sorted(next(iter(rows.values())))
    count, space = re.fullmatch(
        r"(\d+) equal spaces \(([\d.]+)\)", next(r for r in runs if "spaces" in r)
    ).groups()
    assert int(count) + 1 == len(places)
    assert float(space) == pytest.approx((places[-1] - places[0]) / (len(places) - 1), abs=5e-4)
    edge = part.body.outer.box[1]
    for place in (places[0], places[-1]):
        assert any(abs(float(r) - (place - edge)) < 5e-4 for r in runs if re.fullmatch(r"[\d.]+", r))
    total = sum(len(row) for row in rows.values())
    assert any(r.startswith(f"{total}× M3") for r in runs)


def test_what_is_shown_of_a_broken_view_is_true_to_scale(design, long_parts):
    """Holes near an end stand as far from it, by the scale, as on the part; between the breaks nothing is
    drawn."""
    part = long_parts["Carrier"]
    sheet, runs = sheet_of(design, part)
    up, down = (float(v) for v in next(r for r in runs if re.fullmatch(r"\d+:\d+", r)).split(":"))
    x0, y0, _, y1 = part.body.outer.box
    circles = [i for i in sheet.items if isinstance(i, DrawnArc) and i.role == "outline" and i.sweep == 360.0]
    ends = [f for f in part.features if f.name == "end_plate_screw"]
    bores = [c for c in circles if c.radius == pytest.approx(ends[0].diameter / 2 * up / down, abs=1e-6)]
    assert len(bores) == len(ends) == 4
    left = min(c.centre[0] for c in bores) - (min(f.at[0] for f in ends) - x0) * up / down
    edges = [
        i.points[0][1]
        for i in sheet.items
        if isinstance(i, Stroke)
        and i.role == "outline"
        and len(i.points) == 2
        and abs(i.points[0][1] - i.points[1][1]) < 1e-9
        and min(i.points[0][0], i.points[1][0]) == pytest.approx(left, abs=1e-6)
    ]
    below, above = min(edges), max(edges)
    lowest, highest = min(f.at[1] for f in ends), max(f.at[1] for f in ends)
    assert min(c.centre[1] for c in bores) - below == pytest.approx((lowest - y0) * up / down, abs=1e-6)
    assert above - max(c.centre[1] for c in bores) == pytest.approx((y1 - highest) * up / down, abs=1e-6)


def test_what_is_left_out_shrinks_to_the_gap_and_nothing_else_does():
    breaks = Breaks(1, ((-40.0, -10.0), (5.0, 100.0)), 2.0)
    at = breaks.squeezed
    assert at(-10.0) - at(-40.0) == pytest.approx(2.0) and at(100.0) - at(5.0) == pytest.approx(2.0)
    for a, b in ((-70.0, -40.0), (-10.0, 5.0), (100.0, 130.0)):
        assert at(b) - at(a) == pytest.approx(b - a)
    assert breaks.shows(-10.0) and breaks.shows(5.0) and not breaks.shows(-10.1) and not breaks.shows(99.0)


def test_a_plate_full_of_unequal_holes_takes_a_larger_sheet(design):
    """Sixty places that nothing repeats: too many numbers for the sides of A3."""
    spots = [(22.0 * i + (i * i) % 7, 15.0 * i + (i * i * i) % 5) for i in range(1, 61)]
    holes = tuple(Hole(f"h{i}", (x, y, 8.0), (0, 0, -1), 4.0, 8.0, True) for i, (x, y) in enumerate(spots))
    part = Part(
        "PLATE",
        "Plate",
        "milled",
        Material("6061-T6", 2700),
        Extrusion(rectangle(0, 0, 1400, 960), 8.0),
        holes,
    )
    sheet, runs = sheet_of(design, part)
    assert sheet.size in (A2.size, A1.size, A0.size)
    for x, y in spots:
        assert f"{x:g}" in runs and f"{y:g}" in runs
