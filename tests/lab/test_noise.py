"""The law by which readings scatter, and the outliers that are told from it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import binom

from tactcad.lab import regression
from tactcad.lab.regression import extreme_deviates

STEPS = 0.025 * np.arange(1, 7)
X, RUN = np.tile(STEPS, 3), np.repeat([1, 2, 3], 6)
SLOPES = np.array([5.2, 9.6, 12.0, 23.6, 33.4])  # N/mm


def deviation(of_sensor: float, of_stage: float, of_reading: float, slope: float) -> np.ndarray:
    """Standard deviation of every reading: three sources that know nothing of each other, N."""
    return np.sqrt(of_sensor**2 + (slope * of_stage) ** 2 + (of_reading * slope * X) ** 2)


def read(sd: tuple[float, float, float], slopes: np.ndarray, rng: np.random.Generator) -> list[np.ndarray]:
    return [k * X + deviation(*sd, k) * rng.standard_normal(len(X)) for k in slopes]


def weights(readings: list[np.ndarray]) -> list[np.ndarray]:
    return regression.weights([regression.Readings(X, X, y, RUN) for y in readings])


@pytest.mark.parametrize(
    "sd",
    [(0.003, 0.0, 0.0), (0.0005, 0.0005, 0.0), (0.003, 0.0005, 0.01), (0.003, 0.0, 0.03)],
    ids=["even", "of the stage", "all three", "grows"],
)
def test_the_law_gives_the_variances_that_made_the_readings(sd):
    """400 elements: each reading's standard deviation within 10 % of the one it was drawn with; where noise
    grows, that of the first displacement, whose reading nearly makes its run's intercept, is taken for up to
    1.4 times as much.
    """
    slopes = np.repeat(SLOPES, 80)
    most = np.where((X == STEPS[0]) & (sd[2] > 0), 1.4, 1.1)
    for k, w in zip(slopes, weights(read(sd, slopes, np.random.default_rng(1)))):
        true = np.maximum(deviation(*sd, k), deviation(*sd, k).max() / 10)
        assert ((w**-0.5 > 0.9 * true) & (w**-0.5 < most * true)).all()


def test_one_bad_reading_is_no_noise_that_grows():
    """At the largest displacement, 30 standard deviations off: its weight is above a third of the others'."""
    readings = read((0.003, 0.0, 0.0), SLOPES, np.random.default_rng(2))
    readings[2][5] += 0.09
    w = weights(readings)[2]
    assert w[5] > w[0] / 3


@pytest.mark.filterwarnings("error")
def test_readings_without_noise_count_alike():
    x = np.array([1.0, 2.0, 3.0, 4.0])
    w = regression.weights([regression.Readings(x, x, 2 * x, np.ones(4, int))])[0]
    assert np.isfinite(w).all() and w.max() <= regression.RANGE * w.min()


@pytest.mark.by_day(1, "hundreds of simulated labs each")
@pytest.mark.parametrize(
    "sd", [(0.003, 0.0, 0.0), (0.003, 0.0, 0.01), (0.003, 0.0, 0.03)], ids=["even", "1 %", "3 %"]
)
def test_false_alarms_come_at_one_rate_whatever_the_noise(sd):
    """One file in a hundred: of 800 files of five elements at most what binomial chance 1e-4 leaves."""
    rng = np.random.default_rng(3)
    named = 0
    for _ in range(800):
        readings = read(sd, SLOPES, rng)
        alarm = 0.01 / len(readings)
        named += any(extreme_deviates(X, y, RUN, w, alarm) for y, w in zip(readings, weights(readings)))
    assert named <= binom.ppf(1 - 1e-4, 800, 0.01), named
