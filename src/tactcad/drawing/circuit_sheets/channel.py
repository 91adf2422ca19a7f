"""One channel in full, for boards with an amplifier or with a converter, and a row for each of a converter;
the periphery of a board's circuits: supplies, digital lines, clamps.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from tactcad.circuit.digital_readout import digital_readout, when_on
from tactcad.circuit.netlist import GROUND, Component, Netlist
from tactcad.circuit.netlist_files import Lead
from tactcad.circuit.read_board import LINES, LOGIC, NEGATIVE, OUTPUT, POSITIVE, SUPPLY
from tactcad.design.sensing import Converter
from tactcad.parts.array.converter_figures import converter_supply
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.leads import COLOURS, boards
from tactcad.parts.bought.electronic_parts import TO_CARD

from ..engine.ink import Item, Point, Text, rectangle
from ..engine.paper import A3, Page, notes
from .symbols import (
    LINE,
    SMALL,
    amplifier,
    box,
    capacitor,
    dashed,
    diode,
    dot,
    ground,
    line,
    mosfet,
    printed,
    resistor,
    resistor_below,
    ring,
    strain_gauge,
    stub,
)

RAIL = 262.0  # mm on the paper: the bridges' supply
RED, WHITE, MINUS, BLACK = 224.0, 210.0, 200.0, 176.0


def channel_page(circuit: Netlist, says: list[str]) -> Page:
    """The page of the first element's channel; `says` are its notes."""
    gauge = next(circuit.of_kind("gauge"))
    n, b = gauge.element, gauge.board
    if any(circuit.of_kind("converter")):
        foot = [dot((FOOT, BLACK)), line((FOOT, BLACK), (FOOT, BLACK - 10.0)), *ground((FOOT, BLACK - 10.0))]
        across = _across(ACROSS, circuit.of_element("capacitor", n))
        chain = [*foot, *across, *_converter(circuit, n, b), *card_connector(circuit, b, "to the controller")]
    else:
        chain = [*_switching(circuit, n, b), *_amplifier(circuit, b), *_filter(circuit, b)]
        chain += card_connector(circuit, b)
    items = [
        *array_side(circuit, gauge),
        *bridge(circuit, n),
        *chain,
        *dashed(24.0, 150.0, 39.0, 92.0, f"on the array: E{n}"),
        *dashed(82.0, 112.0, 318.0, 164.0, f"board A{b}, channel 1"),
        *notes((26.0, 100.0), says, 190.0)[0],
    ]
    return Page(A3, "", tuple(items), "Circuit diagram")


def _filter(circuit: Netlist, b: int) -> list[Item]:
    """Between multiplexer and amplifier."""
    amplifier = circuit.on_board("amplifier", b)
    items: list[Item] = []
    for role, y, below in (("plus", WHITE, False), ("minus", MINUS, True)):
        resistor = next(
            c for c, _ in circuit.nets[amplifier.net(role)] if c.kind == "resistor" and not c.element
        )
        items.append(rectangle(234.0, y - 1.5, 8.0, 3.0, LINE, "symbol"))
        text = (238.0, y - 4.6 if below else y + 2.6)
        items.append(Text(text, f"{printed(resistor)} {resistor.value}", SMALL, "middle"))
    across = next(c for c, _ in circuit.nets[amplifier.net("plus")] if c.kind == "capacitor")
    return items + _across(250.0, across)


def _across(x: float, capacitor: Component) -> list[Item]:
    """A capacitor between the lines of a bridge's output."""
    middle = (WHITE + MINUS) / 2
    return [
        dot((x, WHITE)),
        dot((x, MINUS)),
        line((x, WHITE), (x, middle + 0.7)),
        line((x, middle - 0.7), (x, MINUS)),
        *(line((x - 3.0, middle + s), (x + 3.0, middle + s)) for s in (0.7, -0.7)),
        Text((x - 3.6, middle - 0.9), f"{printed(capacitor)} {capacitor.value}", SMALL, "end"),
    ]


def array_side(circuit: Netlist, gauge: Component) -> list[Item]:
    """The gauge, its terminals, its leads to the board's connector."""
    n = gauge.element
    leads = [c for c in circuit.of_kind("lead") if c.element == n]
    three = len(leads) == 3
    rows = [RED, WHITE, BLACK] if three else [RED, BLACK]
    colours = COLOURS["three-wire" if three else "two-wire"]
    connector = next(c for c, _ in circuit.nets[leads[0].net("2")] if c.kind == "connector")
    x, terminal, pin = 46.0, 56.0, 90.0  # mm: left of x a value of eleven letters
    items: list[Item] = [
        *strain_gauge((x, RED), (x, BLACK), gauge.designator, gauge.value),
        line((x, RED), (terminal - 1.0, RED)),
        line((x, BLACK), (terminal - 1.0, BLACK)),
        ring((terminal, RED)),
        ring((terminal, BLACK)),
        Text((terminal - 1.0, RED + 2.0), f"X{n}.1", SMALL, "middle"),
        Text((terminal - 1.0, BLACK - 4.0), f"X{n}.2", SMALL, "middle"),
        Text((pin - 2.0, RED + 9.0), printed(connector)),
    ]
    for y, lead, colour in zip(rows, leads, colours):
        if y == WHITE:
            items.append(line((terminal, RED - 1.0), (terminal, WHITE), (pin - 1.0, WHITE)))
        else:
            items.append(line((terminal + 1.0, y), (pin - 1.0, y)))
        number = next(p.number for p in connector.pins if p.net == lead.net("2"))
        items += [
            ring((pin, y)),
            Text((pin, y + 2.0), number, SMALL, "middle"),
            Text((terminal + 9.0, y + 1.2), f"{lead.designator} {colour}", SMALL),
        ]
    return items


def bridge(circuit: Netlist, n: int) -> list[Item]:
    """The three other arms, and the lines to multiplexer or converter."""
    own = [c for c in circuit.components if c.kind == "resistor" and c.element == n]
    arms = {printed(c): c for c in own}
    first, second, third, link = arms
    left, right, pin, multiplexer = 112.0, 148.0, 91.0, 196.0
    three = sum(c.element == n for c in circuit.of_kind("lead")) == 3
    joint = 98.0
    plus = [line((pin if three else joint, WHITE), (multiplexer, WHITE)), dot((joint, RED))]
    plus += [item for item in resistor((joint, RED), (joint, WHITE), "", "") if not isinstance(item, Text)]
    said = "left off" if three else arms[link].value
    plus += [Text((joint + 3.0, WHITE + 8.0), link, SMALL), Text((joint + 3.0, WHITE + 5.0), said, SMALL)]
    if three:
        plus.append(dot((joint, WHITE)))
    return [
        line((left, RAIL), (right, RAIL), (250.0, RAIL)),
        dot((left, RAIL)),
        dot((right, RAIL)),
        Text((252.0, RAIL - 1.0), circuit.on_board("regulator", own[0].board).net("out")),
        *resistor((left, RAIL), (left, RED), first, arms[first].value),
        line((pin, RED), (left, RED)),
        *plus,
        *resistor((right, RAIL), (right, 224.0), second, arms[second].value),
        line((right, 224.0), (right, MINUS)),
        dot((right, MINUS)),
        line((right, MINUS), (multiplexer, MINUS)),
        *resistor((right, MINUS), (right, BLACK), third, arms[third].value),
        line((pin, BLACK), (right, BLACK)),
    ]


def _switching(circuit: Netlist, n: int, b: int) -> list[Item]:
    """MOSFET, decoder and multiplexer."""
    switch = circuit.of_element("switch", n)
    decoder, multiplexer = circuit.on_board("decoder", b), circuit.on_board("multiplexer", b)
    foot, gate = (128.0, BLACK), (196.0, 150.0)
    items: list[Item] = [dot(foot)]
    items += mosfet(foot, (foot[0] + 12.0, BLACK - 8.0), printed(switch), switch.value)
    items.append(line((foot[0] + 12.0, BLACK - 8.0), (166.0, BLACK - 8.0), (166.0, gate[1]), gate))
    items += box(196.0, 190.0, 30.0, 30.0, printed(multiplexer), multiplexer.value)
    items += box(196.0, 128.0, 30.0, 30.0, printed(decoder), decoder.value)
    items.append(Text((196.0, 186.0), _fed(multiplexer), SMALL))
    items.append(Text((196.0, 124.0), _fed(decoder), SMALL))
    items.append(Text((198.0, gate[1] - 0.9), f"{_pin(decoder, 'Y0')} Y0", SMALL))
    for role, y in (("S1A", WHITE), ("S1B", MINUS)):
        items.append(Text((198.0, y - 0.9), f"{_pin(multiplexer, role)} {role}", SMALL))
    for role, name, y in (("out_a", "DA", WHITE), ("out_b", "DB", MINUS)):
        items.append(Text((224.0, y - 0.9), f"{name} {_pin(multiplexer, role)}", SMALL, "end"))
        items.append(line((226.0, y), (262.0, y)))
    address = [p.role for p in multiplexer.pins if p.role in ("A0", "A1", "A2")]
    for i, role in enumerate((*address, "enable")):
        y, own = 154.0 - 6.0 * i, "E3" if role == "enable" else role
        items.append(Text((224.0, y - 0.9), f"{own} {_pin(decoder, own)}", SMALL, "end"))
        also = "" if role == "enable" else f", also {printed(multiplexer)}.{_pin(multiplexer, role)}"
        named = f"{local(decoder.net(own), b)}{also}"
        items += stub((226.0, y), named)
    return items


def _fed(component: Component) -> str:
    """Its pins on supplies and ground, without those of unused channels."""
    pins: dict[str, list[str]] = {}
    for pin in component.pins:
        if pin.net in (GROUND, *SUPPLIES) and not pin.role.startswith("S"):
            pins.setdefault(pin.net, []).append(pin.number)
    return "pins " + "; ".join(f"{', '.join(numbers)} on {net}" for net, numbers in pins.items())


def _pin(component: Component, role: str) -> str:
    return next(p.number for p in component.pins if p.role == role)


def _amplifier(circuit: Netlist, b: int) -> list[Item]:
    part = circuit.on_board("amplifier", b)
    middle, x, size = (WHITE + MINUS) / 2, 262.0, 24.0
    out = (x + size, middle)
    items = [
        *amplifier((x, middle), size),
        Text((x - 2.0, WHITE + 1.5), _pin(part, "plus"), SMALL, "end"),
        Text((x - 2.0, MINUS - 3.3), _pin(part, "minus"), SMALL, "end"),
        Text((x, middle + 17.6), printed(part)),
        Text((x, middle + 13.8), part.value, SMALL),
        *stub(out, part.net("out")),
        Text((out[0] + 1.0, middle + 1.5), _pin(part, "out"), SMALL),
    ]
    items += _gain(circuit, part, (x, middle))
    lines = [
        f"pin {_pin(part, 'ref')} (REF) on {GROUND}",
        f"pins {_pin(part, 'positive')}, {_pin(part, 'negative')} on VPOS, VNEG",
    ]
    return [*items, *(Text((x + 4.0, middle - 32.0 - 4.0 * i), t, SMALL) for i, t in enumerate(lines))]


def _gain(circuit: Netlist, part: Component, at: Point) -> list[Item]:
    """The part that sets the gain between two pins on the triangle's lower edge: a resistor, a joint, or
    nothing."""
    (x, y), slope = at, 0.5
    left, right = ((x + dx, y - 12.0 + slope * dx) for dx in (3.0, 19.0))
    ends = {p.net for p in part.pins if p.role.startswith("rg") and p.net}
    resistor = next((c for c in circuit.of_kind("resistor") if ends & {p.net for p in c.pins}), None)
    low = y - 18.0
    items: list[Item] = [
        Text((left[0] - 1.0, low + 0.6), _pin(part, "rg1"), SMALL, "end"),
        Text((right[0] + 1.0, low + 0.6), _pin(part, "rg2"), SMALL),
    ]
    if resistor:
        return items + resistor_below(left, right, low, printed(resistor), resistor.value)
    if part.net("rg1"):
        return [*items, line(left, (left[0], low), (right[0], low), right)]
    return [*items, *(line(p, (p[0], low)) for p in (left, right))]


def card_connector(circuit: Netlist, b: int, to: str = "to the card") -> list[Item]:
    """The connector to the converter's card, or to a controller, pin by pin."""
    connector = next(c for c in circuit.of_kind("connector") if c.part_no == TO_CARD and c.board == b)
    x, top = 360.0, 250.0
    items: list[Item] = [Text((x - 4.0, top + 8.0), f"{printed(connector)}, {to}")]
    for i, pin in enumerate(connector.pins):
        y = top - 7.0 * i
        items += [
            ring((x, y)),
            line((x - 8.0, y), (x - 1.0, y)),
            Text((x + 3.0, y - 1.2), f"{pin.number}  {pin.net}", 2.5),
        ]
    return items


DIGITAL = re.compile(r"A\d|(ENABLE|CS)\d+|ON|SCLK|DIN")
SUPPLIES = (POSITIVE, NEGATIVE, LOGIC)


def around_page(circuit: Netlist) -> Page:
    """The page of the periphery: supplies, digital lines, clamps."""
    gauge = next(circuit.of_kind("gauge"))
    own = [c for c in circuit.components if c.board == gauge.board and not c.element and c.fitted]
    pins = [p for c in own if c.kind in ("amplifier", "multiplexer") for p in c.pins]
    drawn = {p.net for p in pins if p.role.startswith(("rg", "out")) or p.role in ("plus", "minus")}
    parts = [
        c
        for c in own
        if c.kind in ("resistor", "capacitor", "diode")
        and not drawn & {p.net for p in c.pins}
        and _first_digits(c)
    ]
    items: list[Item] = []
    for i, c in enumerate(parts):
        x, top = 46.0 + 37.0 * (i % 10), 262.0 - 50.0 * (i // 10)
        items += _between((x, top), c, gauge.board)
    regulators = [c for c in own if c.kind in ("regulator", "supply")]
    for k, regulator in enumerate(regulators):
        x, y = 40.0 + 70.0 * k, 70.0 if len(parts) <= 20 else 54.0
        items += box(x, y, 50.0, 6.0 * len(regulator.pins) + 4.0, printed(regulator), regulator.value)
        for i, pin in enumerate(regulator.pins):
            role = pin.role.replace("_", " ")
            text = f"{pin.number}  {role}: {local(pin.net, gauge.board) or 'open'}"
            items.append(Text((x + 2.0, y + 6.0 * (len(regulator.pins) - 1 - i) + 3.0), text, 2.5))
    return Page(A3, "", tuple(items), "Supplies and digital lines")


def _first_digits(c: Component) -> bool:
    """Not of a channel that reads no element."""
    return c.kind != "resistor" or not 10 < int(printed(c)[1:]) < 90


def local(net: str, board: int) -> str:
    """A board's own net without the board; a digital line before its resistor by its connector."""
    own = net.removeprefix(f"A{board}_")
    return f"J1, {net}" if own == net and DIGITAL.fullmatch(net) else own


def _between(at: Point, c: Component, board: int) -> list[Item]:
    """A component with two pins, upright, each pin's net at its end."""
    (x, top), bottom = at, (at[0], at[1] - 24.0)
    first, second = (local(c.net(role), board) for role in "12")
    ends = [Text((x, top + 1.2), first, SMALL, "middle"), Text((x, bottom[1] - 3.0), second, SMALL, "middle")]
    if c.kind == "resistor":
        return [*resistor(at, bottom, printed(c), c.value), *ends]
    if c.kind == "diode":
        return [*diode(at, bottom, printed(c), c.value), *ends]
    lines = capacitor(at, bottom, printed(c), c.value, first)
    return [item for item in lines if item not in ground(bottom)] + ends[1:]


HEADS = ("Board", "Channel", "Element", "Gauge", "Arms", "Leads", "Terminals", "Lead connector")
CONVERTER_HEADS = (*HEADS, "Capacitor", "Input +", "Input −", "Selected by")
ACROSS, LEFT = 176.0, 196.0  # mm on the paper: the capacitor, the converter
FOOT = 128.0


def _converter(circuit: Netlist, n: int, b: int) -> list[Item]:
    """The converter: this channel's inputs, its lines, and what its other pins are on."""
    part = circuit.on_board("converter", b)
    items: list[Item] = [*box(LEFT, 176.0, 40.0, 44.0, printed(part), part.value)]
    for (role, number), y in zip(inputs(part, n), (WHITE, MINUS), strict=True):
        items.append(Text((LEFT + 2.0, y - 0.9), f"{number} {role}", SMALL))
    for i, role in enumerate((*LINES[1:], OUTPUT)):
        pin, y = next(p for p in part.pins if p.role == role), WHITE - 7.0 * i
        items.append(Text((LEFT + 38.0, y - 0.9), f"{role} {pin.number}", SMALL, "end"))
        items += stub((LEFT + 40.0, y), local(pin.net, b))
    on: dict[str, list[str]] = {}
    for pin in part.pins:
        if not pin.role.startswith("AIN") and pin.role not in (*LINES, OUTPUT):
            on.setdefault(local(pin.net, b) or "open", []).append(f"{pin.number} {pin.role}")
    said = [f"{', '.join(pins)} on {net}".replace(" on open", " open") for net, pins in on.items()]
    count = sum(p.role.startswith("AIN") for p in part.pins)
    said.append(f"AIN0 to AIN{count - 1}: channels 1 to {count // 2}, as on the sheet of all channels")
    return [*items, *(Text((LEFT, 168.0 - 4.0 * i), text, SMALL) for i, text in enumerate(said))]


def inputs(converter: Component, n: int) -> list[tuple[str, str]]:
    """Role and number of the two pins that an element's bridge is on, + before −."""
    pins = {p.net: (p.role, p.number) for p in converter.pins if p.role.startswith("AIN")}
    return [pins[f"E{n}_PLUS"], pins[f"E{n}_MINUS"]]


def converter_channels(circuit: Netlist, leads: Sequence[Lead]) -> Iterator[tuple[str, ...]]:
    """Every channel of every board, a row each."""
    for gauge in circuit.of_kind("gauge"):
        n, b = gauge.element, gauge.board
        converter = circuit.on_board("converter", b)
        arms = [printed(c) for c in circuit.components if c.kind == "resistor" and c.element == n]
        own = [lead for lead in leads if lead.element == n]
        ends = [lead.end.rpartition(".")[2] for lead in own]
        (plus, plus_at), (minus, minus_at) = inputs(converter, n)
        yield (
            f"{b}",
            f"{int(plus.removeprefix('AIN')) // 2 + 1}",
            f"E{n}",
            gauge.designator,
            f"{arms[0]} to {arms[2]}",
            f"{own[0].designator} to {own[-1].designator}",
            f"X{n}",
            f"J2.{ends[0]} to {ends[-1]}",
            printed(circuit.of_element("capacitor", n)),
            f"{printed(converter)}.{plus_at} {plus}",
            f"{printed(converter)}.{minus_at} {minus}",
            f"CS{b}",
        )


def converter_notes(layout: Layout, converter: Converter, letters: str) -> list[str]:
    """The first page's notes; `letters` of the designators."""
    d, found, count = layout.design, digital_readout(layout, converter.name), len(boards(layout))
    selected = "CS1" if count == 1 else f"CS1 to CS{count}"
    return [
        letters,
        f"The bridges' supply, EXC, is {found.excitation:.4g} V over {GROUND}, made from VPOS "
        f"({d.readout.supply_positive:g} V) on each board while ON is high, and the converter's reference; "
        f"{SUPPLY}, {converter_supply():.4g} V, feeds the converter",
        f"ON: {when_on(layout, found)}",
        f"The controller, of 3.3 V, needs SCLK, DIN, {OUTPUT} and ON for all boards, and a line to select "
        f"each: {selected}",
        f"{found.rate:g} results a second at a gain of {found.gain:g}; {found.settling * 1e3:g} ms from one "
        "input to the next",
        f"Registers, and elements by input: circuit/{d.name}-{converter.name}, as C header and JSON",
        "All other channels are alike; of channels that are not used capacitor and third arm are left off, "
        "the other arms are links, so that their inputs lie at EXC",
    ]
