r"""Tip for the pads: a nose with a half-round seat for the roller, which stands out by its radius.

+-------+   z = TIP: M6 from the top
|       |
\       /
 +-( )-+
   ( )      roller; z = 0 its lowest line
"""

from __future__ import annotations

from tactcad.contour import Corner, rounded_polygon
from tactcad.design.present import present

from ..description import Extrusion, Part
from ..library.dowels import dowel_diameter
from ..part_materials import STAINLESS
from .flat_tip import shaft_thread
from .frame import TIP
from .stand_layout import StandLayout


def roller_tip(rig: StandLayout) -> Part:
    """Tip for the pads: a nose with a half-round seat for the roller, which stands out by its radius.

    Contour in (x, z), z = 0 the roller's lowest line, extruded along y by 10.
    """
    r = dowel_diameter(present(rig.design.calibration).roller) / 2
    nose, half = r + 1.0, 6.0
    corners = [
        Corner((-nose, r)),
        Corner((-r, r), edge="seat"),
        Corner((-r, 2 * r), r),
        Corner((r, 2 * r), r),
        Corner((r, r)),
        Corner((nose, r)),
        Corner((half, r + half - nose)),
        Corner((half, TIP)),
        Corner((-half, TIP)),
        Corner((-half, r + half - nose)),
    ]
    return Part(
        part_no=f"{rig.design.name}-tip-roller",
        name="Tip, roller holder",
        process="wire-cut",
        material=STAINLESS,
        body=Extrusion(rounded_polygon(corners), 10.0),
        features=(shaft_thread((0.0, TIP, 5.0), (0, -1, 0)),),
        colour="#565d66",
        notes=("roller bonded in its seat; it may not turn while an element is loaded",),
    )
