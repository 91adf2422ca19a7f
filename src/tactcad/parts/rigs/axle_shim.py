r"""Ring beside a bearing's inner ring, narrower than the shield: the outer ring stays free.

+---+
| o |   o: bore for the axle
+---+
"""

from __future__ import annotations

from tactcad.contour import circle

from ..description import Characteristic, Extrusion, Part
from ..part_materials import STAINLESS
from .cart_layout import CartLayout

# mm; chosen: a ring faced on both sides holds it, and it is small against the air that the shim gives
SHIM_TOLERANCE = 0.02


def axle_shim(rig: CartLayout) -> Part:
    """Ring beside an inner ring, narrower than the shield: the outer ring stays free."""
    b, t = rig.bearing, rig.cart.shim
    bore = round(b.d + 0.1, 6)
    outside = round(b.inner - 0.1, 6)
    return Part(
        part_no=f"SHIM-{bore:g}x{outside:g}x{t:g}-ring",
        name=f"Shim ring {bore:g}x{outside:g}x{t:g}",
        process="turned",
        material=STAINLESS,
        body=Extrusion(circle((0, 0), outside), t, (circle((0, 0), bore),)),
        colour="#5c6066",
        finish="faces parallel within 0.01, burr-free",
        characteristics=(Characteristic("thickness", t, t + SHIM_TOLERANCE, t - SHIM_TOLERANCE),),
        spares=2,
    )
