r"""Fixed half of a micro-stage, bought: its screws enter from the slideway's side.

O-----------O    z = thickness: slideway
|           |
|           |    four counterbored holes at +-STAGE_HOLE
O-----------O    z = 0: back
"""

from __future__ import annotations

from tactcad.contour import rectangle

from ..description import Extrusion, Part, Purchase
from ..part_materials import ALUMINIUM
from ..screw_holes import corners, sunk
from .frame import PLATE_SCREW, STAGE, STAGE_HOLE, STAGE_PLATE


def stage_fixed(travel: float) -> Part:
    """Fixed half of a micro-stage: back at z = 0, slideway at the top; screws enter from the slideway's
    side."""
    half, t = STAGE / 2, STAGE_PLATE
    thread, _, under = PLATE_SCREW
    holes = tuple(
        sunk("mount", thread, (px, py, t), (0, 0, -1), t, under) for px, py in corners(STAGE_HOLE, STAGE_HOLE)
    )
    return Part(
        part_no=f"STAGE-{STAGE:g}-{2 * travel:g}-FIXED",
        name=f"Micro-stage {STAGE:g} x {STAGE:g}, fixed half",
        process="bought",
        material=ALUMINIUM,
        body=Extrusion(rectangle(-half, -half, half, half), t),
        features=holes,
        colour="#3f4650",
        purchase=Purchase(
            f"crossed roller stage {STAGE:g} x {STAGE:g} x {2 * t:g} mm, travel +-{travel:g} mm, M4 at "
            f"{2 * STAGE_HOLE:g} x {2 * STAGE_HOLE:g}",
            alternates="any stage of that travel and hole pattern",
        ),
    )
