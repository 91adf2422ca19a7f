"""The setting fixture: what stands on what, for two rows and for one, one element and many; its limits."""

from __future__ import annotations

import pytest
from built import shapes_of
from variants import ROCKING_BLANK, ROCKING_PLATE, variant

from tactcad.checks.on_solids.interference import check_interference
from tactcad.checks.on_solids.steps import Trial, check_steps
from tactcad.checks.on_solids.tools import check_tools
from tactcad.parts.array.layout import Layout
from tactcad.parts.bought.standard_parts import dowel_limits
from tactcad.parts.rigs.setting_fixture import STEP, SettingLayout, setting_fixture
from tactcad.parts.rules import broken_rules
from tactcad.scenes import make_scene, scene_names
from tactcad.scenes.bom import bom_rows

ROWS = {
    "two rows": {},
    "one row": {"array.row_arms": [[6.0] * 3]},
    "one element": {"array.row_arms": [[6.0]]},
    "rows of different length": {"array.row_arms": [[4, 7, 6], [5]]},
    "tie rods": {"array.row_arms": [[4, 7, 6, 8, 6, 5] * 2] * 2},
}


FAST = ("one row", "two rows")


@pytest.mark.cad
@pytest.mark.parametrize(
    # slow: few by day: all checks on solids
    "rows",
    [rows if rows in FAST else pytest.param(rows, marks=pytest.mark.slow) for rows in sorted(ROWS)],
)
def test_the_stack_stands_in_it_and_its_screws_are_reached(rows):
    design = variant(ROWS[rows])
    scene = make_scene(design, "setting")
    shapes = shapes_of(scene)
    for check in (check_interference, check_steps, check_tools):
        assert check(scene, shapes) == []
    met = {frozenset((c.first, c.second)) for c in scene.contacts}
    for place in Layout(design).elements:
        assert frozenset((place.designator, "FX1")) in met
    assert all(frozenset((plate, "FX1")) in met for plate in ("EP1", "EP2"))
    blanks = [p.designator for p in scene.placements if p.designator.startswith("BL")]
    assert all(frozenset((blank, "FS1")) in met for blank in blanks)


@pytest.mark.cad
@pytest.mark.slow  # steps of two scenes on solids, twice each
@pytest.mark.parametrize(
    ("rocks", "scene", "lies"),
    [
        (ROCKING_PLATE, "array", {"sheet.thickness": 3.15, "array.spacer": 20.85}),
        (ROCKING_BLANK, "setting", {"holes.dowel_offsets": [9.1], "holes.screw_offsets": [20.0]}),
    ],
)
def test_what_rules_refuse_the_check_of_steps_finds_rocking(rocks, scene, lies):
    """And what they call legal, nearly at the limit, it lets pass."""
    for changes, free in ((rocks, True), (rocks | lies, False)):
        made = make_scene(variant(changes), scene)
        trial = Trial(made, shapes_of(made), {})
        assert any("turn about" in f.message for f in trial.freedoms()) == free
        assert bool(broken_rules(variant(changes))) == free


def test_every_design_has_it_in_bill_and_guide():
    for name in ("two rows", "one row"):
        design = variant(ROWS[name])
        assert "setting" in scene_names(design)
        scene = make_scene(design, "setting")
        assert "Setting fixture" in {row.description for row in bom_rows(scene, None, {})}
        text = " ".join(s.text for s in make_scene(design, "array").steps)
        assert "setting fixture" in text and "mrad" in text
        assert ("every blank on the strip" in text) == (name == "one row")


def test_its_steps_make_elements_stand_square():
    """By hand: a 3 m6 pin is 3.005 on average, a hole of 3.012 to 3.018 3.015: pressed down, an element's
    hole lies 5 um under its pin, so the steps are 5 um higher than the plates' edges over the pads, 2.5 mm,
    +-3 um."""
    fixture = setting_fixture(SettingLayout(variant()))
    front, back = (c for c in fixture.characteristics if c.name.startswith("step over"))
    assert (front.nominal, front.lower, front.upper) == pytest.approx((2.5, 2.502, 2.508))
    assert (back.lower, back.upper) == (front.lower, front.upper) and STEP == 0.003
    assert sum(dowel_limits("3")) / 2 == pytest.approx(3.005)
