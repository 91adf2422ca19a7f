"""A line of the bill of materials that has no solid."""

from __future__ import annotations

from dataclasses import dataclass

# What the bill's column `process` says of what is bought, and so who is asked for it.
ELECTRONIC = "electronic"
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
