"""The circuit's sheets, in frame and title block as all others: one channel, all channels, the leads' way,
the wiring list. As PDF, read back, and SVG.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil

from tactcad.circuit.bridges import netlist
from tactcad.circuit.wiring_list import wiring
from tactcad.design.electronics import MULTIPLEXERS
from tactcad.design.messages import CheckFailure
from tactcad.design.tree import Design
from tactcad.parts.boards import boards
from tactcad.parts.bridge_figures import settling_time
from tactcad.parts.electronic_supplies import wire_metres
from tactcad.parts.layout import Layout
from tactcad.parts.lead_route import leads

from .assembly_file import stacked_svg
from .circuit_channel import channel_page
from .circuit_tables import channel_pages, lead_pages
from .gate import pdf_runs
from .ink import DrawnSheet, preliminary
from .layout_check import layout_faults
from .page import Page
from .paper import frame
from .title import block_of, title_block
from .wiring_plan import plan_page
from .workers import Written


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
    from .pdf import pdf_bytes

    identity = order.design.design
    sheets = circuit_sheets(order.design, order.draft, order.sample)
    pdf = pdf_bytes(
        sheets, f"{order.name} revision {identity.revision}: circuit", identity.author or "", identity.date
    )
    runs = " ".join(run for page in pdf_runs(pdf) for run in page)
    wanted = [c.designator for c in netlist(Layout(order.design)).of_kind("gauge")]
    missing = [name for name in wanted if name not in runs]
    if missing:
        raise CheckFailure(f"drawings: {order.name}: {missing[0]} is missing; no drawing was written")
    return Written(pdf, stacked_svg(sheets))


def circuit_sheets(design: Design, draft: bool = False, sample: bool = False) -> list[DrawnSheet]:
    """Every sheet, its layout clean; raises CheckFailure where it is not."""
    layout = Layout(design)
    circuit = netlist(layout)
    pages = [
        channel_page(circuit, _channel_notes(layout)),
        *channel_pages(circuit),
        plan_page(layout, _plan_notes(layout)),
        *lead_pages(wiring(layout, circuit)),
    ]
    sheets = _sheets(design, pages, draft, sample)
    for sheet in sheets:
        wrong = layout_faults(sheet)
        if wrong:
            raise CheckFailure(f"drawings: {sheet.title}: {'; '.join(wrong[:3])}; no drawing was written")
    return [preliminary(sheet) for sheet in sheets] if draft else sheets


def _sheets(design: Design, pages: Sequence[Page], draft: bool, sample: bool) -> list[DrawnSheet]:
    block = replace(
        block_of(design.design, f"{design.name}-circuit", "Circuit and wiring", draft, sample),
        dimensioned=False,
    )
    sheets = []
    for n, page in enumerate(pages, start=1):
        own = replace(block, scale=page.scale, sheet=n, sheets=len(pages), document_type=page.document_type)
        items = (*frame(page.paper), *title_block(page.paper, own), *page.items)
        title = f"{page.document_type}, sheet {n} of {len(pages)}"
        sheets.append(DrawnSheet(block.number, title, page.paper.size, items))
    return sheets


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
