r"""Nest of the bonding fixture: a tongue in the element's slot, a rest under its rear body, pins beside it.

           ||        pins      ||          tongue's tip: on the leaf
 __________||__   o        o
|              |__________________         rest
|                                 |
+---------------------------------+        v up, foot v = 0; u = 0 in the tongue's middle
"""

from __future__ import annotations

from tactcad.contour import Contour, Corner, rounded_polygon

from ..description import Extrusion, Hole, Part
from ..end_plate import PRESS_FIT, pressed
from ..library.dowels import dowel_diameter
from ..limits import FACES, DatumFeature, Geometric, within
from ..part_materials import STAINLESS
from ..plate import BREAK_EDGES, PLACE, RIG_COLOUR
from .bonding_layout import BASE, ROOT, TIP, TONGUE, TONGUE_EDGE, BondingLayout, kind_suffix

TONGUE_WIDTH, TIP_OVER_REST, EDGE_RADIUS = "tongue width", "tongue's tip over the rest", "tongue's edges"


def bonding_nest(rig: BondingLayout) -> Part:
    """Nest for elements with one kind of hinge: contour in (x, height over its foot), extruded across."""
    outer = _outline(rig)
    names = {s.name for s in outer}
    tip = "tongue_tip" if "tongue_tip" in names else "tongue_back_edge"
    width = rig.tongue
    limits = [
        within(TONGUE_WIDTH, width, TONGUE, True, ("tongue_front", "tongue_back")),
        within(TIP_OVER_REST, round(rig.rest - rig.floor, 9), TIP, between=("rest", tip)),
        pressed(rig.pin_d),
    ]
    if tip == "tongue_tip":  # a full round's width defines it
        r = rig.tongue_radius
        edges = ("tongue_back_edge", "tongue_front_edge")
        limits.append(within(EDGE_RADIUS, r, TONGUE_EDGE, between=edges))
    return Part(
        part_no=f"{rig.design.name}-bonding-nest{kind_suffix(rig)}",
        name="Bonding fixture, nest",
        process="wire-cut",
        material=STAINLESS,
        body=Extrusion(outer, rig.width),
        features=tuple(
            Hole(
                "dowel_hole",
                (x, BASE, rig.width / 2 + side * rig.pin_y),
                (0, -1, 0),
                dowel_diameter(rig.design.clamp.dowel),
                BASE,
                True,
                tolerance=f"{PRESS_FIT}, the pin pressed in",
            )
            for x in rig.pin_x
            for side in (-1, 1)
        ),
        colour=RIG_COLOUR,
        finish="Ra 0.8 on tongue and rest",
        notes=(
            BREAK_EDGES + ", but not the tongue's: its ends are what the gauge is set by",
            "tongue and rest wire-cut in one contour",
            f"pins {rig.design.clamp.dowel} m6 are pressed in from above, {rig.pin_depth:g} deep",
            f"clamp: {rig.bar_force:.2g} N on {rig.pad_area:g} mm2 of gauge, {rig.bar_pressure:.2g} MPa",
        ),
        characteristics=tuple(limits),
        geometric=(Geometric("dowel holes", "position", PLACE, ("dowel_hole",), ("A", "B", "C"), True),),
        datums=(DatumFeature("A", "rest"), DatumFeature("B", FACES[0]), DatumFeature("C", "back")),
    )


def _outline(rig: BondingLayout) -> Contour:
    front, back = rig.nest_x
    half, r = rig.tongue / 2, rig.tongue_radius
    floor, top = round(BASE + rig.rest - rig.front_floor, 9), rig.nest_height
    step = (
        [Corner((rig.sill, BASE), ROOT, "step", "step_root"), Corner((rig.sill, floor), edge="floor_back")]
        if floor > BASE
        else []
    )
    return rounded_polygon(
        [
            Corner((front, 0.0), edge="foot"),
            Corner((back, 0.0), edge="back"),
            Corner((back, BASE), edge="rest"),
            *step,
            Corner((half, floor), ROOT, "tongue_back", "tongue_root"),
            Corner((half, top), r, "tongue_tip", "tongue_back_edge"),
            Corner((-half, top), r, "tongue_front", "tongue_front_edge"),
            Corner((-half, floor), ROOT, "floor_front", "tongue_root"),
            Corner((front, floor), edge="front"),
        ]
    )
