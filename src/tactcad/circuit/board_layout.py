"""A board laid out and routed by construction: a cell a channel, two buses, circuits by fans; no router.

    y  10   J2: leads          +------------------------------------+
            cells, one a channel: link, three arms, switch           columns run down from the cells
            bus 1: a row a net on the lower layer                    and up from
            U2, U3                                                   the fans of multiplexer and decoder;
            U1, U4 and what is around them, upside down              through columns join both buses
            bus 2
            J1: to the card, series and pull-down resistors +--------+

A fan: pins of a circuit's left side, from the top, take columns from its left edge outwards, so that their
L-shaped tracks lie in each other and never cross. Columns lie on the upper layer, PITCH or more apart, rows
on the lower layer, ROW apart; intervals share a row where they are apart (left-edge rule). So vias' openings
in the planes never meet. Only GND and EXC are on a plane.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace

from tactcad.design.messages import CheckFailure
from tactcad.parts.array.board_plate import BOARD_OUTLINE, CARD_FROM_EDGE, LEADS_FROM_EDGE, BoardOutline
from tactcad.parts.array.board_plate import PITCH as PIN
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.leads import boards, leads
from tactcad.parts.bought.electronic_parts import converter_of

from .copper import (
    BOTTOM,
    CLEARANCE,
    PLANES,
    TOP,
    TRACK,
    VIA,
    WIDE,
    BoardCopper,
    Placed,
    Point,
    Track,
    Via,
    rounded,
)
from .footprints import Pad, footprint
from .netlist import Component, Netlist
from .read_board import OUTSIDE, board_netlist, digital_netlist

PITCH, ROW = 0.75, 0.9  # mm: vias of neighbours are 1.17 apart, their openings in the planes 1 wide
APART = 1.15  # mm between vias in one row, of one net or two
CELL = 3 * PIN  # mm
PLUS, GATE, MINUS = 3.81, 4.56, 5.31  # mm from a cell's left edge: its columns
ARMS, LEG = 1.27, 5.6  # mm: the two columns of arms
ON_PLANE = set(PLANES.values())
TIE, TIES_FROM_EDGE, TIE_APART = 2.5, 3.5, 6.0  # mm: holes in pairs, for ties 2.5 wide around the leads
LEFT = 2.5  # mm from the board's side to the first column


@dataclass(frozen=True)
class BusColumn:
    net: str
    x: float
    y: float


@dataclass
class Routing:
    """The layout so far, and the columns that wait for their bus."""

    placed: list[Placed] = field(default_factory=list)
    tracks: list[Track] = field(default_factory=list)
    vias: list[Via] = field(default_factory=list)
    columns: list[BusColumn] = field(default_factory=list)

    def path(self, net: str, *points: Point, width: float = TRACK, layer: str = TOP) -> None:
        steps = [rounded(p) for p in points]
        self.tracks += [Track(net, layer, a, b, width) for a, b in zip(steps, steps[1:]) if a != b]

    def via(self, net: str, *points: Point, width: float = WIDE) -> None:
        """At the end of a path."""
        self.path(net, *points, width=width)
        self.vias.append(Via(net, rounded(points[-1])))

    def place(self, component: Component, at: Point, turn: int = 0) -> dict[str, Point]:
        """Places of its pads, by number."""
        placed = Placed(component, rounded(at), turn)
        self.placed.append(placed)
        return {pad.number: placed.pad_at(pad) for pad in placed.footprint.pads}

    def moved(self, x: float, y: float, turned: bool = False) -> Routing:
        """The same, moved; `turned` by 180 degrees about the corner first."""
        f = -1 if turned else 1

        def at(p: Point) -> Point:
            return rounded((x + f * p[0], y + f * p[1]))

        return Routing(
            [replace(p, at=at(p.at), turn=(p.turn + 90 - 90 * f) % 360) for p in self.placed],
            [replace(t, start=at(t.start), end=at(t.end)) for t in self.tracks],
            [replace(v, at=at(v.at)) for v in self.vias],
            [BusColumn(c.net, *at((c.x, c.y))) for c in self.columns],
        )

    def extent(self) -> tuple[float, float]:
        """Lowest and highest y of its components and vias."""
        halves = [(p.at[1], p.footprint.half[0 if p.turn % 180 else 1]) for p in self.placed]
        halves += [(v.at[1], ROW - ROW / 4) for v in self.vias]
        halves += [(c.y, TRACK / 2 + CLEARANCE) for c in self.columns]
        return min(y - h for y, h in halves), max(y + h for y, h in halves)

    def add(self, other: Routing) -> None:
        for mine, new in zip(vars(self).values(), vars(other).values()):
            mine.extend(new)


def _cell(sheet: Routing, board: dict[str, Component], c: int, x0: float, pins: Sequence[Point]) -> None:
    """Channel c between its three pins and its three columns."""
    one, two, three, link = (board[f"R{10 * c + k}"] for k in (1, 2, 3, 4))
    red, plus, minus, foot = (f"CH{c}_RED", f"CH{c}_PLUS", f"CH{c}_MINUS", three.net("1"))
    y = pins[0][1]
    r1 = sheet.place(one, (x0 + ARMS, y + 6.0), 270)
    r3 = sheet.place(three, (x0 + LEG, y + 6.0), 270)
    r2 = sheet.place(two, (x0 + LEG, y + 14.2), 270)
    r4 = sheet.place(link, (x0 + 2.2, y + 11.5))
    side, branch = x0 + 0.2, y + 2.0
    sheet.path(red, pins[0], (pins[0][0], branch), r1["1"], width=WIDE)
    sheet.path(red, (pins[0][0], branch), (side, branch), (side, r4["1"][1]), r4["1"])
    sheet.path(plus, pins[1], (x0 + PLUS, r4["2"][1]))
    sheet.path(plus, (x0 + PLUS, r4["2"][1]), r4["2"])
    across = r3["1"][1] - 1.4
    sheet.path(foot, pins[2], (pins[2][0], across), (x0 + LEG, across), width=WIDE)
    sheet.path(foot, (x0 + LEG, across), r3["1"], width=WIDE)
    middle = (x0 + LEG, (r3["2"][1] + r2["1"][1]) / 2)
    sheet.path(minus, r3["2"], middle, r2["1"], width=WIDE)
    if f"Q{c}" in board:
        jog = _switch(sheet, board[f"Q{c}"], c, (x0, y), (x0 + LEG, across))
    else:
        jog = y + 22.5
        at = sheet.place(board[f"C{10 * c + 1}"], (x0 + (PLUS + MINUS) / 2, y + 20.2))
        sheet.path(minus, at["2"], (x0 + MINUS, jog))
    down = x0 + 7.1
    sheet.path(minus, middle, (down, middle[1]), (down, jog), (x0 + MINUS, jog))
    for pads, part in ((r1, one), (r2, two)):
        if part.footprint != "radial":  # a soldered pin is in the plane itself
            (x, y2) = pads["2"]
            sheet.via("EXC", (x, y2), (x, y2 + 1.3))
    sheet.columns += [BusColumn(plus, x0 + PLUS, r4["2"][1]), BusColumn(minus, x0 + MINUS, jog)]


def _switch(sheet: Routing, part: Component, c: int, corner: Point, leg: Point) -> float:
    """A channel's switch, from the leg's track to ground; and the other output's way round it."""
    x0, y = corner
    q = sheet.place(part, (x0 + GATE + 0.95, y + 20.2), 90)
    switch = {p.role: q[p.number] for p in part.pins}
    left, drain = x0 + 4.3, switch["drain"]
    sheet.path(f"CH{c}_FOOT", leg, (left, leg[1]), (left, drain[1]), drain, width=WIDE)
    x, low = switch["source"]
    sheet.via("GND", (x, low), (x, low + 1.35))
    x, at = switch["gate"]
    sheet.path(f"GATE{c}", (x, at), (x0 + GATE, at))
    sheet.columns.append(BusColumn(f"GATE{c}", x0 + GATE, at))
    return low + 2.3


@dataclass
class Strip:
    """Circuits side by side that face a bus above them; `closed` are places of the bus's other columns."""

    board: dict[str, Component]
    closed: list[tuple[float, str]]  # x and net
    x: float
    y: float  # of the circuits' middles
    sheet: Routing = field(default_factory=Routing)

    def column(self, net: str, x: float, y: float, step: float = 0.0) -> float:
        """At x, or by steps from there the first place that is open; raises ValueError if x is closed."""
        while not self.is_open(net, x):
            if not step:
                raise ValueError
            x = round(x + step, 3)
        self.closed.append((x, net))
        self.sheet.columns.append(BusColumn(net, x, y))
        return x

    def is_open(self, net: str, x: float) -> bool:
        """Vias of one net lie in one row, and so further apart."""
        return all(abs(x - other) >= (APART if net == own else PITCH) - 1e-6 for other, own in self.closed)

    def through(self, nets: Iterable[str]) -> None:
        """Columns for nets of both buses."""
        for net in nets:
            self.x = self.column(net, self.x, self.y, 0.05) + PITCH

    def _try(self, make: Callable[[Strip, float], None], reach: float) -> None:
        """The first place to the right that fits; at least `reach` from its middle to the left."""
        middle = self.x + reach
        for _ in range(400):
            trial = Strip(self.board, list(self.closed), self.x, self.y)
            try:
                make(trial, round(middle, 3))
            except ValueError:
                middle += 0.05
                continue
            if (short := self.x - trial.left()) <= 1e-6:
                break
            middle += max(0.05, 0.5 * short)
        else:
            raise CheckFailure("circuit board: no place between the columns of its bus")
        self.sheet.add(trial.sheet)
        self.closed = trial.closed
        self.x = trial.right()

    def left(self) -> float:
        return min(self._ends(-1))

    def right(self) -> float:
        return max(self._ends(1))

    def _ends(self, side: int) -> list[float]:
        ends = [c.x + side * PITCH / 2 for c in self.sheet.columns]
        for p in self.sheet.placed:
            half = p.footprint.half[1 if p.turn % 180 else 0]
            ends.append(p.at[0] + side * half)
        return [*ends, *(v.at[0] + side * VIA for v in self.sheet.vias)]

    def fan(self, name: str, caps: Sequence[str] = ()) -> None:
        """A circuit; `caps` are capacitors, each next to the first pin on its net that takes a column."""
        self._try(lambda trial, x: trial._fan(name, x, list(caps)), 3.0)

    def _fan(self, name: str, x: float, caps: list[str]) -> None:
        part = self.board[name]
        at = self.sheet.place(part, (x, self.y))
        net = {p.number: p.net for p in part.pins}
        pads = self.sheet.placed[-1].footprint.pads
        slug = next((p for p in pads if p.x == 0.0), None)
        if slug:
            self.sheet.via(net[slug.number], at[slug.number], (x, self.y + 2.6))
        for side in (-1, 1):
            row = sorted((p for p in pads if p.x * side > 0), key=lambda p: p.y)
            last, before, capped = at[row[0].number], "", False
            edge = x + side * (max(abs(p.x) + p.w / 2 for p in row) + 1.35)
            for pad in row:
                own, here = net.get(pad.number, ""), at[pad.number]
                joined, before = own and own == before, own
                if joined:
                    self.sheet.path(own, last, here)
                elif slug and own == net[slug.number]:
                    self.sheet.path(own, here, (x, here[1]), (x, self.y))
                elif own in ON_PLANE:
                    self.sheet.via(own, here, (here[0] + side * (pad.w / 2 + 0.5), here[1]), width=TRACK)
                elif own:  # pads are wider than a column, courtyards than that
                    left = len(caps)
                    edge = self._out(own, here, here[1], edge, side, caps, 0.3 if capped else 0.15)
                    capped = len(caps) < left
                last = here

    def around(self, name: str, caps: Sequence[str]) -> None:
        """A circuit with pins on four sides; `caps` as above."""
        self._try(lambda trial, x: trial._around(name, x, list(caps)), 12.0)

    def _around(self, name: str, x: float, caps: list[str]) -> None:
        """Pins of the upper side rise to columns above it, the outermost turn first; those of a side take
        columns from the circuit outwards, and beyond them those of the lower side's half. Ground goes to the
        slug, the other plane's net to a via below."""
        part = self.board[name]
        at = self.sheet.place(part, (x, self.y))
        net = {p.number: p.net for p in part.pins}
        *pads, slug = self.sheet.placed[-1].footprint.pads
        reach = max(p.x + p.w / 2 for p in pads)
        for dx in (-1.0, 1.0):
            for dy in (-1.0, 1.0):
                self.sheet.vias.append(Via(net[slug.number], rounded((x + dx, self.y + dy))))
        for side in (-1, 1):
            upper = sorted(
                (p for p in pads if p.y < -reach + p.h and p.x * side > 0), key=lambda p: p.x * side
            )
            beside = sorted((p for p in pads if p.x * side > reach - p.w), key=lambda p: p.y)
            lower = sorted(
                (p for p in pads if p.y > reach - p.h and p.x * side > 0), key=lambda p: -p.x * side
            )
            edge = self._above([p for p in upper if net[p.number]], net, at, x + side * 0.375, side, caps)
            edge = side * max(side * edge, side * x + reach + 1.35)
            turn = self.y + reach + 0.3
            for pad in (*beside, *lower):
                own, here = net[pad.number], at[pad.number]
                if own == net[slug.number]:
                    inside = (here[0], self.y) if pad in lower else (x, here[1])
                    self.sheet.path(own, here, (here[0], inside[1]), inside)
                elif own in ON_PLANE:
                    self.sheet.via(own, here, (here[0], turn), (x, self.y + reach + 1.1), width=TRACK)
                elif own:
                    y = here[1] if pad in beside else turn
                    turn += 0.0 if pad in beside else 0.4
                    edge = self._side(own, here, y, edge, side, caps)

    def _side(self, own: str, here: Point, y: float, edge: float, side: int, caps: list[str]) -> float:
        """A pin's way to its column or, if nothing else is on its net, to its capacitor."""
        if not own.startswith("REGCAP"):
            return self._out(own, here, y, edge, side, caps)
        self.sheet.path(own, here, (edge, y), (edge, y - 1.5))
        self.closed.append((edge, own))
        return self._beyond(own, edge, y, side, caps)

    def _out(
        self, own: str, here: Point, y: float, edge: float, side: int, caps: list[str], apart: float = 0.3
    ) -> float:
        """A pin's way out to the next column, `apart` further if a capacitor is next to it; and the next
        column's least place."""
        apart = apart if any(self.board[c].net("1") == own for c in caps) else 0.0
        edge = self.column(own, round(edge + side * apart, 3), y, side * 0.05)
        self.sheet.path(own, here, (here[0], y), (edge, y))
        return self._beyond(own, edge, y, side, caps)

    def _beyond(self, own: str, edge: float, y: float, side: int, caps: list[str]) -> float:
        """The next column's least place, beyond the net's capacitor if one is to be next to this one."""
        if cap := next((c for c in caps if self.board[c].net("1") == own), None):
            caps.remove(cap)
            edge = self._cap(cap, edge, y, side)
        return round(edge + side * PITCH, 3)

    def _above(
        self, pads: Sequence[Pad], net: dict[str, str], at: dict[str, Point], edge: float, side: int,
        caps: list[str],
    ) -> float:  # fmt: skip
        """Columns of the upper side's half, from the middle outwards; pins of one net are joined."""
        before, last = "", (0.0, 0.0)
        for k, pad in enumerate(pads):
            own, here = net[pad.number], at[pad.number]
            if own == before:
                ends = here[1] - pad.h / 2 - 0.2
                self.sheet.path(own, last, (last[0], ends), (here[0], ends), here)
                continue
            y = here[1] - pad.h / 2 - 0.3 - 0.4 * (len(pads) - k)
            edge = self._out(own, here, y, edge, side, caps)
            before, last = own, here
        return edge

    def _cap(self, name: str, x: float, y: float, side: int) -> float:
        """A capacitor next to a column, its other end on its plane; returns the next column's least place."""
        reach = self.footprint_reach(name)
        up = y - 1.5
        at = self.sheet.place(self.board[name], (x + side * reach, up), 0 if side > 0 else 180)
        self._plane(name, at["2"], -1)
        return round(x + side * (2 * reach + 0.55), 3)

    def footprint_reach(self, name: str) -> float:
        return footprint(self.board[name].footprint).pads[1].x

    def _plane(self, name: str, at: Point, up: int) -> None:
        pad = footprint(self.board[name].footprint).pads[0]
        self.sheet.via(self.board[name].net("2"), at, (at[0], at[1] + up * (pad.h / 2 + 0.5)))

    def two(self, name: str, turn: int = 0) -> None:
        """A component with two pins, level; a column from each, or a via to its plane below it."""
        self._try(lambda trial, x: trial._two(name, x, turn), footprint(self.board[name].footprint).half[0])

    def _two(self, name: str, x: float, turn: int) -> None:
        part = self.board[name]
        at = self.sheet.place(part, (x, self.y), turn)
        pad = footprint(part.footprint).pads[0]
        for pin in part.pins:
            here = at[pin.number]
            if pin.net in ON_PLANE:
                self.sheet.via(pin.net, here, (here[0], here[1] + pad.h / 2 + 0.5))
            else:
                self.column(pin.net, here[0], here[1])


def _rows(columns: Iterable[BusColumn]) -> dict[str, int]:
    """Each net's row on a bus, by the left-edge rule."""
    reach: dict[str, tuple[float, float]] = {}
    for c in columns:
        low, high = reach.get(c.net, (c.x, c.x))
        reach[c.net] = (min(low, c.x), max(high, c.x))
    ends: list[float] = []
    rows: dict[str, int] = {}
    for net, (low, high) in sorted(reach.items(), key=lambda item: (item[1], item[0])):
        row = next((i for i, end in enumerate(ends) if low - end >= APART), len(ends))
        ends[row : row + 1] = [high]
        rows[net] = row
    return rows


def _bus(
    sheet: Routing, columns: Sequence[BusColumn], passing: Sequence[BusColumn], rows: dict[str, int], y: float
) -> None:
    """Columns down or up to their net's row, and the row."""
    places: dict[str, set[float]] = {}
    for c in passing:
        sheet.vias.append(Via(c.net, rounded((c.x, y + ROW * rows[c.net]))))
        places.setdefault(c.net, set()).add(c.x)
    for c in columns:
        at = (c.x, y + ROW * rows[c.net])
        sheet.via(c.net, (c.x, c.y), at, width=TRACK)
        places.setdefault(c.net, set()).add(c.x)
    for net, xs in places.items():
        sheet.path(net, *((x, y + ROW * rows[net]) for x in sorted(xs)), layer=BOTTOM)


def _card(sheet: Routing, board: dict[str, Component], middle: float, y: float) -> None:
    """The connector to the card with what belongs to its pins."""
    connector = board["J1"]
    at = sheet.place(connector, (middle, y))
    beside = {"VPOS": ("D3", 270), "VNEG": ("D2", 270)}
    k = 0
    for pin in connector.pins:
        (x, _), net = at[pin.number], pin.net
        if net in ON_PLANE:
            continue
        up, end = y - 3.3, (x, y - 5.0)
        if net.endswith(OUTSIDE):
            series, down = sheet.place(board[f"R{5 + k}"], (x, up), 90), board[f"R{91 + k}"]
            sheet.path(net, at[pin.number], series["1"])
            net, k = net.removesuffix(OUTSIDE), k + 1
            sheet.path(net, series["2"], end)
            other = sheet.place(down, (x, y - 6.8), 90)
        elif net in beside:
            sheet.path(net, at[pin.number], end)
            name, turn = beside[net]
            down = board[name]
            first = net == down.net("1")
            other = sheet.place(down, (x, y - 7.4), 90 if first else 270)
        else:
            sheet.columns.append(BusColumn(net, x, y))
            continue
        near, far = ("1", "2") if down.net("1") == net else ("2", "1")
        sheet.path(net, end, other[near])
        sheet.path(net, end, (x + PIN / 2, end[1]))
        sheet.via(down.net(far), other[far], (x, other[far][1] - 1.3))
        sheet.columns.append(BusColumn(net, x + PIN / 2, end[1]))


# Of both strips in turn: parts of two pins, and circuits with the capacitors beside them. A card's amplifier
# may need no gain resistor R1.
CARD_STRIPS = "U2+C3+C4 U3+C5", "R4 C9 R3 U1+C1+C2 R1 U4+C6 C7 D1 R2 C8"
CONVERTER_STRIPS = "U1+C1+C2+C3+C4", "U4+C7 R2 C5 C8 D1 U5+C10 R3 C6 C9"


def lay_out(circuit: Netlist, outline: BoardOutline) -> BoardCopper:
    """Raises CheckFailure if the board is too small for it."""
    board = {c.designator: c for c in circuit.components}
    width, height = outline.width, outline.height
    whole, lead_pins = Routing(), footprint(board["J2"].footprint).pads
    pins = whole.place(board["J2"], (width / 2, LEADS_FROM_EDGE))
    x0 = width / 2 + lead_pins[0].x - PIN / 2
    for c in range(1, len(lead_pins) // 3 + 1):
        _cell(whole, board, c, x0 + (c - 1) * CELL, [pins[str(3 * c - 2 + i)] for i in range(3)])
    card = Routing()
    _card(card, board, width / 2, 0.0)
    selecting, reading, passing = _strips(board, width, whole.columns, card.columns)

    upper_rows = _rows([*whole.columns, *selecting.columns, *passing])
    first = whole.extent()[1] + ROW / 2
    selecting = selecting.moved(0.0, first + ROW * (max(upper_rows.values()) + 0.5) - selecting.extent()[0])
    reading = reading.moved(width, selecting.extent()[1] + reading.extent()[1], turned=True)
    lower_rows = _rows([*reading.columns, *card.columns, *passing])
    second = reading.extent()[1] + ROW / 2
    needed = second + ROW * (max(lower_rows.values()) + 0.5) - card.extent()[0] + CARD_FROM_EDGE
    if needed > height:
        raise CheckFailure(f"circuit board: {circuit.name} needs a height of {needed:.1f} mm, not {height:g}")
    card = card.moved(0.0, height - CARD_FROM_EDGE)
    _bus(whole, [*whole.columns, *selecting.columns], passing, upper_rows, first)
    _bus(whole, [*reading.columns, *card.columns], passing, lower_rows, second)
    for p in passing:
        ends = [(p.x, y + ROW * rows[p.net]) for y, rows in ((first, upper_rows), (second, lower_rows))]
        whole.path(p.net, *ends)
    for part in (selecting, reading, card):
        whole.add(part)
    ties = ((width * f + s * TIE_APART / 2, TIES_FROM_EDGE, TIE) for f in (0.25, 0.5, 0.75) for s in (-1, 1))
    holes = (*((x, height - y, d) for x, y, d in outline.holes), *ties)
    return BoardCopper(
        circuit, width, height, tuple(whole.placed), tuple(whole.tracks), tuple(whole.vias), holes
    )


def _strips(
    board: dict[str, Component], width: float, cells: list[BusColumn], card: list[BusColumn]
) -> tuple[Routing, Routing, list[BusColumn]]:
    """Multiplexer and decoder, or the converter; amplifier and supplies; columns through both buses. All by
    their middles, the second yet to be turned."""
    strips = CARD_STRIPS if "U2" in board else CONVERTER_STRIPS
    chosen, read = ([part.split("+") for part in strip.split()] for strip in strips)
    through = Strip(board, [(c.x, c.net) for c in (*cells, *card)], LEFT, 0.0)
    through.through(_nets_of_both(board, sum(chosen, [])))
    passing = through.sheet.columns
    selecting = Strip(board, [(c.x, c.net) for c in (*cells, *passing)], through.x, 0.0)
    for name, *beside in chosen:
        place = selecting.fan if strips is CARD_STRIPS else selecting.around
        place(name, beside)
    reading = Strip(board, [(width - c.x, c.net) for c in (*card, *passing)], LEFT, 0.0)
    for name, *beside in read:
        if beside:
            reading.fan(name, beside)
        elif name in board:
            reading.two(name)
    for strip, most in ((selecting, width - LEFT), (reading, width - through.x)):
        if strip.x > most:
            raise CheckFailure(f"circuit board: too narrow by {strip.x - most:.1f} mm")
    return selecting.sheet, reading.sheet, passing


def _nets_of_both(board: dict[str, Component], selecting: Sequence[str]) -> list[str]:
    upper = {p.net for n in selecting for p in board[n].pins}
    upper |= {p.net for c in board.values() if c.kind == "switch" for p in c.pins}
    lower = {
        p.net
        for n, c in board.items()
        if n not in (*selecting, "J2") and c.kind != "switch" and not _of_cell(n)
        for p in c.pins
    }
    return sorted((upper & lower) - ON_PLANE - {""})


def _of_cell(name: str) -> bool:
    return name[0] in "RC" and 10 < int(name[1:]) < 90


def netlist_of_board(layout: Layout, used: int) -> Netlist:
    """Netlist of the board for so many elements: with amplifier and card, or with a converter."""
    converter = converter_of(layout.design)
    if converter:
        return digital_netlist(layout, converter, used)
    return board_netlist(layout.design, used, leads(layout))


def laid_out(layout: Layout) -> tuple[BoardCopper, ...]:
    """One for each number of elements that a board reads, the largest first. Raises CheckFailure if the
    outline is too small."""
    used = sorted({len(board.places) for board in boards(layout)}, reverse=True)
    return tuple(lay_out(netlist_of_board(layout, n), BOARD_OUTLINE) for n in used)
