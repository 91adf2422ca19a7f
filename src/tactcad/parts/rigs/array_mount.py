r"""Plate on the upper stage that holds the array on its back in the calibration.

+-----------------+
| O             O |   O stage, sunk from above
|    (O)   (O)    |   (O) carrier, sunk from below
|    (O)   (O)    |
| O             O |
+-----------------+
"""

from __future__ import annotations

from tactcad.contour import rectangle

from ..description import Extrusion, Feature, Part
from ..limits import FACES, Geometric
from ..plate import plate
from ..screw_holes import corners, sunk
from .carrier_screws import carrier_pattern, under_carrier_screw
from .frame import PLATE, PLATE_SCREW
from .stand_layout import StandLayout


def array_mount(rig: StandLayout) -> Part:
    """Plate on the upper stage that holds the array on its back. z = 0 is the stage's side."""
    thread, _, under = PLATE_SCREW
    stage = rig.stage
    x = max(rig.array.carrier_size[0] / 2, stage.size / 2)
    features: list[Feature] = [
        sunk("stage", thread, (px, py, PLATE), (0, 0, -1), PLATE, under)
        for px, py in corners(stage.hole, stage.hole)
    ]
    mount = rig.design.clamp.mount_thread
    features += [
        sunk("carrier", mount, (px, py, 0.0), (0, 0, 1), PLATE, under_carrier_screw(rig.design))
        for px, py in carrier_pattern(rig.array)
    ]
    return plate(
        rig.design,
        "array-mount",
        "Array mount",
        Extrusion(rectangle(-x, -stage.size / 2, x, stage.size / 2), PLATE),
        features,
        finish="Ra 1.6",
        geometric=(Geometric("parallelism", "parallelism", 0.01, (FACES[1],), ("A",)),),
    )
