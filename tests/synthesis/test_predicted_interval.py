"""The predicted interval: special cases with formulas of their own, scaling laws, conservation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from as_a_lab import calibrations
from scipy.stats import t as student

from tactcad.parts.array.hinge_section import hinge_section
from tactcad.parts.array.layout import Layout
from tactcad.synthesis.interval import bounds, coupled_estimate, information, motion, weights
from tactcad.synthesis.knowledge import Elements, Knowledge, elements, knowledge
from tactcad.synthesis.target import parse_target

ONE = np.ones(1)
NOISE, FORCE, LOADS = 4e-4, 10.0, 10


def springs(K: list[float], K_v: list[float]) -> Elements:
    return Elements(None, np.array(K), np.array(K_v), np.divide(K_v, K))  # type: ignore[arg-type]


def errors(k: float | np.ndarray, v: float | np.ndarray, n: int, dof: float = 1e6) -> Knowledge:
    """Standard errors of K and K_v, relative."""
    k, v = np.broadcast_to(k, n).astype(float), np.broadcast_to(v, n).astype(float)
    return Knowledge(k * k, v * v, 0.0 * k, (0.0 * k, 0.0 * k), dof=dof)


PAIR = springs([60.0, 5.0], [8.0, 3.0])
TEN = springs([60.0, 5.0, 12.0, 30.0, 4.0] * 2, [8.0, 3.0, 4.0, 6.0, 2.5] * 2)


def predicted(e: Elements, known: Knowledge, x: float, noise=NOISE, force=FORCE, loads=LOADS):
    return bounds(e, ONE, known, np.array([[x]]), noise, force, loads)


@pytest.mark.parametrize("x", [0.5, 3.0, 40.0])
def test_two_elements_have_fiellers_interval(x):
    """Of (f_1 - f_2)/(s_2 - s_1), equation (3): the roots of (N - x' D)^2 = t^2 var(N - x' D)."""
    (K1, K2), (V1, V2) = PAIR.stiffness, PAIR.signal
    load = FORCE * np.arange(1, LOADS + 1) / LOADS
    spread = float(np.sqrt(((load - load.mean()) ** 2).sum()))
    total = K1 * x / (K1 + x) + K2 * x / (K2 + x)
    s1, s2 = (x / (K + x) * spread / total for K in (K1, K2))
    N, D = K1 * s1 - K2 * s2, s2 - s1
    var_N, var_D = NOISE**2 * ((K1 / V1) ** 2 + (K2 / V2) ** 2), NOISE**2 * (V1**-2 + V2**-2)
    cov = -(NOISE**2) * (K1 / V1**2 + K2 / V2**2)
    q = student.ppf(0.975, LOADS - 2) ** 2
    roots = np.sort(np.roots([D * D - q * var_D, -2 * (N * D - q * cov), N * N - q * var_N]))
    got = predicted(PAIR, errors(0.0, 0.0, 2), x)
    assert (got.low[0], got.high[0]) == pytest.approx(tuple(roots.real), rel=1e-6)


def test_two_elements_whose_stiffness_errs():
    """Without noise: by equation (3) dx/dK_1 = s_1/(s_2 - s_1), so the variance adds up by hand."""
    x, of = 3.0, np.array([0.01, 0.02])
    s = 1.0 / (PAIR.stiffness + x)
    slope = s * PAIR.stiffness / (s[1] - s[0])
    got = predicted(PAIR, errors(of, 0.0, 2), x, noise=1e-12)
    assert got.error[0] == pytest.approx(np.sqrt(((slope * of) ** 2).sum()), rel=1e-6)


def test_an_error_that_all_share_adds_up_before_it_is_squared():
    """All stiffnesses too large by 1 %: so is K_obj. All sensitivities: it is not."""
    x, none = 3.0, np.zeros(10)
    known = replace(
        errors(1e-9, 1e-9, 10), common={"modulus": (none + 0.01, none), "factor": (none, none + 0.01)}
    )
    assert predicted(TEN, known, x, noise=1e-12).error[0] == pytest.approx(0.01 * x, rel=1e-5)


def test_half_width_goes_with_noise_and_against_force():
    known = errors(0.0, 0.0, 10)
    one = predicted(TEN, known, 3.0, noise=1e-6).half_width(3.0)[0]
    assert predicted(TEN, known, 3.0, noise=3e-6).half_width(3.0)[0] == pytest.approx(3 * one, rel=1e-4)
    assert predicted(TEN, known, 3.0, noise=1e-6, force=4 * FORCE).half_width(3.0)[0] == pytest.approx(
        one / 4, rel=1e-4
    )


def test_stiffer_springs_on_a_stiffer_object_under_more_force_are_the_same():
    known = errors(0.01, 0.007, 10, dof=2.0)
    stiff = springs(7.0 * TEN.stiffness, TEN.signal)
    assert predicted(stiff, known, 21.0, force=7 * FORCE).half_width(21.0) == pytest.approx(
        predicted(TEN, known, 3.0).half_width(3.0), rel=1e-9
    )


def test_four_arrays_side_by_side_have_half_the_error():
    known, x = errors(0.01, 0.01, 10, dof=2.0), np.array([[3.0]])
    one = bounds(TEN, ONE, known, x, NOISE, FORCE, LOADS)
    four = bounds(TEN, 4 * ONE, known, x, NOISE, 4 * FORCE, LOADS)
    assert four.error == pytest.approx(one.error / 2, rel=1e-9)


def test_forces_add_up_to_the_load():
    count = np.array([3.0, 2.0])
    for x in (0.1, 3.0, 200.0):
        m = motion(PAIR, count, np.array([x]), FORCE, LOADS)
        assert (count * m.largest).sum() == pytest.approx(FORCE, rel=1e-12)
        assert m.f + x * m.s == pytest.approx(np.full(2, m.c[0]), rel=1e-12)  # equation (1)


def test_load_cell_shifts_the_objects_compliance():
    known = errors(0.01, 0.01, 10)
    without, within = predicted(TEN, known, 3.0), predicted(TEN, replace(known, load_cell=4e-4), 3.0)
    assert 1 / within.low - 1 / without.low == pytest.approx(4e-4, rel=1e-6)
    assert 1 / without.high - 1 / within.high == pytest.approx(4e-4, rel=1e-6)


def test_no_weights_are_better_than_the_inverse_variances():
    """Gauss and Markov: the lab's weights, from averaged covariances, lose where elements' errors differ, and
    nothing where they are alike."""
    rng, x = np.random.default_rng(2), np.array([[3.0]])
    for _ in range(20):
        known = errors(rng.uniform(0.001, 0.05, 10), rng.uniform(0.001, 0.05, 10), 10, dof=2.0)
        m = motion(TEN, ONE, x, FORCE, LOADS)
        by_noise, by_belief, _ = weights(m, TEN, known, ONE, x, NOISE)
        best = 1.0 / np.sqrt(information(m, ONE, by_noise + by_belief)[0])
        assert predicted(TEN, known, 3.0).error[0] > 1.001 * best
        alike = errors(0.01, 0.01, 10, dof=2.0)
        known_well = errors(0.01, 0.01, 10)
        assert predicted(TEN, alike, 3.0).error == pytest.approx(
            predicted(TEN, known_well, 3.0).error, rel=1e-9
        )


def test_pads_apart_feel_the_truth():
    for x in (0.5, 3.0, 40.0):
        felt = coupled_estimate(TEN, errors(0.01, 0.01, 10, dof=2.0), x, NOISE, FORCE, LOADS, np.eye(10))
        assert felt == pytest.approx(x, rel=1e-5)


def test_even_coupling_of_equal_pairs():
    """Two elements, share c between them: equation (3) gives x' = (f_1 - f_2)/(s_2 - s_1) of springs that
    sink by (f_i + c f_j)/x, that is x/(1 - c)."""
    c, x = 0.3, 3.0
    felt = coupled_estimate(
        PAIR, errors(0.01, 0.01, 2), x, NOISE, FORCE, LOADS, np.array([[1.0, c], [c, 1.0]])
    )
    assert felt == pytest.approx(x / (1 - c), rel=1e-5)


def test_what_a_calibration_knows_is_the_scatter_of_calibrations():
    """4000 calibrations, regressed one by one, of an element of each kind."""
    target = parse_target(
        "[target]\nname='t'\n[object]\nstiffness=[2,8]\n[grasp]\nforce=10\noverload=20\n[known]\ncontact=0",
        "t",
    )
    design = target.base
    layout = Layout(design)
    e = elements(hinge_section(layout, layout.elements), design)
    steps = round(design.calibration.travel / design.calibration.step)
    known = knowledge(target, design, e, np.array([float(steps)]))
    sure = replace(design, calibration=replace(design.calibration, load_cell_accuracy=0.0))
    rng, shape = np.random.default_rng(4), (4000, len(e.stiffness))
    K, K_v, stated = calibrations(
        target, sure, np.broadcast_to(e.stiffness, shape), np.broadcast_to(e.signal, shape), rng
    )
    assert (K / e.stiffness).var(axis=0) == pytest.approx(known.of_k, rel=0.12)  # 5 of sqrt(2/4000)
    assert (K_v / e.signal).var(axis=0) == pytest.approx(known.of_v, rel=0.12)
    assert stated.ss.mean(axis=0) == pytest.approx(known.of_v, rel=0.12)
    assert stated.ff.mean(axis=0) == pytest.approx(known.of_k + known.of_v - 2 * known.cross, rel=0.12)
