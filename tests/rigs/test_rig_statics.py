"""Tipping, holding and moving weight, each by another way than the code's."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from built import shape_of
from scipy.optimize import linprog
from variants import variant

from tactcad.mechanics.statics import holding_force, inside_by, tipping_margin, tipping_pull
from tactcad.parts.rigs.cart import cart_layout
from tactcad.parts.rules import load
from tactcad.scenes import make_scene
from tactcad.scenes.rigs.grasping import check_moving_weight, moving_weight
from tactcad.scenes.scene import Pose
from tactcad.solids.measure import volume


def wheels_can_carry(contacts, forces) -> bool:
    """Is there a set of pushing wheel forces in balance with vertical forces (F, x, y) and moments? By a
    linear program."""
    x, y = np.array(contacts).T
    total = sum(f for f, _, _ in forces)
    balance = np.array([np.ones(len(x)), x, y])
    right = np.array([total, sum(f * px for f, px, _ in forces), sum(f * py for f, _, py in forces)])
    return linprog(np.zeros(len(x)), A_eq=balance, b_eq=right, bounds=[(0, None)] * len(x)).status == 0


@pytest.mark.parametrize("name", ["macro-array", "double-sample", "smallest-bearing"])
def test_no_load_on_the_sample_tips_the_cart(name):
    design = load(name)
    rig, half = cart_layout(design), design.sample.side / 2
    margin = tipping_margin(rig.contacts, half)
    assert margin >= 2.0
    for x in np.linspace(-half, half, 5):
        for y in np.linspace(-half, half, 5):
            assert wheels_can_carry(rig.contacts, [(13.04, x, y)])
    out = half + margin
    side = max(((out + 0.01, 0.0), (0.0, out + 0.01)), key=lambda p: -inside_by(rig.contacts, p))
    assert not wheels_can_carry(rig.contacts, [(13.04, *side)])  # and just beyond the margin it would


def test_the_pull_that_lifts_a_wheel_is_where_balance_ends():
    contacts, height, weight, load_, at = (
        ((25, 27), (-25, 27), (-25, -27), (25, -27)),
        34.0,
        2.0,
        3.2,
        (5.0, -3.0),
    )
    pull = tipping_pull(contacts, height, weight, load_, at)

    def stands(force: float) -> bool:
        """A pull of `force` in any direction at that height shifts the load's line of action."""
        return all(
            wheels_can_carry(
                contacts,
                [(weight, 0, 0), (load_, *at), (1e-9, force * height * 1e9 * c, force * height * 1e9 * s)],
            )
            for c, s in ((1, 0), (-1, 0), (0, 1), (0, -1))
        )

    assert stands(0.999 * pull) and not stands(1.001 * pull)


def test_vacuum_holds_by_pressure_times_area():
    assert holding_force(100.0, 10.0) == pytest.approx(1.0)  # 0.1 N/mm2 on 10 mm2
    design = load("macro-array")
    rig = cart_layout(design)
    assert len(rig.suction_holes) == 37
    force = holding_force(design.holder.vacuum, 37 * pi * 0.25)
    assert force == pytest.approx(1.162, abs=1e-3)
    assert force > design.holder.pull
    half = design.holder.vacuum_diameter / 2
    assert all(np.hypot(*spot) + design.holder.hole_diameter / 2 <= half for spot in rig.suction_holes)


@pytest.mark.parametrize("name", ["macro-array", "double-sample", "smallest-bearing"])
def test_what_moves_weighs_what_the_paper_says(name):
    """Summed here from the kernel's volumes, densities and given masses."""
    design = load(name)
    scene = make_scene(design, "grasping")
    axis = dict(scene.groups)["axis"]
    grams = 0.0
    for p in scene.placements:
        if p.designator in axis and not p.designator.startswith("WT"):
            given = p.part.mass_override
            grams += volume(shape_of(p.part)) * p.part.material.density * 1e-6 if given is None else given
    assert grams * 9.80665e-3 == pytest.approx(3.235, rel=0.005)
    assert moving_weight(scene) == pytest.approx(grams * 9.80665e-3, rel=1e-6)
    assert check_moving_weight(design, scene) == []


def test_too_heavy_an_axis_is_seen():
    light = variant({"grasping.moving_weight": 2.0})
    (found,) = check_moving_weight(light, make_scene(light, "grasping"))
    assert found.severity == "fail" and found.value > 2.0


def test_ten_weights_reach_the_overload_force():
    design = load("macro-array")
    scene = make_scene(design, "grasping", Pose(weights=10))
    weights = sum(p.part.mass for p in scene.placements if p.designator.startswith("WT"))
    total = moving_weight(scene) + weights * 9.80665e-3
    assert total == pytest.approx(design.rating.overload_force, rel=0.001)
