r"""Post of the stand: two columns of M4 threads, four threads for the base plate's screws from below.

+-------+
| o   o |
| o   o |   rows ROW_PITCH apart
| o   o |   ^ z
|       |   |
+-------+   +-> x
"""

from __future__ import annotations

from tactcad.contour import rectangle

from ..description import Extrusion, Feature, Part
from ..library.screws import METRIC
from ..plate import plate
from ..screw_holes import corners, tapped, tapped_blind
from .frame import BASE, POST, STAGE_HOLE
from .stand_layout import StandLayout

POST_SCREWS = corners(20.0, 5.0)  # from the post's middle
BASE_SCREW = 16.0  # M5 through the base plate into the post, head sunk
BASE_THREAD = BASE_SCREW - (BASE[1] - METRIC["M5"].head_height) + 1.0  # its end free at any limits


def post(rig: StandLayout) -> Part:
    """Post: contour in (x, z) of the scene, front face at local z = 0, two columns of M4 threads."""
    w, t = POST
    features: list[Feature] = [
        tapped("row", "M4", (sx * STAGE_HOLE, z, 0.0), (0, 0, 1), t) for z in rig.post_rows for sx in (-1, 1)
    ]
    # the base plate's screws reach 9 mm in, more than the usual blind thread has
    features += [
        tapped_blind("base", "M5", (px, 0.0, t / 2 + py), (0, 1, 0), BASE_THREAD) for px, py in POST_SCREWS
    ]
    return plate(
        rig.design,
        "post",
        "Post",
        Extrusion(rectangle(-w / 2, 0, w / 2, rig.post_height), t),
        features,
        colour="#6f7a86",
        finish="Ra 1.6, front face square to the foot within 0.02/100",
        notes=("break edges 0.5",),
    )
