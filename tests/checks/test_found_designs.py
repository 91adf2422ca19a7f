"""Designs that the random draws found: let pass once by every rule, and then not built, or caught by a check.

Each is the shipped array with the fewest values changed that still show it, and is now refused by the rule
named, or passes every check.
"""

from __future__ import annotations

from operator import attrgetter

import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from variants import IN_SLOT, variant

from tactcad.checks.on_solids.soundness import check_brep
from tactcad.contour import LEAST_EDGE
from tactcad.design.messages import CheckFailure, InputError
from tactcad.parts.array.element import element, outline
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.stop_gap import stop_gap
from tactcad.parts.rules import broken_rules
from tactcad.scenes import left_out, scene_names
from tactcad.solids.build import build

TWO = {"array.row_arms": [[8.0], [8.0]]}

REFUSED = {
    "half a micrometre of flat face between pad root and slot": (
        "no_slivers",
        {
            "element.sides": "two",
            "array.row_arms": [[2.7405]],
            "element.arm_height": 1.8,
            "element.body_height": 2.6,
            "stop.land_length": 0.2,
            **IN_SLOT,
        },
    ),
    "an M3 tap through 9.1 mm of carrier": ("carrier_can_be_screwed", {"clamp.carrier_thickness": 9.1}),
    "heads of the carrier's screws flush under what lies on it": (
        "carrier_can_be_screwed",
        {"clamp.carrier_thickness": 5.7},
    ),
    "a 3 mm reamer through 30.5 mm of end plate": (
        "end_plate_takes_holes",
        {"clamp.end_plate_thickness": 30.5},
    ),
    "the flat tip's body pressed into the sample": ("tip_land_clears_sample", {"sample.travel": 2.1}),
    "a tip pressed through a thin sample": ("tip_land_clears_sample", {"sample.thickness": 0.4}),
    "the axle's bore 0.26 mm from the holder's thread": ("axles_fit_plate", {"cart.wheel_base": 47.2}),
    "a calibration that bends a stiff, weak hinge beyond yield": (
        "calibration_bends_elastically",
        {"calibration.travel": 0.4},
    ),
    "a wire recess that parts the ledge from the rear body": (
        "recess_fits_rear",
        {"element.recess_offset": 0.0, "element.recess_depth": 3.2},
    ),
    "the hose fitting on the cart plate": ("port_clears_cart", {"holder.floor": 1.0}),
}

LEFT_OUT = {
    "500 N on a cart of its size": ("guide_stays_straight", {"grasping.moving_weight": 500.0}),
    "ballast of no thickness": ("ballast_trims_moving_weight", {"grasping.moving_weight": 2.735}),
    "the roller's holder on the neighbouring pads": ("roller_clears_neighbours", {"calibration.travel": 1.0}),
    "screws of carrier and bar through each other in the foot": (
        "foot_holes_apart",
        {
            "clamp.mount_pitch_y": 24.1,
            "array.row_arms": [[3.0]],
            "clamp.carrier_screw_offset": 3.0,
            "gauge.carrier_arm_side": 0.5,
        },
    ),
    "heads of the screws into the carrier through each other": (
        "carrier_screws_fit",
        {"clamp.mount_pitch_y": 6.0},
    ),
}

PASSES = {
    "a flat tip wider than its round body": (
        {"sheet.thickness": 10.0, "array.pitch": 11.0, "stop.tolerance": 0.015},
        "sample-stiffness",
    ),
    "an arm too low for the estimator, pressed in calibration": (
        {"element.hinge_length": 9.0, "array.row_arms": [[12.0]]},
        "calibration",
    ),
    "holder's screws 8.8 mm in the cart plate, whose thread ended at 7.5": (
        {"holder.floor": 5.2},
        "sample-stiffness",
    ),
    "holder's screws in a cart plate thicker than a drill reaches": (
        {"cart.thickness": 40.0},
        "sample-stiffness",
    ),
    "clamping screws 13 mm in a plate of 20 mm, whose thread ends at 9": (
        {"clamp.end_plate_thickness": 20.0},
        "array",
    ),
    "pads no deeper in the sample than their root fillets": ({"sample.travel": 1.8}, "grasping"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_refused_by_its_rule(what):
    rule, changes = REFUSED[what]
    assert rule in [b.check for b in broken_rules(variant({**TWO, **changes}))]


@pytest.mark.parametrize("what", LEFT_OUT)
def test_the_scene_that_cannot_take_it_is_left_out_by_its_rule(what):
    rule, changes = LEFT_OUT[what]
    design = variant({**TWO, **changes})
    assert broken_rules(design) == []
    assert any(left.why.check == rule for left in left_out(design))


@pytest.mark.nightly
@pytest.mark.cad
@pytest.mark.parametrize("what", PASSES)
def test_passes_every_check(what):
    from tactcad.checks.run import run_checks

    changes, scene = PASSES[what]
    design = variant({**TWO, **changes})
    assert broken_rules(design) == [] and scene in scene_names(design)
    assert [str(f) for f in run_checks(design, [scene]).failures] == []


def test_the_derived_set_screw_leaves_the_stop_plate_its_gap():
    """The shortest set screw that reaches came out 0.04 mm over the stop plate, which the rules refused: the
    next one."""
    for thickness in (3.0, 4.0, 5.0, 6.0, 6.001, 6.04, 6.1, 7.0):
        layout = Layout(variant({**TWO, "clamp.stop_plate_thickness": thickness}))
        assert layout.hold_down.reach >= 0.1


def test_set_screws_stand_in_mirrored_places_to_the_last_digit():
    """Two rows' places, rounded to a micrometre's thousandth, once differed in that digit: one hole counted
    as two."""
    for pitch in (29.917, 7.001, 5.123, 13.77777):
        for apart in (5.0, 6.321, 13.151, 17.0):
            changes = {
                "array.row_arms": [[4.0] * 8] * 2,
                "array.pitch": pitch,
                "clamp.hold_down_pitch": apart,
            }
            y = Layout(variant(changes)).hold_down_y
            assert y == tuple(-v for v in reversed(y))


@pytest.mark.cad
@pytest.mark.parametrize("short", [0.001, 0.0010000001, 0.00099, 0.0011])
@pytest.mark.parametrize("sides", ["one", "two"])
def test_an_edge_at_the_limit_is_the_same_to_rule_and_check(short, sides):
    """A slot floor of 0.001 mm between its fillets: the rule had taken it, the solid's edge was "under
    0.001"."""
    both = {
        "array.row_arms": [[4.0]],
        "element.sides": sides,
        "element.body_height": 3.6 if sides == "two" else 3.0,
    }
    design = variant({**both, "element.hinge_length": round(0.6 + short, 10)})
    refused = [b.check for b in broken_rules(design) if b.check == "no_slivers"]
    layout = Layout(design)
    part = element(layout, layout.elements[0])
    tiny = [f for f in check_brep(part, build(part)) if f.check == "tiny-edge"]
    assert bool(refused) == bool(tiny) == (short < 0.001)


MOVED = (
    "element.hinge_length",
    "element.arm_height",
    "element.body_height",
    "element.pad_length",
    "element.pad_height",
    "element.seat_length",
    "element.recess_depth",
    "element.recess_offset",
    "element.rear_height",
    "element.rear_length",
    "stop.land_length",
    "holes.web",
)


def pieces(design) -> dict[str, float]:
    """Lengths (mm) of the named pieces of the first element's contour."""
    layout = Layout(design)
    p = layout.elements[0]
    return {s.name: s.length for s in outline(layout, p.arm, p.hinge, stop_gap(layout, p)) if s.name}


def slope(changes: dict, path: str, piece: str) -> float:
    """How much longer the piece is for each mm more of the field."""
    beside = {**changes, path: attrgetter(path)(variant(changes)) + 1e-4}
    return (pieces(variant(beside))[piece] - pieces(variant(changes))[piece]) / 1e-4


def at_the_limit(changes: dict, path: str, piece: str, length: float) -> dict:
    """The design with the field moved, by two secants, so that the piece is that long (mm)."""
    for _ in range(2):
        value = attrgetter(path)(variant(changes))
        missing = length - pieces(variant(changes))[piece]
        changes = {**changes, path: round(value + missing / slope(changes, path, piece), 9)}
    return changes


@pytest.mark.slow  # hundreds of pieces of a search
@pytest.mark.cad
def test_no_piece_near_the_limit_passes_the_rule_and_fails_the_check():
    """Any field that makes any piece short, moved until the piece is 0.001 mm long but for 1e-3 to 1e-6 mm.

    What the rules accept has no edge that the check on the built solid finds too short.
    """
    bases = {
        sides: {
            "array.row_arms": [[4.0]],
            "element.sides": sides,
            "element.body_height": height,
            "calibration.travel": 0.1,  # short hinges yield sooner
            **(IN_SLOT if sides == "two" else {}),
        }
        for sides, height in (("one", 3.0), ("two", 3.6))
    }
    moves = [
        (sides, path, piece)
        for sides, base in bases.items()
        for piece in sorted(pieces(variant(base)))
        for path in MOVED
        if abs(slope(base, path, piece)) > 1e-6
    ]
    judged = {"accepted": 0, "slivers": 0}

    @settings(max_examples=80, derandomize=True, deadline=None, phases=[Phase.generate])
    @given(st.sampled_from(moves), st.floats(-6, -3), st.booleans())
    def each(move, digits, longer):
        sides, path, piece = move
        off = 10.0**digits * (1 if longer else -1)
        try:
            design = variant(at_the_limit(bases[sides], path, piece, LEAST_EDGE + off))
        except (InputError, CheckFailure, ValueError, ZeroDivisionError, KeyError):
            return  # out of the field's range, no contour, or the piece is gone
        refused = [b.check for b in broken_rules(design)]
        judged["slivers"] += refused == ["no_slivers"]
        if refused:
            return
        judged["accepted"] += 1
        layout = Layout(design)
        part = element(layout, layout.elements[0])
        assert [f for f in check_brep(part, build(part)) if f.check == "tiny-edge"] == [], move

    each()
    assert judged["accepted"] >= 5 and judged["slivers"] >= 5, judged
