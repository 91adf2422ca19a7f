"""The clamp of the elements: end plates, carrier and stop plate, with screws and dowels: standard lengths, or
tie rods and ground rod beyond them.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, floor

from tactcad.contour import rectangle
from tactcad.design.fields import present
from tactcad.design.tree import Design

from ..bought.screws import CAP_SCREW_LENGTHS
from ..bought.standard_parts import dowel_diameter, dowel_lengths, dowel_limits
from ..language.description import Extrusion, Feature, Hole, Part, Vector
from ..language.limits import FACES, Characteristic, DatumFeature, Geometric, deviations, general, within
from ..language.metric import (
    METRIC,
    SUNK,
    TAP_REACH,
    counterbore_diameter,
    engagement,
    tapped_blind,
    tapped_through,
)
from ..language.stock import ANODISED, BREAK_EDGES, FRAME, MAGNETIC_STAINLESS, PLACE, held_for_grinding, plate
from .layout import Layout

# Least plate under a screw's head, and least grip of a dowel in each end plate, in mm: chosen, one
# diameter of the usual M3 and of its dowel less the pin's chamfer.
LEAST_UNDER_HEAD = 2.5
LEAST_GRIP = 3.0
LEAST_UNDER_CARRIER_HEAD = 2.0


# mm, plus and minus: spacers are as thick as pitch less measured sheet, so that the stack is as long as drawn
# within STACK. Chosen: 0.01 by picking from rolled sheet or by grinding; 0.2 is what the carrier's holes
# take, where six such spacers and five sheets measured to 0.01 are 0.11 off.
SPACER_TOLERANCE, STACK = 0.01, 0.2


@dataclass(frozen=True)
class Clamping:
    """Lengths in mm.

    screw           ISO 4762 length through the stack, or the tie rod's where rod is true
    head_plate_web  head plate's material under the screw's head; None for tie rods
    dowel           dowel length, a standard one or ground rod cut to length
    """

    rod: bool
    screw: float
    head_plate_web: float | None
    dowel: float


def clamping(layout: Layout) -> Clamping:
    """The stack's fasteners.

    A cap screw must leave LEAST_UNDER_HEAD under its head and engage 1.5 d in the tapped plate
    without passing through it; the counterbore takes up the difference to the standard length, and sinks the
    head, or there is none.
    """
    d = layout.design.clamp
    plate, stack = d.end_plate_thickness, layout.stack
    dowel = _dowel(layout)
    for length in CAP_SCREW_LENGTHS[d.screw]:
        # engaged in the tapped plate over 2/3 of its thickness, so that the screw ends inside, and no deeper
        # than its thread
        engaged = max(engagement(d.screw), min(round(2 / 3 * plate, 1), TAP_REACH * METRIC[d.screw].d))
        web = round(length - stack - engaged, 9)
        if plate > web > plate - METRIC[d.screw].head_height - SUNK:  # a counterbore sinks the whole head
            web = round(plate - METRIC[d.screw].head_height - SUNK, 9)
            engaged = round(length - stack - web, 9)
        # at its longest, in the shortest stack, it still ends inside the plate
        free = deviations("js15", length)[1] + STACK
        reach = min(plate - free, TAP_REACH * METRIC[d.screw].d)
        if LEAST_UNDER_HEAD <= web <= plate and engaged <= reach:
            return Clamping(False, length, web, dowel)
    m = METRIC[d.screw]
    ends = m.nut_height + 2 * m.pitch
    return Clamping(True, float(ceil(stack + 2 * plate + 2 * ends)), None, dowel)


def array_width(layout: Layout) -> float:
    """Along y, mm: the carrier, and the protrusion of tie rods or of a screw's head."""
    c, d, half = clamping(layout), layout.design.clamp, layout.carrier_width / 2
    if c.rod:
        return max(2 * half, c.screw)
    web = c.head_plate_web or 0.0
    head = layout.stack / 2 + max(d.end_plate_thickness, web + METRIC[d.screw].head_height)
    return round(half + max(half, head), 6)


def _dowel(layout: Layout) -> float:
    plate, stack = layout.design.clamp.end_plate_thickness, layout.stack
    fitting = [
        n
        for n in dowel_lengths(layout.design.clamp.dowel)
        if stack + 2 * LEAST_GRIP <= n <= stack + 2 * plate
    ]
    if fitting:
        return fitting[-1]
    return (
        float(ceil(stack + 2 * LEAST_GRIP))
        if ceil(stack + 2 * LEAST_GRIP) <= stack + 2 * plate
        else stack + 2 * plate
    )


def dowel_depth(layout: Layout) -> float:
    """Depth of a dowel in each end plate, from the inner face, mm."""
    return round((clamping(layout).dowel - layout.stack) / 2, 9)


@dataclass(frozen=True)
class CarrierScrew:
    """Length, and the carrier's material under its sunk head, mm."""

    length: float
    under_head: float


def carrier_screw(layout: Layout) -> CarrierScrew | None:
    """The cap screw that fixes the carrier to an end plate's blind thread; None if no length fits.

    It engages 1.5 d and 0.8 mm of the 1.5 d + 1.5 mm of thread; its head is sunk.
    """
    d = layout.design.clamp
    fits = thinnest_carrier(d.screw) <= d.carrier_thickness + 1e-9  # mm: written in decimals, kept in binary
    return _shortest_carrier_screw(d.screw) if fits else None


def thinnest_carrier(thread: str) -> float:
    """Least carrier thickness that sinks the head of its screws, mm."""
    return round(_shortest_carrier_screw(thread).under_head + METRIC[thread].head_height + SUNK, 9)


def _shortest_carrier_screw(thread: str) -> CarrierScrew:
    under = ((length, round(length - engagement(thread) - 0.8, 9)) for length in CAP_SCREW_LENGTHS[thread])
    return next(CarrierScrew(*pair) for pair in under if pair[1] >= LEAST_UNDER_CARRIER_HEAD)


PLATE_COLOUR = "#7c8794"


def end_plate(layout: Layout, head: bool) -> Part:
    """Plate at an end of the stack, in (x, z - bottom); joins both rows.

    `head`: the plate that takes the screw heads and lets the dowels slide; the other one is tapped
    (or, for tie rods, bored) and holds the dowels by press fit. Local z = 0 is the outer face.

    +--o-----------------------------o--+   carrier's threads into the upper edge
    |                                   |   ^ z
    |  O   o   O               O   o   O|   |     O screw, o dowel
    +-----------------------------------+   +-> x
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
        finish=f"{ANODISED}; dowel holes masked",
        notes=(
            BREAK_EDGES,
            *(() if head else (_dowels_stand(layout, c),)),
            "both edges and the dowel holes of both end plates machined in one clamping; mark the pair",
        ),
        characteristics=(bore,),
        geometric=(*_places(layout), CLAMP_FACE, *(() if head else (SQUARENESS,))),
        datums=(
            DatumFeature("A", INNER),
            DatumFeature("B", "upper edge"),
            DatumFeature("C", "left edge"),
            DatumFeature("D", "lower edge"),
        ),
    )


def _dowels_stand(layout: Layout, c: Clamping) -> str:
    deep = dowel_depth(layout)
    return (
        f"dowels {layout.design.clamp.dowel} m6 are pressed in on assembly from the stack's side, "
        f"{deep:g} deep: {c.dowel - deep:g} stand out"
    )


PRESS_FIT = "N7"  # of the pins in the tapped plate, ISO 286


def pin_hole(name: str, at: Vector, axis: Vector, size: str, depth: float) -> Hole:
    """A through hole that a pin is pressed into."""
    fit = f"{PRESS_FIT}, the pin pressed in"
    return Hole(name, at, axis, dowel_diameter(size), depth, True, tolerance=fit)


HEAD_TOLERANCE = 0.03  # mm, of the head plate's dowel holes; chosen: reamed or bored
# mm that a pin is bent at its end by hand while a plate goes on; chosen: 1 N on 3 mm of steel, 29 mm out.
BENT = 0.01
INNER = FACES[1]
# Zones in mm; chosen: achievable by a jig borer or wire in one clamping.
HOLES, PAIR, SQUARE = 0.03, 0.01, 0.003
OVER_EDGE = "dowel holes over the lower edge"  # by which the setting fixture holds the plates' height


def lean(layout: Layout) -> float:
    """Largest lean of a pin at the head plate's outer face, mm: as its hole, but no more than a finger
    straightens."""
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
        Geometric(OVER_EDGE, "position", PAIR, dowels, ("A", "D"), True),
        Geometric("screw holes", "position", PLACE, screws, FRAME, True),
        Geometric("carrier threads", "position", PLACE, ("carrier",), FRAME, True),
    )


# mm; chosen: finely milled or lapped. The pins' squareness refers to this face, and the stack is clamped on
# it.
CLAMP_FACE = Geometric("flatness", "flatness", 0.005, (INNER,))
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


def carrier(layout: Layout) -> Part:
    """Plate over the end plates: takes the axis, and the set screws that hold the stop plate down.

    Local (x, y) is the scene's, z = 0 its underside.

    +-------------------------------+
    | O   o   .           .   o   O |   O end plate's screws, sunk
    |         .           .         |   o threads for the axis
    | O   o   .           .   o   O |   . set screws
    +-------------------------------+
    """
    d, thread = layout.design, layout.design.clamp.screw
    length, width = layout.carrier_size
    t = d.clamp.carrier_thickness
    metric = METRIC[thread]
    screw = present(carrier_screw(layout))
    wider = carrier_clearance(layout) - metric.clearance
    counterbore = (round(counterbore_diameter(thread) + wider, 9), round(t - screw.under_head, 9))
    features: list[Feature] = []
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            features.append(
                Hole(
                    "end_plate_screw",
                    (sx * layout.carrier_screw_x, sy * layout.end_plate_y, t),
                    (0, 0, -1),
                    carrier_clearance(layout),
                    t,
                    True,
                    counterbore=counterbore,
                )
            )
            features.append(
                tapped_through(
                    "mount",
                    d.clamp.mount_thread,
                    (sx * layout.mount_x, sy * d.clamp.mount_pitch_y / 2, t),
                    (0, 0, -1),
                    t,
                )
            )
        for y in layout.hold_down_y:
            features.append(
                tapped_through("hold_down", thread, (sx * layout.hold_down_x, y, t), (0, 0, -1), t)
            )
    return plate(
        d,
        "carrier",
        "Carrier",
        Extrusion(rectangle(-length / 2, -width / 2, length / 2, width / 2), t),
        features,
    )


def carrier_clearance(layout: Layout) -> float:
    """Diameter of the holes for the end plates' screws, mm.

    They allow for the end plates' distance by the stack and for the threads' zones, even if the holes are as
    small as general tolerances allow; but they leave LEAST_RING of every head's face on the carrier.
    """
    m = METRIC[layout.design.clamp.screw]
    wanted = m.d + STACK + 2 * PLACE + general(m.clearance)
    # (head - hole)/2 - (hole - d)/2 >= LEAST_RING
    widest = (m.head - HEAD_LESS + m.d) / 2 - LEAST_RING
    return max(m.clearance, min(floor(10 * widest + 1e-6), ceil(10 * wanted - 1e-6)) / 10)


# Least width of a head's face around a hole, at its narrowest, mm; chosen.
LEAST_RING = 0.25
HEAD_LESS = 0.2  # mm: least head diameter under the largest (ISO 4762, table 1, rounded up)


STOP_PLATE_FLAT = 0.005  # mm; chosen: what surface grinding holds, a quarter of the usual gap's tolerances


def stop_plate(layout: Layout) -> Part:
    """Ground plate on the ledges: the plane that every overload stop closes against.

    +-----------------------------------+   ^ z
    +-----------------------------------+   +-> x   both faces ground
    """
    d = layout.design
    x, y = layout.stop_plate_half, layout.stop_plate_width / 2
    return Part(
        part_no=f"{d.name}-stop-plate",
        name="Stop plate",
        process="ground",
        material=MAGNETIC_STAINLESS,
        body=Extrusion(rectangle(-x, -y, x, y), d.clamp.stop_plate_thickness),
        colour="#565d66",
        finish="both faces ground, Ra 0.4",
        notes=(
            "break edges 0.2",
            "either face may lie on the ledges",
            f"ground {held_for_grinding(MAGNETIC_STAINLESS)}",
        ),
        characteristics=(within("thickness", d.clamp.stop_plate_thickness, 0.05, between=FACES),),
        geometric=(
            Geometric("flatness", "flatness", STOP_PLATE_FLAT, FACES),
            Geometric("parallelism", "parallelism", STOP_PLATE_FLAT, (FACES[1],), ("A",)),
        ),
        datums=(DatumFeature("A", FACES[0]),),
    )
