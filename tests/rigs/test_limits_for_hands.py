"""Limits that assembling and using the parts need, on every shipped design: flat clamp faces, heads below
their face, wheels beside threads, a roller straight on its pad, and sheets as fine as their limits."""

from __future__ import annotations

from functools import cache
from itertools import product

import pytest
from variants import FACING_ROWS

from tactcad.design.family import family_of
from tactcad.drawing.parts.part_sheet import part_plan
from tactcad.parts.bought.standard_parts import GROOVE_DEPTHS, SECTION
from tactcad.parts.language.description import Hole, Part
from tactcad.parts.language.limits import general
from tactcad.parts.language.metric import METRIC
from tactcad.parts.rigs.cart import cart_layout
from tactcad.parts.rules import load
from tactcad.scenes import make_scene, scene_names

MADE = ("wire-cut", "milled", "turned", "ground")


@cache
def made(name: str) -> dict[str, Part]:
    design = load(name)
    parts = [p for scene in scene_names(design) for p in make_scene(design, scene).parts]
    return {p.part_no.removeprefix(f"{name}-"): p for p in parts if p.process in MADE}


def flatness(part: Part, face: str) -> float:
    return min((g.zone for g in part.geometric if g.symbol == "flatness" and face in g.features), default=1.0)


@pytest.mark.parametrize("name", FACING_ROWS)
def test_faces_that_others_refer_to_are_flat(name):
    for number, part in made(name).items():
        a = next((d.feature for d in part.datums if d.letter == "A"), "")
        if number.startswith("end-plate"):
            assert flatness(part, a) <= 0.005
        if number == "riser":
            assert a == "face z=0" and flatness(part, a) <= 0.01


@pytest.mark.parametrize("name", FACING_ROWS)
def test_a_head_that_is_sunk_stays_below_its_face_at_any_limits(name):
    """ISO 4762: the head is at most as high as its thread is wide."""
    for number, part in made(name).items():
        for h in (f for f in part.features if isinstance(f, Hole) and f.counterbore and not f.thread):
            thread = next(t for t, m in METRIC.items() if m.head < h.counterbore[0] <= m.head + 1.1)
            deep, head = h.counterbore[1], METRIC[thread].d
            assert deep < 0.8 * head or deep - general(deep) >= head, (number, h.name, deep)


@pytest.mark.parametrize("name", FACING_ROWS)
def test_no_wheel_rolls_over_a_thread(name):
    rig, base = cart_layout(load(name)), made(name).get("base")
    if rig is None or base is None:
        return
    half = rig.bearing.B / 2
    for h, (_, y) in product(base.features, rig.contacts):
        if h.axis[2] < 0:  # from the face on which the cart rolls
            assert abs(h.at[1] - y) >= half + h.thread_diameter / 2 + 0.3, h.name


@pytest.mark.parametrize("name", [n for n in FACING_ROWS if load(n).calibration is not None])
def test_the_roller_is_sold_and_lies_straight_on_its_pad(name):
    """ISO 8734 begins at 5 mm for 2 mm pins; the ends of a pin are chamfered by 0.35, of cut rod by 0.1."""
    design = load(name)
    roller = next(
        p for p in make_scene(design, "calibration").placements if p.designator.startswith("RO")
    ).part
    length, pin = roller.extrusion.thickness, "ISO 8734" in roller.purchase.designation
    assert length >= 5.0 if pin else "ground rod" in roller.purchase.designation
    straight = length - 2 * (0.35 if pin else 0.1)
    assert straight >= design.sheet.thickness + 2 * 0.15
    assert length / 2 <= design.array.pitch - design.sheet.thickness / 2 - 0.1 + 1e-9


@pytest.mark.parametrize("name", FACING_ROWS)
def test_sheets_state_no_size_finer_than_its_limits(name):
    design = load(name)
    for part in made(name).values():
        plan = part_plan(part, (), family_of(design).plans)
        for d in plan.dimensions:
            if not (d.limits or d.fit or d.basic or d.auxiliary):
                value = d.value(plan.values)
                assert abs(value * 100 - round(value * 100)) < 1e-6, (part.part_no, d.name, value)
            if d.sign == "⌀" and (d.limits or d.fit):
                assert d.text(plan.values).endswith("Ⓔ"), (part.part_no, d.name)


@pytest.mark.parametrize("name", FACING_ROWS)
def test_geometry_stands_in_frames_and_not_in_the_surface_finish(name):
    words = ("parallel", "square", "within", "flat ", "chamfer")
    for part in made(name).values():
        assert not [w for w in words if w in part.finish], part.finish


@pytest.mark.parametrize("name", FACING_ROWS)
def test_an_elements_holes_are_placed_by_axis_and_then_face(name):
    for number, part in made(name).items():
        if part.kind == "element":
            letters = {d.letter: d.feature for d in part.datums}
            screws = next(g for g in part.geometric if g.features == ("screw_hole",))
            assert [letters[x] for x in screws.datums] == ["dowel_hole", "flat_face"]
            lean = next(g for g in part.geometric if g.symbol == "parallelism")
            assert len(lean.features) == 2 and letters[lean.datums[0]] == "flat_face" and lean.zone <= 0.005


def test_the_seal_is_squeezed_as_its_makers_ask():
    """ISO 3601-1: 1.78 +-0.08; static face seals take 15 to 33 % (makers' handbooks)."""
    body = made("macro-array")["holder-body"]
    depth = next(c for c in body.characteristics if c.name == "seal depth")
    assert (depth.lower, depth.upper) == GROOVE_DEPTHS
    squeeze = [1 - g / s for g, s in product(GROOVE_DEPTHS, (SECTION - 0.08, SECTION + 0.08))]
    assert 0.15 < min(squeeze) and max(squeeze) < 0.33
