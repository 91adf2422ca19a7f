r"""Plate that holds the force gauge by two screws from behind, and is itself held at its sides.

+-----------------+
| O      O      O |
|                 |   middle column: gauge; sides: axis plate
| O      O      O |
+-----------------+
"""

from __future__ import annotations

from collections.abc import Sequence

from tactcad.contour import rectangle

from ..description import Extrusion, Feature, Part
from ..plate import plate
from ..screw_holes import corners, sunk
from .force_gauge import GAUGE_THREADS
from .frame import PLATE, PLATE_SCREW
from .stand_layout import StandLayout

GAUGE_SCREW_X, GAUGE_SCREW_Z = 40.0, 20.0  # gauge plate on axis plate: outside the gauge's width


def gauge_plate(rig: StandLayout) -> Part:
    """Holds the force gauge by two screws from behind. Front face at local z = 0."""
    thread, _, under = PLATE_SCREW
    features = [
        sunk("axis_plate", thread, (px, py, 0.0), (0, 0, 1), PLATE, under)
        for px, py in corners(GAUGE_SCREW_X, GAUGE_SCREW_Z)
    ]
    features += [sunk("gauge", thread, (0.0, y, PLATE), (0, 0, -1), PLATE, under) for y in GAUGE_THREADS]
    return upright_plate(rig, "gauge-plate", "Gauge plate", features)


def upright_plate(rig: StandLayout, number: str, name: str, features: Sequence[Feature]) -> Part:
    return plate(rig.design, number, name, Extrusion(rectangle(-46.0, -35.0, 46.0, 35.0), PLATE), features)
