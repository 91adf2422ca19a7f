r"""Fixed half of a micro-stage, bought: its screws enter from the slideway's side.

O-----------O    z = thickness: slideway
|           |
|           |    four counterbored holes at its corners
O-----------O    z = 0: back
"""

from __future__ import annotations

from tactcad.contour import rectangle

from ..description import Extrusion, Part, Purchase
from ..library.stages import Stage
from ..part_materials import ALUMINIUM
from ..screw_holes import corners, sunk
from .frame import PLATE_SCREW


def stage_fixed(stage: Stage) -> Part:
    """Fixed half of a micro-stage: back at z = 0, slideway at the top; screws enter from the slideway's
    side."""
    half, t = stage.size / 2, stage.plate
    thread, _, under = PLATE_SCREW
    holes = tuple(
        sunk("mount", thread, (px, py, t), (0, 0, -1), t, under) for px, py in corners(stage.hole, stage.hole)
    )
    return Part(
        part_no=f"STAGE-{stage.size:g}-{2 * stage.travel:g}-FIXED",
        name=f"Micro-stage {stage.size:g} x {stage.size:g}, fixed half",
        process="bought",
        material=ALUMINIUM,
        body=Extrusion(rectangle(-half, -half, half, half), t),
        features=holes,
        colour="#3f4650",
        purchase=Purchase(
            f"crossed roller stage {stage.size:g} x {stage.size:g} x {stage.height:g} mm, "
            f"travel +-{stage.travel:g} mm, M4 at {2 * stage.hole:g} x {2 * stage.hole:g}",
            manufacturer=stage.maker,
            mpn=stage.part_no,
            alternates="any stage of that travel and hole pattern",
            source_verified=stage.verified,
        ),
    )
