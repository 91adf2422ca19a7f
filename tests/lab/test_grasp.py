"""Object stiffness from grasp readings: against known truth, against Fieller's formula and dense least
squares.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from example_readings import Noise, calibration_rows, truth
from scipy.stats import binom

from tactcad.contact import springs
from tactcad.design.messages import InputError
from tactcad.lab import calibration, grasp, readings
from tactcad.lab.calibration_file import Sensitivity
from tactcad.lab.combine import combine, combine_each, scatter
from tactcad.lab.load_cell import LoadCell
from tactcad.lab.readings import CalibrationReadings, GraspReadings
from tactcad.mechanics import lumped
from tactcad.mechanics.lumped import shares_between
from tactcad.paper.grasp_figures import Truth, grasp_signals

CELL = 57.04
LOAD = 3.235 + 0.980665 * np.arange(8)
TRUTH = Truth(
    np.array([1, 2, 3, 4]),
    np.array([80.0, 38.0, 12.0, 6.0]),
    np.array([-9.0, -7.3, -4.9, 3.8]),
    np.array([0.2, -1.0, 0.1, -2.1]),
)


def exact(truth=TRUTH) -> Sensitivity:
    zero = np.zeros(len(truth.element))
    return Sensitivity(
        truth.element,
        truth.stiffness.copy(),
        zero,
        truth.signal_per_deflection,
        zero,
        zero,
        zero + 1e6,
        zero + CELL,
        zero,
    )


def grasped(x, noise=0.0, seed=0, heights=0.0, truth=TRUTH, load=LOAD) -> GraspReadings:
    signal = grasp_signals(truth, load, x, noise, np.random.default_rng(seed), heights)
    return GraspReadings(1, truth.element, load, np.zeros(len(load), int), signal)


def test_elements_that_have_each_others_zeros_are_refused():
    """An array whose zeros are all new is not."""
    read = grasped(3.85, 1e-4, load=np.concatenate([[0.0], LOAD]))
    known = replace(exact(), zero=TRUTH.zero_signal)
    assert grasp.evaluate(read, known).combined.estimate == pytest.approx(3.85, rel=0.01)
    swapped = replace(read, signal=read.signal[[0, 2, 1, 3]])
    with pytest.raises(InputError, match="element 2 has the zero of element 3 .* swapped"):
        grasp.evaluate(swapped, known)
    with pytest.raises(InputError, match="element 1 has the zero of element 4 .* swapped"):
        grasp.evaluate(replace(read, signal=np.roll(read.signal, 1, axis=0)), known)
    grasp.evaluate(read, replace(known, zero=np.array([0.7, -0.2, -1.4, 0.4])))


def test_swapped_channels_are_refused_without_zeros_by_the_one_exchange_that_makes_elements_agree():
    nine = truth()
    known = replace(exact(nine), stiffness_se=0.005 * nine.stiffness, dof=np.full(9, 6.0))
    read = grasped(3.85, 1e-4, truth=nine)
    assert grasp.evaluate(read, known).combined.estimate == pytest.approx(3.85, rel=0.02)
    for i, j in ((0, 1), (2, 7), (8, 0)):
        order = np.arange(9)
        order[[i, j]] = j, i
        n, m = sorted(nine.element[[i, j]])
        with pytest.raises(InputError, match=f"once the signals of {n} and {m} are exchanged"):
            grasp.evaluate(replace(read, signal=read.signal[order]), known)


def test_one_channel_of_the_other_sign_is_refused():
    """All of them are a note: the calibration may have been read the other way round."""
    read = grasped(3.85, 1e-4)
    for number in TRUTH.element:
        signal = np.where((TRUTH.element == number)[:, None], -1, 1) * read.signal
        with pytest.raises(InputError, match=f"element {number} goes the other way"):
            grasp.evaluate(replace(read, signal=signal), exact())


@pytest.mark.parametrize("x", [1e-3, 0.5, 3.85, 40.0, 2000.0, 1e5])
def test_without_noise_the_truth_comes_back(x):
    found = grasp.evaluate(grasped(x, 1e-12), exact())
    assert found.combined.estimate == pytest.approx(x, rel=1e-5 if x <= 2000 else 1e-3)
    for pair in found.pairs:
        k_m = TRUTH.stiffness[TRUTH.element == pair.measuring][0]
        assert pair.reference == 1
        assert pair.ratio == pytest.approx((80 + x) / (k_m + x), rel=1e-6)  # equation (2)
        assert pair.condition == pytest.approx((80 + x) * (k_m + x) / (x * (80 - k_m)), rel=1e-3)


def test_pad_heights_drop_out_of_slopes_but_not_of_totals():
    heights = np.array([0.0, 0.008, -0.008, 0.004])
    even, uneven = grasped(3.85), grasped(3.85, heights=heights)
    d = (uneven.signal - TRUTH.zero_signal[:, None]) / TRUTH.signal_per_deflection[:, None]
    assert abs(d[3, 0] / d[0, 0] / ((80 + 3.85) / (6 + 3.85)) - 1) > 0.01  # the totals' R is off
    assert grasp.evaluate(uneven, exact()).combined.estimate == pytest.approx(
        grasp.evaluate(even, exact()).combined.estimate, rel=1e-6
    )


def test_errors_of_the_load_drop_out():
    """Friction in the guide or a wrong weight moves all pads alike: R keeps, and so does the noise
    estimate.
    """
    held = 0
    for seed in range(100):
        wrong = LOAD + np.random.default_rng(seed).normal(0, 0.3, len(LOAD))
        reading = grasped(3.85, 1e-4, seed=seed, load=wrong)
        found = grasp.evaluate(
            GraspReadings(1, TRUTH.element, LOAD, np.zeros(8, int), reading.signal), exact()
        )
        assert found.noise == pytest.approx(1e-4, rel=0.6)
        held += found.combined.low < 3.85 < found.combined.high
    assert held >= binom.ppf(1e-4, 100, 0.95)


def test_a_pair_has_fieller_s_interval():
    """Against mechanics' formula for the same deflections, variances and quantile."""
    reading = grasped(25.0, 4e-3, seed=3)
    known = Sensitivity(
        TRUTH.element,
        TRUTH.stiffness,
        TRUTH.stiffness * 0.004,
        TRUTH.signal_per_deflection,
        np.abs(TRUTH.signal_per_deflection) * 0.003,
        np.zeros(4),
        np.full(4, 1e9),
        np.full(4, CELL),
        np.zeros(4),
    )
    slopes, _ = grasp.common_slopes(reading.element, reading.signal, known)
    found, _, _ = combine_each([(slopes, [3, 0])], 0.95)[0]
    n, d = slopes.f[0] - slopes.f[3], slopes.s[3] - slopes.s[0]
    c = slopes.covariance[0] + slopes.covariance[3]
    from tactcad.lab.regression import t_quantile

    _, dof = scatter(slopes, [3, 0], slopes.covariance[[3, 0]], found.estimate)
    formula = lumped.ratio_interval(n, d, c[0, 0], c[1, 1], -c[0, 1], quantile=t_quantile(0.95, dof))
    assert formula.bounded
    assert found.estimate == pytest.approx(float(formula.estimate), rel=1e-6)
    assert found.low == pytest.approx(max(float(formula.lower), 0.0), rel=1e-6)
    assert found.high == pytest.approx(float(formula.upper), rel=1e-6)


def test_all_elements_together_are_the_pairs_least_squares_with_their_full_covariance():
    """z_m = (f_m - f_r) + x (s_m - s_r), covariance V_m on the diagonal and the reference's V_r
    everywhere.
    """
    reading = grasped(8.0, 2e-3, seed=4)
    slopes, _ = grasp.common_slopes(reading.element, reading.signal, exact())
    found, _, _ = combine(slopes, 0.95)

    def square_sum(x):
        along = np.array([1.0, x])
        v = np.array([along @ c @ along for c in slopes.covariance])
        z = (slopes.f - slopes.f[0] + x * (slopes.s - slopes.s[0]))[1:]
        return z @ np.linalg.solve(np.diag(v[1:]) + v[0], z)

    x = np.linspace(found.low * 0.8, found.high * 1.2, 40001)
    values = np.array([square_sum(v) for v in x[::20]])
    assert x[::20][np.argmin(values)] == pytest.approx(found.estimate, abs=25 * (x[1] - x[0]))
    assert square_sum(found.low) == pytest.approx(square_sum(found.high), rel=1e-4)


def simulated_sensitivity(rng) -> Sensitivity:
    rows = calibration_rows(TRUTH, CELL, 0.025 * np.arange(7), 3, Noise(), rng)
    made = calibration.calibrate(
        CalibrationReadings(
            rows[:, 0].astype(int), rows[:, 1].astype(int), *rows[:, 2:].T, np.arange(len(rows))
        ),
        LoadCell(CELL),
    )
    pick = lambda f: np.array([f(r) for r in made])  # noqa: E731
    return Sensitivity(
        pick(lambda r: r.element),
        pick(lambda r: r.stiffness.value),
        pick(lambda r: r.stiffness.standard_error),
        pick(lambda r: r.signal_per_deflection.value),
        pick(lambda r: r.signal_per_deflection.standard_error),
        pick(lambda r: r.correlation),
        pick(lambda r: r.dof),
        np.full(len(made), CELL),
        np.zeros(len(made)),
    )


@pytest.mark.slow  # 300 simulated labs; by day test_coverage_where_the_interval_is_not_bounded
@pytest.mark.parametrize("x", [3.85, pytest.param(60.0, marks=pytest.mark.nightly)])
def test_stated_intervals_hold_the_truth_as_often_as_they_say(x):
    """Calibration and grasp both simulated, 300 times: 95 % within binomial bounds of probability 1e-4."""
    rng = np.random.default_rng(11)
    trials, combined, pairs = 300, 0, np.zeros(3)
    for _ in range(trials):
        known = simulated_sensitivity(rng)
        signal = grasp_signals(TRUTH, LOAD, x, 5e-4, rng, rng.normal(0, 0.005, 4))
        found = grasp.evaluate(GraspReadings(1, TRUTH.element, LOAD, np.zeros(8, int), signal), known)
        combined += found.combined.low <= x <= found.combined.high
        pairs += [p.object.low <= x <= p.object.high for p in found.pairs]
    low, high = binom.ppf([5e-5, 1 - 5e-5], trials, 0.95)
    assert low <= combined <= high
    assert (pairs >= low).all() and (pairs <= high).all()


def test_says_when_the_data_do_not_bound_the_object():
    stiff = grasp.evaluate(grasped(1e6, 2e-3, seed=2), exact()).combined
    assert (
        np.isinf(stiff.high) and stiff.low > 20 and "from below only" in stiff.verdict and not stiff.bounded
    )
    soft = grasp.evaluate(grasped(0.01, 0.02, seed=2), exact()).combined
    assert soft.low == 0 and "from above only" in soft.verdict
    twins = Truth(
        TRUTH.element[:2], np.array([10.0, 10.0]), TRUTH.signal_per_deflection[:2], TRUTH.zero_signal[:2]
    )
    assert (
        "not bounded"
        in grasp.evaluate(grasped(3.85, 1e-3, seed=1, truth=twins), exact(twins)).combined.verdict
    )


@pytest.mark.slow  # a simulated lab
def test_coverage_where_the_interval_is_not_bounded():
    """For an object far stiffer than the elements the unbounded interval still holds it 95 times in 100."""
    held = 0
    for seed in range(300):
        i = grasp.evaluate(grasped(5000.0, 1e-3, seed=seed), exact()).combined
        held += (not i.empty) and i.low <= 5000 <= i.high
    assert binom.ppf(5e-5, 300, 0.95) <= held <= binom.ppf(1 - 5e-5, 300, 0.95)


def test_elements_that_disagree_are_named_and_widen_the_interval():
    wrong = exact()
    wrong.stiffness[2] *= 1.3  # a calibration that is off
    found = grasp.evaluate(grasped(3.85, 2e-4, seed=6), wrong)
    assert found.widened > 2 and any("disagree" in note for note in found.notes)
    honest = grasp.evaluate(grasped(3.85, 2e-4, seed=6), exact())
    assert honest.widened == 1 and found.combined.high - found.combined.low > 3 * (
        honest.combined.high - honest.combined.low
    )


def test_an_element_that_touches_late_is_named():
    late = grasped(3.85, 2e-4, seed=7, heights=np.array([0.0, 0.0, 0.0, -0.4]))
    notes = grasp.evaluate(late, exact()).notes
    assert any("element 4 does not follow" in note for note in notes)
    assert sum("does not follow" in note for note in notes) == 1
    good = [
        grasp.evaluate(grasped(3.85, 2e-4, seed=s, heights=np.array([0, 0.01, -0.01, 0])), exact()).notes
        for s in range(200)
    ]
    assert sum(bool(n) for n in good) <= 8  # by chance: one in 10 000 here, and one in 100 for disagreement


def test_forces_of_the_wrong_sign_or_size_are_noted_and_change_no_ratio():
    right = grasped(3.85, 2e-4, seed=8)
    found = grasp.evaluate(right, exact(), overload_force=13.04)
    assert found.notes == ()
    for factor, said in (
        (-1.0, "element 1, 2, 3, 4 falls"),
        (50.0, "beyond the design's overload force of 13.04 N"),
    ):
        wrong = grasp.evaluate(replace(right, signal=factor * right.signal), exact(), overload_force=13.04)
        (note,) = wrong.notes
        assert said in note and "\n" not in note
        assert wrong.combined.estimate == pytest.approx(found.combined.estimate, rel=1e-9)
    # the force that is told, by the model: the share of the load's rise that the stiffest element takes
    share = TRUTH.stiffness / (TRUTH.stiffness + 3.85) * 3.85
    assert f"(no. 1: {50 * np.ptp(LOAD) * share[0] / share.sum():.3g} N)" in note


@pytest.mark.slow  # a simulated lab
def test_presses_of_any_array_are_believed_and_wrong_units_are_not():
    """20 arrays from 0.03 to 150 N/mm, pressed on anything, any two or more of their elements read."""
    rng = np.random.default_rng(3)
    for n in rng.integers(2, 30, 20):
        K = 10 ** (rng.uniform(-0.7, 0.7, n) + rng.uniform(-0.8, 1.5))
        truth = Truth(np.arange(1, n + 1), K, 10 ** rng.uniform(-3, 1, n), np.zeros(n))
        load, x = np.arange(1, 9) * 0.01 * K.sum(), K.mean() * 10 ** rng.uniform(-2, 4)
        read = rng.permutation(n)[: int(rng.integers(2, n + 1))]
        right = grasped(x, 1e-6, truth=truth, load=load)
        right = replace(right, element=right.element[read], signal=right.signal[read])
        for factor in (1.0, 1e3, 1e-3, 102.0):  # on the load: mN or g for N, N for mN
            found = grasp.evaluate(replace(right, load=load * factor), exact(truth), elements=n)
            assert len(found.warnings) == (factor != 1), (n, read, x, factor, found.warnings)


def test_readings_before_contact_are_left_out():
    load = np.concatenate([[0.0], LOAD])
    reading = grasped(3.85, 1e-9, load=load, heights=np.array([0.02, 0.0, 0.0, 0.0]))
    found = grasp.evaluate(reading, exact())
    assert found.loads == 8 and found.dropped_loads == 1
    assert found.combined.estimate == pytest.approx(3.85, rel=1e-4)


@pytest.mark.parametrize(
    "change, named",
    [
        (lambda g: GraspReadings(1, g.element, g.load[:2], g.run[:2], g.signal[:, :2]), "too little"),
        (lambda g: GraspReadings(1, g.element[:1], g.load, g.run, g.signal[:1]), "too little"),
        (lambda g: GraspReadings(1, g.element + 90, g.load, g.run, g.signal), "element 91"),
    ],
)
def test_too_little_is_refused(change, named):
    with pytest.raises(InputError, match=named):
        grasp.evaluate(change(grasped(3.85)), exact())


def test_an_unknown_reference_is_refused():
    with pytest.raises(InputError, match="reference"):
        grasp.evaluate(grasped(3.85), exact(), reference=77)


def test_the_array_carries_the_load_and_late_pads_carry_none():
    heights = np.array([0.0, 0.05, -0.3, 0.01])
    z, _, d = springs.press(TRUTH.stiffness, 5.0, LOAD, -heights)
    assert (TRUTH.stiffness[:, None] * d).sum(0) == pytest.approx(LOAD, rel=1e-12)
    assert ((z[None, :] + heights[:, None] <= 0) == (d == 0)).all() and (d[2, 0] == 0)


def test_grasp_file_needs_every_element_at_every_load(tmp_path):
    file = tmp_path / "grasp.csv"
    file.write_text("load,element,signal\n1,1,0.1\n1,2,0.2\n2,1,0.2\n")
    with pytest.raises(InputError, match=r"grasp.csv:4:2: element 2 has no signal at load 2 N"):
        readings.grasps(file)


def coupled_grasp(x: float, share: np.ndarray, noise: float, seed: int) -> GraspReadings:
    """Signals where each pad also sinks by share[i, j] of what the force on pad j does there: a dense
    solve."""
    force = np.linalg.solve(np.diag(1 / TRUTH.stiffness) + share / x, np.ones(4))
    deflection = np.outer(force / TRUTH.stiffness, LOAD / force.sum())
    signal = TRUTH.zero_signal[:, None] + TRUTH.signal_per_deflection[:, None] * deflection
    signal += noise * np.random.default_rng(seed).standard_normal(signal.shape)
    return GraspReadings(1, TRUTH.element, LOAD, np.zeros(len(LOAD), int), signal)


def half_space() -> np.ndarray:
    """Pads of 2 x 3 mm, two facing pairs 4 mm apart, on an incompressible half-space."""
    x, y = np.array([2.0, 2.0, -2.0, -2.0]), np.array([0.0, 4.0, 0.0, 4.0])
    return shares_between(x, y, 2.0, 3.0, np.inf, 0.5)


@pytest.mark.parametrize("of_limit", [0.25, 0.5, 1.0])
def test_without_noise_the_coupled_readings_give_the_truth_at_their_coupling(of_limit):
    share = half_space()
    reading = coupled_grasp(4.0, np.eye(4) + of_limit * (share - np.eye(4)), 1e-12, 0)
    slopes, _ = grasp.common_slopes(reading.element, reading.signal, exact())
    assert combine(slopes.coupled(of_limit * share), 0.95)[0].estimate == pytest.approx(4.0, rel=1e-4)


# each object and each coupling once in every run, all pairs of them by night
EVERY_RUN = {("half-space", 4.0), ("even, 5 %", 12.0), ("separate", 1.5)}
KINDS_AND_OBJECTS = [(k, x) for k in ("half-space", "even, 5 %", "separate") for x in (1.5, 4.0, 12.0)]


@pytest.mark.by_day(1, "a hundred simulated labs each")
@pytest.mark.parametrize(
    "kind, x",
    [
        pytest.param(*both, marks=() if both in EVERY_RUN else pytest.mark.nightly)
        for both in KINDS_AND_OBJECTS
    ],
)
def test_intervals_hold_whatever_the_coupling_up_to_its_limit(kind, x):
    """Fifty grasps each: the truth lies within every pair's interval and the combined one, 93 % of the time
    at least; without the limit, coupling takes nearly all of them away from it."""
    limit = half_space()
    share = {"half-space": limit, "even, 5 %": np.full((4, 4), 0.05), "separate": np.zeros((4, 4))}[
        kind
    ].copy()
    np.fill_diagonal(share, 1.0)
    pairs = combined = blind = 0
    for seed in range(50):
        reading = coupled_grasp(x, share, 1e-4, seed)
        found = grasp.evaluate(reading, exact(), coupling=limit)
        pairs += sum(p.object.low <= x <= p.object.high for p in found.pairs)
        combined += found.combined.low <= x <= found.combined.high
        blind += found.combined_by_noise.low <= x <= found.combined_by_noise.high
    assert combined >= 46 and pairs >= 0.93 * 150
    assert kind == "separate" or blind < 40


def test_the_load_cell_s_limits_reach_the_object():
    """Readings of a calibration with a softer cell than was reckoned with: the interval holds the truth,
    which noise alone does not."""
    cell, off = CELL, 0.97
    k = TRUTH.stiffness * off * cell / (TRUTH.stiffness + off * cell)  # slope over the stage's displacement
    believed = k * cell / (cell - k)
    zero = np.zeros(4)
    known = Sensitivity(
        TRUTH.element,
        believed,
        zero,
        TRUTH.signal_per_deflection * (1 - k / (off * cell)) / (1 - k / cell),
        zero,
        zero,
        zero + 1e6,
        zero + cell,
        zero + 0.03 * cell,
    )
    again = known.at_load_cell_limit(-1.0)
    assert again.stiffness == pytest.approx(TRUTH.stiffness, rel=1e-12)
    assert again.signal_per_deflection == pytest.approx(TRUTH.signal_per_deflection, rel=1e-12)
    found = grasp.evaluate(grasped(3.85, 1e-5), known)
    assert found.combined.low <= 3.85 <= found.combined.high
    assert not found.combined_by_noise.low <= 3.85 <= found.combined_by_noise.high


@pytest.mark.parametrize("half_width", [CELL, 2 * CELL, CELL - 1.0])
def test_limits_that_leave_the_load_cell_no_stiffness_are_refused(half_width):
    """Nothing, less than nothing, and less than what gave way with it."""
    given = dict(load_cell=np.full(4, CELL), load_cell_half_width=np.full(4, half_width))
    with pytest.raises(InputError, match="softest load cell within its limits"):
        replace(exact(), **given).at_load_cell_limit(-1.0)


def test_signals_without_size_are_refused():
    """About 1e-300 V: a change whose square is nought to a computer is none."""
    reading = grasped(3.85, 1e-4)
    with pytest.raises(InputError, match="its signal does not change with the load"):
        grasp.evaluate(
            GraspReadings(1, TRUTH.element, LOAD, np.zeros(len(LOAD), int), reading.signal * 1e-300), exact()
        )
