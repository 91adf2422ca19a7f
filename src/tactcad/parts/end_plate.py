r"""End plate of the stack: takes the clamping screws and dowels of both rows, and the carrier's screws from
above.

+--o-----------------------------o--+   carrier's threads into the upper edge
|                                   |   ^ z
|  O   o   O               O   o   O|   |     O screw, o dowel
+-----------------------------------+   +-> x
"""

from __future__ import annotations

from math import ceil

from tactcad.contour import rectangle
from tactcad.design.present import present
from tactcad.design.tree import Design

from .description import Extrusion, Feature, Hole, Part, Vector
from .fasteners import Clamping, clamping, dowel_depth
from .layout import Layout
from .library.dowels import dowel_diameter, dowel_limits
from .library.fits import deviations
from .library.screws import METRIC, counterbore_diameter
from .limits import FACES, Characteristic, DatumFeature, Geometric
from .plate import BREAK_EDGES, FRAME, PLACE, plate
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
    bore = head_bore(layout) if head else pressed(float(d.clamp.dowel))
    features: list[Feature] = []
    for side in (-1.0, 1.0):
        for i, x in enumerate(layout.screw_x):
            features.append(
                _screw_hole(f"screw_{i + 1}", d, c, head, (side * x, d.holes.height - z0, 0.0), depth)
            )
        for x in layout.dowel_x:
            features.append(
                Hole(
                    "dowel_hole",
                    (side * x, d.holes.height - z0, 0.0),
                    (0, 0, 1),
                    round((bore.lower + bore.upper) / 2, 6) if head else dowel_diameter(d.clamp.dowel),
                    depth,
                    True,
                    tolerance="" if head else f"{PRESS_FIT}, the pin pressed in",
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
        notes=(
            BREAK_EDGES,
            *(() if head else (_dowels_stand(layout, c),)),
            "upper edge and dowel holes of both end plates machined in one clamping; mark the pair",
        ),
        characteristics=(bore,),
        geometric=(*_places(layout), *(() if head else (SQUARENESS,))),
        datums=(DatumFeature("A", INNER), DatumFeature("B", "upper edge"), DatumFeature("C", "left edge")),
    )


def _dowels_stand(layout: Layout, c: Clamping) -> str:
    deep = dowel_depth(layout)
    return (
        f"dowels {layout.design.clamp.dowel} m6 are pressed in on assembly from the stack's side, "
        f"{deep:g} deep: {c.dowel - deep:g} stand out"
    )


PRESS_FIT = "N7"  # of the pins in the tapped plate, ISO 286
HEAD_TOLERANCE = 0.03  # mm, of the head plate's dowel holes; chosen: reamed or bored
# mm that a pin is bent at its end by hand while a plate goes on; chosen: 1 N on 3 mm of steel, 29 mm out.
BENT = 0.01
INNER = FACES[1]
# Zones in mm; chosen: what a jig borer or wire holds in one clamping.
HOLES, PAIR, SQUARE = 0.03, 0.01, 0.003


def lean(layout: Layout) -> float:
    """How far a pin may lean at the head plate's outer face, mm: as its hole, but no further than a finger
    bends it straight."""
    depth = layout.design.clamp.end_plate_thickness
    return min(SQUARE / depth * (layout.stack + depth), BENT)


def head_bore(layout: Layout) -> Characteristic:
    """The head plate's dowel holes: they pass over pins that lean as far as they may, and leave room to level
    the plate."""
    d = layout.design
    least = ceil(100 * (dowel_limits(d.clamp.dowel)[1] + 2 * lean(layout) + PAIR) - 1e-6) / 100
    upper = round(least + HEAD_TOLERANCE, 6)
    return Characteristic("dowel hole diameter", least, upper, least, between=("dowel_hole",))


def pressed(size: float) -> Characteristic:
    """Limits of a hole that a pin of that size (mm) is pressed into."""
    low, high = deviations(PRESS_FIT, size)
    limits = (round(size + high, 6), round(size + low, 6))
    return Characteristic("dowel hole diameter", size, *limits, between=("dowel_hole",))


def _places(layout: Layout) -> tuple[Geometric, ...]:
    screws = tuple(f"screw_{i + 1}" for i in range(len(layout.screw_x)))
    dowels = ("dowel_hole",)
    return (
        Geometric("dowel holes", "position", HOLES, dowels, FRAME, True),
        Geometric("dowel holes of the pair", "position", PAIR, dowels, ("A", "B"), True),
        Geometric("screw holes", "position", PLACE, screws, FRAME, True),
        Geometric("carrier threads", "position", PLACE, ("carrier",), FRAME, True),
    )


SQUARENESS = Geometric("dowel holes' squareness", "perpendicularity", SQUARE, ("dowel_hole",), ("A",), True)


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
