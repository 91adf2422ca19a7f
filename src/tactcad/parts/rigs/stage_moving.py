r"""Moving half of a micro-stage, bought: slideway down, threads up.

o-----------o    z = thickness: four M4 threads at +-STAGE_HOLE
|           |
o-----------o    z = 0: slideway
"""

from __future__ import annotations

from tactcad.contour import rectangle

from ..description import Extrusion, Part, Purchase
from ..part_materials import ALUMINIUM
from ..screw_holes import corners, tapped
from .frame import STAGE, STAGE_HOLE, STAGE_PLATE


def stage_moving(travel: float) -> Part:
    """Moving half: slideway at z = 0, threads from the face at the top."""
    half, t = STAGE / 2, STAGE_PLATE
    threads = tuple(
        tapped("mount", "M4", (px, py, t), (0, 0, -1), t) for px, py in corners(STAGE_HOLE, STAGE_HOLE)
    )
    return Part(
        part_no=f"STAGE-{STAGE:g}-{2 * travel:g}-MOVING",
        name=f"Micro-stage {STAGE:g} x {STAGE:g}, moving half",
        process="bought",
        material=ALUMINIUM,
        body=Extrusion(rectangle(-half, -half, half, half), t),
        features=threads,
        colour="#59626e",
        purchase=Purchase("moving half, comes with the fixed half", alternates="as the fixed half"),
    )
