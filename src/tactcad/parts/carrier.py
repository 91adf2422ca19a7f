r"""Carrier over the end plates: takes the axis, and the set screws that hold the stop plate down.

+-------------------------------+
| O   o   .           .   o   O |   O end plate's screws, sunk
|         .           .         |   o threads for the axis
| O   o   .           .   o   O |   . set screws
+-------------------------------+
"""

from __future__ import annotations

from tactcad.contour import rectangle
from tactcad.design.present import present

from .description import Extrusion, Feature, Hole, Part
from .fasteners import carrier_screw
from .layout import Layout
from .library.screws import METRIC, counterbore_diameter
from .plate import plate
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
    counterbore = (counterbore_diameter(thread), round(t - screw.under_head, 9))
    features: list[Feature] = []
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            features.append(
                Hole(
                    "end_plate_screw",
                    (sx * layout.carrier_screw_x, sy * layout.end_plate_y, t),
                    (0, 0, -1),
                    metric.clearance,
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
