r"""Blank: an element without arm. It fills the shorter row, and stands in for the missing one, so that both
rows are clamped alike and the stop plate has two ledges to sit on.

                +-------------------------+
        ledge   |  o        O        o    |
      __________|                         |   z up, x ->
     |__________________           _______|
                        \_________|  wire recess
"""

from __future__ import annotations

from tactcad.contour import Corner, rounded_polygon
from tactcad.design.tree import Design

from .description import Extrusion, Part
from .element import dowel_hole_limits, mounting_holes, rear_corners, screw_places, sheet_material
from .layout import Layout
from .limits import FACES, DatumFeature, Geometric, within


def blank_ledge_zone(design: Design) -> float:
    """Width of the zone of a blank's ledge, mm: the elements' ledges lie in one as wide."""
    return round(2 * (design.tolerance.pad_height + design.tolerance.ledge), 9)


def blank(layout: Layout) -> Part:
    """An element without arm: fills the shorter row, and stands in for the missing one, so that both
    rows are clamped alike and the stop plate has two ledges to sit on."""
    d = layout.design
    hinge = layout.elements[0].hinge
    face, ledge = layout.body_bottom(hinge), layout.ledge
    front = round(layout.clamp_edge - d.element.seat_length, 6)
    corners = [
        Corner((front, face), edge="front_face"),
        *rear_corners(layout, face),
        Corner((layout.clamp_edge, ledge), d.element.corner_radius, "ledge", "ledge_root"),
        Corner((front, ledge), edge="front_end"),
    ]
    return Part(
        part_no=f"{d.name}-blank",
        name="Blank, an element without arm",
        process="wire-cut",
        material=sheet_material(d),
        body=Extrusion(rounded_polygon(corners), d.sheet.thickness, mounting_holes(layout)),
        colour="#aab2ba",
        notes=("burr-free, do not tumble",),
        characteristics=(
            within("thickness", d.sheet.thickness, d.tolerance.sheet_thickness, between=FACES),
            dowel_hole_limits(d),
        ),
        # as far from the dowel hole as any element's ledge: pad height and ledge over the pad
        geometric=(
            Geometric("ledge", "position", blank_ledge_zone(d), ("ledge",), ("A",)),
            screw_places("A"),
        ),
        datums=(DatumFeature("A", "dowel_hole"),),
    )
