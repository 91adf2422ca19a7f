r"""The rail's carriage without seals, bought: section across the rail.

+-------------------+   y = RAIL_HEIGHT: mounting face, four M3 threads
|   +-----------+   |
+---+   rail    +---+
"""

from __future__ import annotations

from tactcad.contour import chain

from ..description import Extrusion, Hole, Part, Purchase
from ..part_materials import CARBON_STEEL
from .frame import CARRIAGE_LENGTH, RAIL_HEIGHT


def carriage() -> Part:
    """The rail's carriage, ends without seals: section in (x, y) with y out of the rail's mounting face,
    extruded along the rail."""
    section = chain(
        [
            (-10, 2.2),
            (-4.5, 2.2),
            (-4.5, 6.5),
            (4.5, 6.5),
            (4.5, 2.2),
            (10, 2.2),
            (10, RAIL_HEIGHT),
            (-10, RAIL_HEIGHT),
        ]
    )
    threads = tuple(
        Hole(
            "mount",
            (sx * 7.5, RAIL_HEIGHT, CARRIAGE_LENGTH / 2 + sy * 5.0),
            (0, -1, 0),
            2.5,
            3.0,
            False,
            thread="M3",
            thread_depth=3.0,
        )
        for sx in (-1, 1)
        for sy in (-1, 1)
    )
    return Part(
        part_no="CARRIAGE-9-UNSEALED",
        name="Guide carriage 9, without seals",
        process="bought",
        material=CARBON_STEEL,
        body=Extrusion(section, CARRIAGE_LENGTH),
        features=threads,
        colour="#50575f",
        notes=("seals taken off: they drag 0.1 to 0.5 N",),
        purchase=Purchase(
            "miniature guide carriage for rail width 9, no seals, light clearance (Z0), 4 x M3 at 15 x 10",
            alternates="MGN9C and alike",
        ),
        mass_override=16.0,
    )
