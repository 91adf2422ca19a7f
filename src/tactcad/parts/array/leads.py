"""Boards and leads: which element is read by which board, and the way of each element's leads: from the
terminal on the floor of its wire recess to the rear end, to the tie around the leads of its board, to the
board.

    gauge           recess                          rear end      tie           connector
    =====----.                                                    .-----------[]
             |  o_________///bonded: strain relief ____________.'
    hinge       terminal                            gather          to board
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, dist

from tactcad.design.sensing import MULTIPLEXERS, WIRES

from ..bought.electronic_parts import converter_of
from ..language.description import Vector
from .layout import ElementPlace, Layout

# Codes of IEC 60757. Red and white are both soldered to the gauge's first tab, black to its second, as in
# strain gauge practice; of two wires there is no white one.
COLOURS = {"three-wire": ("RD", "WH", "BK"), "two-wire": ("RD", "BK")}
AHEAD_OF_LEADS = 0.5  # terminals behind the recess's wall, mm; chosen: a tool to press them down
WHOLE = 5.0  # leads are cut to whole steps of so many mm; chosen: what a rule is read to


@dataclass(frozen=True)
class LeadRoute:
    """The way of one element's leads, mm in the scene's frame, and what each is cut to."""

    place: ElementPlace
    points: tuple[Vector, ...]
    cut: float

    @property
    def length(self) -> float:
        """mm, without slack."""
        return sum(dist(a, b) for a, b in zip(self.points, self.points[1:]))


def lead_routes(layout: Layout) -> tuple[LeadRoute, ...]:
    """Every element's leads, by number."""
    found = [_route(layout, board, place) for board in boards(layout) for place in board.places]
    return tuple(sorted(found, key=lambda route: route.place.number))


def _route(layout: Layout, board: ReadBoard, place: ElementPlace) -> LeadRoute:
    d, side = layout.design, 1.0 if place.row == 1 else -1.0
    terminal, recess = layout.recess_start + AHEAD_OF_LEADS, d.element.recess_depth
    middle = (board.places[0].y + board.places[-1].y) / 2
    tie = layout.rear_end + d.wiring.gather
    points = (
        (side * terminal, place.y, recess),
        (side * layout.rear_end, place.y, recess),
        (side * tie, middle, recess),
        (side * (tie + d.wiring.to_board), middle, recess),
    )
    way = LeadRoute(place, points, 0.0).length
    return LeadRoute(place, points, WHOLE * ceil(way * (1 + d.wiring.slack) / WHOLE - 1e-9))


def recess_length(layout: Layout) -> float:
    """Of the wire recess, mm."""
    return layout.rear_end - layout.recess_start


def colours(layout: Layout) -> tuple[str, ...]:
    """Of each gauge's leads, in their order."""
    return COLOURS[layout.design.readout.connection]


def leads(layout: Layout) -> int:
    """How many each gauge has."""
    return len(colours(layout))


def longest_lead_resistance(layout: Layout) -> float:
    """Of one lead, ohm."""
    return max(route.cut for route in lead_routes(layout)) * lead_ohm(layout)


def lead_ohm(layout: Layout) -> float:
    """Of a millimetre of lead."""
    return WIRES[layout.design.wiring.wire].ohm_per_metre * 1e-3


@dataclass(frozen=True)
class ReadBoard:
    """A board by its number from 1, and its elements in the order of the multiplexer's channels."""

    number: int
    places: tuple[ElementPlace, ...]


def channels_of(layout: Layout) -> int:
    """Of a board: of its multiplexer, or of the converter that takes the bridges themselves."""
    converter = converter_of(layout.design)
    return converter.inputs if converter else MULTIPLEXERS[layout.design.readout.multiplexer].channels


def boards(layout: Layout) -> tuple[ReadBoard, ...]:
    """Every board of the array."""
    channels = channels_of(layout)
    taken = []
    for row in (1, 2):
        own = [p for p in layout.elements if p.row == row]
        taken += [tuple(own[i : i + channels]) for i in range(0, len(own), channels)]
    return tuple(ReadBoard(number, places) for number, places in enumerate(taken, start=1))
