"""The list of leads: from terminal to connector, colour, gauge of wire, cut length, bundle."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass, fields

from tactcad.parts.layout import Layout

from .bridges import netlist
from .netlist import Component, Netlist

# Codes of IEC 60757. Red and white are both soldered to the gauge's first tab, black to its second, as in
# strain gauge practice; of two wires there is no white one.
COLOURS = {3: ("RD", "WH", "BK"), 2: ("RD", "BK")}


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


COLUMNS = {"designator": "lead", "start": "from", "end": "to", "length": "cut_length_mm"}


def wiring(layout: Layout) -> tuple[Lead, ...]:
    """Every lead of the array, by board and channel."""
    circuit = netlist(layout)
    return tuple(_lead(layout, circuit, c) for c in circuit.of_kind("lead"))


def _lead(layout: Layout, circuit: Netlist, c: Component) -> Lead:
    count = 3 if layout.design.readout.connection == "three-wire" else 2
    at_gauge, at_board = c.net("1"), c.net("2")
    return Lead(
        c.designator,
        c.element,
        _place(circuit, at_gauge, "terminal"),
        _place(circuit, at_board, "connector"),
        COLOURS[count][int(c.designator[1:]) % 10 - 1],
        layout.design.wiring.wire,
        c.figure("mm"),
        c.board,
    )


def _place(circuit: Netlist, net: str, kind: str) -> str:
    """The one terminal or connector pin on a net."""
    ((component, pin),) = [node for node in circuit.nets[net] if node[0].kind == kind]
    return f"{component.designator}.{pin.number}"


def wiring_csv(layout: Layout) -> bytes:
    """The list (RFC 4180, UTF-8)."""
    text = io.StringIO(newline="")
    writer = csv.writer(text)
    names = [f.name for f in fields(Lead)]
    writer.writerow([COLUMNS.get(name, name) for name in names])
    for lead in wiring(layout):
        values = (getattr(lead, name) for name in names)
        writer.writerow([f"{v:g}" if isinstance(v, float) else v for v in values])
    return text.getvalue().encode()
