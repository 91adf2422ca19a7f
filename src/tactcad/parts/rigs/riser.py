r"""Block between post and guide rail.

+---------+
| O     O |   screws into the post, heads deep inside
|    o    |   ^ z
|    o    |   |     the rail's M3 threads
| O     O |   +-> x
+---------+
"""

from __future__ import annotations

from tactcad.contour import rectangle

from ..description import Extrusion, Feature, Part
from ..plate import plate
from ..screw_holes import sunk, tapped_blind
from .frame import POST, RISER_PITCH, STAGE_HOLE
from .guide_layout import GuideLayout
from .rail import rail_holes

RISER_SCREW, RISER_UNDER_HEAD = 16.0, 9.0  # M4 into the post: 7 mm engaged, head deep in the riser


def riser(rig: GuideLayout) -> Part:
    """Block between post and guide rail. Front face (the rail's) at local z = 0, contour in (x, z) about its
    middle."""
    length, depth = rig.grasping.rail_length, rig.riser_depth
    half = max(length / 2, RISER_PITCH + 8.0)
    features: list[Feature] = [
        sunk(
            "post",
            "M4",
            (sx * STAGE_HOLE, sy * RISER_PITCH, 0.0),
            (0, 0, 1),
            depth,
            min(RISER_UNDER_HEAD, depth),
        )
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    features += [tapped_blind("rail", "M3", (0.0, y, 0.0), (0, 0, 1)) for y in rail_holes(length)]
    return plate(
        rig.design,
        "riser",
        "Riser",
        Extrusion(rectangle(-POST[0] / 2, -half, POST[0] / 2, half), depth),
        features,
        finish="rail face Ra 0.8, parallel to the back within 0.01",
    )
