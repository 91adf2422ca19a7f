"""The force gauge, the two plates that hold it on its vertical axis, and the tips on its shaft."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, floor, hypot

from tactcad.contour import Corner, circle, rectangle, rounded_polygon
from tactcad.design.fields import present

from ..array.layout import Layout
from ..bought.standard_parts import dowel_diameter, dowel_lengths, dowel_limits
from ..language.description import Extrusion, Feature, Hole, Part, Pocket, Purchase
from ..language.limits import within
from ..language.metric import METRIC, corners, sunk, tapped
from ..language.stock import ALUMINIUM, STAINLESS, STAINLESS_PLATE, plate
from .frame import GAUGE_SHAFT, GAUGE_SIZE, PLATE, PLATE_SCREW, STAGE_HOLE, TIP, TIP_LAND
from .stand import StandLayout

SHAFT = 6.0  # M6
GAUGE_THREADS = (-20.0, 20.0)  # of the gauge's back, from the middle of its plate, mm


def force_gauge(rig: StandLayout) -> Part:
    """Digital force gauge, shaft down: (x, y) the scene's, z = 0 the shaft's end, z = 10 the housing's lower
    face.

    +-----------+
    |  o     o  |    threads in the back, toward +y
    |           |  ^ z
    +----+ +----+  |
         | | shaft
         +-+         z = 0
    """
    w, deep, high = GAUGE_SIZE
    c = present(rig.design.calibration)
    around = rectangle(-w / 2, -deep / 2, w / 2, deep / 2)
    shaft = Pocket(
        "around_shaft", (0, 0, 0), (0, 0, 1), (1, 0, 0), around, GAUGE_SHAFT, (circle((0, 0), SHAFT),)
    )
    threads = tuple(
        Hole(
            "mount",
            (0, deep / 2, GAUGE_SHAFT + 45.0 + z),
            (0, -1, 0),
            METRIC["M4"].tap_drill,
            9.0,
            False,
            thread="M4",
            thread_depth=8.0,
        )
        for z in GAUGE_THREADS
    )
    maker, number = ("Sauter", "FH 5") if c.load_cell_range == 5.0 else ("", "")
    return Part(
        part_no=f"FORCE-GAUGE-{c.load_cell_range:g}N",
        name=f"Digital force gauge {c.load_cell_range:g} N",
        process="bought",
        material=ALUMINIUM,
        body=Extrusion(around, high + GAUGE_SHAFT),
        features=(shaft, *threads),
        colour="#d9b44a",
        purchase=Purchase(
            f"digital force gauge {c.load_cell_range:g} N, {c.load_cell_resolution:g} N, "
            f"{c.load_cell_stiffness:g} N/mm at its shaft, M6 shaft",
            manufacturer=maker,
            mpn=number,
            alternates="any gauge of that range; enter its measured stiffness in "
            "calibration.load_cell_stiffness",
        ),
        mass_override=640.0,
    )


GAUGE_SCREW_X, GAUGE_SCREW_Z = 40.0, 20.0  # gauge plate on axis plate: outside the gauge's width


def gauge_plate(rig: StandLayout) -> Part:
    """Holds the force gauge by two screws from behind. Front face at local z = 0.

    +-----------------+
    | O      O      O |
    |                 |   middle column: gauge; sides: axis plate
    | O      O      O |
    +-----------------+
    """
    thread, _, under = PLATE_SCREW
    features = [
        sunk("axis_plate", thread, (px, py, 0.0), (0, 0, 1), PLATE, under)
        for px, py in corners(GAUGE_SCREW_X, GAUGE_SCREW_Z)
    ]
    features += [sunk("gauge", thread, (0.0, y, PLATE), (0, 0, -1), PLATE, under) for y in GAUGE_THREADS]
    return upright_plate(rig, "gauge-plate", "Gauge plate", features)


def upright_plate(rig: StandLayout, number: str, name: str, features: Sequence[Feature]) -> Part:
    return plate(rig.design, number, name, Extrusion(rectangle(-46.0, -35.0, 46.0, 35.0), PLATE), features)


def axis_plate(rig: StandLayout) -> Part:
    """On the vertical stage; takes the gauge plate outside the gauge's width. Front face at local z = 0.

    +-----------------+
    | o   O     O   o |   O stage, sunk; o gauge plate, tapped
    |                 |
    | o   O     O   o |
    +-----------------+
    """
    thread, _, under = PLATE_SCREW
    features = [
        sunk("stage", thread, (px, py, 0.0), (0, 0, 1), PLATE, under)
        for px, py in corners(STAGE_HOLE, STAGE_HOLE)
    ]
    features += [
        tapped("gauge_plate", thread, (px, py, 0.0), (0, 0, 1), PLATE)
        for px, py in corners(GAUGE_SCREW_X, GAUGE_SCREW_Z)
    ]
    return upright_plate(rig, "axis-plate", "Axis plate", features)


LAND = 0.01  # mm, plus and minus


def flat_tip(rig: StandLayout) -> Part:
    """Tip for the sample: a land of one pad's size under a round body. z = 0 is the land, the thread from
    the top.

    +-------+   z = TIP: M6 from the top
    |       |
    |       |
    +-+   +-+
      +---+     z = 0: land
    """
    d = rig.design
    a, b = d.element.pad_length / 2, d.sheet.thickness / 2
    body = max(10.0, float(ceil(2 * hypot(a, b) + 1.0)))  # 0.5 mm around the land's corners
    around = circle((0, 0), body)
    return Part(
        part_no=f"{d.name}-tip-flat",
        name=f"Tip, flat {d.element.pad_length:g} x {d.sheet.thickness:g}",
        process="milled",
        material=STAINLESS,
        body=Extrusion(around, TIP),
        features=(
            Pocket(
                "around_land", (0, 0, 0), (0, 0, 1), (1, 0, 0), around, TIP_LAND, (rectangle(-a, -b, a, b),)
            ),
            shaft_thread(),
        ),
        colour="#565d66",
        finish="land Ra 0.4, edges sharp, burr-free",
        characteristics=(
            within("land along x", 2 * a, LAND, between=("around_land left edge", "around_land right edge")),
            within("land along y", 2 * b, LAND, between=("around_land lower edge", "around_land upper edge")),
        ),
    )


def shaft_thread(
    at: tuple[float, float, float] = (0.0, 0.0, TIP), axis: tuple[float, float, float] = (0, 0, -1)
) -> Hole:
    """M6 for the gauge's shaft: 6 of its 10 mm engaged, a jam nut on the rest."""
    return Hole("shaft", at, axis, 5.0, 12.0, False, thread="M6", thread_depth=10.0, drill_point=True)


def roller_tip(rig: StandLayout) -> Part:
    r"""Tip for the pads: a nose with a half-round seat for the roller, which protrudes by its radius.

    Contour in (x, z), z = 0 the roller's lowest line, extruded along y by 10.

    +-------+   z = TIP: M6 from the top
    |       |
    \       /
     +-( )-+
       ( )      roller; z = 0 its lowest line
    """
    r, seat = seat_radius(present(rig.design.calibration).roller), "seat"
    top = dowel_diameter(present(rig.design.calibration).roller)
    low = top - r  # of the nose: the seat is half round
    nose, half = ceil(10 * (r + 1.0)) / 10, 6.0
    corners = [
        Corner((-nose, low), edge=NOSE),
        Corner((-r, low)),
        Corner((-r, top), r, fillet=seat),
        Corner((r, top), r, fillet=seat),
        Corner((r, low)),
        Corner((nose, low)),
        Corner((half, low + half - nose)),
        Corner((half, TIP), edge="shaft_face"),
        Corner((-half, TIP)),
        Corner((-half, low + half - nose)),
    ]
    return Part(
        part_no=f"{rig.design.name}-tip-roller",
        name="Tip, roller holder",
        process="wire-cut",
        material=STAINLESS_PLATE,
        body=Extrusion(rounded_polygon(corners), 10.0),
        features=(shaft_thread((0.0, TIP, 5.0), (0, -1, 0)),),
        colour="#565d66",
        notes=("roller bonded in its seat; it may not turn while an element is loaded",),
        characteristics=(
            within(SEAT_RADIUS, r, SEAT, between=(seat,)),
            within(NOSE, round(TIP - low, 6), NOSE_HEIGHT, between=(NOSE, "shaft_face")),
        ),
    )


# mm of roller beyond a pad in all: chamfers of a pin (0.35 each), and its place; of a rod with broken edges;
# between roller and neighbouring pads.
OVER_PAD, LEAST_OVER_PAD, BESIDE_ROLLER = 1.0, 0.5, 0.1


def longest_roller(layout: Layout) -> float:
    """Longest roller that clears the pads next to the loaded one, mm."""
    d = layout.design
    return round(2 * (d.array.pitch - d.sheet.thickness / 2 - BESIDE_ROLLER), 9)


def roller_length(layout: Layout) -> float:
    """Length of the roller, mm: the shortest standard pin that lies straight on the whole pad, else ground
    rod."""
    d, most = layout.design, longest_roller(layout)
    least = d.sheet.thickness + OVER_PAD
    fitting = [n for n in dowel_lengths(present(d.calibration).roller) if least <= n <= most]
    return fitting[0] if fitting else floor(10 * min(least, most) + 1e-6) / 10


SEAT_RADIUS, NOSE = "seat radius", "nose"
NOSE_HEIGHT = 0.05  # mm, plus and minus; chosen: the roller protrudes from it
SEAT = 0.005  # mm, plus and minus; chosen: two to three passes of the wire
# Radial, mm: the least play felt with a pin; more would let the roller lie off the seat's middle.
LEAST_AROUND_ROLLER = 0.001


def seat_radius(size: str) -> float:
    """Radius of the roller's seat, mm: at its lower limit it still takes the largest m6 pin of that size."""
    return round(dowel_limits(size)[1] / 2 + LEAST_AROUND_ROLLER + SEAT, 6)
