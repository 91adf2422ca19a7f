r"""End plate of the stack: takes the clamping screws and dowels of both rows, and the carrier's screws from
above.

+--o-----------------------------o--+   carrier's threads into the upper edge
|                                   |   ^ z
|  O   o   O               O   o   O|   |     O screw, o dowel
+-----------------------------------+   +-> x
"""

from __future__ import annotations

from tactcad.contour import rectangle
from tactcad.design.present import present
from tactcad.design.tree import Design

from .description import Extrusion, Feature, Hole, Part, Vector
from .element import dowel_hole_diameter
from .fasteners import Clamping, clamping, dowel_depth
from .layout import Layout
from .library.dowels import dowel_diameter
from .library.screws import METRIC, counterbore_diameter
from .plate import BREAK_EDGES, plate
from .screw_holes import tapped_blind, tapped_through

PLATE_COLOUR = "#7c8794"


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
            tapped_blind(
                "carrier", d.clamp.screw, (side * layout.carrier_screw_x, height, depth / 2), (0, -1, 0)
            )
        )
    kinds = ("sliding fit", "press fit") if c.rod else ("head", "tapped")
    kind = kinds[0] if head else kinds[1]
    return plate(
        d,
        f"end-plate-{kind.replace(' ', '-')}",
        f"End plate, {kind}",
        Extrusion(outer, depth),
        features,
        colour=PLATE_COLOUR,
        finish="Ra 1.6, clear anodised after machining; dowel holes masked",
        notes=(BREAK_EDGES,) if head else (BREAK_EDGES, _dowels_stand(layout, c)),
    )


def _dowels_stand(layout: Layout, c: Clamping) -> str:
    deep = dowel_depth(layout)
    return (
        f"dowels {layout.design.clamp.dowel} m6 are pressed in on assembly from the stack's side, "
        f"{deep:g} deep: {c.dowel - deep:g} stand out"
    )


def _screw_hole(name: str, d: Design, c: Clamping, head: bool, at: Vector, depth: float) -> Hole:
    m = METRIC[d.clamp.screw]
    if c.rod or (head and c.head_plate_web is None):
        return Hole(name, at, (0, 0, 1), m.clearance, depth, True)
    if head:
        deep = round(depth - present(c.head_plate_web), 9)
        counterbore = (counterbore_diameter(d.clamp.screw), deep) if deep > 0 else None
        return Hole(name, at, (0, 0, 1), m.clearance, depth, True, counterbore=counterbore)
    # from the inner face, where the screw comes in
    return tapped_through(name, d.clamp.screw, (at[0], at[1], depth), (0, 0, -1), depth)
