r"""Body of the vacuum holder: an octagonal plenum, whose flat walls let the port be drilled square.

+-----------------+
| O    ____     O |
|    /      \     |   plenum inside, the O-ring's groove around it,
|   |        |    |   never under the sample
|    \ ____ /     |
| O     ||      O |
+-------||--------+   port in the front wall
"""

from __future__ import annotations

from math import cos, pi, sin

from tactcad.contour import Contour, Corner, circle, rectangle, rounded_polygon
from tactcad.design.present import present
from tactcad.parts.description import Feature

from ..description import Extrusion, Hole, Part, Pocket
from ..library import orings
from ..library.screws import METRIC
from ..plate import plate
from ..screw_holes import corners
from .cart_layout import CartLayout


def holder_body(rig: CartLayout) -> Part:
    """Plenum, seal groove, port in the front wall; z = 0 is the underside."""
    t, s, h = rig.holder_body, rig.holder_side / 2, rig.holder_screw
    inner, outer = orings.groove(present(rig.o_ring))
    flat = rig.holder.vacuum_diameter / 2
    m5 = METRIC["M5"]
    features: list[Feature] = [
        Pocket("plenum", (0, 0, t), (0, 0, -1), (1, 0, 0), plenum(rig), rig.holder.plenum_depth),
        Pocket(
            "seal",
            (0, 0, t),
            (0, 0, -1),
            (1, 0, 0),
            circle((0, 0), outer),
            orings.GROOVE_DEPTH,
            (circle((0, 0), inner),),
        ),
        Hole(
            "port",
            (0, -s, t - rig.port_depth),
            (0, 1, 0),
            m5.tap_drill,
            round(s - flat, 9),
            True,
            thread="M5",
            thread_depth=min(6.0, round(s - flat, 9)),
        ),
    ]
    features += [
        Hole("screw", (px, py, t), (0, 0, -1), METRIC["M3"].clearance, t, True) for px, py in corners(h, h)
    ]
    return plate(
        rig.design,
        "holder-body",
        "Sample holder, body",
        Extrusion(rectangle(-s, -s, s, s), t),
        features,
        finish="Ra 1.6; groove floor and face around it Ra 0.8, not anodised",
        notes=("break edges 0.2, the groove's 0.1",),
    )


def plenum(rig: CartLayout) -> Contour:
    """Octagon with rounded corners, its flats across the vacuum's diameter."""
    r = rig.holder.vacuum_diameter / 2 / cos(pi / 8)
    corners = [(r * cos(pi / 8 + k * pi / 4), r * sin(pi / 8 + k * pi / 4)) for k in range(8)]
    return rounded_polygon([Corner(at, rig.plenum_corner, "wall", "corner") for at in corners])
