"""Stacks against sums written by hand, and against limits that are loosened and tightened."""

from dataclasses import replace

import numpy as np
import pytest

from tactcad.assembly.mechanic import Assembled
from tactcad.assembly.stack import stack
from tactcad.assembly.variables import STACK_LENGTH, DimensionLimits
from tactcad.assembly.virtual_build import sensor
from tactcad.assembly.virtual_shop import made
from tactcad.parts.designs import load


@pytest.fixture(scope="module")
def macro():
    return sensor(load("macro-array"))


@pytest.fixture(scope="module")
def lines(macro):
    return {line.requirement.name: line for line in macro.stack()}


def test_the_carriers_screws_by_hand(lines):
    """The stack's length +-0.2, threads within 0.2 and holes within 0.1 at both ends: 0.2 + 0.2 + 0.1; an M3
    in a hole of 3.5 leaves just that."""
    line = lines["carrier's screws enter the end plates"]
    assert (line.worst_low, line.worst_high) == pytest.approx((-0.5, 0.5))
    assert (line.requirement.lower, line.requirement.upper) == pytest.approx((-0.5, 0.5))
    shares = {c.name: c.share for c in line.contributors}
    squares = {"stack": 0.2**2, "threads": 2 * 0.1**2, "holes": 2 * 0.05**2}
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
                squares = [(c * float(macro.variables[v].upper[0])) ** 2 for v, c in r.linear[1]]
                assert value.std() == pytest.approx(0.87963 * 0.5 * sum(squares) ** 0.5, rel=0.02)


def scaled(variables, name, by):
    v = variables[name]
    middle, half = (v.upper + v.lower) / 2, by * (v.upper - v.lower) / 2
    return {**variables, name: DimensionLimits(name, middle - half, middle + half)}


def test_loosening_a_limit_is_noticed_wherever_its_share_counts(macro, lines):
    """Any one limit three times as wide: every requirement of which it has more than 5 % spreads further."""
    names = sorted({c.name for line in lines.values() for c in line.contributors if c.share > 0.05})
    assert len(names) > 20
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
                spread = []
                for variables in (macro.variables, loose):
                    drawn = made(variables, 400, "corners", np.random.default_rng(3))
                    spread.append(line.requirement.value(Assembled(macro.layout, drawn)).std())
                assert spread[1] > spread[0], (name, line.requirement.name)


def test_tightening_everything_never_lowers_the_yield(macro):
    """Where the yield is below 1 it rises."""
    loose = replace(macro, variables={n: scaled({n: v}, n, 1.6)[n] for n, v in macro.variables.items()})
    yields = []
    for by in (1.0, 0.8, 0.6):
        tighter = {n: scaled({n: v}, n, by)[n] for n, v in loose.variables.items()}
        yields.append(replace(loose, variables=tighter).built(1000).share)
    assert yields[0] < 1.0
    assert yields == sorted(yields) and yields[-1] > yields[0]
