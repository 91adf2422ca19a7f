r"""Plate of the wheeled cart: the axles' threads in its sides, the holder's in its face.

  +-o---------o-+   axles: cap screws into the sides
  |  o       o  |   ^ y
  |             |   |     holder's four M3 threads
  |  o       o  |   +-> x
  +-o---------o-+

The inner rings are clamped between shims, the outer rings stand a shim free of plate and head: nothing can
bind. The shanks' play in the bores (up to 0.14 mm) lets all four wheels be set on a flat plate before
the axles are tightened.
"""

from __future__ import annotations

from tactcad.contour import rectangle
from tactcad.design.present import present

from ..description import Extrusion, Hole, Part
from ..library.screws import METRIC
from ..limits import FACES, within
from ..plate import plate
from ..screw_holes import corners, tapped
from .cart_layout import CartLayout


def cart_plate(rig: CartLayout) -> Part:
    """Plate with the axles' threads in its sides and the holder's in its face; z = 0 is the underside."""
    c, t = rig.cart, rig.cart.thickness
    m = METRIC[rig.axle_thread]
    x, y = c.length / 2, c.width / 2
    entry = round(rig.axle_in_plate - 2 * m.d, 9)  # the last 2 d of the axle are engaged
    axles = tuple(
        Hole(
            "axle",
            (sx * c.wheel_base / 2, sy * y, rig.axle_z - c.clearance),
            (0, -sy, 0),
            m.tap_drill,
            round(rig.axle_in_plate + 1.0 + 2 * m.pitch, 9),
            False,
            counterbore=(m.clearance, entry),
            thread=rig.axle_thread,
            thread_depth=2 * m.d + 1.0,
            drill_point=True,
        )
        for sx in (-1.0, 1.0)
        for sy in (-1.0, 1.0)
    )
    h, (length, under) = rig.holder_screw, present(rig.holder_fixing)
    engaged = length - under - rig.holder_body
    holder = tuple(tapped("holder", "M3", (px, py, t), (0, 0, -1), t, engaged) for px, py in corners(h, h))
    return plate(
        rig.design,
        "cart-plate",
        "Cart plate",
        Extrusion(rectangle(-x, -y, x, y), t),
        axles + holder,
        notes=("break edges 0.2", "axle threads of one side in one setting"),
        characteristics=(within(AXLES_OVER, rig.axle_z - c.clearance, AXLES, between=(FACES[0], "axle")),),
    )


# mm, plus and minus; chosen: as the end plates' dowel holes. What four of them are off a plane, the
# shanks' play in the bores nearly always takes up (requirement "wheels touch").
AXLES = 0.015
AXLES_OVER = "axles over the underside"
