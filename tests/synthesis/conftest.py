"""What tests of a synthesis share."""

from __future__ import annotations

import pytest

from tactcad.synthesis import synthesise


@pytest.fixture
def answer_only(monkeypatch):
    """There is time for the answer, and for nothing beside it."""

    def answer(tasks, *_, **__):
        return ((n, task.make()) for n, task in enumerate(tasks) if task.name == synthesise.ANSWER)

    monkeypatch.setattr(synthesise, "side_by_side", answer)
