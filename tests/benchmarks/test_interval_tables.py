"""Coverage tables: a few labs of every kind, counted here; the published tables in the long run."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import interval_tables
import numpy as np
import pytest
from example_readings import Noise
from labs import Lab, intervals, known_widths, slope_covariance, true_values
from scipy.stats import binom

from tactcad.lab.regression import fit_lines

DOCUMENT = Path(__file__).parents[2] / "benchmarks" / "results" / "intervals.md"
ARRAY = interval_tables.chosen(interval_tables.THREE)
KINDS = {s.what: s.lab for s in interval_tables.STUDIES}
# the elements share the load cell's error; one run is given more scatter than it has
ALONE = [w for w, lab in KINDS.items() if not lab.cell_off and lab.runs > 1]


@pytest.mark.by_day(3, "forty simulated labs each")
@pytest.mark.parametrize("what", ALONE)
def test_intervals_of_forty_labs_hold_as_often_as_they_say(what):
    """120 intervals of each quantity: within binomial bounds of probability 1e-4."""
    rng, value = np.random.default_rng(1), true_values(ARRAY)
    held = np.zeros(3)
    for _ in range(40):
        rows = KINDS[what].calibrated(KINDS[what].readings(ARRAY, rng))
        found = np.array([intervals(r) for r in rows])
        held += ((found[..., 0] <= value) & (value <= found[..., 1])).sum(0)
    low, high = binom.ppf([5e-5, 1 - 5e-5], 120, 0.95)
    assert (low <= held).all() and (held <= high).all(), held


@pytest.mark.by_day(1, "simulated labs each")
@pytest.mark.parametrize("off", [0.02, 0.05])
def test_intervals_hold_at_the_ends_of_the_load_cell_s_limits(off):
    """The stiffest element, where the load cell counts most: 95 % of 60 labs, less what chance 1e-4 takes."""
    lab = next(lab for lab in KINDS.values() if lab.cell_off == off)
    rng, held = np.random.default_rng(2), 0
    for _ in range(60):
        low, high = intervals(lab.calibrated(lab.readings(ARRAY, rng))[2])[0]
        held += low <= ARRAY.stiffness[2] <= high
    assert held >= binom.ppf(1e-4, 60, 0.95)


@pytest.mark.by_day(1, "hundreds of simulated labs each")
@pytest.mark.parametrize("noise", [Noise(), Noise(of_run=0.01)], ids=["noise", "runs differ"])
def test_the_known_covariance_is_that_of_plain_fits(noise):
    """Slopes of 3000 simulated calibrations by equal weights scatter as the formula says, within 8 %."""
    lab = Lab(noise=noise)
    rng, found = np.random.default_rng(3), []
    for _ in range(3000):
        data = lab.readings(replace(ARRAY, **{n: getattr(ARRAY, n)[:1] for n in ARRAY.__dict__}), rng)
        y = np.column_stack([data.force, data.signal])
        found.append(fit_lines(data.displacement, y, data.run).slope)
    expected = slope_covariance(lab, ARRAY)[0]
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    assert (np.abs(np.cov(np.array(found).T) - expected) < 0.08 * scale).all()


def test_no_interval_is_narrower_than_of_somebody_who_knows():
    """On average over 30 labs with runs alike, and so for every quantity and element."""
    lab, rng = Lab(), np.random.default_rng(4)
    rows = [lab.calibrated(lab.readings(ARRAY, rng)) for _ in range(30)]
    widths = np.array([[np.ptp(intervals(r), axis=1) for r in lab_rows] for lab_rows in rows])
    assert (widths.mean(0) > known_widths(lab, ARRAY)).all()


def test_a_share_has_the_exact_interval():
    """From the definition: at either end the tail beyond what was counted is 2.5 %."""
    low, high = interval_tables.exact_limits(190, 200)
    assert binom.sf(189, 200, low) == pytest.approx(0.025) and binom.cdf(190, 200, high) == pytest.approx(
        0.025
    )
    assert interval_tables.exact_limits(0, 10)[0] == 0 and interval_tables.exact_limits(10, 10)[1] == 1


def test_a_reason_stands_where_the_figures_want_one():
    assert interval_tables.reason(0.95, 1.2, Lab(5), "a cause") == ""
    assert "2 degrees of freedom" in interval_tables.reason(0.95, 1.8, Lab(3), "")
    assert "a cause" in interval_tables.reason(0.99, 1.0, Lab(5), "a cause")
    assert "too seldom" in interval_tables.reason(0.90, 1.0, Lab(5), "a cause")


def test_published_rows_are_of_the_studies_that_the_command_makes():
    text = DOCUMENT.read_text("utf-8")
    for study in (*interval_tables.STUDIES, *interval_tables.BROKEN):
        assert f"| {study.what} |" in text
    assert all(f"| {what} | {2 * interval_tables.LABS} |" in text for what in interval_tables.NOISES)
    rows = [
        line.split(" | ") for line in text.splitlines() if line.startswith("| ") and " | all three | " in line
    ]
    assert {int(r[3]) for r in rows} == {interval_tables.LABS}


@pytest.mark.nightly
def test_the_published_tables_come_again():
    text = DOCUMENT.read_text("utf-8")
    assert interval_tables.renewed(text, interval_tables.LABS, lambda what: None) == text
