"""Every statement of the gates that hold a written STEP file, or a built part, against the description."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tactcad.design.messages import CheckFailure
from tactcad.export import step_file as step
from tactcad.export.products import _compare_box
from tactcad.export.step_text import Header

pytestmark = pytest.mark.cad

HEADER = Header("macro", "an array", "B", "2026-11-21", "a", "b")


@pytest.fixture(scope="module")
def written(macro_scene, macro_shapes):
    part = macro_scene.parts[0]
    return part, step.part_step(part, macro_shapes[part.part_no], HEADER)


def test_a_good_file_passes(written):
    part, data = written
    step.check_part(data, step.read_assembly(data), part)
    assert step.read_assembly(data).name == part.part_no


def test_what_is_no_step_file_cannot_be_read(written):
    with pytest.raises(CheckFailure, match="cannot be read back"):
        step.read_assembly(b"ISO-10303-21;\nnothing of the kind")


def test_two_shapes_beside_each_other_are_no_assembly(tmp_path):
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer

    writer = STEPControl_Writer()
    for size in (1.0, 2.0):
        writer.Transfer(BRepPrimAPI_MakeBox(size, size, size).Shape(), STEPControl_AsIs)
    writer.Write(str(tmp_path / "two.step"))
    with pytest.raises(CheckFailure, match="2 top-level shapes instead of one"):
        step.read_assembly((tmp_path / "two.step").read_bytes())


@pytest.mark.parametrize(
    "entity, found", [("PRODUCT", 2), ("NEXT_ASSEMBLY_USAGE_OCCURRENCE", 1), ("MANIFOLD_SOLID_BREP", 2)]
)
def test_a_part_file_has_its_entities_once(entity, found, written):
    part, data = written
    with pytest.raises(CheckFailure, match=f"has {found} {entity}, not {found - 1}"):
        step.check_part(data + f"\n/* #1={entity}( */".encode(), step.read_assembly(data), part)


def test_a_part_file_bears_its_number(written):
    part, data = written
    with pytest.raises(CheckFailure, match=f"reads back as '{part.part_no}', valid: True"):
        step.check_part(data, step.read_assembly(data), replace(part, part_no="another"))


def test_a_solid_is_as_large_as_its_description(written):
    part, _ = written
    low, high = part.body.box
    _compare_box(part, (low, high))
    with pytest.raises(CheckFailure, match="bounding box is 2e-06 mm from"):
        _compare_box(part, (low, (*high[:2], high[2] + 2e-6)))


def test_an_assembly_has_as_many_instances_as_the_scene(macro_scene):
    count = len(macro_scene.placements)
    with pytest.raises(CheckFailure, match=f"has 0 instances, not {count}"):
        step._check_instances((), macro_scene.placements, "array")
