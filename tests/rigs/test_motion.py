"""Collisions on the way are seen, however thin; what is free is passed."""

from __future__ import annotations

import pytest
from built import shape_of, shapes_of
from variants import variant

from tactcad.checks.on_solids.interference import check_interference
from tactcad.checks.on_solids.motion import check_motions
from tactcad.contour import circle, rectangle
from tactcad.parts.language.description import Extrusion, Hole, Material, Part, envelope
from tactcad.parts.language.finding import Finding
from tactcad.parts.rules import load
from tactcad.scenes import make_scene
from tactcad.scenes.scene import Contact, Motion, Placement, Scene
from tactcad.solids.measure import bounding_box

METAL = Material("metal", 2700)
BALL = Part("block", "block", "milled", METAL, Extrusion(rectangle(-1, -1, 1, 1), 2))
FOIL = Part("foil", "foil", "milled", METAL, Extrusion(rectangle(-5, -5, 5, 5), 0.01))
WINDOW = Part(
    "window",
    "window",
    "milled",
    METAL,
    Extrusion(rectangle(-5, -5, 5, 5), 1),
    (Hole("hole", (0, 0, 1), (0, 0, -1), 4.0, 1.0, True),),
)


def scene(obstacle: Part, at, start, end, contacts=()) -> Scene:
    return Scene(
        "test",
        (Placement("B1", BALL), Placement("O1", obstacle, at)),
        contacts,
        groups=(("mover", frozenset({"B1"})),),
        motions=(Motion("way", (("mover", start, end),)),),
    )


def found(s: Scene) -> list[Finding]:
    full = shapes_of(s)
    return check_motions(s, full, {p.part_no: shape_of(envelope(p)) for p in s.parts})


def findings(s: Scene) -> list[str]:
    return [f.message for f in found(s)]


def test_a_foil_between_the_ends_is_met():
    """It is free at both ends and in the middle of the way: poses would not show it."""
    s = scene(FOIL, (0, 0, 13.3), (0, 0, 0), (0, 0, 20))
    (message,) = findings(s)
    assert "B1 (block) and O1 (foil) meet at 56 % of the motion 'way'" in message  # 13.3 - 2 over 20


def test_past_the_foil_is_free():
    assert findings(scene(FOIL, (6.1, 0, 13.3), (0, 0, 0), (0, 0, 20))) == []
    assert findings(scene(FOIL, (0, 0, 22.1), (0, 0, 0), (0, 0, 20))) == []


def test_through_a_window_the_true_shape_decides():
    """Its envelope is in the way, the hole is not: corners at 1.414 pass a radius of 2."""
    assert findings(scene(WINDOW, (0, 0, 5), (0, 0, 0), (0, 0, 20))) == []
    assert len(findings(scene(WINDOW, (1.0, 0, 5), (0, 0, 0), (0, 0, 20)))) == 1


def test_sliding_on_a_face_is_free_and_cutting_into_it_is_not():
    touch = (Contact("B1", "O1", "touch"),)
    assert findings(scene(WINDOW, (0, 4, 2), (0, 0, 0), (3, 0, 0), touch)) == []
    (message,) = findings(scene(WINDOW, (0, 4, 2), (0, 0, 0), (0, 0, 0.5), touch))
    assert "cut into each other" in message


def test_undeclared_sliding_is_a_collision():
    assert len(findings(scene(FOIL, (0, 0, 2), (0, 0, 0), (3, 0, 0)))) == 1


def test_diagonal_ways_do_not_reach_around_corners():
    """The boxes of start and end hold the obstacle, the way itself does not."""
    post = Part("post", "post", "milled", METAL, Extrusion(circle((0, 0), 1), 2))
    assert findings(scene(post, (8, 2, 0), (0, 0, 0), (10, 10, 0))) == []
    assert len(findings(scene(post, (5, 5, 0), (0, 0, 0), (10, 10, 0)))) == 1


@pytest.mark.parametrize("name", ["calibration", "sample-stiffness", "grasping"])
def test_an_envelope_holds_its_part(name):
    for part in make_scene(load("macro-array"), name).parts:
        outer, inner = bounding_box(shape_of(envelope(part))), bounding_box(shape_of(part))
        assert all(o <= i + 1e-6 for o, i in zip(outer[0], inner[0]))
        assert all(o >= i - 1e-6 for o, i in zip(outer[1], inner[1]))
        assert envelope(part).volume >= part.volume - 1e-6


def test_a_tip_that_is_not_lifted_enough_is_seen():
    """Half a millimetre of lift clears the pads; none drags the roller over them."""
    good = make_scene(variant({"calibration.retract": 0.5}), "calibration")
    shapes = shapes_of(good)
    envelopes = {p.part_no: shape_of(envelope(p)) for p in good.parts}
    assert check_motions(good, shapes, envelopes) == []
    dragged = tuple(
        Motion(
            m.name, tuple((g, *((0.0, 0.0, -0.05),) * 2) if g == "axis" else (g, a, b) for g, a, b in m.ways)
        )
        for m in good.motions[1:]
    )
    bad = Scene(good.name, good.placements, good.contacts, groups=good.groups, motions=dragged)
    met = " ".join(f.message for f in check_motions(bad, shapes, envelopes))
    assert "RO1" in met


def test_a_pressed_element_meets_the_stop_only_beyond_its_gap():
    from tactcad.parts.array.element import deflected_element
    from tactcad.parts.array.layout import Layout
    from tactcad.parts.array.stop_gap import stop_gap
    from tactcad.scenes.rigs.array import array

    design = load("macro-array")
    layout = Layout(design)
    place = layout.elements[3]
    closed = stop_gap(layout, place) * place.load_arm / place.arm
    shapes = shapes_of(array(design))
    for deflection, hits in ((0.97 * closed, False), (1.03 * closed, True)):
        pressed = deflected_element(layout, place, round(deflection, 4), 1.0)
        s = array(design, {place.number: pressed})
        shapes[pressed.part_no] = shape_of(pressed)
        met = [f for f in check_interference(s, shapes) if "ST1" in f.message and f.check == "overlap"]
        assert bool(met) is hits
