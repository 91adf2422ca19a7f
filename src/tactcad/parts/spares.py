"""How many pieces beyond the array's are ordered, by what building it may cost."""

from __future__ import annotations

from math import ceil

LOST_IN = 10  # the paper: of ten elements one, no. 5, did not work


def spare_elements(count: int) -> int:
    """Spare elements of a kind of which the array has `count`: one of every ten, and one of every kind, since
    none can stand in for another's arm."""
    return ceil(count / LOST_IN)
