"""Pressed arms against closed forms, and designs in which they meet something."""

from __future__ import annotations

from dataclasses import replace
from math import asin, cos, sin

import pytest
from variants import variant

from tactcad.checks.clearance import _Arms, _mirrored, _nearest, check_clearance
from tactcad.design.load import names
from tactcad.parts.designs import load
from tactcad.parts.layout import Layout
from tactcad.parts.rigs.calibration_loads import calibration_loads
from tactcad.parts.room_rules import turns
from tactcad.parts.stop_gap import stop_gap


@pytest.mark.parametrize("name", names())
def test_what_ships_is_clear(name):
    assert check_clearance(load(name)) == []


def test_opposite_pads_come_nearer_by_what_their_height_turns():
    """The pad's lower inner corner, 2 mm below the flat face: x = -a cos w - (2 + t/2) sin w from the hinge."""
    design = variant({"stop.gaps": {"4": 0.12}, "array.row_arms": [[4], [4]]})
    layout = Layout(design)
    arms, (first, second) = _Arms(layout), layout.elements
    w = asin((0.12 + design.stop.tolerance) / 4)
    towards = (2 + 0.125) * sin(w) - 4 * (1 - cos(w))
    assert arms.most(first) == pytest.approx(w)
    one = _nearest(arms.of(first, w), map(_mirrored, arms.of(second, 0.0)))
    both = _nearest(arms.of(first, w), map(_mirrored, arms.of(second, w)))
    assert one == pytest.approx(2 - towards, abs=1e-9)
    assert both == pytest.approx(2 - 2 * towards, abs=1e-9)
    assert _nearest(arms.of(first, 0.0), map(_mirrored, arms.of(second, 0.0))) == pytest.approx(2.0)


def test_high_pads_that_meet_when_pressed_are_seen():
    changes = {"array.row_pitch": 2.2, "array.row_arms": [[4, 6], [4, 6]]}
    found = check_clearance(variant(changes))
    assert {f.part for f in found} == {"E1", "E2"}
    assert all("opposite arm" in f.message and f.value < f.limit for f in found)
    # arms that do not face each other cannot meet
    assert check_clearance(variant({**changes, "array.row_arms": [[4]]})) == []


def test_a_slot_that_closes_before_its_stop_is_seen():
    """A slot as narrow as wire cutting makes it, and a gap that turns the arm by 0.15: 2.5 mm over the hinge it closes by 0.38."""
    design = variant(
        {
            "array.row_arms": [[4]],
            "element.hinge_length": 0.25,
            "element.fillet_radius": 0.1,
            "stop.gaps": {"4": 0.6},
            "element.body_height": 3.6,
            "gauge.grid_length": 0.2,
        }
    )
    (finding,) = check_clearance(design)
    assert finding.part == "E1" and "own body" in finding.message


def test_the_calibration_turns_an_arm_further_than_its_stop_would():
    """Without stop plate: the gauge gives way a little, K_g/(K_g + K) of the travel stays for the pad."""
    design = variant({"array.row_arms": [[8.0], [8.0]], "calibration.travel": 0.35})
    layout = Layout(design)
    (load, _) = calibration_loads(design)
    tip = load.deflection * 8 / 7
    assert tip > stop_gap(layout, layout.elements[0]) + design.stop.tolerance
    assert _Arms(layout).most(layout.elements[0]) == pytest.approx(asin(tip / 8))
    assert turns(Layout(replace(design, calibration=None)))[0] < asin(tip / 8)


def test_an_arm_too_near_its_neighbour_is_seen_with_part_place_and_number():
    """0.11 mm of spacer, less 0.1 of sheet and 0.01 of spacer."""
    found = check_clearance(variant({"array.row_arms": [[6, 6]], "array.pitch": 3.11, "array.spacer": 0.11}))
    assert [(f.part, f.message.split(";")[0]) for f in found] == [
        ("E1", "the arm stands 0.110 mm beside EP1"),
        ("E1", "the arm stands 0.110 mm beside E2"),
        ("E2", "the arm stands 0.110 mm beside E1"),
        ("E2", "the arm stands 0.110 mm beside EP2"),
    ]
    # E1's mid-plane at y = -1.555: its sides 1.5 mm to both sides, its tip at x = 1
    assert [f.place for f in found[:2]] == [
        pytest.approx((1.0, -3.055, 0.0)),
        pytest.approx((1.0, -0.055, 0.0)),
    ]
    assert all(f.value == pytest.approx(0.11) and f.limit == pytest.approx(0.11) for f in found)
    assert (
        check_clearance(variant({"array.row_arms": [[6, 6]], "array.pitch": 3.13, "array.spacer": 0.13}))
        == []
    )


def test_a_blank_is_a_neighbour_too():
    found = check_clearance(
        variant({"array.row_arms": [[6, 6], [6]], "array.pitch": 3.1, "array.spacer": 0.1})
    )
    assert {"a blank"} == {f.message.split("beside ")[1].split(";")[0] for f in found if f.part == "E3"} - {
        "EP1",
        "EP2",
    }


def test_an_arm_that_would_meet_the_stop_plate_beside_its_land_is_seen():
    """The land stands 0.13 mm over the arm, whose back, 2.6 of 4 mm out, comes 0.035 less high than the tip."""
    (finding,) = check_clearance(
        variant(
            {
                "array.row_arms": [[4]],
                "stop.gaps": {"4": 0.1},
                "element.body_height": 2.83,
                "tolerance.arm_height": 0.2,
            }
        )
    )
    assert finding.part == "E1" and "stop plate" in finding.message
    assert finding.value == pytest.approx(0.165, abs=0.01) and finding.limit == 0.2


def test_leads_without_room_are_seen():
    (finding,) = check_clearance(
        variant({"array.row_arms": [[6]], "element.recess_depth": 0.2, "element.corner_radius": 0.15})
    )
    assert "0 leads of 0.25 mm fit into its wire recess of 4 x 0.2 mm, it has 3" in finding.message
    assert finding.place[0] == pytest.approx(1 + 6 + 0.44 + 1.96 + 1.6)
    # 0.6 mm wide and 0.5 deep: two in a row, two rows
    narrow = {
        "array.row_arms": [[6]],
        "sheet.thickness": 0.4,
        "array.spacer": 0.2,
        "array.pitch": 0.6,
        "tolerance.sheet_thickness": 0.01,
    }
    assert check_clearance(variant({**narrow, "element.recess_depth": 0.5})) == []
    assert [f.value for f in check_clearance(variant({**narrow, "element.recess_depth": 0.45}))] == [2]


def test_a_gauge_that_would_touch_the_object_is_seen():
    """Lead of 0.25 and 0.03 of backing under a pad of 0.27."""
    (finding,) = check_clearance(
        variant({"array.row_arms": [[6]], "element.pad_height": 0.27, "element.pad_root_radius": 0.2})
    )
    assert "gauge and leads stand 0.280 mm out" in finding.message and finding.value == pytest.approx(0.27)
