"""One channel in full, and a row for each, for boards with a converter."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from tactcad.circuit.digital_readout import digital_readout, when_on
from tactcad.circuit.netlist import GROUND, Component, Netlist
from tactcad.circuit.netlist_files import Lead
from tactcad.circuit.read_board import LINES, OUTPUT, SUPPLY
from tactcad.design.sensing import Converter
from tactcad.parts.array.converter_figures import converter_supply
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.leads import boards

from ..engine.ink import Item, Text
from ..engine.paper import A3, Page, notes
from .channel import BLACK, MINUS, WHITE, array_side, bridge, card_connector, local
from .symbols import SMALL, box, dashed, dot, ground, line, printed, stub

CHANNELS = (
    "Board, Channel, Element, Gauge, Arms, Leads, Terminals, Lead connector, Capacitor, Input +, Input −"
)
HEADS = (*CHANNELS.split(", "), "Selected by")
ACROSS, LEFT = 176.0, 196.0  # mm on the paper: the capacitor, the converter
FOOT = 128.0


def converter_page(circuit: Netlist, says: list[str]) -> Page:
    """The page of the first element's channel; `says` are its notes."""
    gauge = next(circuit.of_kind("gauge"))
    n, b = gauge.element, gauge.board
    items = [
        *array_side(circuit, gauge),
        *bridge(circuit, n),
        dot((FOOT, BLACK)),
        line((FOOT, BLACK), (FOOT, BLACK - 10.0)),
        *ground((FOOT, BLACK - 10.0)),
        *_across(circuit, n),
        *_converter(circuit, n, b),
        *card_connector(circuit, b, "to the controller"),
        *dashed(24.0, 150.0, 39.0, 92.0, f"on the array: E{n}"),
        *dashed(82.0, 112.0, 318.0, 164.0, f"board A{b}, channel 1"),
        *notes((26.0, 100.0), says, 190.0)[0],
    ]
    return Page(A3, "", tuple(items), "Circuit diagram")


def _across(circuit: Netlist, n: int) -> list[Item]:
    part, middle = circuit.of_element("capacitor", n), (WHITE + MINUS) / 2
    return [
        dot((ACROSS, WHITE)),
        dot((ACROSS, MINUS)),
        line((ACROSS, WHITE), (ACROSS, middle + 0.7)),
        line((ACROSS, middle - 0.7), (ACROSS, MINUS)),
        *(line((ACROSS - 3.0, middle + s), (ACROSS + 3.0, middle + s)) for s in (0.7, -0.7)),
        Text((ACROSS - 3.6, middle - 0.9), f"{printed(part)} {part.value}", SMALL, "end"),
    ]


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
