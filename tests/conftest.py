"""What all tests share: nobody's cache but their own. Its being here also puts tests/ on the import path."""

from __future__ import annotations

import pytest


@pytest.fixture(autouse=True)
def own_cache(tmp_path_factory, monkeypatch):
    """No test reads what another run, or the user's own exports, left in the cache."""
    monkeypatch.setenv("TACTCAD_CACHE", str(tmp_path_factory.getbasetemp() / "cache"))
