r"""Lid of the vacuum holder under the sample: suction holes in hexagonal rings.

+-----------+
| O       O |
|    . .    |   . suction holes
|   . . .   |
|    . .    |
| O       O |   O screws through body into the cart, sunk
+-----------+
"""

from __future__ import annotations

from tactcad.contour import rectangle
from tactcad.design.present import present

from ..description import Extrusion, Hole, Part
from ..limits import FACES, Geometric
from ..plate import plate
from ..screw_holes import corners, sunk
from .cart_layout import CartLayout


def holder_lid(rig: CartLayout) -> Part:
    """Plate under the sample with the suction holes; z = 0 is the underside."""
    t, s, h = rig.holder.lid_thickness, rig.holder_side / 2, rig.holder_screw
    holes = [
        Hole("suction", (x, y, t), (0, 0, -1), rig.holder.hole_diameter, t, True)
        for x, y in rig.suction_holes
    ]
    under = present(rig.holder_fixing)[1]
    screws = [sunk("screw", "M3", (px, py, t), (0, 0, -1), t, under) for px, py in corners(h, h)]
    return plate(
        rig.design,
        "holder-lid",
        "Sample holder, lid",
        Extrusion(rectangle(-s, -s, s, s), t),
        holes + screws,
        colour="#aab2ba",
        finish="Ra 0.8 both faces",
        notes=("suction holes burr-free, not countersunk: rubber would be drawn in",),
        geometric=(Geometric("flatness", "flatness", 0.02, FACES),),
    )
