"""What the page says of parts, elements, scenes and findings, without a kernel."""

from __future__ import annotations

import json
import tomllib
from dataclasses import replace
from math import sqrt
from pathlib import Path

import numpy as np
import pytest
from variants import HARDWARE, variant

from tactcad.design.messages import InputError
from tactcad.export.inputs import flattened, nested
from tactcad.fem.elements import solve_plane
from tactcad.fem.face_strain import face_strain
from tactcad.fem.shape import cut_element
from tactcad.lab.array_estimate import estimate
from tactcad.parts.array.element import element
from tactcad.parts.array.hinge_section import design_alloy
from tactcad.parts.array.layout import Layout
from tactcad.parts.language.finding import Finding
from tactcad.review import review_page
from tactcad.review.facts import _fact, element_facts, part_facts, scene_facts
from tactcad.review.review_record import strain_along, strain_field
from tactcad.scenes import make_scene

WRITTEN = tomllib.loads((HARDWARE / "macro-array.toml").read_text("utf-8"))


@pytest.fixture(scope="module")
def facts(macro, macro_scene):
    """Of the array's elements, with the sensor and its stack."""
    return element_facts(macro, (macro_scene,))


@pytest.fixture(scope="module")
def parts(facts, macro_scene):
    _, made, lines = facts
    return {p.part_no: part_facts(p, made.variables, lines) for p in macro_scene.parts}


def distance(part, first: str, second: str) -> float:
    """Between the planes of two features by their points and the first one's normal, mm."""
    a, b = (next(f for f in part["features"] if f["name"] == name) for name in (first, second))
    assert a["kind"] == b["kind"] == "plane"
    return abs(float(np.dot(a["direction"], np.subtract(b["point"], a["point"]))))


def test_limits_and_features_are_the_design_files_values(parts):
    part = parts["macro-array-element-a4mm"]
    wanted, limits = WRITTEN["element"], {c["name"]: c for c in part["limits"]}
    assert limits["hinge thickness"]["nominal"] == wanted["hinge_thickness"] == 0.25
    assert limits["arm length"]["nominal"] == WRITTEN["array"]["row_arms"][0][0]
    assert distance(part, "slot_floor", "flat_face") == pytest.approx(wanted["hinge_thickness"], abs=1e-12)
    assert distance(part, "slot_arm_wall", "slot_body_wall") == pytest.approx(
        wanted["hinge_length"], abs=1e-12
    )
    assert distance(part, "face z=0", "face z=thickness") == WRITTEN["sheet"]["thickness"]
    hole = next(f for f in part["features"] if f["name"] == "dowel_hole")
    limit = limits["dowel hole diameter"]
    assert hole["kind"] == "cylinder" and limit["lower"] <= hole["diameter"] <= limit["upper"]
    assert limit["lower"] == WRITTEN["holes"]["dowel_hole"]
    # a feature's middle lies on its surface
    beside = np.subtract(hole["middle"], hole["point"])
    assert np.linalg.norm(beside[:2]) == pytest.approx(hole["diameter"] / 2, abs=1e-12)


def test_mass_is_density_times_volume(parts):
    part = parts["macro-array-spacer"]
    assert part["mass_g"] == pytest.approx(
        part["volume_mm3"] * WRITTEN["material"]["density"] * 1e-6, rel=1e-12
    )


def test_what_the_sensor_needs_of_an_element(parts, facts):
    """The hinge decides when the stop closes; its share is the stack's."""
    shares = {s["requirement"]: s for s in parts["macro-array-element-a4mm"]["shares"]}
    assert shares and all(0 < s["share"] <= 1 for s in shares.values())
    (line,) = (x for x in facts[2] if x.requirement.name == "pads coplanar")
    own = {c.name: c.share for c in line.contributors}
    for name, share in shares["pads coplanar"]["limits"]:
        variable = {"pad's and ledge's lean": "pad's lean"}.get(name, name)
        assert share == own[f"element: {variable}"]
    assert parts["ISO8734-3x30-pin"]["shares"] == []


def test_pairs_are_formed_with_the_stiffest_element(facts, macro):
    elements, _, _ = facts
    rows = estimate(Layout(macro), "solid")
    K = {f"E{r.number}": r.stiffness for r in rows}
    assert {d: e["estimate"]["stiffness"] for d, e in elements["elements"].items()} == K
    stiffest = max(K.values())
    assert {p["measuring"] for p in elements["pairs"]} == {d for d in K if K[d] < stiffest}
    for p in elements["pairs"]:
        K_r, K_m = p["K_r"], p["K_m"]
        assert (K_r, K_m) == (stiffest, K[p["measuring"]]) and p["ratio"] == K_r / K_m
        # R = (K_r + x)/(K_m + x): dln x/dln R by differences, and no other object is found better
        errors = [_error(K_r, K_m, p["best_for"] * f) for f in (0.9, 1.0, 1.1)]
        assert errors[1] == pytest.approx(p["condition"], rel=1e-5) and errors[1] == min(errors)
        assert p["condition"] == pytest.approx((sqrt(K_r) + sqrt(K_m)) ** 2 / (K_r - K_m), rel=1e-9)


def _error(K_r: float, K_m: float, x: float) -> float:
    def ratio(x: float) -> float:
        return (K_r + x) / (K_m + x)

    h = 1e-5
    return abs(2 * h / np.log(ratio(x * np.exp(h)) / ratio(x * np.exp(-h))))


def test_strain_per_newton_is_that_of_any_elastic_force(facts, macro):
    elements, _, _ = facts
    for row in estimate(Layout(macro), "solid", 0.3):
        own = elements["elements"][f"E{row.number}"]
        assert own["gauge_per_newton"] * 0.3 == pytest.approx(row.gauge_strain, rel=1e-12)


def test_the_strain_picture_agrees_with_the_faces_strain(macro):
    """Nodes on the flat face against the readings along it, which are taken from the displacements there."""
    layout = Layout(macro)
    place = layout.elements[1]
    field = strain_field(layout, place)
    shape = cut_element(
        element(layout, place).extrusion.outer, layout.clamp_edge, place.hinge_x - place.load_arm
    )
    alloy = design_alloy(macro)
    fine = solve_plane(shape, alloy.youngs_modulus, alloy.poisson, 3.0, density=6)
    read = face_strain(fine, "flat")
    on_face = (np.abs(field.points[:, 1]) < 1e-6) & (np.abs(field.points[:, 0] - place.hinge_x) < 0.4)
    assert on_face.sum() > 10
    assert field.strain[on_face].max() == pytest.approx(read.peak, rel=0.02)  # tension: pressed away
    assert field.strain.min() == pytest.approx(-face_strain(fine, "slot").peak, rel=0.05)
    # the pad moves away from the object by 1/K per newton
    tip = field.points[:, 0] == field.points[:, 0].min()
    assert field.moved[tip, 1].mean() == pytest.approx(fine.compliance, rel=0.02)
    assert strain_along(fine).shape == fine.space.nodes.shape[1:]


def test_a_scene_tells_places_steps_ways_and_bill(macro):
    scene = make_scene(macro, "grasping")
    told = scene_facts(macro, scene)
    assert [p["designator"] for p in told["placed"]] == [p.designator for p in scene.placements]
    for p in told["placed"]:
        assert p["designator"] in scene.steps[p["step"]].designators
    under = {p["designator"]: p["under"] for p in told["placed"]}
    assert under["E1"] == ("vertical axis", "array") and under["SA1"] == ("cart with holder and sample",)
    # the sample leaves by its step's way; of a fanned step nothing by more than the whole way
    ways = {p["designator"]: p["way"] for p in told["placed"]}
    assert ways["SA1"] == scene.steps[told["placed"][list(under).index("SA1")]["step"]].explode
    assert sum(r["qty"] for r in told["bill"] if r["has_solid"]) == len(scene.placements)
    rests = {m["name"]: m["rest"] for m in told["motions"]}
    assert rests == {
        "array down to the sample": 1.0,
        "cart rolls under the lifted array": None,
        "cart rolls with the array on the sample": 0.5,
    }


def test_each_pose_brings_an_elements_pad_to_where_the_first_ones_stands(macro):
    """Read off the parts' own faces: a pad's middle, turned and placed."""
    scene = make_scene(macro, "calibration")
    told = scene_facts(macro, scene)
    placed = {p.designator: p for p in scene.placements}

    def pad(designator, offset=(0.0, 0.0, 0.0)):
        p = placed[designator]
        (face,) = (f for f in part_facts(p.part, {}, [])["features"] if f["name"] == "pad_face")
        return np.asarray(p.rotation) @ face["middle"] + p.origin + np.asarray(offset)

    assert [pose["name"] for pose in told["poses"]] == [f"E{n}" for n in range(1, 11)]
    for pose in told["poses"]:
        offsets = {d: offset for group, offset in pose["ways"] for d in group}
        assert pad(pose["name"], offsets.get(pose["name"], (0.0, 0.0, 0.0))) == pytest.approx(pad("E1"))
        # the array is one piece: all of it moves alike
        assert len({offsets.get(f"E{n}") for n in range(1, 11)}) == 1
    assert told["poses"][0]["ways"] == ()
    assert scene_facts(macro, make_scene(macro, "array"))["poses"] == ()


def test_findings_are_told_with_their_parts(macro_scene):
    def told(part: str, check: str = "hinge", subject: str = "x", place=(1.0, 2.0), number: str = ""):
        return _fact(check, subject, Finding("c", "flag", part, place, 0, 0, "m", number), [macro_scene])

    alike = tuple(
        p.designator for p in macro_scene.placements if p.part.part_no == "macro-array-element-a6mm"
    )
    assert told("macro-array-element-a6mm").designators == alike and len(alike) == 2
    element = told("E2", number="macro-array-element-a7mm")
    assert element.designators == ("E2",) and element.about == "E2 (macro-array-element-a7mm)"
    assert told("macro-array").designators == ()
    assert told("E2", "interference", "array").scene == "array"
    assert told("E2", "motion", "array").place == ()


def test_a_design_is_read_back_from_an_exports_values(macro):
    from tactcad.design.load import from_table
    from tactcad.parts.rules import load

    for name in ("macro-array", "soft-tissue", "smallest-bearing", "double-sample", "better-array"):
        design = load(name)
        assert from_table(nested(flattened(design))) == design
    with_gaps = replace(macro, stop=replace(macro.stop, gaps={4.0: 0.08, 7.5: 0.1}))
    assert nested(flattened(with_gaps))["stop"]["gaps"] == {"4.0": 0.08, "7.5": 0.1}


def test_a_missing_viewer_is_said_with_the_remedy(monkeypatch, tmp_path):
    monkeypatch.setattr(review_page, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"pip install '\.\[review\]' in a checkout"):
        review_page.viewer_library()


def test_the_installed_viewer_is_whole():
    found = review_page.viewer_library()
    assert found.version.startswith("5.") and b"export {" in found.script[-600:] and "tcv_" in found.style


def test_what_is_no_export_is_refused(tmp_path: Path):
    from tactcad.review.subject import subject

    with pytest.raises(InputError, match="not a sound export"):
        subject(str(tmp_path))
    with pytest.raises(InputError, match="no design of that name"):
        subject("no-such-design")


def test_figures_that_nobody_knows_are_none_and_can_be_written():
    """Built arrays have no stiffness where the hinge is thinner than the closed form's range."""
    design = variant({"element.hinge_thickness": 0.05})
    found, _, _ = element_facts(design, (make_scene(design, "array"),))
    assert found["elements"]["E1"]["built"]["stiffness"] == (None, None)
    assert found["elements"]["E1"]["built"]["load_arm"][0] == pytest.approx(3.0, abs=0.01)
    json.dumps(found["elements"], allow_nan=False)
