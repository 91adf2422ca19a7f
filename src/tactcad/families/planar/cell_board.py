"""The board under the cells: a chip below every magnet, its capacitor, buses, their connector.

    +----------------------------+
    | [U] [U] [U]  lines of a bus on the lower layer above each row of chips
    | [U] [U] [U]
    |  |    |      trunks between columns: above on the upper layer, from the last row on on the lower
    +--|----|--------------------+  the housing ends here
    |   fan, pull-ups, J1        |  tongue
    +----------------------------+

Chips are turned by 180 degrees, so that nothing but trunks leaves the last row towards the tongue. All places
are fixed, no router: they keep 0.2 mm between copper of two nets, and the vias' openings in the planes apart.

Below the pitch ROOMY chips have no room for that between them. A bus takes whole rows. Between the corners of
four chips lie vias of one's lines and one of the supply; lines and trunks are on the lower layer. Capacitors
lie on the tongue, in line with their chips, and the planes join them: the jaw's 12 mm at a width of 28 mm are
0.3 nH (mu0 times the planes' distance, a square), a via some 1 nH; what the chip's maker asks for is unread.

    | |  .---.----.--  |     lines of a row, joined by SDA's trunk; SCL's lie above them
    | | [U]  [U]  [U]  |     trunks of further buses pass below the first column's chips
    | |  |             |     tongue: capacitors, fan, pull-ups, J1
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from math import ceil

from tactcad.circuit.board_layout import Routing
from tactcad.circuit.copper import BOTTOM, CLEARANCE, VIA, BoardCopper, Point, Via
from tactcad.circuit.footprints import FLUSH, footprint
from tactcad.circuit.netlist import GROUND, Component, Netlist, Pin
from tactcad.circuit.printed import HIGH
from tactcad.circuit.printed import width as printed_width
from tactcad.contour import rectangle
from tactcad.parts.array.supplies import supplies as bill_lines
from tactcad.parts.bought.electronic_parts import BOARD, Supply
from tactcad.parts.language.description import Extrusion, Material, Part, Process, Purchase
from tactcad.parts.language.metric import METRIC

from .cell_layout import PlanarLayout
from .parts import SCREW, bored, copper_room, frame_room, screw_places

GLASS_EPOXY, PACKAGE = Material("FR4", 1850), Material("moulded package", 1800)
SUPPLY = "VDD"
LEAST_PITCH, ROOMY = 4.0, 8.0  # mm, of chips without and with room for capacitors and trunks between them
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
# Closer: vias' places from a chip's middle, before it is turned; x of each bus's trunks from the middle of
# the first column, of SCL's of the first bus from the last one's
CLOSE = {"SCL": (-2.6, 1.4), "SDA": (-1.4, 1.4), SUPPLY: (-2.0, -1.4)}
CLOSE_TRUNKS = ({"SDA": 1.4, "SCL": 2.6}, {"SDA": -0.6, "SCL": 0.6}, {"SDA": -1.4, "SCL": -1.0})
AISLE, LINE, WAY = 2.0, 0.6, 2.1  # mm: tracks between chips, from a middle; a via to its line; to that way
CAP_ROW, FIRST_CAP = 2.2, 1.6  # mm between capacitors with their names, and from the housing
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
    return (_why_not_roomy if roomy(layout) else _why_not_close)(layout)


def roomy(layout: PlanarLayout) -> bool:
    return layout.design.planar.pitch >= ROOMY


def _why_not_roomy(layout: PlanarLayout) -> str:
    d, ways = layout.design, len(channels(layout))
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


def _why_not_close(layout: PlanarLayout) -> str:
    p, buses = layout.design.planar, layout.design.hall.buses
    used, most = ceil(p.rows / ceil(p.rows / buses)), min(layout.chip.addresses, 4 * len(CODES))
    if used < buses or buses > len(CLOSE_TRUNKS):
        pass_ = f"at most {len(CLOSE_TRUNKS)} pass"
        return f"buses take whole rows: {used} of {buses} hall.buses are used, {pass_}"
    if chips_a_bus(layout) > most:
        return f"buses take whole rows, and more than {most} chips would share one: more hall.buses"
    if any(have < need - 1e-9 for have, need in zip(frame_room(layout), copper_room(layout))):
        return (
            "tracks around the outer chips would pass under the metal frame: a wider housing.border or side"
        )
    pins = 2 + 2 * buses
    if 2.0 * layout.half[0] < max(PIN * (pins + 0.7), printed_width(_name(layout), HIGH) + 1.4):
        return "the connector or the board's name is wider than the board: a wider housing.border"
    first, last = layout.elements[0].x, layout.elements[-1].x
    ways = [first + x for at in CLOSE_TRUNKS[:buses] for x in at.values()]
    ways[1] += last - first
    if any(abs(x - way) < HEAD_ROOM for x, y in screw_places(layout) if y < 0.0 for way in ways):
        return "a screw's head would cover the trunks of a bus: other columns or housing.border"
    return ""


def bus_of(layout: PlanarLayout, number: int) -> tuple[int, str, int]:
    """A cell's bus, from 1 on, its chip's order code and address: cells are shared out in their order; a code
    has four addresses, by its pins A0 and A1."""
    bus, place = divmod(number - 1, chips_a_bus(layout))
    code = list(CODES)[place // 4]
    return 1 + bus, code, CODES[code] + place % 4


def chips_a_bus(layout: PlanarLayout) -> int:
    p, buses = layout.design.planar, layout.design.hall.buses
    return ceil(p.rows * p.columns / buses) if roomy(layout) else p.columns * ceil(p.rows / buses)


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
    return [x for x in middles if all(abs(x + dx - s) >= HEAD_ROOM for dx in TRUNKS.values() for s in screws)]


def tongue(layout: PlanarLayout) -> float:
    """Length of the board beyond the housing, mm, on the side of the least y; 0 without a board's layout."""
    if why_none(layout):
        return 0.0
    caps = 0.0 if roomy(layout) else CAP_ROW * layout.design.planar.rows + 1.0
    return ceil(2.0 * (EDGE + RESISTOR + BELOW_FAN + ROW * 2 * layout.design.hall.buses + 0.5 + caps)) / 2.0


def _name(layout: PlanarLayout) -> str:
    return f"{layout.design.design.board_no} {layout.design.design.of_board.revision}"


def _pair(name: str, kind: str, value: str, part_no: str, package: str, *nets: str) -> Component:
    """A part of two pins."""
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
        order, body, cap = layout.chip.name + code, "QFN-16" if roomy(layout) else FLUSH, f"C{e.number}"
        said = f"{order} 0x{at:02X}"
        parts.append(Component(f"U{e.number}", "sensor", said, order, pins, element=e.number, footprint=body))
        parts.append(_pair(cap, "capacitor", "100 nF", "CAPACITOR-100N-0603", "0603", SUPPLY, GROUND))
    last, lines = f"C{len(layout.elements) + 1}", lines_of(layout)
    parts.append(_pair(last, "capacitor", "10 uF", "CAPACITOR-10U", "1206", SUPPLY, GROUND))
    for i, net in enumerate(lines, start=1):
        parts.append(_pair(f"R{i}", "resistor", f"{PULL_UP:g} ohm", "PULL-UP-4K7", "0805", net, SUPPLY))
    pins = tuple(Pin(str(i), f"{i} {net}", net) for i, net in enumerate((SUPPLY, GROUND, *lines), start=1))
    said, body = f"{len(pins)} pins", f"pin-header-{len(pins)}"
    parts.append(Component("J1", "connector", said, "HEADER-BUS", pins, footprint=body))
    return Netlist(f"{layout.design.name}-board", 0.0, (), tuple(parts))


def lines_of(layout: PlanarLayout) -> list[str]:
    """Nets of the buses in the order of their trunks and of the connector's pins after supply and ground."""
    buses = range(1, layout.design.hall.buses + 1)
    return [f"{line}{bus}" for bus in (buses if roomy(layout) else reversed(buses)) for line in TRUNKS]


def made(layout: PlanarLayout) -> tuple[BoardCopper, ...]:
    """The board, if there is one (`why_none`)."""
    return () if why_none(layout) else (_laid_out(layout),)


def _laid_out(layout: PlanarLayout) -> BoardCopper:
    circuit, sheet = netlist(layout), Routing()
    board = {c.designator: c for c in circuit.components}
    half_x, half_y = layout.half
    width, height = 2.0 * half_x, 2.0 * half_y + tongue(layout)
    lines, roomy_ = lines_of(layout), roomy(layout)
    taps: dict[str, list[Point]] = {net: [] for net in lines}  # vias that each net's lines reach
    rows = rows_of(layout)
    for e in layout.elements:
        at, chip, cap = (e.x + half_x, half_y - e.y), board[f"U{e.number}"], board[f"C{e.number}"]
        slot = rows[e.row].index(bus_of(layout, e.number)[0])
        if roomy_:
            found = _cell(sheet, chip, cap, at, LINES[slot])
        else:
            found = _close_cell(sheet, chip, at, layout.design.planar.pitch, e.column == 1)
            down = 2.0 * half_y + FIRST_CAP + CAP_ROW * (e.row - 1)
            _close_cap(sheet, cap, (at[0], down), layout, e.column)
        for net, tap in found:
            taps[net].append(tap)
    ways = _header(sheet, board, lines, width / 2.0, height - EDGE)
    trunks = (_trunks if roomy_ else _close_trunks)(layout, sheet, taps)
    for net, (x, down), end, rank in zip(lines, trunks, ways, range(len(ways)), strict=True):
        base = height - EDGE - RESISTOR - BELOW_FAN
        turn = base - ROW * (rank if x < end[0] else len(ways) - 1 - rank)
        sheet.path(net, (x, down), (x, turn), (end[0], turn), end, layer=BOTTOM)
    holes = tuple((x + half_x, half_y - y, METRIC[SCREW].clearance) for x, y in screw_places(layout))
    long = printed_width(_name(layout), HIGH)
    name = (max(width / 4.0, long / 2.0 + 0.7), height - EDGE - RESISTOR - 3.5)
    placed, tracks, vias = tuple(sheet.placed), tuple(sheet.tracks), tuple(sheet.vias)
    planes, t = {"In1.Cu": GROUND, "In2.Cu": SUPPLY}, layout.design.hall.board
    return BoardCopper(circuit, width, height, placed, tracks, vias, holes, planes, t, name)


def _trunks(layout: PlanarLayout, sheet: Routing, taps: dict[str, list[Point]]) -> Iterator[Point]:
    """Lines of the rows, trunks, and their ways down from the last row; yields the end of each."""
    half_x, half_y = layout.half
    last_row, middles = half_y - layout.elements[0].y, channels(layout)
    for net, points in taps.items():
        line, bus = net[:3], int(net[3:])
        x = round(middles[bus - 1] + half_x + TRUNKS[line], 3)
        ys = sorted({y for _, y in points})
        for y in ys:
            along = sorted({*(px for px, py in points if py == y), x})
            sheet.path(net, *((px, y) for px in along), layer=BOTTOM)
            sheet.vias.append(Via(net, (x, y)))
        down = round(last_row + DOWN[line], 3)
        sheet.via(net, (x, ys[0]), (x, down), width=0.2)
        yield x, down


def _close_trunks(layout: PlanarLayout, sheet: Routing, taps: dict[str, list[Point]]) -> Iterator[Point]:
    """The same on the lower layer alone."""
    first = layout.half[0] + layout.elements[0].x
    for net, points in taps.items():
        line, bus = net[:3], int(net[3:])
        x = round(first + CLOSE_TRUNKS[bus - 1][line], 3)
        up = max(px for px, _ in points) if line == "SCL" else x  # the trunk along the rows of this bus
        meets = [y for px, y in points if px == up]
        for y in sorted({y for _, y in points}):
            if along := sorted(px for px, py in points if py == y and px != up):
                way = round(y + (LINE if line == "SDA" else -LINE), 3)
                for px in along:
                    sheet.path(net, (px, y), (px, way), layer=BOTTOM)
                sheet.path(net, *((px, way) for px in sorted({*along, up})), layer=BOTTOM)
                meets.append(way)
        down = max(meets) if bus == 1 or line == "SDA" else max(y for _, y in points) + WAY
        sheet.path(net, (up, min(meets)), (up, down), (x if bus > 1 else up, down), layer=BOTTOM)
        yield (x if bus > 1 else up), down


def _close_cell(
    sheet: Routing, chip: Component, at: Point, pitch: float, first: bool
) -> Iterator[tuple[str, Point]]:
    """A chip of the first column or another; yields as `_cell`."""
    reach = AISLE if first else pitch - AISLE  # x of the next aisle, whose track is on the supply
    there, pad, nets = _chip(sheet, chip, at, lambda y: ((reach, y),))
    x, y = CLOSE[SUPPLY]
    sheet.via(SUPPLY, *there(pad["CS"], (x, pad["CS"][1]), (x, y)), width=0.2)
    sheet.path(SUPPLY, *there(pad["VDD"], (pad["VDD"][0], -AISLE), (x + LINE, -AISLE), (x, y)))
    x = pad["VDD_IO"][0]
    sheet.path(SUPPLY, *there(pad["VDD_IO"], (x, AISLE), (AISLE if first else x + pitch, AISLE)))
    if first:
        sheet.via(SUPPLY, *there((AISLE, AISLE), (AISLE, y)), width=0.2)
    (x, y), low = CLOSE["SCL"], pad["SCL"][1]
    sheet.via(
        nets["SCL"], *there(pad["SCL"], (-AISLE, low), (-AISLE, y - 0.4), (x + 0.2, y), (x, y)), width=0.2
    )
    x, y = CLOSE["SDA"]
    sheet.via(nets["SDA"], *there(pad["SDA"], (pad["SDA"][0], y), (x, y)), width=0.2)
    yield from ((nets[line], there(CLOSE[line])[0]) for line in ("SCL", "SDA"))


def _close_cap(sheet: Routing, cap: Component, at: Point, layout: PlanarLayout, column: int) -> None:
    """A chip's capacitor on the tongue: it shares its vias with those beside it, so supply and ground change
    sides from one to the next."""
    right, left = (SUPPLY, GROUND) if column % 2 else (GROUND, SUPPLY)
    pads = sheet.place(cap, at, 180 if right == SUPPLY else 0)
    ends = {net: pads[number] for net, number in ((SUPPLY, "1"), (GROUND, "2"))}
    sheet.via(right, ends[right], (at[0] + AISLE, at[1]))
    beside = (at[0] + AISLE - (2.0 * AISLE if column == 1 else layout.design.planar.pitch), at[1])
    if column == 1:
        sheet.via(left, ends[left], beside)
    else:
        sheet.path(left, ends[left], beside, width=0.3)


def _chip(
    sheet: Routing, chip: Component, at: Point, outside: Callable[[float], tuple[Point, ...]]
) -> tuple[Callable[..., list[Point]], dict[str, Point], dict[str, str]]:
    """A chip, turned, with its pins on ground joined to its slug, and its straps to the supply by a way
    `outside`; returns what turns places, and pads and nets by role."""

    def there(*points: Point) -> list[Point]:
        return [(round(at[0] - x, 3), round(at[1] - y, 3)) for x, y in points]

    nets = {p.role: p.net for p in chip.pins}
    pads = {pad.number: (pad.x, pad.y) for pad in footprint(chip.footprint).pads}
    pad = {role: pads[str(number)] for role, number in PINS.items()}
    sheet.place(chip, at, 180)
    sheet.vias.append(Via(GROUND, there((0.0, 0.0))[0]))
    x, y = pad["VSS"]
    sheet.path(GROUND, *there((x, y), (x, -1.05), (0.6, -0.6)))
    for role, inside in (("A1", ((0.6, -0.25),)), ("A0", ((1.05, -0.75), (0.6, -0.6)))):
        way = inside if nets[role] == GROUND else outside(pad[role][1])
        sheet.path(nets[role], *there(pad[role], *way))
    return there, pad, nets


def _cell(
    sheet: Routing, chip: Component, cap: Component, at: Point, lines: tuple[float, float]
) -> Iterator[tuple[str, Point]]:
    """A chip with its capacitor; yields each bus net and the via that its line must reach."""
    there, pad, nets = _chip(sheet, chip, at, lambda y: ((2.3, y), (2.75, -0.5)))
    sheet.place(cap, there(CAP)[0], 180)
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
    last = f"C{sum(c.kind == 'capacitor' for c in board.values())}"
    cap = sheet.place(board[last], ((x0 + x1) / 2.0, above))
    for number, x, net in (("1", x0, SUPPLY), ("2", x1, GROUND)):
        sheet.path(net, cap[number], (x, above), (x, y), width=0.3)
    for i, net in enumerate(lines, start=1):
        x, _ = at[str(i + 2)]
        pads = sheet.place(board[f"R{i}"], (x, above), 90)
        sheet.path(net, (x, y), pads["1"])
        sheet.via(SUPPLY, pads["2"], (x + PIN / 2.0, pads["2"][1]))
    return [at[str(i + 2)] for i in range(1, len(lines) + 1)]


def board(layout: PlanarLayout) -> Part:
    """The chips' board, z = 0 its lower face; longer than the housing by its tongue."""
    d, (x, y), t = layout.design, layout.half, layout.design.hall.board
    what = f"bare board and its parts are ordered by their own lines, {BOARD} and those after it"
    if why_none(layout):
        what = f"board of {d.name}, {len(layout.elements)} x {layout.chip.name}"
    return Part(
        part_no=f"{d.name}-board",
        name="Board",
        process=_process(layout),
        material=GLASS_EPOXY,
        body=Extrusion(rectangle(-x, -y - tongue(layout), x, y), t),
        features=tuple(bored("screw", screw_places(layout), METRIC[SCREW].clearance, t)),
        colour="#3f6b4b",
        purchase=Purchase(what),
    )


def _process(layout: PlanarLayout) -> Process:
    """Of board and chips: `supplies` asks for them where a board is laid out."""
    return "bought" if why_none(layout) else "included"


def order_of(layout: PlanarLayout, number: int) -> str:
    """The order number of a cell's chip; the chip's name where no board is laid out."""
    return layout.chip.name if why_none(layout) else layout.chip.name + bus_of(layout, number)[1]


def chip(layout: PlanarLayout, order: str) -> Part:
    """A chip's body, z = 0 on the board."""
    c, spares = layout.chip, 0
    bought = Purchase(f"on the fitted board: the chip is ordered by the line {order}")
    if why_none(layout):
        spares = max(1, len(layout.elements) // 10)
        bought = Purchase(f"three-axis Hall chip {order}", manufacturer=c.maker, mpn=order)
    return Part(
        part_no=f"{order}-chip",
        name=f"Hall chip {order}",
        process=_process(layout),
        material=PACKAGE,
        body=Extrusion(rectangle(-c.length / 2, -c.width / 2, c.length / 2, c.width / 2), c.height),
        colour="#2b2d31",
        purchase=bought,
        spares=spares,
    )


def supplies(layout: PlanarLayout) -> list[Supply]:
    """Lines of the bill: the bare board and all that is fitted on it; none if none is laid out."""
    if why_none(layout):
        return []
    fitted = Counter(c.part_no for c in netlist(layout).components)
    (x, y), orders = layout.half, dict.fromkeys(order_of(layout, e.number) for e in layout.elements)
    d, pins, maker = layout.design, 2 + len(lines_of(layout)), layout.chip.maker
    figures = {"thickness": d.hall.board, "length": 2 * x, "width": 2 * y + tongue(layout), "pins": pins}
    bare, *others = bill_lines("cells board", fitted, name=d.name, **figures)
    chips = [line for o in orders for line in bill_lines("cells chip", fitted, order=o, maker=maker)]
    return [bare, *chips, *others]
