r"""Stop plate on the ledges: the plane that every overload stop closes against.

+-----------------------------------+   ^ z
+-----------------------------------+   +-> x   both faces ground
"""

from __future__ import annotations

from tactcad.contour import rectangle

from .description import Extrusion, Part
from .layout import Layout
from .limits import FACES, DatumFeature, Geometric, within
from .part_materials import MAGNETIC_STAINLESS, held_for_grinding

STOP_PLATE_FLAT = 0.005  # mm; chosen: what surface grinding holds, a quarter of the usual gap's tolerances


def stop_plate(layout: Layout) -> Part:
    """Ground plate on the ledges: the plane that every overload stop closes against."""
    d = layout.design
    x, y = layout.stop_plate_half, layout.stop_plate_width / 2
    return Part(
        part_no=f"{d.name}-stop-plate",
        name="Stop plate",
        process="ground",
        material=MAGNETIC_STAINLESS,
        body=Extrusion(rectangle(-x, -y, x, y), d.clamp.stop_plate_thickness),
        colour="#565d66",
        finish="both faces ground, Ra 0.4",
        notes=(
            "break edges 0.2",
            "either face may lie on the ledges",
            f"ground {held_for_grinding(MAGNETIC_STAINLESS)}",
        ),
        characteristics=(within("thickness", d.clamp.stop_plate_thickness, 0.05, between=FACES),),
        geometric=(
            Geometric("flatness", "flatness", STOP_PLATE_FLAT, FACES),
            Geometric("parallelism", "parallelism", STOP_PLATE_FLAT, (FACES[1],), ("A",)),
        ),
        datums=(DatumFeature("A", FACES[0]),),
    )
