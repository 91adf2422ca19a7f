r"""Pin that centres the weights, as high as their stack and the ballast under it.

+---+
|   |
|   |   z up
| o |   M4 thread in its foot
+---+   z = 0
"""

from __future__ import annotations

from math import ceil

from tactcad.contour import circle

from ..description import Extrusion, Part
from ..library.screws import tapped_depth
from ..part_materials import plate_material
from ..screw_holes import tapped_blind
from .disc_weight import disc_weight
from .frame import PIN
from .guide_layout import GuideLayout


def pin(rig: GuideLayout, under: float = 0.0) -> Part:
    """Pin that centres the weights, as high as their stack on `under` mm of ballast; M4 thread in its
    foot."""
    stack = round(rig.grasping.weights) * disc_weight(rig).extrusion.thickness
    thread = tapped_depth("M4") + 1.0  # in its foot, and the floor over it
    height = 5.0 * ceil(max(stack + max(9.0, under + 1.0), thread) / 5.0)
    return Part(
        part_no=f"{rig.design.name}-weight-pin",
        name="Weight pin",
        process="turned",
        material=plate_material(rig.design),
        body=Extrusion(circle((0, 0), PIN), height),
        features=(tapped_blind("foot", "M4", (0, 0, 0), (0, 0, 1)),),
        colour="#9aa4ae",
        finish="Ra 1.6, top edge chamfered 0.5 by hand",
    )
