"""The board that a row of elements is read by: bought made to the netlist, large enough for its parts.

Its parts are too fine for strip board: the circuits come with leads 0.65 to 1.27 mm apart.
"""

from __future__ import annotations

from math import ceil

from tactcad.design.electronics import COMPLETIONS, MULTIPLEXERS
from tactcad.design.tree import Design

from .electronic_parts import CARD_SIGNALS, ON_SUPPLIES, gain_resistance
from .lead_route import COLOURS

PITCH = 2.54  # of the headers' pins, mm
# mm2 with pads and the room that an iron takes around them; chosen: bodies by JEDEC and EIA, 1 mm around.
ROOM = {
    "radial": 40.0,
    "0805": 15.0,
    "1206": 18.0,
    "SOT-23": 16.0,
    "SOIC-8": 42.0,
    "SO16": 77.0,
    "TSSOP-28": 88.0,
    "pin": 3 * PITCH,
}
PARTS_SHARE = 0.5  # of the board that parts take; chosen: the other half for tracks and corners' holes
EDGE = 5.0  # mm from a header's end to the board's edge; chosen: a corner's hole of M3 beside it
WHOLE = 5.0  # mm, the board's sides are whole steps of; chosen: so that nobody asks about tenths


def header_pins(design: Design) -> tuple[int, int]:
    """Pins of a board's header for leads, and of that to the converter's card."""
    part = MULTIPLEXERS[design.readout.multiplexer]
    return len(COLOURS[design.readout.connection]) * part.channels, CARD_SIGNALS + len(part.address)


def board_size(design: Design) -> tuple[float, float]:
    """Length and width that a board needs at least, mm: all channels of its multiplexer are on it."""
    r, pins = design.readout, header_pins(design)
    channel = 3 * ROOM[COMPLETIONS[r.completion].package] + ROOM["SOT-23"]
    circuits = ROOM["SOIC-8"] + ROOM["TSSOP-28"] + ROOM["SO16"]
    small = (ON_SUPPLIES + 1 + (gain_resistance(design) is not None)) * ROOM["0805"] + ROOM["1206"]
    area = MULTIPLEXERS[r.multiplexer].channels * channel + circuits + small + sum(pins) * ROOM["pin"]
    length = _whole(max(max(pins) * PITCH + 2 * EDGE, (area / PARTS_SHARE) ** 0.5))
    return length, _whole(area / PARTS_SHARE / length)


def _whole(mm: float) -> float:
    return WHOLE * ceil(mm / WHOLE)
