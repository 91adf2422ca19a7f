"""Steps that can be carried out, or not: a plate, a pin and a screw with one thing wrong each, and the
shipped scenes' moves as guide/SCENE.json tells them."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import pytest
from built import shapes_of
from test_tools import block
from variants import variant

from tactcad.checks.on_solids.steps import Trial, check_steps
from tactcad.parts.bought.screws import cap_screw, jam_nut
from tactcad.parts.bought.standard_parts import STAGES, dowel
from tactcad.parts.language.description import Hole
from tactcad.parts.rigs import stand
from tactcad.parts.rules import load
from tactcad.scenes import make_scene, scene_names
from tactcad.scenes.builder import Builder
from tactcad.scenes.moves import CLAMP, TWEEZED, guide_json, settles, step_moves
from tactcad.scenes.scene import DOWN, STILL, Contact, Held, Move, Need, Placement, Scene, Step

pytestmark = pytest.mark.cad

TAPPED = block(
    "TAPPED", 20, 20, 10, Hole("tap", (0, 0, 10), (0, 0, -1), 2.5, 10, True, thread="M3", thread_depth=9)
)
HOLED = block("HOLED", 20, 20, 10, Hole("pin", (0, 0, 10), (0, 0, -1), 3.02, 8, False))
ROOF = block("ROOF", 20, 20, 2)


def scene(steps: tuple[Step, ...], contacts: tuple[Contact, ...] = (), roof: float = 100.0) -> Scene:
    """A drilled plate with a pin of 3 x 16 in it, 8 deep; a tapped one with a screw; a roof so far "
    "over the first."""
    placed = (
        Placement("P1", HOLED),
        Placement("DW1", dowel("3", 16.0), (0, 0, 2)),
        Placement("T1", TAPPED, (40, 0, 0)),
        Placement("SC1", cap_screw("M3", 8.0), (40, 0, 10), DOWN),
        Placement("RO1", ROOF, (0, 0, 10 + roof)),
    )
    names = {d for step in steps for d in step.designators}
    met = tuple(c for c in contacts if {c.first, c.second} <= names)
    return Scene("test", tuple(p for p in placed if p.designator in names), met, steps=steps)


def step(*names: str, **more) -> Step:
    return Step(" ".join(names) or "none", names, STILL, "", **more)


def found(scene: Scene) -> list:
    return check_steps(scene, shapes_of(scene))


def test_pairs_alike_share_a_trial_and_the_odd_one_is_found(monkeypatch):
    """Pins into a plate's 12 holes: one hole is 2 mm narrower, one blind, one pin stands 1 mm aside."""
    tried = []
    real = Trial._tried
    monkeypatch.setattr(Trial, "_tried", lambda *a: tried.append(a) or real(*a))

    def hole(n: int, wide: float, deep: float) -> Hole:
        return Hole("h", (8.0 * n - 44, 0, 4), (0, 0, -1), wide, deep, deep == 4.0)

    holes = [hole(n, 1.2 if n == 5 else 3.2, 2.0 if n == 9 else 4.0) for n in range(12)]
    plate, pin = Placement("P1", block("PLATE", 100, 8, 4, *holes)), dowel("3", 6.0)
    at = [(8.0 * n - 44, 1.0 if n == 3 else 0.0, 0.0) for n in range(12)]
    pins = [Placement(f"DW{n}", pin, place) for n, place in enumerate(at)]
    steps = (step("P1"), step(*(p.designator for p in pins), by=TWEEZED))
    cut = [f.part for f in found(Scene("pins", (plate, *pins), steps=steps)) if f.check == "insertion"]
    assert cut == ["DW3", "DW5", "DW9"]
    assert len(tried) == 4


def on_rail(wide: float) -> Scene:
    """A plate of 20 x 20 x 10 on a rail along x, said to be level."""
    rail, plate = Placement("RA1", block("RAIL", 20, wide, 5)), Placement("P1", HOLED, (0, 0, 5))
    level = Held((("P1",),), ("RA1",), ("z", "rx", "ry"))
    steps = (step("RA1"), step("P1", held=(level,)))
    return Scene("rail", (rail, plate), (Contact("P1", "RA1", "touch"),), steps=steps)


IN_T1 = (Contact("SC1", "T1", "thread"),)
PULL = Move(("DW1",), STILL, ((0.0, 0.0, 12.0), STILL))
BAD = {
    "insertion": scene((step("P1", "RO1"), step("DW1")), (Contact("DW1", "P1", "press"),), roof=10.0),
    "order": scene((step("SC1"), step("T1")), IN_T1),
    "fingers": scene(
        (step("P1", "DW1"), step("RO1"), step(order=(PULL,))), (Contact("DW1", "P1", "press"),), 21.0
    ),
    "freedom": on_rail(2.0),
}


@pytest.mark.parametrize("check", sorted(BAD))
def test_a_bad_step_of_each_kind_is_found(check):
    assert check in {f.check for f in found(BAD[check])}


def beside(*walls: Placement, by: str = "", press: bool = False, moved: tuple = ()) -> list[str]:
    """What is found if a pin of 3 x 16, or a thin nut M6, goes where walls stand."""
    nut = by.startswith("spanner")
    put = Placement("JN1", jam_nut(), (0, 0, 10)) if nut else Placement("DW1", dowel("3", 16.0), (0, 0, 2))
    met = (Contact("DW1", "P1", "press"),) if press else ()
    last = step(put.designator, by="" if nut else by, order=moved)
    steps = (step("P1", *(w.designator for w in walls)), last)
    made = Scene("beside", (Placement("P1", HOLED), *walls, put), met, steps=steps)
    return [f"{f.check}: {f.message}" for f in found(made)]


def wall(at: float, top: float, wide: float = 20.0) -> Placement:
    """Across x, its nearer face so far from the pin's axis, up to so far over the plate."""
    name = f"W{'A' if at > 0 else 'B'}{abs(at):g}"
    return Placement(name, block(f"WALL-{top:g}", 2, wide, top), (at + (1 if at > 0 else -1), 0, 10))


def test_a_press_wants_room_for_ram_and_sleeve():
    """Over 8 mm of pin: a ram 20 mm wide, and a sleeve 2 mm thick, which a lower wall 3 mm off is in."""
    assert beside(wall(10.1, 20), press=True) == [] == beside(wall(3.6, 8), press=True)
    (ram,) = beside(wall(9.9, 20), press=True)
    assert "tool-room" in ram and "press's ram, 20 mm wide" in ram
    (sleeve,) = beside(wall(3.0, 7), press=True)
    assert "press's sleeve, 7 mm wide" in sleeve


def test_a_fingertip_reaches_what_it_lays():
    """Down a hole of 3.02 mm none does, tweezers do; between walls 9 mm apart, higher than the pin, none."""
    drilled = block("ROUND", 20, 20, 30, Hole("way", (0, 0, 0), (0, 0, 1), 3.02, 30, True))
    deep = Placement("W1", drilled, (0, 0, 10))
    assert beside(wall(5.1, 60), wall(-5.1, 60)) == [] == beside(deep, by="tweezers")
    for walls in ((wall(4.5, 60), wall(-4.5, 60)), (deep,)):
        (said,) = beside(*walls)
        assert said.startswith("fingers") and "no fingertip, 12 x 10 mm, reaches it" in said


@pytest.mark.parametrize("shelf", [False, True])
@pytest.mark.parametrize(("beside", "over", "free"), [(45, 45, True), (35, 45, True), (35, 35, False)])
def test_one_hand_holds_what_the_other_screws(beside, over, free, shelf):
    """A cover of 30 x 30 on an upright plate, walls so far beside it and over and under it: fingers, 40 mm
    long, hold it by two sides, or from above press it on a shelf."""
    upright = ((1, 0, 0), (0, 0, -1), (0, 1, 0))  # local z to the front, -y
    hole = Hole("screw", (0, 0, 10), (0, 0, -1), 3.4, 10, True)
    cover = Placement("C1", block("COVER", 30, 30, 10, hole), (0, -10, 0), upright)
    screw = Placement("SC1", cap_screw("M3", 16.0), (0, -20, 0), ((1, 0, 0), (0, 0, 1), (0, -1, 0)))
    walls = [
        *(Placement(f"W{s}", block("SIDE", 2, 60, 60), (s * (16 + beside), -10, -30)) for s in (-1, 1)),
        Placement("W2", block("ROOF-60", 60, 60, 2), (0, -10, 15 + over)),
        Placement("W3", block("ROOF-60", 60, 60, 2), (0, -10, -17 - (0 if shelf else over))),
    ]
    met = (Contact("SC1", "T1", "thread"), Contact("SC1", "C1", "touch"), Contact("C1", "T1", "touch"))
    steps = (step("T1", *(w.designator for w in walls)), step("C1"), step("SC1"))
    tapped = block("TAPPED-60", 60, 60, 10, *TAPPED.features)
    back = Placement("T1", tapped, (0, 0, 0), upright)
    on = (Contact("C1", "W3", "touch"),) if shelf else ()
    made = Scene("held", (back, *walls, cover, screw), (*met, *on), steps=steps)
    said = [f.message for f in found(made) if f.check == "fingers"]
    none = "step 'SC1': C1: no fingertip presses it down, and no two hold it, 100 mm apart at most, while SC1"
    assert [m.startswith(none) for m in said] == ([] if free else [True])


@pytest.mark.parametrize(
    ("wide", "tools", "most"), [(120, (), 100), (120, (CLAMP,), 0), (310, (CLAMP,), 300)]
)
def test_a_clamp_holds_what_a_hand_does_not_span(wide, tools, most):
    """A cover too wide for a hand, screwed from below: by the jaws of a clamp, up to its opening."""
    cover = Placement("C1", block("COVER-WIDE", wide, wide, 10, *TAPPED.features), (0, 0, 20))
    plate = Placement(
        "P1",
        block("PLATE-WIDE", wide, wide, 10, Hole("screw", (0, 0, 10), (0, 0, -1), 3.4, 10, True)),
        (0, 0, 10),
    )
    screw = Placement("SC1", cap_screw("M3", 16.0), (0, 0, 10), ((1, 0, 0), (0, 1, 0), (0, 0, 1)))
    met = (Contact("SC1", "C1", "thread"), Contact("SC1", "P1", "touch"), Contact("C1", "P1", "touch"))
    last = step("SC1", tools=tools)
    made = Scene("wide", (plate, cover, screw), met, steps=(step("P1"), step("C1"), last))
    said = [f.message for f in found(made) if f.check == "fingers"]
    assert len(said) == bool(most) and all(f"{most} mm apart at most" in message for message in said)


def test_a_spanner_wants_room_to_turn():
    """Its handle, 60 mm long, turns by 30 degrees between walls along it; between closer ones it does not."""
    turn = (Move(("JN1",), (0, 0, 30.0), (STILL,), "spanner 10 mm"),)
    assert beside(by="spanner", moved=turn) == []
    assert beside(wall(42, 20, 200), wall(-42, 20, 200), by="spanner", moved=turn) == []
    (said,) = beside(wall(25, 20, 200), wall(-25, 20, 200), by="spanner", moved=turn)
    assert said.startswith("tool-room") and "no spanner of 10 mm turns by 30 degrees on it" in said


def test_a_thin_spanner_goes_where_a_usual_one_does_not():
    """Under a plate 3.5 mm over the nut's seat, with a shaft through it: 3 mm do, 5 do not."""
    over = Placement("W1", block("OVER", 60, 60, 5), (0, 0, 13.5))
    for thick, free in ((", 3 mm thick", True), ("", False)):
        turn = (Move(("JN1",), (40.0, 0, 0), (STILL,), f"spanner 10 mm{thick}"),)
        assert (beside(over, by="spanner", moved=turn) == []) is free


@pytest.mark.parametrize("away", [True, False])
def test_a_box_that_a_step_brings_is_moved_and_stands_there(away):
    """A gauge block on the plate is in the pin's way until it is taken off it; the roof is in the block's."""
    b = Builder()
    aid = b.aid("block", (-5, -5, 10), (5, 5, 20))
    out = (Move((aid,), STILL, ((0, 0, 30.0),)),) if away else ()
    steps = (step("P1", order=(("P1",), Move((aid,), (0, 0, 30.0), (STILL,)), *out)), step("DW1"))
    with_block = replace(scene(steps), aids=tuple(b.aids))
    assert ("insertion" in {f.check for f in found(with_block)}) is not away
    low = scene((step("P1", "RO1"), step(order=steps[0].order[1:])), roof=30.0)
    cuts = [f for f in found(replace(low, aids=tuple(b.aids))) if f.check == "insertion"]
    assert {f.part for f in cuts} == {"AID1"} and all("into RO1" in f.message for f in cuts)


def test_only_a_step_that_takes_apart_leaves_parts_off():
    off = Move(("P1",), STILL, ((0, 0, 30.0),))
    assert found(scene((step("P1"), step(order=(off,), apart=True)))) == []
    (said,) = found(scene((step("P1"), step(order=(off,)))))
    assert "P1 is left 30 mm off" in said.message


def test_a_pin_wants_its_length_before_its_hole():
    """8 mm stand out of the plate and the pin has 8 in it: it passes under a roof 16 mm and more over the
    plate, and 1 mm below that it cuts by a cylinder of that length."""
    out = Move(("DW1",), (0.0, 0.0, 8.0), (STILL,))
    tried = {
        roof: found(scene((step("P1", "RO1"), step("DW1", order=(out,))), roof=roof))
        for roof in (16.05, 15.0)
    }
    assert tried[16.05] == []
    (cut,) = tried[15.0]
    assert cut.check == "insertion" and cut.value == pytest.approx(3.14159 * 1.5**2, rel=0.05)


@pytest.mark.parametrize(
    ("steps", "said"),
    [
        ((step("SC1"), step("T1")), "goes into T1, which is not there yet"),
        ((step("P1", needs=(Need(("T1",), "measured on it"),)), step("T1")), "is not there yet: measured"),
        ((step("T1"), step("P1", needs=(Need(("T1",), "its place", away=True),))), "is there already"),
        ((step("P1", order=(Move(("P1",), (0, 0, 30.0), ((0, 0, 5.0),)),)),), "is left 5 mm off"),
        (
            (step("P1"), step(order=(Move(("P1",), (0, 0, 3.0), (STILL,)),))),
            "does not start where it was left",
        ),
    ],
)
def test_what_a_step_needs_is_asked_for(steps, said):
    assert any(said in f.message for f in found(scene(steps, IN_T1)))


def test_good_steps_are_not_found():
    good = (step("P1"), step("DW1"), step("T1"), step("SC1"), step("RO1"))
    assert found(scene(good, (*IN_T1, Contact("DW1", "P1", "press")))) == []


def test_a_rail_levels_a_plate_from_a_tenth_of_its_half_diagonal_on():
    """Across the rail that is 11.2 mm, for half a rail of 2.24 mm. A plate that stands off by 0.1 is free in
    all it is said to be held in."""
    assert found(on_rail(2.4)) == []
    (rocks,) = found(on_rail(2.0))
    assert "P1 is free to turn about x: its contact with RA1 does not set that" in rocks.message
    one = on_rail(2.4)
    off = replace(one, placements=(one.placements[0], Placement("P1", HOLED, (0, 0, 5.1))))
    assert [f.message.split(":")[1].split("free ")[1] for f in found(off)] == [
        "along z", "to turn about x", "to turn about y",
    ]  # fmt: skip


def test_what_virtual_arrays_take_as_set_a_step_must_set():
    """The shipped fixture does; lower by 0.05 it carries nothing, and a step that says nothing is found."""
    made = make_scene(load("soft-tissue"), "setting")

    def free(scene: Scene) -> list[str]:
        return [f.message for f in Trial(scene, shapes_of(scene), {}).freedoms()]

    assert free(made) == []
    said = free(replace(made, steps=tuple(replace(s, held=()) for s in made.steps)))
    assert len(said) == 2 * 3 + 8 * 2 and any("E7 is free to turn about y: no step sets" in m for m in said)
    down = [replace(p, origin=(*p.origin[:2], p.origin[2] - 0.05)) for p in made.placements[:1]]
    low = replace(made, placements=(*down, *made.placements[1:]))
    said = free(low)
    assert any("EP1 EP2 is free along z" in m for m in said) and any("E1 is free to turn" in m for m in said)


def test_a_drill_point_is_told_from_a_thread():
    """A screw may share its thread's ring with what it goes through, 2.16 mm2 over 10 mm, and no more."""
    blind = replace(
        TAPPED, part_no="BLIND", features=(replace(TAPPED.features[0], depth=4.0, through=False),)
    )
    one = scene((step("T1"), step("SC1")), IN_T1)
    stuck = replace(one, placements=(replace(one.placements[0], part=blind), one.placements[1]))
    assert found(one) == [] and [f.check for f in found(stuck)] == ["insertion"]


@pytest.mark.by_day(1, "two seconds for long ones")
@pytest.mark.parametrize("rows", [[[6.0]], [[4.0, 7, 6, 8] * 3, [8.0, 5, 4, 7] * 3]], ids=["one", "tie rods"])
def test_hands_get_into_small_and_long_arrays(rows):
    """One element's strip is laid by tweezers; a long array's nuts, low over the fixture, want nut drivers:
    an open spanner has no room there."""
    made = make_scene(variant({"array.row_arms": rows}), "setting")
    assert found(made) == []
    (nuts,) = (s for s in made.steps if s.title == "Coplanar pads")
    spanner = Move(("NU1",), (0, -30.0, 0), (STILL,), "spanner 5.5 mm")
    if "NU1" in nuts.designators:
        other = replace(made, steps=(*made.steps[:-1], replace(nuts, order=(spanner,))))
        assert ("tool-room", "NU1") in {(f.check, f.part) for f in found(other)}


@pytest.mark.slow  # 24 elements moved past all parts
def test_a_long_array_comes_past_the_guide():
    """Slid up and off to be weighed, its end plate met the heads of the rail's screws."""
    long = variant({"array.row_arms": [[4.0, 7, 6, 8] * 3, [8.0, 5, 4, 7] * 3]})
    assert found(make_scene(long, "grasping")) == []


@pytest.mark.parametrize("name", ["macro-array", "soft-tissue"])
def test_the_shipped_array_goes_together(name):
    assert found(make_scene(load(name), "array")) == []


def test_every_step_tells_its_moves_and_ends_in_place():
    """Of every scene: the contract's fields; every part comes once and is at its place at last."""
    design = load("macro-array")
    for name in scene_names(design):
        made = make_scene(design, name)
        told = json.loads(guide_json(made))
        assert told["units"] == "mm" and "final place" in told["frame"]
        at: dict[str, list[float]] = {}
        assert [s["title"] for s in told["steps"]] == [s.title for s in made.steps]
        for one in told["steps"]:
            assert {"title", "moves", "sets", "leaves"} <= set(one)
            for move in one["moves"]:
                assert {"designator", "from", "path", "by"} <= set(move)
                assert at.get(move["designator"], move["from"]) == move["from"]
                at[move["designator"]] = move["path"][-1]
        aids = {aid["designator"] for aid in told["aids"]}
        assert set(at) == {p.designator for p in made.placements} | aids
        off = {m["designator"] for s in told["steps"] if s["apart"] for m in s["moves"]} | aids
        assert all(offset == [0.0, 0.0, 0.0] for name, offset in at.items() if name not in off)


def test_usual_ways_follow_from_the_placements():
    """A pin comes from the side where it stands out, a screw against its axis, a part along its "
    "seat's normal."""
    made = make_scene(load("macro-array"), "array")
    ways = {m.designators: m for moves in step_moves(made) for m in moves}
    assert ways["DW1",].start[1] < -20.0 and ways["DW1",].start[::2] == (0.0, 0.0)
    assert ways["SC5",].start[2] > 20.0 and ways["SC5",].by == "hex key 2.5 mm"
    assert ways["E1",].start[1] < -20.0 and ways["CA1",].start[2] > 0.0
    titles = [s.title for s in made.steps]
    sets, _ = settles(made, titles.index("Carrier"))
    assert any("CA1 to EP1: all, by SC5 SC6" in said for said in sets)


@pytest.mark.by_day(1, "a scene with all its steps each")
@pytest.mark.parametrize("stage", STAGES, ids=lambda stage: f"{stage.size:g} mm")
def test_every_stage_sold_can_be_screwed_down(monkeypatch, stage):
    """The largest stands 8 mm before the post: there its screws would stay covered."""
    monkeypatch.setattr(stand, "calibration_stage", lambda _layout: stage)
    made = make_scene(load("macro-array"), "calibration")
    steps = made.steps[: 1 + [s.title for s in made.steps].index("Stages on the base plate")]
    names = {d for s in steps for d in s.designators}
    assert {"PO1", "SF2", "SM2"} <= names and len([n for n in names if n.startswith("RS")]) == 4 + 4 + 4
    placed = tuple(p for p in made.placements if p.designator in names)
    assert placed[[p.designator for p in placed].index("SM2")].part.body.box[1][0] == stage.size / 2
    met = tuple(c for c in made.contacts if {c.first, c.second} <= names)
    stands = replace(made, placements=placed, contacts=met, steps=steps, groups=(), motions=(), ready=())
    assert found(stands) == []


@pytest.mark.parametrize("name", ["macro-array", "planar-array", "jaw-array"])
def test_a_step_on_the_bench_fixes_nothing_on_what_is_not_there(name):
    design = load(name)
    for scene_name in scene_names(design):
        told, there = json.loads(guide_json(make_scene(design, scene_name))), set()
        for one in (s for s in told["steps"] if s["bench"]):
            there |= {move["designator"] for move in one["moves"]}
            said = set(re.findall(r"\b[A-Z]{1,3}\d+\b", " ".join([*one["sets"], *one["leaves"]])))
            assert said <= there, (scene_name, one["title"], said - there)
