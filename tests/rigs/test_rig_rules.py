"""Every rule of the rigs has a design that breaks it; an array that a rig cannot take costs only that
scene."""

from __future__ import annotations

import re

import pytest
from variants import DROP, variant

from tactcad.design.load import names
from tactcad.design.messages import InputError
from tactcad.design.tree import Design
from tactcad.parts.array.layout import Layout
from tactcad.parts.rules import broken_rules, design_rules, load
from tactcad.scenes import chosen_scenes, left_out, scene_names
from tactcad.scenes.rig import all_rigs

WITNESSES = {
    "axles_fit_plate": {"cart.clearance": 3.0},
    "cart_cannot_tip": {"cart.wheel_base": 35.0},
    "holder_on_cart": {"cart.width": 47.0},
    "cart_clears_post": {"cart.width": 102.0},
    "holes_under_sample": {"holder.rings": 12},
    "vacuum_holds": {"holder.vacuum": 20.0},
    "plenum_takes_port": {"holder.plenum_depth": 6.0},
    "seal_fits_holder": {"holder.vacuum_diameter": 29.9, "sample.side": 32.0, "holder.margin": 3.6},
    "holder_can_be_screwed": {"holder.lid_thickness": 4.0},
    "screws_clear_sample": {"holder.margin": 6.0},
    "port_clears_cart": {"holder.floor": 1.2},
    "tip_land_clears_sample": {"sample.travel": 2.1},
    "axis_reaches_contact": {"calibration.axis_travel": 0.9},
    "calibration_bends_elastically": {"calibration.travel": 0.4},
    "roller_stays_on_pad": {"element.pad_height": 30.0},
    "weights_clear_guide": {"grasping.weight_diameter": 60.0},
}

MISFITS = {
    "stages_reach_pads": ("calibration", {"calibration.stage_travel": 30.0}),
    "mount_clears_carrier": (
        "calibration",
        {"clamp.mount_pitch_y": 84.0, "element.rear_length": 50.0, "array.row_arms": [[6.0] * 3] * 2},
    ),
    "carrier_screws_fit": ("calibration", {"clamp.carrier_thickness": 8.95, "clamp.mount_thread": "M5"}),
    "roller_clears_neighbours": ("calibration", {"array.pitch": 3.3, "array.spacer": 0.3}),
    "mount_holes_apart": (
        "calibration",
        {"clamp.mount_pitch_y": 56.0, "element.rear_length": 34.0, "clamp.carrier_screw_offset": 27.0},
    ),
    "foot_holes_apart": ("grasping", {"clamp.mount_pitch_y": 40.0, "clamp.carrier_screw_offset": 6.0}),
    "pads_on_sample": ("grasping", {"array.row_arms": [[6.0] * 9, [6.0] * 9], "sample.side": 32.0}),
    "bar_clears_screws": ("grasping", {"clamp.mount_pitch_y": 36.0, "clamp.carrier_screw_offset": 2.0}),
    "platform_clears_latch": ("grasping", {"grasping.lift": 44.1, "grasping.rail_length": 140.0}),
    "rail_is_long_enough": ("grasping", {"grasping.lift": 90.0}),
    "leads_reach_from_stages": ("calibration", {"wiring.to_board": 100.0}),
    "leads_reach_from_guide": ("grasping", {"wiring.to_board": 100.0}),
    "calibration_stays_straight": ("calibration", {"calibration.step": 0.01}),
    "sample_stand_stays_straight": ("sample-stiffness", {"sample.step": 0.001}),
    "guide_stays_straight": ("grasping", {"grasping.weights": 40}),
    "ballast_trims_moving_weight": ("grasping", {"grasping.moving_weight": 2.8}),
    "tongue_enters_slot": ("bonding", {"element.hinge_length": 0.5, "element.fillet_radius": 0.2}),
    "nest_clears_rear_body": ("bonding", {"element.seat_length": 0.8}),
    "rear_body_takes_pins": ("bonding", {"element.rear_length": 12.0}),
    "clamp_balances_on_leaf": ("bonding", {"gauge.carrier_arm_side": 1.6, "gauge.carrier_body_side": 1.0}),
    "clamp_can_be_handled": ("bonding", {"bonding.pressure": 1.0}),
    "leaf_bears_clamp": ("bonding", {"element.hinge_thickness": 0.02}),
    "glue_lies_under_foil": ("bonding", {"bonding.glue_thickness": 0.05}),
    "terminals_lie_in_recess": ("bonding", {"bonding.terminal_length": 20.0}),
    "tongue_stays_straight": ("bonding", {"bonding.sight": 0.002}),
}


def test_there_is_a_witness_for_every_rule():
    of_rigs = ("cart_rules", "calibration_rules", "grasping_rules")
    refusing = {n for n, r in design_rules().items() if r.find.__module__.endswith(of_rigs)}
    fitting = {r.name for rig in all_rigs(Design).values() for r in rig.rules}
    for name, where in [(n, "WITNESSES") for n in refusing - set(WITNESSES)] + [
        (n, "MISFITS") for n in fitting - set(MISFITS)
    ]:
        pytest.fail(f"rule {name} has no witness: add a design that breaks it to {where} in {__file__}")
    assert set(WITNESSES) == refusing and set(MISFITS) == fitting


@pytest.mark.parametrize("rule", WITNESSES)
def test_a_design_that_breaks_it_is_refused(rule):
    design = variant(WITNESSES[rule])
    assert rule in [b.check for b in broken_rules(design)]
    (found,) = design_rules()[rule](Layout(design))
    assert found.part.split(".")[0] in {"cart", "holder", "grasping", "calibration", "sample"}
    assert found.limit  # says what is legal


@pytest.mark.parametrize("rule", MISFITS)
def test_an_array_that_does_not_fit_costs_the_scene_and_says_why(rule):
    scene, changes = MISFITS[rule]
    design = variant(changes)
    assert next(r for r in all_rigs(Design)[scene].rules if r.name == rule)(Layout(design))
    assert scene not in scene_names(design)
    assert any(str(left).startswith(f"scene {scene} left out: rule ") for left in left_out(design))
    with pytest.raises(InputError, match="left out"):
        chosen_scenes(design, [scene])
    assert "array" in chosen_scenes(design, None)


@pytest.mark.parametrize(
    ("path", "changes"),
    [
        ("clamp.mount_pitch_y", {"clamp.mount_pitch_y": 100.0}),
        ("array.row_arms", {"element.rear_length": 50.0, "array.row_arms": [[6.0] * 17] * 2}),
    ],
)
def test_a_carrier_too_wide_names_a_value_of_the_field(path, changes):
    """What is found is the field's own value, and the legal one takes the carrier between the screws."""
    rule = next(r for r in all_rigs(Design)["calibration"].rules if r.name == "mount_clears_carrier")
    (found,) = rule(Layout(variant(changes)))
    legal = re.match(r"at most ([\d.]+) (?:mm|elements a row)", str(found.limit))[1]
    rows = path == "array.row_arms"
    assert (found.part, found.value) == (path, 17 if rows else changes[path])
    enough = variant({**changes, path: [[6.0] * int(legal)] * 2 if rows else float(legal)})
    assert not rule(Layout(enough))


@pytest.mark.parametrize("name", ["macro-array", "double-sample", "smallest-bearing"])
def test_the_shipped_rigs_keep_all(name):
    design = load(name)
    assert scene_names(design) == (
        "array",
        "setting",
        "wiring",
        "calibration",
        "sample-stiffness",
        "grasping",
        "bonding",
    )
    assert left_out(design) == []


@pytest.mark.parametrize("rows", [[1], [3], [1, 7], [50, 50], [500, 500]])
def test_arrays_of_any_length_are_still_built(rows):
    design = variant({"array.row_arms": [[6.0] * n for n in rows]})
    assert not [b for b in broken_rules(design) if b.check in WITNESSES]
    assert "array" in scene_names(design)


def test_a_design_without_the_tables_has_no_rigs():
    assert scene_names(load("soft-tissue")) == ("array", "setting", "wiring", "bonding")
    assert scene_names(variant({"bonding": DROP}, "soft-tissue")) == ("array", "setting", "wiring")
    assert set(names()) >= {"macro-array", "double-sample", "smallest-bearing", "soft-tissue"}
