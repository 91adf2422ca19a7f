r"""Stop plate on the ledges: the plane that every overload stop closes against.

+-----------------------------------+   ^ z
+-----------------------------------+   +-> x   both faces ground
"""

from __future__ import annotations

from tactcad.contour import rectangle

from .description import Characteristic, Extrusion, Part
from .layout import Layout
from .part_materials import MAGNETIC_STAINLESS


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
        finish="both faces ground, Ra 0.4, flat and parallel within 0.005",
        notes=("break edges 0.2", "either face may lie on the ledges"),
        characteristics=(
            Characteristic(
                "thickness",
                d.clamp.stop_plate_thickness,
                d.clamp.stop_plate_thickness + 0.05,
                d.clamp.stop_plate_thickness - 0.05,
            ),
        ),
    )
