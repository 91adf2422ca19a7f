"""Sheets of planar parts, read back from their PDF: values against the design by arithmetic of its own."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from built import shape_of

from tactcad.contour import Contour
from tactcad.design.family import family_of
from tactcad.design.load import parse
from tactcad.design.messages import CheckFailure
from tactcad.drawing.engine.layout_check import layout_faults
from tactcad.drawing.engine.sheet_files import pdf_runs
from tactcad.drawing.parts.part_sheet import MadeFrom, Order, part_plan, part_sheet, written
from tactcad.families.planar import cell_array, parts
from tactcad.families.planar.cell_layout import PlanarLayout
from tactcad.families.planar.cell_plan import cell_plan
from tactcad.parts.language.description import NOT_MADE
from tactcad.parts.rules import load
from tactcad.scenes import make_scene, scene_names
from tactcad.solids.step import to_bytes

pytestmark = pytest.mark.cad

DESIGNS = Path(__file__).parents[3] / "hardware"
ETCHED = 0.013  # mm, plus and minus, below 0.13 mm: data/processes.csv, the least


@cache
def layout(name: str) -> PlanarLayout:
    return PlanarLayout(load(str(DESIGNS / f"{name}-array.toml")))


def order(name: str, part) -> Order:
    made = (MadeFrom(f"dxf/{part.part_no}_A.dxf", "f" * 64),)
    return Order(layout(name).design, part, to_bytes(shape_of(part)), made)


@cache
def texts(name: str, part) -> list[str]:
    """Of the sheet's PDF."""
    (runs,) = pdf_runs(written(order(name, part)).pdf)
    return runs


def test_the_jaw_s_foil_by_hand():
    """Opening = pitch - web; a straight beam from the island's edge, a pinwheel's from its ear, to the frame;
    ears stand over their beam by twice the fillet."""
    runs = texts("jaw", parts.foil(layout("jaw")))
    opening = 4.0 - 0.4
    cut = f"±{ETCHED}"
    for text, count in (
        (f"{opening:g}", 2),
        (f"0.4 {cut}", 1),  # straight: beam_width
        (f"{(opening - 1.0) / 2:g} {cut}", 1),
        ("(1)", 1),
        ("16× R0.08", 1),
        ("8× R0.04", 1),  # inside radius of 1 T
        (f"0.2 {cut}", 1),  # pinwheel: beam_width
        (f"{opening / 2 + 1.0 / 2 - 0.35:g} {cut}", 1),
        ("0.18", 1),  # slot
        (f"{2 * 0.06:g}", 1),
        ("(0.35)", 1),
        ("16× R0.06", 1),
        ("0.04 ±0.0015", 1),  # picked by micrometer
    ):
        assert runs.count(text) == count, text
    # spigot 0.35; 2 um of play and the process' tolerance, up to the next 5 um: 0.365
    assert "12× ⌀0.365 ±0.013" in runs
    # places of the outer cells from the edges: border 2.2 or side 1.2, half an opening, whole pitches
    for x in (2.2 + 1.8, 2.2 + 1.8 + 4, 2.2 + 1.8 + 20, 1.2 + 1.8, 1.2 + 1.8 + 4):
        assert f"{x:g}" in runs
    assert any("6 cells as X" in run and "6 as Z" in run for run in [" ".join(runs)])


@pytest.mark.slow  # a sheet of 36 cells
def test_the_bench_array_s_foil_names_its_holes_and_datums():
    """36 cells, holes counted; limits of dowel holes as the process and their places ask: pin 2.008, play
    0.002, places of 0.013 * 57.4/25 = 0.030 and 0.02, cut 0.013: 2.073, up to the next 5 um."""
    drawn = order("planar", parts.foil(layout("planar")))
    sheet = part_sheet(drawn)
    assert layout_faults(sheet) == []
    runs = [t.text for t in sheet.texts]
    assert "2× ⌀2.075 ±0.013" in runs and "12× ⌀2.4 through" in runs and "36× ⌀0.815 ±0.013" in runs
    assert runs.count("⌀0.03 CZ") == 2 and {"A", "B", "C"} <= {*runs}


@pytest.mark.parametrize("name", ["jaw", "planar"])
def test_every_sheet_finds_a_place_for_every_limit(name):
    """Without the kernel: a limit that no dimension states is refused."""
    design = layout(name).design
    every = {part for scene in scene_names(design) for part in make_scene(design, scene).parts}
    made = [part for part in every if part.process not in NOT_MADE]
    assert len(made) == 17
    assert all(part_plan(part, (), family_of(design).plans) for part in made)


def test_a_post_states_its_limits():
    """Turned: pad over foil and foot, fields of spigot and pad below their sizes; shoulder on the foot."""
    lay = layout("jaw")
    runs = texts("jaw", parts.post(lay))
    # cover z: foil, foot, lift; cover; stand-out; less foil and foot
    length = 0.2 + 1.0 + 0.6
    assert f"{length:g} ±0.01" in runs and "⌀1.2 0/-0.02" in runs
    assert "⌀0.35 0/-0.01" in runs and f"{0.04 + 0.2 - 0.02:g}" in runs


@pytest.mark.parametrize("number", [5, 47])
def test_a_cell_that_does_not_repeat_is_refused(number):
    """One corner of one slot a micrometre off, in a cell that the sheet does not enlarge."""
    foil = parts.foil(layout("jaw"))
    body = foil.extrusion
    other = body.openings[number]
    x, y = other.segments[0].start
    moved = [replace(s, start=(s.start[0] + 1e-3 * (s.start == (x, y)), s.start[1])) for s in other]
    moved[-1] = replace(moved[-1], end=moved[0].start)
    openings = (*body.openings[:number], Contour(tuple(moved)), *body.openings[number + 1 :])
    wrong = replace(foil, body=replace(body, openings=openings))
    assert cell_plan(foil, ())
    with pytest.raises(CheckFailure, match="no regular grid"):
        cell_plan(wrong, ())


@pytest.mark.parametrize("off", [1e-6, 3e-6, 7e-6])
def test_sizes_of_odd_nanometres_repeat(off):
    """Their halves are half nanometres, which floats of different places round either way."""
    d = layout("planar").design
    d = replace(
        d,
        planar=replace(d.planar, rows=3, columns=4, pitch=8.0 + off, web=0.6 + 2.0 * off),
        measuring=replace(d.measuring, beam_width=0.4 + off),
    )
    lay = PlanarLayout(d)
    for part in (parts.foil(lay), parts.lower_spacer(lay), parts.upper_spacer(lay)):
        assert cell_plan(part, ())


def test_holes_that_pins_and_spigots_enter_follow_the_process():
    """Worst case by hand: the thickest pin or spigot in the least hole, places at their worst."""
    for name in ("jaw", "planar"):
        lay = layout(name)
        scene = cell_array.scene(lay.design)
        for part in scene.parts:
            limits = {c.name: c for c in part.characteristics}
            thickness = part.extrusion.thickness if hasattr(part.body, "thickness") else 0.0
            if (hole := limits.get("spigot diameter")) and part.process != "turned":
                assert hole.lower >= lay.design.post.spigot + 0.002 - 1e-9
                assert hole.upper - hole.nominal == pytest.approx(max(0.1 * thickness, ETCHED))
            if (hole := limits.get("dowel hole diameter")) and part.name != "Base":
                places = next(g.zone for g in part.geometric if g.features == ("dowel_hole",))
                assert hole.lower >= 2.008 + 0.002 + places + 0.02 - 1e-9, part.part_no
                assert hole.upper - 2.002 < 0.2


def test_stack_names_every_fit_and_all_are_made():
    """Virtual builds by draws within the limits: nothing sticks."""
    import numpy as np

    rng = np.random.default_rng(3)
    for name, fits in (("jaw", 3), ("planar", 8)):
        lay = layout(name)
        known, wanted = cell_array.limits(lay, [])
        made = {k: rng.uniform(v.lower, v.upper, (2000, v.pieces)) for k, v in known.items()}
        built = cell_array.Stacked(lay, made)
        own = [r for r in wanted if re.search(r"enter the|slips over|holds the", r.name)]
        assert len(own) == fits
        for requirement in own:
            assert (requirement.margin(requirement.value(built)) >= 0.0).all(), requirement.name
        parts = {p.part_no: p for s in ("array", "bonding") for p in make_scene(lay.design, s).parts}
        for v in known.values():  # every limit that it names is the part's
            for number, limit in v.stated:
                part = parts[number]
                found = {c.name for c in part.characteristics} | {g.name for g in part.geometric}
                assert limit in found


@pytest.mark.parametrize("off, found", [(0.0, []), (1e-4, ["contact"]), (-1e-3, ["overlap"])])
def test_layers_that_touch_are_told_from_layers_that_do_not(off, found):
    """Foil on the lower spacer: in its place, 0.1 um above it, and 1 um inside it, where the overlap is the
    foil's and the spacer's common area, the frame of both, times 1 um."""
    from tactcad.checks.on_solids.interference import check_interference
    from tactcad.scenes.scene import Contact, Placement, Scene

    text = (DESIGNS / "jaw-array.toml").read_text("utf-8")
    two = text.replace("rows = 2", "rows = 1").replace("columns = 6", "columns = 2")
    lay = PlanarLayout(parse(two, "two.toml"))
    spacer, foil = parts.lower_spacer(lay), parts.foil(lay)
    t = spacer.extrusion.thickness
    placed = (Placement("SP1", spacer, (0.0, 0.0, 0.0)), Placement("F1", foil, (0.0, 0.0, t + off)))
    scene = Scene("pair", placed, contacts=(Contact("SP1", "F1", "touch"),))
    shapes = {p.part_no: shape_of(p) for p in (spacer, foil)}
    findings = check_interference(scene, shapes)
    assert [f.check for f in findings] == found
    if off < 0:
        assert findings[0].value == pytest.approx(spacer.extrusion.section_area * -off, rel=1e-6)


def test_etched_sheets_are_ordered_as_rolled_and_lie_in_no_nest():
    """Strip of the drawn thickness and limits, nothing to come off; etchers lay out their own sheets."""
    from tactcad.parts.language.stock import stock_of
    from tactcad.release.nest import nests

    lay = layout("jaw")
    made = [parts.foil(lay), parts.lower_spacer(lay), parts.foot(lay, lay.used[0])]
    for part, thickness, limit in zip(made, (0.04, 0.035, 0.2), (0.0015, 0.005, 0.02)):
        stock = stock_of(part)
        assert stock and (stock.thickness, stock.face, stock.edge) == (thickness, 0.0, 0.0)
        assert (stock.lower, stock.upper) == pytest.approx((thickness - limit, thickness + limit))
    assert not nests([(part, 1, 1) for part in made], True) + nests([(part, 1, 1) for part in made], False)
