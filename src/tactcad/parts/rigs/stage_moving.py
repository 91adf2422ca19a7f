r"""Moving half of a micro-stage, bought: slideway down, threads up.

o-----------o    z = thickness: four M4 threads at its corners
|           |
o-----------o    z = 0: slideway
"""

from __future__ import annotations

from tactcad.contour import rectangle

from ..description import Extrusion, Part, Purchase
from ..library.stages import Stage
from ..part_materials import ALUMINIUM
from ..screw_holes import corners, tapped


def stage_moving(stage: Stage) -> Part:
    """Moving half: slideway at z = 0, threads from the face at the top."""
    half, t = stage.size / 2, stage.plate
    threads = tuple(
        tapped("mount", "M4", (px, py, t), (0, 0, -1), t) for px, py in corners(stage.hole, stage.hole)
    )
    return Part(
        part_no=f"STAGE-{stage.size:g}-{2 * stage.travel:g}-MOVING",
        name=f"Micro-stage {stage.size:g} x {stage.size:g}, moving half",
        process="included",
        material=ALUMINIUM,
        body=Extrusion(rectangle(-half, -half, half, half), t),
        features=threads,
        colour="#59626e",
        purchase=Purchase("moving half, comes with the fixed half", alternates="as the fixed half"),
    )
