"""Finished sheets: clean at paper size, read back, the same in any process, refused where they cannot be
right."""

from __future__ import annotations

import hashlib
import json
import os
import pickle
import re
import subprocess
import sys
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from built import shape_of
from variants import HARDWARE, IN_SLOT, one_letter, variant

import tactcad
from tactcad.cli.main import main
from tactcad.contour import rectangle
from tactcad.design.messages import CheckFailure
from tactcad.drawing.engine import ink
from tactcad.drawing.engine.ink import DrawnArc, Stroke, Text
from tactcad.drawing.engine.layout_check import layout_faults
from tactcad.drawing.engine.paper import A3, A4, SERIES
from tactcad.drawing.engine.sheet_files import pdf_bytes, pdf_runs
from tactcad.drawing.parts import board
from tactcad.drawing.parts import part_sheet as sheets
from tactcad.drawing.parts.compose import compose
from tactcad.drawing.parts.part_sheet import (
    MadeFrom,
    Order,
    drawing_faults,
    key_faults,
    part_sheet,
    title_of,
    written,
)
from tactcad.drawing.parts.prism import prism_plan
from tactcad.export.formats import ExportOptions
from tactcad.export.manifest import check_manifest, read_manifest, sha256_of
from tactcad.export.pipeline import export
from tactcad.export.workers import Task, side_by_side
from tactcad.parts.language.description import Characteristic, Extrusion, Material, Part
from tactcad.scenes import make_scene, scene_names

pytestmark = pytest.mark.cad

DXF = MadeFrom("dxf/some_B.dxf", "f" * 64)
ELEMENT = "macro-array-element-a8mm"


def sheets_of(orders: list[Order]) -> list:
    """Made by processes, in the orders' order."""
    made = dict(side_by_side([Task(order.part.part_no, partial(written, order)) for order in orders]))
    return [made[n] for n in range(len(orders))]


@pytest.fixture(scope="module")
def orders(macro, macro_scene, macro_shapes):
    from tactcad.solids.step import to_bytes

    return {
        p.part_no: Order(macro, p, to_bytes(macro_shapes[p.part_no]), (DXF,))
        for p in macro_scene.parts
        if not p.bought
    }


@pytest.fixture(scope="module")
def finished(orders):
    return {n: part_sheet(order) for n, order in orders.items()}


def pdf(sheet) -> bytes:
    return pdf_bytes([sheet], "title", "author", "2026-11-21")


def test_every_sheet_of_the_array_is_clean_and_complete(orders, finished, macro):
    assert len(finished) >= 10
    for number, sheet in finished.items():
        assert layout_faults(sheet) == []
        assert drawing_faults(pdf(sheet), sheet, orders[number].part, macro.design.revision) == []
        (runs,) = pdf_runs(pdf(sheet))
        for text in (
            number,
            macro.design.revision,
            "1/1",
            macro.design.date,
            macro.design.title,
            orders[number].part.name,
            *str(orders[number].part.material).split(", "),
            "tolerancing ISO 8015",
            "ISO 22081; sizes to 6 ±0.1, to 30 ±0.2,",
            "surfaces: profile 0.4, to datums if any",
        ):
            assert text in runs, (number, text)
        assert "f" * 64 in " ".join(runs) and "some_B.dxf" in " ".join(runs)


def test_the_stated_scale_is_preferred_and_is_the_one_drawn(finished, orders):
    """The outline's visible lines span the part's box times the scale that the title block states."""
    for number in ("macro-array-stop-plate", "macro-array-carrier"):
        sheet = finished[number]
        stated = next(t.text for t in sheet.texts if re.fullmatch(r"\d+:\d+", t.text))
        up, down = map(int, stated.split(":"))
        assert (up, down) in SERIES
        x0, y0, x1, y1 = orders[number].part.body.outer.box
        lines = [c for i in sheet.items if isinstance(i, Stroke) and i.role == "outline" for c in i.chords()]
        lengths = {round(max(abs(b[0] - a[0]), abs(b[1] - a[1])), 3) for a, b in lines}
        assert round((x1 - x0) * up / down, 3) in lengths and round((y1 - y0) * up / down, 3) in lengths


def test_a_place_without_room_for_a_text_s_box_is_none_for_the_text(finished, orders, monkeypatch):
    """Where no box is looked at first, the sheets are the same."""
    monkeypatch.setattr(board, "ROUNDING", 1e3)  # boxes turned inside out, which fit anywhere
    for number in ("macro-array-carrier", ELEMENT):
        assert part_sheet(orders[number]) == finished[number]


def test_the_hinge_is_shown_at_ten_to_one_or_larger(finished):
    for number, sheet in finished.items():
        if "element" in number:
            label = next(t.text for t in sheet.texts if t.text.startswith("Z ("))
            assert int(label.removeprefix("Z (").split(":")[0]) >= 10
            # and its fillets are true arcs at that scale
            factor = int(label.removeprefix("Z (").split(":")[0])
            radii = {
                round(i.radius, 3) for i in sheet.items if isinstance(i, DrawnArc) and i.role == "outline"
            }
            assert round(0.3 * factor, 3) in radii


def test_dimension_lines_stand_off_the_outline(finished):
    """No dimension line is nearer than 7 mm to the part's box in its own direction: those across a web
    apart."""
    for number in ("macro-array-stop-plate", "macro-array-carrier", "macro-array-spacer"):
        sheet = finished[number]
        outline = [i for i in sheet.items if isinstance(i, Stroke) and i.role == "outline"]
        level = [i for i in sheet.items if isinstance(i, Stroke) and i.role == "dimension"]
        for line in level:
            (ax, ay), (bx, by) = line.points
            for edge in outline:
                (px, py), (qx, qy) = edge.points[0], edge.points[-1]
                if ay == by and py == qy and min(ax, bx) < max(px, qx) and min(px, qx) < max(ax, bx):
                    assert abs(ay - py) >= 7.0, number


def test_key_characteristics_are_found_in_the_pdf_and_held_against_the_model(orders, finished):
    part = orders[ELEMENT].part
    keys = [c for c in part.characteristics if c.key]
    assert len(keys) == 4
    (runs,) = pdf_runs(pdf(finished[ELEMENT]))
    assert key_faults(runs, keys) == []
    thinner = [replace(keys[0], nominal=keys[0].nominal - 0.001), *keys[1:]]
    assert "the model has 0.249" in key_faults(runs, thinner)[0]
    wider = [replace(keys[0], upper=keys[0].upper + 0.001), *keys[1:]]
    assert len(key_faults(runs, wider)) == 1
    assert key_faults([*runs, "K1"], keys) and key_faults([r for r in runs if r != "K2"], keys)
    again = runs[runs.index("K1") + 1]
    bare = [run if run is not again else "0.25" for run in runs]
    assert key_faults(bare, keys) == ["K1: '0.25' is no value with limits"]
    assert f"{again!r} appears 2 times" in " ".join(key_faults([*runs, again], keys))
    assert "K5" in key_faults(runs, [*keys, Characteristic("one more", 1.0, 1.1, 0.9, True)])[0]


def test_the_gate_sees_a_sheet_that_says_something_else(orders, finished, macro):
    sheet, part = finished[ELEMENT], orders[ELEMENT].part
    value = next(t for t in sheet.texts if t.text.startswith("0.25 "))
    wrong = replace(
        sheet, items=tuple(replace(i, text="0.26 ±0.005") if i is value else i for i in sheet.items)
    )
    assert any(
        "says 0.26" in fault for fault in drawing_faults(pdf(wrong), wrong, part, macro.design.revision)
    )
    assert any(
        "is not found again" in fault
        for fault in drawing_faults(pdf(wrong), sheet, part, macro.design.revision)
    )
    assert any("'Q' is missing" in fault for fault in drawing_faults(pdf(sheet), sheet, part, "Q"))
    other = replace(part, part_no="macro-array-other")
    assert any(
        "'macro-array-other' is missing" in fault
        for fault in drawing_faults(pdf(sheet), sheet, other, macro.design.revision)
    )
    two = pdf_bytes([sheet, sheet], "t", "a", "2026-11-21")
    assert drawing_faults(two, sheet, part, macro.design.revision) == ["2 pages instead of 1"]
    scribbled = replace(sheet, items=(*sheet.items, Text(value.at, "again", 2.5)))
    assert any(
        "over text" in fault
        for fault in drawing_faults(pdf(scribbled), scribbled, part, macro.design.revision)
    )


def test_a_sheet_written_without_a_text_is_not_let_out(orders, finished, monkeypatch):
    from tactcad.drawing.engine import sheet_files as pdf

    sheet = finished[ELEMENT]
    lost = next(t for t in sheet.texts if t.text == "K1")
    without = replace(sheet, items=tuple(item for item in sheet.items if item is not lost))
    monkeypatch.setattr(pdf, "pdf_bytes", lambda sheets, *more: pdf_bytes([without], *more))
    monkeypatch.setattr(sheets, "part_sheet", lambda order: sheet)
    with pytest.raises(CheckFailure, match=r"K1 .*appears 0 times.*; no drawing was written"):
        written(orders[ELEMENT])


@pytest.mark.slow  # processes; by day test_sheet_writers.py
def test_side_by_side_or_one_by_one_the_bytes_are_the_same(orders, tmp_path):
    """Three sheets from two processes of this one, and two of them from a fresh process with another hash
    seed."""
    some = list(orders.values())[:3]
    beside = sheets_of(some)
    assert [written(order) for order in some[:2]] == beside[:2]
    (tmp_path / "orders").write_bytes(pickle.dumps(some[:2]))
    script = (
        "import hashlib, pickle, sys\nfrom tactcad.drawing.parts.part_sheet import written\n"
        "done = [written(o) for o in reversed(pickle.load(open(sys.argv[1], 'rb')))]\n"
        "print(*(hashlib.sha256(d.pdf + d.svg).hexdigest() for d in reversed(done)))"
    )
    run = subprocess.run(
        [sys.executable, "-c", script, tmp_path / "orders"],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "PYTHONHASHSEED": "99", "PYTHONPATH": str(Path(tactcad.__file__).parents[1])},
    )
    assert run.stdout.split() == [hashlib.sha256(d.pdf + d.svg).hexdigest() for d in beside[:2]]


def test_a_draft_says_preliminary_and_is_no_final(orders):
    order = orders["macro-array-spacer"]
    draft = written(replace(order, draft=True))
    (runs,) = pdf_runs(draft.pdf)
    assert "PRELIMINARY" in "".join(runs) and "draft" in runs
    (runs,) = pdf_runs(written(order).pdf)
    assert "PRELIMINARY" not in "".join(runs) and "for manufacture" in runs


def test_a_part_larger_than_the_paper_is_refused(macro):
    size = 4000.0
    part = Part(
        "LONG", "Long", "milled", Material("6061-T6", 2700), Extrusion(rectangle(0, 0, size, 50), 10.0)
    )
    plan = prism_plan(part, ())
    curves = {v.name: [Stroke(((0, 0), (size, 0)))] for v in plan.views}
    with pytest.raises(CheckFailure, match=r"LONG \(4000 x 50 mm\) finds no place on A4, A3 at 50:1 to 1:10"):
        compose(plan, curves, title_of(macro, part, False), (A4, A3))


def test_a_letter_that_the_font_lacks_is_refused(orders, macro):
    named = replace(macro, design=replace(macro.design, author="张"))
    with pytest.raises(CheckFailure, match="has no letter"):
        written(replace(orders["macro-array-spacer"], design=named))


class Silent:
    def line(self, text: str) -> None: ...

    def step(self, done: int, total: int, text: str) -> None: ...


SMALL = {"array.row_arms": [[4.0, 6.0]]}


def test_a_missing_font_stops_the_export_before_anything_is_written(monkeypatch, tmp_path):
    monkeypatch.setattr(ink, "_FILE", Path("nowhere.ttf"))
    with pytest.raises(CheckFailure, match="nowhere.ttf"):
        export(variant(SMALL), ExportOptions(("array",), drawings=True), tmp_path / "out", Silent())
    assert not (tmp_path / "out").exists()


def test_a_killed_process_stops_the_export(monkeypatch, orders):
    monkeypatch.setattr(sheets, "part_sheet", lambda order: os._exit(9))
    with pytest.raises(CheckFailure, match="killed"):
        sheets_of(list(orders.values()))


CHILD = """
import json, sys
from tactcad.cli.main import main
status = main(sys.argv[1:])
print(json.dumps([status, sorted({m.split(".")[0] for m in sys.modules})]))
"""


@pytest.mark.slow  # a whole export with drawings
def test_export_with_drawings(tmp_path, monkeypatch):
    """Every part made here has its PDF and SVG in the manifest, each names the file it is made from with the
    hash that the manifest has for it; the same again rebuilds nothing and loads neither kernel nor PDF
    library."""
    (tmp_path / "d.toml").write_text(
        one_letter((HARDWARE / "macro-array.toml").read_text()).replace(
            "[[4, 7, 6, 8, 6], [8, 5, 4, 5, 7]]", "[[4]]"
        )
    )
    command = [
        sys.executable,
        "-c",
        CHILD,
        "export",
        "d.toml",
        "--scene",
        "array",
        "--drawings",
        "--out",
        "out",
    ]
    environment = {**os.environ, "PYTHONPATH": str(Path(tactcad.__file__).parents[1])}
    monkeypatch.chdir(tmp_path)
    assert main(command[3:]) == 0
    manifest = read_manifest(tmp_path / "out")
    assert check_manifest((tmp_path / "out").resolve()) == []
    made = {p.part_no for p in manifest.parts if p.process != "bought"}
    files = {f.path: f for f in manifest.files}
    drawings = [f for f in manifest.files if f.kind == "drawing" and f.part_no]
    revision = manifest.revision
    assert {f.path for f in drawings} == {
        f"drawings/{n}_{revision}.{e}" for n in made for e in ("pdf", "svg")
    }
    for f in drawings:
        if f.path.endswith(".pdf"):
            text = " ".join(pdf_runs((tmp_path / "out" / f.path).read_bytes())[0])
            wire_cut = next(p for p in manifest.parts if p.part_no == f.part_no).process == "wire-cut"
            model = [] if wire_cut else [files[f"step/{f.part_no}_{revision}.step"]]
            cut = files.get(f"dxf/{f.part_no}_{revision}.dxf")
            for source in model + ([cut] if cut else []):
                assert source.sha256 in text and Path(source.path).name in text
            assert sha256_of((tmp_path / "out" / f.path).read_bytes()) == f.sha256
    again = subprocess.run(
        command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
    )
    status, loaded = json.loads(again.stdout)
    assert status == 0 and "nothing was rebuilt" in again.stderr
    assert not {"OCP", "build123d", "numpy", "reportlab", "pypdf", "matplotlib"} & set(loaded)


VARIANTS = {
    "both sides": {**IN_SLOT, "element.sides": "two"},
    "thick body": {**IN_SLOT, "element.sides": "two", "element.body_height": 4.0, "element.pad_height": 2.5},
    "uneven rows": {"array.row_arms": [[4, 7, 6], [8]]},
    "full round": {"element.hinge_length": 0.6, "element.fillet_radius": 0.3, "array.row_arms": [[5], [6]]},
    "long arms": {"array.row_arms": [[40, 30], [6, 8]]},
    "tie rods": {"array.row_arms": [[4] * 12, [8] * 12]},
    "eighty": {"array.row_arms": [[4] * 40, [8] * 40]},
    "thin": {"element.hinge_thickness": 0.1, "array.row_arms": [[5, 6]]},
    "rigs": {},
}


@pytest.mark.nightly
@pytest.mark.parametrize("name", [*VARIANTS, "soft-tissue", "double-sample", "smallest-bearing"])
def test_sheets_of_other_designs_are_clean(name):
    from tactcad.solids.step import to_bytes

    design = variant(VARIANTS[name]) if name in VARIANTS else variant({}, name)
    scenes = ("array",) if VARIANTS.get(name) else scene_names(design)
    parts = {
        p.part_no: p
        for s in scenes
        for p in make_scene(design, s).parts
        if p.process not in ("bought", "reference")
    }
    made = sheets_of([Order(design, p, to_bytes(shape_of(p)), (DXF,)) for p in parts.values()])
    assert len(made) == len(parts)
