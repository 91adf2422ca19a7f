r"""Carrier over the end plates: takes the axis, and the set screws that hold the stop plate down.

+-------------------------------+
| O   o   .           .   o   O |   O end plate's screws, sunk
|         .           .         |   o threads for the axis
| O   o   .           .   o   O |   . set screws
+-------------------------------+
"""

from __future__ import annotations

from math import ceil, floor

from tactcad.contour import rectangle
from tactcad.design.present import present

from .description import Extrusion, Feature, Hole, Part
from .fasteners import STACK, carrier_screw
from .layout import Layout
from .library.fits import general
from .library.screws import METRIC, counterbore_diameter
from .plate import PLACE, plate
from .screw_holes import tapped_through


def carrier(layout: Layout) -> Part:
    """Plate over the end plates: takes the axis, and the set screws that hold the stop plate down.

    Local (x, y) is the scene's, z = 0 its underside.
    """
    d, thread = layout.design, layout.design.clamp.screw
    length, width = layout.carrier_size
    t = d.clamp.carrier_thickness
    metric = METRIC[thread]
    screw = present(carrier_screw(layout))
    wider = carrier_clearance(layout) - metric.clearance
    counterbore = (round(counterbore_diameter(thread) + wider, 9), round(t - screw.under_head, 9))
    features: list[Feature] = []
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            features.append(
                Hole(
                    "end_plate_screw",
                    (sx * layout.carrier_screw_x, sy * layout.end_plate_y, t),
                    (0, 0, -1),
                    carrier_clearance(layout),
                    t,
                    True,
                    counterbore=counterbore,
                )
            )
            features.append(
                tapped_through(
                    "mount",
                    d.clamp.mount_thread,
                    (sx * layout.mount_x, sy * d.clamp.mount_pitch_y / 2, t),
                    (0, 0, -1),
                    t,
                )
            )
        for y in layout.hold_down_y:
            features.append(
                tapped_through("hold_down", thread, (sx * layout.hold_down_x, y, t), (0, 0, -1), t)
            )
    return plate(
        d,
        "carrier",
        "Carrier",
        Extrusion(rectangle(-length / 2, -width / 2, length / 2, width / 2), t),
        features,
    )


def carrier_clearance(layout: Layout) -> float:
    """Diameter of the holes for the end plates' screws, mm.

    They let the end plates stand as far apart as the stack makes them, and their threads where their zones
    allow, be they as small as general tolerances allow; but no wider than leaves LEAST_RING of every head's
    face on the carrier.
    """
    m = METRIC[layout.design.clamp.screw]
    wanted = m.d + STACK + 2 * PLACE + general(m.clearance)
    # (head - hole)/2 - (hole - d)/2 >= LEAST_RING
    widest = (m.head - HEAD_LESS + m.d) / 2 - LEAST_RING
    return max(m.clearance, min(floor(10 * widest + 1e-6), ceil(10 * wanted - 1e-6)) / 10)


# Least of a head's face beside a hole, on the side where it is least, mm; chosen.
LEAST_RING = 0.25
HEAD_LESS = 0.2  # mm: least head diameter under the largest (ISO 4762, table 1, rounded up)
