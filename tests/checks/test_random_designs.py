"""Designs drawn over the whole legal range: each is refused by a named rule, or passes every check.

Seeds and counts stand at the end of pytest's output. A design is the number of its draw: `raw_table(number,
...)`. A thousand of them are tests/night.py's.
"""

from __future__ import annotations

import tomllib
from random import Random

import pytest
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st
from random_designs import Counts, as_toml, raw_table, redraw
from sound_designs import LEGAL, sound_table

pytestmark = pytest.mark.cad

CI_SEED = 20261121


def draw(count: int, start: int, row_lengths: tuple[int, ...], rigs: float) -> Counts:
    """Judge that many designs; one that is neither refused nor passes does not keep the others from their
    turn."""
    counts = Counts()

    # no shrinking: each example is a whole check, and a failing one says itself what is wrong
    @seed(start)
    @settings(
        max_examples=count,
        deadline=None,
        database=None,
        suppress_health_check=list(HealthCheck),
        phases=[Phase.generate],
    )
    @given(st.integers(0, 2**48))
    def each(number):
        counts.judge(f"design {number}", raw_table(number, row_lengths, rigs))

    each()
    return counts


@pytest.mark.slow  # checks whole designs by the kernel; by day those of test_rules.py
def test_four_designs_drawn_over_the_whole_legal_range(record_property):
    counts = draw(4, CI_SEED, (1, 2, 3), rigs=0.15)
    record_property("random designs", f"seed {CI_SEED}, {counts}")
    assert counts.failed == []
    assert counts.drawn >= 4 and 2 * counts.accepted >= counts.drawn


def test_draws_reach_over_every_fields_range():
    """Of 12000 draws on 100 sound designs, each field's least and largest value lie in its range's lowest and
    highest tenth, by the logarithm where the range spans decades."""
    seen: dict[str, list[float]] = {}
    sound = [sound_table(number, (1, 2, 3, 5), rigs=number % 2 == 0) for number in range(100)]
    for number in range(12000):
        values = dict(sound[number % 100])
        redraw(values, Random(number))
        for path, value in values.items():
            if path in LEGAL and path != "stop.gaps":  # holds several
                seen.setdefault(path, []).append(value)
    assert set(seen) == set(LEGAL) - {"stop.gaps"}
    for path, values in seen.items():
        low, high = LEGAL[path].low, LEGAL[path].high
        near = (high / low) ** 0.1 if 0 < 10 * low < high else None
        assert min(values) <= (low * near if near else low + (high - low) / 10), path
        assert max(values) >= (high / near if near else high - (high - low) / 10), path


def test_a_drawn_design_is_written_as_toml_and_read_back_the_same():
    for number in range(200):
        tree = raw_table(number, (1, 2, 3), 0.5)
        assert tomllib.loads(as_toml(tree)) == tree
