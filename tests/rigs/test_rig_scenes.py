"""Scenes: what they place, that they build only that, their configurations and guides."""

from __future__ import annotations

import dataclasses
import json
import re
from io import StringIO
from math import cos, hypot, sin

import pytest
from built import shape_of
from variants import variant

from tactcad.cli.main import main
from tactcad.cli.streams import progress
from tactcad.design.messages import InputError
from tactcad.drawing import guide
from tactcad.drawing.assemblies.arrangement import notes_of
from tactcad.export.formats import ExportOptions
from tactcad.export.pipeline import export
from tactcad.export.products import _compare_box
from tactcad.parts.array.element import deflected_element, deflection_at_pad_edge
from tactcad.parts.array.layout import Layout
from tactcad.parts.bought.screws import seating_torque
from tactcad.parts.rigs.frame import pad_middles
from tactcad.parts.rigs.stand import StandLayout
from tactcad.parts.rigs.stiffness import calibration_loads
from tactcad.parts.rules import load
from tactcad.scenes import make_scene, scene_names
from tactcad.scenes.moves import moments
from tactcad.scenes.rig import pose_of, poses
from tactcad.scenes.rigs.calibration import check_travel
from tactcad.scenes.scene import Pose, Scene
from tactcad.solids.build import build
from tactcad.solids.measure import measure, volume

RIGS = ("calibration", "sample-stiffness", "grasping")
# what a workshop cuts from plate; the rest is turned, milled from a block or a bar, or bought
PLATES = {
    "end-plate-head",
    "end-plate-tapped",
    "stop-plate",
    "carrier",
    "base",
    "axis-plate",
    "gauge-plate",
    "array-mount",
    "cart-plate",
    "holder-lid",
    "foot",
    "bar",
    "platform",
    "post",
    "riser",
}
DESIGNS = ("macro-array", "double-sample", "smallest-bearing")


@pytest.mark.parametrize("name", DESIGNS)
def test_every_rig_part_is_the_solid_that_its_description_says(name):
    design = load(name)
    parts = {p.part_no: p for scene in RIGS for p in make_scene(design, scene).parts}
    for part in parts.values():
        facts = measure(shape_of(part))  # build has compared the volume
        assert facts["centre"] == pytest.approx(part.centre, abs=1e-6), part.part_no
        _compare_box(part, facts["box"])


@pytest.mark.slow  # by day the array's: tests/cli/test_profile.py
@pytest.mark.parametrize("scene", RIGS)
def test_an_export_of_one_scene_builds_its_parts_once_each_and_no_others(scene, tmp_path, monkeypatch):
    monkeypatch.setenv("TACTCAD_CACHE", str(tmp_path / "cache"))
    design = load("smallest-bearing")
    done = export(design, ExportOptions((scene,)), tmp_path / "out", progress(StringIO()))
    assert sorted(done.built) == sorted(p.part_no for p in make_scene(design, scene).parts)
    bill = json.loads((tmp_path / f"out/bom-{scene}.json").read_text())["rows"]
    assert sum(row["qty"] for row in bill if row["has_solid"]) == len(make_scene(design, scene).placements)
    read = {row["part_no"] for row in bill if row["make_buy"] == "buy" and row["source_verified"]}
    # numbers and dimensions read at the maker's
    assert read <= {
        "ADHESIVE",
        "GAUGE-TAPE",
        "SURFACE-PREPARATION",
        "CARRIAGE-9-UNSEALED",
        "RAIL-9x100-guide",
    }
    cut = {
        p.part_no
        for p in make_scene(design, scene).parts
        if p.process == "wire-cut" or p.part_no.removeprefix("smallest-bearing-") in PLATES
    }
    assert {p.stem.rsplit("_", 1)[0] for p in (tmp_path / "out").glob("dxf/*.dxf")} == cut
    again = export(design, ExportOptions((scene,)), tmp_path / "out", progress(StringIO()))
    assert (again.made, again.built) == ((), ())
    # envelopes cost less and weigh the same
    export(design, ExportOptions((scene,), detail="envelope"), tmp_path / "envelopes", progress(StringIO()))
    full, envelope = (
        next((tmp_path / out).glob(f"step/smallest-bearing-{scene}_*.step")) for out in ("out", "envelopes")
    )
    assert envelope.stat().st_size < full.stat().st_size / 2
    assert not list((tmp_path / "envelopes").glob("dxf/*"))
    light = json.loads((tmp_path / f"envelopes/bom-{scene}.json").read_text())["rows"]
    assert [(r["part_no"], r["mass_g"]) for r in light] == [(r["part_no"], r["mass_g"]) for r in bill]


@pytest.mark.parametrize("number", range(1, 11))
def test_each_element_comes_under_the_force_gauge(number):
    """Its pad's middle, placed, lies on the gauge's axis at the roller's lowest line."""
    design = load("macro-array")
    scene = make_scene(design, "calibration", Pose(element=number))
    layout = Layout(design)
    (p,) = (p for p in scene.placements if p.designator == f"E{number}")
    local = (
        (layout.pad_inner + layout.pad_outer) / 2,
        -design.element.pad_height,
        design.sheet.thickness / 2,
    )
    at = [sum(r * c for r, c in zip(row, local)) + o for row, o in zip(p.rotation, p.origin)]
    assert at == pytest.approx([0.0, 0.0, StandLayout(design).pads_up], abs=1e-9)
    (gauge,) = (p for p in scene.placements if p.designator == "FG1")
    assert gauge.origin[:2] == (0.0, 0.0)


def test_an_element_that_is_not_there_is_refused():
    with pytest.raises(InputError, match="element"):
        make_scene(load("smallest-bearing"), "calibration", Pose(element=5))


def test_pads_face_each_other_across_the_middle():
    pads = pad_middles(Layout(load("macro-array")))
    assert [x for x, _ in pads] == [2.0] * 5 + [-2.0] * 5
    assert [y for _, y in pads[:5]] == [y for _, y in pads[5:]] == [-8, -4, 0, 4, 8]


def test_the_axis_hangs_over_the_sample_at_every_height():
    design = load("macro-array")
    rest, lifted = (make_scene(design, "grasping", Pose(height=h, weights=0)) for h in (0.0, 20.0))
    axis = dict(rest.groups)["axis"]
    for a, b in zip(rest.placements, lifted.placements):
        moved = b.origin[2] - a.origin[2]
        assert moved == pytest.approx(20.0 if a.designator in axis else 0.0), a.designator


@pytest.mark.parametrize("weights", [0, 1, 7])
def test_weights_lie_on_each_other(weights):
    scene = make_scene(load("macro-array"), "grasping", Pose(weights=weights))
    discs = [p for p in scene.placements if p.designator.startswith("WT")]
    assert len(discs) == weights
    for p in discs:  # as high as its mass asks for
        assert volume(shape_of(p.part)) * p.part.material.density * 1e-6 == pytest.approx(100.0, rel=1e-3)
    heights = [p.origin[2] for p in discs]
    assert all(b - a == pytest.approx(discs[0].part.body.thickness) for a, b in zip(heights, heights[1:]))


def test_a_rolled_cart_moves_alone():
    design = load("macro-array")
    rest, rolled = (make_scene(design, "sample-stiffness", Pose(cart=x)) for x in (0.0, 4.0))
    cart = dict(rest.groups)["cart"]
    for a, b in zip(rest.placements, rolled.placements):
        assert b.origin[0] - a.origin[0] == pytest.approx(4.0 if a.designator in cart else 0.0)


@pytest.mark.parametrize("sides", ["one", "two"])
def test_the_roller_leaves_the_pad_where_the_turned_face_ends(sides):
    """At that deflection the foot of the roller's axis on the turned face is the face's inner end."""
    two = {"element.body_height": 5.0} if sides == "two" else {}
    layout = Layout(
        variant({"element.sides": sides, "element.pad_length": 1.0, "array.row_arms": [[3.0]], **two})
    )
    place, r = layout.elements[0], 1.5
    deflection = deflection_at_pad_edge(layout, place, r)
    (face,) = (s for s in deflected_element(layout, place, deflection, r).body.outer if s.name == "pad_face")
    axis = ((layout.pad_inner + layout.pad_outer) / 2, -layout.design.element.pad_height - r + deflection)
    inner = min(face.start, face.end, key=lambda p: abs(p[0] - place.hinge_x))
    assert hypot(inner[0] - axis[0], inner[1] - axis[1]) == pytest.approx(r, abs=1e-9)


@pytest.mark.parametrize("number", [1, 4])
@pytest.mark.parametrize("deflection", [0.02, 0.08])
def test_a_pressed_pad_touches_the_roller(number, deflection):
    """The roller's axis has come up by the deflection; the pad's face is its radius away, by the turned face
    itself."""
    layout = Layout(load("macro-array"))
    place, r = layout.elements[number - 1], 1.0025
    part = deflected_element(layout, place, deflection, r)
    (face,) = (s for s in part.body.outer if s.name == "pad_face")
    axis = ((layout.pad_inner + layout.pad_outer) / 2, -layout.design.element.pad_height - r + deflection)
    (x0, y0), (x1, y1) = face.start, face.end
    away = abs((x1 - x0) * (axis[1] - y0) - (y1 - y0) * (axis[0] - x0)) / face.length
    assert away == pytest.approx(r, abs=1e-9)
    build(part)  # refuses an invalid solid
    assert part.process == "reference"
    angle = deflection / place.load_arm
    (tip,) = (s for s in part.body.outer if s.name == "tip")
    lever = layout.ledge - place.hinge.t / 2
    rise = tip.start[1] - (layout.ledge - _gap(layout, place))
    assert rise == pytest.approx(place.arm * sin(angle) - lever * (1 - cos(angle)), rel=0.02)


def _gap(layout, place):
    from tactcad.parts.array.stop_gap import stop_gap

    return stop_gap(layout, place)


def test_calibration_shares_its_travel_between_gauge_and_element():
    design = load("macro-array")
    for one in calibration_loads(design):
        # the force that bends the element is the one that bends the gauge, over the rest of the travel
        assert one.force == pytest.approx(
            design.calibration.load_cell_stiffness * (design.calibration.travel - one.deflection)
        )
        assert one.force < design.calibration.load_cell_range
        assert 0 < one.deflection and design.calibration.travel < one.travel_at_yield
        # the same travel split the same way at the rated deflection and at yield, which is its factor away
        assert one.travel_at_rated * one.deflection == pytest.approx(
            design.calibration.travel * one.rated_deflection
        )
        assert one.travel_at_yield == pytest.approx(one.travel_at_rated * design.rating.deflection_factor)


def test_the_calibration_has_no_stop_plate_and_the_array_s_guide_says_when_it_comes():
    """With it the stops of the short arms would close on the way: that is why."""
    design = load("macro-array")
    layout = Layout(design)
    placed = {p.designator for p in make_scene(design, "calibration").placements}
    whole = {p.designator for p in make_scene(design, "array").placements}
    assert {d for d in whole - placed} == {"ST1", *(d for d in whole if d.startswith("SS"))}
    closing = {
        s.place.arm
        for s in calibration_loads(design)
        if s.deflection > _gap(layout, s.place) * s.place.load_arm / s.place.arm
    }
    assert closing == {4.0, 5.0}
    texts = {step.title: step.text for step in make_scene(design, "array").steps}
    assert "without stop plate" in texts["Stop plate"]
    *_, pressed, last = make_scene(design, "calibration").steps
    assert "stop plate" in last.title and "arm 4 carries 3.42 N and would yield at 179 um" in pressed.text


@pytest.mark.parametrize(
    ("changes", "severity"),
    [
        ({"calibration.travel": 0.149}, None),
        ({}, "flag"),  # the paper's 150 um, 0.2 um beyond
        ({"calibration.travel": 0.20}, "fail"),
        ({"material.alloy": "soft", "material.yield_strength": 275}, "fail"),
    ],
)
def test_a_calibration_beyond_the_rated_deflection_is_seen(changes, severity):
    found = check_travel(variant(changes), None)
    assert (found == []) is (severity is None)
    assert not found or found[0].severity == severity
    for f in found:
        assert f.value > f.limit and "calibrate it to" in f.message


def test_there_is_a_pose_for_every_element():
    design = load("macro-array")
    assert [p.element for p in poses(design, "calibration")] == list(range(1, 11))


@pytest.mark.parametrize("row_arms", [[[5]], [[4, 7], [6, 8]]])
def test_a_part_number_is_one_part_in_every_scene_and_pose(row_arms):
    """One arm's pad dents the sample as the force gauge's tip does, in another place: the kernel's shapes go
    by number."""
    design = variant({"array.row_arms": row_arms, "clamp.mount_pitch_y": 24.0})
    known = {}
    for name in scene_names(design):
        for pose in (None, *poses(design, name)):
            for part in make_scene(design, name, pose).parts:
                assert known.setdefault(part.part_no, part) == part
    assert sum("-pressed-" in number for number in known) >= 3


@pytest.mark.parametrize(
    ("text", "pose"),
    [
        ("element=3", Pose(element=3)),
        ("deflection=0.1", Pose(deflection=0.1)),
        ("weights=0", Pose(weights=0)),
        ("height=5", Pose(height=5.0)),
        ("cart=-2.5", Pose(cart=-2.5)),
    ],
)
def test_poses_on_the_command_line(text, pose):
    assert pose_of([text], load("macro-array")) == pose


@pytest.mark.parametrize(
    "text",
    ["element=11", "element=0", "element=1.5", "height=nan", "cart=6", "weights=11", "tilt=1", "element"],
)
def test_impossible_poses_are_refused(text, capsys):
    assert main(["export", "macro-array", "--scene", "calibration", "--pose", text, "--out", "nowhere"]) == 2
    assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.parametrize("name", ["macro-array", "soft-tissue", "smallest-bearing"])
def test_a_guide_places_every_part_once_and_shows_its_torques(name):
    design = load(name)
    for scene_name in scene_names(design):
        scene = make_scene(design, scene_name)
        placed = [d for step in scene.steps for d in step.designators]
        assert sorted(placed) == sorted(p.designator for p in scene.placements)
        page = re.sub('<p class="note">.*?</p>', "", guide.page(design, scene).decode())  # Fixes: E1 ...
        ready = {d for step in scene.steps for d in step.ready}  # put together before, by its own guide
        supplies = {*scene.supplies} - {s for before in scene.ready for s in before.supplies}
        assert page.count("<h2>") == len(scene.steps) + 1 + bool(supplies)  # and the tools
        for p in scene.placements:
            listed = bool(re.search(rf"[> ]{p.designator}[< ]", page))
            assert listed == (p.designator not in ready), p.designator
        for p in scene.placements:
            if p.part.part_no.startswith("ISO4762-M3"):
                assert guide.torque(p.part, design) == 0.55
            if p.part.part_no.startswith("ISO4026-"):
                assert 0.3 * 0.55 < guide.torque(p.part, design) < 0.4 * 0.55
        assert "http" not in page  # opens offline


def test_set_screws_are_turned_in_by_their_size():
    """A third of what a cap screw of the size bears, in the step and in the part's row."""
    page = guide.page(design := load("macro-array"), make_scene(design, "array")).decode()
    assert "crosswise, to 0.2 N m, locked" in page and "<td>0.2 N m</td>" in page
    assert [seating_torque(size) for size in ("M2", "M3", "M4", "M5")] == [0.05, 0.2, 0.4, 0.8]


def test_set_screws_of_a_long_array_do_not_bow_it():
    """Ten a row bear 0.1 N m; with 25 a row they only touch, in the step, its part's row and the drawing's
    note."""
    ten, many = (variant({"array.row_arms": [[4, 7, 6, 8, 6] * n, [8, 5, 4, 5, 7] * n]}) for n in (2, 5))
    assert "crosswise, to 0.1 N m, locked" in guide.page(ten, make_scene(ten, "array")).decode()
    scene = make_scene(many, "array")
    assert (
        "crosswise, until they touch the stop plate and no further, locked"
        in guide.page(many, scene).decode()
    )
    assert any(n.startswith("Turn set screws in until they touch") for n in notes_of(many, scene))


def test_the_array_guide_says_how_pads_become_coplanar_and_how_that_is_measured():
    (step,) = (s for s in make_scene(load("macro-array"), "array").steps if s.title == "Coplanar pads")
    for word in ("surface plate", "feelers, 2 mm nominal", "lever indicator", "20 um", "calibration set-up"):
        assert word in step.text
    rigs = dict.fromkeys(("cart", "holder", "sample", "calibration", "grasping"))
    alone = dataclasses.replace(load("macro-array"), **rigs)
    assert not any("calibration" in s.text for s in make_scene(alone, "array").steps)


def test_an_exploded_view_pulls_every_part_out_along_its_step():
    scene = make_scene(load("macro-array"), "grasping")
    out = {p.designator: p.origin for p in guide.exploded(scene)}
    rest = {p.designator: p.origin for p in scene.placements}
    for step in scene.steps:
        for d in step.designators:
            way = [b - a for a, b in zip(rest[d], out[d])]
            shares = [w / e for w, e in zip(way, step.explode) if e]
            assert all(0.5 < s <= 1 + 1e-9 for s in shares)
    standing, coming = guide.at_step(scene, moments(scene), 3)
    assert {p.designator for p in coming} == set(scene.steps[2].designators)
    assert {p.designator for p in standing} == {d for s in scene.steps[:2] for d in s.designators}


def test_steps_that_forget_a_part_are_refused():
    scene = make_scene(load("macro-array"), "array")
    with pytest.raises(ValueError, match="steps"):
        Scene("bad", scene.placements, scene.contacts, steps=scene.steps[:-1])


def test_wheels_touch_the_base_and_only_they():
    scene = make_scene(load("macro-array"), "sample-stiffness")
    low = {p.designator: p.origin[2] for p in scene.placements if p.designator.startswith("BB")}
    assert set(low.values()) == {5.0}  # 623: 10 mm outside
    assert sum(c.second == "BP1" and c.first.startswith("BB") for c in scene.contacts) == 4
    assert all(p.rotation[1] == (0, 0, 1) for p in scene.placements if p.designator.startswith("BB"))


def test_an_array_beyond_the_estimator_still_has_a_calibration():
    """Its strength is flagged as not known, the guide says nothing of it, and poses take it as without
    stiffness."""
    odd = variant(
        {
            "element.hinge_length": 3.0,
            "element.hinge_thickness": 0.02,
            "stop.gaps": {f"{a}": 0.1 for a in range(4, 9)},
        }
    )
    assert all(one.refused for one in calibration_loads(odd))
    assert check_travel(odd, None) == []
    assert {p.deflection for p in poses(odd, "calibration")} == {odd.calibration.travel}
    assert "yield" not in make_scene(odd, "calibration").steps[-1].text
