"""The periphery of a board's circuits: supplies, digital lines, clamps."""

from __future__ import annotations

import re

from tactcad.circuit.netlist import Component, Netlist
from tactcad.circuit.read_board import LOGIC, NEGATIVE, POSITIVE

from ..engine.ink import Item, Point, Text
from ..engine.paper import A3, Page
from .symbols import SMALL, box, capacitor, diode, ground, printed, resistor

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
