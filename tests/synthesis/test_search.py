"""The search against every candidate of small problems."""

from __future__ import annotations

import numpy as np
import pytest

from tactcad.synthesis.candidates import Stand, stands
from tactcad.synthesis.search import search
from tactcad.synthesis.target import parse_target

SEED = 20261126  # not the one that the search was tuned with
WORSE = 0.01  # relative, than the best of all, at most
FEWER = 100  # times fewer candidates looked at, at least
CHUNK = 50_000


def problem(seed: int, steps: tuple[int, int, int, int]) -> Stand:
    """A target by chance, its numbers kept within `steps` of arm, thickness, slot and radius by chance."""
    rng = np.random.default_rng(seed)
    low = rng.uniform(0.5, 5.0)
    target = parse_target(
        f"""
        [target]
        name = "small"
        [object]
        stiffness = [{low:.3g}, {low * rng.uniform(2.0, 5.0):.3g}]
        [grasp]
        force = {rng.uniform(4.0, 12.0):.3g}
        overload = 20.0
        [room]
        elements = [2, {rng.integers(4, 9)}]
        """,
        "small",
    )
    (stand,) = stands(target)
    least, most = stand.limits
    arm, thickness, slot, radius = steps
    width = np.array([arm, thickness, 3, arm, thickness, 3, slot, radius])
    start = rng.integers(least, np.maximum(most - width + 1, least) + 1)
    start[[2, 5]] = 1
    start[[1, 4]] = rng.integers(
        [55, 75], [65, 95]
    )  # one kind thin, one thick, so that some bear their forces
    start[6] = rng.integers(40, 70)
    stand.__dict__["limits"] = (start, np.minimum(start + width - 1, most))
    return stand


def best_of_all(stand: Stand) -> tuple[float, int]:
    """Least half-width of all candidates that keep the limits, and how many there are."""
    low, high = stand.limits
    shape = tuple(int(n) for n in high - low + 1)
    count, best = int(np.prod(shape)), np.inf
    for first in range(0, count, CHUNK):
        some = np.unravel_index(np.arange(first, min(first + CHUNK, count)), shape)
        c = stand.candidates(low + np.stack(some, axis=1))
        with np.errstate(all="ignore"):
            best = min(best, float(np.where(c.violation > 0.0, np.inf, c.half_width).min()))
    return best, count


def held_against_all(stand: Stand) -> tuple[float, float]:
    """How much worse the search's answer is, relative, and how many times fewer candidates it looked at."""
    got = search(stand, lambda c: c.half_width, rules=None)
    best, count = best_of_all(stand)
    assert np.isfinite(best)
    assert got.accepted
    return got.half_width / best - 1.0, count / got.evaluations


def test_small_problem_is_searched_as_if_all_were_tried():
    worse, fewer = held_against_all(problem(SEED, (4, 4, 5, 3)))
    assert -1e-12 <= worse <= WORSE
    assert fewer > 4  # of 34 560; what the search saves grows with the problem


@pytest.mark.nightly
@pytest.mark.parametrize("n", range(6))
def test_six_problems_of_two_million_candidates(n, record_property):
    worse, fewer = held_against_all(problem(SEED + n, (7, 9, 14, 4)))
    record_property(f"problem {n}", f"{100 * worse:.2f} % worse at {fewer:.0f} times fewer candidates")
    assert -1e-12 <= worse <= WORSE
    assert fewer >= FEWER
