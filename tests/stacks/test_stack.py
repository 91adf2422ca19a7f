"""Stacks against sums written by hand, and against limits that are loosened and tightened."""

from dataclasses import replace

import numpy as np
import pytest
from pose_program import nearest_pose

from tactcad.parts.rules import load
from tactcad.scenes.requirement import DimensionLimits
from tactcad.scenes.rig_requirements import AXLE_HEIGHT, BORES, PARALLEL, SHANKS, WHEEL, loose_wheel
from tactcad.stacks.mechanic import Assembled
from tactcad.stacks.stack import stack
from tactcad.stacks.variables import STACK_LENGTH, made
from tactcad.stacks.virtual_build import sensor


@pytest.fixture(scope="module")
def macro():
    return sensor(load("macro-array"))


@pytest.fixture(scope="module")
def lines(macro):
    return {line.requirement.name: line for line in macro.stack()}


def test_the_carriers_screws_by_hand(lines):
    """The stack's length +-0.2, threads and holes within 0.1 at both ends: 0.2 + 0.1 + 0.1; an M3 in a hole
    of 3.5, which may be 0.1 small, leaves just that."""
    line = lines["carrier's screws enter the end plates"]
    assert (line.worst_low, line.worst_high) == pytest.approx((-0.4, 0.4))
    assert (line.requirement.lower, line.requirement.upper) == pytest.approx((-0.4, 0.4))
    shares = {c.name: c.share for c in line.contributors}
    squares = {"stack": 0.2**2, "threads": 2 * 0.05**2, "holes": 2 * 0.05**2}
    assert shares[STACK_LENGTH] == pytest.approx(squares["stack"] / sum(squares.values()))


def test_the_carriers_own_screws_by_hand(lines):
    """M3x8 js15 (+-0.29) through 2.7 mm of carrier (plate +-0.05, counterbore 3.3 +-0.1) into 6 mm of thread
    (+-0.1)."""
    engages = lines["M3x8 through carrier into end-plate-head (carrier): engages"]
    assert (engages.nominal, engages.worst_low, engages.worst_high) == pytest.approx((5.3, 4.86, 5.74))
    free = lines["M3x8 through carrier into end-plate-head (carrier): clamps before it bottoms"]
    assert (free.nominal, free.worst_low) == pytest.approx((0.7, 0.7 - 0.29 - 0.05 - 0.1 - 0.1))


def test_the_clamping_screws_by_hand(lines):
    """M3x30 js15 (+-0.42) through a plate (+-0.05, counterbore +-0.1) and the stack (+-0.2)."""
    line = next(x for name, x in lines.items() if name.startswith("M3x30") and name.endswith("engages"))
    reach = 0.42 + 0.05 + 0.1 + 0.2
    assert (line.worst_low, line.worst_high) == pytest.approx((line.nominal - reach, line.nominal + reach))


# Of a screw and two parts: the hole less the screw less what the hole may be small and the pins leave beside,
# and the zones of hole and thread.
ENTER = {
    "M3x20 through holder-lid into cart-plate": (3.4 - 3 - 0.1, 0.1 + 0.1),
    "M4x12 through gauge-plate into axis-plate": (4.5 - 4 - 0.1, 0.1 + 0.1),
    "M4x12 through gauge-plate into FORCE-GAUGE-5N": (4.5 - 4 - 0.1, 0.1 + 0.2),  # bought: 0.2
    "M3x8 through RAIL-9x100-guide into riser": (3.5 - 3 - 0.1, 0.2 + 0.1),
    "M5x16 through base into post": (5.5 - 5 - 0.1, 0.1 + 0.1),
    # element on a 3.002 pin by a hole of 3.018, pins within 0.03; the head plate's hole is 3.04 to 3.07
    "M3x30 through element into end-plate-tapped": (3.4 - 3 - 0.1 - 0.016 - 0.03, 0.1 + 0.1),
    "M3x30 through end-plate-head into end-plate-tapped": (3.4 - 3 - 0.1 - 0.068 - 0.03, 0.1 + 0.1),
}


@pytest.mark.parametrize("name", ENTER)
def test_screws_enter_by_hand(lines, name):
    room, zones = ENTER[name]
    line = lines[f"{name}: enter"]
    assert (line.requirement.lower, line.requirement.upper) == pytest.approx((-room, room))
    assert (line.worst_low, line.worst_high) == pytest.approx((-zones, zones))


def test_every_pattern_passes_at_its_worst(lines):
    """And of made parts, all that take two screws and more are looked at."""
    patterns = [line for name, line in lines.items() if name.endswith(": enter")]
    assert all(line.shortfall < 1e-9 for line in patterns)
    made = (
        "base",
        "post",
        "array-mount",
        "axis-plate",
        "gauge-plate",
        "cart-plate",
        "holder-body",
        "holder-lid",
    )
    for part in (*made, "riser", "foot", "bar", "platform", "carrier", "element", "spacer", "end-plate-head"):
        assert any(
            f"through {part} " in x.requirement.name or f"into {part}:" in x.requirement.name
            for x in patterns
        )


def test_a_screw_passes_only_what_stands_before_its_thread(lines):
    """The weights stand around the pin beyond the platform: their thickness is none of its screw's."""
    line = lines["M4x10 through platform into weight-pin (foot): engages"]
    assert [c.name for c in line.contributors] == [
        "M4x10 screw: length",
        "macro-array-platform: counterbore depth",
        "macro-array-platform: thickness",
    ]


def test_wheels_by_hand(macro, lines):
    """Two axles of a diagonal 0.015 high, the others low: 0.06 of alternating heights, and 0.016 of wheels'
    radii; shanks at 3 in bores of 2.992 give nothing way, shanks of 2.9 in bores of 3 take it up."""
    up = np.array([[1.0, -1.0, 1.0, -1.0]])
    none = {AXLE_HEIGHT: 0.015 * up, WHEEL: -0.004 - 0.004 * up, BORES: np.full((1, 4), -0.008)}
    stuck = Assembled(macro.layout, {**none, SHANKS: np.zeros((1, 4))})
    assert loose_wheel(stuck) == pytest.approx(4 * 0.015 + 4 * 0.002)
    free = Assembled(macro.layout, {**none, BORES: np.zeros((1, 4)), SHANKS: np.full((1, 4), -0.1)})
    assert loose_wheel(free) == 0.0
    assert lines["wheels touch"].worst_high == pytest.approx(0.068, abs=1e-6)


def test_parallelism_by_hand(macro, lines):
    """Levelled to and sample within 0.025 degree each; plate 5 um of 32 mm, lid 20 of 48, rail's face 10 of
    the carriage's 28.9. At the worst wheels are 68 um off and the cart rocks over 59 mm, wheel to wheel."""
    line = lines[PARALLEL]
    once = np.degrees([0.005 / 32, 0.020 / 48, 0.010 / 28.9])
    assert line.requirement.upper == 0.1 and line.kept > 0.995
    assert line.worst_high == pytest.approx(0.05 + once.sum() + np.degrees(0.068 / 59), rel=1e-6)
    # two standard deviations of normal parts are at the limits, cut there; a sum's absolute value
    spread = 0.87963 * 0.5 * np.hypot(0.025 * 2**0.5, np.linalg.norm(once))
    assert line.sigma == pytest.approx(spread * (1 - 2 / np.pi) ** 0.5, rel=0.1)
    made_ = {n: np.zeros((1, v.pieces)) for n, v in macro.variables.items()}
    made_["sample: parallel faces, degrees"] = np.array([[0.01, -0.03]])
    value = line.requirement.value(Assembled(macro.layout, made_))
    assert value == pytest.approx(np.array([[0.01, 0.03]]))


def test_wheels_by_another_way(macro):
    """The pose of a rigid cart that misses its four wheels' heights least beyond their play, as a linear
    program: the fourth wheel's gap is shared by all four."""
    names = (AXLE_HEIGHT, WHEEL, BORES, SHANKS)
    wide = {n: DimensionLimits(n, 5 * macro.variables[n].lower, macro.variables[n].upper) for n in names[:1]}
    drawn = made({**{n: macro.variables[n] for n in names}, **wide}, 200, "uniform", np.random.default_rng(4))
    corners = np.array([[35.0, 30.0], [-35.0, 30.0], [-35.0, -30.0], [35.0, -30.0]])
    heights = drawn[AXLE_HEIGHT] - drawn[WHEEL] / 2
    missed = nearest_pose(corners, heights, np.maximum(drawn[BORES] - drawn[SHANKS], 0.0) / 2)[:, 3]
    assert loose_wheel(Assembled(macro.layout, drawn))[:, 0] == pytest.approx(4 * missed, abs=1e-6)
    assert missed.max() > 0.0


def test_the_rollers_seat_by_hand(lines):
    """2 m6 is 2.002 to 2.008; the seat's radius is 1.005 to 1.015."""
    enters, middle = lines["roller enters its seat"], lines["roller in its seat's middle"]
    assert (enters.worst_low, enters.worst_high) == pytest.approx((2.01 - 2.008, 2.03 - 2.002))
    assert (middle.worst_low, middle.worst_high) == pytest.approx((1.005 - 1.004, 1.015 - 1.001))


def test_what_does_not_vary_has_no_spread(macro):
    """With all parts at one size the drawn arrays differ by rounding only: their spread is 0, not 1e-19."""
    fixed = {
        n: DimensionLimits(n, (v.upper + v.lower) / 2, (v.upper + v.lower) / 2)
        for n, v in macro.variables.items()
    }
    for line in stack(macro.layout, fixed, list(macro.requirements), 50):
        assert line.sigma == 0.0, line.requirement.name


def test_no_two_requirements_share_a_name(macro):
    names = [r.name for r in macro.requirements]
    assert len({*names}) == len(names)


def test_pins_and_holes_by_hand(lines):
    """3 m6 is 3.002 to 3.008; N7 is 2.986 to 2.996; elements' holes are 3.012 to 3.018."""
    press, play = lines["pins hold in the tapped end plate"], lines["pins enter the elements"]
    assert (press.worst_low, press.worst_high) == pytest.approx((0.006, 0.022))
    assert (play.worst_low, play.worst_high) == pytest.approx((0.004, 0.016))


def test_sums_and_draws_agree(macro, lines):
    """The spread of drawn arrays is the root of the sum of squares of their parts', which have 0.8796 of a
    quarter of their width, being cut at two sigma. No drawn array leaves the worst case."""
    arrays = Assembled(macro.layout, made(macro.variables, 20_000, "normal", np.random.default_rng(9)))
    for r in macro.requirements:
        if r.linear:
            value, line = r.value(arrays), lines[r.name]
            assert value.min() >= line.worst_low - 1e-9 and value.max() <= line.worst_high + 1e-9
            if all(macro.variables[v].pieces == 1 for v, _ in r.linear[1]):
                limits = [(c, macro.variables[v]) for v, c in r.linear[1]]
                squares = [(c * float(v.upper[0] - v.lower[0]) / 2) ** 2 for c, v in limits]
                assert value.std() == pytest.approx(0.87963 * 0.5 * sum(squares) ** 0.5, rel=0.02)


def scaled(variables, name, by):
    v = variables[name]
    middle, half = (v.upper + v.lower) / 2, by * (v.upper - v.lower) / 2
    return {**variables, name: DimensionLimits(name, middle - half, middle + half)}


def test_loosening_a_limit_is_noticed_wherever_its_share_counts(macro, lines):
    """Any one limit three times as wide: every requirement of which it has more than 5 % spreads further."""
    names = sorted({c.name for line in lines.values() for c in line.contributors if c.share > 0.05})
    assert len(names) > 20
    drawn = made(macro.variables, 1000, "uniform", np.random.default_rng(3))
    before = Assembled(macro.layout, drawn)
    spread = {n: li.requirement.value(before).std() for n, li in lines.items() if not li.requirement.linear}
    for name in names:
        loose = scaled(macro.variables, name, 3.0)
        for line in lines.values():
            share = next((c.share for c in line.contributors if c.name == name), 0.0)
            if share <= 0.05:
                continue
            if line.requirement.linear:
                (changed,) = stack(macro.layout, loose, [line.requirement], 50)
                assert changed.worst_high - changed.worst_low > 1.05 * (line.worst_high - line.worst_low), (
                    name
                )
            else:
                looser = Assembled(macro.layout, made(loose, 1000, "uniform", np.random.default_rng(3)))
                assert line.requirement.value(looser).std() > spread[line.requirement.name], name


def test_tightening_everything_never_lowers_the_yield(macro):
    """Where the yield is below 1 it rises."""
    loose = replace(macro, variables={n: scaled({n: v}, n, 1.6)[n] for n, v in macro.variables.items()})
    yields = []
    for by in (1.0, 0.8, 0.6):
        tighter = {n: scaled({n: v}, n, by)[n] for n, v in loose.variables.items()}
        yields.append(replace(loose, variables=tighter).built(1000).share)
    assert yields[0] < 1.0
    assert yields == sorted(yields) and yields[-1] > yields[0]
