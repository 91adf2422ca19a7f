"""The list of leads: from terminal to connector, colour, gauge of wire, cut length, bundle."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass, fields

from tactcad.parts.layout import Layout
from tactcad.parts.lead_route import colours

from .netlist import Component, Netlist


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


def wiring(layout: Layout, circuit: Netlist) -> tuple[Lead, ...]:
    """Every lead of the array and its circuit, by board and channel."""
    return tuple(_lead(layout, circuit, c) for c in circuit.of_kind("lead"))


def _lead(layout: Layout, circuit: Netlist, c: Component) -> Lead:
    at_gauge, at_board = c.net("1"), c.net("2")
    return Lead(
        c.designator,
        c.element,
        _place(circuit, at_gauge, "terminal"),
        _place(circuit, at_board, "connector"),
        colours(layout)[int(c.designator[1:]) % 10 - 1],
        layout.design.wiring.wire,
        c.figure("mm"),
        c.board,
    )


def _place(circuit: Netlist, net: str, kind: str) -> str:
    """The one terminal or connector pin on a net."""
    ((component, pin),) = [node for node in circuit.nets[net] if node[0].kind == kind]
    return f"{component.designator}.{pin.number}"


def wiring_csv(leads: Sequence[Lead]) -> bytes:
    """The list (RFC 4180, UTF-8)."""
    text = io.StringIO(newline="")
    writer = csv.writer(text)
    names = [f.name for f in fields(Lead)]
    writer.writerow([COLUMNS.get(name, name) for name in names])
    for lead in leads:
        values = (getattr(lead, name) for name in names)
        writer.writerow([f"{v:g}" if isinstance(v, float) else v for v in values])
    return text.getvalue().encode()
