"""Spacers, blanks, end plates, stop plate and carrier: what fixes both rows in one clamp."""

from __future__ import annotations

from tactcad.contour import Corner, rectangle, rounded_polygon
from tactcad.design.tree import Design

from .description import Characteristic, Extrusion, Feature, Hole, Material, Part, Vector
from .element import dowel_hole_diameter, mounting_holes, rear_corners, sheet_material
from .fasteners import Clamping, carrier_screw, clamping
from .layout import Layout
from .library.dowels import dowel_diameter
from .library.screws import METRIC, TAP_REACH, blind_thread, counterbore_diameter
from .materials import plate_material

STEEL = Material("1.4301 stainless steel", 7900)
PLATE_COLOUR = "#7c8794"
SPACER_TOLERANCE = 0.01  # mm, plus and minus; chosen: shim stock is rolled to less


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
        notes=("burr-free, flat faces as rolled",),
        characteristics=(
            Characteristic(
                "thickness", layout.spacer, layout.spacer + SPACER_TOLERANCE, layout.spacer - SPACER_TOLERANCE
            ),
        ),
    )


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
    )


def end_plate(layout: Layout, head: bool) -> Part:
    """Plate at an end of the stack, in (x, z - bottom); joins both rows.

    `head`: the plate that takes the screw heads and lets the dowels slide; the other one is tapped
    (or, for tie rods, bored) and holds the dowels by press fit. Local z = 0 is the outer face.
    """
    d, c = layout.design, clamping(layout)
    z0, z1 = layout.end_plate_z
    depth = d.clamp.end_plate_thickness
    height = round(z1 - z0, 9)
    outer = rectangle(-layout.end_plate_half, 0, layout.end_plate_half, height)
    features: list[Feature] = []
    for side in (-1.0, 1.0):
        for i, x in enumerate(layout.screw_x):
            features.append(
                _screw_hole(f"screw_{i + 1}", d, c, head, (side * x, d.holes.height - z0, 0.0), depth)
            )
        for i, x in enumerate(layout.dowel_x):
            features.append(
                Hole(
                    f"dowel_{i + 1}",
                    (side * x, d.holes.height - z0, 0.0),
                    (0, 0, 1),
                    dowel_hole_diameter(d) if head else dowel_diameter(d.clamp.dowel),
                    depth,
                    True,
                    tolerance=f"+{d.holes.dowel_hole_upper:g}/0"
                    if head
                    else "H7, reamed with the pin in press fit",
                )
            )
        features.append(
            _blind_tapped(
                "carrier", d.clamp.screw, (side * layout.carrier_screw_x, height, depth / 2), (0, -1, 0)
            )
        )
    kind = "head" if head else "tapped"
    return Part(
        part_no=f"{d.name}-end-plate-{kind}",
        name=f"End plate, {kind}",
        process="milled",
        material=plate_material(d),
        body=Extrusion(outer, depth),
        features=tuple(features),
        colour=PLATE_COLOUR,
        finish="Ra 1.6, clear anodised after machining; dowel holes masked",
        notes=("break edges 0.2",),
    )


def stop_plate(layout: Layout) -> Part:
    """Ground plate on the ledges: the plane that every overload stop closes against."""
    d = layout.design
    x, y = layout.stop_plate_half, layout.stop_plate_width / 2
    return Part(
        part_no=f"{d.name}-stop-plate",
        name="Stop plate",
        process="ground",
        material=STEEL,
        body=Extrusion(rectangle(-x, -y, x, y), d.clamp.stop_plate_thickness),
        colour="#565d66",
        finish="both faces ground, Ra 0.4, flat within 0.005",
        notes=("break edges 0.2", "ground face down, on the ledges"),
        characteristics=(
            Characteristic(
                "thickness",
                d.clamp.stop_plate_thickness,
                d.clamp.stop_plate_thickness + 0.05,
                d.clamp.stop_plate_thickness - 0.05,
            ),
        ),
    )


def carrier(layout: Layout) -> Part:
    """Plate over the end plates: takes the axis, and the set screws that hold the stop plate down.

    Local (x, y) is the scene's, z = 0 its underside.
    """
    d, thread = layout.design, layout.design.clamp.screw
    length, width = layout.carrier_size
    t = d.clamp.carrier_thickness
    metric = METRIC[thread]
    screw = carrier_screw(layout)
    counterbore = (counterbore_diameter(thread), round(t - screw.under_head, 9))
    features: list[Feature] = []
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            features.append(
                Hole(
                    "end_plate_screw",
                    (sx * layout.carrier_screw_x, sy * layout.end_plate_y, t),
                    (0, 0, -1),
                    metric.clearance,
                    t,
                    True,
                    counterbore=counterbore,
                )
            )
            features.append(
                _tapped(
                    "mount",
                    d.clamp.mount_thread,
                    (sx * layout.mount_x, sy * d.clamp.mount_pitch_y / 2, t),
                    (0, 0, -1),
                    t,
                )
            )
        for y in layout.hold_down_y:
            features.append(_tapped("hold_down", thread, (sx * layout.hold_down_x, y, t), (0, 0, -1), t))
    return Part(
        part_no=f"{d.name}-carrier",
        name="Carrier",
        process="milled",
        material=plate_material(d),
        body=Extrusion(rectangle(-length / 2, -width / 2, length / 2, width / 2), t),
        features=tuple(features),
        colour="#8d99a6",
        finish="Ra 1.6, clear anodised after machining",
        notes=("break edges 0.2",),
    )


def _screw_hole(name: str, d: Design, c: Clamping, head: bool, at: Vector, depth: float) -> Hole:
    m = METRIC[d.clamp.screw]
    if c.rod or (head and c.head_plate_web is None):
        return Hole(name, at, (0, 0, 1), m.clearance, depth, True)
    if head:
        deep = round(depth - c.head_plate_web, 9)
        counterbore = (counterbore_diameter(d.clamp.screw), deep) if deep > 0 else None
        return Hole(name, at, (0, 0, 1), m.clearance, depth, True, counterbore=counterbore)
    # from the inner face, where the screw comes in
    return _tapped(name, d.clamp.screw, (at[0], at[1], depth), (0, 0, -1), depth)


def _tapped(name: str, thread: str, at: Vector, axis: Vector, depth: float) -> Hole:
    """Drilled through, and tapped from `at` as deep as a tap reaches."""
    full = min(depth, TAP_REACH * METRIC[thread].d)
    return Hole(name, at, axis, METRIC[thread].tap_drill, depth, True, thread=thread, thread_depth=full)


def _blind_tapped(name: str, thread: str, at: Vector, axis: Vector) -> Hole:
    m = METRIC[thread]
    full = blind_thread(thread)
    return Hole(
        name,
        at,
        axis,
        m.tap_drill,
        round(full + 2 * m.pitch, 9),
        False,
        thread=thread,
        thread_depth=full,
        drill_point=True,
    )
