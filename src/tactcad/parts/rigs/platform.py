r"""Plate on the bar's upper end; the weights' pin stands over the array's middle.

+-----------+
|   O   O   |   bar, sunk from above
|           |   ^ y
|    (o)    |   |   pin, sunk from below
+-----------+   +-> x
"""

from __future__ import annotations

from tactcad.contour import rectangle

from ..description import Extrusion, Feature, Part
from ..plate import plate
from ..screw_holes import sunk
from .bar import BAR_SCREW_X
from .frame import BAR_FRONT, BAR_WIDTH, BEHIND_BAR, PLATFORM
from .guide_layout import GuideLayout

PLATFORM_UNDER_HEAD = 3.5  # heads sunk by 0.5: the weights lie flat


def platform(rig: GuideLayout) -> Part:
    """Plate on the bar's upper end; the weights' pin stands over the array's middle. z = 0 is the
    underside."""
    half = rig.grasping.weight_diameter / 2
    features: list[Feature] = [
        sunk(
            "bar",
            "M4",
            (sx * BAR_SCREW_X, rig.bar_middle, PLATFORM),
            (0, 0, -1),
            PLATFORM,
            PLATFORM_UNDER_HEAD,
        )
        for sx in (-1, 1)
    ]
    features.append(sunk("pin", "M4", (0.0, 0.0, 0.0), (0, 0, 1), PLATFORM, PLATFORM_UNDER_HEAD))
    return plate(
        rig.design,
        "platform",
        "Weight platform",
        Extrusion(
            rectangle(-BAR_WIDTH, -min(half, 20.0), BAR_WIDTH, BAR_FRONT + rig.bar + BEHIND_BAR), PLATFORM
        ),
        features,
    )
