r"""The sensing element: one wire-cut side view, extruded by the sheet's thickness.

stop land                                      +-------------------------+ rear_height
  ___                          ledge           |  o        O        o    |
 /   \_____arm_____   ______________           |                         |
|                  | |              |__________|                         |
|__    ____________|_|______________     flat face                       |
   |  |            hinge t                        \______ wire recess ___|
   +--+ pad                                     x ->
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from tactcad.contour import Contour, Corner, circle, rounded_polygon
from tactcad.design.materials import ALLOYS, family
from tactcad.design.tree import Design

from .description import Extrusion, Material, Part
from .layout import ElementPlace, HingeShape, Layout
from .limits import FACES, Characteristic, DatumFeature, Geometric, within
from .plate import PLACE
from .spares import spare_elements
from .wire_passes import least_passes

BARE_METAL = "#c3c8ce"


def element(layout: Layout, place: ElementPlace, gap: float | None = None) -> Part:
    """The element that stands at a place; equal elements give equal parts with one part number.

    Parameters
    ----------
    layout, place
        The array, and the element in it.
    gap
        Stop gap at the arm's tip, mm; by default the design's.
    """
    design = layout.design
    unrated: tuple[str, ...] = ()
    if gap is None:
        from .stop_gap import stop_gap, unrated_gap  # loads numpy: not needed where the gap is known

        gap, unrated = stop_gap(layout, place), unrated_gap(layout, place)
    passes = least_passes(design.tolerance.hinge_thickness)
    outer = outline(layout, place.arm, place.hinge, gap)
    number = element_number(design, place)
    return Part(
        part_no=number,
        name=f"Sensing element, arm {shortest(place.arm)}",
        process="wire-cut",
        material=sheet_material(design),
        body=Extrusion(outer, design.sheet.thickness, mounting_holes(layout)),
        colour=BARE_METAL,
        finish="Ra 0.8 on hinge faces",
        notes=(
            f"wire-cut in at least {passes}, both hinge faces skimmed",
            "burr-free, do not tumble",
            "measure and record the hinge thickness of every element",
            *material_notes(design),
            *unrated,
        ),
        characteristics=_limits(layout, place, gap, {s.name for s in outer}),
        geometric=(screw_places("A", "B"),),
        datums=(DatumFeature("A", "flat_face"), DatumFeature("B", "dowel_hole")),
        spares=spare_elements(sum(element_number(design, p) == number for p in layout.elements)),
        kind="element",
    )


def screw_places(*datums: str) -> Geometric:
    """Zone of the clamping screws' holes in what is stacked: cut in one contour with the dowel holes."""
    return Geometric("screw holes", "position", PLACE, ("screw_hole",), datums, True)


# The load arm is the arm less half the pad: its tolerance is shared so that the two give just that.
ARM_SHARE, PAD_SHARE = 0.8, 0.4
PAD_HEIGHT = "pad height over the dowel hole's centre"
LEDGE = "ledge over the pad face"
DOWEL_HOLE = "dowel hole diameter"


def _limits(
    layout: Layout, place: ElementPlace, gap: float, edges: Collection[str]
) -> tuple[Characteristic, ...]:
    """Every limit of an element whose outline has these edges (a full round has used some up); mm."""
    d, cut, e, t = layout.design, layout.design.element, place.hinge, layout.design.tolerance
    over = cut.pad_height
    floor = ("slot_floor", "flat_face" if cut.sides == "one" else "hinge_face")
    walls = ("slot_arm_wall", "slot_body_wall")
    fillets = ("slot_arm_fillet", "slot_body_fillet")
    stated: tuple[Characteristic, ...] = (
        within("hinge thickness", e.t, t.hinge_thickness, True, floor),
        within(PAD_HEIGHT, d.holes.height + over, t.pad_height, True, ("pad_face", "dowel_hole")),
        within("stop gap", gap, d.stop.tolerance, True, ("stop_land", "ledge")),
        within(LEDGE, round(layout.ledge + over, 9), t.ledge, True, ("pad_face", "ledge")),
        within("slot length", e.l, t.hinge_length, between=walls),
        within("arm length", place.arm, round(ARM_SHARE * t.load_arm, 9), between=("tip", *walls)),
        within("pad length", cut.pad_length, round(PAD_SHARE * t.load_arm, 9), between=("tip", "pad_side")),
        within("arm height", e.h, t.arm_height, between=("flat_face", "arm_back")),
        within("fillet radius", e.r, t.fillet_radius, between=fillets),
        within("tip from dowel hole", _tip_to_dowel(layout), t.tip, between=("tip", "dowel_hole")),
        within("sheet thickness", d.sheet.thickness, t.sheet_thickness, between=FACES),
        dowel_hole_limits(d),
    )
    if "slot_floor" not in edges:  # a full round's width defines it
        stated = tuple(c for c in stated if c.name != "fillet radius")
    return tuple(replace(c, between=tuple(_standing(f, edges) for f in c.between)) for c in stated)


# A fillet that has used up its edge touches where the edge was.
USED_UP = {
    "slot_floor": ("slot_body_fillet", "slot_arm_fillet"),
    "hinge_face": ("front_slot_arm_fillet",),
    "slot_arm_wall": ("slot_arm_fillet", "slot_body_fillet"),
    "slot_body_wall": ("slot_body_fillet",),
    "pad_side": ("pad_root",),
    "arm_back": ("land_root",),
    "ledge": ("ledge_root",),
}


def _standing(feature: str, edges: Collection[str]) -> str:
    """The feature, or what stands for it where the outline has lost it."""
    return next((f for f in (feature, *USED_UP.get(feature, ())) if f in edges), feature)


def dowel_hole_limits(design: Design) -> Characteristic:
    """Slide-fit dowel hole of elements, blanks and spacers, mm."""
    h = design.holes
    low, high = h.dowel_hole, round(h.dowel_hole + h.dowel_hole_upper, 9)
    return Characteristic(DOWEL_HOLE, low, high, low, between=("dowel_hole",))


def _tip_to_dowel(layout: Layout) -> float:
    """mm, to the dowel hole next to the clamp edge."""
    return round(min(layout.dowel_x) - layout.pad_inner, 9)


def element_number(design: Design, place: ElementPlace) -> str:
    """Part number from the arm length, and from what an override changes; never from list order.

    It ends in a letter: FreeCAD makes the names of equal parts unique by counting up their last digits.
    """
    base = design.element
    usual = HingeShape(base.hinge_thickness, base.hinge_length, base.fillet_radius, base.arm_height)
    number = f"{design.name}-element-a{shortest(place.arm)}mm"
    for letter in ("t", "l", "r", "h"):
        value = getattr(place.hinge, letter)
        if value != getattr(usual, letter):
            number += f"-{letter}{shortest(value)}mm"
    return number


def outline(layout: Layout, arm: float, hinge: HingeShape, gap: float) -> Contour:
    """The element's contour in (x, z), counter-clockwise from the pad, mm.

    Parameters
    ----------
    layout
        The array.
    arm
        Arm length from the hinge's centre to the tip, mm.
    hinge
        Its dimensions.
    gap
        Stop gap at the arm's tip, mm.
    """
    e = layout.design.element
    x_tip, x_pad = layout.pad_inner, layout.pad_outer
    x_hinge = x_tip + arm
    x_arm, x_body = x_hinge - hinge.l / 2, x_hinge + hinge.l / 2
    ledge = layout.ledge_of(hinge)
    land = ledge - gap
    x_land = x_tip + layout.design.stop.land_length
    floor = hinge.t if e.sides == "one" else (hinge.h + hinge.t) / 2
    corners = [
        Corner((x_tip, -e.pad_height), edge="pad_face"),
        Corner((x_pad, -e.pad_height), edge="pad_side"),
        Corner((x_pad, 0.0), e.pad_root_radius, "flat_face", "pad_root"),
    ]
    if e.sides == "two":
        front = (hinge.h - hinge.t) / 2
        corners += [
            Corner((x_arm, 0.0), edge="front_slot_arm_wall"),
            Corner((x_arm, front), hinge.r, "hinge_face", "front_slot_arm_fillet"),
            Corner((x_body, front), hinge.r, "front_slot_body_wall", "front_slot_body_fillet"),
            Corner((x_body, layout.body_bottom(hinge)), edge="body_face"),
        ]
    corners += [
        *rear_corners(layout, layout.body_bottom(hinge)),
        Corner((layout.clamp_edge, ledge), e.corner_radius, "ledge", "ledge_root"),
        Corner((x_body, ledge), edge="slot_body_wall"),
        Corner((x_body, floor), hinge.r, "slot_floor", "slot_body_fillet"),
        Corner((x_arm, floor), hinge.r, "slot_arm_wall", "slot_arm_fillet"),
        Corner((x_arm, hinge.h), edge="arm_back"),
        # a ramp of 45 degrees: a square step would be lower than the wire's corner radius
        Corner((x_land + land - hinge.h, hinge.h), e.corner_radius, "land_ramp", "land_root"),
        Corner((x_land, land), edge="stop_land"),
        Corner((x_tip, land), edge="tip"),
    ]
    return rounded_polygon(corners)


def rear_corners(layout: Layout, face: float) -> list[Corner]:
    """Corners of the clamped rear body, from the wire recess round to the clamp edge; the same in elements
    and blanks.

    `face` is z of the front body's lower face, where the recess begins.
    """
    e = layout.design.element
    return [
        Corner((layout.recess_start, face), edge="recess_wall"),
        Corner((layout.recess_start, e.recess_depth), e.corner_radius, "recess_face", "recess_root"),
        Corner((layout.rear_end, e.recess_depth), edge="rear_end"),
        Corner((layout.rear_end, e.rear_height), edge="rear_top"),
        Corner((layout.clamp_edge, e.rear_height), edge="clamp_edge"),
    ]


def mounting_holes(layout: Layout) -> tuple[Contour, ...]:
    """Screw and dowel holes through elements, blanks and spacers, wire-cut; dowel holes at mid-tolerance."""
    from .library.screws import METRIC

    design = layout.design
    z = design.holes.height
    dowel = dowel_hole_diameter(design)
    screws = [circle((x, z), METRIC[design.clamp.screw].clearance, "screw_hole") for x in layout.screw_x]
    dowels = [circle((x, z), dowel, "dowel_hole") for x in layout.dowel_x]
    return tuple(sorted(screws + dowels, key=lambda c: c.box[0]))


def dowel_hole_diameter(design: Design) -> float:
    """Slide-fit dowel hole as cut and modelled, mm: the middle of its limits."""
    return round(design.holes.dowel_hole + design.holes.dowel_hole_upper / 2, 6)


def sheet_material(design: Design) -> Material:
    known = ALLOYS.get(design.material.alloy)
    return Material(
        design.material.alloy,
        design.material.density,
        standard=known.standard if known else "",
        magnetic=design.material.magnetic or "",
    )


def material_notes(design: Design) -> tuple[str, ...]:
    """Notes that the material requires: from its data, and on values in which the design differs from
    them.
    """
    bare = ("bare sheet, not clad",) if family(design.material.density) == "aluminium" else ()
    magnetic = ("demagnetise after cutting",) if design.material.magnetic == "yes" else ()
    # fatigue: sheet is stronger along its grain than across, and the hinge bends along the arm
    rolled = "rolling direction along the arm, across the hinge"
    return (
        *bare,
        rolled,
        *magnetic,
        *(f"designed with other data than its material's: {d}" for d in design.differences),
    )


def shortest(value: float) -> str:
    """A length as in part numbers: 4.0 is "4", 4.25 is "4.25"; equal text means equal value."""
    text = repr(float(value))
    return text.removesuffix(".0")
