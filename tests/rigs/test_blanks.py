"""Blanks of every shipped design, read from their DXF files by ezdxf alone: no finished hole is in one, and
there is material on every face and edge that is finished."""

from __future__ import annotations

import io
from dataclasses import replace

import ezdxf
import pytest
from built import shape_of
from variants import FACING_ROWS

from tactcad.contour import rectangle
from tactcad.export.dxf import dxf_bytes
from tactcad.parts.language.description import Extrusion, Hole, Material, Part
from tactcad.parts.language.stock import STAINLESS_PLATE, cut_section, plate_material, stock_of
from tactcad.parts.rules import load
from tactcad.scenes import make_scene, scene_names
from tactcad.solids.measure import bounding_box

# mm, plus and minus: of rolled plate, written down again from EN 485-3 and EN 10051 as issued to a shop
ROLLED = {8: 0.35, 10: 0.45, 12: 0.50, 15: 0.50, 20: 0.60, 25: 0.65, 30: 0.65, 5: 0.32}


def parts_of(name: str) -> dict[str, Part]:
    design = load(name)
    return {p.part_no: p for scene in scene_names(design) for p in make_scene(design, scene).parts}


def read(part: Part) -> list:
    return [*ezdxf.read(io.StringIO(dxf_bytes(part).decode())).modelspace()]


@pytest.mark.by_day(2, "the kernel on a design each")
@pytest.mark.parametrize("name", FACING_ROWS)
def test_a_blank_holds_no_finished_hole_and_material_everywhere(name):
    blanks = [p for p in parts_of(name).values() if p.process in ("milled", "ground") and cut_section(p)]
    assert len(blanks) > 3
    for part in blanks:
        entities = read(part)
        assert [e.dxftype() for e in entities] == ["LINE"] * 4, part.part_no
        xs = [v for e in entities for v in (e.dxf.start.x, e.dxf.end.x)]
        ys = [v for e in entities for v in (e.dxf.start.y, e.dxf.end.y)]
        x0, y0, x1, y1 = part.extrusion.outer.box
        thick = 2.0 if stock_of(part).thickness <= 20 else 3.0
        for left in (x0 - min(xs), y0 - min(ys), max(xs) - x1, max(ys) - y1):
            assert left == pytest.approx(thick), part.part_no
        # the thinnest plate that is delivered still has both faces to machine
        stock, most = stock_of(part), part.extrusion.thickness + 0.05
        each = 0.2 if part.process == "ground" else 0.5
        assert stock.thickness - ROLLED[stock.thickness] - most >= 2 * each - 1e-9, part.part_no


def test_a_hole_is_dropped_for_what_it_is_and_not_for_its_text():
    design = load("macro-array")
    head = parts_of("macro-array")["macro-array-end-plate-head"]
    assert {f.tolerance for f in head.features if f.name == "dowel_hole"} == {""}  # limits stand elsewhere
    assert cut_section(head).openings == ()
    plain = Part(
        "P",
        "plate",
        "milled",
        plate_material(design),
        Extrusion(rectangle(0, 0, 30, 20), 4.0),
        (Hole("any", (10.0, 10.0, 0.0), (0, 0, 1), 1.0, 4.0, True),),
    )
    assert cut_section(plain).openings == ()
    assert cut_section(replace(plain, process="wire-cut", material=STAINLESS_PLATE)).openings != ()


@pytest.mark.cad
def test_the_solid_lies_in_its_blank():
    part = parts_of("macro-array")["macro-array-carrier"]
    low, high = bounding_box(shape_of(part))
    x0, y0, x1, y1 = cut_section(part).outer.box
    assert (x0, y0) < (low[0] - 1.9, low[1] - 1.9) and (x1, y1) > (high[0] + 1.9, high[1] + 1.9)


def test_wire_cut_sheet_is_picked_and_other_wire_cut_parts_are_ground_to_size():
    parts = parts_of("macro-array")
    element, spacer = (stock_of(parts[f"macro-array-{n}"]) for n in ("element-a4mm", "spacer"))
    assert (element.thickness, element.face) == (3.0, 0.0)
    assert (spacer.thickness, spacer.lower, spacer.upper, spacer.face) == (1.0, 0.99, 1.01, 0.0)
    for n, sold in (("bonding-nest", 20), ("bonding-clamp", 15), ("tip-roller", 12)):
        assert (stock_of(parts[f"macro-array-{n}"]).thickness, stock_of(parts[f"macro-array-{n}"]).face) == (
            sold,
            0.2,
        )


@pytest.mark.parametrize("name", FACING_ROWS)
def test_a_material_is_ordered_by_the_standard_of_its_form(name):
    """EN 485-2: rolled aluminium; EN 755-2: extruded bar; EN 10088-2: stainless sheet and plate; -3: bar."""
    for part in parts_of(name).values():
        if part.process not in ("wire-cut", "milled", "turned", "ground"):
            continue
        round_ = part.process == "turned" or part.extrusion.outer.as_circle() is not None
        bar, flat = ("EN 755-2", "EN 10088-3", "EN 10025-2"), ("EN 485-2", "EN 10088-2", "EN 10151")
        assert part.material.standard.startswith(bar if round_ else flat), part.part_no
        if part.process == "milled" and not round_:
            assert part.material.name.endswith("-T651")  # stretched: flat when one side is milled off


def test_spring_steel_is_not_ordered_to_the_limits_of_hot_rolled_sheet():
    """EN 10051 is of hot-rolled flat steel; 1.4310 is cold-rolled strip (EN 10151)."""
    element = next(p for p in make_scene(load("macro-array"), "array").parts if p.kind == "element")
    strip = replace(element, material=Material("1.4310-C1300", 7900, standard="EN 10151 (X10CrNi18-8)"))
    assert [stock_of(p).standard for p in (element, strip)] == ["EN 485-4", ""]
