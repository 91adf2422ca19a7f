"""The circuit's sheets, in frame and title block as all others: one channel in full, a matrix of all
channels, the leads' way, the wiring list. As PDF, read back, and SVG.

The symbols of IEC 60617 are our own few: the libraries' would have to be turned into the sheets' lines, and
their MOSFETs lack the substrate's arrow.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from math import ceil

from tactcad.circuit.bridges import netlist
from tactcad.circuit.netlist import GROUND, Component, Netlist
from tactcad.circuit.netlist_files import wiring
from tactcad.circuit.read_board import LOGIC, NEGATIVE, POSITIVE
from tactcad.design.family import taken_as
from tactcad.design.messages import CheckFailure
from tactcad.design.sensing import MULTIPLEXERS
from tactcad.design.tree import CommonTables, Design
from tactcad.parts.array.bridge_figures import instants, jitter, settling_time
from tactcad.parts.array.layout import ElementPlace, Layout
from tactcad.parts.array.leads import COLOURS, boards, lead_routes, leads
from tactcad.parts.array.supplies import wire_metres
from tactcad.parts.bought.electronic_parts import TO_CARD, TO_LEADS

from .engine.ink import (
    FRAME,
    LETTERS,
    THIN,
    VISIBLE,
    DrawnArc,
    DrawnSheet,
    Fill,
    Item,
    LineType,
    Point,
    Stroke,
    Text,
    rectangle,
    segment,
    width,
)
from .engine.layout_check import sheets_of
from .engine.paper import A3, HEIGHT, MARGIN, Page, block_of, notes
from .engine.sheet_files import Written, files_of, pdf_runs

ROW = 5.5  # mm
CHANNELS = (
    "Board, Channel, Element, Gauge, Arms, Leads, Terminals, Lead connector, Switch, Multiplexer, Decoder"
)
CHANNEL_HEADS = (*CHANNELS.split(", "), "Read at")
LEAD_HEADS = ("Lead", "Element", "From", "To", "Colour", "Wire", "Cut to, mm", "Bundle")
Place = Callable[[float, float], Point]  # mm of the array to mm of the paper
LEAD = LineType("lead", 0.35)
SCALES = (5.0, 2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01)  # ISO 5455
ONWARDS = 16.0  # mm of paper that a bundle is drawn beyond its tie
MARKS = 12.0  # mm of paper above the array for what is marked there
SUPPLIES = (POSITIVE, NEGATIVE, LOGIC)
RAIL = 262.0  # mm on the paper: the bridges' supply
RED, WHITE, MINUS, BLACK = 224.0, 210.0, 200.0, 176.0
LINE = LineType("circuit", 0.35)
SMALL = 1.8  # height of values' letters, ISO 3098


@dataclass(frozen=True)
class CircuitOrder:
    """The circuit of a design to draw."""

    design: CommonTables
    draft: bool = False
    sample: bool = False

    @property
    def name(self) -> str:
        return f"{self.design.name}-circuit"


def circuit_written(order: CircuitOrder) -> Written:
    """All its sheets as PDF and SVG.

    Raises CheckFailure where a layout is not clean, or the PDF lacks a component when read back.
    """
    design = taken_as(order.design, Design, "the circuit's sheets")
    sheets = circuit_sheets(design, order.draft, order.sample)
    made = files_of(sheets, order.name, "circuit", design.design)
    runs = " ".join(run for page in pdf_runs(made.pdf) for run in page)
    for gauge in netlist(Layout(design)).of_kind("gauge"):
        if gauge.designator not in runs:
            raise CheckFailure(
                f"drawings: {order.name}: {gauge.designator} is missing; no drawing was written"
            )
    return made


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
        around_page(circuit),
        *_tables(CHANNEL_HEADS, list(_channels(circuit)), "Circuit, all channels"),
        plan_page(layout, _plan_notes(layout)),
        *_tables(LEAD_HEADS, rows, "Wiring list"),
    ]
    block = block_of(design.design, f"{design.name}-circuit", "Circuit and wiring", draft, sample)
    return sheets_of(replace(block, dimensioned=False), pages, draft)


def _channel_notes(layout: Layout) -> list[str]:
    r, inputs = layout.design.readout, len(boards(layout))
    address = len(MULTIPLEXERS[r.multiplexer].address)
    settled, at = ceil(settling_time(layout.design) * 1e6), instants(layout.design) * 1e3
    return [
        "Symbols IEC 60617, letters of designators IEC 81346-2: B gauge, C capacitor, D diode, J connector, "
        "Q transistor, R resistor, U circuit, W lead, X terminal",
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


def _plan_notes(layout: Layout) -> list[str]:
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


def printed(component: Component) -> str:
    """The designator as on the board."""
    return component.designator.rpartition("-")[2]


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


def channel_page(circuit: Netlist, says: list[str]) -> Page:
    """The page of the first element's channel; `says` are its notes."""
    gauge = next(circuit.of_kind("gauge"))
    n, b = gauge.element, gauge.board
    items = [
        *_array_side(circuit, gauge),
        *_bridge(circuit, n),
        *_switching(circuit, n, b),
        *_amplifier(circuit, b),
        *_filter(circuit, b),
        *_card(circuit, b),
        *dashed(24.0, 150.0, 39.0, 92.0, f"on the array: E{n}"),
        *dashed(82.0, 112.0, 318.0, 164.0, f"board A{b}, channel 1"),
        *notes((26.0, 100.0), says, 190.0)[0],
    ]
    return Page(A3, "", tuple(items), "Circuit diagram")


def around_page(circuit: Netlist) -> Page:
    """The page of what stands around a board's circuits: supplies, digital lines, clamps."""
    gauge = next(circuit.of_kind("gauge"))
    own = [c for c in circuit.components if c.board == gauge.board and not c.element and c.fitted]
    drawn = {p.net for p in circuit.on_board("amplifier", gauge.board).pins if p.role.startswith("rg")}
    drawn |= {p.net for p in circuit.on_board("multiplexer", gauge.board).pins if p.role.startswith("out")}
    drawn |= {p.net for p in circuit.on_board("amplifier", gauge.board).pins if p.role in ("plus", "minus")}
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
    regulator = circuit.on_board("regulator", gauge.board)
    x, y = 40.0, 70.0
    items += box(x, y, 50.0, 6.0 * len(regulator.pins) + 4.0, printed(regulator), regulator.value)
    for i, pin in enumerate(regulator.pins):
        role = pin.role.replace("_", " ")
        text = f"{pin.number}  {role}: {_local(pin.net, gauge.board) or 'open'}"
        items.append(Text((x + 2.0, y + 6.0 * (len(regulator.pins) - 1 - i) + 3.0), text, 2.5))
    return Page(A3, "", tuple(items), "Supplies and digital lines")


def _first_digits(c: Component) -> bool:
    """Not of a channel that reads no element."""
    return c.kind != "resistor" or not 10 < int(printed(c)[1:]) < 90


def _local(net: str, board: int) -> str:
    """A board's own net without the board; a digital line before its resistor by its connector."""
    own = net.removeprefix(f"A{board}_")
    return f"J1, {net}" if own == net and re.fullmatch(r"A\d|ENABLE\d+", net) else own


def _between(at: Point, c: Component, board: int) -> list[Item]:
    """A component with two pins, upright, each pin's net at its end."""
    (x, top), bottom = at, (at[0], at[1] - 24.0)
    first, second = (_local(c.net(role), board) for role in "12")
    ends = [Text((x, top + 1.2), first, SMALL, "middle"), Text((x, bottom[1] - 3.0), second, SMALL, "middle")]
    if c.kind == "resistor":
        return [*resistor(at, bottom, printed(c), c.value), *ends]
    if c.kind == "diode":
        return [*diode(at, bottom, printed(c), c.value), *ends]
    lines = capacitor(at, bottom, printed(c), c.value, first)
    return [item for item in lines if item not in ground(bottom)] + ends[1:]


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


def _array_side(circuit: Netlist, gauge: Component) -> list[Item]:
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


def _bridge(circuit: Netlist, n: int) -> list[Item]:
    """The three other arms, and the lines to the multiplexer."""
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
        named = f"{_local(decoder.net(own), b)}{also}"
        items += stub((226.0, y), named)
    return items


def _fed(component: Component) -> str:
    """Which of its pins, but for channels that are not used, are on supplies and ground."""
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
    """What sets the gain between two pins on the triangle's lower edge: a resistor, a joint, or nothing."""
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


def _card(circuit: Netlist, b: int) -> list[Item]:
    """The connector to the converter's card, pin by pin."""
    connector = next(c for c in circuit.of_kind("connector") if c.part_no == TO_CARD and c.board == b)
    x, top = 360.0, 250.0
    items: list[Item] = [Text((x - 4.0, top + 8.0), f"{printed(connector)}, to the card")]
    for i, pin in enumerate(connector.pins):
        y = top - 7.0 * i
        items += [
            ring((x, y)),
            line((x - 8.0, y), (x - 1.0, y)),
            Text((x + 3.0, y - 1.2), f"{pin.number}  {pin.net}", 2.5),
        ]
    return items


def line(*points: Point) -> Stroke:
    """A connection through these points."""
    return Stroke(points, LINE, "symbol")


def dot(at: Point) -> Item:
    """Where connections join."""
    return DrawnArc(at, 0.5, line=VISIBLE, role="symbol")


def ring(at: Point) -> Item:
    """A terminal, or a connector's pin."""
    return DrawnArc(at, 1.0, line=LINE, role="symbol")


def resistor(top: Point, bottom: Point, name: str, value: str) -> list[Item]:
    """Upright, in the middle of its connection; name and value to its right."""
    x, middle = top[0], (top[1] + bottom[1]) / 2
    return [
        line(top, (x, middle + 5.0)),
        rectangle(x - 2.0, middle - 5.0, 4.0, 10.0, LINE, "symbol"),
        line((x, middle - 5.0), bottom),
        Text((x + 3.5, middle + 0.8), name),
        Text((x + 3.5, middle - 3.0), value, SMALL),
    ]


def resistor_below(left: Point, right: Point, y: float, name: str, value: str) -> list[Item]:
    """Level at height y, hung on two connections from above; name and value below it."""
    middle = (left[0] + right[0]) / 2
    return [
        line(left, (left[0], y), (middle - 5.0, y)),
        rectangle(middle - 5.0, y - 2.0, 10.0, 4.0, LINE, "symbol"),
        line((middle + 5.0, y), (right[0], y), right),
        Text((middle, y - 6.2), name, anchor="middle"),
        Text((middle, y - 9.6), value, SMALL, "middle"),
    ]


def strain_gauge(top: Point, bottom: Point, name: str, value: str) -> list[Item]:
    """A resistor that strain varies; name and value to its left."""
    x, middle = top[0], (top[1] + bottom[1]) / 2
    lines = [item for item in resistor(top, bottom, name, value) if not isinstance(item, Text)]
    near, far = (x - 4.5, middle - 6.0), (x + 4.5, middle + 6.0)
    return [
        *lines,
        line((near[0] - 2.5, near[1]), near, far),
        Text((x - 4.5, middle + 0.8), name, anchor="end"),
        Text((x - 4.5, middle - 3.0), value, SMALL, "end"),
    ]


def diode(top: Point, bottom: Point, name: str, value: str) -> list[Item]:
    """Upright, its cathode above; name and value to its right."""
    x, middle = top[0], (top[1] + bottom[1]) / 2
    return [
        line(top, (x, middle + 2.0)),
        line((x - 2.2, middle + 2.0), (x + 2.2, middle + 2.0)),
        Fill(((x, middle + 2.0), (x - 2.2, middle - 2.0), (x + 2.2, middle - 2.0)), "symbol"),
        line((x, middle - 2.0), bottom),
        Text((x + 3.5, middle + 0.8), name),
        Text((x + 3.5, middle - 3.0), value, SMALL),
    ]


def ground(at: Point) -> list[Item]:
    x, y = at
    return [line((x - w, y - 1.0 * k), (x + w, y - 1.0 * k)) for k, w in enumerate((2.5, 1.6, 0.7))]


def capacitor(top: Point, bottom: Point, name: str, value: str, net: str) -> list[Item]:
    """Upright from a net's name to ground."""
    x, middle = top[0], (top[1] + bottom[1]) / 2
    return [
        Text((x, top[1] + 1.2), net, SMALL, "middle"),
        line(top, (x, middle + 0.7)),
        line((x - 3.0, middle + 0.7), (x + 3.0, middle + 0.7)),
        line((x - 3.0, middle - 0.7), (x + 3.0, middle - 0.7)),
        line((x, middle - 0.7), bottom),
        *ground(bottom),
        Text((x + 4.0, middle + 1.2), name),
        Text((x + 4.0, middle - 2.8), value, SMALL),
    ]


def mosfet(drain: Point, gate: Point, name: str, value: str) -> list[Item]:
    """N-channel, enhancement, to ground; the gate to the right of the channel; name and value to its left."""
    x, y = drain
    channel, middle = x + 4.0, y - 8.0
    broken = [line((channel, middle + s - 1.2), (channel, middle + s + 1.2)) for s in (-4.0, 0.0, 4.0)]
    return [
        line(drain, (x, middle + 4.0), (channel, middle + 4.0)),
        *broken,  # enhancement
        line((channel, middle), (x, middle)),
        Fill(((channel, middle), (x + 1.2, middle + 1.1), (x + 1.2, middle - 1.1)), "symbol"),
        line((channel, middle - 4.0), (x, middle - 4.0)),
        line((x, middle), (x, middle - 10.0)),
        *ground((x, middle - 10.0)),
        line((channel + 1.2, middle - 4.0), (channel + 1.2, middle + 4.0)),
        line((channel + 1.2, middle), (gate[0], middle), gate),
        Text((x - 2.5, middle + 0.8), name, anchor="end"),
        Text((x - 2.5, middle - 3.0), value, SMALL, "end"),
    ]


def amplifier(at: Point, size: float) -> list[Item]:
    """A triangle from `at`, the middle of its left side; + above, - below."""
    x, y = at
    half = size / 2
    return [
        Stroke(((x, y + half), (x, y - half), (x + size, y)), LINE, "symbol", True),
        Text((x + 1.5, y + 0.3 * half + 1.0), "+"),
        Text((x + 1.5, y - 0.3 * half - 3.2), "−"),
    ]


def box(x: float, y: float, w: float, h: float, name: str, value: str) -> list[Item]:
    """A circuit as a box; name and value above it."""
    return [
        rectangle(x, y, w, h, LINE, "symbol"),
        Text((x, y + h + 5.2), name),
        Text((x, y + h + 1.4), value, SMALL),
    ]


def stub(start: Point, text: str) -> list[Item]:
    """A connection to the right that ends at its net's name."""
    end = (start[0] + 5.0, start[1])
    return [line(start, end), Text((end[0] + 1.0, end[1] - SMALL / 2), text, SMALL)]


def dashed(x: float, y: float, w: float, h: float, name: str) -> list[Item]:
    """What stands together: on the array, on a board."""
    around = LineType("around", THIN.width, (3.0, 1.5))
    return [rectangle(x, y, w, h, around, "symbol"), Text((x + 2.0, y + 2.0), name)]
