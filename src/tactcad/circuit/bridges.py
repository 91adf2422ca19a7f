"""The array's circuit: its boards (read_board.py), with gauges, terminals and leads.

    B  .--+--W.1------- RED         Three wires: W.1 lies in one arm and W.3 in the next, so that their
  gauge   '--W.2------- PLUS        resistance cancels; W.2 carries no current. Two wires: W.1 and W.2 both
       '-----W.3------- FOOT        lie in the gauge's arm, and RED is joined to PLUS on the board.

That is with amplifier and card; with a converter (read_board.py) no switch is in the way, and FOOT is
ground.

With ENABLE the decoder closes the switch of the channel that the address names, and the multiplexer leads
that bridge to the amplifier: so one gauge of a board is warm at a time, and a switch carries one bridge's
current.

Boards are A1, A2 and on: A2-R11 is R11 as printed on the second. Nets of an element's bridge begin with its
number, those of a board's own with the board's; supplies, ground and the address are common.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from tactcad.design.sensing import WIRES
from tactcad.parts.array.converter_figures import bridge_supply
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.leads import LeadRoute, ReadBoard, boards, colours, lead_ohm, lead_routes, leads
from tactcad.parts.bought.electronic_parts import GAUGE, TERMINAL, converter_of, lead_part

from .board_layout import netlist_of_board
from .netlist import GROUND, Component, Netlist
from .read_board import LOGIC, NEGATIVE, OUTPUT, OUTSIDE, POSITIVE, two

COMMON = {GROUND, POSITIVE, NEGATIVE, LOGIC}
EXCITATION = "EXC"


def netlist(layout: Layout) -> Netlist:
    """The whole circuit of the array."""
    r, converter = layout.design.readout, converter_of(layout.design)
    routes = {route.place.number: route for route in lead_routes(layout)}
    components: list[Component] = []
    for board in boards(layout):
        own = netlist_of_board(layout, len(board.places))
        components += (_of_board(board, c) for c in own.components)
        for place in board.places:
            components += _at_array(layout, board, routes[place.number])
    supplies = ((POSITIVE, r.supply_positive), (NEGATIVE, r.supply_negative), (LOGIC, 5.0))
    volts = bridge_supply(layout) if converter else r.excitation
    return Netlist(layout.design.name, volts, supplies[:1] if converter else supplies, tuple(components))


def _of_board(board: ReadBoard, c: Component) -> Component:
    """A component of a board, with its name and nets in the array's circuit."""
    pins = tuple(replace(p, net=array_net(board, p.net)) for p in c.pins)
    channel = _channel(c)
    element = board.places[channel - 1].number if 0 < channel <= len(board.places) else 0
    return replace(
        c, designator=f"A{board.number}-{c.designator}", pins=pins, element=element, board=board.number
    )


def _channel(c: Component) -> int:
    """A component's channel; 0 for none."""
    number = int(c.designator[1:])
    if c.kind == "switch":
        return number
    return number // 10 if c.kind in ("resistor", "capacitor") and 10 < number < 90 else 0


def array_net(board: ReadBoard, net: str) -> str:
    """A board's net in the array's circuit."""
    if not net or net in COMMON:
        return net
    outside = net.removesuffix(OUTSIDE)
    if outside != net:  # a line of the card: the address is common, each board has its ENABLE
        return f"{outside}{board.number}" if outside in ("ENABLE", "CS") else outside
    head, _, tail = net.partition("_")
    number = head.removeprefix("CH" if tail else "GATE")
    if number != head and int(number) <= len(board.places):
        element = board.places[int(number) - 1].number
        return f"E{element}_{tail or 'GATE'}"
    return f"{net}{board.number}" if net in (EXCITATION, "OUT", OUTPUT) else f"A{board.number}_{net}"


def _at_array(layout: Layout, board: ReadBoard, route: LeadRoute) -> Iterator[Component]:
    """An element's gauge, terminals and leads."""
    d, n = layout.design, route.place.number
    top, bottom = f"E{n}_TOP", f"E{n}_BOTTOM"
    lead, ohm = route.cut * lead_ohm(layout), d.gauge.resistance
    ends = ("RED", "PLUS", "FOOT") if leads(layout) == 3 else ("RED", "FOOT")
    foot = GROUND if converter_of(d) else f"E{n}_FOOT"
    parts = [
        two(f"B{n}", "gauge", f"{ohm:g} ohm", GAUGE, (top, bottom), ohm=ohm),
        two(f"X{n}", "terminal", "solder terminals", TERMINAL, (top, bottom)),
    ]
    for k, (end, colour) in enumerate(zip(ends, colours(layout), strict=True), start=1):
        value = f"{WIRES[d.wiring.wire].name}, {route.cut:g} mm"
        nets = (bottom, foot) if end == "FOOT" else (top, f"E{n}_{end}")
        parts.append(two(f"W{10 * n + k}", "lead", value, lead_part(colour), nets, ohm=lead, mm=route.cut))
    return (replace(part, element=n, board=board.number) for part in parts)
