"""Every closed form on every named extreme hinge: 50-digit mpmath, a scaling law, or a refusal by name."""

from __future__ import annotations

import warnings

import mpmath as mp
import numpy as np
import pytest
from exact_ladder import ORDER, condition, true_compliance
from hinges import CASES, FITTED, LENGTHS, scaled

from tactcad.design.materials import ALLOYS
from tactcad.design.messages import CheckFailure
from tactcad.mechanics import ladder, strain, strength
from tactcad.mechanics.ladder import size
from tactcad.mechanics.section import REFERENCE

EPS = np.finfo(float).eps
ALLOY = next(iter(ALLOYS.values()))


@pytest.fixture(autouse=True)
def loud():
    """Overflow, division by zero and NaN raise; a number too small for float64 may be zero. 50 digits for
    mpmath."""
    with (
        warnings.catch_warnings(),
        np.errstate(over="raise", divide="raise", invalid="raise"),
        mp.workdps(50),
    ):
        warnings.simplefilter("error")
        yield


@pytest.mark.parametrize("two", [True, False], ids=["two", "one"])
@pytest.mark.parametrize("case", CASES, ids=lambda c: c.name)
def test_stiffness_is_exact_or_refused_by_name(case, two):
    s = case.section(two)
    for rung in ladder.CLOSED_FORMS:
        result = ladder.evaluate(s, rung)
        if rung in case.refused:
            assert str(result.reason).startswith(case.refused[rung]), (rung, result.reason)
            assert not result.valid and np.isnan(result.stiffness)
            with pytest.raises(CheckFailure, match="rung"):
                ladder.stiffness(s, rung)
            continue
        values = [mp.mpf(float(getattr(s, name))) for name in ORDER]
        truth = true_compliance(rung, values, two)
        # beams' sums have positive terms and powers up to 3, which 16 covers; the fitted forms say theirs
        cond = condition(lambda v: true_compliance(rung, v, two), values) if rung in FITTED else 16.0
        assert abs(mp.mpf(float(result.stiffness)) * truth - 1) <= 16 * EPS * (1 + cond), rung


@pytest.mark.parametrize("two", [True, False], ids=["two", "one"])
@pytest.mark.parametrize("case", CASES, ids=lambda c: c.name)
def test_strain_and_strength_are_numbers_or_refused_like_the_stiffness(case, two):
    s, grid = case.section(two), 0.2 * float(REFERENCE.hinge_length)
    for rung in ladder.CLOSED_FORMS:
        if rung in case.refused:
            for form in (lambda: strain.peak(s, 1.0, rung), lambda: strain.gauge(s, 1.0, grid, rung)):
                with pytest.raises(CheckFailure):
                    form()
            continue
        nominal = 6 * s.load_arm / (s.youngs_modulus * s.width * s.hinge_thickness**2)
        peak = float(strain.peak(s, 1.0, rung) / nominal)
        assert 0.5 < peak < 6.0, (
            rung
        )  # a notch's factor, less than 1 only by the width; Kt of a sharp notch is below 6
        try:
            assert (
                0.0 < float(strain.gauge(s, 1.0, min(grid, float(s.hinge_length) / 4), rung) / nominal) < 1.5
            )
        except CheckFailure as refusal:
            assert "grid" in str(refusal) and two
    if "plane" in case.refused:
        with pytest.raises(CheckFailure, match="do not reach this design"):
            strength.yield_force(s, ALLOY)
    else:
        assert 0.0 < float(strength.yield_force(s, ALLOY)) < np.inf
        assert 0.0 < float(strength.goodman(ALLOY, strain.peak_stress(s, 1.0))) < np.inf


@pytest.mark.parametrize("factor", [1 / 25, 1e-3, 25.0, 1e3])
@pytest.mark.parametrize("two", [True, False], ids=["two", "one"])
def test_stiffness_goes_with_size_and_strain_does_not(two, factor):
    """Force that goes with size squared: deflection goes with size, strain and stress stay."""
    s, small = (REFERENCE.with_(two_sided=two, **change) for change in ({}, scaled(factor)))
    grid, force = 0.3, 0.4
    for rung in ladder.CLOSED_FORMS:
        assert float(ladder.stiffness(small, rung)) == pytest.approx(
            factor * float(ladder.stiffness(s, rung)), rel=1e-13
        )
        for form, args in ((strain.peak, ()), (strain.gauge, (grid,))):
            near = form(small, force * factor**2, *(a * factor for a in args), rung)
            assert float(near) == pytest.approx(float(form(s, force, *args, rung)), rel=1e-12)
    assert float(strength.yield_force(small, ALLOY)) == pytest.approx(
        factor**2 * float(strength.yield_force(s, ALLOY))
    )


@pytest.mark.parametrize("factor", [1e-3, 1e3])
def test_modulus_in_the_wrong_unit_scales_stiffness_and_leaves_stress(factor):
    wrong = REFERENCE.with_(youngs_modulus=REFERENCE.youngs_modulus * factor)
    for rung in ladder.CLOSED_FORMS:
        assert float(ladder.stiffness(wrong, rung)) == pytest.approx(
            factor * float(ladder.stiffness(REFERENCE, rung)), rel=1e-13
        )
    assert float(strain.peak_stress(wrong, 1.0)) == pytest.approx(
        float(strain.peak_stress(REFERENCE, 1.0)), rel=1e-13
    )


@pytest.mark.parametrize("rung", ladder.CLOSED_FORMS)
@pytest.mark.parametrize("wanted", [1e-12, 1e-3, 1e3, 1e12], ids=lambda k: f"{k:g} N per mm")
def test_sizing_meets_an_extreme_wish_or_says_what_can_be_had(wanted, rung):
    try:
        found = size(REFERENCE, wanted, "hinge_thickness", rung)
    except CheckFailure as refusal:
        assert "out of reach" in str(refusal) and "stiffness goes from" in str(refusal)
        assert wanted in (1e-12, 1e-3, 1e3, 1e12)
    else:
        assert float(ladder.stiffness(REFERENCE.with_(hinge_thickness=found), rung)) == pytest.approx(
            wanted, rel=1e-9
        )


@pytest.mark.parametrize("short_of_locking", [1e-3, 1e-9, 1e-12])
def test_friction_near_locking_stiffens_by_the_exact_factor(short_of_locking):
    s = REFERENCE.with_(pad_height=2.0)
    lever = mp.mpf(2) + mp.mpf(float(s.hinge_thickness)) / 2
    mu = float(s.load_arm) / float(lever) * (1 - short_of_locking)
    L = mp.mpf(float(s.load_arm))
    factor = L / (L - mp.mpf(mu) * lever)
    found = float(ladder.stiffness(s.with_(friction=mu)) / ladder.stiffness(s))
    assert found == pytest.approx(float(factor), rel=4 * EPS / short_of_locking)


def test_friction_at_locking_is_refused():
    s = REFERENCE.with_(pad_height=2.0)
    mu = float(s.load_arm / (2.0 + s.hinge_thickness / 2)) * (1 + 1e-12)
    with pytest.raises(CheckFailure, match="friction locks the arm"):
        ladder.stiffness(s.with_(friction=mu))


def test_many_extreme_hinges_at_once_are_the_single_ones():
    """Refused designs among others leave no mark: no warning, no NaN but their own."""
    sections = [case.section(two) for case in CASES for two in (True, False)]
    both = REFERENCE.with_(
        two_sided=[bool(s.two_sided) for s in sections],
        **{name: [float(getattr(s, name)) for s in sections] for name in {*LENGTHS, *ORDER}},
    )
    for rung in ladder.CLOSED_FORMS:
        together = ladder.evaluate(both, rung)
        for i, s in enumerate(sections):
            alone = ladder.evaluate(s, rung)
            assert together.reason[i] == str(alone.reason)
            if alone.valid:
                assert together.stiffness[i] == pytest.approx(float(alone.stiffness), rel=4 * EPS)
            else:
                assert np.isnan(together.stiffness[i])
