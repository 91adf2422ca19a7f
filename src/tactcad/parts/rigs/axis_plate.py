r"""Plate on the vertical stage's moving half: takes the gauge plate outside the gauge's width.

+-----------------+
| o   O     O   o |   O stage, sunk; o gauge plate, tapped
|                 |
| o   O     O   o |
+-----------------+
"""

from __future__ import annotations

from ..description import Part
from ..screw_holes import corners, sunk, tapped
from .frame import PLATE, PLATE_SCREW, STAGE_HOLE
from .gauge_plate import GAUGE_SCREW_X, GAUGE_SCREW_Z, upright_plate
from .stand_layout import StandLayout


def axis_plate(rig: StandLayout) -> Part:
    """On the vertical stage; takes the gauge plate outside the gauge's width. Front face at local z = 0."""
    thread, _, under = PLATE_SCREW
    features = [
        sunk("stage", thread, (px, py, 0.0), (0, 0, 1), PLATE, under)
        for px, py in corners(STAGE_HOLE, STAGE_HOLE)
    ]
    features += [
        tapped("gauge_plate", thread, (px, py, 0.0), (0, 0, 1), PLATE)
        for px, py in corners(GAUGE_SCREW_X, GAUGE_SCREW_Z)
    ]
    return upright_plate(rig, "axis-plate", "Axis plate", features)
