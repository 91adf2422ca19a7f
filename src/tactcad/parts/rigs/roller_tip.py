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
from ..library.dowels import dowel_diameter, dowel_limits
from ..limits import within
from ..part_materials import STAINLESS
from .flat_tip import shaft_thread
from .frame import TIP
from .stand_layout import StandLayout


def roller_tip(rig: StandLayout) -> Part:
    """Tip for the pads: a nose with a half-round seat for the roller, which stands out by its radius.

    Contour in (x, z), z = 0 the roller's lowest line, extruded along y by 10.
    """
    r, seat = seat_radius(present(rig.design.calibration).roller), "seat"
    top = dowel_diameter(present(rig.design.calibration).roller)
    low = top - r  # of the nose: the seat is half round
    nose, half = r + 1.0, 6.0
    corners = [
        Corner((-nose, low)),
        Corner((-r, low)),
        Corner((-r, top), r, fillet=seat),
        Corner((r, top), r, fillet=seat),
        Corner((r, low)),
        Corner((nose, low)),
        Corner((half, low + half - nose)),
        Corner((half, TIP)),
        Corner((-half, TIP)),
        Corner((-half, low + half - nose)),
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
        characteristics=(within(SEAT_RADIUS, r, SEAT, between=(seat,)),),
    )


SEAT_RADIUS = "seat radius"
SEAT = 0.005  # mm, plus and minus; chosen: two to three passes of the wire
# Radial, mm: what a pin's feel tells from none; more would let the roller lie beside the seat's middle.
LEAST_AROUND_ROLLER = 0.001


def seat_radius(size: str) -> float:
    """Of the roller's seat, mm: at its least it still takes the largest m6 pin of that size."""
    return round(dowel_limits(size)[1] / 2 + LEAST_AROUND_ROLLER + SEAT, 6)
