"""Assembly drawings of shipped scenes: clean, complete, and what they say is the bill of materials and the solids."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import replace
from math import dist

import pytest
from variants import variant

from tactcad.export.bom import bom_rows
from tactcad.export.drawing import parts_list
from tactcad.export.drawing.assembly import assembly_sheets
from tactcad.export.drawing.assembly_file import assembly_faults, stacked_svg
from tactcad.export.drawing.gate import pdf_runs
from tactcad.export.drawing.ink import Arc, Fill, Stroke, Text, preliminary
from tactcad.export.drawing.layout import layout_faults
from tactcad.export.drawing.page import MOST_DRAWN, fewer
from tactcad.export.drawing.pdf import pdf_bytes
from tactcad.export.guide import exploded
from tactcad.parts.library.screws import METRIC
from tactcad.scenes import make_scene

pytestmark = pytest.mark.cad


@pytest.fixture(scope="module", params=["array", "sample-stiffness"])
def assembly(request):
    """Scene, bill, shapes and sheets."""
    from tactcad.solids.build import build

    design = variant()
    scene = make_scene(design, request.param)
    shapes = {part.part_no: build(part).wrapped for part in scene.parts}
    rows = bom_rows(scene, design.design.revision, {})
    return design, scene, rows, shapes, assembly_sheets(design, scene, rows, shapes)


def balloons(sheets) -> dict[int, tuple]:
    """Item -> its circle, the tip of its leader, and the sheet: read off the primitives."""
    found = {}
    for n, sheet in enumerate(sheets):
        for circle in (i for i in sheet.items if isinstance(i, Arc) and i.role == "symbol" and i.radius == 4.5):
            (text,) = (t for t in sheet.texts if dist(t.at, circle.centre) < 2.0)
            leaders = [
                i for i in sheet.items if isinstance(i, Stroke) and i.role == "leader" and abs(dist(i.points[0], circle.centre) - 4.5) < 1e-6
            ]
            assert len(leaders) == 1 and int(text.text) not in found
            found[int(text.text)] = (circle, leaders[0].points[1], n)
    return found


def test_every_sheet_is_clean_and_says_what_it_is(assembly):
    design, scene, _, _, sheets = assembly
    for n, sheet in enumerate(sheets, 1):
        assert layout_faults(sheet) == []
        texts = [t.text for t in sheet.texts]
        assert f"{n}/{len(sheets)}" in texts and f"{design.name}-{scene.name}" in texts and design.design.revision in texts
        assert sheet.size in ((420.0, 297.0), (297.0, 420.0), (210.0, 297.0))
    assert re.fullmatch(r"\d+:\d+", next(t.text for t in sheets[0].texts if re.fullmatch(r"\d+:\d+", t.text)))


def test_every_item_that_has_a_solid_has_one_balloon(assembly):
    _, _, rows, _, sheets = assembly
    assert sorted(balloons(sheets)) == [row.item for row in rows if row.has_solid]


def test_leaders_cross_neither_each_other_nor_a_balloon(assembly):
    found = balloons(assembly[4])
    for item, (circle, tip, page) in found.items():
        for other, (there, its_tip, its_page) in found.items():
            if other == item or its_page != page:
                continue
            assert not _cross(circle.centre, tip, there.centre, its_tip), (item, other)
            assert _away(there.centre, circle.centre, tip) > 5.0, (item, other)


def _cross(p, q, r, s) -> bool:
    def side(a, b, c):
        return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])

    return side(p, q, r) * side(p, q, s) < 0 and side(r, s, p) * side(r, s, q) < 0


def _away(p, a, b) -> float:
    u = ((p[0] - a[0]) * (b[0] - a[0]) + (p[1] - a[1]) * (b[1] - a[1])) / dist(a, b) ** 2
    u = min(1.0, max(0.0, u))
    return dist(p, (a[0] + u * (b[0] - a[0]), a[1] + u * (b[1] - a[1])))


def test_every_leader_ends_on_an_edge_of_a_part_with_that_number(assembly):
    """The part's own picture, drawn alone from the same eye, has an edge where the leader ends."""
    from tactcad.export.picture import ABOVE, drawing
    from tactcad.solids.place import placed_shape

    _, scene, rows, shapes, sheets = assembly
    items = {row.part_no: row.item for row in rows}
    edges: dict[int, list] = {}
    for p in exploded(scene):
        lines = drawing([placed_shape(shapes[p.part.part_no], p.origin, p.rotation)], ABOVE).sharp
        edges.setdefault(items[p.part.part_no], []).extend(lines)
    found = balloons(sheets)
    for page in {page for *_, page in found.values()}:
        scale = next(t.text for t in sheets[page].texts if re.fullmatch(r"\d+:\d+", t.text))
        f = int(scale.split(":")[0]) / int(scale.split(":")[1])
        # where the view's own zero lies on the paper: from the box of what is drawn there
        mine = {n: (circle, tip) for n, (circle, tip, there) in found.items() if there == page}
        shift = _shift(sheets[page], f, [line for n in edges for line in edges[n]])
        for n, (_, tip) in mine.items():
            at = ((tip[0] - shift[0]) / f, (tip[1] - shift[1]) / f)
            assert min(_away(at, a, b) for line in edges[n] for a, b in zip(line, line[1:])) < 0.05, n


def _shift(sheet, f, lines) -> tuple[float, float]:
    """Of the view on the paper: the commonest offset between ends of drawn edges and of the parts' own edges."""
    ends = [p for i in sheet.items if isinstance(i, Stroke) and i.role == "outline" and i.line.name == "edge" for p in (i.points[0], i.points[-1])]
    own = {(round(p[0] * f, 2), round(p[1] * f, 2)) for line in lines for p in (line[0], line[-1])}
    count = Counter((round(x - u, 1), round(y - v, 1)) for x, y in ends[:: max(1, len(ends) // 40)] for u, v in own)
    (rough, _), *_ = count.most_common(1)
    near = [(x - u, y - v) for x, y in ends for u, v in own if dist((x - u, y - v), rough) < 0.15]
    return (sum(x for x, _ in near) / len(near), sum(y for _, y in near) / len(near))


def test_the_parts_list_is_the_bill(assembly):
    design, scene, rows, _, sheets = assembly
    pages = pdf_runs(pdf_bytes(sheets, "x", "y"))
    text = "".join(run for page in pages for run in page).replace(" ", "")
    for row in rows:
        quantity = f"{row.qty:g}" + ("" if row.unit == "pcs" else row.unit)
        assert f"{row.item}{quantity}{row.part_no}{row.description}".replace(" ", "") in text, row.part_no
    assert assembly_faults(pdf_bytes(sheets, "x", "y"), f"{design.name}-{scene.name}", design.design.revision, rows) == []


def test_overall_dimensions_are_the_solids(assembly):
    from OCP.Bnd import Bnd_Box
    from OCP.BRepBndLib import BRepBndLib

    from tactcad.solids.place import placed_shape

    _, scene, _, shapes, sheets = assembly
    box = Bnd_Box()
    for p in scene.placements:
        BRepBndLib.AddOptimal_s(placed_shape(shapes[p.part.part_no], p.origin, p.rotation), box, False, False)
    low, high = box.CornerMin(), box.CornerMax()
    sizes = [high.X() - low.X(), high.Y() - low.Y(), high.Z() - low.Z()]
    shown = [float(t.text.strip("()")) for t in sheets[0].texts if re.fullmatch(r"\([\d.]+\)", t.text)]
    assert sorted(shown) == pytest.approx(sorted(sizes), abs=2e-3)


def test_notes_give_torques_and_the_pads_procedure(assembly):
    design, scene, _, _, sheets = assembly
    text = " ".join(t.text for t in sheets[0].texts)
    threads = {m.group(1) for p in scene.parts if (m := re.match(r"ISO4762-(M[\d.]+)x", p.part_no))}
    for thread in threads:
        assert f"{thread} {METRIC[thread].torque:g} N·m" in text
    if scene.name == "array":
        assert "surface plate" in text and "gauge block of 2 mm" in text and "0.01 mm" in text
        assert "E4 arm 8" in text and "E10 arm 7" in text


@pytest.mark.parametrize("assembly", ["array"], indirect=True)
def test_what_is_wrong_in_a_written_drawing_is_found(assembly):
    design, scene, rows, _, sheets = assembly
    number, revision = f"{design.name}-{scene.name}", design.design.revision
    faults = lambda sheets, rows=rows, r=revision: assembly_faults(pdf_bytes(sheets, "x", "y"), number, r, rows)  # noqa: E731
    page = next(n for n, s in enumerate(sheets) if any(isinstance(i, Fill) and i.role == "leader" for i in s.items))
    ballooned = next(t for t in sheets[page].texts if t.anchor == "middle" and t.role == "note" and t.text.isdigit())
    without = replace(sheets[page], items=tuple(i for i in sheets[page].items if i is not ballooned))
    assert any("has 0 balloons" in f for f in faults([*sheets[:page], without, *sheets[page + 1 :]]))
    assert any("has 2 balloons" in f for f in faults([*sheets, sheets[page]]))
    assert any("missing" in f for f in faults(sheets[:-1]))
    assert any("missing" in f for f in faults(sheets, r="ZZ"))
    assert any("parts list" in f for f in faults(sheets, [replace(rows[0], qty=rows[0].qty + 1), *rows[1:]]))
    assert any("parts list" in f for f in faults(sheets, [*rows, replace(rows[-1], item=99, part_no="NEW")]))


@pytest.mark.parametrize("assembly", ["array"], indirect=True)
def test_a_draft_is_marked_on_every_page(assembly):
    pages = pdf_runs(pdf_bytes([preliminary(sheet) for sheet in assembly[4]], "x", "y"))
    assert all(page.count("PRELIMINARY") == 1 for page in pages)
    assert all("PRELIMINARY" not in page for page in pdf_runs(pdf_bytes(assembly[4], "x", "y")))


@pytest.mark.parametrize("assembly", ["array"], indirect=True)
def test_one_svg_holds_all_sheets_below_each_other(assembly):
    from xml.etree import ElementTree

    sheets = assembly[4]
    root = ElementTree.fromstring(stacked_svg(sheets))
    inner = [e for e in root if e.tag.endswith("svg")]
    assert [(float(e.get("width")), float(e.get("height"))) for e in inner] == [s.size for s in sheets]
    heights = [s.size[1] for s in sheets]
    assert [float(e.get("y")) for e in inner] == pytest.approx([sum(heights[:n]) + 10 * n for n in range(len(heights))])
    texts = {e.text for e in root.iter() if e.tag.endswith("text")}
    assert {t.text for s in sheets for t in s.texts} <= texts


def test_long_lists_go_over_several_pages_whole():
    scene = make_scene(variant(), "array")
    rows = bom_rows(scene, "A", {}) * 7
    list_ = parts_list.laid(rows, 1.8)
    pages = parts_list.pages(list_, 200.0)
    assert [n for page in pages for n in page] == list(range(len(rows))) and len(pages) > 2
    for page in pages:
        items, height = parts_list.drawn(list_, page, (0.0, 0.0))
        assert height <= 200.0
        lowest = min(p[1] for i in items if isinstance(i, Stroke) for p in i.points)
        assert lowest == pytest.approx(-height)
        assert all(min(y for _, y in t.corners()) > lowest for t in items if isinstance(t, Text))


def test_of_very_many_parts_some_of_each_are_drawn():
    scene = make_scene(variant({"array.row_arms": [[4.0, 5.0, 6.0] * 40] * 2}), "array")
    kept = fewer(scene.placements)
    assert len(scene.placements) > 400 > MOST_DRAWN >= len(kept)
    assert {p.part.part_no for p in kept} == {p.part_no for p in scene.parts}
