"""The board under the cells: a chip below every magnet, its capacitor beside it, buses, their connector.

    +----------------------------+
    | [U] [U] [U]  lines of a bus on the lower layer above each row of chips
    | [U] [U] [U]
    |  |    |      trunks between columns: above on the upper layer, from the last row on on the lower
    +--|----|--------------------+  the housing ends here
    |   fan, pull-ups, J1        |  tongue
    +----------------------------+

Chips are turned by 180 degrees, so that nothing but trunks leaves the last row towards the tongue. All places
are fixed, no router: they keep 0.2 mm between copper of two nets, and the vias' openings in the planes apart,
at pitches from LEAST_PITCH on.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from math import ceil

from tactcad.circuit.board_layout import Routing
from tactcad.circuit.copper import BOTTOM, CLEARANCE, VIA, BoardCopper, Point, Via
from tactcad.circuit.footprints import footprint
from tactcad.circuit.letters import width as printed_width
from tactcad.circuit.netlist import GROUND, Component, Netlist, Pin
from tactcad.circuit.printed import HIGH
from tactcad.contour import rectangle
from tactcad.parts.bought.electronic_parts import BARE_BOARD, BOARD, ELECTRONIC, Supply, board_spares
from tactcad.parts.language.description import Extrusion, Hole, Material, Part, Process, Purchase
from tactcad.parts.language.metric import METRIC

from .cell_layout import PlanarLayout
from .parts import SCREW, screw_places

GLASS_EPOXY, PACKAGE = Material("FR4", 1850), Material("moulded package", 1800)
SUPPLY = "VDD"
LEAST_PITCH = 8.0  # mm, of the places below
# Of MLX90393: pins by the layout library's part MLX90393SLW-ABA-011-RE (SamacSys), first address by order
# code by RT-Thread's driver (lgnq/mlx90393, inc/mlx90393.h); the maker's sheet is unread.
PINS = {
    "INT": 1, "CS": 2, "SCL": 3, "SDA": 5, "MISO": 6, "TRIG": 7, "VDD_IO": 8, "A1": 11, "A0": 12, "VSS": 13,
    "VDD": 15, "EP": 17,
}  # fmt: skip
CODES = {"SLW-ABA-011": 0x0C, "SLW-ABA-012": 0x10, "SLW-ABA-013": 0x14, "SLW-ABA-014": 0x18}
BOARDS_FOR = "MLX90393"
PULL_UP = 4700.0  # ohm; chosen: 0.7 mA at 3.3 V, of I2C's 3 mA, and 0.4 us with 100 pF
# mm from a chip's middle, x to the right and y down, before it is turned
SCL_X, SDA_X, CAP, CAP_VIAS = -2.75, -0.75, (1.1, -2.9), (-1.6, 2.75)
LINES = ((2.5, 3.15), (3.8, 4.45))  # SCL's and SDA's lines of the row's first bus, and of its second
# mm of SDA's trunk and SCL's from the middle between two columns, and of their ways down from the last row
TRUNKS, DOWN = {"SDA": -0.4, "SCL": 0.5}, {"SDA": 1.2, "SCL": 1.9}
HEAD_ROOM = 2.3  # mm from a trunk to a screw's middle: its head is 3.8 wide
ROW, BELOW_FAN = 0.45, 1.75  # mm: of the fan, and from it to the resistors' middles
PIN, EDGE, RESISTOR = 2.54, 5.0, 3.4  # mm: header's pitch, from the edge; resistors from it


def why_none(layout: PlanarLayout) -> str:
    """What keeps a board from being laid out; "" if one is."""
    d = layout.design
    if layout.chip.name != BOARDS_FOR:
        return f"pins of {layout.chip.name} are unknown: boards are laid out for {BOARDS_FOR}"
    if d.planar.pitch < LEAST_PITCH:
        return f"the chips are {d.planar.pitch:g} mm apart, and the layout takes {LEAST_PITCH:g} mm or more"
    ways = len(channels(layout))
    if d.hall.buses > ways:
        pass_ = f"at most {ways} buses pass" if ways else "no bus passes"
        return f"{pass_} between columns and screws, and hall.buses is {d.hall.buses}"
    rows = rows_of(layout)
    if (most := max(map(len, rows.values()))) > len(LINES):
        return f"a row of chips is on {most} buses, at most {len(LINES)} reach it: fewer hall.buses"
    inside = (d.planar.pitch - d.planar.web - VIA) / 2.0 - CLEARANCE  # a via's middle, from an outer chip's
    if LINES[len(rows[d.planar.rows]) - 1][1] > inside + 1e-9:
        return "the last row of chips is on two buses, and their lines would pass under the metal frame"
    return ""


def bus_of(layout: PlanarLayout, number: int) -> tuple[int, str, int]:
    """A cell's bus, from 1 on, its chip's order code and address: cells are shared out in their order; a code
    has four addresses, by its pins A0 and A1."""
    bus, place = divmod(number - 1, ceil(len(layout.elements) / layout.design.hall.buses))
    code = list(CODES)[place // 4]
    return 1 + bus, code, CODES[code] + place % 4


def rows_of(layout: PlanarLayout) -> dict[int, list[int]]:
    """Buses of each row of cells."""
    rows: dict[int, list[int]] = {}
    for e in layout.elements:
        buses = rows.setdefault(e.row, [])
        if (bus := bus_of(layout, e.number)[0]) not in buses:
            buses.append(bus)
    return rows


def channels(layout: PlanarLayout) -> list[float]:
    """x of the middles between columns, in the layout's frame, whose trunks pass the screws."""
    p = layout.design.planar
    middles = [(i - p.columns / 2.0) * p.pitch for i in range(1, p.columns)]
    screws = [x for x, y in screw_places(layout) if y < 0.0]
    return [
        x
        for x in middles
        if all(abs(x + dx - screw) >= HEAD_ROOM for dx in TRUNKS.values() for screw in screws)
    ]


def tongue(layout: PlanarLayout) -> float:
    """Length of the board beyond the housing, mm, on the side of the least y; 0 without a board's layout."""
    if why_none(layout):
        return 0.0
    return ceil(2.0 * (EDGE + RESISTOR + BELOW_FAN + ROW * 2 * layout.design.hall.buses + 0.5)) / 2.0


def _component(name: str, kind: str, value: str, part_no: str, package: str, *nets: str) -> Component:
    pins = tuple(Pin(str(i), str(i), net) for i, net in enumerate(nets, start=1))
    return Component(name, kind, value, part_no, pins, footprint=package)  # type: ignore[arg-type]


def netlist(layout: PlanarLayout) -> Netlist:
    """Chips U by their cells' numbers, each with capacitor C; pull-ups R; connector J1."""
    parts: list[Component] = []
    for e in layout.elements:
        bus, code, at = bus_of(layout, e.number)
        nets = {
            "CS": SUPPLY, "SCL": f"SCL{bus}", "SDA": f"SDA{bus}", "VDD_IO": SUPPLY, "VDD": SUPPLY,
            "VSS": GROUND, "EP": GROUND, "A0": SUPPLY if at & 1 else GROUND,
            "A1": SUPPLY if at & 2 else GROUND,
        }  # fmt: skip
        pins = tuple(Pin(str(number), role, nets.get(role, "")) for role, number in PINS.items())
        order = layout.chip.name + code
        parts.append(
            Component(
                f"U{e.number}",
                "sensor",
                f"{order} 0x{at:02X}",
                order,
                pins,
                element=e.number,
                footprint="QFN-16",
            )
        )
        parts.append(
            _component(f"C{e.number}", "capacitor", "100 nF", "CAPACITOR-100N-0603", "0603", SUPPLY, GROUND)
        )
    last = len(layout.elements) + 1
    parts.append(_component(f"C{last}", "capacitor", "10 uF", "CAPACITOR-10U", "1206", SUPPLY, GROUND))
    lines = lines_of(layout)
    for i, net in enumerate(lines, start=1):
        parts.append(_component(f"R{i}", "resistor", f"{PULL_UP:g} ohm", "PULL-UP-4K7", "0805", net, SUPPLY))
    pins = tuple(Pin(str(i), f"{i} {net}", net) for i, net in enumerate((SUPPLY, GROUND, *lines), start=1))
    parts.append(
        Component(
            "J1", "connector", f"{len(pins)} pins", "HEADER-BUS", pins, footprint=f"pin-header-{len(pins)}"
        )
    )
    return Netlist(f"{layout.design.name}-board", 0.0, (), tuple(parts))


def lines_of(layout: PlanarLayout) -> list[str]:
    """Nets of the buses in the order of their trunks and of the connector's pins after supply and ground."""
    return [f"{line}{bus}" for bus in range(1, layout.design.hall.buses + 1) for line in TRUNKS]


def made(layout: PlanarLayout) -> tuple[BoardCopper, ...]:
    """The board, if there is one (`why_none`)."""
    return () if why_none(layout) else (_laid_out(layout),)


def _laid_out(layout: PlanarLayout) -> BoardCopper:
    circuit, sheet = netlist(layout), Routing()
    board = {c.designator: c for c in circuit.components}
    half_x, half_y = layout.half
    width, height = 2.0 * half_x, 2.0 * half_y + tongue(layout)
    lines, rows = lines_of(layout), rows_of(layout)
    taps: dict[str, list[Point]] = {net: [] for net in lines}  # vias that each net's lines reach
    for e in layout.elements:
        at = (e.x + half_x, half_y - e.y)
        slot = rows[e.row].index(bus_of(layout, e.number)[0])
        for net, tap in _cell(sheet, board[f"U{e.number}"], board[f"C{e.number}"], at, LINES[slot]):
            taps[net].append(tap)
    last_row = half_y - layout.elements[0].y
    ways = _header(sheet, board, lines, width / 2.0, height - EDGE)
    middles = channels(layout)
    for (net, points), end, rank in zip(taps.items(), ways, range(len(ways)), strict=True):
        line, bus = net[:3], int(net[3:])
        x = round(middles[bus - 1] + half_x + TRUNKS[line], 3)
        ys = sorted({y for _, y in points})
        for y in ys:
            along = sorted({*(px for px, py in points if py == y), x})
            sheet.path(net, *((px, y) for px in along), layer=BOTTOM)
            sheet.vias.append(Via(net, (x, y)))
        down = round(last_row + DOWN[line], 3)
        sheet.via(net, (x, ys[0]), (x, down), width=0.2)
        base = height - EDGE - RESISTOR - BELOW_FAN
        turn = base - ROW * (rank if x < end[0] else len(ways) - 1 - rank)
        sheet.path(net, (x, down), (x, turn), (end[0], turn), end, layer=BOTTOM)
    holes = tuple((x + half_x, half_y - y, METRIC[SCREW].clearance) for x, y in screw_places(layout))
    d = layout.design
    long = printed_width(f"{d.name}-board {d.design.revision}", HIGH)
    name = (max(width / 4.0, long / 2.0 + 0.7), height - EDGE - RESISTOR - 3.5)
    return BoardCopper(
        circuit,
        width,
        height,
        tuple(sheet.placed),
        tuple(sheet.tracks),
        tuple(sheet.vias),
        holes,
        {"In1.Cu": GROUND, "In2.Cu": SUPPLY},
        layout.design.hall.board,
        name,
    )


def _cell(
    sheet: Routing, chip: Component, cap: Component, at: Point, lines: tuple[float, float]
) -> Iterator[tuple[str, Point]]:
    """A chip, turned, with its capacitor; yields each bus net and the via that its line must reach."""

    def there(*points: Point) -> list[Point]:
        return [(round(at[0] - x, 3), round(at[1] - y, 3)) for x, y in points]

    nets = {p.role: p.net for p in chip.pins}
    pads = {pad.number: (pad.x, pad.y) for pad in footprint(chip.footprint).pads}
    pad = {role: pads[str(number)] for role, number in PINS.items()}
    sheet.place(chip, at, 180)
    sheet.place(cap, there(CAP)[0], 180)
    sheet.vias.append(Via(GROUND, there((0.0, 0.0))[0]))
    x, y = pad["VSS"]
    sheet.path(GROUND, *there((x, y), (x, -1.05), (0.6, -0.6)))
    for role, inside in (("A1", ((0.6, -0.25),)), ("A0", ((1.05, -0.75), (0.6, -0.6)))):
        x, y = pad[role]
        if nets[role] == GROUND:
            sheet.path(GROUND, *there((x, y), *inside))
        else:
            sheet.path(SUPPLY, *there((x, y), (2.3, y), (2.75, -0.5)))
    if SUPPLY in (nets["A0"], nets["A1"]):
        sheet.vias.append(Via(SUPPLY, there((2.75, -0.5))[0]))
    x, y = pad["CS"]
    sheet.via(SUPPLY, *there((x, y), (-2.2, y), (-2.75, -0.6)), width=0.2)
    x, y = pad["VDD_IO"]
    sheet.via(SUPPLY, *there((x, y), (2.5, y)), width=0.2)
    (x, y), one, two = pad["VDD"], *(CAP[0] + p.x for p in footprint(cap.footprint).pads)
    sheet.path(SUPPLY, *there((x, y), (x, CAP[1])))
    sheet.via(SUPPLY, *there((one, CAP[1]), (CAP_VIAS[0], CAP[1])))
    sheet.via(GROUND, *there((two, CAP[1]), (CAP_VIAS[1], CAP[1])))
    for role, x, y in (("SCL", SCL_X, lines[0]), ("SDA", SDA_X, lines[1])):
        points = [pad[role], (x, pad[role][1]), (x, y)]
        sheet.via(nets[role], *there(*points), width=0.2)
        yield nets[role], there((x, y))[0]


def _header(
    sheet: Routing, board: dict[str, Component], lines: list[str], middle: float, y: float
) -> list[Point]:
    """The connector with pull-ups and the supply's capacitor; the pins of the lines."""
    at = sheet.place(board["J1"], (middle, y))
    above = round(y - RESISTOR, 3)
    (x0, _), (x1, _) = at["1"], at["2"]
    cap = sheet.place(
        board[f"C{sum(c.kind == 'capacitor' for c in board.values())}"], ((x0 + x1) / 2.0, above)
    )
    for number, (x, _) in (("1", at["1"]), ("2", at["2"])):
        net = SUPPLY if number == "1" else GROUND
        sheet.path(net, cap[number], (x, above), (x, y), width=0.3)
    for i, net in enumerate(lines, start=1):
        x, _ = at[str(i + 2)]
        pads = sheet.place(board[f"R{i}"], (x, above), 90)
        sheet.path(net, (x, y), pads["1"])
        sheet.via(SUPPLY, pads["2"], (x + PIN / 2.0, pads["2"][1]))
    return [at[str(i + 2)] for i in range(1, len(lines) + 1)]


def board(layout: PlanarLayout) -> Part:
    """The chips' board, z = 0 its lower face; longer than the housing by its tongue."""
    d, (x, y) = layout.design, layout.half
    t = d.hall.board
    holes = tuple(
        Hole("screw", (*place, 0.0), (0, 0, 1), METRIC[SCREW].clearance, t, True)
        for place in screw_places(layout)
    )
    return Part(
        part_no=f"{d.name}-board",
        name="Board",
        process=_process(layout),
        material=GLASS_EPOXY,
        body=Extrusion(rectangle(-x, -y - tongue(layout), x, y), t),
        features=holes,
        colour="#3f6b4b",
        purchase=Purchase(f"board of {d.name}, {len(layout.elements)} x {layout.chip.name}"),
    )


def _process(layout: PlanarLayout) -> Process:
    """Of board and chips: `supplies` asks for them where a board is laid out."""
    return "bought" if why_none(layout) else "included"


def order_of(layout: PlanarLayout, number: int) -> str:
    """The order number of a cell's chip; the chip's name where no board is laid out."""
    return layout.chip.name if why_none(layout) else layout.chip.name + bus_of(layout, number)[1]


def chip(layout: PlanarLayout, order: str) -> Part:
    """A chip's body, z = 0 on the board."""
    c = layout.chip
    return Part(
        part_no=f"{order}-chip",
        name=f"Hall chip {order}",
        process=_process(layout),
        material=PACKAGE,
        body=Extrusion(rectangle(-c.length / 2, -c.width / 2, c.length / 2, c.width / 2), c.height),
        colour="#2b2d31",
        purchase=Purchase(f"three-axis Hall chip {order}", manufacturer=c.maker, mpn=order),
        spares=max(1, len(layout.elements) // 10),
    )


# Of what is fitted beside the chips: part number, description, designation; equal parts of any maker will do.
FITTED = (
    ("CAPACITOR-100N-0603", "capacitor of a chip", "ceramic capacitor 100 nF, 10 %, X7R, 16 V, 0603"),
    ("CAPACITOR-10U", "capacitor of the supply", "ceramic capacitor 10 uF, 10 %, X5R or X7R, 10 V, 1206"),
    ("PULL-UP-4K7", "pull-up of a bus line", "thick film resistor 4.7 kohm, 5 %, 0.1 W, 0805"),
    ("HEADER-BUS", "connector to the controller", "pin header 2.54 mm, {pins} pins in one row, straight"),
)


def supplies(layout: PlanarLayout) -> list[Supply]:
    """Lines of the bill: the bare board and all that is fitted on it; none if none is laid out."""
    if why_none(layout):
        return []
    d, (x, y), chips = layout.design, layout.half, layout.chip
    fitted = Counter(c.part_no for c in netlist(layout).components)
    pins = 2 + len(lines_of(layout))
    orders = dict.fromkeys(order_of(layout, e.number) for e in layout.elements)
    bare = (
        f"circuit board {d.name}-board by its Gerber files: FR-4 {d.hall.board:g} mm, 4 layers, "
        f"copper 35 um, tin or gold on pads, {2 * x:g} x {2 * y + tongue(layout):g} mm"
    )
    return [
        _supply(BOARD, "circuit board, bare", 1, bare, process=BARE_BOARD),
        *(
            _supply(name, "three-axis Hall chip", fitted[name], f"Hall chip {name}", chips.maker, name)
            for name in orders
        ),
        *(
            _supply(name, what, fitted[name], f"{order.format(pins=pins)}; any maker's")
            for name, what, order in FITTED
        ),
    ]


def _supply(
    part_no: str, what: str, qty: int, order: str, maker: str = "", mpn: str = "", process: str = ELECTRONIC
) -> Supply:
    return Supply(
        part_no,
        what,
        qty,
        "pcs",
        order,
        spares=board_spares(qty),
        consumable=False,
        manufacturer=maker,
        mpn=mpn,
        process=process,
    )
