"""Arrays built virtually: shipped designs go together, and parts as they were before do not."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation
from variants import variant

from tactcad.checks.described.goes_together import check_assembly
from tactcad.design.messages import InputError
from tactcad.mechanics import ladder
from tactcad.mechanics.strength import yield_force
from tactcad.parts.array.hinge_section import design_alloy, hinge_section
from tactcad.parts.array.stop_gap import overloads, seat
from tactcad.parts.rules import load, refuse_broken
from tactcad.scenes.requirement import variable
from tactcad.stacks.mechanic import PAD, Assembled
from tactcad.stacks.stack import LEAST_YIELD
from tactcad.stacks.variables import STACK_LENGTH, STEPS, made
from tactcad.stacks.virtual_build import sensor

UNITS = np.array([1e3, 1e4, 1e4])  # um and tenths of a milliradian, so that all numbers are near one
SHIPPED = ("macro-array", "soft-tissue", "double-sample", "smallest-bearing")


@pytest.fixture(scope="module")
def macro():
    return sensor(load("macro-array"))


@pytest.mark.by_day(2, "a build each")
@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_designs_go_together(name):
    assert check_assembly(load(name)) == []


@pytest.mark.by_day(1, "a build each")
@pytest.mark.parametrize("name", SHIPPED)
def test_and_with_another_seed(name):
    assert sensor(load(name)).built(1000, 987654321).share >= LEAST_YIELD


def test_the_same_seed_builds_the_same_arrays(macro):
    assert macro.built(50, 5) == macro.built(50, 5)
    assert macro.built(50, 5) != macro.built(50, 6)


# Limits as parts had them before, by the variable: each then keeps too many arrays from going together.
BEFORE = {
    "dowel holes of the plates by general tolerance": (
        "end plate, head: dowel holes against the pair's along x",
        -0.3, 0.3, "pins enter the head end plate"),
    "rows' gap by general tolerance": (
        "element: tip from dowel hole", -0.2, 0.2, "gap between rows"),
    "plates' edge over their dowels by general tolerance": (
        "end plates: dowel holes along z", -0.3, 0.3, "pads square to the carrier"),
    "ledge over the pad by general tolerance": (
        "element: ledge over the pad face", -0.2, 0.2, "stop closes within the rated deflection"),
    "hinges as thick as it happens": (
        "element: hinge thickness", -0.15, 0.15, "stop keeps the hinge from yielding, as made"),
    "H7 holes for pressed pins": (
        "end plate, tapped: dowel hole diameter", 0.0, 0.010, "pins hold in the tapped end plate"),
    "a stack as long as its sheets make it": (
        STACK_LENGTH, -0.56, 0.56, "carrier's screws enter the end plates"),
}  # fmt: skip


@pytest.mark.by_day(4, "a build each")
@pytest.mark.parametrize("what", BEFORE)
def test_a_loose_limit_keeps_arrays_from_going_together(macro, what):
    name, low, high, requirement = BEFORE[what]
    known = macro.variables[name]
    loose = replace(known, lower=np.full(known.pieces, low), upper=np.full(known.pieces, high))
    worse = replace(macro, variables={**macro.variables, name: loose})
    builds = worse.built(300)
    assert builds.share < LEAST_YIELD
    assert builds.failures[builds.worse][requirement] > 3
    why = worse.refusal(builds)
    assert requirement in why and name in why


def test_a_hinge_whose_stop_never_closes_bears_the_overload_alone():
    """Under a force that does not close it: that force over the hinge's own yield force."""
    own = sensor(variant({"rating.overload_force": 0.5}))
    zero = {n: np.zeros((1, v.pieces)) for n, v in own.variables.items()}
    a = Assembled(own.layout, zero)
    assert a.closing_force.min() > 0.5
    alone = 0.5 / yield_force(a.section, design_alloy(own.layout.design))
    assert a.yield_shares == pytest.approx(alone, rel=1e-12)


def test_hinges_on_their_closed_stops_are_stressed_as_the_overload_table_says(macro):
    """All parts as drawn, gaps as wide as limits make them: what tests/fem holds against finite elements."""
    zero = perfect(macro)
    wider = macro.layout.design.stop.tolerance + seat(macro.layout)
    zero["element: stop gap"] = np.full((1, len(macro.layout.elements)), wider)
    share = [1.0 / state.yield_factor for state in overloads(macro.layout)]
    assert Assembled(macro.layout, zero).yield_shares[0] == pytest.approx(share, rel=1e-9)


def test_a_fillet_as_high_as_its_arm_is_no_cut_hinge(macro):
    """2.5 mm in a slot of 4.88, drawn down to what the arm has over the hinge: where rounding put it beyond
    that, one in fifty, the hinge was not a number."""
    zero = {name: np.zeros((100, v.pieces)) for name, v in macro.variables.items()}
    zero["element: fillet radius"] += 2.2
    zero["element: slot length"] += 4.0
    thin, high = np.random.default_rng(1).uniform(-0.005, 0.005, (2, 100, 10))
    a = Assembled(macro.layout, {**zero, "element: hinge thickness": thin, "element: arm height": high})
    assert a.section.fillet_radius == pytest.approx(2.6 + high - 0.25 - thin, abs=1e-9)
    assert np.isfinite(ladder.evaluate(a.section, "section").stiffness).all()


def test_a_cut_hinge_is_a_missed_array(macro):
    name = "element: hinge thickness"
    cut = variable(name, -0.3, -0.3, macro.variables[name].pieces)
    builds = replace(macro, variables={**macro.variables, name: cut}).built(20)
    assert builds.share == 0.0
    assert builds.failures[builds.worse]["stop keeps the hinge from yielding, as made"] == 20


def test_the_least_dowel_hole_that_rules_accept_keeps_its_play():
    """3 m6 is 3.008 at most: 3.010 leaves the 0.002 asked for, at worst."""
    with pytest.raises(InputError, match=r"holes.dowel_hole.*at least 3\.01 mm"):
        refuse_broken(variant({"holes.dowel_hole": 3.0099}))
    least = variant({"holes.dowel_hole": 3.01})
    refuse_broken(least)
    (line,) = sensor(least).stack("pins enter the elements")
    assert line.worst_low == pytest.approx(0.002) and line.kept == 1.0


def test_a_refusal_is_confirmed_by_the_worst_case(macro):
    worse = replace(macro, variables={**macro.variables, STACK_LENGTH: variable(STACK_LENGTH, -0.56, 0.56)})
    (line,) = worse.stack("carrier's screws enter the end plates")
    assert line.shortfall == pytest.approx(0.56 + 0.2 + 0.1 - 0.5)


def perfect(macro):
    """All deviations nought, the fixture's steps higher by half of a play of 0.012: a hole of 3.012 on a pin
    of 3."""
    zero = {n: np.zeros((1, v.pieces)) for n, v in macro.variables.items()}
    return {**zero, STEPS: np.full((1, 2), 0.006)}


def test_one_row_has_no_gap_but_its_tips_have_a_place():
    """A tip's edge is drawn half the two rows' gap from the middle line, and may be off by its load arm's."""
    built = sensor(variant({"array.row_arms": [[4.0, 7.0, 6.0]]}))
    (tips,) = (r for r in built.requirements if "rows" in r.name or "middle line" in r.name)
    assert tips.name == "tips from the middle line"
    assert (tips.lower, tips.upper) == pytest.approx((1.0 - 0.05, 1.0 + 0.05))
    assert Assembled(built.layout, perfect(built)).row_gaps == pytest.approx(1.0)


def test_perfect_parts_make_the_array_as_drawn(macro):
    """Pads in one plane, plate on the ledges, gaps and stiffness as drawn."""
    a = Assembled(macro.layout, perfect(macro))
    assert a.pads == pytest.approx(0.0, abs=1e-9) and a.turn == pytest.approx(0.0, abs=1e-9)
    assert a.lifts == pytest.approx(0.0, abs=1e-9)
    assert a.tilt == pytest.approx(0.0, abs=1e-6)
    assert a.row_gaps == pytest.approx(2.0)
    drawn = ladder.evaluate(hinge_section(macro.layout, macro.layout.elements)).stiffness
    assert a.stiffness[0] == pytest.approx(drawn, rel=1e-12)


def test_a_longer_pad_turns_its_element_and_a_low_ledge_lifts_its_plate(macro):
    """One pad 30 um longer than others: its element alone turns, about the pad's outer edge 17.5 mm from its
    dowel; its pad's middle, a millimetre inwards, stands off the floor by as much over 17.5."""
    one = {**perfect(macro), PAD: np.array([[0.0] * 4 + [0.03] + [0.0] * 5])}
    a = Assembled(macro.layout, one)
    turn = 0.03 / (min(macro.layout.dowel_x) - macro.layout.pad_outer)
    assert a.turn[0] == pytest.approx([0.0] * 4 + [-turn] + [0.0] * 5, abs=1e-9)
    assert float(a.pads_apart.item()) == pytest.approx(turn * 1.0)
    low = {**perfect(macro), "element: ledge over the pad face": np.array([[0.0] * 2 + [-0.004] + [0.0] * 7])}
    assert Assembled(macro.layout, low).lifts[0] == pytest.approx([0, 0, 0.004] + [0] * 7, abs=1e-9)


def test_gaps_agree_with_rigid_bodies_placed_by_a_general_minimiser(macro):
    """The stop plate as a rigid body with full rotations, let down until ledges stop it, lies as high."""
    a = Assembled(macro.layout, made(macro.variables, 12, "uniform", np.random.default_rng(11)))
    layout = macro.layout
    seats = np.column_stack([a.side * layout.hold_down_x, a.y])
    lands = np.column_stack([a.side * (layout.pad_inner + layout.design.stop.land_length / 2), a.y])
    ledges = a.ledges(layout.hold_down_x)
    at_land = a.ledges(layout.pad_inner + layout.design.stop.land_length / 2)

    def heights(x, points):
        turn = Rotation.from_rotvec([x[1], x[2], 0.0]).as_matrix()
        return x[0] + (np.column_stack([points, np.zeros(len(points))]) @ turn.T)[:, 2]

    for k in range(12):
        own = ledges[k] * 1e3  # um

        def free(x, own=own):
            return 1e3 * heights(x / UNITS, seats) - own

        best = minimize(
            lambda x: x[0],
            [20.0, 0.0, 0.0],
            method="SLSQP",
            constraints={"type": "ineq", "fun": free},
            options={"ftol": 1e-12, "maxiter": 500},
        )
        assert free(best.x).min() > -1e-6  # where it stops at its precision it says so
        plate = a.plate[k]
        assert plate[0] == pytest.approx(best.x[0] / 1e3, abs=1e-6)
        # it may rock over two ledges: then nowhere further from a ledge than the minimiser's
        over = plate[0] + seats @ plate[1:] - ledges[k]
        assert over.min() >= -1e-9
        assert over.max() <= (heights(best.x / UNITS, seats) - ledges[k]).max() + 1e-6
        own_lift = plate[0] + lands @ plate[1:] - at_land[k] + a.made["stop plate: flatness"][k]
        assert a.lifts[k] == pytest.approx(own_lift, abs=1e-9)


def test_stiffness_as_built_spreads_as_the_budget_says(macro):
    """First order: thickness +-5 um alone spreads K by the closed form's own derivative."""
    name = "element: hinge thickness"
    only = made(macro.variables, 4000, "normal", np.random.default_rng(2), only=(name,))
    k = Assembled(macro.layout, only).stiffness
    s = hinge_section(macro.layout, macro.layout.elements)
    up = ladder.evaluate(s.with_(hinge_thickness=s.hinge_thickness + 1e-4)).stiffness
    down = ladder.evaluate(s.with_(hinge_thickness=s.hinge_thickness - 1e-4)).stiffness
    slope = (up - down) / 2e-4
    assert k.std(axis=0) == pytest.approx(slope * 0.87963 * 0.0025, rel=0.04)
