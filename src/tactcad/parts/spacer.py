r"""Spacer between neighbouring elements, over the clamped rear body only.

clamp edge +--------------------+
           |  o      O      o   |   z up, x ->
           +--------------------+
"""

from __future__ import annotations

from dataclasses import replace

from tactcad.contour import rectangle
from tactcad.design.tree import Design

from .description import Extrusion, Part
from .element import dowel_hole_limits, mounting_holes, screw_places, sheet_material
from .fasteners import SPACER_TOLERANCE, STACK
from .layout import Layout
from .limits import FACES, DatumFeature, within
from .part_materials import held_for_grinding


def thickness_by_sheet(design: Design) -> str:
    """What every spacer measures, in words."""
    return f"{design.array.pitch:g} less what the elements' sheet measures, +-{SPACER_TOLERANCE:g}"


def spacer(layout: Layout) -> Part:
    """Wire-cut sheet between neighbouring elements, over the clamped rear body only."""
    d = layout.design
    z0, z1 = layout.spacer_z
    material = sheet_material(d)
    return Part(
        part_no=f"{d.name}-spacer",
        name="Spacer",
        process="wire-cut",
        material=material,
        body=Extrusion(
            rectangle(layout.clamp_edge, z0, layout.rear_end, z1), layout.spacer, mounting_holes(layout)
        ),
        colour="#9aa4ae",
        notes=(
            f"burr-free; picked from rolled sheet that measures so, or ground {held_for_grinding(material)}",
            f"thickness as drawn where the elements' sheet measures {d.sheet.thickness:g}; else "
            f"{thickness_by_sheet(d)}; the whole stack {layout.stack:g} +-{STACK:g}",
        ),
        characteristics=(
            replace(
                within("thickness", layout.spacer, SPACER_TOLERANCE, between=FACES),
                remark=thickness_by_sheet(d),
            ),
            dowel_hole_limits(d),
        ),
        geometric=(screw_places("A"),),
        datums=(DatumFeature("A", "dowel_hole"),),
    )
