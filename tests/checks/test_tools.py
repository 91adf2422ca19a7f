"""Screws and nuts that a tool reaches, or not: a plate under a bridge, and the shipped scenes with one thing
moved."""

from __future__ import annotations

from dataclasses import replace

import pytest
from built import shapes_of
from variants import variant

from tactcad.checks.on_solids.tools import check_tools
from tactcad.contour import rectangle
from tactcad.parts.bought.screws import cap_screw, nut, set_screw, threaded_rod
from tactcad.parts.language.description import Extrusion, Hole, Material, Part
from tactcad.parts.rules import load
from tactcad.scenes import make_scene, scene_names
from tactcad.scenes.scene import DOWN, Move, Placement, Scene, Step

pytestmark = pytest.mark.cad

ALUMINIUM = Material("aluminium", 2700)


def block(name: str, x: float, y: float, z: float, *holes: Hole) -> Part:
    return Part(name, name, "milled", ALUMINIUM, Extrusion(rectangle(-x / 2, -y / 2, x / 2, y / 2), z), holes)


PLATE = block(
    "PLATE", 20, 20, 10, Hole("tap", (0, 0, 10), (0, 0, -1), 2.5, 10, True, thread="M3", thread_depth=9)
)
BRIDGE = block("BRIDGE", 20, 20, 2)
ORDER = ("plate", "bridge", "screw")
DRILLED = block("DRILLED", 20, 20, 2, Hole("key", (0, 0, 0), (0, 0, 1), 3.2, 2, True))


def scene(
    bridge: float, over: Part = BRIDGE, screw: Part | None = None, order=ORDER, moves=(), **step
) -> Scene:
    """A screw in a plate, its head 3 mm high on it, under a bridge so far over the plate."""
    placed = {
        "plate": Placement("P1", PLATE),
        "bridge": Placement("B1", over, (0, 0, 10 + bridge)),
        "screw": Placement("SC1", screw or cap_screw("M3", 8.0), (0, 0, 10), DOWN),
    }
    last = ({}, {"order": moves, **step})
    steps = tuple(
        Step(name, (placed[name].designator,), (0, 0, 0), "", **last[name == "screw"]) for name in order
    )
    return Scene("test", tuple(placed.values()), steps=steps)


def found(scene: Scene):
    return check_tools(scene, shapes_of(scene))


def test_what_stands_within_a_keys_reach_is_in_its_way():
    # the key of 40 mm starts 0.05 mm over the socket, whose floor is 1.3 mm under the head's top, 3 mm over
    # the plate
    assert found(scene(bridge=43.1)) == []
    (finding,) = found(scene(bridge=42.9))
    assert (finding.check, finding.part, finding.severity) == ("tool-room", "SC1", "fail")
    assert "B1 (BRIDGE) is in the way of the key of 40 mm for SC1" in finding.message
    assert finding.place[2] == pytest.approx(52.9, abs=0.2)


def test_a_hole_for_the_key_lets_it_through():
    assert found(scene(bridge=10.0, over=DRILLED)) == []
    # 2.5 mm across flats are 2.89 across corners: 3.2 passes it, 2.8 does not
    narrow = block("NARROW", 20, 20, 2, Hole("key", (0, 0, 0), (0, 0, 1), 2.8, 2, True))
    assert [f.check for f in found(scene(bridge=10.0, over=narrow))] == ["tool-room"]


def test_steps_say_what_stands_there():
    assert found(scene(10.0, order=("plate", "screw", "bridge"))) == []
    assert found(scene(10.0, bench=True)) == []
    aside = Move(("B1",), (0, 0, 0), ((50.0, 0, 0),)), ("SC1",), Move(("B1",), (50.0, 0, 0), ((0, 0, 0),))
    assert found(scene(10.0, moves=aside)) == []
    assert found(scene(10.0, ready=frozenset({"SC1"}))) == []


def test_set_screws_want_their_key_too():
    standing = set_screw("M3", 8.0)
    assert [f.part for f in found(scene(10.0, screw=standing))] == ["SC1"]
    assert found(scene(60.0, screw=standing)) == []


@pytest.mark.parametrize(("apart", "expected"), [(7.7, []), (7.5, ["NU1", "NU2"])])
def test_a_socket_over_a_nut_wants_room_beside_it(apart, expected):
    """Two M3 nuts: corners at 6.351/2, and a socket 1.25 mm wider: 7.60 mm between axes is enough, less is
    not."""
    names = [("NU1", 0.0), ("NU2", apart)]
    nuts = tuple(Placement(name, nut("M3"), (x, 0, 10)) for name, x in names)
    rods = tuple(
        Placement(f"TR{n}", threaded_rod("M3", 16.0), (x, 0, 0)) for n, (_, x) in enumerate(names, start=1)
    )
    steps = (Step("all", tuple(p.designator for p in (*nuts, *rods)), (0, 0, 0), ""),)
    placed = Scene("test", (*nuts, *rods), steps=steps)
    assert [f.part for f in found(placed)] == expected


@pytest.mark.parametrize("name", ["macro-array", "soft-tissue"])
def test_every_screw_of_the_shipped_arrays_can_be_reached(name):
    assert found(make_scene(load(name), "array")) == []


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["macro-array", "double-sample", "smallest-bearing"])
def test_every_screw_of_the_shipped_rigs_can_be_reached(name):
    design = load(name)
    for one in scene_names(design):
        assert found(make_scene(design, one)) == [], one


def test_a_plate_over_the_clamping_screws_of_an_array_is_seen():
    array = make_scene(variant({"array.row_arms": [[6.0]]}), "array")
    z = next(p for p in array.placements if p.designator == "SC1").origin[2]
    over = Placement("OVER", block("OVER", 80, 40, 2), (0, -25.0, z), ((1, 0, 0), (0, 0, -1), (0, 1, 0)))
    steps = (Step("over", ("OVER",), (0, 0, 0), ""), *array.steps)
    hidden = found(replace(array, placements=(over, *array.placements), steps=steps))
    assert {f.part for f in hidden} == {f"SC{n}" for n in range(1, 5)}
