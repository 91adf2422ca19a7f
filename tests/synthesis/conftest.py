"""What tests of a synthesis share."""

from __future__ import annotations

from itertools import count
from types import SimpleNamespace

import pytest

from tactcad.costs import grades
from tactcad.synthesis import synthesise


@pytest.fixture(autouse=True)
def machine_as_published(monkeypatch):
    """What fits into given seconds does not hang on how busy the machine is that tests."""
    monkeypatch.setattr(grades, "slowness", lambda: 1.0)


@pytest.fixture
def time_is_over(monkeypatch):
    """A clock by which any time given is over at once."""
    clock = count(step=1e4)
    monkeypatch.setattr(synthesise, "time", SimpleNamespace(perf_counter=lambda: next(clock)))
