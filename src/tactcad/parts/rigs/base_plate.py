r"""Base plate of the stand: the cart or the stages on it, the post behind.

+---------------------------+
|          O O              |   the post's four screws, from below
|          O O              |   ^ y
|       o       o           |   |
|                           |   +-> x
|       o       o           |   the stages' four threads
+---------------------------+
"""

from __future__ import annotations

from tactcad.contour import rectangle

from ..description import Extrusion, Feature, Part
from ..library.screws import METRIC
from ..limits import FACES, Geometric
from ..plate import plate
from ..screw_holes import corners, sunk, tapped_blind
from .cart_layout import LOOSE_WHEEL
from .frame import BASE, POST, POST_Y
from .post import POST_SCREWS
from .stand_layout import StandLayout


def base_plate(rig: StandLayout) -> Part:
    """Base plate under the post, one for all set-ups: with the threads of the horizontal stages where the
    design has a calibration. The cart's wheels roll beside them or keep most of their width on the plate."""
    t, x = BASE[1], rig.base_length / 2
    middle = POST_Y + POST[1] / 2
    m5 = METRIC["M5"]
    features: list[Feature] = [
        sunk("post", "M5", (px, middle + py, 0.0), (0, 0, 1), t, t - m5.head_height) for px, py in POST_SCREWS
    ]
    if rig.design.calibration is not None:
        features += [
            tapped_blind("stage", "M4", (px, py, t), (0, 0, -1))
            for px, py in corners(rig.stage.hole, rig.stage.hole)
        ]
    return plate(
        rig.design,
        "base",
        "Base plate",
        Extrusion(rectangle(-x, rig.base_front, x, rig.base_back), t),
        features,
        colour="#6f7a86",
        finish="upper face ground or fly-cut, Ra 0.8",
        notes=("break edges 0.5", "threads countersunk 0.3, no burr: wheels roll over this face"),
        geometric=(Geometric("flatness", "flatness", LOOSE_WHEEL, (FACES[1],)),),
    )
