"""Findings by arithmetic of their own, and findings that change when the data do."""

from __future__ import annotations

import csv
import re
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
from scipy import optimize

import tactcad.paper
from tactcad.mechanics import gauge_signal, ladder
from tactcad.paper import (
    budget,
    gain,
    grasp_figures,
    hinge,
    inversion,
    reference_element,
    reference_stiffness,
    residuals,
    table1_check,
    table2,
)

DATA = Path(tactcad.paper.__file__).parent / "data"


def raw(name):
    """A table as plain dictionaries, read without the project's reader."""
    lines = [line for line in (DATA / name).read_text().splitlines() if not line.startswith("#")]
    return [{k: float(v) for k, v in row.items()} for row in csv.DictReader(lines)]


T1 = {int(row["element"]): row for row in raw("table1.csv")}
T2 = raw("table2.csv")
RNG = lambda: np.random.default_rng(1)  # noqa: E731


def with_table1(paper, **columns):
    """The paper's data with other values in some columns of Table 1."""
    t = paper.table1
    return replace(
        paper,
        table1=replace(
            t, **{n: replace(getattr(t, n), value=np.asarray(v, float)) for n, v in columns.items()}
        ),
    )


def with_ratio(paper, R):
    return replace(paper, table2=replace(paper.table2, ratio=replace(paper.table2.ratio, value=R)))


def with_figures(paper, **figures):
    return replace(paper, figure=paper.figure | figures)


def equation_2(paper, K_r):
    k, x = paper.table2.measuring_stiffness.value[:, None], paper.table2.object_stiffness.value[None, :]
    return (K_r + x) / (k + x)


# --- 5: Table 2 ---


def test_the_reference_stiffness_that_table_2_supports(paper):
    """Least squares of ln R by a fine scan over K_r, from the raw file."""
    K = np.linspace(20, 90, 70001)
    square = np.zeros_like(K)
    for row in T2:
        k, x = row["measuring_stiffness_N_per_mm"], row["object_stiffness_N_per_mm"]
        square += np.log(row["deflection_ratio_R"] * (k + x) / (K + x)) ** 2
    found = reference_stiffness.study(paper).supported
    assert found.value[0] == pytest.approx(K[np.argmin(square)], abs=2e-3)
    assert found.rms == pytest.approx((square.min() / 48) ** 0.5, rel=1e-6)
    assert found.low[0] < found.value[0] < found.high[0] < 80.38 / 1.5
    implied = [
        r["deflection_ratio_R"] * (r["measuring_stiffness_N_per_mm"] + r["object_stiffness_N_per_mm"])
        - r["object_stiffness_N_per_mm"]
        for r in T2
    ]
    assert np.median(implied) == pytest.approx(found.value[0], rel=0.05)


def test_a_common_factor_on_r_is_the_mean_of_its_logarithm(paper):
    logs = [
        np.log(
            r["deflection_ratio_R"]
            / (
                (80.38 + r["object_stiffness_N_per_mm"])
                / (r["measuring_stiffness_N_per_mm"] + r["object_stiffness_N_per_mm"])
            )
        )
        for r in T2
    ]
    found = reference_stiffness.study(paper).fit("R times a factor")
    assert found.value[0] == pytest.approx(np.exp(np.mean(logs)), rel=1e-6)
    assert found.rms == pytest.approx(np.std(logs), rel=1e-6)


def test_implied_object_stiffnesses_are_the_known_ones(paper):
    found = reference_stiffness.study(paper).object_implied
    assert found.round(2).tolist() == [9.83, 7.24, 6.20, 5.41, 4.45, 3.78, 3.57, 2.35]


def findings_5(paper, array):
    s = reference_stiffness.study(paper)
    r, e = residuals.residuals(paper, array, RNG()), reference_element.study(paper, array, s)
    return " ".join(table2.findings(s, paper, table2.witnesses(s, r, e)))


@pytest.mark.slow  # the paper's fit again for changed tables
def test_table_2_findings_follow_the_data(paper, array):
    as_printed = findings_5(paper, array)
    assert "too large by a factor" in as_printed and "lies far outside the interval" in as_printed
    assert "R is near 1 for 7 of 8" in as_printed and "no pair reached 10" in as_printed
    assert "cannot tell a softer reference element from a wrong scale" in as_printed
    noise = np.exp(0.02 * RNG().standard_normal((6, 8)))
    healed = findings_5(with_ratio(paper, equation_2(paper, 80.38) * noise), array)
    assert "agrees with the printed 80.38" in healed and "K_r/K_m stand" in healed
    assert "no pair reached" not in healed and "near 1" not in healed
    stiffer = findings_5(with_ratio(paper, equation_2(paper, 160.0) * noise), array)
    assert "too small by a factor" in stiffer and "above the printed 80.38" in stiffer
    scaled = reference_stiffness.study(with_ratio(paper, 0.5 * equation_2(paper, 80.38) * noise**0.3))
    assert scaled.fit("R times a factor").rms < 0.5 * scaled.supported.rms
    k, x = paper.table2.measuring_stiffness.value[:, None], paper.table2.object_stiffness.value[None, :]
    quotient = replace(paper.table2.printed_ratio, value=k / x)
    assert "agree within rounding" in findings_5(
        replace(paper, table2=replace(paper.table2, printed_ratio=quotient)), array
    )


def test_intervals_of_the_supported_stiffness_hold_the_truth(paper):
    """Simulated Tables 2 with errors by element and by sample, 60 of them: the two-way jackknife is not too
    narrow.
    """
    rng, held = np.random.default_rng(3), 0
    for _ in range(60):
        R = equation_2(paper, 40.0) * np.exp(
            0.06 * rng.standard_normal((6, 1))
            + 0.05 * rng.standard_normal((1, 8))
            + 0.03 * rng.standard_normal((6, 8))
        )
        d = with_ratio(paper, R)
        f = reference_stiffness._fit(
            "K_r free", 80.38, d.table2.measuring_stiffness.value, d.table2.object_stiffness.value, R
        )
        held += f.low[0] <= 40.0 <= f.high[0]
    assert held >= 53


# --- 4: Table 1 against itself ---


def test_products_of_table_1_by_hand(paper):
    c = table1_check.check(paper)
    assert c.force.difference[5] == pytest.approx(15.25 * 0.1087 / 1.78 - 1)  # no. 7: -6.9 %
    assert c.signal.difference[6] == pytest.approx(9.0 * 0.0506 / 0.47 - 1)  # no. 8
    assert c.ratio.difference[0] == pytest.approx(7.3 / 40.12 / 0.182 - 1)
    assert c.series.travel[6] == pytest.approx(50.6 + 4.33 / 57.04 * 1000)


def test_series_spring_is_a_straight_line(paper):
    force = [row["max_force_N"] for row in T1.values()]
    deflection = [row["max_deflection_um"] for row in T1.values()]
    slope, travel = np.polyfit(force, deflection, 1)
    s = table1_check.check(paper).series
    assert s.line_stiffness == pytest.approx(-1e3 / slope) and s.line_travel == pytest.approx(travel)
    assert s.line_low < s.line_stiffness < s.line_high < 57.04


def test_table_1_findings_follow_the_data(paper):
    as_printed = " ".join(table1_check.findings(table1_check.check(paper), paper))
    assert (
        "softer than the load cell alone" in as_printed
        and "stopped early" in as_printed
        and "no. 8 had to be" in as_printed
    )
    assert re.search(r"K × deflection differs .* 8 of 9 elements", as_printed)
    K = paper.table1.stiffness.value
    d = 150 * 57.04 / (57.04 + K)
    exact = with_table1(
        paper,
        deflection=d,
        force=K * d * 1e-3,
        signal=np.abs(paper.table1.signal_per_deflection.value) * d * 1e-3,
    )
    healed = " ".join(table1_check.findings(table1_check.check(exact), exact))
    assert (
        "K × deflection agrees with the printed force" in healed
        and "the printed load cell is compatible" in healed
    )
    assert "stopped early" not in healed
    wrong = with_table1(
        paper, signal_per_force=np.where(paper.table1.element == 3, -0.5, paper.table1.signal_per_force.value)
    )
    assert "most for no. 3" in " ".join(table1_check.findings(table1_check.check(wrong), wrong))


# --- 1: stiffness ---


def test_explanations_give_the_measured_stiffness_back(paper, array):
    r = residuals.residuals(paper, array, RNG())
    _, s = residuals.matched(paper, array)
    assert ladder.stiffness(s.with_(hinge_thickness=r.hinge_thickness_needed)) == pytest.approx(
        r.measured, rel=1e-6
    )
    assert ladder.stiffness(s.with_(load_arm=r.load_arm_needed)) == pytest.approx(r.measured, rel=1e-6)
    # by the cube of the thickness and the square of the arm, roughly
    assert r.hinge_thickness_needed / 0.25 == pytest.approx(np.exp(r.residual / 3), rel=0.12)
    assert r.load_arm / r.load_arm_needed == pytest.approx(np.exp(r.residual / 2), rel=0.12)


def test_bands_are_what_the_tolerances_give(paper, array):
    """Thickness alone, +-5 um as two standard deviations: 95 % is 3.92/2 times the half-width on either
    side."""
    tol = array.tolerance
    tol = replace(tol, **{f.name: 0.0 for f in fields(tol) if f.name != "hinge_thickness"})
    r = residuals.residuals(paper, replace(array, tolerance=tol), RNG())
    s = array.section
    both = [
        ladder.stiffness(s.with_(hinge_thickness=s.hinge_thickness + sign * 0.98 * tol.hinge_thickness))
        for sign in (-1, 1)
    ]
    place = array.rows(r.element)
    assert r.band_cut == pytest.approx(np.array(both)[:, place], rel=0.012)


def test_stiffness_findings_follow_the_data(paper, array):
    as_printed = " ".join(residuals.findings(residuals.residuals(paper, array, RNG()), array))
    assert (
        "Furthest off is no. 8" in as_printed
        and "still on the pad" in as_printed
        and "differ by up to 2.00 (nos. 8 and 1)" in as_printed
    )
    assert (
        "5 of 9 elements" in as_printed
        and "With the contact anywhere on the pad, still outside: no. 8" in as_printed
        and "no common factor is left" in as_printed
    )
    _, s = residuals.matched(paper, array)
    K = ladder.stiffness(s)
    healed = " ".join(
        residuals.findings(residuals.residuals(with_table1(paper, stiffness=K * 1.001), array, RNG()), array)
    )
    assert "All 9 elements lie inside" in healed and "Furthest off" in healed and "off the pad" not in healed
    heavy = " ".join(
        residuals.findings(residuals.residuals(with_table1(paper, stiffness=K * 1.5), array, RNG()), array)
    )
    assert "all of them together are +50 % off" in heavy


# --- 2: hinge ---


def test_load_point_and_factor_of_the_two_strains(paper, array):
    """eps = f 6 F (a - c)/(E b t^2) solved by hand."""
    c = 4 - 4 * 0.2711 / (0.6316 - 0.2711)
    f = (0.006316 - 0.002711) / 4 / (6 * 2 / (69000 * 3 * 0.25**2))
    s = hinge.fit(paper, array).strains
    assert s.offset == pytest.approx(c) and s.factor == pytest.approx(f)
    assert s.nominal[0] == pytest.approx(6 * 2 * 3 / (69000 * 3 * 0.0625))


def test_best_length_against_a_minimiser(paper, array):
    from scipy.optimize import minimize_scalar

    h = hinge.fit(paper, array)
    _, s = residuals.matched(paper, array)
    edge = s.body_length + s.hinge_length / 2

    def square(length):
        return (
            np.log(
                ladder.stiffness(s.with_(hinge_length=length, body_length=edge - length / 2))
                / paper.table1.stiffness.value
            )
            ** 2
        ).sum()

    best = minimize_scalar(square, bounds=(0.65, 1.5), method="bounded")
    assert h.own.design_length == pytest.approx(best.x, abs=0.011)
    for end in (h.own.design_low, h.own.design_high):  # t interval of one parameter with unknown scatter
        assert square(end) / best.fun == pytest.approx(1 + 2.306**2 / 8, rel=0.06)


def test_hinge_findings_follow_the_data(paper, array):
    as_printed = " ".join(hinge.findings(hinge.fit(paper, array)))
    assert (
        "cannot be told apart" in as_printed
        and "does not tell the notch form" in as_printed
        and "pad's centre (1 mm)" in as_printed
    )
    assert "lies inside it" in as_printed and "No single element decides" in as_printed
    moved = " ".join(hinge.findings(hinge.fit(with_figures(paper, strain_short_arm=0.32), array)))
    assert "not the pad's centre" in moved
    longer = array.section.hinge_length * 2.2
    other = replace(
        array, section=array.section.with_(hinge_length=longer, body_length=array.section.body_length - 0.5)
    )
    assert "lies OUTSIDE it" in " ".join(hinge.findings(hinge.fit(paper, other)))


# --- 3: gain ---


def test_one_gain_by_its_logarithmic_mean(paper, array):
    g = gain.fit(paper, array)
    assert g.fitted_gain == pytest.approx(np.exp(np.mean(np.log(g.measured / g.strain_per_deflection))))
    assert g.design_gain == pytest.approx(2.7 * 100 * 2.1 / 4)
    short = gain.fit(paper, replace(array, gauge=replace(array.gauge, grid_length=0.01)))
    assert short.per_length_exponent == pytest.approx(1.0, abs=0.1)  # strain per deflection is t/(2 l L)
    assert 0.5 < g.per_length_exponent < short.per_length_exponent  # the grid averages beyond the leaf


def test_gain_findings_follow_the_data(paper, array):
    as_printed = " ".join(gain.findings(gain.fit(paper, array), array))
    assert "inside that interval" in as_printed and "No element lies more than two" in as_printed
    _, s = residuals.matched(paper, array)
    q = gauge_signal.foil_strain_per_deflection(s, array.gauge)
    odd = 300 * q * np.where(paper.table1.element == 6, 2.0, 1.0)
    said = " ".join(gain.findings(gain.fit(with_table1(paper, signal_per_deflection=odd), array), array))
    assert "OUTSIDE that interval" in said and "no. 6 lies more than two" in said


# --- 6: figures ---


def test_simulated_ratio_is_equation_2(paper, array):
    six = grasp_figures.figure_6(paper, array, 39.0, RNG())
    k = paper.table2.measuring_stiffness.value
    for s, K_r in ((six.as_printed, 80.38), (six.as_supported, 39.0)):
        assert s.true == pytest.approx((K_r + 3.85) / (k + 3.85))
        assert np.abs(s.ratio / s.true[:, None] - 1).max() < 5 * (s.deviation / s.true[:, None]).max()
    assert six.load[0] == 3.235 and np.diff(six.load) == pytest.approx(0.980665)
    assert (six.with_pad_heights.deviation[:, 0] > 3 * six.as_supported.deviation[:, 0]).all()


def test_figure_findings_follow_the_data(paper, array):
    def said(d):
        s = reference_stiffness.study(d)
        six = grasp_figures.figure_6(d, array, s.supported.value[0], RNG())
        return " ".join(grasp_figures.findings(six, grasp_figures.figure_7(s), array))

    assert "The supported one is closer" in said(paper) and "fit better than chance" in said(paper)
    noise = np.exp(0.1 * RNG().standard_normal((6, 8)))
    assert "scatter too much" in said(with_ratio(paper, equation_2(paper, 40.0) * noise))


# --- 7: reference element ---


def test_ranges_of_the_reference_element_by_hand(paper, array):
    e = reference_element.study(paper, array, reference_stiffness.study(paper))
    assert e.implied_k_v == pytest.approx((0.06 / 0.0286, 0.14 / 0.0372))
    assert e.deflection_from_signal == pytest.approx((0.06 / 9 * 1e3, 0.14 / 9 * 1e3))
    assert e.element == 8 and e.twin == 1
    x = np.array([10.01, 7.26, 6.28, 5.41, 4.51, 3.85, 3.57, 2.34])
    K5 = float(ladder.stiffness(array.section)[4])
    K = np.array([row["stiffness_N_per_mm"] for row in T1.values()] + [K5])
    share = x / (K[:, None] + x)  # deflection per approach
    total = (K[:, None] * share).sum(0)  # N per mm of approach
    load = 0.1419 / (share[3] / total).max()  # element 4 is the softest
    printed = e.readings[0]
    assert printed.load == pytest.approx(load)
    assert printed.deflection == pytest.approx(
        ((load * share[6] / total).min() * 1e3, (load * share[6] / total).max() * 1e3)
    )
    assert printed.signal == pytest.approx(tuple(9e-3 * v for v in printed.deflection))


def test_explanations_predict_what_their_geometry_gives(paper, array):
    """For a short hinge K goes with 1/L^2 and K_v with 1/L; force scale leaves K_v alone, deflection scale
    multiplies it.
    """
    e = reference_element.study(paper, array, reference_stiffness.study(paper))
    by = {x.name: x for x in e.explanations}
    nominal = by["force scale of its calibration"].signal_per_deflection
    ratio = e.stiffness / e.nominal_stiffness
    assert by["deflection scale of its calibration"].signal_per_deflection == pytest.approx(nominal * ratio)
    assert by["load point"].signal_per_deflection == pytest.approx(nominal * ratio**0.5, rel=0.05)
    assert nominal < by["hinge thickness"].signal_per_deflection < nominal * ratio ** (1 / 3)
    for x in e.explanations:
        assert x.signal_per_force == pytest.approx(x.signal_per_deflection / 80.38)
    assert by["load point"].possible and not by["hinge thickness"].possible


def test_reference_findings_follow_the_data(paper, array):
    def said(d):
        return " ".join(
            reference_element.findings(reference_element.study(d, array, reference_stiffness.study(d)))
        )

    as_printed = said(paper)
    assert (
        "at least 2.39 times more" in as_printed
        and "Only 'with its deflection scale off' overlaps both" in as_printed
    )
    assert "lies within" in said(with_figures(paper, reference_signal_least=0.2, reference_signal_most=0.4))
    softer = said(with_figures(paper, reference_signal_least=0.26, reference_signal_most=0.30))
    assert "Only 'with a softer reference element' overlaps both" in softer
    assert "None overlaps either" in said(
        with_figures(
            paper,
            reference_signal_least=5.0,
            reference_signal_most=6.0,
            reference_deflection_least=500.0,
            reference_deflection_most=600.0,
        )
    )


# --- 8: budget ---


def test_effects_of_the_budget_by_hand(paper, array):
    b = budget.budget(paper, array, reference_stiffness.study(paper))
    by = {e.name: e for e in b.effects}
    H = 2.0 + 0.125
    friction = by["friction at the force sensor's tip"]
    assert friction.short_arm == pytest.approx(
        np.log(3 / (3 - 0.2 * H))
    ) and friction.long_arm == pytest.approx(np.log(7 / (7 - 0.2 * H)))
    assert by["load cell's own compliance in the sample test"].on_object == pytest.approx(
        57.04 / (57.04 - 3.85) - 1
    )
    assert (
        "12.1 uncorrected" in by["load cell's own compliance in the sample test"].how
    )  # 10.01 N/mm, as hardware notes have it
    assert by["sheet thickness"].short_arm == pytest.approx(0.1 / 3, rel=0.05)  # K goes with the width
    assert by["load point anywhere on the pad"].short_arm == pytest.approx(
        np.log(2.25**0.5 * (4 / 3)), rel=0.05
    )
    x, r, m = 3.85, b.reference, b.measuring
    lateral = (
        x * 2 * (1 - 0.49) / (2 - 0.49)
    )  # a rigid pad's sideways stiffness on a half-space over its normal one
    assert by["rubber shears on stuck pads"].short_arm == pytest.approx(lateral * (H / 3) ** 2 / r)
    assert by["rubber shears on stuck pads"].long_arm == pytest.approx(lateral * (H / 7) ** 2 / m)
    stiff, bond = by["gauge stiffens the leaf"], by["bond line stiffens the leaf"]
    # adhesive alone as a sandwich: E w h (t/2 + h/2)^2 of the leaf's E b t^3/12, of which K has nine tenths
    glued = 2000 * 1.5 * 0.01 * 0.13**2 / (69000 * 3 * 0.25**3 / 12)
    assert 0.6 * glued < bond.short_arm < glued and bond.remaining == 0.0
    assert bond.short_arm < stiff.short_arm < 0.028  # together below the composite beam's 2.8 %
    assert (
        0.005 < stiff.short_arm < 0.12 and by["bridge non-linearity"].on_object < 0.01
    )  # as hardware notes have them
    assert b.sensitivity_reference == pytest.approx(
        r * (m + x) / (x * (r - m))
    ) and b.sensitivity_reference + b.sensitivity_measuring == pytest.approx(1)
    cell = by["load cell in series in the calibration"]  # K = k K_c/(K_c - k): dlnK/dlnK_c = -K/K_c
    assert cell.short_arm == pytest.approx(0.02 * r / 57.04) and cell.long_arm == pytest.approx(
        0.02 * m / 57.04
    )
    assert by["design's modulus instead of its material's"].long_arm == pytest.approx(np.log(72 / 69))
    assert by["gauges creep"].on_object == pytest.approx(
        -b.sensitivity_ratio * 2**0.5 * 0.001 * np.log10(300 / 10)
    )
    assert by["gauges creep"].remaining < by["gauges creep"].on_object
    sizes = [e.on_object for e in b.effects]
    assert sizes == sorted(sizes, reverse=True)
    assert b.total() > 5 * b.total(remaining=True)


def test_budget_findings_follow_the_numbers(paper, array):
    study = reference_stiffness.study(paper)
    said = " ".join(budget.findings(budget.budget(paper, array, study)))
    assert "Largest are reference stiffness, printed against supported" in said
    healed = reference_stiffness.study(with_ratio(paper, equation_2(paper, 80.38)))
    assert "Largest are load point anywhere on the pad" in " ".join(
        budget.findings(budget.budget(paper, array, healed))
    )


# --- 9: inversion ---


def test_inversion_is_equation_3(paper):
    study = reference_stiffness.study(paper)
    v = inversion.invert(study)
    for w, K in ((v.printed, 80.38), (v.supported, study.supported.value[0])):
        for n, row in enumerate(T2):
            R, k = row["deflection_ratio_R"], row["measuring_stiffness_N_per_mm"]
            assert w.estimate.ravel()[n] == pytest.approx((K - R * k) / (R - 1))


def test_what_the_inversion_is_worth_is_counted_again_by_hand(paper):
    """Fits by a search in one dimension over the printed table, each count from the definition."""
    k, x, R = (
        np.array([float(r[c]) for r in T2])
        for c in ("measuring_stiffness_N_per_mm", "object_stiffness_N_per_mm", "deflection_ratio_R")
    )

    def fitted(keep):
        square = lambda log_K: (  # noqa: E731
            (np.log(R[keep] * (k[keep] + x[keep]) / (np.exp(log_K) + x[keep])) ** 2).sum()
        )
        return np.exp(optimize.minimize_scalar(square, bracket=(3, 4), tol=1e-12).x)

    def near(estimate):
        return (estimate > x / 1.5) & (estimate < x * 1.5)

    def inverted(K):
        return (K - R * k) / (R - 1)

    best = fitted(np.ones(48, bool))
    apart = np.array([inverted(fitted((k != k[i]) & (x != x[i])))[i] for i in range(48)])
    study = reference_stiffness.study(paper)
    ends = {int(near(inverted(K)).sum()) for K in (study.supported.low[0], study.supported.high[0])}
    mean = np.exp(np.log(x).mean())
    well = np.abs((best + x) * (k + x) / (x * (best - k))) < 5
    said = " ".join(inversion.findings(inversion.invert(study)))
    positive = inverted(best) > 0
    assert (near(inverted(best)).sum(), near(apart).sum(), ends, near(mean).sum()) == (29, 26, {19}, 36)
    for part in (
        "with K_r = 39.3 N/mm 29;",
        f"and {np.median(np.where(positive, inverted(best) / x, np.inf)):.2f} times the sample's",
        f"({np.median((inverted(best) / x)[positive]):.2f} the latter without it)",
        "element and sample, 26 are within the factor; 19 with either end",
        f"Always answering {mean:.2f} N/mm, the samples' geometric mean, without any reading is within the "
        f"factor for 36",
        f"below 5 {near(inverted(best))[well].sum()} of {well.sum()} are within the factor "
        f"({near(apart)[well].sum()} with",
        f"{near(mean)[well].sum()} without any reading), above it {near(inverted(best))[~well].sum()} of "
        f"{(~well).sum()}",
    ):
        assert part in said, part
    assert (near(inverted(best))[well].sum(), well.sum()) == (22, 24)


def test_the_scatter_is_said_with_and_without_the_element_that_is_furthest_off(paper, array):
    r = residuals.residuals(paper, array, RNG())
    off = np.log(r.measured / r.predicted["solid"])
    rest = off[r.element != 8]
    said = residuals.findings(r, array)[0]
    assert abs(off[r.element == 8][0]) > np.abs(rest).max()
    assert (
        f"{100 * off.std(ddof=1):.0f} % (standard deviation of ln K; {100 * rest.std(ddof=1):.0f} % without "
        f"no. 8)" in said
    )


def test_inversion_findings_follow_the_data(paper):
    as_printed = " ".join(inversion.findings(inversion.invert(reference_stiffness.study(paper))))
    assert (
        "80.38 N/mm 0 of 48 readings" in as_printed
        and "no positive K_obj at all (K_m = 40.12, 11.57, 9.05 N/mm)" in as_printed
    )
    noise = np.exp(0.01 * RNG().standard_normal((6, 8)))
    healed = " ".join(
        inversion.findings(
            inversion.invert(reference_stiffness.study(with_ratio(paper, equation_2(paper, 80.38) * noise)))
        )
    )
    assert (
        re.search(r"80.38 N/mm (4[0-8]) of 48", healed)
        and "counts as infinite" not in healed
        and "0 readings give no positive K_obj at all." in healed
    )
