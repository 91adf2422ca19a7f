"""The arrays that benchmarks are made on: legal designs of the size they say."""

from __future__ import annotations

import pytest
from measuring import array_of, array_text, published_text

from tactcad.design.load import parse
from tactcad.parts.rules import refuse_broken


@pytest.mark.parametrize("elements", [2, 10, 20, 30, 40, 100, 300, 400, 1000])
@pytest.mark.parametrize("changed", [False, True])
def test_its_designs_are_legal_and_of_the_size_they_say(elements, changed):
    design = parse(array_text(elements, changed), "benchmark")
    refuse_broken(design)
    assert sum(map(len, design.array.row_arms)) == elements
    if not changed:
        assert design.array.row_arms == array_of(elements).array.row_arms


def test_ten_elements_are_the_published_design():
    assert parse(array_text(10), "a") == parse(published_text(), "a") == array_of(10)
    assert parse(array_text(10, changed=True), "a") != array_of(10)
