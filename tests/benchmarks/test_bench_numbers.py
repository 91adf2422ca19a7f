"""What a benchmark's figures rest on: the fit of exponents, the efficient front, times in turns, tables."""

from __future__ import annotations

import csv
import io
import json

import numpy as np
import pytest
import tables
from bench_elements import errors
from measuring import interleaved, of_samples
from tables import dominators, efficient, exponent, told


@pytest.mark.parametrize("p", [0.0, 0.5, 1.0, 2.0])
def test_an_exact_power_is_found_with_no_doubt_left(p):
    sizes = [10, 30, 100, 1000]
    found = exponent(sizes, [3e-4 * n**p for n in sizes])
    assert (found.value, found.low, found.high, found.last) == pytest.approx((p, p, p, p), abs=1e-9)


def test_its_interval_covers_the_truth_nineteen_times_in_twenty():
    random, sizes = np.random.default_rng(3), np.array([10, 30, 100, 300, 1000])
    covered = 0
    for _ in range(2000):
        found = exponent(sizes, sizes**1.3 * np.exp(random.normal(0, 0.2, 5)))
        covered += found.low <= 1.3 <= found.high
    assert 0.935 < covered / 2000 < 0.965  # binomial: 0.95 +- 3 x 0.005


def test_a_fixed_cost_shows_in_the_last_step():
    sizes = [1, 10, 100, 1000, 10_000]
    found = exponent(sizes, [1.0 + 1e-3 * n for n in sizes])
    assert found.value < 0.35 and found.last == pytest.approx(np.log10(11.0 / 2.0), rel=1e-12)


def test_two_sizes_have_no_interval_and_one_has_no_exponent():
    found = exponent([10, 20], [1.0, 4.0])
    assert found.value == pytest.approx(2.0) and (found.low, found.high) == (-np.inf, np.inf)
    with pytest.raises(ValueError, match="two sizes"):
        exponent([10, 10], [1.0, 2.0])


def dominated(point, points) -> bool:
    return any(all(a <= b for a, b in zip(q, point)) and q != point for q in points)


def test_the_front_is_what_nothing_dominates():
    """Brute force over every pair; few distinct values, so that ties and equal points occur."""
    for seed in range(40):
        points = [tuple(map(float, p)) for p in np.random.default_rng(seed).integers(1, 6, (seed % 14, 2))]
        front = efficient(points)
        assert sorted(front) == [i for i, p in enumerate(points) if not dominated(p, points)], seed
        assert [points[i][0] for i in front] == sorted(points[i][0] for i in front), seed
        instead = dominators(points)
        assert set(instead) == set(range(len(points))) - set(front), seed
        for i, j in instead.items():
            as_quick = [p[1] for p in points if p[0] <= points[i][0]]
            assert points[j][0] <= points[i][0] and points[j][1] == min(as_quick), seed


def test_the_sentence_names_front_and_dominated():
    said = told(["a", "b", "c"], [(1.0, 1.0), (2.0, 3.0), (3.0, 0.1)])
    assert said == "On the efficient front, quickest first: a, c. Dominated: b by a."


def test_actions_are_run_in_turns_and_each_as_often():
    order = []
    timed = interleaved({name: (lambda name=name: order.append(name)) for name in "abc"}, 3)
    rounds = "".join(key for i, key in enumerate(order) if i == 0 or order[i - 1] != key)
    assert rounds == "abc" + "abc" + "bca" + "cab", "a warm-up, then every round begins with the next one"
    assert all(t.runs == 3 and 0 < t.seconds <= t.median for t in timed.values())


def test_samples_of_another_clock():
    found = of_samples([3.0, 1.0, 8.0])
    assert (found.seconds, found.median, found.runs) == (1.0, 3.0, 3)


ROWS = [
    {"name": "a", "time": 0.00123456, "wrong": 3, "kept": True},
    {"name": "b | c", "time": None, "wrong": 0, "kept": False},
]
TABLE = tables.table("name; time [ms]; wrong; kept", ROWS)


def test_a_table_reads_the_same_in_every_form():
    assert json.loads(json.dumps(TABLE)) == TABLE
    read = list(csv.DictReader(io.StringIO(tables.as_csv(TABLE))))
    assert float(read[0]["time"]) == ROWS[0]["time"] and read[1]["time"] == "" and read[1]["name"] == "b | c"
    heads, _, first, second = tables.markdown(TABLE).splitlines()
    assert heads == "| name | time, ms | wrong | kept |"
    assert first == "| a | 1.23 | 3 | yes |" and second == "| b \\| c |  | 0 | no |"


def test_no_error_smaller_than_that_of_the_converged_elements_is_claimed():
    found = errors(np.array([1.0, 1.01, np.nan]), np.ones(3), "solid", np.array([2e-4, 2e-4, 2e-4]))
    assert found == {
        "solid mean": pytest.approx((2e-4 + 0.01) / 2),
        "solid worst": pytest.approx(0.01),
        "solid designs": 2,
    }
