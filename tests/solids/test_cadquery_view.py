"""Parts and scenes for people who work in CadQuery, and their models as bought parts of ours."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from math import pi

import cadquery as cq
import numpy as np
import pytest

from tactcad.checks.on_solids.interference import check_interference
from tactcad.design.messages import InputError
from tactcad.drawing.engine import picture
from tactcad.export import shapes as shapes_of
from tactcad.export import step_file as step
from tactcad.export.cache import Cache
from tactcad.export.step_text import Header
from tactcad.parts.language.description import Material, Purchase
from tactcad.scenes import bom
from tactcad.scenes.scene import Contact, Placement, Scene
from tactcad.solids.build import build
from tactcad.solids.cadquery_view import assembly, bought_from_cadquery, bought_from_step, workplane
from tactcad.solids.measure import volume

pytestmark = pytest.mark.cad

HEADER = Header("scene", "a scene", "A", "2026-11-21", "tactcad", "tactcad")
BRASS = Material("brass", 8500.0)
ORDER = Purchase("spring plunger M3", manufacturer="Nobody", mpn="1")


def test_any_part_is_a_workplane(macro_scene):
    for part in macro_scene.parts:
        plane = workplane(part)
        assert isinstance(plane, cq.Workplane) and plane.solids().size() == 1
        assert plane.val().isValid()
        assert plane.val().Volume() == pytest.approx(part.volume, rel=1e-9)
        assert tuple(plane.val().Center().toTuple()) == pytest.approx(part.centre, abs=1e-8)


def test_a_workplane_can_be_worked_on(macro_scene):
    """Whoever works in CadQuery drills a hole into our stop plate, by CadQuery's own means."""
    plate = next(p for p in macro_scene.parts if p.part_no.endswith("stop-plate"))
    drilled = workplane(plate).faces(">Z").workplane(centerOption="CenterOfBoundBox").hole(2.0)
    thick = plate.body.thickness
    assert drilled.val().Volume() == pytest.approx(plate.volume - pi * thick, rel=1e-9)


@pytest.fixture(scope="module")
def whole(macro_scene) -> cq.Assembly:
    return assembly(macro_scene)


def test_the_assembly_has_the_scenes_names_colours_and_places(macro_scene, whole):
    assert whole.name == macro_scene.name
    children = {c.name: c for c in whole.children}
    assert list(children) == [p.designator for p in macro_scene.placements]
    for p in macro_scene.placements:
        child = children[p.designator]
        assert child.metadata["part_no"] == p.part.part_no
        t = child.loc.wrapped.Transformation()
        got = np.array([[t.Value(r, c) for c in (1, 2, 3, 4)] for r in (1, 2, 3)])
        assert np.allclose(got, np.column_stack([np.array(p.rotation, float), p.origin]), atol=1e-12)
        assert child.color.toTuple()[3] == 1.0
    solids = whole.toCompound().Solids()
    assert len(solids) == len(macro_scene.placements)
    assert sum(s.Volume() for s in solids) == pytest.approx(
        sum(p.part.volume for p in macro_scene.placements), rel=1e-9
    )
    assert len({id(c.obj) for c in whole.children}) == len(macro_scene.parts), "equal parts share one solid"


def test_cadquerys_own_step_export_has_our_colours(macro_scene, whole, tmp_path):
    """Written by CadQuery, read as text: the colours are the descriptions', in sRGB as every STEP reader
    takes them."""
    import re

    path = tmp_path / "cq.step"
    whole.export(str(path))
    written = {
        tuple(round(255 * float(v)) for v in m)
        for m in re.findall(
            r"COLOUR_RGB\('',([\d.E+-]+),([\d.E+-]+),([\d.E+-]+)\)", path.read_text().replace("\n", "")
        )
    }
    assert written == {tuple(int(p.colour[i : i + 2], 16) for i in (1, 3, 5)) for p in macro_scene.parts}


# --- models from CadQuery as bought parts ---


def plunger() -> cq.Workplane:
    return cq.Workplane("XY").circle(1.5).extrude(8).faces(">Z").workplane().circle(0.75).extrude(1.5)


VOLUME = pi * (1.5**2 * 8 + 0.75**2 * 1.5)


@pytest.fixture
def bought(tmp_path):
    return bought_from_cadquery(
        plunger(), tmp_path / "plunger.step", "PLUNGER-M3", "Spring plunger", BRASS, ORDER
    )


def test_a_cadquery_model_becomes_a_bought_part(bought, tmp_path):
    assert bought.bought and bought.volume == pytest.approx(VOLUME, rel=1e-9)
    assert bought.mass == pytest.approx(VOLUME * 8.5e-3, rel=1e-9)
    assert bought.body.sha256 == hashlib.sha256((tmp_path / "plunger.step").read_bytes()).hexdigest()
    assert volume(build(bought)) == pytest.approx(VOLUME, rel=1e-9)
    same = bought_from_step(tmp_path / "plunger.step", "PLUNGER-M3", "Spring plunger", BRASS, ORDER)
    assert same == bought


def test_it_stands_in_a_scene_with_all_that_comes_of_it(bought, macro_scene, macro_shapes):
    """Placed on the carrier: interference, STEP, bill of materials, CadQuery's view and pictures all know
    it."""
    carrier = next(p for p in macro_scene.placements if p.designator == "CA1")
    top = carrier.origin[2] + carrier.part.body.thickness
    placement = Placement("PL1", bought, (0.0, 0.0, top))
    scene = Scene(
        "more", (*macro_scene.placements, placement), (*macro_scene.contacts, Contact("PL1", "CA1", "touch"))
    )
    shapes = {**macro_shapes, bought.part_no: build(bought)}
    assert check_interference(scene, shapes) == []
    sunk = replace(
        scene, placements=(*macro_scene.placements, replace(placement, origin=(0.0, 0.0, top - 1)))
    )
    assert [f.check for f in check_interference(sunk, shapes)] == ["overlap"]

    text = step.scene_step(scene, shapes, HEADER).decode("ascii")
    assert "NEXT_ASSEMBLY_USAGE_OCCURRENCE('PL1','PL1'" in text
    assert step.part_step(bought, shapes[bought.part_no], HEADER)

    row = next(r for r in bom.bom_rows(scene, None, {}) if r.part_no == "PLUNGER-M3")
    assert (row.qty, row.make_buy, row.has_solid) == (1, "buy", True)
    assert [c.name for c in assembly(scene).children][-1] == "PL1"


def test_a_picture_with_it_shows_it_whole(bought, macro_scene, tmp_path):
    """A model that stands out of everything else: the picture is checked against its extent too."""
    placements = (*macro_scene.placements, Placement("PL1", bought, (0.0, 0.0, 60.0)))
    shapes = shapes_of.Shapes(Cache(tmp_path / "cache"), "test")
    drawn = shapes_of.picture_bytes(placements, "front", shapes, "t", "d").decode()
    height = float(drawn.split('viewBox="0 0 ')[1].split('"')[0].split()[1]) - 2 * picture.MARGIN
    lowest = min(p.origin[2] for p in macro_scene.placements) - 2.0  # the pads
    assert height == pytest.approx(60 + 9.5 - lowest, abs=0.1)
    alone = (Placement("PL1", bought),)
    assert shapes_of.picture_bytes(alone, "oblique", shapes, "t", "d")


def test_what_is_not_one_solid_is_refused(tmp_path):
    two = cq.Workplane("XY").box(1, 1, 1).add(cq.Workplane("XY").box(1, 1, 1).translate((5, 0, 0))).combine()
    for model in (two, cq.Workplane("XY").rect(1, 1)):
        with pytest.raises(InputError, match="one solid"):
            bought_from_cadquery(model, tmp_path / "x.step", "X", "x", BRASS, ORDER)
        assert not (tmp_path / "x.step").exists()
    two.val().exportStep(str(tmp_path / "two.step"))
    with pytest.raises(InputError, match="one solid"):
        bought_from_step(tmp_path / "two.step", "X", "x", BRASS, ORDER)


def test_model_files_that_are_gone_changed_or_no_step(bought, tmp_path):
    path = tmp_path / "plunger.step"
    data = path.read_bytes()
    path.write_bytes(data.replace(b"1.5", b"1.4"))
    with pytest.raises(InputError, match="changed"):
        build(bought)
    path.unlink()
    with pytest.raises(InputError, match="no such"):
        build(bought)
    with pytest.raises(InputError, match="no such"):
        bought_from_step(tmp_path / "nowhere.step", "X", "x", BRASS, ORDER)
    (tmp_path / "text.step").write_text("not a STEP file")
    with pytest.raises(InputError):
        bought_from_step(tmp_path / "text.step", "X", "x", BRASS, ORDER)
