"""A read-out board as its neighbours see it (outline, holes, lead connector, heights), and its carrier: a
plate with stand-offs, and a clamp that relieves the leads before the board's connector.

      W = width
    +-------------------------------+  y = height
    | o     ::::::::::::::::      o |     leads come in over this edge
    |       lead connector          |
    |                               |
    | o     ::::::: to the card   o |
    +-------------------------------+  y = 0
    x = 0

    :::::::  socket on the board's header
  ===========  board             leads
  ||       ||   stand-offs    [##]-----------> array
  +--------------------------------+  plate
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, sqrt

from tactcad.contour import Corner, chain, rectangle, rounded_polygon
from tactcad.design.sensing import MULTIPLEXERS, WIRES
from tactcad.design.tree import Design

from ..bought.electronic_parts import CARD_SIGNALS, CONTROLLER_SIGNALS, converter_of
from ..language.description import Extrusion, Hole, Material, Part, Purchase, Revolution
from ..language.limits import FACES, DatumFeature, Geometric
from ..language.metric import METRIC, tapped_through
from ..language.stock import BRASS, BREAK_EDGES, PLACE, plate
from .layout import Layout

Place = tuple[float, float]

THICKNESS = 1.6  # mm; chosen: what every board house has in stock
PITCH = 2.54  # of the headers' pins, mm
HOLE, AT_CORNER = 3.4, 4.0  # mm: a hole for M3 (ISO 273, medium), from both edges of its corner
LEADS_FROM_EDGE = 10.0  # mm, the lead connector's pins from the upper edge: before them are the ties' holes
CARD_FROM_EDGE = 5.0  # mm, the other connector's pins from the lower edge: their names are printed below
HIGHEST = 8.5  # mm, pin headers: insulator 2.54 and pins of 6; the foil resistors are 8.3
PIN_LENGTH = 1.4  # mm that soldered pins reach below the board; chosen: pins of 3 mm through 1.6 mm
WIDTH, HEIGHT = 90.0, 102.0  # mm; chosen: what the routed board takes


@dataclass(frozen=True)
class BoardOutline:
    """mm, from the lower left corner of the component side; `thickness` of the bare board.

    holes: x, y, diameter. connector: the middle of the lead connector's row of pins; leads leave along y.
    highest: of the parts above the board, without plugs; lowest: of the parts below it.
    """

    width: float
    height: float
    thickness: float
    holes: tuple[tuple[float, float, float], ...]
    connector: Place
    highest: float
    lowest: float


# Of each board that reads the array; all are equal.
BOARD_OUTLINE = BoardOutline(
    WIDTH,
    HEIGHT,
    THICKNESS,
    tuple((x, y, HOLE) for y in (AT_CORNER, HEIGHT - AT_CORNER) for x in (AT_CORNER, WIDTH - AT_CORNER)),
    (WIDTH / 2, HEIGHT - LEADS_FROM_EDGE),
    HIGHEST,
    PIN_LENGTH,
)


def channels_of(layout: Layout) -> int:
    """Channels of a board: of its multiplexer, or of the converter that takes the bridges directly."""
    converter = converter_of(layout.design)
    return converter.inputs if converter else MULTIPLEXERS[layout.design.readout.multiplexer].channels


def lead_pins(layout: Layout) -> int:
    """Pins of a board's lead connector: three a channel, and one each for the leads' shield and the array's
    metal."""
    return 3 * channels_of(layout) + 2


def card_pins(layout: Layout) -> int:
    """Pins of a board's connector to the converter's card, or to the controller of a converter on the
    board."""
    if converter_of(layout.design):
        return CONTROLLER_SIGNALS
    return CARD_SIGNALS + len(MULTIPLEXERS[layout.design.readout.multiplexer].address)


THREAD = "M3"  # of every screw here, to fit the board's holes
PLATE = 8.0  # mm; chosen: a thickness sold, with 1.5 d of thread and the stand-offs' studs inside it
EDGE = 4.0  # mm of plate beyond the board's other three edges; chosen: no board protrudes at a grip
STAND_OFF, STUD, FLATS = 10.0, 6.0, 5.5  # mm; chosen: clear of soldered pins, as sold, across flats
STAND_OFF_THREAD = 7.0  # mm of inner thread; chosen: the screw's 4.4 and run-out
BOARD_SCREW = 6.0  # mm: through the board, 4.4 in the stand-off
CLAMP_AHEAD = 22.0  # mm from the connector's pins to the clamp's middle: board's edge, a parked socket, a key
CLAMP = (36.0, 8.0, 6.0)  # mm: across the leads, along them, high
CLAMP_SCREW, CLAMP_SCREW_X = 12.0, 12.0  # mm: 6 in the plate; from the groove's middle
PLATE_AHEAD = CLAMP_AHEAD + CLAMP[1] / 2 + EDGE  # mm from the connector's pins to the plate's edge
SQUEEZED = 0.8  # of the bundle's diameter is the groove high; chosen: it holds by its braid, wires stay round
PACKED = 0.75  # of a bundle's section is wire; chosen: round wires laid by hand
BRAID = 0.3  # mm: wall of braid and sleeve around the bundle; chosen
MILLED = 1.0  # mm: inside radius that a cutter leaves over the clamp's length
INSULATOR, SOCKET = 2.54, 8.5  # mm: of a header over its board, and of the socket over that, usual
UNPLUGGED = 12.0  # mm that a socket is lifted until its header's pins of 6 mm are free; chosen: twice as far
FR4 = Material("FR-4", 1850)  # kg/m3, usual
PLASTIC = Material("PBT", 1300)  # kg/m3, usual


def socket_top() -> float:
    """Solder level of a plugged socket, mm over the plate's underside."""
    return PLATE + STAND_OFF + THICKNESS + INSULATOR + SOCKET


def bundle(design: Design, leads: int) -> float:
    """Diameter of so many leads in their braid, mm."""
    return WIRES[design.wiring.wire].outer * sqrt(leads / PACKED) + 2 * BRAID


def board_plate(design: Design, outline: BoardOutline) -> Part:
    """Plate under a board, in the board's own x and y; z = 0 is its underside.

    +----------------------+
    |        .    .        |   threads of the lead clamp, on the array's side
    | .                  . |   threads of the stand-offs
    |                      |
    | .                  . |
    +----------------------+
    """
    clamp_y = HEIGHT - LEADS_FROM_EDGE + CLAMP_AHEAD
    features = [
        tapped_through("stand_off", THREAD, (x, y, PLATE), (0, 0, -1), PLATE) for x, y, _ in outline.holes
    ]
    features += [
        tapped_through("clamp", THREAD, (WIDTH / 2 + side * CLAMP_SCREW_X, clamp_y, PLATE), (0, 0, -1), PLATE)
        for side in (-1, 1)
    ]
    top = HEIGHT - LEADS_FROM_EDGE + PLATE_AHEAD
    body = Extrusion(rectangle(-EDGE, -EDGE, WIDTH + EDGE, top), PLATE)
    return plate(design, "board-plate", "Board plate", body, features)


def lead_clamp(design: Design, leads: int) -> Part:
    """Bar over a board's leads: contour in (x, height), extruded along them.

    +--O--------O--+
    |     .--.     |   groove for the bundle
    +----+    +----+
    """
    across, along, high = CLAMP
    x, least = across / 2, MILLED + 0.2
    wide = max(least, ceil(5 * bundle(design, leads)) / 10)
    deep = max(least, ceil(10 * SQUEEZED * bundle(design, leads)) / 10)
    contour = rounded_polygon(
        [
            Corner((-x, 0.0), edge="left foot"),
            Corner((-wide, 0.0), edge="groove"),
            Corner((-wide, deep), MILLED, "groove", "groove"),
            Corner((wide, deep), MILLED, "groove", "groove"),
            Corner((wide, 0.0), edge="right foot"),
            Corner((x, 0.0), edge="right"),
            Corner((x, high), edge="top"),
            Corner((-x, high), edge="left"),
        ]
    )
    holes = tuple(
        Hole(
            "screw", (side * CLAMP_SCREW_X, high, along / 2), (0, -1, 0), METRIC[THREAD].clearance, high, True
        )
        for side in (-1, 1)
    )
    return plate(
        design,
        "lead-clamp",
        "Lead clamp",
        Extrusion(contour, along),
        holes,
        notes=(BREAK_EDGES + ", the groove's by hand, round: leads lie on it",),
        geometric=(Geometric("screw holes", "position", PLACE, ("screw",), ("A", "B", "C"), True),),
        datums=(DatumFeature("A", "top"), DatumFeature("B", FACES[0]), DatumFeature("C", "right")),
    )


def stand_off() -> Part:
    """Hexagonal stand-off, modelled as round: axis z, stud below z = 0, inner thread from its top."""
    m, r = METRIC[THREAD], FLATS / 2
    body = Revolution(
        chain([(0, -STUD), (m.d / 2, -STUD), (m.d / 2, 0), (r, 0), (r, STAND_OFF), (0, STAND_OFF)])
    )
    inner = Hole(
        "thread",
        (0, 0, STAND_OFF),
        (0, 0, -1),
        m.tap_drill,
        STAND_OFF_THREAD + m.pitch,
        False,
        thread=THREAD,
        thread_depth=STAND_OFF_THREAD,
    )
    size = f"{THREAD}x{STAND_OFF:g}"
    return Part(
        part_no=f"STAND-OFF-{size}-{STUD:g}-bolt",
        name=f"Stand-off {size}, stud {STUD:g}",
        process="bought",
        material=BRASS,
        body=body,
        features=(inner,),
        colour="#c2b280",
        purchase=Purchase(
            f"hexagonal stand-off {THREAD}, {STAND_OFF:g} mm, {FLATS:g} across flats, inner thread at least "
            f"{STAND_OFF_THREAD:g} mm, stud {THREAD} x {STUD:g}; any maker's",
            alternates="steel, same size",
        ),
        spares=1,
    )


def fitted_board(design: Design, outline: BoardOutline) -> Part:
    """The fitted board, modelled as a bare board: its components are in its own STEP file."""
    holes = tuple(
        Hole("screw", (x, y, outline.thickness), (0, 0, -1), d, outline.thickness, True)
        for x, y, d in outline.holes
    )
    return Part(
        part_no=f"{design.name}-fitted-board",
        name="Read-out board, its parts on",
        process="included",
        material=FR4,
        body=Extrusion(rectangle(0.0, 0.0, outline.width, outline.height), outline.thickness),
        features=holes,
        colour="#1f6b3a",
        purchase=Purchase("bare board and its parts stand on their own lines", alternates="none"),
    )


def lead_socket(pins: int) -> Part:
    """Socket strip that the leads are soldered to, its pins along x; z = 0 lies on the header."""
    half = pins * PITCH / 2
    return Part(
        part_no=f"SOCKET-LEADS-{pins}-strip",
        name=f"Socket of a board's leads, {pins} pins",
        process="bought",
        material=PLASTIC,
        body=Extrusion(rectangle(-half, -PITCH / 2, half, PITCH / 2), SOCKET),
        colour="#2b2b2e",
        purchase=Purchase(
            f"socket strip 2.54 mm, {pins} pins in one row, straight, solder tails; any maker's",
            manufacturer="Samtec",
            mpn=f"SSW-1{pins:02d}-01-G-S",
            alternates="two or more strips side by side",
        ),
        spares=1,
    )
