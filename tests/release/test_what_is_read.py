"""What shops, buyers and mechanics read: bills, guides, orders, READMEs and sheets as they are written, of
designs with every rig. Each sentence was once missing there."""

from __future__ import annotations

import csv
import io
import re
from collections import defaultdict
from functools import cache
from html import unescape
from itertools import product
from math import dist

import pytest
from built import shape_of
from variants import HARDWARE

from tactcad.checks.shop import load_shop
from tactcad.drawing.engine.ink import DrawnSheet, Fill, Stroke, Text
from tactcad.drawing.engine.paper import A4, title_block
from tactcad.drawing.engine.sheet_files import pdf_bytes, pdf_runs
from tactcad.drawing.guide import page
from tactcad.drawing.parts.part_sheet import Order, part_sheet, title_of
from tactcad.parts.language.description import Part
from tactcad.parts.rules import load
from tactcad.release.packages import ORDER, nest_files, packed
from tactcad.release.readme import package_readme
from tactcad.release.release_contents import PROCESSES, ReleaseContents
from tactcad.scenes import make_scene, scene_names
from tactcad.scenes.bom import bom_rows, csv_bytes

DESIGNS = sorted(path.stem for path in HARDWARE.glob("*.toml"))


def rows(data: bytes) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(data.decode(), newline="")))


@cache
def guide(scene: str) -> dict[str, str]:
    """Title of a step of the macro array's guide -> its words; "" -> the whole page's."""
    design = load("macro-array")
    html = page(design, make_scene(design, scene)).decode()
    steps = re.findall(r"<section><h2>\d+\. (.*?)</h2>(.*?)</section>", html, re.S)
    return {title: unescape(re.sub(r"<[^>]+>", " ", text)) for title, text in [*steps, ("", html)]}


@cache
def bill(scene: str) -> dict[str, dict[str, str]]:
    made = make_scene(load("macro-array"), scene)
    return {row["part_no"]: row for row in rows(csv_bytes(bom_rows(made, None, {})))}


@cache
def packages(name: str) -> dict[str, tuple[dict[str, dict[str, str]], str]]:
    """By way of making: lines of the order by part number, and the README in one line."""
    design, shop = load(name), load_shop()
    contents = ReleaseContents(
        design, [make_scene(design, scene) for scene in scene_names(design)], (), (), False
    )
    files = defaultdict(bytes, nest_files(contents, shop))  # what needs the kernel is empty
    made = packed(contents, files, shop)
    return {
        one.package.name: (
            {r["part_no"].removeprefix(f"{name}-"): r for r in rows(one.files[ORDER])},
            " ".join(package_readme(contents, one, "whole.zip", shop).decode().split()),
        )
        for one in made
    }


@pytest.mark.parametrize(
    ("scene", "said", "part_no"),
    [
        ("bonding", "silicone adhesive", "SILICONE-ADHESIVE"),
        ("bonding", "Solder three leads", "SOLDER"),
        ("bonding", "clean off all flux", "FLUX"),
        ("bonding", "insulated strand", "STRAND"),
        ("sample-stiffness", "silicone grease", "SILICONE-GREASE"),
        ("sample-stiffness", "Close the holes with tape", "LEAK-TAPE"),
        ("calibration", "shim foil under its foot", "SHIM-FOIL"),
        ("grasping", "thin oil", "GUIDE-OIL"),
        ("array", "oil every thread", "ASSEMBLY-OIL"),
        ("array", "thread lacquer", "THREAD-LACQUER"),
        ("setting", "bar of rubber for each row", "RUBBER-BAR"),
    ],
)
def test_what_a_guide_uses_up_is_in_its_bill(scene, said, part_no):
    assert said in guide(scene)[""]
    assert bill(scene)[part_no]["standard_designation"] and float(bill(scene)[part_no]["qty"]) > 0


@pytest.mark.parametrize(
    ("scene", "step", "said"),
    [
        ("array", "End plate and dowels", r"a sleeve [\d.]+ mm long|[\d.]+ mm deep: [\d.]+ mm stand out"),
        ("setting", "Setting fixture", r"9 mm deep"),
        ("calibration", "Stand", r"shim foil under its foot"),
        ("calibration", "Array on its mount", r"row 1 at the end marked x"),
        ("calibration", "Mount on the stages", r"rows then run along y"),
        ("calibration", "Mount on the stages", r"fit a quarter turn off too: look at the mark"),
        ("calibration", "Take the array off, then fit the stop plate", r"take the carrier off .* \(hex key"),
        ("grasping", "Riser", r"rows at z = 85 and 165 mm"),
        ("grasping", "Riser", r"upright within 0\.01 mm on 100 mm .* shim foil between post and riser"),
        ("grasping", "End stop", r"8 mm deep"),
    ],
)
def test_a_step_says_what_hands_must_know(scene, step, said):
    assert re.search(said, guide(scene)[step], re.S)


def test_the_gauge_is_measured_before_the_array_lies_under_it():
    order = list(guide("calibration"))
    at = [order.index(s) for s in ("Roller tip", "Stiffness of gauge and stand", "Array on its mount")]
    assert at == sorted(at)


def test_the_key_for_the_carrier_and_the_sleeve_for_the_dowels_are_among_the_tools():
    assert re.search(r"hex key [\d.]+ mm: the carrier's screws", guide("calibration")[""])
    for scene in ("array", "setting", "grasping"):
        assert re.search(r"sleeve [\d.]+ mm long as stop", guide(scene)[""])


@pytest.mark.parametrize(
    ("way", "said"),
    [
        ("wire-cutting", "EN 10204 3.1, with its heat number"),
        ("sheet", "EN 10204 3.1, with its heat number"),
        ("wire-cutting", "in its own compartment of a box or in foam, its arm free of everything"),
        ("wire-cutting", "delivery wanted by"),
        ("milling-and-turning", "delivery wanted by"),
        ("purchase-mechanical", "delivery wanted by"),
    ],
)
def test_a_readme_asks_for_it(way, said):
    assert said in packages("macro-array")[way][1]


def test_etched_foil_comes_with_its_certificate():
    lines, readme = packages("planar-array")["etching"]
    assert {row["certificate"] for row in lines.values()} == {"EN 10204 3.1"} and "EN 10204 3.1" in readme


def test_orders_name_temper_plate_and_thickness_of_the_oxide():
    wire, sheet, machined = (
        packages("macro-array")[w][0] for w in ("wire-cutting", "sheet", "milling-and-turning")
    )
    assert {row["certificate"] for row in (*wire.values(), *sheet.values())} == {"EN 10204 3.1"}
    assert machined["stop-plate"]["material"] == "X46Cr13 (1.4034) +A"
    assert machined["end-plate-head"]["material"] == "6061-T651"
    spacer = wire["spacer"]  # after its sheet is measured, in packs of one pass
    assert "4 less what the elements' sheet measures" in spacer["after"]
    assert spacer["passes"] == "1" and int(spacer["at_once"]) > 1


@pytest.mark.parametrize("name", ["macro-array", "planar-array", "jaw-array"])
def test_what_is_anodised_states_how_thick(name):
    finishes = [row["finish"] for row in packages(name)["milling-and-turning"][0].values()]
    coated = [f for f in finishes if re.search(r"(?<!not )anodised", f)]
    assert coated and all(re.search(r"anodised \d+ um", f) for f in coated)


def test_a_stage_whose_drawing_nobody_read_says_so_to_its_buyer():
    stages = [row for n, row in bill("calibration").items() if re.fullmatch(r"STAGE-.*-FIXED", n)]
    assert stages
    for row in stages:
        assert row["source_verified"] == "unread" and "no maker's drawing read" in row["standard_designation"]


@pytest.mark.parametrize("name", DESIGNS)
def test_what_no_standard_names_has_one_make_as_an_example(name):
    design = load(name)
    for row in (row for s in scene_names(design) for row in bom_rows(make_scene(design, s), None, {})):
        told = row.mpn or row.process != "bought" or not row.has_solid
        if told or re.match(r"(ISO|DIN) \d", row.standard_designation):
            assert "example" not in row.alternates, row.part_no
            continue
        make = r"example: \S.*; drawing (read|unread)(?=;|$)|no example found(?=;|$)"
        said = re.match(make, row.alternates)
        assert said and (said[1] == "read") == row.source_verified, row.part_no


def test_the_guide_has_the_dimensions_of_the_make_whose_drawing_was_read():
    """HIWIN G99TE20-1808, section 2-4-18: MGN 9C and its rail, H, H1, W, B, C, L, M x l, HR, D, h, d, P."""
    parts = make_scene(load("macro-array"), "grasping").parts
    rail, carriage = (next(p for p in parts if p.part_no.startswith(kind)) for kind in ("RAIL", "CARRIAGE"))
    x0, y0, x1, y1 = carriage.body.outer.box
    assert (y1, y0, x1 - x0, carriage.body.thickness, carriage.mass) == (10, 2, 20, 28.9, 16)
    at = sorted((h.at[0], h.at[2]) for h in carriage.features)
    assert (at[-1][0] - at[0][0], at[1][1] - at[0][1]) == pytest.approx((15, 10))
    assert {(h.thread, h.depth) for h in carriage.features} == {("M3", 3)}
    ys = [h.at[1] for h in rail.features]
    assert {b - a for a, b in zip(ys, ys[1:])} == {20} and rail.body.thickness == 6.5
    assert {(h.counterbore, h.diameter) for h in rail.features} == {((6, 3.5), 3.5)}


@cache
def made(name: str) -> dict[str, Part]:
    design = load(name)
    parts = [p for scene in scene_names(design) for p in make_scene(design, scene).parts]
    return {p.part_no.removeprefix(f"{name}-"): p for p in parts if p.process in PROCESSES}


@pytest.mark.by_day(2, "all sheets of a design each")
@pytest.mark.parametrize("name", DESIGNS)
def test_material_and_finish_are_not_in_the_letters_of_the_headings(name):
    for number, part in made(name).items():
        block = [i for i in title_block(A4, title_of(load(name), part, False)) if isinstance(i, Text)]
        texts = [t.text for t in block]
        for heading, after in (("Material and temper", "Mass"), ("Surface finish", "Dimensions")):
            cell = block[texts.index(heading) + 1 : texts.index(after)]
            assert all(t.height >= 2.5 for t in cell), (number, [t.text for t in cell])


@cache
def sheet(number: str) -> tuple[DrawnSheet, list[str]]:
    """A sheet of the macro array, and the texts of its PDF."""
    from tactcad.solids.step import to_bytes

    part = made("macro-array")[number]
    drawn = part_sheet(Order(load("macro-array"), part, to_bytes(shape_of(part)), ()))
    (runs,) = pdf_runs(pdf_bytes([drawn], "title", "author", "2026-11-27"))
    return drawn, runs


@pytest.mark.cad
def test_the_tongue_has_a_detail_large_enough_to_read_and_the_pins_hole_its_fit():
    """0.85 mm of tongue is at least 4 mm on paper."""
    detail = next(re.fullmatch(r"[A-Z] \((\d+):1\)", t) for t in sheet("bonding-nest")[1] if ":1)" in t)
    assert int(detail[1]) * 0.85 >= 4.0
    assert any(t.startswith("⌀3 N7") for t in sheet("riser")[1])


@pytest.mark.cad
def test_no_leader_of_the_riser_ends_on_a_corner():
    """Arrows that end on a straight line of the outline end 2 mm or more from both its ends."""
    drawn, runs = sheet("riser")
    assert runs.count("0.01") == 2
    lines = [c for i in drawn.items if isinstance(i, Stroke) and i.role == "outline" for c in i.chords()]
    long = [(a, b) for a, b in lines if dist(a, b) > 20.0]
    tips = [i.points[0] for i in drawn.items if isinstance(i, Fill) and len(i.points) == 3]
    on = [(t, a, b) for t, (a, b) in product(tips, long) if dist(a, t) + dist(t, b) - dist(a, b) < 1e-6]
    assert len(on) >= 2 and all(min(dist(t, a), dist(t, b)) >= 2.0 for t, a, b in on)
