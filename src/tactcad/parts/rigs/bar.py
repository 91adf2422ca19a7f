r"""Vertical bar on the guide's carriage: foot below, platform above.

+--o---o--+   M4 threads into the ends
|         |
|  O   O  |   ^ z
|  O   O  |   |     sunk M3 into the carriage
+--o---o--+   +-> x
"""

from __future__ import annotations

from tactcad.contour import rectangle

from ..description import Extrusion, Feature, Part
from ..plate import plate
from ..screw_holes import sunk, tapped_blind
from .frame import BAR_WIDTH
from .guide_layout import GuideLayout

BAR_SCREW_X = 7.0
BAR_UNDER_HEAD = 3.6  # of the carriage's screws, M3x6: 2.4 mm in its 3 mm of thread, heads sunk


def bar(rig: GuideLayout) -> Part:
    """Vertical bar on the carriage. Contour in (x, z), front face at local z = 0, lower end at y = 0."""
    t, z, top = rig.bar, rig.carriage_on_bar, rig.bar_height
    features: list[Feature] = [
        sunk("carriage", "M3", (sx * 7.5, z + sy * 5.0, 0.0), (0, 0, 1), t, BAR_UNDER_HEAD)
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    for sx in (-1, 1):
        features.append(tapped_blind("foot", "M4", (sx * BAR_SCREW_X, 0.0, t / 2), (0, 1, 0)))
        features.append(tapped_blind("platform", "M4", (sx * BAR_SCREW_X, top, t / 2), (0, -1, 0)))
    return plate(
        rig.design,
        "bar",
        "Bar",
        Extrusion(rectangle(-BAR_WIDTH / 2, 0, BAR_WIDTH / 2, top), t),
        features,
        colour="#7c8794",
        finish="Ra 1.6, back face and ends square within 0.02",
    )
