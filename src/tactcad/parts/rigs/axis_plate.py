r"""Plate on the vertical stage's moving half: takes the gauge plate outside the gauge's width.

+-----------------+
| o   O     O   o |   O stage, sunk; o gauge plate, tapped
|                 |
| o   O     O   o |
+-----------------+
"""

from __future__ import annotations

from ..description import Part
from ..screw_holes import sunk, tapped
from .frame import PLATE, PLATE_SCREW, STAGE_HOLE
from .gauge_plate import GAUGE_SCREW_X, GAUGE_SCREW_Z, upright_plate
from .stand_layout import StandLayout


def axis_plate(rig: StandLayout) -> Part:
    """On the vertical stage; takes the gauge plate outside the gauge's width. Front face at local z = 0."""
    thread, _, under = PLATE_SCREW
    features = [
        sunk("stage", thread, (sx * STAGE_HOLE, sy * STAGE_HOLE, 0.0), (0, 0, 1), PLATE, under)
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    features += [
        tapped("gauge_plate", thread, (sx * GAUGE_SCREW_X, sy * GAUGE_SCREW_Z, 0.0), (0, 0, 1), PLATE)
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    return upright_plate(rig, "axis-plate", "Axis plate", features)
