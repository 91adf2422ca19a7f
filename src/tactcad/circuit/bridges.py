"""The array's circuit: a quarter bridge an element, a switch in its return, and boards that read them.

EXC ---+-----------+           One board: the multiplexer leads the bridge that the address names, + and -,
    R.1|        R.2|           to the amplifier, whose output is a differential input of the card; with
       +--W.1      +--- -      ENABLE the decoder closes that bridge's switch. So one gauge of a board is
          |                    warm at a time, and a switch carries one bridge's current.
    B  .--+--W.2------- +
    (gauge)                    Three wires: W.1 lies in one arm and W.3 in the next, so that their
       '--+--W.3--+  R.3       resistance cancels; W.2 carries no current. Two wires: W.1 and W.2 both
                  +---+        lie in the gauge's arm.
                  Q
                 GND
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from tactcad.design.sensing import AMPLIFIERS, MULTIPLEXERS, SWITCHES, WIRES
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.leads import LeadRoute, ReadBoard, boards, colours, lead_ohm, lead_routes, leads
from tactcad.parts.bought.electronic_parts import (
    COMPLETION,
    DECOUPLING,
    GAIN_RESISTOR,
    GAUGE,
    RESERVOIR,
    TERMINAL,
    TO_CARD,
    TO_LEADS,
    completion_resistance,
    gain_resistance,
    lead_part,
    set_gain,
)

from .netlist import GROUND, Component, Kind, Netlist, Pin

EXCITATION, POSITIVE, NEGATIVE, LOGIC = "EXC", "VPOS", "VNEG", "V5"
# Of the 74HC238 (from memory of its sheet): address, outputs in order, enables.
DECODER_ADDRESS, DECODER_OUTPUTS = ("1", "2", "3"), ("15", "14", "13", "12", "11", "10", "9", "7")


def netlist(layout: Layout) -> Netlist:
    """The whole circuit of the array."""
    r = layout.design.readout
    routes = {route.place.number: route for route in lead_routes(layout)}
    components: list[Component] = []
    for board in boards(layout):
        components += _board(layout, board)
        for channel, place in enumerate(board.places):
            components += _bridge(layout, board, channel, routes[place.number])
    supplies = ((POSITIVE, r.supply_positive), (NEGATIVE, r.supply_negative), (LOGIC, 5.0))
    return Netlist(layout.design.name, r.excitation, supplies, tuple(components))


def _two(
    designator: str, kind: Kind, value: str, part_no: str, nets: tuple[str, str], **figures: float
) -> Component:
    """A component with two pins."""
    pins = (Pin("1", "1", nets[0]), Pin("2", "2", nets[1]))
    return Component(designator, kind, value, part_no, pins, tuple(figures.items()))


def gate(board: ReadBoard, channel: int) -> str:
    return f"GATE{board.places[channel].number}"


def _bridge(layout: Layout, board: ReadBoard, channel: int, route: LeadRoute) -> Iterator[Component]:
    d, n = layout.design, route.place.number
    switch = SWITCHES[d.readout.switch]
    top, bottom, foot = f"E{n}_TOP", f"E{n}_BOTTOM", f"E{n}_FOOT"
    plus, minus, red = f"E{n}_PLUS", f"E{n}_MINUS", f"E{n}_RED"
    three = leads(layout) == 3
    if not three:
        red = plus
    arm, lead = completion_resistance(d), route.cut * lead_ohm(layout)
    wires = ((top, red), (top, plus), (bottom, foot)) if three else ((top, red), (bottom, foot))

    def own(component: Component) -> Component:
        return replace(component, element=n, board=board.number)

    ohm = d.gauge.resistance
    yield own(_two(f"B{n}", "gauge", f"{ohm:g} ohm", GAUGE, (top, bottom), ohm=ohm))
    yield own(_two(f"X{n}", "terminal", "solder terminals", TERMINAL, (top, bottom)))
    for k, (nets, colour) in enumerate(zip(wires, colours(layout), strict=True), start=1):
        value = f"{WIRES[d.wiring.wire].name}, {route.cut:g} mm"
        yield own(_two(f"W{10 * n + k}", "lead", value, lead_part(colour), nets, ohm=lead, mm=route.cut))
    for k, nets in enumerate(((EXCITATION, red), (EXCITATION, minus), (minus, foot)), start=1):
        yield own(_two(f"R{10 * n + k}", "resistor", f"{arm:g} ohm", COMPLETION, nets, ohm=arm))
    on = {"gate": gate(board, channel), "source": GROUND, "drain": foot}
    pins = tuple(Pin(switch.pins[role], role, net) for role, net in on.items())
    yield own(Component(f"Q{n}", "switch", switch.name, switch.mpn, pins, (("ohm", switch.on_ohm),)))


def _board(layout: Layout, board: ReadBoard) -> Iterator[Component]:
    """What a board carries once, and its connectors."""
    bridges = [(f"E{p.number}_PLUS", f"E{p.number}_MINUS") for p in board.places]
    b = board.number
    out, enable = f"OUT{b}", f"ENABLE{b}"
    parts = [*_amplifier(layout, b, out), _multiplexer(layout, b, bridges)]
    parts.append(_decoder(layout, board, enable))
    rails = (POSITIVE, NEGATIVE, POSITIVE, NEGATIVE, LOGIC, EXCITATION)
    for k, rail in enumerate(rails, start=1):
        parts.append(_two(f"C{10 * b + k}", "capacitor", "100 nF", DECOUPLING, (rail, GROUND), farad=1e-7))
    parts.append(_two(f"C{10 * b + 7}", "capacitor", "10 uF", RESERVOIR, (EXCITATION, GROUND), farad=1e-5))
    address = [f"A{i}" for i in range(len(MULTIPLEXERS[layout.design.readout.multiplexer].address))]
    card = [EXCITATION, GROUND, POSITIVE, NEGATIVE, LOGIC, *address, enable, out, GROUND]
    parts.append(_connector(f"J{10 * b + 1}", TO_CARD, card))
    ends = ("RED", "PLUS", "FOOT") if leads(layout) == 3 else ("PLUS", "FOOT")
    pins = [f"E{p.number}_{end}" for p in board.places for end in ends]
    spare = MULTIPLEXERS[layout.design.readout.multiplexer].channels - len(board.places)
    pins += [""] * (spare * len(ends))  # open: all boards have the same header
    parts.append(_connector(f"J{10 * b + 2}", TO_LEADS, pins))
    return (replace(part, board=b) for part in parts)


def _amplifier(layout: Layout, b: int, out: str) -> Iterator[Component]:
    d, amplifier = layout.design, AMPLIFIERS[layout.design.readout.amplifier]
    resistance = gain_resistance(d)
    strapped = amplifier.gains and d.readout.gain == max(amplifier.gains)
    first = f"GAIN{b}" if resistance or strapped else ""
    second = f"GAIN{b}B" if resistance else first
    nets = {
        "rg1": first,
        "minus": f"IN{b}_MINUS",
        "plus": f"IN{b}_PLUS",
        "negative": NEGATIVE,
        "ref": GROUND,
        "out": out,
        "positive": POSITIVE,
        "rg2": second,
    }
    pins = tuple(Pin(amplifier.pins[role], role, net) for role, net in nets.items())
    gain = set_gain(d)
    figures = (
        ("gain", gain),
        ("noise", amplifier.noise_density(gain)),
        ("bandwidth", amplifier.bandwidth(gain)),
    )
    value = f"{amplifier.name}, gain {gain:.6g}"
    yield Component(f"U{10 * b + 1}", "amplifier", value, amplifier.mpn, pins, figures)
    if resistance:
        yield _two(
            f"R{10 * b}", "resistor", f"{resistance:g} ohm", GAIN_RESISTOR, (first, second), ohm=resistance
        )


def _multiplexer(layout: Layout, b: int, bridges: list[tuple[str, str]]) -> Component:
    """Enabled always: so the amplifier's inputs hang on the addressed bridge, which no open switch cuts off
    its supply, and never float."""
    part = MULTIPLEXERS[layout.design.readout.multiplexer]
    nets = {
        "out_a": f"IN{b}_PLUS",
        "out_b": f"IN{b}_MINUS",
        "enable": LOGIC,
        "positive": POSITIVE,
        "negative": NEGATIVE,
        "ground": GROUND,
    }
    pins = [Pin(part.pins[role], role, net) for role, net in nets.items()]
    pins += [Pin(number, f"A{i}", f"A{i}") for i, number in enumerate(part.address)]
    for i, (a, c) in enumerate(zip(part.inputs_a, part.inputs_b), start=1):
        plus, minus = bridges[i - 1] if i <= len(bridges) else (GROUND, GROUND)  # none floats
        pins += [Pin(a, f"S{i}A", plus), Pin(c, f"S{i}B", minus)]
    return Component(
        f"U{10 * b + 2}", "multiplexer", part.name, part.mpn, tuple(pins), (("ohm", part.on_ohm),)
    )


def _decoder(layout: Layout, board: ReadBoard, enable: str) -> Component:
    part = MULTIPLEXERS[layout.design.readout.multiplexer]
    lines = len(part.address)
    pins = [
        Pin(number, f"A{i}", f"A{i}" if i < lines else GROUND) for i, number in enumerate(DECODER_ADDRESS)
    ]
    pins += [Pin("4", "E1", GROUND), Pin("5", "E2", GROUND), Pin("6", "E3", enable)]
    for i, number in enumerate(DECODER_OUTPUTS):
        pins.append(Pin(number, f"Y{i}", gate(board, i) if i < len(board.places) else ""))
    pins += [Pin("8", "ground", GROUND), Pin("16", "positive", LOGIC)]
    return Component(f"U{10 * board.number + 3}", "decoder", part.decoder, part.decoder, tuple(pins))


def _connector(designator: str, part_no: str, nets: list[str]) -> Component:
    pins = tuple(Pin(str(i), f"{i} {net}".rstrip(), net) for i, net in enumerate(nets, start=1))
    return Component(designator, "connector", f"{len(nets)} pins", part_no, pins)
