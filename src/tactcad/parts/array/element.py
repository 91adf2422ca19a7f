"""The stacked sheet parts: sensing element, blank for an empty place, and spacer; and the element with its
pad pushed.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from math import asin, atan2, hypot, inf, pi, sqrt, tan

from tactcad.contour import Contour, Corner, Line, Point, Segment, circle, rectangle, rounded_polygon
from tactcad.contour.segment import turned
from tactcad.design.materials import ALLOYS, family
from tactcad.design.messages import InputError
from tactcad.design.tree import CommonTables, Design

from ..bought.electronic_parts import spare_elements
from ..language.description import Extrusion, Material, Part
from ..language.limits import FACES, Characteristic, DatumFeature, Geometric, within
from ..language.stock import PLACE, held_for_grinding
from .clamp import SPACER_TOLERANCE, STACK
from .layout import ElementPlace, HingeShape, Layout

BARE_METAL = "#c3c8ce"


def element(layout: Layout, place: ElementPlace, gap: float | None = None) -> Part:
    r"""The element at a place; equal elements give equal parts with one part number.

    stop land                                      +-------------------------+ rear_height
      ___                          ledge           |  o        O        o    |
     /   \_____arm_____   ______________           |                         |
    |                  | |              |__________|                         |
    |__    ____________|_|______________     flat face                       |
       |  |            hinge t                        \______ wire recess ___|
       +--+ pad                                     x ->

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
        from .stop_gap import stop_gap, unrated_gap

        gap, unrated = stop_gap(layout, place), unrated_gap(layout, place)
    passes = least_passes(design.tolerance.hinge_thickness)
    outer = outline(layout, place.arm, place.hinge, gap)
    number = element_number(design, place)
    edges = {s.name for s in outer}
    pad, ledge = (_standing(f, edges) for f in ("pad_face", "ledge"))
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
        characteristics=_limits(layout, place, gap, edges),
        geometric=(screw_places("B", "A"), Geometric(SEAT_LEAN, "parallelism", LEAN, (pad, ledge), ("A",))),
        datums=(DatumFeature("A", "flat_face"), DatumFeature("B", "dowel_hole")),
        spares=spare_elements(sum(element_number(design, p) == number for p in layout.elements)),
        kind="element",
    )


def screw_places(*datums: str) -> Geometric:
    """Zone of the clamping screws' holes in stacked parts: cut in one contour with the dowel holes."""
    return Geometric("screw holes", "position", PLACE, ("screw_hole",), datums, True)


LEAN = 0.005  # mm, of pad and ledge against the flat face; chosen: one contour, four passes of the wire
# The load arm is the arm less half the pad: its tolerance is shared so that the two give just that.
ARM_SHARE, PAD_SHARE = 0.8, 0.4
PAD_HEIGHT = "pad height over the dowel hole's centre"
LEDGE = "ledge over the pad face"
DOWEL_HOLE, SEAT_LEAN = "dowel hole diameter", "pad's and ledge's lean"
STOP_GAP, SLOT, ARM_LENGTH, PAD_LENGTH = "stop gap", "slot length", "arm length", "pad length"
TIP_PLACE, HINGE_THICKNESS = "tip from dowel hole", "hinge thickness"
ARM_HEIGHT, FILLET = "arm height", "fillet radius"
# Growth of each size by the wire's offset, mm a mm: one offset moves all faces of a piece outward. Between
# faces of equal direction nothing changes.
WIRE: dict[str, int] = {
    HINGE_THICKNESS: 2,
    PAD_HEIGHT: 1,
    LEDGE: 2,
    SLOT: -2,
    ARM_LENGTH: 1,
    PAD_LENGTH: 2,
    ARM_HEIGHT: 2,
    FILLET: -1,
    TIP_PLACE: 1,
    DOWEL_HOLE: -2,
}


def _limits(
    layout: Layout, place: ElementPlace, gap: float, edges: Collection[str]
) -> tuple[Characteristic, ...]:
    """Every limit of an element whose outline has these edges (a full round has used some up); mm."""
    d, cut, e, t = layout.design, layout.design.element, place.hinge, layout.design.tolerance
    over = cut.pad_height
    floor = ("slot_floor", "flat_face" if cut.sides == "one" else "hinge_face")
    walls = ("slot_arm_wall", "slot_body_wall")
    fillets = ("slot_arm_fillet", "slot_body_fillet")
    # mm, to the dowel hole next to the clamp edge.
    stated: tuple[Characteristic, ...] = (
        within(HINGE_THICKNESS, e.t, t.hinge_thickness, True, floor),
        within(PAD_HEIGHT, d.holes.height + over, t.pad_height, True, ("pad_face", "dowel_hole")),
        within(STOP_GAP, gap, d.stop.tolerance, True, ("stop_land", "ledge")),
        within(LEDGE, round(layout.ledge + over, 9), t.ledge, True, ("pad_face", "ledge")),
        within(SLOT, e.l, t.hinge_length, between=walls),
        within(ARM_LENGTH, place.arm, round(ARM_SHARE * t.load_arm, 9), between=("tip", *walls)),
        within(PAD_LENGTH, cut.pad_length, round(PAD_SHARE * t.load_arm, 9), between=("tip", "pad_side")),
        within(ARM_HEIGHT, e.h, t.arm_height, between=("flat_face", "arm_back")),
        within(FILLET, e.r, t.fillet_radius, between=fillets),
        within(
            TIP_PLACE, round(min(layout.dowel_x) - layout.pad_inner, 9), t.tip, between=("tip", "dowel_hole")
        ),
        within("sheet thickness", d.sheet.thickness, t.sheet_thickness, between=FACES),
        dowel_hole_limits(d),
    )
    if "slot_floor" not in edges:  # a full round's width defines it
        stated = tuple(c for c in stated if c.name != FILLET)
    return tuple(replace(c, between=tuple(_standing(f, edges) for f in c.between)) for c in stated)


# A fillet that has used up its edge is tangent at the edge's former place.
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
    """The feature, or its substitute if the outline has lost it."""
    return next((f for f in (feature, *USED_UP.get(feature, ())) if f in edges), feature)


def dowel_hole_limits(design: Design) -> Characteristic:
    """Slide-fit dowel hole of elements, blanks and spacers, mm."""
    h = design.holes
    low, high = h.dowel_hole, round(h.dowel_hole + h.dowel_hole_upper, 9)
    return Characteristic(DOWEL_HOLE, low, high, low, between=("dowel_hole",))


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


def mounting_holes(layout: Layout, dowel: float | None = None) -> tuple[Contour, ...]:
    """Screw and dowel holes through elements, blanks and spacers, wire-cut; dowel holes (mm) at mid-tolerance
    of the slide fit if nothing else is given."""
    from ..language.metric import METRIC

    design = layout.design
    z = design.holes.height
    if dowel is None:
        dowel = round(design.holes.dowel_hole + design.holes.dowel_hole_upper / 2, 6)
    screws = [circle((x, z), METRIC[design.clamp.screw].clearance, "screw_hole") for x in layout.screw_x]
    dowels = [circle((x, z), dowel, "dowel_hole") for x in layout.dowel_x]
    return tuple(sorted(screws + dowels, key=lambda c: c.box[0]))


def sheet_material(design: CommonTables) -> Material:
    known = ALLOYS.get(design.material.alloy)
    return Material(
        design.material.alloy,
        design.material.density,
        standard=known.standard if known else "",
        magnetic=design.material.magnetic or "",
    )


def material_notes(design: Design) -> tuple[str, ...]:
    """Notes that the material requires."""
    bare = ("bare sheet, not clad",) if family(design.material.density) == "aluminium" else ()
    magnetic = ("demagnetise after cutting",) if design.material.magnetic == "yes" else ()
    # fatigue: sheet is stronger along its grain than across, and the hinge bends along the arm
    rolled = "rolling direction along the arm, across the hinge"
    return (*bare, rolled, *magnetic)


def shortest(value: float) -> str:
    """A length as in part numbers: 4.0 is "4", 4.25 is "4.25"; equal text means equal value."""
    text = repr(float(value))
    return text.removesuffix(".0")


def blank(layout: Layout) -> Part:
    r"""An element without arm: fills the shorter row, or an empty one, so that both rows are clamped equally
    and the stop plate has two ledges.

                    +-------------------------+
            ledge   |  o        O        o    |
          __________|                         |   z up, x ->
         |__________________           _______|
                            \_________|  wire recess
    """
    d = layout.design
    hinge = layout.elements[0].hinge
    face, ledge = layout.body_bottom(hinge), layout.ledge
    front = round(layout.clamp_edge - d.element.seat_length, 6)
    # as far from the dowel hole as any element's ledge: pad height and ledge over the pad
    zone = round(2 * (d.tolerance.pad_height + d.tolerance.ledge), 9)
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
        geometric=(Geometric("ledge", "position", zone, ("ledge",), ("A",)), screw_places("A")),
        datums=(DatumFeature("A", "dowel_hole"),),
    )


def deflected_element(layout: Layout, place: ElementPlace, deflection: float, roller: float) -> Part:
    """The element while a roller has pushed its pad up.

    The arm turns until the pad's face touches the roller: seen from the turned arm, the roller's centre
    (u, v) from the hinge is then at the height -(pad height + radius), which is
    A sin(phi + atan2(v, u)) = w with A = hypot(u, v).

    Parameters
    ----------
    layout, place
        The array, and the element in it.
    deflection
        Travel of the roller since it touched the pad, mm.
    roller
        Its radius, mm; its axis is under the pad's middle.

    Raises
    ------
    InputError
        If the arm cannot turn so far.
    """
    part = element(layout, place)
    z, w = _heights(layout, place, roller)
    u = -place.load_arm
    v = w + deflection
    if hypot(u, v) < -w:
        raise InputError(
            "deflection",
            "the arm cannot turn so far",
            value=deflection,
            legal=f"up to {-w - sqrt(max(w**2 - u**2, 0.0)):.3g} mm",
        )
    # the arm's direction from the hinge lies in the left half-plane: phi + atan2(v, u) there too
    angle = -(-pi - asin(w / hypot(u, v)) - atan2(v, u))
    outer = _bent(part.extrusion.outer, (place.hinge_x, z), angle)
    return replace(
        part,
        part_no=f"{part.part_no}-at-{deflection:g}mm",
        name=f"{part.name}, deflected {deflection:g}",
        process="reference",
        body=Extrusion(outer, part.extrusion.thickness, part.extrusion.openings),
        notes=("deflected state, for collision checks only",),
        characteristics=(),
        geometric=(),
        datums=(),
        finish="",
    )


def deflection_at_pad_edge(layout: Layout, place: ElementPlace, roller: float) -> float:
    """Deflection (mm) at which the arm has turned so far that a roller (radius in mm) meets the pad's edge.

    Seen from the turned arm the roller's centre comes nearer to the hinge: to A' with A'^2 + w^2 = A^2 + (w +
    d)^2. It is on the pad while A - A' is at most half the pad's length p, so d^2 + 2 w d + A p - p^2/4 = 0.
    Infinite if no deflection moves it that far.
    """
    _, w = _heights(layout, place, roller)
    half = layout.design.element.pad_length / 2
    c = 2 * place.load_arm * half - half**2
    return -w - sqrt(w**2 - c) if c < w**2 else inf


def _heights(layout: Layout, place: ElementPlace, roller: float) -> tuple[float, float]:
    """The hinge's centre over the flat face, and the roller's over it while it touches the pad of the arm at
    rest, mm."""
    z = place.hinge.t / 2 if layout.design.element.sides == "one" else place.hinge.h / 2
    return z, -layout.design.element.pad_height - roller - z


def _bent(contour: Contour, hinge: Point, angle: float) -> Contour:
    """The contour with everything left of the hinge's centre turned about it.

    Along the hinge, a stretch slightly longer than the rotation shortens becomes a chord.
    """
    pieces: list[Segment] = []
    for s in contour:
        left_first, left_last = s.start[0] < hinge[0], s.end[0] < hinge[0]
        if left_first == left_last:
            pieces.append(turned(s, hinge, angle) if left_first else s)
            continue
        half = 2 * abs(s.at(_where(s, hinge[0]))[1] - hinge[1]) * tan(abs(angle))
        sign = -1.0 if left_first else 1.0
        first = replace(s, end=s.at(_where(s, hinge[0] + sign * half)))
        last = replace(s, start=s.at(_where(s, hinge[0] - sign * half)))
        if left_first:
            first = turned(first, hinge, angle)
        else:
            last = turned(last, hinge, angle)
        pieces += [first, Line(first.end, last.start, s.name), last]
    return Contour(tuple(pieces))


def _where(s: Segment, x: float) -> float:
    """Parameter at which a segment that runs from one side of x to the other passes it."""
    low, high = 0.0, 1.0
    rising = s.end[0] > s.start[0]
    for _ in range(60):
        middle = (low + high) / 2
        if (s.at(middle)[0] < x) == rising:
            low = middle
        else:
            high = middle
    return (low + high) / 2


# Half-width in mm by number of passes, the coarser figure of vendors' pages (mecvil.com, tongrencnc.com): one
# pass 0.015 to 0.025, two to three 0.010, four and more 0.002 to 0.005.
WIRE_TOLERANCE = {"1 pass": 0.025, "2-3 passes": 0.010, "4 or more passes": 0.005}
_ENOUGH = (("one pass", "1 pass"), ("three passes", "2-3 passes"))


def least_passes(tolerance: float) -> str:
    """In words, the passes that hold that limit (mm, plus and minus): of two or three, three; more than four
    are promised nowhere."""
    return next((words for words, key in _ENOUGH if tolerance >= WIRE_TOLERANCE[key]), "four passes")


MEASURED = "measured:"  # first words of the origin of a value that follows from an inspection sheet
# Spacer's dowel hole over the dowel, mm; chosen: it positions nothing, and one pass of the wire suffices.
LOOSE = 0.1


def thickness_by_sheet(design: Design) -> str:
    """Every spacer's thickness by the sheet, in words."""
    return f"{design.array.pitch:g} less what the elements' sheet measures, +-{SPACER_TOLERANCE:g}"


def spacer(layout: Layout) -> Part:
    """Wire-cut sheet between neighbouring elements, over the clamped rear body only.

    clamp edge +--------------------+
               |  o      O      o   |   z up, x ->
               +--------------------+
    """
    d = layout.design
    z0, z1 = layout.spacer_z
    material = sheet_material(d)
    known = d.origin.get("array.spacer", "")
    measured = known if known.startswith(MEASURED) else ""
    if measured:
        by_sheet: tuple[str, ...] = (f"thickness {measured}",)
    else:
        by_sheet = (
            "order after measuring the elements' sheet",
            f"thickness as drawn where the elements' sheet measures {d.sheet.thickness:g}; else "
            f"{thickness_by_sheet(d)}",
        )
    return Part(
        part_no=f"{d.name}-spacer",
        name="Spacer",
        process="wire-cut",
        material=material,
        body=Extrusion(
            rectangle(layout.clamp_edge, z0, layout.rear_end, z1),
            layout.spacer,
            mounting_holes(layout, float(d.clamp.dowel) + LOOSE),
        ),
        colour="#9aa4ae",
        notes=(
            *by_sheet,
            "all from one sheet",
            f"burr-free; picked from rolled sheet that measures so, or ground {held_for_grinding(material)}",
            "wire-cut as packs: one pass holds outline and holes",
            f"the whole stack {layout.stack:g} +-{STACK:g}",
        ),
        characteristics=(
            replace(
                within("thickness", layout.spacer, SPACER_TOLERANCE, between=FACES),
                remark="" if measured else thickness_by_sheet(d),
            ),
        ),
        geometric=(screw_places("A"),),
        datums=(DatumFeature("A", "dowel_hole"),),
    )
