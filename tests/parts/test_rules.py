"""Every rule has designs that break it and nothing else; designs that keep all of them are never refused."""

from __future__ import annotations

import re
from dataclasses import fields, is_dataclass

import pytest
from built import shapes_of
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from sound_designs import sound_designs
from traced_parts import asked_parts, unnamed
from variants import DROP, IN_SLOT, ORIGIN, ROCKING_BLANK, ROCKING_PLATE, table, variant

from tactcad.design.family import section_types
from tactcad.design.load import from_table, names, paths
from tactcad.design.messages import InputError
from tactcad.design.tree import Design
from tactcad.parts.array.layout import Layout
from tactcad.parts.language.description import Part
from tactcad.parts.rules import broken_rules, design_rules, load, refuse_broken
from tactcad.parts.rules.gauge_rules import leads_that_fit
from tactcad.scenes import make_scene

MACRO = "macro-array"
THIN = {
    "sheet.thickness": 0.5,
    "array.spacer": 0.5,
    "array.pitch": 1.0,
    "gauge.carrier_width": 0.5,
    "gauge.grid_width": 0.4,
}
ONE = {"array.row_arms": [[4.0]]}
FIFTY_A_ROW = {"array.row_arms": [[4, 7, 6, 8, 6] * 10, [8, 5, 4, 5, 7] * 10]}
TWO_SIDED = {**ONE, **IN_SLOT, "element.sides": "two", "element.body_height": 3.6}

# rule -> designs that break it alone: what is changed, and the field that the message points at
WITNESSES = {
    "override_names_element": [({"element.override.11.hinge_thickness": 0.2}, "element.override.11")],
    "gaps_name_an_arm": [
        ({"stop.gaps": {"4.1": 0.05}}, "stop.gaps.4.1"),
        ({"stop.gaps": {"4": 0.05, "40": 0.05}}, "stop.gaps.40"),
    ],
    "stop_plate_stays": [
        (
            {**FIFTY_A_ROW, "clamp.hold_down_pitch": 200.0, "clamp.stop_plate_thickness": 2.5},
            "clamp.hold_down_pitch",
        ),
        ({**FIFTY_A_ROW, "clamp.hold_down_pitch": 200.0}, "clamp.hold_down_pitch"),
    ],
    "pitch_is_sheet_and_spacer": [
        ({"array.spacer": 1.1}, "array.spacer"),
        ({"array.pitch": 4.5}, "array.spacer"),
        ({"sheet.thickness": 3.1}, "array.spacer"),
    ],
    "arms_clear_opposite_row": [
        ({"array.row_pitch": 2.0}, "array.row_pitch"),
        ({"array.row_pitch": 0.1}, "array.row_pitch"),
        ({"element.pad_length": 3.95, "array.row_arms": [[6], [6]]}, "array.row_pitch"),
    ],
    "hinge_thinner_than_arm": [
        ({"element.hinge_thickness": 3.0}, "element.hinge_thickness"),
        ({"element.hinge_thickness": 2.6}, "element.hinge_thickness"),
        ({"element.hinge_thickness": 2.4}, "element.fillet_radius"),
        ({"element.override.3.hinge_thickness": 2.5}, "element.fillet_radius"),
        ({"element.override.3.hinge_thickness": 2.7}, "element.override.3.hinge_thickness"),
        ({**TWO_SIDED, "element.hinge_thickness": 2.2}, "element.fillet_radius"),
    ],
    "hinge_outlasts_its_tolerance": [
        ({"tolerance.hinge_thickness": 0.1}, "tolerance.hinge_thickness"),
        (
            {"tolerance.hinge_thickness": 0.05, "element.override.3.hinge_thickness": 0.19},
            "tolerance.hinge_thickness",
        ),
    ],
    "fillets_fit_slot": [
        ({"element.fillet_radius": 0.441}, "element.fillet_radius"),
        ({"element.hinge_length": 0.59}, "element.fillet_radius"),
        ({"element.override.4.fillet_radius": 0.6}, "element.override.4.fillet_radius"),
    ],
    "friction_leaves_the_arm_free": [
        ({"rating.friction": 0.8, "element.pad_height": 4.0, "holes.height": 5.0}, "rating.friction")
    ],
    "ledges_in_one_plane": [
        (
            {**TWO_SIDED, "array.row_arms": [[4, 4]], "element.override.2.arm_height": 2.7},
            "element.override.2.arm_height",
        )
    ],
    "slot_clears_pad": [
        ({"array.row_arms": [[6], [2.7]], "gauge.carrier_arm_side": 0.3}, "array.row_arms[1][0]"),
        ({**TWO_SIDED, "array.row_arms": [[2.7]]}, "array.row_arms[0][0]"),
    ],
    "pad_root_fits_pad": [
        ({"element.pad_height": 0.29}, "element.pad_root_radius"),
        ({"element.pad_root_radius": 2.1, "array.row_arms": [[6]]}, "element.pad_root_radius"),
    ],
    "pad_stands_out_of_body": [
        (
            {
                **TWO_SIDED,
                "element.body_height": 7.0,
                "element.rear_height": 12.0,
                "clamp.spacer_drop": 4.1,
                "stop.land_length": 0.3,
            },
            "element.pad_height",
        ),
        ({**TWO_SIDED, "element.pad_height": 0.55, "element.pad_root_radius": 0.2}, "element.pad_height"),
    ],
    "gauge_fits_face": [
        ({"gauge.carrier_arm_side": 1.71}, "gauge.carrier_arm_side"),
        ({"gauge.carrier_body_side": 4.1}, "gauge.carrier_body_side"),
        ({**TWO_SIDED, "gauge.grid_length": 0.9}, "gauge.grid_length"),
    ],
    "gauge_lies_in_slot": [
        ({**TWO_SIDED, "gauge.carrier_arm_side": 0.15}, "element.sides"),
        ({**TWO_SIDED, "gauge.carrier_body_side": 1.0}, "element.sides"),
    ],
    "arms_clear_neighbours": [
        ({"array.spacer": 0.06, "array.pitch": 3.06, "tolerance.sheet_thickness": 0.01}, "array.spacer"),
        ({"array.spacer": 0.12, "array.pitch": 3.12}, "array.spacer"),
    ],
    "gauge_fits_width": [
        ({"gauge.carrier_width": 3.1}, "gauge.carrier_width"),
        ({"gauge.grid_width": 1.6}, "gauge.grid_width"),
        ({"gauge.grid_length": 2.5}, "gauge.grid_length"),
    ],
    "leads_have_room": [
        (
            {"element.recess_depth": 0.2, "element.corner_radius": 0.15, "element.pad_root_radius": 0.2},
            "element.recess_depth",
        ),
        ({"element.pad_height": 0.27, "element.pad_root_radius": 0.2}, "element.pad_height"),
    ],
    "land_stands_over_arm": [({"tolerance.arm_height": 0.4}, "tolerance.arm_height")],
    "slots_stay_open": [
        (
            {
                "tolerance.hinge_length": 0.5,
                "element.hinge_length": 0.55,
                "element.fillet_radius": 0.25,
                "calibration.travel": 0.135,  # a short hinge yields sooner
            },
            "element.hinge_length",
        )
    ],
    "pressed_arms_clear_opposite_row": [
        ({"array.row_pitch": 2.2}, "array.row_pitch"),
        ({"tolerance.load_arm": 1.0}, "array.row_pitch"),
    ],
    "ledge_below_rear": [
        ({"clamp.stop_plate_gap": 0.25}, "clamp.stop_plate_gap"),
        (
            {"element.body_height": 7.5, "stop.land_length": 0.1, "array.row_arms": [[9]]},
            "element.rear_height",
        ),
        (
            {"clamp.stop_plate_gap": 0.8, "element.corner_radius": 0.8, "element.recess_depth": 0.8},
            "element.seat_length",
        ),
    ],
    "reading_within_period": [({"readout.period": 0.004}, "readout.period")],
    "amplifier_has_gain": [
        ({"readout.gain": 50}, "readout.gain"),
        ({"readout.amplifier": "AD620", "readout.gain": 2000, "readout.excitation": 0.3}, "readout.gain"),
    ],
    "supplies_suit_parts": [
        ({"readout.supply_positive": 19.0, "readout.supply_negative": -15.0}, "readout.supply_positive"),
        ({"readout.amplifier": "AD623", "readout.supply_positive": 8.0}, "readout.supply_positive"),
    ],
    "boards_have_inputs": [({"readout.inputs": 1}, "readout.inputs")],
    "gauge_bears_power": [
        ({"readout.on_time": 0.2}, "readout.on_time"),
        (
            {"readout.excitation": 7.0, "readout.gain": 10, "readout.supply_positive": 9.0},
            "readout.excitation",
        ),
    ],
    "bridge_stays_in_range": [
        ({"readout.completion_tolerance": 0.02}, "readout.completion_tolerance"),
        ({"readout.completion": "film-1", "gauge.resistance_tolerance": 0.03}, "readout.completion"),
        ({"readout.completion_resistance": 130.0}, "readout.completion_resistance"),
        ({"readout.bridge_offset": 0.08}, "readout.bridge_offset"),
        ({"gauge.resistance_tolerance": 0.08}, "gauge.resistance_tolerance"),
        ({"readout.headroom": 4.8}, "readout.headroom"),
        ({"readout.headroom": 5.0}, "readout.headroom"),
    ],
    "inputs_within_common_mode": [
        (
            {
                "readout.supply_negative": -0.4,
                "readout.supply_positive": 9.6,
                "readout.headroom": 0.0,
                "readout.gain": 10,
            },
            "readout.supply_negative",
        )
    ],
    "switching_settles": [
        ({"readout.samples": 1000}, "readout.samples"),
        ({"readout.on_time": 1e-5}, "readout.on_time"),
        ({"readout.jitter": 0.0025}, "readout.on_time"),
        ({"readout.timing": "software", "readout.instant": 4.9e-3}, "readout.instant"),
    ],
    "converter_takes_field": [
        ({"readout.converter": "AD7124-8", "readout.hum": 0.01}, "readout.hum"),
        (
            {"readout.converter": "AD7124-8", "readout.timing": "software", "readout.excitation": 3.0},
            "readout.excitation",
        ),
    ],
    "converter_meets_mains": [({"readout.converter": "AD7124-8", "readout.mains": 1000.0}, "readout.mains")],
    "converter_has_reference": [
        ({"readout.converter": "AD7124-8", "gauge.resistance": 80.0}, "gauge.resistance")
    ],
    "converter_reads_within_period": [
        ({"readout.converter": "AD7124-8", "readout.period": 0.2}, "readout.period")
    ],
    "regulators_take_supply": [
        ({"readout.supply_positive": 24.0}, "readout.supply_positive"),
        ({"readout.converter": "AD7124-8", "readout.supply_positive": 20.5}, "readout.supply_positive"),
        ({"readout.converter": "AD7124-8", "readout.supply_positive": 3.3}, "readout.supply_positive"),
        ({"gauge.resistance": 10.0, "gauge.rise": 100.0}, "readout.excitation"),
    ],
    "leads_are_relieved": [
        ({"wiring.bonded": 0.0}, "wiring.bonded"),
        ({"wiring.bonded": 20.0}, "wiring.bonded"),
    ],
    "recess_fits_rear": [
        ({"clamp.spacer_bottom": 0.7}, "clamp.spacer_bottom"),
        ({"element.recess_depth": 0.28}, "element.recess_depth"),
        ({"element.recess_offset": 18.0}, "element.recess_offset"),
    ],
    "stop_land_above_arm": [
        ({"element.body_height": 2.65}, "element.body_height"),
        ({"element.body_height": 0.3}, "element.body_height"),
        ({"stop.gaps": {"6": 0.5}}, "stop.gaps.6"),
    ],
    "stop_gap_above_tolerance": [
        ({"stop.tolerance": 0.1}, "stop.tolerance"),
        ({"stop.gaps": {"4": 0.005}}, "stop.tolerance"),
        ({"tolerance.pad_height": 0.1}, "tolerance.pad_height"),
        ({"tolerance.ledge": 0.06}, "tolerance.ledge"),
        ({"rating.overload_force": 250.0, "clamp.stop_plate_thickness": 7.0}, "rating.overload_force"),
        # a short arm beside a long one: 88 mm of body turn its hinge round on the closed stop
        ({"rating.overload_force": 15.0, "array.row_arms": [[90, 4], [90, 4]]}, "rating.overload_force"),
    ],
    "stop_keeps_rated_deflection": [({"stop.gaps": {"4": 0.115}}, "stop.gaps.4")],
    "stop_land_fits_arm": [({"stop.land_length": 3.3}, "stop.land_length")],
    "holes_inside_body": [
        ({"holes.screw_offsets": [4.1, 15.0], "clamp.end_plate_margin": 1.0}, "holes.screw_offsets"),
        ({"holes.height": 4.0, "clamp.end_plate_bottom": 0.0}, "holes.height"),
        ({"holes.dowel_hole": 3.0}, "holes.dowel_hole"),
        ({"holes.dowel_hole": 3.009}, "holes.dowel_hole"),
        ({"holes.dowel_hole": 3.2}, "holes.dowel_hole"),
        ({"clamp.dowel": "2.5"}, "holes.dowel_hole"),
        ({"holes.web": 2.0}, "element.rear_height"),
        ({"holes.screw_offsets": [4.1], "holes.dowel_offsets": [9.1, 17.0]}, "holes.dowel_offsets"),
    ],
    "stack_can_be_clamped": [
        ({"array.row_arms": [[4] * 500], "array.pitch": 6.0, "array.spacer": 3.0}, "array.row_arms")
    ],
    "tilt_covers_pads_and_dowels": [({"tolerance.tilt": 0.01}, "tolerance.tilt")],
    "end_plate_takes_holes": [
        ({"clamp.end_plate_bottom": 0.9}, "clamp.end_plate_bottom"),
        ({"clamp.end_plate_thickness": 4.0}, "clamp.end_plate_thickness"),
        ({"clamp.end_plate_thickness": 30.5}, "clamp.end_plate_thickness"),
        ({"clamp.end_plate_height": 15.0, "clamp.stop_plate_thickness": 2.5}, "clamp.end_plate_height"),
    ],
    "setting_fixture_holds_its_pins": [
        ({"clamp.end_plate_thickness": 6.4}, "clamp.end_plate_thickness"),
        (
            {
                "clamp.end_plate_thickness": 6.4,
                "clamp.dowel": "4",
                "holes.dowel_hole": 4.014,
                "holes.web": 1.0,
            },
            "clamp.end_plate_thickness",
        ),
    ],
    "blanks_lie_firmly": [(ROCKING_BLANK, "holes.dowel_offsets")],
    "boards_stand_clear": [
        ({"wiring.to_board": 48.0}, "wiring.to_board"),
        ({"wiring.to_board": 54.0, "clamp.carrier_margin": 20.0}, "wiring.to_board"),
    ],
    "carrier_can_be_screwed": [
        ({"clamp.mount_thread": "M5"}, "clamp.carrier_thickness"),
        ({"clamp.carrier_thickness": 9.1, "clamp.stop_plate_thickness": 7.0}, "clamp.carrier_thickness"),
    ],
    "stop_plate_can_be_held": [
        ({"element.seat_length": 1.7}, "element.seat_length"),
        ({"clamp.stop_plate_gap": 0.85}, "clamp.stop_plate_gap"),
        ({"element.rear_height": 20.0}, "clamp.stop_plate_thickness"),
        ({"clamp.stop_plate_thickness": 0.5, "rating.overload_force": 1.0}, "clamp.stop_plate_thickness"),
        ({**ONE, **THIN}, "clamp.screw"),
        (ROCKING_PLATE, "sheet.thickness"),
    ],
    "carrier_holes_apart": [
        ({"clamp.carrier_screw_offset": 20.0}, "clamp.carrier_screw_offset"),
        ({"clamp.carrier_screw_offset": 6.0, "clamp.mount_pitch_y": 25.0}, "clamp.mount_pitch_y"),
    ],
    "no_slivers": [
        ({"element.hinge_length": 0.6005, "calibration.travel": 0.1}, "element.hinge_length"),
        ({**TWO_SIDED, "array.row_arms": [[4], [2.7405]], "stop.land_length": 0.2}, "array.row_arms"),
    ],
}

CASES = [(rule, n) for rule, cases in WITNESSES.items() for n in range(len(cases))]


def test_every_rule_has_a_witness():
    """Rules of rigs have theirs in tests/rigs/test_rig_rules.py."""
    of_rigs = ("cart_rules", "calibration_rules", "grasping_rules")
    array = {name for name, rule in design_rules().items() if not rule.find.__module__.endswith(of_rigs)}
    for name in array - set(WITNESSES):
        pytest.fail(
            f"rule {name} has no witness: add a design that breaks it alone to WITNESSES in {__file__}"
        )
    assert set(WITNESSES) == array


@pytest.mark.parametrize(
    "rule", [n for n in WITNESSES if design_rules()[n].find.__module__.endswith("readout_rules")]
)
def test_a_rule_names_the_unread_parts_that_it_asks(rule):
    """In the finding on each of its bad designs: every part of which it took a figure to get there."""
    for changes, _ in WITNESSES[rule]:
        design = variant(changes)
        with asked_parts() as asked:
            (found,) = design_rules()[rule](Layout(design))
        assert not asked or not unnamed(design, asked, found.message)


def test_what_a_rule_comes_after_stands_before_it():
    """A rule that is tried only where another one is kept names one that was tried before."""
    names = list(design_rules())
    for n, rule in enumerate(design_rules().values()):
        assert not rule.after or rule.after in names[:n], rule.name


def test_leads_lie_side_by_side_and_in_rows():
    """0.6 mm of pitch and 0.5 of depth take two rows of two leads of 0.25 mm; 0.45 mm of depth take one."""
    narrow = {"sheet.thickness": 0.4, "array.spacer": 0.2, "array.pitch": 0.6}
    fit = [leads_that_fit(Layout(variant({**narrow, "element.recess_depth": d}))) for d in (0.5, 0.45, 0.2)]
    assert fit == [4, 2, 0]


@pytest.mark.parametrize(("rule", "n"), CASES, ids=[f"{rule}-{n}" for rule, n in CASES])
def test_the_witness_breaks_its_rule_alone(rule, n):
    changes, path = WITNESSES[rule][n]
    design = variant(changes)
    assert [b.check for b in broken_rules(design)] == [rule]
    with pytest.raises(InputError) as caught:
        refuse_broken(design)
    error = caught.value
    assert error.where == path
    assert path.split("[")[0] in paths(design) or path.startswith(("element.override.", "stop.gaps."))
    assert rule in error.what and error.legal
    text = str(error)
    assert text.isprintable()
    assert not re.search(r"\d\.\d{8}", text), "shows digits that nobody wrote"


TOO_WIDE = {
    "stop.tolerance": [{}, {"tolerance.ledge": 0.02}, {"clamp.hold_down_pitch": DROP}],
    "tolerance.ledge": [{}, {"stop.tolerance": 0.012}, {"array.row_arms": [[6, 7], [8, 8]]}],
    "tolerance.pad_height": [{}, {"clamp.hold_down_pitch": DROP}],
}


@pytest.mark.by_day(4, "twenty designs each")
@pytest.mark.parametrize(
    ("path", "others"), [(path, other) for path, cases in TOO_WIDE.items() for other in cases]
)
def test_the_legal_tolerance_of_a_stop_is_accepted_and_slightly_more_is_not(path, others):
    """Bisected from outside: what the rules accept just below what they say, and no more."""

    def found(value):
        design = variant({**others, path: value})
        return [b for b in broken_rules(design) if b.check == "stop_gap_above_tolerance"]

    (wrong,) = found(0.1)
    assert wrong.part == path
    legal = float(re.fullmatch(r"at most ([\d.]+) mm", wrong.limit)[1])
    assert found(legal) == []
    rule, low, high = design_rules()["stop_gap_above_tolerance"], 0.001, 0.1
    while high - low > 1e-6:
        middle = (low + high) / 2
        wrong = list(rule(Layout(variant({**others, path: middle}))))
        low, high = (low, middle) if wrong else (middle, high)
    assert found(low) == [] and found(high)
    assert legal <= low + 1e-6 < legal + 1.01e-4


@pytest.mark.parametrize("name", names())
def test_the_shipped_designs_keep_every_rule(name):
    assert broken_rules(load(name)) == []


def test_several_broken_rules_are_all_named():
    design = variant({"array.row_pitch": 2.0, "element.fillet_radius": 0.5})
    assert [b.check for b in broken_rules(design)] == ["arms_clear_opposite_row", "fillets_fit_slot"]
    with pytest.raises(InputError, match="rule arms_clear_opposite_row .and fillets_fit_slot"):
        refuse_broken(design)


@settings(max_examples=40, derandomize=True, deadline=None, suppress_health_check=list(HealthCheck))
@given(sound_designs())
def test_a_design_made_to_keep_all_rules_is_not_refused(design):
    assert broken_rules(design) == []
    for part in make_scene(design, "array").parts:
        assert part.volume > 0
        if part.process in ("milled", "ground"):
            assert holes_outside(part) == []


def holes_outside(part: Part) -> list[str]:
    """Holes that reach over the edge of the plate they are in, counterbores included."""
    x0, y0, x1, y1 = part.body.outer.box
    low, high = (x0, y0, 0.0), (x1, y1, part.body.thickness)
    outside = []
    for f in part.features:
        r = max(f.diameter, f.counterbore[0] if f.counterbore else 0.0) / 2
        across = [k for k in range(3) if not f.axis[k]]
        if any(f.at[k] - r < low[k] + 0.1 or f.at[k] + r > high[k] - 0.1 for k in across):
            outside.append(f.name)
    return outside


def checked(design: Design) -> list[str]:
    """What is wrong with the array as solids: what its loads do to it, or a drill to its plates, is not asked
    here, nor whether lengths drawn by chance leave an edge of a micrometre."""
    from tactcad.checks.described.wirecut import check_wirecut
    from tactcad.checks.on_solids.interference import check_interference
    from tactcad.checks.on_solids.soundness import check_brep, check_mesh
    from tactcad.checks.shop import load_shop

    scene, shop = make_scene(design, "array"), load_shop()
    shapes = shapes_of(scene)
    found = check_interference(scene, shapes)
    for part in scene.parts:
        found += check_brep(part, shapes[part.part_no]) + check_mesh(part, shapes[part.part_no])
        found += check_wirecut(part, shop) if part.process == "wire-cut" else []
    return [str(f) for f in found if f.severity == "fail" and not f.check.startswith("tiny-")]


@pytest.mark.slow  # whole builds
@pytest.mark.cad
# no shrinking: each example is a whole check, and a failing one says itself what is wrong
@settings(
    max_examples=2,
    derandomize=True,
    deadline=None,
    suppress_health_check=list(HealthCheck),
    phases=[Phase.generate],
)
@given(sound_designs(row_lengths=(1, 2, 3)))
def test_such_designs_build_and_pass_every_check(design):
    assert checked(design) == []


@pytest.mark.nightly
@pytest.mark.cad
@settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))
@given(sound_designs(row_lengths=(1, 2, 3, 5)))
def test_many_such_designs_build_and_pass_every_check(design):
    assert checked(design) == []


@pytest.mark.by_day(1, "the kernel on a whole array each")
@pytest.mark.cad
@pytest.mark.parametrize(
    "changes",
    [
        {"element.rear_height": 16.0},  # carrier over high rear bodies
        {
            "array.row_arms": [[4] * 4],
            "clamp.end_plate_thickness": 6.5,
            "clamp.mount_pitch_y": 5.0,
        },  # counterbores
        # set screws over the outermost of thin elements would stand in the end plates
        {"array.row_arms": [[4] * 8], **THIN},
        {"array.row_arms": [[50.0, 4.0]]},  # beyond the estimator's fit
        {
            **TWO_SIDED,
            "clamp.screw": "M2.5",
            "clamp.carrier_thickness": 6.2,
            "clamp.stop_plate_thickness": 5.5,
        },
    ],
)
def test_designs_that_once_were_let_pass_and_did_not_build(changes):
    assert checked(variant({**ONE, **changes})) == []


@pytest.mark.parametrize(
    "rows",
    [
        *([1], [3], [5, 5], [1, 7], [7, 1], [20, 20], [50, 50]),
        # slow: scenes of 500 and 1,000 elements
        *(pytest.param(rows, marks=pytest.mark.slow) for rows in ([500], [500, 500])),
    ],
)
def test_the_shipped_hinge_in_rows_of_any_length(rows):
    """Neither 2 nor 5 stands in code: with only the arms changed, 1 x 1 to 2 x 500 are designs."""
    arms = [[(4, 5, 6, 7, 8)[(i * 7 + row) % 5] for i in range(n)] for row, n in enumerate(rows)]
    for base in (MACRO, "soft-tissue"):
        design = variant({"array.row_arms": arms}, base=base)
        assert broken_rules(design) == []
        scene = make_scene(design, "array")
        placed = [
            p.designator for p in scene.placements if p.designator[0] == "E" and p.designator[1].isdigit()
        ]
        assert sorted(placed, key=lambda d: int(d[1:])) == [f"E{n + 1}" for n in range(sum(rows))]


def _numbers() -> list[tuple[str, float, float]]:
    found = []
    for section, kind in section_types(Design).items():
        for f in fields(kind) if is_dataclass(kind) else ():
            spec = f.metadata.get("spec")
            if (
                spec is not None
                and hasattr(spec, "low")
                and f.name != "gaps"
                and section in ("sheet", "array", "element", "holes", "clamp", "stop", "gauge")
            ):
                found.append((f"{section}.{f.name}", spec.low, spec.high))
    return found


@settings(max_examples=80, derandomize=True, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.data())
def test_any_legal_values_are_judged_without_a_crash_and_what_passes_can_be_drawn(data):
    """Values anywhere in their ranges: the rules answer, and whatever they let pass becomes a scene."""
    known = _numbers()
    chosen = data.draw(st.lists(st.sampled_from(known), min_size=1, max_size=4, unique=True))
    changes = {}
    for path, low, high in chosen:
        value = data.draw(st.sampled_from([low, high]) | st.floats(low, high))
        changes[path] = value
    changes["element.sides"] = data.draw(st.sampled_from(["one", "two"]))
    changes["clamp.screw"] = data.draw(st.sampled_from(["M2", "M3", "M5"]))
    arms = data.draw(st.sampled_from([[[4]], [[0.1]], [[100]], [[4, 5], [6]], [[8, 4]]]))
    changes["array.row_arms"] = arms
    tree = table(changes)
    tree["origin"] = ORIGIN
    design: Design = from_table(tree)
    if not broken_rules(design):
        make_scene(design, "array")


def test_what_the_stop_plate_s_rule_calls_legal_is_legal():
    """Its own word put back; and left out, the pitch is one that holds, thin plate or usual."""
    soft = {**FIFTY_A_ROW, "clamp.stop_plate_thickness": 2.5, "clamp.hold_down_pitch": 200.0}
    (found,) = broken_rules(variant(soft))
    assert (found.part, found.value) == ("clamp.hold_down_pitch", 200.0)
    most = float(str(found.limit).split()[2])
    assert broken_rules(variant({**soft, "clamp.hold_down_pitch": most})) == []
    for thickness in (2.5, 4.0):
        derived = {**soft, "clamp.stop_plate_thickness": thickness, "clamp.hold_down_pitch": DROP}
        assert broken_rules(variant(derived)) == []


def test_every_broken_rule_is_found_also_behind_a_broken_one():
    """Faults of different parts are found together as they are alone; the refusal names the first only."""
    faults = (
        {"element.fillet_radius": 0.5},
        {"element.rear_length": 12.0},
        {"clamp.carrier_screw_offset": 30.0},
    )
    alone = {b.check for fault in faults for b in broken_rules(variant(fault))}
    together = variant({path: value for fault in faults for path, value in fault.items()})
    assert {b.check for b in broken_rules(together, every=True)} == alone
    assert {b.check for b in broken_rules(together)} < alone
