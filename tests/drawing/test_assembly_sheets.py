"""Assembly drawings of shipped scenes: clean, complete, and what they say is the bill of materials and the
solids."""

from __future__ import annotations

import re
from dataclasses import replace
from math import dist

import numpy as np
import pytest
from built import shapes_of
from scipy.spatial import cKDTree
from variants import variant

from tactcad.design.messages import CheckFailure
from tactcad.drawing.assemblies import assembly_sheets as assembly_file
from tactcad.drawing.assemblies.assembly_sheets import assembly_faults, assembly_sheets
from tactcad.drawing.assemblies.balloons import laid, laid_columns, list_drawn
from tactcad.drawing.engine.boxes import placed
from tactcad.drawing.engine.ink import DrawnArc, DrawnSheet, Fill, Stroke, Text, bounds_of_items, preliminary
from tactcad.drawing.engine.layout_check import layout_faults
from tactcad.drawing.engine.paper import MOST_DRAWN, fewer
from tactcad.drawing.engine.sheet_files import pdf_bytes, pdf_runs, stacked_svg
from tactcad.drawing.guide import axes
from tactcad.parts.bought.screws import METRIC
from tactcad.scenes import make_scene
from tactcad.scenes.bom import bom_rows

pytestmark = pytest.mark.cad


SCENES = [
    ("macro-array", "array"),
    pytest.param(("macro-array", "calibration"), marks=pytest.mark.nightly),
    pytest.param(("macro-array", "sample-stiffness"), marks=pytest.mark.nightly),
    pytest.param(("macro-array", "grasping"), marks=pytest.mark.slow),  # seconds to lay out
]
OTHERS = [
    pytest.param(("double-sample", "grasping"), marks=pytest.mark.nightly),
    pytest.param(("smallest-bearing", "grasping"), marks=pytest.mark.nightly),
    ("soft-tissue", "array"),
]


def drawn(base: str, name: str):
    """Design, scene, bill, shapes and sheets."""

    design = variant(base=base)
    scene = make_scene(design, name)
    shapes = shapes_of(scene)
    rows = bom_rows(scene, design.design, {})
    return design, scene, rows, shapes, assembly_sheets(design, scene, rows, shapes)


@pytest.fixture(scope="module", params=SCENES, ids=lambda pair: pair[1])
def assembly(request):
    return drawn(*request.param)


def balloons(sheets) -> dict[int | str, tuple]:
    """Item, or letter of another view -> its circle, the tip of its leader, and the sheet: read off the
    primitives."""
    found = {}
    for n, sheet in enumerate(sheets):
        for circle in (
            i for i in sheet.items if isinstance(i, DrawnArc) and i.role == "symbol" and i.radius == 4.5
        ):
            (text,) = (t for t in sheet.texts if dist(t.at, circle.centre) < 2.0)
            leaders = [
                i
                for i in sheet.items
                if isinstance(i, Stroke)
                and i.role == "leader"
                and abs(dist(i.points[0], circle.centre) - 4.5) < 1e-6
            ]
            label = int(text.text) if text.text.isdigit() else text.text
            assert len(leaders) == 1 and label not in found
            found[label] = (circle, leaders[0].points[1], n)
    return found


def test_every_sheet_is_clean_and_says_what_it_is(assembly):
    design, scene, _, _, sheets = assembly
    for n, sheet in enumerate(sheets, 1):
        assert layout_faults(sheet) == []
        texts = [t.text for t in sheet.texts]
        assert (
            f"{n}/{len(sheets)}" in texts
            and f"{design.name}-{scene.name}" in texts
            and design.design.revision in texts
        )
        assert sheet.size in ((420.0, 297.0), (297.0, 420.0), (210.0, 297.0))
    assert re.fullmatch(r"\d+:\d+", next(t.text for t in sheets[0].texts if re.fullmatch(r"\d+:\d+", t.text)))


def test_every_item_that_has_a_solid_has_one_balloon(assembly):
    _, _, rows, _, sheets = assembly
    assert sorted(n for n in balloons(sheets) if isinstance(n, int)) == [
        row.item for row in rows if row.has_solid
    ]


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


def test_every_leader_ends_on_a_part_with_that_number(assembly):
    """Around the end of the leader lie the lines of the part's own picture, drawn alone from the same eye and
    at the sheet's scale."""
    from tactcad.drawing.engine.picture import ABOVE, drawing
    from tactcad.solids.occt import placed_shape

    _, scene, rows, shapes, sheets = assembly
    item = {row.part_no: row.item for row in rows}
    turned: dict[int, dict] = {}
    for p in [*scene.placements, *(p for ready in scene.ready for p in ready.placements)]:
        turned.setdefault(item[p.part.part_no], {})[p.rotation] = p.part
    found = balloons(sheets)
    for page, sheet in enumerate(sheets):
        mine = {n: tip for n, (_, tip, there) in found.items() if there == page and isinstance(n, int)}
        if mine:
            lines = np.array(
                [
                    (i.points[0], i.points[-1])
                    for i in sheet.items
                    if isinstance(i, Stroke) and i.role == "outline" and i.line.name == "edge"
                ]
            )
            scale = next(t.text for t in sheet.texts if re.fullmatch(r"\d+:\d+", t.text))
            f = int(scale.split(":")[0]) / int(scale.split(":")[1])
            for n, tip in mine.items():
                own = (
                    drawing([placed_shape(shapes[part.part_no], (0, 0, 0), rotation)], ABOVE).sharp
                    for rotation, part in turned[n].items()
                )
                assert any(_found_again(some, f, tip, lines) > 0.2 for some in own), n


def _found_again(own, f, tip, lines) -> float:
    """The largest share of a part's corners that have the end of a drawn line at their place, with the part
    put so that one of its edges is a drawn line and the leader ends on another or the same."""
    chords = np.array([(np.array(a) * f, np.array(b) * f) for line in own for a, b in zip(line, line[1:])])
    whole = np.array([(line[0], line[-1]) for line in own]) * f
    corners = np.unique(whole.reshape(-1, 2), axis=0)
    ends = cKDTree(lines.reshape(-1, 2))
    same = cKDTree(lines[:, 1] - lines[:, 0]).query_ball_point(whole[:, 1] - whole[:, 0], 0.02)
    shifts = np.unique(
        [np.round(lines[k, 0] - edge[0], 2) for edge, some in zip(whole, same) for k in some] or [(1e9, 1e9)],
        axis=0,
    )
    start, way = chords[:, 0], chords[:, 1] - chords[:, 0]
    best = 0.0
    for shift in shifts:
        to_tip = np.array(tip) - shift - start
        u = np.clip((to_tip * way).sum(axis=1) / np.maximum((way**2).sum(axis=1), 1e-12), 0.0, 1.0)
        if np.hypot(*(to_tip - u[:, None] * way).T).min() < 0.05:
            best = max(best, float(np.mean(ends.query(corners + shift)[0] < 0.03)))
    return best


@pytest.mark.parametrize("assembly", SCENES[1:], ids=lambda pair: pair[1], indirect=True)
def test_a_rig_is_taken_apart_sub_assembly_by_sub_assembly(assembly):
    """Of the written file: which items a view has, in balloons or named as numbered elsewhere, and which
    views it points to."""
    _, scene, rows, _, sheets = assembly
    item = {row.part_no: row.item for row in rows}
    at = {p.designator: item[p.part.part_no] for p in scene.placements}
    views = _views(sheets)
    # every letter in a balloon is the letter of one view, every view but the first has one
    letters = [n for view in views.values() for n in view["shown"] if isinstance(n, str)]
    assert sorted(letters) == sorted(view["letter"] for view in views.values() if view["letter"] != "A")
    assert not [n for n in views["the sub-assemblies"]["shown"] if isinstance(n, int)]
    for name, view in views.items():
        assert all(
            item_view in {v["letter"] for v in views.values()} and item_view < view["letter"]
            for item_view in view["elsewhere"].values()
        )
    items = {
        name: {n for n in view["shown"] if isinstance(n, int)} | set(view["elsewhere"])
        for name, view in views.items()
    }
    assert set().union(*items.values()) == set(at.values())
    groups = dict(scene.groups)
    if "cart" in groups:
        assert items["cart with holder and sample"] == {at[d] for d in groups["cart"]}
    for ready in scene.ready:
        assert items[ready.name] == {item[p.part.part_no] for p in ready.placements}
    standing = {d for name in ("BP", "PO", "RI", "RL") for d in at if d.rstrip("0123456789") == name}
    assert {at[d] for d in standing} <= items["stand"]
    moving = {at[d] for d in groups["axis"]} - set().union(
        *({item[p.part.part_no] for p in r.placements} for r in scene.ready), set()
    )
    assert moving <= set().union(
        *(items[n] for n in items if n in ("vertical axis", "platform with weights", "force axis"))
    )


def _views(sheets) -> dict[str, dict]:
    """By title: letter, labels in balloons, and items that are numbered in another view, with its letter."""
    labels = balloons(sheets)
    views = {}
    for page, runs in enumerate(pdf_runs(pdf_bytes(sheets, "x", "y", "2026-11-21"))):
        for match in filter(None, (re.fullmatch(r"([A-Z]): (.+), exploded", run) for run in runs)):
            also = " ".join(run for run in runs if run.startswith("Also here: "))
            elsewhere = {int(n): letter for n, letter in re.findall(r"(\d+) \(see ([A-Z])\)", also)}
            shown = [n for n, (*_, there) in labels.items() if there == page]
            assert match[2] not in views and not set(shown) & set(elsewhere)
            views[match[2]] = {"letter": match[1], "shown": shown, "elsewhere": elsewhere}
    return views


@pytest.mark.parametrize("assembly", SCENES + OTHERS, ids="-".join, indirect=True)
def test_no_shipped_design_falls_back_on_parts_side_by_side(assembly):
    design, scene, rows, _, sheets = assembly
    pdf = pdf_bytes(sheets, "x", "y", "2026-11-21")
    runs = [run for page in pdf_runs(pdf) for run in page]
    assert not [run for run in runs if run.startswith("One of each part") or "the views before it" in run]
    assert assembly_faults(pdf, f"{design.name}-{scene.name}", design.design.revision, rows) == []
    assert all(layout_faults(sheet) == [] for sheet in sheets)
    # no part that is numbered is smaller on the paper than an M3 screw at 1:2
    scales = [t.text for sheet in sheets for t in sheet.texts if re.fullmatch(r"\d+:\d+", t.text)]
    assert {"1:5", "1:10", "1:20", "1:50"}.isdisjoint(scales)


def test_the_parts_list_is_the_bill(assembly):
    design, scene, rows, _, sheets = assembly
    pages = pdf_runs(pdf_bytes(sheets, "x", "y", "2026-11-21"))
    text = "".join(run for page in pages for run in page).replace(" ", "")
    for row in rows:
        quantity = f"{row.qty:g}" + ("" if row.unit == "pcs" else row.unit)
        assert f"{row.item}{quantity}{row.part_no}{row.description}".replace(" ", "") in text, row.part_no
    assert (
        assembly_faults(
            pdf_bytes(sheets, "x", "y", "2026-11-21"),
            f"{design.name}-{scene.name}",
            design.design.revision,
            rows,
        )
        == []
    )


def test_overall_dimensions_are_the_solids(assembly):
    from OCP.Bnd import Bnd_Box
    from OCP.BRepBndLib import BRepBndLib

    from tactcad.solids.occt import placed_shape

    _, scene, _, shapes, sheets = assembly
    box = Bnd_Box()
    for p in scene.placements:
        BRepBndLib.AddOptimal_s(placed_shape(shapes[p.part.part_no], p.origin, p.rotation), box, False, False)
    low, high = box.CornerMin(), box.CornerMax()
    sizes = [high.X() - low.X(), high.Y() - low.Y(), high.Z() - low.Z()]
    shown = [float(t.text.strip("()")) for t in sheets[0].texts if re.fullmatch(r"\([\d.]+\)", t.text)]
    own = interfaces(scene) if scene.name == "array" else []
    assert sorted(shown) == pytest.approx(sorted(sizes + own), abs=2e-3)


def interfaces(scene) -> list[float]:
    """Pitch and gap of the placed pads, and both distances of the carrier's threads for its holder, mm."""
    at = {p.designator: p for p in scene.placements}
    tips = {
        d: placed(at[d], (*at[d].part.extrusion.outer.named("pad_face").start, 0.0))
        for d in ("E1", "E2", "E6")
    }
    threads = [f.at for f in at["CA1"].part.features if f.name == "mount"]
    return [
        tips["E2"][1] - tips["E1"][1],
        tips["E1"][0] - tips["E6"][0],
        *(max(t[k] for t in threads) - min(t[k] for t in threads) for k in (0, 1)),
    ]


@pytest.mark.parametrize(
    "assembly", [("macro-array", "array"), ("soft-tissue", "array")], ids=str, indirect=True
)
def test_the_sensing_face_says_which_element_stands_where(assembly):
    """Numbers on the side and at the height of their elements, x to the right and y down, by the scale."""
    _, scene, _, _, sheets = assembly
    numbers = {t.text: t for t in sheets[0].texts if re.fullmatch(r"E\d+", t.text)}
    at = {p.designator: p for p in scene.placements}
    assert sorted(numbers) == sorted(d for d in at if re.fullmatch(r"E\d+", d))
    scale = next(t.text for t in sheets[0].texts if re.fullmatch(r"\d+:\d+", t.text))
    f = int(scale.split(":")[0]) / int(scale.split(":")[1])
    first, last = min(numbers, key=lambda d: int(d[1:])), max(numbers, key=lambda d: int(d[1:]))
    centre = (numbers[first].at[0] + numbers[last].at[0]) / 2
    thick = at[first].part.extrusion.thickness
    low = numbers[first].at[1] + f * placed(at[first], (0.0, 0.0, thick / 2))[1]
    for d, text in numbers.items():
        x, y, _ = placed(at[d], (10.0, 0.0, thick / 2))
        assert (text.at[0] > centre) == (x > 0)
        assert text.at[1] + f * y == pytest.approx(low, abs=1e-6)
    assert {"+x", "+y", "Sensing face"} <= {t.text for t in sheets[0].texts}


def test_the_axes_names_stand_on_the_side_away_from_the_elements_numbers():
    """Numbers end just left of the axes, at any height: of a short array E1 beside the end of y."""
    x0, *_ = bounds_of_items(axes((0.0, 0.0)))
    assert x0 > -0.5  # half an arrow head
    sheet = DrawnSheet("axes", "", (50.0, 50.0), tuple(axes((25.0, 25.0))))
    assert layout_faults(sheet) == []


def test_notes_give_torques_and_the_pads_procedure(assembly):
    design, scene, _, _, sheets = assembly
    text = " ".join(t.text for t in sheets[0].texts)
    threads = {m.group(1) for p in scene.parts if (m := re.match(r"ISO4762-(M[\d.]+)x", p.part_no))}
    for thread in threads:
        assert f"{thread} {METRIC[thread].torque:g} N·m" in text
    if scene.name == "array":
        assert "Turn set screws in to M3 0.2 N·m" in text
        assert "surface plate" in text and "feelers, 2 mm nominal" in text
        assert "within 0.02 mm" in text and "setting fixture" in text
        assert "E4 arm 8" in text and "E10 arm 7" in text


@pytest.mark.parametrize("assembly", SCENES[:1], ids=["array"], indirect=True)
def test_what_is_wrong_in_a_written_drawing_is_found(assembly):
    design, scene, rows, _, sheets = assembly
    number, revision = f"{design.name}-{scene.name}", design.design.revision

    def faults(sheets, rows=rows, r=revision, number=number):
        return assembly_faults(pdf_bytes(sheets, "x", "y", "2026-11-21"), number, r, rows)

    page = next(
        n for n, s in enumerate(sheets) if any(isinstance(i, Fill) and i.role == "leader" for i in s.items)
    )
    ballooned = next(
        t for t in sheets[page].texts if t.anchor == "middle" and t.role == "note" and t.text.isdigit()
    )
    without = replace(sheets[page], items=tuple(i for i in sheets[page].items if i is not ballooned))
    assert any("has 0 balloons" in f for f in faults([*sheets[:page], without, *sheets[page + 1 :]]))
    assert any("has 2 balloons" in f for f in faults([*sheets, sheets[page]]))
    assert any("missing" in f for f in faults(sheets[:-1]))
    assert any("missing" in f for f in faults(sheets, r="ZZ"))
    said = [f for f in faults(sheets, number="other-array") if "is missing" in f]
    assert said == [f"sheet {n}: 'other-array' is missing" for n in range(1, len(sheets) + 1)]
    assert any("parts list" in f for f in faults(sheets, [replace(rows[0], qty=rows[0].qty + 1), *rows[1:]]))
    assert any("parts list" in f for f in faults(sheets, [*rows, replace(rows[-1], item=99, part_no="NEW")]))


@pytest.mark.parametrize("assembly", SCENES[:1], ids=["array"], indirect=True)
def test_a_drawing_that_lacks_a_sheet_is_not_written(assembly):
    design, scene, rows, _, sheets = assembly
    assert pdf_runs(assembly_file.assembly_written(sheets, design, scene, rows).pdf)
    with pytest.raises(CheckFailure, match="no drawing was written"):
        assembly_file.assembly_written(sheets[:-1], design, scene, rows)


@pytest.mark.parametrize("assembly", SCENES[:1], ids=["array"], indirect=True)
def test_a_draft_is_marked_on_every_page(assembly):
    pages = pdf_runs(pdf_bytes([preliminary(sheet) for sheet in assembly[4]], "x", "y", "2026-11-21"))
    assert all(page.count("PRELIMINARY") == 1 for page in pages)
    assert all("PRELIMINARY" not in page for page in pdf_runs(pdf_bytes(assembly[4], "x", "y", "2026-11-21")))


@pytest.mark.parametrize("assembly", SCENES[:1], ids=["array"], indirect=True)
def test_one_svg_holds_all_sheets_below_each_other(assembly):
    from xml.etree import ElementTree

    sheets = assembly[4]
    root = ElementTree.fromstring(stacked_svg(sheets))
    inner = [e for e in root if e.tag.endswith("svg")]
    assert [(float(e.get("width")), float(e.get("height"))) for e in inner] == [s.size for s in sheets]
    heights = [s.size[1] for s in sheets]
    assert [float(e.get("y")) for e in inner] == pytest.approx(
        [sum(heights[:n]) + 10 * n for n in range(len(heights))]
    )
    texts = {e.text for e in root.iter() if e.tag.endswith("text")}
    assert {t.text for s in sheets for t in s.texts} <= texts


def test_long_lists_go_over_several_columns_whole():
    scene = make_scene(variant(), "array")
    rows = bom_rows(scene, None, {}) * 7
    list_ = laid(rows, 1.8)
    rooms = [200.0, 150.0]
    columns = laid_columns(list_, rooms)
    assert [n for rows_ in columns for n in rows_] == list(range(len(rows))) and len(columns) > 2
    for c, rows_ in enumerate(columns):
        items, height = list_drawn(list_, rows_, (0.0, 0.0))
        assert height <= rooms[c % 2]
        lowest = min(p[1] for i in items if isinstance(i, Stroke) for p in i.points)
        assert lowest == pytest.approx(-height)
        assert all(min(y for _, y in t.corners()) > lowest for t in items if isinstance(t, Text))


def test_of_very_many_parts_some_of_each_are_drawn():
    scene = make_scene(variant({"array.row_arms": [[4.0, 5.0, 6.0] * 40] * 2}), "array")
    kept = fewer(scene.placements)
    assert len(scene.placements) > 400 > MOST_DRAWN >= len(kept)
    assert {p.part.part_no for p in kept} == {p.part_no for p in scene.parts}
