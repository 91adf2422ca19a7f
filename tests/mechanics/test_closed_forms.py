"""Every rung against the same mechanics written independently in mpmath at 50 digits, and named limits.

The mpmath side is in tests/exact_ladder.py.
"""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest
from exact_ladder import condition, section, true_compliance

from tactcad.mechanics import ladder
from tactcad.mechanics.rungs import beams, plane, solid
from tactcad.mechanics.section import REFERENCE

EPS = np.finfo(float).eps


@pytest.fixture(autouse=True)
def fifty_digits():
    with mp.workdps(50):
        yield


def designs():
    """Named extremes, then random designs far beyond any real one; powers of two keep r = l/2 exact."""
    yield "reference", (0.25, 0.75, 0.15, 6.0, 2.0, 4.0, 4.0, 0.33, 69000.0, 3.0), True
    yield "full round", (0.25, 0.5, 0.25, 6.0, 2.0, 4.0, 4.0, 0.33, 69000.0, 3.0), False
    yield "slot of nanometres", (0.25, 1e-6, 2.5e-7, 6.0, 2.0, 4.0, 4.0, 0.33, 69000.0, 3.0), True
    yield (
        "slot nearly as long as twice the arm",
        (0.02, 11.999, 0.01, 6.0, 2.0, 4.0, 4.0, 0.33, 69000.0, 3.0),
        True,
    )
    yield "jaw size", (0.01, 0.03, 0.006, 0.24, 0.08, 0.16, 0.16, 0.33, 69000.0, 0.12), False
    yield "knife-thin notch", (1e-5, 2.0, 1.0, 6.0, 3.0, 4.0, 4.0, 0.33, 69000.0, 3.0), False
    yield "two millimetres", (2.0, 6.0, 0.5, 100.0, 20.0, 40.0, 0.001, 0.2, 210000.0, 8.0), True
    yield "soft", (0.3, 0.9, 0.2, 5.0, 2.0, 4.0, 1000.0, 0.49, 1e-3, 3.0), False
    rng = np.random.default_rng(3)
    for i in range(40):
        t, L, b = 10 ** rng.uniform(-2, 0.3), 10 ** rng.uniform(0, 2), 10 ** rng.uniform(-1, 1)
        l = L * 10 ** rng.uniform(-4, 0.2)  # noqa: E741
        r = l * rng.uniform(0.01, 0.5)
        h, Hb = (t + 2 * r) * 10 ** rng.uniform(0.2, 1.5), (t + 2 * r) * 10 ** rng.uniform(0.2, 1.5)
        row = (
            t,
            l,
            r,
            L,
            h,
            Hb,
            10 ** rng.uniform(-2, 1.5),
            rng.uniform(0.1, 0.45),
            10 ** rng.uniform(0, 6),
            b,
        )
        yield f"random {i}", row, bool(i % 2)


DESIGNS = list(designs())


@pytest.mark.by_day(120, "as many designs by chance, 30 ms each")
@pytest.mark.parametrize("rung", ladder.CLOSED_FORMS)
@pytest.mark.parametrize("name,values,two", DESIGNS, ids=[d[0] for d in DESIGNS])
def test_compliance_errs_by_few_ulp_times_its_condition(rung, name, values, two):
    given = [mp.mpf(v) for v in values]
    truth = true_compliance(rung, given, two)
    got = mp.mpf(float(ladder.compliance(section(values, two), rung)))
    # derivatives by the rungs' closed pieces cost too long for the integrals: beam theory's own bound is
    # that a power 3 enters at most, so 16 covers every sum of positive terms
    cond = condition(lambda v: true_compliance(rung, v, two), given) if rung in ("plane", "solid") else 16.0
    assert abs(got / truth - 1) <= 16 * EPS * (1 + cond)


def test_limit_slot_to_zero_leaves_the_roots():
    s = REFERENCE.with_(hinge_length=1e-9, fillet_radius=0.0)
    roots = plane.compliance(s)
    assert np.isfinite(roots) and roots > 0.2 * plane.compliance(REFERENCE)
    assert beams.short_hinge(s) < 1e-8 * beams.short_hinge(REFERENCE)
    np.testing.assert_allclose(beams.beam(s), beams.arm(s) + beams.body(s), rtol=1e-6)


def test_limit_full_round_r_equal_to_half_the_slot_has_no_straight_part():
    s = REFERENCE.with_(hinge_length=0.75, fillet_radius=0.375)
    assert s.straight_length == 0.0
    near = REFERENCE.with_(hinge_length=0.75, fillet_radius=0.375 * (1 - 1e-9))
    for rung in ("section", "plane", "solid"):
        np.testing.assert_allclose(ladder.stiffness(s, rung), ladder.stiffness(near, rung), rtol=1e-8)


def test_limit_fillet_to_zero_is_the_uniform_beam():
    s = REFERENCE.with_(fillet_radius=1e-12)
    np.testing.assert_allclose(beams.section_integral(s), beams.beam(s), rtol=1e-11)


def test_limit_thin_notch_root_is_the_section_integral():
    """As r/t grows, g^2 -> A r/t: the notch's own compliance, which section theory has exactly."""
    for two in (True, False):
        n = 2 if two else 1
        i0, *_ = beams.fillet_integrals(np.array(n * 1e8))
        assert float(1e8 * i0 / np.sqrt(plane.THIN_NOTCH / n * 1e8)) == pytest.approx(1.0, rel=2e-4)


def test_limit_poisson_zero_needs_no_width():
    s = REFERENCE.with_(poisson=0.0)
    assert solid.compliance(s) == plane.compliance(s)


@pytest.mark.parametrize("rung", ladder.CLOSED_FORMS)
@pytest.mark.parametrize("two", [True, False])
def test_stiffness_scales_with_size_and_modulus(rung, two):
    s = REFERENCE.with_(two_sided=two)
    lengths = (
        "hinge_thickness",
        "hinge_length",
        "fillet_radius",
        "load_arm",
        "arm_height",
        "body_height",
        "body_length",
        "width",
    )
    small = s.with_(**{name: getattr(s, name) / 25 for name in lengths})
    np.testing.assert_allclose(ladder.stiffness(small, rung), ladder.stiffness(s, rung) / 25, rtol=1e-13)
    np.testing.assert_allclose(
        ladder.stiffness(s.with_(youngs_modulus=138000.0), rung), 2 * ladder.stiffness(s, rung), rtol=1e-14
    )


def test_blocks_of_a_large_array_give_what_single_designs_give():
    rng = np.random.default_rng(5)
    count = 20_000
    s = REFERENCE.with_(hinge_thickness=rng.uniform(0.2, 0.3, count), two_sided=rng.random(count) < 0.5)
    K = ladder.stiffness(s)
    for i in (0, 8191, 8192, count - 1):
        assert K[i] == ladder.stiffness(s.rows(i))
