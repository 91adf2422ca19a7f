"""Pressed arms against closed forms, and designs in which they meet something."""

from __future__ import annotations

from dataclasses import replace
from math import asin, cos, sin

import pytest
from variants import FACING_ROWS, variant

from tactcad.checks.facing_rows.overload_stop import _Arms, _mirrored, _nearest, check_clearance
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.stop_gap import seat, stop_gap
from tactcad.parts.rigs.stiffness import calibration_loads
from tactcad.parts.rules import load
from tactcad.parts.rules.pressed_rules import turns


@pytest.mark.parametrize("name", FACING_ROWS)
def test_what_ships_is_clear(name):
    assert check_clearance(load(name)) == []


def test_opposite_pads_come_nearer_by_what_their_height_turns():
    """The pad's lower inner corner, 2 mm below the flat face: x = -a cos w - (2 + t/2) sin w from the
    hinge."""
    design = variant({"stop.gaps": {"4": 0.12}, "array.row_arms": [[4], [4]]})
    layout = Layout(design)
    arms, (first, second) = _Arms(layout), layout.elements
    give = (
        layout.stop_give * design.rating.overload_force * (4 - 1) / 4
    )  # the plate's, under the load at 3 of 4 mm
    w = asin((0.12 + design.stop.tolerance + seat(layout) + give) / 4)
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
    """A slot as narrow as wire cutting makes it, and a gap that turns the arm by 0.15: 2.5 mm over the hinge
    it closes by 0.38."""
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


def test_an_arm_that_would_meet_the_stop_plate_beside_its_land_is_seen():
    """The land stands 0.13 mm over the arm, whose back, 2.6 of 4 mm out, comes 0.035 less high than the
    tip."""
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
