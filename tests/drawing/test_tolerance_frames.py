"""Geometric tolerances, datums and basic dimensions: each once, where the part has it, as ISO 1101 and 5459
draw it; a sheet that lacks one is refused (`gate.geometric_faults`)."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import replace
from itertools import pairwise
from math import atan2, degrees, dist

import pytest
from built import shape_of
from variants import variant

from tactcad.contour import Corner, rectangle, rounded_polygon
from tactcad.design.messages import CheckFailure
from tactcad.drawing.engine.ink import DrawnArc, Fill, Stroke, Text
from tactcad.drawing.engine.layout_check import layout_faults
from tactcad.drawing.engine.sheet_files import pdf_bytes, pdf_runs
from tactcad.drawing.parts.part_sheet import MadeFrom, Order, drawing_faults, part_plan, part_sheet
from tactcad.drawing.parts.prism import prism_plan
from tactcad.families.facing_rows import FAMILY
from tactcad.parts.language.description import Extrusion, Hole, Material, Part
from tactcad.parts.language.limits import DatumFeature, Geometric, general
from tactcad.scenes import make_scene

DXF = MadeFrom("dxf/some_B.dxf", "f" * 64)
# By the tolerance's name: zone cell and datums as ISO 1101 and ISO 5458 write them, of the part's own width.
FRAMES = {
    "end-plate-tapped": {
        "dowel holes": ("⌀{} CZ", "A", "B", "C"),
        "dowel holes of the pair": ("⌀{} CZ", "A", "B"),
        "dowel holes over the lower edge": ("⌀{} CZ", "A", "D"),
        "screw holes": ("⌀{} CZ", "A", "B", "C"),
        "carrier threads": ("⌀{} CZ", "A", "B", "C"),
        "dowel holes' squareness": ("⌀{}", "A"),
        "flatness": ("{}",),
    },
    "stop-plate": {"flatness": ("{}",), "parallelism": ("{}", "A")},
    "carrier": {
        "end plate screw holes": ("⌀{} CZ", "A", "B", "C"),
        "mount holes": ("⌀{} CZ", "A", "B", "C"),
        "hold down holes": ("⌀{} CZ", "A", "B", "C"),
    },
    "spacer": {"screw holes": ("⌀{} CZ", "A")},
    "element-a8mm": {"screw holes": ("⌀{} CZ", "B", "A"), "pad's and ledge's lean": ("{}", "A")},
}


def drawn(design, part):
    from tactcad.solids.step import to_bytes

    return part_sheet(Order(design, part, to_bytes(shape_of(part)), (DXF,)))


@pytest.fixture(scope="module")
def parts(macro_scene):
    return {p.part_no.removeprefix("macro-array-"): p for p in macro_scene.parts}


@pytest.fixture(scope="module")
def sheets(macro, parts):
    """Those that state geometric tolerances or datums, and the spacer, which has none."""
    names = (*FRAMES, "end-plate-head", "element-a8mm", "spacer")
    return {name: drawn(macro, parts[name]) for name in names}


def faults(sheet, part) -> list[str]:
    pdf = pdf_bytes([sheet], "title", "author", "2026-11-21")
    return drawing_faults(pdf, sheet, part, "E")


def boxes(sheet) -> list[tuple]:
    """Least and largest corner of every closed rectangle of symbols."""
    found = []
    for item in sheet.items:
        if isinstance(item, Stroke) and item.role == "symbol" and item.closed and len(item.points) == 4:
            xs, ys = zip(*item.points)
            if all(x in (min(xs), max(xs)) and y in (min(ys), max(ys)) for x, y in item.points):
                found.append((min(xs), min(ys), max(xs), max(ys)))
    return found


def around(box, sheet, kind=Text) -> list:
    x0, y0, x1, y1 = box
    inside = lambda p: x0 <= p[0] <= x1 and y0 <= p[1] <= y1  # noqa: E731
    points = {
        Text: lambda i: i.corners(),
        Stroke: lambda i: i.points,
        DrawnArc: lambda i: [i.at(a) for a in (0, 90, 180, 270)],
    }
    return [i for i in sheet.items if isinstance(i, kind) and all(map(inside, points[kind](i)))]


def frames_on(sheet) -> dict[tuple, list[str]]:
    """Cells in a row, read from the lines alone: their texts, and the symbol in the first."""
    cells = [b for b in boxes(sheet) if abs(b[3] - b[1] - 5.0) < 1e-6]
    follows = {a: b for a in cells for b in cells if dist(a[2:], (b[0], b[3])) < 1e-6}
    read: dict[tuple, list[str]] = {}
    for first in cells:
        if first in follows.values() or first not in follows:
            continue
        texts, cell = [], first
        while cell in follows:
            cell = follows[cell]
            texts += [t.text for t in around(cell, sheet)]
        read.setdefault(tuple(texts), []).append(symbol_in(first, sheet))
    return read


def symbol_in(cell, sheet) -> str:
    """Which of ISO 1101's symbols a cell's strokes are."""
    strokes = [s for s in around(cell, sheet, Stroke) if dist(s.points[0], s.points[1]) < 4.5]
    turns = sorted(
        round(degrees(atan2(q[1] - p[1], q[0] - p[0])) % 180) for p, q in (s.points[:2] for s in strokes)
    )
    if [s.closed for s in strokes] == [True]:
        (a, b, c, d) = strokes[0].points
        assert (b[0] - a[0], b[1] - a[1]) == pytest.approx((c[0] - d[0], c[1] - d[1])) and a[0] != d[0]
        return "flatness"
    if around(cell, sheet, DrawnArc):
        assert turns == [0, 90]
        return "position"
    if turns == [0, 90]:
        return "perpendicularity"
    assert turns[0] == turns[1] and 45 < turns[0] < 80
    return "parallelism"


@pytest.mark.cad
def test_every_geometric_tolerance_stands_once_in_its_frame(sheets, parts):
    for name, cells in FRAMES.items():
        assert set(cells) == {g.name for g in parts[name].geometric}
        expected: dict[tuple, list[str]] = {}
        for g in parts[name].geometric:
            zone, *letters = cells[g.name]
            row = expected.setdefault((zone.format(f"{g.zone:g}"), *letters), [])
            row += [g.symbol] * (len(g.features) if g.symbol in ("flatness", "parallelism") else 1)
        assert frames_on(sheets[name]) == expected, name


@pytest.mark.cad
def test_frames_of_hole_patterns_stand_below_their_callout(sheets):
    """Left-aligned with its lines, the frames below the last of them and joined to each other."""
    sheet = sheets["end-plate-tapped"]
    last = next(t for t in sheet.texts if t.text == "N7, the pin pressed in")
    tops = sorted((b[3] for b in boxes(sheet) if abs(b[0] - last.at[0]) < 1e-6), reverse=True)
    assert len(tops) == 4
    assert 0 < last.at[1] - tops[0] < 2.5 and [a - b for a, b in pairwise(tops)] == pytest.approx([5.0] * 3)


def datums_on(sheet) -> dict[str, tuple]:
    """Letters in a square of their own that a stem joins to a triangle: the middle of the triangle's base."""
    found = {}
    for fill in sheet.items:
        if isinstance(fill, Fill) and fill.role == "symbol":
            (ax, ay), (bx, by), tip = fill.points
            stem = next(
                s
                for s in sheet.items
                if isinstance(s, Stroke) and s.role == "symbol" and s.points[0] == tip and not s.closed
            )
            (letter,) = (
                t.text
                for b in boxes(sheet)
                if min(dist(stem.points[1], p) for p in sides(b)) < 1e-6
                for t in around(b, sheet)
            )
            assert letter not in found
            found[letter] = ((ax + bx) / 2, (ay + by) / 2)
    return found


def sides(b) -> list[tuple]:
    x, y = (b[0] + b[2]) / 2, (b[1] + b[3]) / 2
    return [(x, b[1]), (x, b[3]), (b[0], y), (b[2], y)]


@pytest.mark.cad
def test_datum_letters_stand_on_what_the_part_names(sheets, parts):
    """On an edge or face the triangle's base is on a line of the outline; of a hole, below its callout."""
    for name, sheet in sheets.items():
        part = parts[name]
        found = datums_on(sheet)
        assert sorted(found) == sorted(d.letter for d in part.datums), name
        lines = [i for i in sheet.items if isinstance(i, Stroke) and i.role == "outline"]
        chords = [c for line in lines for c in line.chords()]
        for d in part.datums:
            if d.feature == "dowel_hole":
                size = "⌀3.1" if name == "spacer" else "⌀3.012"
                said = next(t for t in sheet.texts if t.text.startswith(size))
                assert 0 < said.at[1] - found[d.letter][1] < 3 and found[d.letter][0] > said.at[0]
                continue
            x, y = found[d.letter]
            assert any(dist(a, (x, y)) + dist((x, y), b) - dist(a, b) < 1e-6 for a, b in chords), (name, d)
    plate = sheets["end-plate-tapped"]
    top = max(p[1] for i in plate.items if isinstance(i, Stroke) and i.role == "outline" for p in i.points)
    assert datums_on(plate)["B"][1] == pytest.approx(top)  # its upper edge, seen from the outer face


@pytest.mark.cad
def test_basic_dimensions_are_framed_and_count_from_the_datums(sheets, parts):
    """Of an end plate: places of all holes from the upper edge, the left edge and the inner face, and nothing
    else."""
    for name in ("end-plate-tapped", "end-plate-head"):
        part, sheet = parts[name], sheets[name]
        x0, _, _, y1 = part.extrusion.outer.box
        holes = [f for f in part.features if isinstance(f, Hole)]
        along_x = {round(h.at[0] - x0, 3) for h in holes}
        down = {round(y1 - h.at[1], 3) for h in holes if h.axis[2]}
        deep = {round(part.extrusion.thickness - h.at[2], 3) for h in holes if h.axis[1]}
        expected = Counter(f"{v:g}" for some in (along_x, down, deep) for v in some)
        cells = {c for row in frames_on(sheet) for c in row}
        framed = Counter(
            t.text for b in boxes(sheet) for t in around(b, sheet) if t.text not in cells and len(t.text) > 0
        )
        framed -= Counter(d.letter for d in part.datums)
        assert framed == expected, name
        assert {"0", "60", "17.5"} <= {t.text for t in sheet.texts}


@pytest.mark.cad
@pytest.mark.parametrize(
    ("text", "instead", "fault"),
    [
        ("⌀0.01 CZ", "", "tolerance frame ⌀0.01 CZ A B appears 0 times, not 1"),
        ("⌀0.01 CZ", "⌀0.1 CZ", "tolerance frame ⌀0.01 CZ A B appears 0 times, not 1"),
        ("B", "A", "datum B appears 0 times in frames, not 5"),
        ("C", "", "datum C appears 0 times in frames, not 4"),
    ],
)
def test_a_sheet_that_lacks_or_changes_a_frame_is_refused(sheets, parts, text, instead, fault):
    sheet, part = sheets["end-plate-tapped"], parts["end-plate-tapped"]
    assert faults(sheet, part) == []
    items = [
        replace(i, text=instead) if isinstance(i, Text) and i.role == "symbol" and i.text == text else i
        for i in sheet.items
    ]
    assert fault in faults(replace(sheet, items=tuple(items)), part)


@pytest.mark.cad
def test_a_sheet_with_a_limit_too_many_is_refused(sheets, parts):
    """The part as it was before it stated a tolerance, or a datum: its sheet says what it does not."""
    sheet, part = sheets["end-plate-tapped"], parts["end-plate-tapped"]
    fewer = replace(part, geometric=part.geometric[1:])
    assert any("datum A appears" in said for said in faults(sheet, fewer))
    bare = replace(parts["stop-plate"], geometric=(), datums=())
    assert any("datum A appears 2 times" in said for said in faults(sheets["stop-plate"], bare))
    more = replace(sheet, items=(*sheet.items, Text((30, 30), "Q", 2.5, role="symbol")))
    assert "datum Q appears 1 times in frames, not 0" in faults(more, part)
    twice = replace(sheet, items=(*sheet.items, Text((30, 30), "A", 2.5, role="symbol")))
    assert any("datum A appears 8 times in frames, not 7" in said for said in faults(twice, part))


@pytest.mark.cad
def test_title_block_names_the_principle_and_the_general_tolerances(sheets):
    for sheet in sheets.values():
        (runs,) = pdf_runs(pdf_bytes([sheet], "title", "author", "2026-11-21"))
        text = " ".join(runs)
        assert "ISO 8015" in text
        assert "2768-2" not in text  # withdrawn
        rest = re.search(
            r"ISO 22081; sizes to 6 ±([\d.]+), to 30 ±([\d.]+), to 120 ±([\d.]+), to 400 ±", text
        )
        assert [float(v) for v in rest.groups()] == [general(v) for v in (6, 30, 120)]


@pytest.mark.cad
def test_the_ledge_of_a_blank_is_located_from_its_dowel_hole():
    design = variant({"array.row_arms": [[4, 7]]})
    part = next(p for p in make_scene(design, "array").parts if p.part_no.endswith("blank"))
    plan = part_plan(part, (DXF,), FAMILY.plans)
    basic = [(d.name, d.text(plan.values)) for d in plan.dimensions if d.basic]
    dowel = next(c for c in part.extrusion.openings if c.segments[0].name == "dowel_hole")
    high = part.extrusion.outer.named("ledge").start[1] - dowel.as_circle()[0][1]
    screws = [c.as_circle()[0][0] for c in part.extrusion.openings if c.segments[0].name == "screw_hole"]
    away = [f"{x - dowel.as_circle()[0][0]:g}" for x in screws]
    assert sorted(text for _, text in basic) == sorted([f"{high:g}", *away])
    sheet = drawn(design, part)
    ledge, screwed = (g.zone for g in part.geometric)
    assert frames_on(sheet) == {(f"{ledge:g}", "A"): ["position"], (f"⌀{screwed:g} CZ", "A"): ["position"]}
    assert layout_faults(sheet) == []


# --- the account of the plan ---

A, B, C = (DatumFeature(*pair) for pair in (("A", "face z=0"), ("B", "left edge"), ("C", "lower edge")))


def block(*features, geometric=(), datums=(), outer=None) -> Part:
    outer = outer or rectangle(0, 0, 40, 30)
    body = Extrusion(outer, 10.0)
    material = Material("6061-T6", 2700)
    return Part("BLOCK", "Block", "milled", material, body, features, geometric=geometric, datums=datums)


def hole(name: str, x: float, y: float, d: float = 3.0) -> Hole:
    return Hole(name, (x, y, 10.0), (0, 0, -1), d, 10.0, True)


def place(*features: str, datums: tuple[str, ...] = ("A", "B", "C")) -> Geometric:
    return Geometric("place", "position", 0.1, features, datums, True)


def test_equal_holes_that_limits_tell_apart_have_callouts_of_their_own():
    part = block(
        hole("a", 5, 8), hole("a", 15, 8), hole("b", 25, 12), geometric=(place("a"),), datums=(A, B, C)
    )
    plan = prism_plan(part, ())
    called = {c.lines[0]: [f.cells for f in c.frames] for v in plan.views for c in v.callouts}
    assert called == {"2× ⌀3 through": [("⌀0.1 CZ", "A", "B", "C")], "⌀3 through": []}
    assert {d.text(plan.values) for d in plan.dimensions if d.basic} == {"5", "15", "8"}


def test_one_hole_has_no_pattern():
    part = block(hole("a", 5, 8), geometric=(place("a"),), datums=(A, B, C))
    cells = [f.cells for v in prism_plan(part, ()).views for c in v.callouts for f in c.frames]
    assert cells == [("⌀0.1", "A", "B", "C")]


@pytest.mark.parametrize(
    ("part", "said"),
    [
        (
            {"features": (hole("a", 5, 8), hole("b", 15, 8, 4.0)), "geometric": (place("a", "b"),)},
            r"tolerance of position \(place\) appears 2 times",
        ),
        (
            {"features": (hole("a", 5, 8),), "geometric": (place("a"),), "datums": (A, C)},
            "nothing locates x = 5 from a datum",
        ),
        ({"datums": (A, DatumFeature("B", "round"))}, "datum B appears 0 times"),
        (
            {"geometric": (Geometric("form", "flatness", 0.1, ("round",)),)},
            r"tolerance of flatness \(form\) appears 0 times",
        ),
    ],
)
def test_a_limit_that_has_no_one_place_is_refused(part, said):
    """Of two kinds of holes at once, from an edge that is no datum, or on what no view shows as a line."""
    corners = [Corner((0, 0), edge="lower edge"), Corner((40, 0)), Corner((40, 30), 5.0, "", "round")]
    given = {"datums": (A, B, C), "geometric": (), "features": ()} | part
    letters = {d.letter for d in given["datums"]}
    geometric = tuple(
        replace(g, datums=tuple(x for x in g.datums if x in letters)) for g in given["geometric"]
    )
    outline = rounded_polygon([*corners, Corner((0, 30), edge="left edge")])
    with pytest.raises(CheckFailure, match=said):
        prism_plan(block(*given["features"], geometric=geometric, datums=given["datums"], outer=outline), ())


@pytest.mark.parametrize("from_behind", [False, True])
def test_edges_and_faces_stand_where_first_angle_projection_shows_them(from_behind):
    """The front view shows the face that the hole is sunk into; in the view from the left, to its right, that
    face is on the right."""
    at, axis = ((5, 8, 0.0), (0, 0, 1)) if from_behind else ((5, 8, 10.0), (0, 0, -1))
    sunk = Hole("a", at, axis, 3.0, 4.0, False)
    behind = DatumFeature("A", "face z=thickness" if from_behind else "face z=0")
    seen = DatumFeature("D", "face z=0" if from_behind else "face z=thickness")
    plan = prism_plan(block(sunk, datums=(behind, seen, B, C)), ())
    away = {(v.name, d.letter): d.away for v in plan.views for d in v.datums}
    left = (1.0, 0.0) if from_behind else (-1.0, 0.0)
    assert away == {
        ("right", "A"): (-1.0, 0.0),
        ("right", "D"): (1.0, 0.0),
        ("front", "B"): pytest.approx(left),
        ("front", "C"): pytest.approx((0.0, -1.0)),
    }
    for view in plan.views:
        for d in view.datums:
            k = 0 if d.away[0] else 1
            far = view.box[k + 2] if d.away[k] > 0 else view.box[k]
            assert d.start[k] == d.end[k] == pytest.approx(far)
