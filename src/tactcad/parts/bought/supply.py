"""A line of the bill of materials that has no solid, and the number of spares to order, by the losses
expected in building.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

# The bill's column `process` for bought items, which decides the supplier.
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
    none can replace another arm."""
    return ceil(count / LOST_IN)


def bonded_spares(n: float) -> int:
    """Spares of n that are bonded or soldered to elements: one in five, at least one; chosen: the paper lost
    one of ten, and a second trial is likely."""
    return max(1, ceil(n / 5))


def board_spares(n: float) -> int:
    """Spares of n that are soldered on boards: one in ten, at least one; chosen: usual practice."""
    return max(1, ceil(n / 10))
