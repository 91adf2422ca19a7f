"""A board's files: KiCad's board and netlist, its bill, places, solid, outline, Gerber files and drills; and
the circuit's: KiCad's netlist, the same as a table, the SPICE deck, the leads to cut. All are read back and
compared before they are published.

Its solid for the assembly is the bare board with the holes of its screws and ties, and a block for everything
that is fitted. mm, x and y as in the outline's DXF, z = 0 on the underside. Soldered pins, which protrude 1.4
mm below it, are left out.
"""

from __future__ import annotations

import csv
import io
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from typing import Any

from tactcad.circuit.copper import BoardCopper
from tactcad.circuit.footprints import Footprint
from tactcad.circuit.gerber import FUNCTIONS, gerber_files, places_csv
from tactcad.circuit.kicad_board import board_bytes
from tactcad.circuit.netlist import Component, Netlist
from tactcad.circuit.netlist_files import deck_bytes, harness_csv, kicad_bytes, netlist_csv, wiring_csv
from tactcad.contour import circle, rectangle
from tactcad.design.family import family_of
from tactcad.design.files import as_csv
from tactcad.design.messages import CheckFailure
from tactcad.design.tree import CommonTables
from tactcad.parts.bought.electronic_parts import Supply
from tactcad.parts.language.description import Extrusion, Material, Part
from tactcad.scenes.scene import UPRIGHT, Placement, Scene, rotation

from .shapes import Shapes
from .step_text import Header

FR4 = Material("FR-4", 1850)  # kg/m3, usual
SOLDERED = Material("electronic part", 2000)  # of no meaning: a block around it
TURNED = {
    0: UPRIGHT,
    90: rotation(((0, -1, 0), (1, 0, 0), (0, 0, 1))),
    180: rotation(((-1, 0, 0), (0, -1, 0), (0, 0, 1))),
    270: rotation(((0, 1, 0), (-1, 0, 0), (0, 0, 1))),
}
LAST = 1e-3  # mm, KiCad's last digit as written
NUMBER = r"([-\d.]+)"
EDGE = re.compile(rf'\(gr_line \(start {NUMBER} {NUMBER}\) \(end {NUMBER} {NUMBER}\) \(layer "Edge.Cuts"\)')
THICK = re.compile(rf"\(general \(thickness {NUMBER}\)\)")
HOLE = re.compile(rf'\(footprint "tactcad:hole" .*?\(at {NUMBER} {NUMBER}\)\n.*\n\(pad .*?\(drill {NUMBER}\)')


def board_scene(board: BoardCopper, name: str) -> Scene:
    """The board, and blocks on it under their designators."""
    part_no = f"{name}-bare"
    holes = tuple(circle((x, board.height - y), d) for x, y, d in board.holes)
    body = Extrusion(rectangle(0.0, 0.0, board.width, board.height), board.thickness, holes)
    bare = Part(part_no, "bare board", "reference", FR4, body, colour="#1f6b3a")
    blocks = {f: _block(f, name) for f in {p.footprint for p in board.placed if p.component.fitted}}
    placed = (
        Placement(
            p.component.designator,
            blocks[p.footprint],
            (p.at[0], board.height - p.at[1], board.thickness),
            TURNED[p.turn],
        )
        for p in board.placed
        if p.component.fitted
    )
    return Scene(name, (Placement("BOARD", bare), *placed))


def _block(f: Footprint, name: str) -> Part:
    x, y = f.body[0] / 2, f.body[1] / 2
    body = Extrusion(rectangle(-x, -y, x, y), f.height)
    return Part(f"{name}-{f.name}", f.name, "reference", SOLDERED, body, colour="#3a3a3a")


def board_step(board: BoardCopper, kicad: bytes, shapes: Shapes, header: Header) -> bytes:
    """The STEP file, read back and compared with the edge and the holes of KiCad's file."""
    from tactcad.solids.measure import bounding_box, holes_through

    from .step_file import read_assembly, scene_step

    scene = board_scene(board, header.name)
    data = scene_step(scene, {part.part_no: shapes.of(part) for part in scene.parts}, header)
    bare = scene.parts[0].part_no
    shape = read_assembly(data).shapes[bare]
    check_bare_board(bare, bounding_box(shape), holes_through(shape), kicad)
    return data


def check_bare_board(
    name: str, box: Sequence[Sequence[float]], cylinders: Sequence[tuple[float, float, float]], kicad: bytes
) -> None:
    """Raises CheckFailure if a solid's box or its holes (x, y, diameter) are not those of KiCad's file."""
    text = kicad.decode()
    (thick,) = (float(found) for found in THICK.findall(text))
    ends = [tuple(map(float, found)) for found in EDGE.findall(text)]
    xs, ys = ({v for e in ends for v in (e[k], e[k + 2])} for k in (0, 1))
    low, high = (min(xs), min(ys), 0.0), (max(xs), max(ys), thick)
    if max(abs(a - b) for got, meant in zip(box, (low, high)) for a, b in zip(got, meant)) > LAST:
        raise CheckFailure(f"{name}: the STEP file reads back in a box of {box}, not {low} to {high}")
    holes = [(float(x), max(ys) - float(y), float(d)) for x, y, d in HOLE.findall(text)]
    if sorted(_rounded(cylinders)) != sorted(_rounded(holes)):
        raise CheckFailure(f"{name}: the STEP file reads back with other holes than KiCad's board")


def _rounded(holes: Sequence[tuple[float, float, float]]) -> list[tuple[float, ...]]:
    return [tuple(round(v, 3) + 0.0 for v in hole) for hole in holes]


PAD = re.compile(r'\(pad "(\w+)" .*?\(net \d+ "/(\w+)"\)')


ENDS = (".kicad_pcb", ".net", "-bill.csv", "-places.csv", ".step")
BARE = (*(f"gerber/{layer}.gbr" for layer in FUNCTIONS), "gerber/PTH.drl", "gerber/NPTH.drl", "outline.dxf")


def files_of(
    board: BoardCopper, design: CommonTables, supplies: Iterable[Supply], shapes: Shapes, header: Header
) -> tuple[bytes, ...]:
    """The files of a fitted board, in the order of ENDS; `header` of its STEP file."""
    d = design.design.of_board
    kicad = board_bytes(board, printed_name(design), d.title, d.date, d.revision)
    check_nets("KiCad's board", nets_in_board(kicad), board.netlist)
    tables = kicad_file(design, board.netlist), bill_csv(board, supplies), places_csv(board)
    return kicad, *tables, board_step(board, kicad, shapes, header)


def bare_files(board: BoardCopper, design: CommonTables) -> list[bytes]:
    """The files of the bare board, in the order of BARE."""
    made = gerber_files(board, printed_name(design), design.design.of_board.date)
    check_flashes(board, made)
    return [*(made[path.removeprefix("gerber/")] for path in BARE[:-1]), outline_dxf(board)]


def board_record(design: CommonTables) -> dict[str, Any]:
    """All boards as plain data, for golden files: bill, nets, places, holes, tracks and vias by board."""
    family = family_of(design)
    if family.boards is None:
        return {}
    layout = family.layout(design)
    supplies = family.boards.supplies(layout)
    found: dict[str, Any] = {}
    for board in family.boards.made(layout):
        copper: dict[str, list] = {}
        for t in board.tracks:
            copper.setdefault(f"{t.net} {t.layer}", []).append([*t.start, *t.end, t.width])
        for v in board.vias:
            copper.setdefault(f"{v.net} vias", []).append([*v.at])
        found[board.netlist.name] = {
            "size_mm": [board.width, board.height, board.thickness],
            "holes_mm": [[*hole] for hole in board.holes],
            "bill": _by(bill_csv(board, supplies), "part_no", "value", "footprint", "fitted"),
            "nets": _by(netlist_csv(board.netlist), "designator", "pin"),
            "places": _by(places_csv(board), "designator"),
            "copper": copper,
        }
    return {design.design.board_no: found} if found else {}


def _by(table: bytes, *names: str) -> dict[str, str]:
    """Rows of a table as text, by these of their columns."""
    rows = csv.DictReader(io.StringIO(table.decode(), newline=""))
    return {" ".join(row[n] for n in names): ", ".join(row.values()) for row in rows}


def printed_name(design: CommonTables) -> str:
    return f"{design.design.board_no} {design.design.of_board.revision}"


def nets_in_board(data: bytes) -> Nets:
    """Nets of a KiCad board, from its pads."""
    nets: dict[str, set[tuple[str, str]]] = {}
    name = ""
    for line in data.decode().splitlines():
        if found := re.match(r'\(fp_text reference "([^"]+)"', line):
            name = found[1]
        elif found := PAD.match(line):
            nets.setdefault(found[2], set()).add((name, found[1]))
    return {net: frozenset(pins) for net, pins in nets.items()}


def check_flashes(board: BoardCopper, files: dict[str, bytes]) -> None:
    """Raises CheckFailure if pads and vias of a copper layer, as read back, are not the board's."""
    for layer in ("F_Cu", "B_Cu"):
        data = files[f"{layer}.gbr"].decode()
        read = Counter((int(x), int(y)) for x, y in re.findall(r"X(\d+)Y(\d+)D03", data))
        places = [at for _, pad, at, _ in board.pads if pad.drill or layer == "F_Cu"]
        places += [via.at for via in board.vias]
        meant = Counter((round(x * 1e6), round((board.height - y) * 1e6)) for x, y in places)
        if read != meant:
            raise CheckFailure(f"{layer}.gbr reads back with other pads than the board's")


BILL = (
    "part_no", "designators", "qty", "fitted", "value", "footprint", "manufacturer", "mpn", "designation",
    "source_verified",
)  # fmt: skip


def bill_csv(board: BoardCopper, supplies: Iterable[Supply]) -> bytes:
    """The bill of one board: a line a part and value, and one for unfitted places."""
    lines: dict[tuple[bool, str, str, str], list[Component]] = {}
    for c in board.netlist.components:
        lines.setdefault((not c.fitted, c.part_no, c.value, c.footprint), []).append(c)
    bought = {s.part_no: s for s in supplies}
    rows: list[tuple[object, ...]] = [BILL]
    for (off, part_no, value, package), components in sorted(lines.items()):
        names = " ".join(c.designator for c in components)
        line = bought.get(part_no)
        order = (line.manufacturer, line.mpn, line.designation) if line else ("", "", "")
        read = "true" if line and line.verified else "unread"
        rows.append((part_no, names, len(components), "no" if off else "yes", value, package, *order, read))
    return as_csv(rows)


def outline_dxf(board: BoardCopper) -> bytes:
    """Edge and holes without copper, mm, y upwards from the lower left corner (AutoCAD R12)."""
    out = ["0", "SECTION", "2", "HEADER", "9", "$ACADVER", "1", "AC1009", "0", "ENDSEC"]
    out += ["0", "SECTION", "2", "ENTITIES"]
    corners = board.corners()
    for (x1, y1), (x2, y2) in zip(corners, corners[1:] + corners[:1]):
        ends = (x1, board.height - y1, 0.0, x2, board.height - y2, 0.0)
        out += ["0", "LINE", "8", "OUTLINE"]
        for code, v in zip(("10", "20", "30", "11", "21", "31"), ends):
            out += [code, f"{v:.3f}"]
    for x, y, d in board.holes:
        out += ["0", "CIRCLE", "8", "HOLES"]
        for code, v in zip(("10", "20", "30", "40"), (x, board.height - y, 0.0, d / 2)):
            out += [code, f"{v:.3f}"]
    return ("\n".join([*out, "0", "ENDSEC", "0", "EOF"]) + "\n").encode()


Nets = dict[str, frozenset[tuple[str, str]]]  # designators and pins by net


def kicad_file(design: CommonTables, circuit: Netlist) -> bytes:
    """KiCad's netlist. Raises CheckFailure if it does not read back as the circuit."""
    d = design.design.of_board
    data = kicad_bytes(circuit, d.title, d.organisation, d.date, d.revision)
    check_nets("KiCad's netlist", nets_in_kicad(data), circuit)
    return data


def table_file(design: CommonTables, circuit: Netlist) -> bytes:
    """The netlist as CSV. Raises CheckFailure if it does not read back as the circuit."""
    data = netlist_csv(circuit)
    check_nets("the netlist's table", nets_in_table(data), circuit)
    return data


def deck_file(design: CommonTables, circuit: Netlist) -> bytes:
    """The SPICE deck, with the boards' tracks."""
    family = family_of(design)
    return deck_bytes(family.must("readout", "export").tracks(family.layout(design), circuit))


def wiring_file(design: CommonTables, circuit: Netlist) -> bytes:
    """The leads to cut. Raises CheckFailure if they are not the circuit's, each once."""
    family = family_of(design)
    data = wiring_csv(family.must("readout", "export").wiring(family.layout(design), circuit))
    check_leads(data, circuit)
    return data


def harness_file(design: CommonTables, circuit: Netlist) -> bytes:
    """Every wire with both its ends."""
    family = family_of(design)
    return harness_csv(circuit, family.must("readout", "export").wiring(family.layout(design), circuit))


def nets_in_kicad(data: bytes) -> Nets:
    """Nets of a KiCad netlist."""
    _, _, text = data.decode().partition("(nets")
    nets: dict[str, set[tuple[str, str]]] = {}
    name = ""
    for key, word, pin in re.findall(r'\((name|node \(ref) "([^"]*)"\)?(?: \(pin "([^"]*)"\))?', text):
        if key == "name":
            name = word.removeprefix("/")
        else:
            nets.setdefault(name, set()).add((word, pin))
    return {name: frozenset(nodes) for name, nodes in nets.items()}


def nets_in_table(data: bytes) -> Nets:
    """Nets of a netlist as CSV."""
    nets: dict[str, set[tuple[str, str]]] = {}
    for row in csv.DictReader(io.StringIO(data.decode(), newline=""), strict=True):
        if row["net"]:
            nets.setdefault(row["net"], set()).add((row["designator"], row["pin"]))
    return {name: frozenset(nodes) for name, nodes in nets.items()}


def check_nets(what: str, read: Nets, circuit: Netlist) -> None:
    """Raises CheckFailure if the nets read back are not the circuit's."""
    meant = {
        name: frozenset((c.designator, p.number) for c, p in nodes) for name, nodes in circuit.nets.items()
    }
    wrong = sorted(name for name in {*read, *meant} if read.get(name) != meant.get(name))
    if wrong:
        raise CheckFailure(f"{what} reads back with other nets: {', '.join(wrong[:3])}")


def check_leads(data: bytes, circuit: Netlist) -> None:
    """Raises CheckFailure if the wiring list does not name every lead of the circuit once."""
    rows = csv.DictReader(io.StringIO(data.decode(), newline=""))
    if sorted(row["lead"] for row in rows) != sorted(c.designator for c in circuit.of_kind("lead")):
        raise CheckFailure("the wiring list does not name every lead of the circuit once")
