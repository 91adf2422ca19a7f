"""The netlist's files: as KiCad reads it (S-expressions, version E, as eeschema of KiCad 6 and later writes
them), as a SPICE deck, as a list of leads, as a table of pins, and as the harness.

The deck is for ngspice: every element is read in turn, and the deck prints its bridge's and its amplifier's
output. Switches are resistors, open at OPEN; an amplifier is its gain behind a resistor without current whose
Johnson noise is the amplifier's own, and one pole at its bandwidth. Logic is left out: the deck's commands
close the switches as the decoder would. If a converter reads the bridges, all are on: the deck prints each
one's output, and its share of the bridges' supply, which the converter takes for its reference; its pins are
open.

The list of leads runs from terminal to connector: colour, gauge of wire, cut length, bundle. The harness has
every wire with both its ends: leads from the array to the boards, with shield and the array's metal; cables
from the boards to the converter's card and the supplies; what each wire carries, and each supply in all.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from math import pi
from uuid import NAMESPACE_OID, uuid5

from tactcad.design.files import as_csv
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.leads import boards, colours
from tactcad.parts.bought.electronic_parts import TO_CARD

from .netlist import GROUND, Component, Netlist

PASSIVE = ("lead", "terminal", "gauge", "resistor", "capacitor", "connector", "diode")
Expression = str | tuple


def kicad_bytes(netlist: Netlist, title: str, company: str | None, date: str, revision: str) -> bytes:
    """The file (UTF-8); `date` of issue, so that equal designs give equal bytes."""
    # with all that eeschema writes there: readers require it
    comments = (("comment", ("number", str(i)), ("value", "")) for i in range(1, 10))
    texts = (
        ("title", title),
        ("company", *([company] if company else [])),
        ("rev", revision),
        ("date", date),
        ("source", netlist.name),
    )
    block = ("title_block", *texts, *comments)
    sheet = ("sheet", ("number", "1"), ("name", "/"), ("tstamps", "/"), block)
    head = ("design", ("source", netlist.name), ("date", date), ("tool", "tactcad"), sheet)
    kinds = {c.part_no: c for c in reversed(netlist.components)}
    parts = tuple(_part(kinds[name]) for name in sorted(kinds))
    nets = tuple(
        (
            "net",
            ("code", str(code)),
            ("name", f"/{name}"),
            *(
                ("node", ("ref", c.designator), ("pin", pin.number), ("pinfunction", pin.role))
                for c, pin in nodes
            ),
        )
        for code, (name, nodes) in enumerate(sorted(netlist.nets.items()), start=1)
    )
    components = tuple(_component(netlist, c) for c in netlist.components)
    whole = (
        "export",
        ("version", "E"),
        head,
        ("components", *components),
        ("libparts", *parts),
        ("libraries",),
        ("nets", *nets),
    )
    return (_text(whole, 0) + "\n").encode()


def _component(netlist: Netlist, c: Component) -> Expression:
    own = str(uuid5(NAMESPACE_OID, f"{netlist.name}/{c.designator}"))
    return (
        "comp",
        ("ref", c.designator),
        ("value", c.value),
        *([("footprint", f"tactcad:{c.footprint}")] if c.footprint else []),
        (
            "fields",
            ("field", ("name", "part_no"), c.part_no),
            ("field", ("name", "fitted"), "yes" if c.fitted else "no"),
        ),
        ("libsource", ("lib", "tactcad"), ("part", c.part_no), ("description", c.kind)),
        ("sheetpath", ("names", "/"), ("tstamps", "/")),
        ("tstamps", own),
    )


def _part(c: Component) -> Expression:
    kind = "passive" if c.kind in PASSIVE else "unspecified"
    # a connector's pins by number: their nets differ from board to board
    names = (p.number if c.kind == "connector" else p.role for p in c.pins)
    pins = tuple(("pin", ("num", p.number), ("name", name), ("type", kind)) for p, name in zip(c.pins, names))
    return ("libpart", ("lib", "tactcad"), ("part", c.part_no), ("description", c.kind), ("pins", *pins))


def _text(expression: Expression, depth: int) -> str:
    """Lists without lists of lists are on one line; words after the first are quoted."""
    if isinstance(expression, str):
        return '"' + expression.replace("\\", "\\\\").replace('"', '\\"') + '"'
    head, *rest = expression
    if any(isinstance(r, tuple) and any(isinstance(x, tuple) for x in r) for r in rest):
        inner = "".join(f"\n{'  ' * (depth + 1)}{_text(r, depth + 1)}" for r in rest)
        return f"({head}{inner})"
    return f"({' '.join([head, *(_text(r, depth) for r in rest)])})"


OPEN = 1e12  # ohm of an open switch; chosen: a millionth of a microvolt at a bridge
POLE_OHM = 1e3  # of the amplifier's pole; chosen: its own noise is nothing behind a gain
FOUR_K_T = 4 * 1.380649e-23 * 300.15  # J, at SPICE's 27 C
WITHOUT_LINES = ("terminal", "connector")
OUTPUT_OHM = 50.0  # of the decoder's outputs, held low; about 4 mA over 0.2 V: its sheet
DIODE = ".model schottky D(IS=2e-7 RS=0.1 N=1.05)"  # about 0.3 V at 20 mA, as a 1N5819 has


def deck_bytes(netlist: Netlist) -> bytes:
    """The deck that reads every element once: what its bridge gives, V, and the amplifier, V; or the bridge's
    share of its supply."""
    return deck(netlist, list(reading(netlist))).encode()


def deck(netlist: Netlist, commands: Sequence[str]) -> str:
    """The circuit with all switches open, and commands of ngspice for it."""
    lines = [f"* {netlist.name}: run with ngspice -b", DIODE]
    lines += [f"V{rail} {rail} 0 {volts!r}" for rail, volts in netlist.supplies]
    for component in netlist.components:
        lines += lines_of(component)
    return "\n".join([*lines, ".control", "set numdgt=13", *commands, "quit 0", ".endc", ".end", ""])


def reading(netlist: Netlist) -> Iterator[str]:
    """Commands that read every element: its bridge's output, and the amplifier's or its ratio."""
    converters = {c.board: c for c in netlist.of_kind("converter")}
    if converters:
        yield "op"
    for gauge in netlist.of_kind("gauge"):
        b, n = gauge.board, gauge.element
        if converters:
            yield from _ratio(converters[b], n)
            continue
        amplifier = netlist.on_board("amplifier", b)
        yield from closed(netlist, n)
        yield "op"
        yield f"let bridge{n} = v({_node(amplifier.net('plus'))}) - v({_node(amplifier.net('minus'))})"
        yield f"let output{n} = v({_node(amplifier.net('out'))})"
        yield f"print bridge{n} output{n}"
        yield from closed(netlist, n, OPEN)


def inputs_of(converter: Component, element: int) -> tuple[str, str]:
    """The nodes of the inputs that an element's bridge is on."""
    nets = {p.net.partition("__")[0]: p.net for p in converter.pins}
    return _node(nets[f"E{element}_PLUS"]), _node(nets[f"E{element}_MINUS"])


def _ratio(converter: Component, n: int) -> Iterator[str]:
    plus, minus = inputs_of(converter, n)
    yield f"let bridge{n} = v({plus}) - v({minus})"
    yield f"let ratio{n} = bridge{n}/v({_node(converter.net('REFIN1+'))})"
    yield f"print bridge{n} ratio{n}"


def closed(netlist: Netlist, element: int, ohm: float | None = None) -> Iterator[str]:
    """Commands that close the switches of one element; opens them where `ohm` is OPEN."""
    switch = netlist.of_element("switch", element)
    multiplexer = netlist.on_board("multiplexer", switch.board)
    channel = channel_of(multiplexer, element)
    yield f"alter RQ{element} = {switch.figure('ohm') if ohm is None else ohm!r}"
    for side in "AB":
        on = multiplexer.figure("ohm") if ohm is None else ohm
        yield f"alter R{_name(multiplexer)}S{channel}{side} = {on!r}"


def channel_of(multiplexer: Component, element: int) -> int:
    """The channel, from 1, that an element's bridge is on."""
    return next(
        int(p.role[1:-1])
        for p in multiplexer.pins
        if p.net.partition("__")[0] == f"E{element}_PLUS" and p.role.startswith("S")
    )


def _node(net: str) -> str:
    return "0" if net == "GND" else net.lower()


def _name(c: Component) -> str:
    """The component's name in the deck, without dashes."""
    return c.designator.replace("-", "_")


def lines_of(c: Component) -> list[str]:
    """The component's lines of the deck; what a regulator makes is an ideal source."""
    if c.kind in WITHOUT_LINES or not c.fitted:
        return []
    if c.kind == "regulator":
        net = c.net("out")
        return [f"V{net} {_node(net)} 0 {c.figure('volts')!r} AC 1"]
    if c.kind == "supply":
        return [f"V{_name(c)} {_node(c.net('out'))} 0 {c.figure('volts')!r}"]
    if c.kind == "converter":  # none floats
        nets = sorted({p.net for p in c.pins if p.net and p.net != GROUND})
        return [f"R{_name(c)}{i} {_node(net)} 0 {OPEN!r}" for i, net in enumerate(nets)]
    if c.kind == "diode":
        return [f"D{_name(c)} {_node(c.net('2'))} {_node(c.net('1'))} schottky"]
    if c.kind == "decoder":
        outputs = [p for p in c.pins if p.role[0] == "Y" and p.net]
        return [f"R{_name(c)}{p.role} {_node(p.net)} 0 {OUTPUT_OHM!r}" for p in outputs]
    if c.kind == "switch":
        return [f"RQ{c.element} {_node(c.net('drain'))} {_node(c.net('source'))} {OPEN!r}"]
    if c.kind == "capacitor":
        return [f"C{_name(c)} {_node(c.net('1'))} {_node(c.net('2'))} {c.figure('farad')!r}"]
    if c.kind == "multiplexer":
        ends = {side: _node(c.net(f"out_{side.lower()}")) for side in "AB"}
        channels = [pin for pin in c.pins if pin.role[0] == "S"]
        return [f"R{_name(c)}{p.role} {_node(p.net)} {ends[p.role[-1]]} {OPEN!r}" for p in channels]
    if c.kind == "amplifier":
        inner, name = _name(c).lower(), _name(c)
        noise = c.figure("noise") ** 2 / FOUR_K_T
        farad = 1 / (2 * pi * POLE_OHM * c.figure("bandwidth"))
        out = _node(c.net("out"))
        set_by = {pin.net for pin in c.pins if pin.role.startswith("rg") and pin.net}
        return [
            *(f"R{name}{net} {_node(net)} 0 {OPEN!r}" for net in sorted(set_by)),  # none floats
            f"R{name}N {_node(c.net('plus'))} {inner}n {noise!r}",
            f"E{name} {inner}e {_node(c.net('ref'))} {inner}n {_node(c.net('minus'))} {c.figure('gain')!r}",
            f"R{name}P {inner}e {out} {POLE_OHM!r}",
            f"C{name}P {out} 0 {farad!r}",
        ]
    first, second = (_node(c.net(role)) for role in "12")
    return [f"R{_name(c)} {first} {second} {c.figure('ohm')!r}"]


@dataclass(frozen=True)
class Lead:
    """One lead. `start` and `end` as designator and pin; length mm as cut; `bundle` by its board's number."""

    designator: str
    element: int
    start: str
    end: str
    colour: str
    wire: str
    length: float
    bundle: int


LEADS = {"designator": "lead", "start": "from", "end": "to", "length": "cut_length_mm"}


def wiring(layout: Layout, circuit: Netlist) -> tuple[Lead, ...]:
    """Every lead of the array and its circuit, by board and channel."""
    return tuple(_lead(layout, circuit, c) for c in circuit.of_kind("lead"))


def _lead(layout: Layout, circuit: Netlist, c: Component) -> Lead:
    return Lead(
        c.designator,
        c.element,
        _terminal(circuit, c.net("1")),
        _connector_pin(layout, circuit, c),
        colours(layout)[int(c.designator[1:]) % 10 - 1],
        layout.design.wiring.wire,
        c.figure("mm"),
        c.board,
    )


def _terminal(circuit: Netlist, net: str) -> str:
    """The one terminal's pin on a net."""
    ((component, pin),) = [node for node in circuit.nets[net] if node[0].kind == "terminal"]
    return f"{component.designator}.{pin.number}"


def _connector_pin(layout: Layout, circuit: Netlist, c: Component) -> str:
    """The connector's pin of a lead, by the print: its channel and end."""
    places = next(board.places for board in boards(layout) if board.number == c.board)
    channel = next(i for i, place in enumerate(places, start=1) if place.number == c.element)
    said = f" CH{channel}_{c.net('2').partition('_')[2] or 'FOOT'}"
    ((name, pin),) = [
        (other.designator, pin.number)
        for other in circuit.of_kind("connector")
        for pin in other.pins
        if other.board == c.board and pin.role.endswith(said)
    ]
    return f"{name}.{pin}"


def wiring_csv(leads: Sequence[Lead]) -> bytes:
    """The list (RFC 4180, UTF-8)."""
    names = [f.name for f in fields(Lead)]
    values = ([getattr(lead, name) for name in names] for lead in leads)
    rows = ([f"{v:g}" if isinstance(v, float) else v for v in row] for row in values)
    return as_csv([[LEADS.get(name, name) for name in names], *rows])


PINS = ("designator", "pin", "role", "net", "kind", "value", "part_no", "element", "board")


def netlist_csv(netlist: Netlist) -> bytes:
    """The table (RFC 4180, UTF-8), components in the netlist's order; an open pin's net is blank."""
    rows = (
        (c.designator, p.number, p.role, p.net, c.kind, c.value, c.part_no, c.element or "", c.board or "")
        for c in netlist.components
        for p in c.pins
    )
    return as_csv([PINS, *rows])


HARNESS = ("from", "to", "signal", "wire", "length_mm", "current_mA")
# mA, largest current of a board's circuits without its warm bridge; chosen: twice what amplifier (1.3) and
# LT3042 (2) take, and a decoder that drives nothing.
BOARDS_OWN = {"VPOS": 7.0, "VNEG": 3.0, "V5": 1.0}
CABLE = 500.0  # mm, the bill's
OUT = "OUT"
AT_CARD = {
    OUT: "analogue input {b} +",
    "EXC": "analogue input, free, to see the bridges' supply",
    "ON": "digital output ON, or a jumper to VPOS beside it: high, the bridges are on",
    "DOUT": "digital input, all boards' together: CS{b} picks this one",
}
Row = tuple[str, str, str, str, float, float]


def harness_csv(circuit: Netlist, leads: Sequence[Lead]) -> bytes:
    """The table (RFC 4180, UTF-8)."""
    rows = ((*names, f"{length:g}", f"{current:.3g}") for *names, length, current in _rows(circuit, leads))
    return as_csv([HARNESS, *rows])


def _rows(circuit: Netlist, leads: Sequence[Lead]) -> Iterator[Row]:
    # a bridge is two parallel halves of twice the resistance; the gauge's half carries half of the current
    bridge = 1e3 * circuit.excitation / next(circuit.of_kind("gauge")).figure("ohm")
    digital = any(circuit.of_kind("converter"))  # all bridges are warm, not one of a board
    read = Counter(g.board for g in circuit.of_kind("gauge"))
    warm = {board: bridge * (count if digital else 1) for board, count in read.items()}
    for lead in leads:
        signal = circuit.pin_at(lead.end).net
        current = 0.0 if signal.endswith("PLUS") else bridge / 2
        wire = f"{lead.designator}: {lead.wire} {lead.colour}"
        yield lead.start, lead.end, signal, wire, lead.length, current
    for connector in circuit.of_kind("connector"):
        if connector.part_no == TO_CARD:
            yield from _cable(connector, warm[connector.board])
        else:
            (shield, array), b, name = connector.pins[-2:], connector.board, connector.designator
            along = max(lead.length for lead in leads)
            yield f"bundle {b}", f"{name}.{shield.number}", "SHIELD", "braid over the leads", along, 0.0
            bonded = "AWG 26, bonded with silver adhesive"
            yield "array's metal", f"{name}.{array.number}", "ARRAY", bonded, along, 0.0
    for rail, volts in circuit.supplies:
        bridges = sum(warm.values()) if rail == "VPOS" else 0.0
        yield (
            f"supply {rail}",
            "all boards; supplies in any order",
            f"{rail} {volts:g} V",
            "",
            0.0,
            BOARDS_OWN[rail] * len(warm) + bridges,
        )


def _cable(connector: Component, warm: float) -> Iterator[Row]:
    b, last, nets = connector.board, connector.pins[-1], {p.net.rstrip("0123456789") for p in connector.pins}
    for pin in connector.pins:
        current = BOARDS_OWN.get(pin.net, 0.0) + (warm if pin.net == "VPOS" else 0.0)
        if pin is last:
            to = f"analogue input {b} -" if OUT in nets else "0 V of the controller"
        elif pin.net == GROUND:
            to, current = "0 V of the supplies", warm + BOARDS_OWN["VPOS"]
        elif pin.net in BOARDS_OWN:
            to = f"supply {pin.net}"
        else:
            to = AT_CARD.get(pin.net.rstrip("0123456789"), f"digital output {pin.net}").format(b=b)
        yield f"{connector.designator}.{pin.number}", to, pin.net, f"cable {b}", CABLE, current
