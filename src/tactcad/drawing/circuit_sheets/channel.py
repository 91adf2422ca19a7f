"""One channel in full, for boards with an amplifier; the periphery of a board's circuits: supplies, digital
lines, clamps.
"""

from __future__ import annotations

import re

from tactcad.circuit.netlist import GROUND, Component, Netlist
from tactcad.circuit.read_board import LOGIC, NEGATIVE, POSITIVE
from tactcad.parts.array.leads import COLOURS
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
    items = [
        *array_side(circuit, gauge),
        *bridge(circuit, n),
        *_switching(circuit, n, b),
        *_amplifier(circuit, b),
        *_filter(circuit, b),
        *card_connector(circuit, b),
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
    x, middle = 250.0, (WHITE + MINUS) / 2
    items += [
        dot((x, WHITE)),
        dot((x, MINUS)),
        line((x, WHITE), (x, middle + 0.7)),
        line((x, middle - 0.7), (x, MINUS)),
    ]
    items += [line((x - 3.0, middle + s), (x + 3.0, middle + s)) for s in (0.7, -0.7)]
    items.append(Text((x - 3.6, middle - 0.9), f"{printed(across)} {across.value}", SMALL, "end"))
    return items


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


LINES = re.compile(r"A\d|(ENABLE|CS)\d+|ON|SCLK|DIN")
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
    return f"J1, {net}" if own == net and LINES.fullmatch(net) else own


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
