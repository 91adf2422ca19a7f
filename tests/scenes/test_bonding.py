"""The bonding fixture: it finds the hinge, backs the leaf, presses as it says, for the range of arrays."""

from __future__ import annotations

import re

import numpy as np
import pytest
from built import shape_of, shapes_of
from variants import DROP, FACING_ROWS, IN_SLOT, variant

from tactcad.checks.described.goes_together import check_assembly
from tactcad.checks.described.wirecut import check_wirecut
from tactcad.checks.on_solids.interference import check_interference
from tactcad.checks.shop import DEFAULT, load_shop
from tactcad.circuit.element_signals import element_signals
from tactcad.drawing.engine.boxes import placed
from tactcad.drawing.parts.part_sheet import part_plan
from tactcad.families.facing_rows import FAMILY
from tactcad.mechanics import gauge_signal
from tactcad.parts.array.hinge_section import design_readout, hinge_section
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.measurements import gauge_checks, volts
from tactcad.parts.rigs.bonding_fixture import bonding_rigs
from tactcad.parts.rules import broken_rules, load
from tactcad.scenes import left_out, make_scene, scene_names
from tactcad.scenes.rig_requirements import PLACE_ON_HINGE
from tactcad.solids.measure import measure
from tactcad.stacks.virtual_build import sensor

# The array and its bonding fixture alone: whose rules are asked here.
ALONE = {table: DROP for table in ("calibration", "sample", "cart", "holder", "grasping")}
SHEETS = {
    t: {
        "sheet.thickness": t,
        "array.pitch": t + 1.0,
        "tolerance.sheet_thickness": 0.05,
        "gauge.carrier_width": min(1.5, t),
        "gauge.grid_width": 0.5,
    }
    for t in (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0)
}
HINGES = {
    "round": {"element.hinge_length": 0.88, "element.fillet_radius": 0.44},
    "short": {"element.hinge_length": 0.6, "element.fillet_radius": 0.15},
    "long": {"element.hinge_length": 3.0, "element.fillet_radius": 0.3},
    "long and round": {"element.hinge_length": 2.0, "element.fillet_radius": 1.0},
    "two kinds": {"element.override.2.hinge_thickness": 0.3, "element.override.3.hinge_length": 1.2},
    "slotted from both faces": {
        "element.sides": "two",
        "element.hinge_length": 3.0,
        "gauge.carrier_arm_side": 1.1,
        "gauge.carrier_body_side": 1.1,
    },
}


def arms(count):
    return {"array.row_arms": [[(4.0, 7.0, 6.0, 8.0, 5.0)[i % 5] for i in range(count)]] * 2}


def rig_of(changes=None):
    return bonding_rigs(variant(changes))[0]


def placement(scene, designator):
    return next(p for p in scene.placements if p.designator == designator)


def edge(scene, designator, name):
    """Ends of a contour edge of a placed part, at both faces, in the scene."""
    p = placement(scene, designator)
    s = p.part.extrusion.outer.named(name)
    return np.array(
        [placed(p, (*end, z)) for end in (s.start, s.end) for z in (0, p.part.extrusion.thickness)]
    )


def test_every_shipped_design_has_its_fixture():
    for name in FACING_ROWS:
        assert "bonding" in scene_names(load(name)) and left_out(load(name)) == []


def test_the_tongue_stands_in_the_slot_on_the_leaf():
    """Read off the placed contours: tip on the slot's floor, half the play beside each wall, and standing out
    at both sides of the sheet, where the gauge is set by it."""
    scene = make_scene(variant(), "bonding")
    floor, tip = edge(scene, "E1", "slot_floor"), edge(scene, "BN1", "tongue_tip")
    assert np.ptp(np.r_[floor[:, 2], tip[:, 2]]) < 1e-9
    walls = [edge(scene, "E1", f"slot_{side}_wall")[:, 0].mean() for side in ("arm", "body")]
    sides = [edge(scene, "BN1", f"tongue_{side}")[:, 0].mean() for side in ("front", "back")]
    assert np.mean(walls) == pytest.approx(np.mean(sides), abs=1e-9)
    assert walls[1] - walls[0] - (sides[1] - sides[0]) == pytest.approx(rig_of().play)
    y = [edge(scene, who, name)[:, 1] for who, name in (("E1", "slot_floor"), ("BN1", "tongue_tip"))]
    assert y[1].min() + 3 < y[0].min() and y[0].max() < y[1].max() - 3
    # and no fillet of the slot touches an edge of the tongue: its flat is inside the slot's
    assert np.abs(tip[:, 0]).max() < np.abs(floor[:, 0]).max()


def test_the_clamps_weight_acts_over_the_gauge_and_presses_as_wished():
    scene = make_scene(variant(), "bonding")
    bar = placement(scene, "CB1")
    solid = measure(shape_of(bar.part))
    x, y, _ = placed(bar, solid["centre"])
    gauge = variant().gauge
    assert x == pytest.approx((gauge.carrier_body_side - gauge.carrier_arm_side) / 2, abs=1e-6)
    assert y == pytest.approx(0.0, abs=1e-6)
    newton = solid["volume"] * 7.9e-6 * 9.80665  # stainless steel, kg/mm3
    area = (gauge.carrier_arm_side + gauge.carrier_body_side) * gauge.carrier_width
    assert newton / area == pytest.approx(variant().bonding.pressure, rel=0.02)
    # pins pass its holes
    pins = [placed(p, (0, 0, 0))[:2] for p in scene.placements if p.designator.startswith("DW")]
    holes = [(placed(bar, f.at)[:2], f.diameter) for f in bar.part.features]
    for pin in pins:
        assert any(np.hypot(*np.subtract(pin, at)) < 1e-9 and d == 3.4 for at, d in holes)


def test_a_bar_is_aluminium_where_steel_would_be_too_thin():
    rig = rig_of({"bonding.pressure": 0.03})
    assert rig.bar_material.name == "6061-T651" and rig.bar_height >= 6.0
    assert rig.bar_pressure == pytest.approx(0.03, rel=0.03)


@pytest.mark.parametrize("name", ["macro-array", "better-array"])
def test_nothing_overlaps_in_the_fixture(name):
    scene = make_scene(load(name), "bonding")
    shapes = shapes_of(scene)
    assert check_interference(scene, shapes) == []


@pytest.mark.parametrize("rows", [1, 2, 3, 5, 7, 9, 12])
@pytest.mark.parametrize("sheet", SHEETS)
def test_every_row_and_sheet_has_a_fixture_that_goes_together(rows, sheet):
    design = variant({**ALONE, **arms(rows), **SHEETS[sheet]})
    assert left_out(design) == []
    (rig,) = bonding_rigs(design)
    # by hand: what adds up in the worst case still lets the element in, and the leaf down on the tongue
    spread = 2 * rig.pin_y - 3.008 - 0.1 - (sheet + 0.05)
    assert spread >= 0.0999 and rig.drop > 0.2 + 0.02
    assert rig.pin_x[1] - rig.pin_x[0] >= 8.0 and rig.pin_depth >= 6.0


@pytest.mark.by_day(2, "the kernel on a fixture each")
@pytest.mark.parametrize("hinge", HINGES)
def test_hinges_of_other_sizes_have_a_fixture_in_which_nothing_overlaps(hinge):
    design = variant({**ALONE, **HINGES[hinge]})
    assert [b for b in broken_rules(design) if b.check != "stop_gap_above_tolerance"] == []
    assert left_out(design) == []
    scene = make_scene(design, "bonding")
    shapes = shapes_of(scene)
    assert check_interference(scene, shapes) == []
    shop = load_shop(DEFAULT)
    for part in (p for p in scene.parts if "-bonding-" in p.part_no):
        assert [f for f in check_wirecut(part, shop) if f.severity == "fail"] == []
        plan = part_plan(part, (), FAMILY.plans)
        keys = [d.characteristic.name for d in plan.dimensions if d.characteristic]
        assert sorted(keys) == sorted(c.name for c in part.characteristics)


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"element.hinge_length": 0.5, "element.fillet_radius": 0.2}, "element.hinge_length = 0.5"),
        ({"bonding.pressure": 1.0}, "bonding.pressure = 1"),
        ({"gauge.carrier_arm_side": 1.6, "gauge.carrier_body_side": 1.0}, "gauge.carrier_body_side = 1"),
        ({"bonding.terminal_length": 20.0}, "bonding.terminal_length = 20"),
        ({"bonding.terminal_width": 3.5}, "bonding.terminal_width = 3.5"),
        ({"element.sides": "two", **IN_SLOT, "element.hinge_length": 0.5}, "element.hinge_length = 0.5"),
    ],
)
def test_where_no_fixture_can_be_had_one_line_names_the_field(changes, field):
    (line,) = map(str, left_out(variant({**ALONE, **changes})))
    assert line.startswith("scene bonding left out: rule ") and f"({field}" in line and "legal: " in line


@pytest.mark.parametrize(
    ("changes", "largest"),
    [
        ({"bonding.sight": 0.06}, "bonding: gauge set"),
        ({"bonding.signal_share": 0.015}, "bonding: "),
        ({"tolerance.hinge_length": 0.1}, ""),
    ],
)
def test_a_gauge_that_cannot_be_set_well_enough_fails_the_check(changes, largest):
    design = variant(changes)
    (finding,) = check_assembly(design, [make_scene(design, "bonding")])
    assert f"Most often missed: {PLACE_ON_HINGE}" in finding.message
    assert f"largest contributor: {largest}" in finding.message


def test_the_gauges_place_in_the_worst_case_by_hand():
    """Half of the play at its widest, and the eye: inside what 3 % of the shortest arm's signal allow."""
    design = variant()
    made = sensor(design, [make_scene(design, "bonding")])
    (line,) = made.stack(PLACE_ON_HINGE)
    layout = Layout(design)
    allowed = gauge_signal.allowed(
        hinge_section(layout, layout.elements[:1]), design.gauge.grid_length, 0.03
    ).item()
    worst = (0.90 - 0.845) / 2 + 0.03
    assert line.nominal == pytest.approx(allowed, abs=1e-6)
    assert line.worst_low == pytest.approx(allowed - worst, abs=2e-3) and line.worst_low >= 0.0
    assert check_assembly(design, [make_scene(design, "bonding")]) == []


def test_limits_of_a_bonded_gauge_by_hand():
    layout = Layout(variant())
    c = gauge_checks(layout)
    assert c.resistance == pytest.approx((119.4, 120.6))
    wide = gauge_checks(Layout(variant({"gauge.resistance_tolerance": 0.01})))
    assert wide.resistance == pytest.approx((118.8, 121.2))  # what may be bought is not hurt
    warm = 0.205 * 1.361 / 120 * 0.0039 * 0.5  # the longest lead's copper, half a kelvin
    assert c.leak == pytest.approx(120 / warm, rel=1e-3)  # R/(R + leak) of its resistance, to 1e-5 of it
    assert c.creep == pytest.approx(0.001 * np.log10(60))
    # of 6 F L/(E b t^2) at 2 N and arm 8, times 2.1 and the reading over the composite's own axis, the root
    # leaves seven eighths: as the signal that the read-out shows
    strain = 6 * 2 * 7 / (69000 * 3 * 0.25**2)
    assert [arm for arm, _ in c.rise] == [4.0, 5.0, 6.0, 7.0, 8.0]
    assert 0.84 < c.rise[-1][1] / (2.1 * strain * 1.2098 / 10) < 0.9
    shown = min(element_signals(layout), key=lambda s: -s.place.arm)
    left = design_readout(layout.design).transmission
    assert c.rise[-1][1] * 67.5 * left == pytest.approx(abs(shown.per_force) * 0.2, rel=1e-6)
    assert c.zero == pytest.approx(4 * 3.5 / (2.7 * 100) - 10 * c.rise[-1][1], rel=1e-3)
    assert volts(layout, 0.004) == pytest.approx(270 * 0.004 / 4.008)


def test_the_guide_says_every_step_with_its_limits():
    scene = make_scene(variant(), "bonding")
    assert [s.title for s in scene.steps] == [
        "Fixture",
        "Clamp bar",
        "Surface",
        "Element on the tongue",
        "Gauge",
        "Clamp and cure",
        "Trim and terminals",
        "Solder",
        "Check resistance and insulation",
        "Coat",
        "Check zero and sign",
        "Check creep after 24 h",
    ]
    text = {s.title: s.text for s in scene.steps}
    assert "within 0.06 mm" in text["Gauge"] and "more than 3 % wrong" in text["Gauge"]
    assert "119.4 to 120.6 ohm" in text["Check resistance and insulation"]
    assert "weight of 20 g (0.2 N)" in text["Check zero and sign"]
    assert "must rise" in text["Check zero and sign"] and "at arm 8" in text["Check zero and sign"]
    assert "0.18 %" in text["Check creep after 24 h"]
    backed, free = (float(v) for v in re.findall(r"at ([\d.]+) MPa", text["Clamp and cure"])[:2])
    # unbacked, by hand: M = p w a^2/2 at the hinge, fillet and moment beside its middle raise it by 1.6
    by_hand = 505 / (6 * 1.5 * 1.2**2 / 2 / (3 * 0.25**2))
    assert by_hand / 2 < free < by_hand < backed


@pytest.mark.parametrize(
    ("connection", "said"),
    [("three-wire", "Solder three leads to the terminals"), ("two-wire", "Solder one lead to each terminal")],
)
def test_the_guide_solders_as_many_leads_as_are_cut(connection, said):
    scene = make_scene(variant({"readout.connection": connection}), "bonding")
    (text,) = (s.text for s in scene.steps if s.title == "Solder")
    assert said in text and ("third" in text) == (connection == "three-wire")


def test_the_arrays_guide_sends_to_the_fixture_where_there_is_one():
    gauges = {
        name: make_scene(variant(changes), "array").steps[0].text
        for name, changes in (
            ("with", {}),
            ("without", {"bonding": DROP}),
            ("left out", {"bonding.pressure": 1.0}),
        )
    }
    assert "guide of scene bonding" in gauges["with"] and "0.1 mm" not in gauges["with"]
    assert "within 0.1 mm" in gauges["without"] and "within 0.1 mm" in gauges["left out"]


def test_the_pins_are_standard_where_a_standard_one_is_long_enough():
    (pin,) = {p.part.part_no for p in make_scene(variant(), "bonding").placements if p.designator == "DW1"}
    assert pin == "ISO8734-3x24-pin"
    rig = rig_of()
    assert rig.pin_length - rig.pin_depth == pytest.approx(rig.rest + rig.bar_bottom + 6.0)


def test_an_array_is_built_the_same_with_and_without_its_fixture():
    """What the fixture draws by chance does not move the array's own numbers."""
    with_it, without = (
        sensor(design, [make_scene(design, "array"), *more])
        for design, more in (
            (variant(), [make_scene(variant(), "bonding")]),
            (variant({"bonding": DROP}), []),
        )
    )
    assert [e.stiffness for e in with_it.built(200).elements] == [
        e.stiffness for e in without.built(200).elements
    ]
