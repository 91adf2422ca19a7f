"""The circuit's sheets, in frame and title block as all others: one channel in full, a matrix of all
channels, the leads' way, the wiring list. As PDF, read back, and SVG.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from math import ceil

from tactcad.circuit.bridges import netlist
from tactcad.circuit.netlist import Component, Netlist
from tactcad.circuit.netlist_files import wiring
from tactcad.design.family import taken_as
from tactcad.design.messages import CheckFailure
from tactcad.design.sensing import MULTIPLEXERS
from tactcad.design.tree import CommonTables, Design
from tactcad.parts.array.bridge_figures import instants, jitter, settling_time
from tactcad.parts.array.layout import ElementPlace, Layout
from tactcad.parts.array.leads import boards, lead_routes, leads
from tactcad.parts.array.supplies import wire_metres
from tactcad.parts.bought.electronic_parts import TO_LEADS, converter_of

from ..engine.ink import (
    FRAME,
    LETTERS,
    THIN,
    VISIBLE,
    DrawnArc,
    DrawnSheet,
    Item,
    LineType,
    Point,
    Text,
    rectangle,
    segment,
    width,
)
from ..engine.layout_check import sheets_of
from ..engine.paper import A3, HEIGHT, MARGIN, Page, block_of, notes
from ..engine.sheet_files import Written, files_of, pdf_runs
from .channel import CONVERTER_HEADS, HEADS, around_page, channel_page, converter_channels, converter_notes
from .symbols import printed

Place = Callable[[float, float], Point]  # mm of the array to mm of the paper
LEAD = LineType("lead", 0.35)
SCALES = (5.0, 2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01)  # ISO 5455
ONWARDS = 16.0  # mm of paper that a bundle is drawn beyond its tie
MARKS = 12.0  # mm of paper above the array for its marks


def plan_page(layout: Layout, says: list[str]) -> Page:
    """The page; `says` are its notes. The array lies with its rows' middle line upright."""
    d = layout.design
    half_x = layout.rear_end + d.wiring.gather
    half_y = layout.stack / 2
    x0, y0, x1, y1 = A3.area
    wide, high = x1 - x0 - 2 * MARGIN - 2 * (ONWARDS + 20.0), y1 - y0 - HEIGHT - 2 * MARGIN - MARKS
    f = next((s for s in SCALES if 2 * half_x * s <= wide and 2 * half_y * s <= high), SCALES[-1])
    middle = ((x0 + x1) / 2, y1 - MARGIN - MARKS - half_y * f)

    def on(x: float, y: float) -> tuple[float, float]:
        return (middle[0] + x * f, middle[1] - y * f)  # y runs down, as seen from below

    items: list[Item] = []
    ends = {p.number for p in (layout.elements[0], layout.elements[-1])}
    for route in lead_routes(layout):
        place = route.place
        items += _element(layout, place, on, d.array.pitch * f > LETTERS + 2 or place.number in ends)
        flat = [on(x, y) for x, y, _ in route.points[:3]]
        items += [segment(a, b, LEAD, "leader") for a, b in zip(flat, flat[1:]) if a != b]
        items.append(DrawnArc(flat[0], 0.6, line=VISIBLE, role="leader"))
    named: dict[float, float] = {}
    for board in boards(layout):
        side = 1.0 if board.places[0].row == 1 else -1.0
        tie = on(side * half_x, (board.places[0].y + board.places[-1].y) / 2)
        end = (tie[0] + side * ONWARDS, tie[1])
        items += [
            DrawnArc(tie, 1.2, line=VISIBLE, role="leader"),
            segment((tie[0] + side * 1.2, tie[1]), end, VISIBLE, "leader"),
        ]
        if abs(tie[1] - named.get(side, 1e9)) < 2 * LETTERS:
            continue  # a long row: those between are named in the list
        named[side] = tie[1]
        name = f"A{board.number}-J2"
        start = end[0] + side * 1.5 - (width(name, LETTERS) if side < 0 else 0.0)
        items.append(Text((start, tie[1] - LETTERS / 2), name, LETTERS))
    items += _marks(layout, on)
    scale = f"{f:g}:1" if f >= 1 else f"1:{1 / f:g}"
    said, _ = notes((x0 + MARGIN, y0 + HEIGHT), says, x1 - x0 - 180.0 - 3 * MARGIN)
    return Page(A3, scale, (*items, *said), "Wiring plan")


def plan_notes(layout: Layout) -> list[str]:
    w, count = layout.design.wiring, leads(layout)
    return [
        "Seen on the gauges' side",
        f"{count} leads an element, {w.wire}, {wire_metres(layout):g} m of each colour; cut lengths in the "
        f"wiring list, slack of {w.slack:.0%} in them",
        "Terminals lie in the recess, behind its wall (a), leads from there to the rear end (c); "
        "bonded from b to c, "
        f"{w.bonded:g} mm: strain relief",
        f"Tied {w.gather:g} mm behind (d), a bundle a board; from there {w.to_board:g} mm to the board, by "
        "the clamp on its plate (scene wiring)",
        "Number both ends of every lead; colours after IEC 60757",
    ]


def _element(layout: Layout, place: ElementPlace, on: Place, named: bool) -> list[Item]:
    side, sheet = (1.0 if place.row == 1 else -1.0), layout.design.sheet.thickness
    a = on(side * layout.pad_inner, place.y + sheet / 2)
    b = on(side * layout.rear_end, place.y - sheet / 2)
    hinge = on(side * place.hinge_x, place.y)[0]
    low, high = min(a[0], b[0]), max(a[0], b[0])
    items: list[Item] = [
        rectangle(low, a[1], high - low, b[1] - a[1], THIN, "outline"),
        segment((hinge, a[1]), (hinge, b[1]), THIN, "outline"),
    ]
    name = f"E{place.number}"
    room = abs(hinge - a[0])
    if named and room > width(name, LETTERS) + 1.0 and b[1] - a[1] > LETTERS + 1.0:
        items.append(Text(((hinge + a[0]) / 2, (a[1] + b[1]) / 2 - LETTERS / 2), name, LETTERS, "middle"))
    return items


def _marks(layout: Layout, on: Place) -> list[Item]:
    """Letters over the first row: recess, strain relief, rear end, tie."""
    rear, wiring = layout.rear_end, layout.design.wiring
    items: list[Item] = []
    last = 0.0
    for letter, x in zip("abcd", (layout.recess_start, rear - wiring.bonded, rear, rear + wiring.gather)):
        px, top = on(x, -layout.stack / 2)
        if px - last > 4.0:
            items.append(segment((px, top + 1.0), (px, top + 6.0), THIN, "leader"))
            items.append(Text((px, top + 7.0), letter, LETTERS, "middle"))
            last = px
    return items


ROW = 5.5  # mm
CARD_HEADS = (*HEADS, "Switch", "Multiplexer", "Decoder", "Read at")
DESIGNATORS = (
    "Symbols IEC 60617, letters of designators IEC 81346-2: B gauge, C capacitor, D diode, J connector, "
    "Q transistor, R resistor, U circuit, W lead, X terminal"
)
LEAD_HEADS = ("Lead", "Element", "From", "To", "Colour", "Wire", "Cut to, mm", "Bundle")


def circuit_written(of: CommonTables, draft: bool = False, sample: bool = False) -> Written:
    """All sheets of a design's circuit as PDF and SVG.

    Raises CheckFailure if a layout is not clean, or the PDF lacks a component when read back.
    """
    design = taken_as(of, Design, "the circuit's sheets")
    name = f"{design.name}-circuit"
    made = files_of(circuit_sheets(design, draft, sample), name, "circuit", design.design)
    runs = " ".join(run for page in pdf_runs(made.pdf) for run in page)
    for gauge in netlist(Layout(design)).of_kind("gauge"):
        if gauge.designator not in runs:
            raise CheckFailure(f"drawings: {name}: {gauge.designator} is missing; no drawing was written")
    return made


def circuit_sheets(design: Design, draft: bool = False, sample: bool = False) -> list[DrawnSheet]:
    """Every sheet, its layout clean; raises CheckFailure if it is not."""
    layout = Layout(design)
    circuit = netlist(layout)
    rows = [
        (e.designator, f"E{e.element}", e.start, e.end, e.colour, e.wire, f"{e.length:g}", f"{e.bundle}")
        for e in wiring(layout, circuit)
    ]
    if converter := converter_of(design):
        first = channel_page(circuit, converter_notes(layout, converter, DESIGNATORS))
        heads: tuple[str, ...] = CONVERTER_HEADS
        channels = [*converter_channels(circuit, wiring(layout, circuit))]
    else:
        first = channel_page(circuit, _channel_notes(layout))
        heads, channels = CARD_HEADS, [*_channels(circuit)]
    pages = [
        first,
        around_page(circuit),
        *_tables(heads, channels, "Circuit, all channels"),
        plan_page(layout, plan_notes(layout)),
        *_tables(LEAD_HEADS, rows, "Wiring list"),
    ]
    block = block_of(design.design, f"{design.name}-circuit", "Circuit and wiring", draft, sample)
    return sheets_of(replace(block, dimensioned=False), pages, draft)


def _channel_notes(layout: Layout) -> list[str]:
    r, inputs = layout.design.readout, len(boards(layout))
    address = len(MULTIPLEXERS[r.multiplexer].address)
    settled, at = ceil(settling_time(layout.design) * 1e6), instants(layout.design) * 1e3
    return [
        DESIGNATORS,
        f"The bridges' supply, EXC, is {r.excitation:g} V over GND, made from VPOS on each board; "
        f"VPOS {r.supply_positive:g} V, VNEG "
        f"{r.supply_negative:g} V, V5 5 V",
        "The address names the channel whose bridge is led to the amplifier; ENABLE high turns its switch "
        "on, all others are off; with ENABLE low no gauge is warm, and the amplifier's inputs rest at EXC",
        f"The card needs {inputs + address} digital outputs, A0 to A{address - 1} for all boards and one "
        f"ENABLE a board; and {inputs} differential input{'s' if inputs > 1 else ''}, OUT and GND of a board",
        f"{r.samples} samples a reading, {at[0]:.4g} to {at[-1]:.4g} ms after ENABLE, always at "
        f"the same instant within {jitter(layout.design) * 1e6:g} us"
        + (", by a clocked line of the card" if r.timing == "hardware" else ", by a program")
        + f": the gauge warms meanwhile; the output has settled after {settled} us",
        "All other channels are alike; of channels that are not used the switch and the third arm are left "
        "off, the other arms are links, so that their inputs lie at EXC",
    ]


def _channels(circuit: Netlist) -> Iterator[tuple[str, ...]]:
    """Every channel of every board, a row each."""
    leads: dict[int, list[Component]] = {}
    arms: dict[int, list[Component]] = {}
    connectors = {c.board: c for c in circuit.of_kind("connector") if c.part_no == TO_LEADS}
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
        gate = next(p for p in decoder.pins if p.net == f"E{n}_GATE")
        yield (
            f"{b}",
            pair[0].role[1:-1],
            f"E{n}",
            gauge.designator,
            f"{printed(arms[n][0])} to {printed(arms[n][2])}",
            f"{leads[n][0].designator} to {leads[n][-1].designator}",
            f"X{n}",
            f"{printed(connectors[b])}.{pins[0]} to {pins[-1]}",
            printed(circuit.of_element("switch", n)),
            f"{printed(multiplexer)}.{pair[0].number} +, .{pair[1].number} −",
            f"{printed(decoder)}.{gate.number} {gate.role}",
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
