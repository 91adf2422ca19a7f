"""A line of the bill of materials that has no solid, and how many pieces beyond the array's are ordered, by
what building it may cost.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

# What the bill's column `process` says of what is bought, and so who is asked for it.
ELECTRONIC = "electronic"
BARE_BOARD = "circuit board"
MECHANICAL = "bought"


@dataclass(frozen=True)
class Supply:
    """A bill-of-materials line without a solid. Quantities count the array once; spares come on top."""

    part_no: str
    description: str
    qty: float
    unit: str
    designation: str
    alternates: str = ""
    spares: float = 0
    consumable: bool = True
    manufacturer: str = ""
    mpn: str = ""
    verified: bool = False
    process: str = ELECTRONIC


LOST_IN = 10  # the paper: of ten elements one, no. 5, did not work


def spare_elements(count: int) -> int:
    """Spare elements of a kind of which the array has `count`: one of every ten, and one of every kind, since
    none can stand in for another's arm."""
    return ceil(count / LOST_IN)


def bonded_spares(n: float) -> int:
    """Spares of n that are bonded or soldered to elements: one in five, at least one; chosen: the paper lost
    one of ten, and a second trial is likely."""
    return max(1, ceil(n / 5))


def board_spares(n: float) -> int:
    """Spares of n that are soldered on boards: one in ten, at least one; chosen: usual practice."""
    return max(1, ceil(n / 10))
