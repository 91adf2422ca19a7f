"""The element's outline measured against the design, and its number."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations
from math import atan2, cos, hypot, pi, sin, sqrt

import pytest
from variants import variant

from tactcad.contour import Arc, Contour, Line, Segment
from tactcad.design.tree import Design
from tactcad.parts.array.element import element, element_number
from tactcad.parts.array.layout import ElementPlace, Layout
from tactcad.parts.array.stop_gap import seat
from tactcad.parts.language.description import Part

ONE_SIDED = variant()
TWO_SIDED = variant({"element.sides": "two", "element.body_height": 3.6, "array.row_arms": [[4, 6.25], [5]]})
SOFT = variant({}, base="soft-tissue")
OVERRIDDEN = variant(
    {
        "element.override.2.hinge_thickness": 0.3,
        "element.override.3.fillet_radius": 0.44,  # a full round: half the slot's length
        "element.override.4.hinge_length": 1.2,
        "element.override.5.arm_height": 2.4,
    }
)
DESIGNS = {"one-sided": ONE_SIDED, "two-sided": TWO_SIDED, "soft": SOFT, "overridden": OVERRIDDEN}
PLACES = [
    pytest.param(design, place, id=f"{name}-E{place.number}")
    for name, design in DESIGNS.items()
    for place in Layout(design).elements
]


def outline(design: Design, place: ElementPlace) -> tuple[Part, Contour]:
    part = element(Layout(design), place)
    return part, part.body.outer


def heights(contour: Contour, x: float) -> list[float]:
    """z of every crossing of the vertical line at x, from below."""
    found = []
    for s in contour:
        if isinstance(s, Line):
            (x0, z0), (x1, z1) = s.start, s.end
            if min(x0, x1) < x < max(x0, x1):
                found.append(z0 + (z1 - z0) * (x - x0) / (x1 - x0))
        elif abs(x - s.centre[0]) < s.radius:
            for sign in (1, -1):
                dz = sign * sqrt(s.radius**2 - (x - s.centre[0]) ** 2)
                if s.spans(atan2(dz, x - s.centre[0])):
                    found.append(s.centre[1] + dz)
    return sorted(found)


def tangent(s: Segment, at_end: bool) -> tuple[float, float]:
    if isinstance(s, Line):
        return ((s.end[0] - s.start[0]) / s.length, (s.end[1] - s.start[1]) / s.length)
    angle = s.end_angle if at_end else s.start_angle
    side = 1 if s.ccw else -1
    return (-side * sin(angle), side * cos(angle))


@pytest.mark.parametrize(("design", "place"), PLACES)
def test_thicknesses_measured_on_the_contour(design, place):
    layout, e, hinge = Layout(design), design.element, place.hinge
    _, contour = outline(design, place)
    half_pad, x_hinge = (design.array.row_pitch - e.pad_length) / 2, place.hinge_x
    assert x_hinge - half_pad == pytest.approx(place.arm, abs=1e-12)

    below, above = heights(contour, x_hinge)[:2]
    assert above - below == pytest.approx(hinge.t, abs=1e-9)
    assert below == pytest.approx(0.0 if e.sides == "one" else (hinge.h - hinge.t) / 2, abs=1e-9)
    # nowhere thinner along the slot, and thicker in its corners
    for k in range(1, 40):
        low, high = heights(contour, x_hinge - hinge.l / 2 + hinge.l * k / 40 + 1e-6)[:2]
        assert high - low >= hinge.t - 1e-9
    near_wall = heights(contour, x_hinge - hinge.l / 2 + 0.05 * hinge.r)[:2]
    assert near_wall[1] - near_wall[0] > hinge.t + 0.5 * hinge.r
    # the slot's own length, just over its fillets
    over = [s for s in contour if s.name in ("slot_arm_wall", "slot_body_wall")]
    assert max(s.start[0] for s in over) - min(s.start[0] for s in over) == pytest.approx(hinge.l, abs=1e-9)

    arm = heights(contour, x_hinge - hinge.l / 2 - 1e-6)
    assert (arm[0], arm[-1]) == pytest.approx((0.0, hinge.h), abs=1e-9)
    body = heights(contour, x_hinge + hinge.l / 2 + 1e-6)
    assert body[-1] - body[0] == pytest.approx(e.body_height, abs=1e-9)
    assert body[-1] == pytest.approx(layout.ledge, abs=1e-9), "every ledge carries the stop plate"

    pad = heights(contour, half_pad + e.pad_length / 2)
    assert pad[0] == pytest.approx(-e.pad_height, abs=1e-9)
    recess = heights(contour, layout.recess_start + e.corner_radius + 1e-6)
    assert recess[0] == pytest.approx(e.recess_depth, abs=1e-9)
    rear = heights(contour, layout.rear_end - 1e-6)
    assert (rear[0], rear[-1]) == pytest.approx((e.recess_depth, e.rear_height), abs=1e-9)
    assert contour.box == pytest.approx(
        (half_pad, min(-e.pad_height, body[0]), layout.rear_end, e.rear_height), abs=1e-9
    )


@pytest.mark.parametrize(("design", "place"), PLACES)
def test_the_stop_lands_gap_and_length(design, place):
    layout, stop = Layout(design), design.stop
    part, contour = outline(design, place)
    gap = next(c.nominal for c in part.characteristics if c.name == "stop gap")
    tip = layout.pad_inner
    for x in (tip + 1e-6, tip + stop.land_length - 1e-6):
        assert layout.ledge - heights(contour, x)[-1] == pytest.approx(gap, abs=1e-9)
    assert 0 < stop.tolerance < gap
    # beyond the land nothing of the arm stands nearer the stop plate
    for k in range(1, 60):
        x = tip + stop.land_length + (place.arm - place.hinge.l / 2 - stop.land_length) * k / 60
        assert heights(contour, x)[-1] <= layout.ledge - gap + 1e-9


def test_stop_gaps_of_the_paper_arms_are_below_yield_and_grow_with_the_arm():
    """Worked by hand for a rigid plate on each element's own ledge 0.13, 0.16, 0.19, 0.22, 0.25 mm; one plate
    on all ledges takes up to `seat` of it, and travel at yield is the bound that counts."""
    layout = Layout(ONE_SIDED)
    gaps = {}
    for place in layout.elements:
        part = element(layout, place)
        gaps[place.arm] = next(c.nominal for c in part.characteristics if c.name == "stop gap")
    ordered = [gaps[a] for a in (4.0, 5.0, 6.0, 7.0, 8.0)]
    assert ordered == sorted(ordered) and len(set(ordered)) == 5
    worked = [0.13, 0.16, 0.19, 0.22, 0.25]
    assert ordered == pytest.approx([g - seat(layout) for g in worked], abs=0.035)


@pytest.mark.parametrize(("design", "place"), PLACES)
def test_every_fillet_runs_on_tangentially(design, place):
    _, contour = outline(design, place)
    joints = 0
    for before, after in zip((contour.segments[-1], *contour), contour):
        if isinstance(before, Arc) != isinstance(after, Arc) or isinstance(before, Arc):
            (ax, ay), (bx, by) = tangent(before, True), tangent(after, False)
            if "fillet" in before.name + after.name or "root" in before.name + after.name:
                assert hypot(ax - bx, ay - by) < 1e-7, f"{before.name} to {after.name}"
                joints += 1
    assert joints >= 10
    for s in contour:
        if isinstance(s, Arc):
            assert s.radius == pytest.approx(hypot(s.end[0] - s.centre[0], s.end[1] - s.centre[1]), abs=1e-9)


def test_a_full_round_is_one_arc_in_the_slot():
    place = Layout(OVERRIDDEN).elements[2]
    _, contour = outline(OVERRIDDEN, place)
    (arc,) = [s for s in contour if isinstance(s, Arc) and "slot" in s.name]
    assert abs(arc.sweep) == pytest.approx(pi)
    assert arc.centre == pytest.approx((place.hinge_x, place.hinge.t + 0.44))


def test_a_full_round_given_to_nine_digits_is_one_too():
    """2 r = l but for the last digits, by more than what the contour itself takes as rounding."""
    large = variant(
        {"element.override.3.hinge_length": 0.888888888, "element.override.3.fillet_radius": 0.444444446}
    )
    place = Layout(large).elements[2]
    _, contour = outline(large, place)
    (arc,) = [s for s in contour if isinstance(s, Arc) and "slot" in s.name]
    assert abs(arc.sweep) == pytest.approx(pi, abs=1e-12)


@pytest.mark.parametrize("design", DESIGNS.values(), ids=DESIGNS)
def test_holes_are_in_line_with_the_webs_that_the_design_asks_for(design):
    layout = Layout(design)
    openings = {place.number: element(layout, place).body.openings for place in layout.elements}
    assert len(set(openings.values())) == 1, "one clamp for all arm lengths"
    part, contour = outline(design, layout.elements[0])
    circles = [c.as_circle() for c in part.body.openings]
    assert len(circles) == len(design.holes.screw_offsets) + len(design.holes.dowel_offsets)
    for (x, z), r in circles:
        low, *_, high = heights(contour, x)
        web = min(z - r - low, high - z - r, x - r - layout.clamp_edge, layout.rear_end - x - r)
        assert web >= design.holes.web - 0.02
    dowels = [r for (x, _), r in circles if any(abs(x - d) < 1e-9 for d in layout.dowel_x)]
    h = design.holes
    assert all(h.dowel_hole < 2 * r < h.dowel_hole + h.dowel_hole_upper for r in dowels)


def test_the_closed_form_area_of_a_plain_element():
    """Counted by hand: rectangles and triangles, less corners of r^2 (1 - pi/4), for sharp-edged sizes."""
    design = variant({"array.row_arms": [[6]]})
    layout = Layout(design)
    (place,) = layout.elements
    part, _ = outline(design, place)
    e, t = design.element, place.hinge
    gap = next(c.nominal for c in part.characteristics if c.name == "stop gap")
    land = e.body_height - gap
    square = 1 - pi / 4  # a corner of 90 degrees, times r^2
    arm = (6 - t.l / 2) * t.h + 1.0 * (land - t.h) + (land - t.h) ** 2 / 2
    slot = t.l * t.t + 2 * square * t.r**2
    front = (layout.clamp_edge - place.hinge_x - t.l / 2) * e.body_height
    rear = e.rear_length * e.rear_height - (e.rear_length - e.recess_offset) * e.recess_depth
    corners = square * (e.pad_root_radius**2 + 2 * e.corner_radius**2)
    ramp = e.corner_radius**2 * (sqrt(2) - 1 - pi / 8)  # tan(w/2) - w/2, w = 45 degrees
    area = 2 * 2 + arm + slot + front + rear + corners + ramp
    assert part.body.outer.area == pytest.approx(area, rel=1e-12)
    holes = 2 * pi * 1.7**2 + pi * (3.015 / 2) ** 2
    assert part.volume == pytest.approx(3 * (area - holes), rel=1e-12)


# --- numbers ---


def parts_by_number(design: Design) -> dict[str, Part]:
    layout = Layout(design)
    return {p.part_no: p for p in (element(layout, place) for place in layout.elements)}


def test_equal_elements_share_a_number_and_different_ones_never_do():
    for design in DESIGNS.values():
        layout = Layout(design)
        numbers: dict[str, Part] = {}
        for place in layout.elements:
            part = element(layout, place)
            assert numbers.setdefault(part.part_no, part) == part
        assert len(set(numbers.values())) == len(numbers)
    assert len(parts_by_number(ONE_SIDED)) == 5
    assert len(parts_by_number(OVERRIDDEN)) == 8  # a4, a5, a7 and a8 as designed, and four of their own


@pytest.mark.parametrize(
    ("field", "value"),
    [("hinge_thickness", 0.3), ("hinge_length", 1.0), ("fillet_radius", 0.2), ("arm_height", 2.5)],
)
def test_whatever_an_override_changes_is_in_the_number(field, value):
    found = parts_by_number(variant({"array.row_arms": [[6, 6]], f"element.override.2.{field}": value}))
    assert len(found) == 2 and all(
        f"{value:g}" in number for number in set(found) - {"macro-array-element-a6mm"}
    )


def test_numbers_do_not_depend_on_the_order_of_the_list():
    arms = [4, 5.5, 6]
    reference = parts_by_number(variant({"array.row_arms": [arms]}))
    assert set(reference) == {
        "macro-array-element-a4mm",
        "macro-array-element-a5.5mm",
        "macro-array-element-a6mm",
    }
    for order in permutations(arms):
        assert parts_by_number(variant({"array.row_arms": [list(order)]})) == reference
    assert parts_by_number(variant({"array.row_arms": [[6, 6], [4, 5.5]]})) == reference


def test_an_override_equal_to_the_design_changes_nothing():
    plain = variant({"array.row_arms": [[4, 4]]})
    said = variant({"array.row_arms": [[4, 4]], "element.override.2.hinge_thickness": 0.25})
    assert parts_by_number(said) == parts_by_number(plain)


def test_numbers_that_round_alike_stay_apart():
    place = Layout(ONE_SIDED).elements[0]
    values = (0.3, 0.30000000000000004, 0.3 + 1e-7, 0.25)
    numbers = {element_number(ONE_SIDED, replace(place, hinge=replace(place.hinge, t=t))) for t in values}
    assert len(numbers) == 4
    arms = (4.0, 4.000001, 4.0000000000000009)
    assert len({element_number(ONE_SIDED, replace(place, arm=a)) for a in arms}) == 3
