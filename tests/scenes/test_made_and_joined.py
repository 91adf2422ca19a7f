"""What a shop and a mechanic need of the shipped designs' parts: heads that are sunk, threads that are
reached, one base plate, a carriage that stays on its rail, notes that agree with limits."""

from __future__ import annotations

import re

import numpy as np
import pytest
from variants import FACING_ROWS

from tactcad.drawing.engine.boxes import box_corners, placed
from tactcad.parts.array.element import WIRE_TOLERANCE, least_passes
from tactcad.parts.language.description import Hole
from tactcad.parts.rules import load
from tactcad.scenes import make_scene, scene_names
from tactcad.scenes.scene import Placement, Pose

SCENES = [(design, scene) for design in FACING_ROWS for scene in scene_names(load(design))]
# Behind the thread, mm: shank, and where it begins. M2: yamawa, catalogue 2016, page 173; M3 to M5: DIN 376.
TAPS = {"M2": (2.8, 8.0), "M3": (2.2, 36.0), "M4": (2.8, 43.0), "M5": (3.5, 50.0)}


@pytest.fixture(scope="module", params=SCENES, ids="-".join)
def scene(request):
    design, name = request.param
    return make_scene(load(design), name)


def box(p: Placement) -> np.ndarray:
    corners = np.array([placed(p, c) for c in box_corners(p.part.body.box)])
    return np.array([corners.min(axis=0), corners.max(axis=0)])


def test_every_counterbore_sinks_the_head_in_it(scene):
    bores = [
        (p, f, np.array(placed(p, f.at)), np.array(p.rotation, float) @ np.array(f.axis, float))
        for p in scene.placements
        for f in p.part.features
        if isinstance(f, Hole) and f.counterbore and not f.thread
    ]
    heads = 0
    for screw in scene.placements:
        if not screw.part.part_no.startswith("ISO4762-"):
            continue
        axis = np.array(screw.rotation, float)[:, 2]
        height = -screw.part.body.box[0][2]
        for p, hole, at, into in bores:
            deep = float((np.array(screw.origin) - at) @ into)
            aside = np.linalg.norm(np.array(screw.origin) - at - deep * into)
            wide, floor = hole.counterbore
            if into @ axis > 0.999 and aside < 1e-6 and abs(deep - floor) < 1e-6:
                heads += 1
                assert deep - height >= -1e-9, f"{screw.designator} stands out of {p.designator}"
                assert 2 * screw.part.body.box[1][0] < wide
    assert heads or scene.name == "bonding"  # which has no screws


def test_a_tap_reaches_every_thread(scene):
    for part in scene.parts:
        for f in () if part.bought else part.features:
            if isinstance(f, Hole) and f.thread in TAPS:
                shank, reach = TAPS[f.thread]
                wide, start = f.counterbore or (0.0, 0.0)
                assert wide > shank or start + f.thread_depth <= reach, (part.part_no, f.name)


@pytest.mark.parametrize("name", ["macro-array", "double-sample", "smallest-bearing"])
def test_all_set_ups_stand_on_one_base_plate(name):
    design = load(name)
    without = ("array", "setting", "wiring", "bonding")
    scenes = [make_scene(design, s) for s in scene_names(design) if s not in without]
    at = [next(p for p in scene.placements if p.designator == "BP1") for scene in scenes]
    assert len(at) == 3 and {p.part.part_no for p in at} == {f"{name}-base"}
    assert len({p.part for p in at}) == 1
    # a wheel keeps half of its width beside every thread that it rolls over
    wheels = [box(p)[:, 1] for p in scenes[-1].placements if p.designator.startswith("BB")]
    for low, high in wheels:
        for f in (f for f in at[0].part.features if f.name == "stage"):
            over = min(high, f.at[1] + 2.0) - max(low, f.at[1] - 2.0)
            assert over <= (high - low) / 2


@pytest.mark.parametrize("name", ["macro-array", "double-sample", "smallest-bearing"])
def test_without_the_cart_the_carriage_comes_down_on_its_stop(name):
    """Let down along the rail, the carriage meets the pin before its end passes the rail's, and in use it
    does not."""
    design = load(name)
    scene = make_scene(design, "grasping", Pose(deflection=0.3))
    at = {p.designator: box(p) for p in scene.placements}
    carriage, rail, pin = at["CG1"], at["RL1"], at["ES1"]
    assert pin[1][2] < carriage[0][2] - 1.0  # the pads in the sample
    assert rail[0][2] - 0.5 < pin[1][2] < rail[0][2]
    (solid,) = [p for p in scene.placements if p.designator == "CG1"]
    roof = min(placed(solid, (0.0, 6.5, 0.0))[1], placed(solid, (0.0, 10.0, 0.0))[1])
    assert pin[0][1] < roof + 3.5 - 1.0, "a millimetre of the carriage lies on it"
    moving = dict(scene.groups)["axis"]
    for d in moving - {"CG1"}:  # nothing else comes down on it
        apart = np.any((at[d][0][:2] >= pin[1][:2]) | (at[d][1][:2] <= pin[0][:2]))
        assert apart or at[d][0][2] > carriage[0][2], d


@pytest.mark.parametrize("name", ["macro-array", "double-sample", "smallest-bearing"])
def test_the_latch_holds_the_lifted_carriage(name):
    """Lifted all the way, the carriage's side stands over the pin by less than a tenth; in use the pin stands
    beside everything that moves, on its whole way."""
    design = load(name)
    lift = design.grasping.lift
    up = {p.designator: box(p) for p in make_scene(design, "grasping", Pose(height=lift)).placements}
    pin, carriage, rail = up["LP1"], up["CG1"], up["RL1"]
    assert 0.0 <= carriage[0][2] - pin[1][2] <= 0.1
    sides = [min(pin[1][k], carriage[1][k]) - max(pin[0][k], carriage[0][k]) for k in (0, 1)]
    assert sides[0] > 2.5 and sides[1] > 5.0, "most of the pin lies under the carriage"
    assert pin[1][0] < rail[0][0] or pin[0][0] > rail[1][0]
    scene = make_scene(design, "grasping")
    at = {p.designator: box(p) for p in scene.placements}
    kept = at["LP1"]
    for d in dict(scene.groups)["axis"]:
        way = np.array([at[d][0], at[d][1] + [0.0, 0.0, lift]])
        assert np.any((way[0] >= kept[1]) | (way[1] <= kept[0])), d


@pytest.mark.parametrize("name", ["calibration", "sample-stiffness"])
def test_the_tip_is_held_by_a_jam_nut(name):
    scene = make_scene(load("macro-array"), name)
    at = {p.designator: box(p) for p in scene.placements}
    contacts = {(c.first, c.second, c.kind) for c in scene.contacts}
    assert ("TI1", "JN1", "touch") in contacts and ("FG1", "JN1", "thread") in contacts
    assert at["JN1"][0][2] == pytest.approx(at["TI1"][1][2])
    assert at["JN1"][1][2] + 0.5 < at["FG1"][0][2] + 10.0, "the nut's way to the housing"
    assert at["TI1"][1][2] - at["FG1"][0][2] >= 6.0 - 1e-9, "a diameter of the shaft in the tip"


WORDS = {"one pass": 1, "three passes": 3, "four passes": 4}


@pytest.mark.parametrize("design", FACING_ROWS)
def test_passes_are_those_that_hold_the_hinge(design):
    """By the vendors' figures; where a design's origin names a number of passes, the same."""
    d = load(design)
    tolerance = d.tolerance.hinge_thickness
    held = {
        1: WIRE_TOLERANCE["1 pass"],
        3: WIRE_TOLERANCE["2-3 passes"],
        4: WIRE_TOLERANCE["4 or more passes"],
    }
    for part in make_scene(d, "array").parts:
        if "-element-" in part.part_no:
            (note,) = [n for n in part.notes if "passes" in n]
            said = next(count for words, count in WORDS.items() if words in note)
            assert held[said] <= tolerance or said == 4
            assert all(held[fewer] > tolerance for fewer in held if fewer < said)
            assert "rolling direction along the arm, across the hinge" in part.notes
            assert "bare sheet, not clad" in part.notes
            assert "EN 485-2" in str(part.material)
    origin = d.origin.get("tolerance.hinge_thickness", "")
    if named := re.search(r"(\w+) passes", origin):
        assert f"{named[1]} passes" == least_passes(tolerance)


def test_a_magnetic_chuck_holds_the_stop_plate():
    (plate,) = [p for p in make_scene(load("macro-array"), "array").parts if p.part_no.endswith("stop-plate")]
    assert re.search(r"Cr1[0-9](?!Ni)", plate.material.name)  # chromium without nickel: martensitic
    assert {g.symbol for g in plate.geometric} == {"flatness", "parallelism"}
    assert "both faces ground" in plate.finish and not any("ground face down" in n for n in plate.notes)
