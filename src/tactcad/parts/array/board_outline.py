"""The mechanical interface of a read-out board: outline, holes, lead connector, heights.

  W = width
+-------------------------------+  y = height
| o     ::::::::::::::::      o |     leads come in over this edge
|       lead connector          |
|                               |
| o     ::::::: to the card   o |
+-------------------------------+  y = 0
x = 0
"""

from __future__ import annotations

from dataclasses import dataclass

from tactcad.design.sensing import MULTIPLEXERS

from ..bought.electronic_parts import CARD_SIGNALS, CONTROLLER_SIGNALS, converter_of
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

    holes: x, y, diameter. connector: the middle of the lead connector's row of pins, `connector_width` long;
    leads leave along `connector_direction` in the board's plane. highest: of the parts above the board,
    without plugs; lowest: of the parts below it.
    """

    width: float
    height: float
    thickness: float
    holes: tuple[tuple[float, float, float], ...]
    connector: Place
    connector_width: float
    connector_direction: Place
    highest: float
    lowest: float


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


def board_outline(layout: Layout) -> BoardOutline:
    """The outline of each board that reads the array; all are equal."""
    at = AT_CORNER
    holes = tuple((x, y, HOLE) for y in (at, HEIGHT - at) for x in (at, WIDTH - at))
    return BoardOutline(
        WIDTH,
        HEIGHT,
        THICKNESS,
        holes,
        (WIDTH / 2, HEIGHT - LEADS_FROM_EDGE),
        lead_pins(layout) * PITCH,
        (0.0, 1.0),
        HIGHEST,
        PIN_LENGTH,
    )
