"""Boards and leads: the board of each element, its place next to the array on its back, and the path of each
element's leads: from the terminal on the floor of its wire recess to the rear end, to the tie around the
leads of its board, to the clamp on the board's plate, to the board's socket.

    gauge           recess                          rear end      tie       clamp   connector
    =====----.                                                    .---------[##]----[]
             |  o_________///bonded: strain relief ____________.'
    hinge       terminal                            gather          to board
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import ceil, dist, hypot, sqrt

from tactcad.design.sensing import WIRES

from ..language.description import Vector
from .board_plate import CLAMP_AHEAD, EDGE, PLATE, PLATE_AHEAD, WIDTH, channels_of, socket_top
from .layout import ElementPlace, Layout

# Codes of IEC 60757. Red and white are both soldered to the gauge's first tab, black to its second, as in
# strain gauge practice; of two wires there is no white one.
COLOURS = {"three-wire": ("RD", "WH", "BK"), "two-wire": ("RD", "BK")}
AHEAD_OF_LEADS = 0.5  # terminals behind the recess's wall, mm; chosen: a tool to press them down
WHOLE = 5.0  # mm, step of the leads' lengths; chosen: the reading of a ruler
BESIDE = 10.0  # mm between boards, and from the array to a plate; chosen: fingers
LAST = hypot(CLAMP_AHEAD, socket_top() - PLATE)  # mm from the clamp to the socket's tails
NEAR = 300.0  # mm; chosen: boards are within a hand's reach, and longer leads hang in a loop


@dataclass(frozen=True)
class LeadRoute:
    """The way of one element's leads, mm in the array's frame, what hangs in a loop, and what each is cut
    to."""

    place: ElementPlace
    points: tuple[Vector, ...]
    loop: float
    cut: float

    @property
    def length(self) -> float:
        """mm, without slack."""
        return self.loop + sum(dist(a, b) for a, b in zip(self.points, self.points[1:]))


def lead_routes(layout: Layout) -> tuple[LeadRoute, ...]:
    """Every element's leads, by number."""
    stood = zip(boards(layout), stands(layout))
    found = [_route(layout, board, stand, place) for board, stand in stood for place in board.places]
    return tuple(sorted(found, key=lambda route: route.place.number))


@dataclass(frozen=True)
class BoardStand:
    """The middle of a board's lead connector, mm in the array's frame: |x|, y; on the side of row one (1) or
    row two (-1)."""

    side: float
    x: float
    y: float


def stands(layout: Layout) -> tuple[BoardStand, ...]:
    """Places of all boards, by number: a row's boards side by side along it, about the middle of their
    elements, at a distance of wiring.to_board from tie to connector."""
    w, found = layout.design.wiring, []
    along = min(w.to_board, NEAR) - LAST
    run = sqrt(max(along**2 - _drop(layout) ** 2, 0.0))
    x = layout.rear_end + w.gather + run + CLAMP_AHEAD
    for row, side in ((1, 1.0), (2, -1.0)):
        own = [b for b in boards(layout) if b.places[0].row == row]
        ends = [p.y for b in own for p in (b.places[0], b.places[-1])]
        for n in range(len(own)):
            off = (n - (len(own) - 1) / 2) * (WIDTH + 2 * EDGE + BESIDE)
            found.append(BoardStand(side, round(x, 6), round((min(ends) + max(ends)) / 2 + off, 6)))
    return tuple(found)


def least_to_board(layout: Layout) -> float:
    """mm: no board's plate overlaps the array, and the tie is in front of the plate."""
    over = layout.carrier_length / 2 + BESIDE - layout.rear_end - layout.design.wiring.gather
    least = LAST + hypot(max(over, 0.0) + PLATE_AHEAD - CLAMP_AHEAD, _drop(layout))
    return ceil(10 * least - 1e-6) / 10


@dataclass(frozen=True)
class Bench:
    """Boards on the bench beside a rig's base plate, the array over this: the longest level way from a tie to
    its lead clamp, mm, and how high the board plates are raised so that wiring.to_board reaches."""

    run: float
    block: float

    @property
    def least(self) -> float:
        """Of wiring.to_board, mm, with plates as high as the leads."""
        return ceil(10 * (LAST + self.run) - 1e-6) / 10


def on_bench(layout: Layout, edge: float, high: float, aside: tuple[float, float] = (0.0, 0.0)) -> Bench:
    """Boards side by side as in `stands`, BESIDE off the base plate's ends, mm.

    edge   of the base plate, from the array's middle along x
    high   leads in their recess over the bench
    aside  that the array is moved along x and y, at most
    """
    w, runs = layout.design.wiring, []
    x = edge + BESIDE + PLATE_AHEAD - CLAMP_AHEAD - layout.rear_end - w.gather + aside[0]
    for board, stand in zip(boards(layout), stands(layout)):
        runs.append(hypot(x, abs(stand.y - _middle(board)) + aside[1]))
    run = max(runs)
    along = max(w.to_board - LAST, run)
    return Bench(run, float(ceil(max(0.0, high - PLATE - sqrt(along**2 - run**2)))))


def _middle(board: ReadBoard) -> float:
    """y at which a board's leads are tied, mm."""
    return (board.places[0].y + board.places[-1].y) / 2


def _drop(layout: Layout) -> float:
    """From the leads in their recess to the clamp's groove, mm; the array lies on its back."""
    return carrier_top(layout) - PLATE - layout.design.element.recess_depth


def carrier_top(layout: Layout) -> float:
    """z of the bench on which the array lies on its back, mm."""
    return round(layout.carrier_bottom + layout.design.clamp.carrier_thickness, 9)


def _route(layout: Layout, board: ReadBoard, stand: BoardStand, place: ElementPlace) -> LeadRoute:
    d, side = layout.design, stand.side
    terminal, recess = layout.recess_start + AHEAD_OF_LEADS, d.element.recess_depth
    middle = _middle(board)
    tie = layout.rear_end + d.wiring.gather
    points = (
        (side * terminal, place.y, recess),
        (side * layout.rear_end, place.y, recess),
        (side * tie, middle, recess),
        (side * (stand.x - CLAMP_AHEAD), stand.y, carrier_top(layout) - PLATE),
        (side * stand.x, stand.y, carrier_top(layout) - socket_top()),
    )
    way = LeadRoute(place, points, max(0.0, d.wiring.to_board - NEAR), 0.0)
    return replace(way, cut=WHOLE * ceil(way.length * (1 + d.wiring.slack) / WHOLE - 1e-9))


def recess_length(layout: Layout) -> float:
    """Length of the wire recess, mm."""
    return layout.rear_end - layout.recess_start


def colours(layout: Layout) -> tuple[str, ...]:
    """Colours of each gauge's leads, in their order."""
    return COLOURS[layout.design.readout.connection]


def leads(layout: Layout) -> int:
    """Number of leads of each gauge."""
    return len(colours(layout))


def longest_lead_resistance(layout: Layout) -> float:
    """Resistance of the longest lead, ohm."""
    return max(route.cut for route in lead_routes(layout)) * lead_ohm(layout)


def lead_ohm(layout: Layout) -> float:
    """Resistance of a millimetre of lead, ohm."""
    return WIRES[layout.design.wiring.wire].ohm_per_metre * 1e-3


@dataclass(frozen=True)
class ReadBoard:
    """A board by its number from 1, and its elements in the order of the multiplexer's channels."""

    number: int
    places: tuple[ElementPlace, ...]


def boards(layout: Layout) -> tuple[ReadBoard, ...]:
    """Every board of the array."""
    channels = channels_of(layout)
    taken = []
    for row in (1, 2):
        own = [p for p in layout.elements if p.row == row]
        taken += [tuple(own[i : i + channels]) for i in range(0, len(own), channels)]
    return tuple(ReadBoard(number, places) for number, places in enumerate(taken, start=1))
