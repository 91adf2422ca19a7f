"""What tests of pages share."""

from __future__ import annotations

import pytest
from browser import browser


@pytest.fixture(scope="module")
def running():
    """A browser; each page opens in a context of its own."""
    with browser() as one:
        yield one
