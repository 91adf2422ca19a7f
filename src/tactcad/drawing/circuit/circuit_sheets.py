"""The circuit's sheets, in frame and title block as all others: one channel, a matrix of all channels, the
leads' way, the wiring list. As PDF, read back, and SVG.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import ceil

from tactcad.circuit.bridges import EXCITATION, netlist
from tactcad.circuit.netlist import Component, Netlist
from tactcad.circuit.wiring_list import wiring
from tactcad.design.electronics import MULTIPLEXERS
from tactcad.design.tree import Design
from tactcad.parts.boards import boards
from tactcad.parts.bridge_figures import settling_time
from tactcad.parts.electronic_supplies import wire_metres
from tactcad.parts.layout import Layout
from tactcad.parts.lead_route import leads

from ..engine.fonts import width
from ..engine.ink import FRAME, LETTERS, THIN, DrawnSheet, Item, Text, rectangle, segment
from ..engine.paper import A3
from ..engine.sheet_files import files_of, pdf_runs
from ..engine.title import HEIGHT, MARGIN, Page, block_of, sheets_of
from ..engine.workers import Written
from .circuit_channel import channel_page
from .wiring_plan import plan_page

ROW = 5.5  # mm
CHANNELS = (
    "Board, Channel, Element, Gauge, Arms, Leads, Terminals, Lead connector, Switch, Multiplexer, Decoder"
)
CHANNEL_HEADS = (*CHANNELS.split(", "), "Read at")
LEAD_HEADS = ("Lead", "Element", "From", "To", "Colour", "Wire", "Cut to, mm", "Bundle")


@dataclass(frozen=True)
class CircuitOrder:
    """The circuit of a design to draw."""

    design: Design
    draft: bool = False
    sample: bool = False

    @property
    def name(self) -> str:
        return f"{self.design.name}-circuit"


def circuit_written(order: CircuitOrder) -> Written:
    """All its sheets as PDF and SVG.

    Raises CheckFailure where a layout is not clean, or the PDF lacks a component when read back.
    """

    def faults(pdf: bytes) -> list[str]:
        runs = " ".join(run for page in pdf_runs(pdf) for run in page)
        gauges = netlist(Layout(order.design)).of_kind("gauge")
        return [f"{c.designator} is missing" for c in gauges if c.designator not in runs][:1]

    sheets = circuit_sheets(order.design, order.draft, order.sample)
    return files_of(sheets, order.name, "circuit", order.design.design, faults)


def circuit_sheets(design: Design, draft: bool = False, sample: bool = False) -> list[DrawnSheet]:
    """Every sheet, its layout clean; raises CheckFailure where it is not."""
    layout = Layout(design)
    circuit = netlist(layout)
    rows = [
        (e.designator, f"E{e.element}", e.start, e.end, e.colour, e.wire, f"{e.length:g}", f"{e.bundle}")
        for e in wiring(layout, circuit)
    ]
    pages = [
        channel_page(circuit, _channel_notes(layout)),
        *_tables(CHANNEL_HEADS, list(_channels(circuit)), "Circuit, all channels"),
        plan_page(layout, _plan_notes(layout)),
        *_tables(LEAD_HEADS, rows, "Wiring list"),
    ]
    block = block_of(design.design, f"{design.name}-circuit", "Circuit and wiring", draft, sample)
    return sheets_of(replace(block, dimensioned=False), pages, draft)


def _channel_notes(layout: Layout) -> list[str]:
    r, inputs = layout.design.readout, len(boards(layout))
    address = len(MULTIPLEXERS[r.multiplexer].address)
    settled = ceil(settling_time(layout.design) * 1e6)
    return [
        "Symbols IEC 60617, letters of designators IEC 81346-2: B gauge, C capacitor, J connector, Q "
        "transistor, R resistor, U circuit, W lead, X terminal",
        f"The bridges' supply, EXC, is {r.excitation:g} V over GND; VPOS {r.supply_positive:g} V, VNEG "
        f"{r.supply_negative:g} V, V5 5 V",
        "The address names the channel whose bridge is led to the amplifier; ENABLE high turns its switch "
        "on, all others are off; with ENABLE low no gauge is warm, and the amplifier's inputs rest at EXC",
        f"The card needs {inputs + address} digital outputs, A0 to A{address - 1} for all boards and one "
        f"ENABLE a board; and {inputs} differential input{'s' if inputs > 1 else ''}, OUT and GND of a board",
        f"Sample {settled} us after ENABLE or later: {r.samples} samples within {r.on_time * 1e3:g} ms",
        "All other channels are alike: next sheets; inputs of channels that are not used are on GND",
    ]


def _plan_notes(layout: Layout) -> list[str]:
    w, count = layout.design.wiring, leads(layout)
    return [
        "Seen on the gauges' side",
        f"{count} leads an element, {w.wire}, {wire_metres(layout):g} m of each colour; cut lengths in the "
        f"wiring list, slack of {w.slack:.0%} in them",
        "Terminals lie in the recess, behind its wall (a), leads from there to the rear end (c); "
        "bonded from b to c, "
        f"{w.bonded:g} mm: strain relief",
        f"Tied {w.gather:g} mm behind (d), a bundle a board; from there {w.to_board:g} mm to the board",
        "Number both ends of every lead; colours after IEC 60757",
    ]


def _channels(circuit: Netlist) -> Iterator[tuple[str, ...]]:
    """Every channel of every board, a row each."""
    leads: dict[int, list[Component]] = {}
    arms: dict[int, list[Component]] = {}
    of_leads = [c for c in circuit.of_kind("connector") if EXCITATION not in {p.net for p in c.pins}]
    connectors = {c.board: c for c in of_leads}
    for by_element, kind in ((leads, "lead"), (arms, "resistor")):
        for c in circuit.components:
            if c.kind == kind and c.element:
                by_element.setdefault(c.element, []).append(c)
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


def _tables(heads: Sequence[str], rows: Sequence[tuple[str, ...]], kind: str) -> list[Page]:
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
