"""What these tests share: the shipped design as an array, the paper's data, one full report."""

from __future__ import annotations

import pytest

from tactcad.paper import published, validation
from tactcad.paper.array_model import from_design
from tactcad.parts.rules import load


@pytest.fixture(scope="session")
def array():
    return from_design(load("macro-array"))


@pytest.fixture(scope="session")
def paper():
    return published.load()


@pytest.fixture(scope="session")
def report(array, paper):
    return validation.validate(paper, array)
