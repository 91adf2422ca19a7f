r"""Plate on the array's carrier, the bar at its back edge.

+---------------+
|    (o) (o)    |   bar, sunk from below
|  O         O  |   ^ y
|  O         O  |   |   carrier, sunk from above
+---------------+   +-> x
"""

from __future__ import annotations

from tactcad.contour import rectangle

from ..description import Extrusion, Feature, Part
from ..library.screws import METRIC
from ..plate import plate
from ..screw_holes import sunk
from .bar import BAR_SCREW_X
from .carrier_screws import carrier_pattern, under_carrier_screw
from .frame import BAR_FRONT, BAR_WIDTH, BEHIND_BAR, FOOT
from .guide_layout import GuideLayout

FOOT_UNDER_HEAD = 3.6  # of the bar's screws, heads sunk by 0.4


def foot(rig: GuideLayout) -> Part:
    """Plate on the array's carrier, with the bar at its back edge. z = 0 is the carrier's side."""
    x = round(max(rig.array.mount_x + METRIC[rig.design.clamp.mount_thread].head / 2, BAR_WIDTH / 2) + 2.0, 3)
    y = round(rig.design.clamp.mount_pitch_y / 2 + METRIC[rig.design.clamp.mount_thread].head / 2 + 2.0, 3)
    mount = rig.design.clamp.mount_thread
    features: list[Feature] = [
        sunk("carrier", mount, (px, py, FOOT), (0, 0, -1), FOOT, under_carrier_screw(rig.design))
        for px, py in carrier_pattern(rig.array)
    ]
    features += [
        sunk("bar", "M4", (sx * BAR_SCREW_X, rig.bar_middle, 0.0), (0, 0, 1), FOOT, FOOT_UNDER_HEAD)
        for sx in (-1, 1)
    ]
    return plate(
        rig.design,
        "foot",
        "Foot of the bar",
        Extrusion(rectangle(-x, -y, x, max(y, BAR_FRONT + rig.bar + BEHIND_BAR)), FOOT),
        features,
    )
