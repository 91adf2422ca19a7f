"""The array's channels as a matrix, a row each; the pins of the boards' connectors; the leads to cut."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from tactcad.circuit.bridges import EXCITATION
from tactcad.circuit.netlist import Component, Netlist
from tactcad.circuit.wiring_list import Lead

from .fonts import width
from .ink import FRAME, THIN, Item, Text, rectangle, segment
from .page import MARGIN, Page
from .paper import A3
from .title import HEIGHT

ROW, LETTERS = 5.5, 2.5
CHANNEL_HEADS = (
    "Board",
    "Channel",
    "Element",
    "Gauge",
    "Arms",
    "Leads",
    "Terminals",
    "Lead connector",
    "Switch",
    "Multiplexer",
    "Decoder",
    "Read at",
)
LEAD_HEADS = ("Lead", "Element", "From", "To", "Colour", "Wire", "Cut to, mm", "Bundle")


def channel_pages(circuit: Netlist) -> list[Page]:
    """Every channel of every board."""
    return _pages(CHANNEL_HEADS, list(_channels(circuit)), "Circuit, all channels")


def lead_pages(leads: Sequence[Lead]) -> list[Page]:
    """Every lead, as in the wiring list."""
    rows = [
        (
            lead.designator,
            f"E{lead.element}",
            lead.start,
            lead.end,
            lead.colour,
            lead.wire,
            f"{lead.length:g}",
            f"{lead.bundle}",
        )
        for lead in leads
    ]
    return _pages(LEAD_HEADS, rows, "Wiring list")


def _channels(circuit: Netlist) -> Iterator[tuple[str, ...]]:
    leads: dict[int, list[Component]] = {}
    arms: dict[int, list[Component]] = {}
    connectors = {c.board: c for c in circuit.of_kind("connector") if EXCITATION not in _nets(c)}
    for kept, kind in ((leads, "lead"), (arms, "resistor")):
        for c in circuit.components:
            if c.kind == kind and c.element:
                kept.setdefault(c.element, []).append(c)
    for gauge in circuit.of_kind("gauge"):
        n, b = gauge.element, gauge.board
        multiplexer, decoder = circuit.on_board("multiplexer", b), circuit.on_board("decoder", b)
        pair = [p for p in multiplexer.pins if p.net in (f"E{n}_PLUS", f"E{n}_MINUS")]
        ends = {lead.net("2") for lead in leads[n]}
        pins = [p.number for p in connectors[b].pins if p.net in ends]
        gate = next(p for p in decoder.pins if p.net == f"GATE{n}")
        yield (
            f"{b}",
            pair[0].role[1:-1],
            f"E{n}",
            gauge.designator,
            f"{arms[n][0].designator} to {arms[n][-1].designator}",
            f"{leads[n][0].designator} to {leads[n][-1].designator}",
            f"X{n}",
            f"{connectors[b].designator}.{pins[0]} to {pins[-1]}",
            f"Q{n}",
            f"{multiplexer.designator}.{pair[0].number} +, .{pair[1].number} −",
            f"{decoder.designator}.{gate.number} {gate.role}",
            circuit.on_board("amplifier", b).net("out"),
        )


def _nets(c: Component) -> set[str]:
    return {p.net for p in c.pins}


def _pages(heads: Sequence[str], rows: Sequence[tuple[str, ...]], kind: str) -> list[Page]:
    """The rows as tables over the width of as many A3 pages as they need, above the title block."""
    x0, y0, x1, y1 = A3.area
    widths = [3.0 + max(width(text, LETTERS) for text in column) for column in zip(heads, *rows, strict=True)]
    spare = (x1 - x0 - 2 * MARGIN - sum(widths)) / len(widths)
    widths = [w + min(spare, 8.0) for w in widths]
    most = int((y1 - y0 - HEIGHT - 3 * MARGIN) / ROW) - 1
    parts = [rows[i : i + most] for i in range(0, len(rows), most)]
    return [Page(A3, "", tuple(_table(heads, part, widths)), kind) for part in parts]


def _table(heads: Sequence[str], rows: Sequence[tuple[str, ...]], widths: Sequence[float]) -> list[Item]:
    left, top = A3.area[0] + MARGIN, A3.area[3] - MARGIN
    high = ROW * (len(rows) + 1)
    items: list[Item] = [rectangle(left, top - high, sum(widths), high, FRAME, "table")]
    for i, row in enumerate((heads, *rows)):
        y, x = top - ROW * (i + 1), left
        if i:
            items.append(segment((left, y + ROW), (left + sum(widths), y + ROW), THIN, "table"))
        for text, w in zip(row, widths):
            items.append(Text((x + 1.5, y + 1.5), text, LETTERS, role="table"))
            x += w
    x = left
    for w in widths[:-1]:
        x += w
        items.append(segment((x, top - high), (x, top), THIN, "table"))
    return items
