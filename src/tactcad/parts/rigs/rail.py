r"""Miniature guide rail, bought: width 9, counterbored M3 holes 20 apart.

+---------------------------+
|   O     O     O     O     |   y ->, z out of the mounting face
+---------------------------+
"""

from __future__ import annotations

from tactcad.contour import rectangle

from ..description import Extrusion, Hole, Part, Purchase
from ..part_materials import CARBON_STEEL


def rail(length: float) -> Part:
    """Miniature guide rail, width 9: local z out of its mounting face, y along it, holes 20 apart."""
    half = length / 2
    holes = tuple(
        Hole("mount", (0, y, 6.5), (0, 0, -1), 3.5, 6.5, True, counterbore=(6.0, 3.5))
        for y in rail_holes(length)
    )
    return Part(
        part_no=f"RAIL-9x{length:g}-guide",
        name=f"Guide rail 9, {length:g} long",
        process="bought",
        material=CARBON_STEEL,
        body=Extrusion(rectangle(-4.5, -half, 4.5, half), 6.5),
        features=holes,
        colour="#6f7378",
        purchase=Purchase(
            f"miniature guide rail, width 9, length {length:g}, holes M3 at 20", alternates="MGN9R and alike"
        ),
    )


def rail_holes(length: float) -> tuple[float, ...]:
    """Along the rail from its middle, mm: 20 apart, half a pitch from the ends."""
    count = round(length / 20.0)
    return tuple(20.0 * (i - (count - 1) / 2) for i in range(count))
