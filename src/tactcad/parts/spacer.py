r"""Spacer between neighbouring elements, over the clamped rear body only.

clamp edge +--------------------+
           |  o      O      o   |   z up, x ->
           +--------------------+
"""

from __future__ import annotations

from tactcad.contour import rectangle

from .description import Extrusion, Part
from .element import dowel_hole_limits, mounting_holes, screw_places, sheet_material
from .fasteners import SPACER_TOLERANCE, STACK
from .layout import Layout
from .limits import FACES, DatumFeature, within


def spacer(layout: Layout) -> Part:
    """Wire-cut sheet between neighbouring elements, over the clamped rear body only."""
    d = layout.design
    z0, z1 = layout.spacer_z
    return Part(
        part_no=f"{d.name}-spacer",
        name="Spacer",
        process="wire-cut",
        material=sheet_material(d),
        body=Extrusion(
            rectangle(layout.clamp_edge, z0, layout.rear_end, z1), layout.spacer, mounting_holes(layout)
        ),
        colour="#9aa4ae",
        notes=(
            "burr-free, flat faces as rolled",
            f"thickness as drawn where the elements' sheet measures {d.sheet.thickness:g}; else, to the same "
            f"limits, {d.array.pitch:g} less what it measures; the whole stack {layout.stack:g} +-{STACK:g}",
        ),
        characteristics=(
            within("thickness", layout.spacer, SPACER_TOLERANCE, between=FACES),
            dowel_hole_limits(d),
        ),
        geometric=(screw_places("A"),),
        datums=(DatumFeature("A", "dowel_hole"),),
    )
