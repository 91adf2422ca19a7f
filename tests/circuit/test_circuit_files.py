"""The circuit's files, read by readers of their own; the leads against a rule and a compass on the scene."""

from __future__ import annotations

import csv
import io
import math
import os
import re
import subprocess
import sys
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from variants import FACING_ROWS, variant

from tactcad.circuit import board_layout as boards
from tactcad.circuit.bridges import netlist
from tactcad.circuit.netlist_files import wiring
from tactcad.circuit.read_board import board_netlist
from tactcad.design.load import read
from tactcad.design.messages import CheckFailure
from tactcad.export import board_files, pipeline
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.leads import lead_routes
from tactcad.scenes import make_scene
from tactcad.scenes.moves import box

WORD = re.compile(r'[()]|"(?:\\.|[^"\\])*"|[^\s()"]+')


def expression(text: str) -> list:
    """A KiCad file's S-expression as nested lists, by a reader that knows nothing but brackets and quotes."""
    assert not WORD.sub("", text).strip()
    stack: list[list] = [[]]
    for word in WORD.findall(text):
        if word == "(":
            stack.append([])
        elif word == ")":
            done = stack.pop()
            stack[-1].append(done)
        else:
            stack[-1].append(re.sub(r"\\(.)", r"\1", word[1:-1]) if word[0] == '"' else word)
    (only,) = stack
    (whole,) = only
    return whole


def part(node: list, name: str) -> list:
    return next(x for x in node if isinstance(x, list) and x[0] == name)


@pytest.mark.parametrize("name", FACING_ROWS)
def test_kicads_netlist_read_by_another_reader(name):
    design = read(name)
    used, channels = max(map(len, design.array.row_arms)), 8
    whole = expression(board_files.kicad_file(design, board_netlist(design, used, 3)).decode())
    assert whole[0] == "export" and part(whole, "version") == ["version", "E"]
    components = part(whole, "components")[1:]
    refs = [part(c, "ref")[1] for c in components]
    assert len(set(refs)) == len(refs)
    kinds = Counter(ref.rstrip("0123456789") for ref in refs)
    # four a channel; besides supply, two of the filter, two a digital line; the AD621's gain needs none
    assert (kinds["Q"], kinds["U"], kinds["J"], kinds["R"]) == (channels, 4, 2, 4 * channels + 1 + 2 + 2 * 4)
    assert all(part(c, "footprint")[1].startswith("tactcad:") for c in components)
    nets = {
        part(net, "name")[1]: [(part(x, "ref")[1], part(x, "pin")[1]) for x in net if x[0] == "node"]
        for net in part(whole, "nets")[1:]
    }
    nodes = Counter(node for pins in nets.values() for node in pins)
    assert set(nodes.values()) == {1}, "a pin on two nets"
    assert {ref for ref, _ in nodes} == set(refs)
    known = {part(lib, "part")[1]: lib for lib in part(whole, "libparts")[1:]}
    for component in components:
        pins = part(known[part(part(component, "libsource"), "part")[1]], "pins")[1:]
        numbers = {part(pin, "num")[1] for pin in pins}
        ref = part(component, "ref")[1]
        assert {pin for r, pin in nodes if r == ref} <= numbers
    # the first channel by hand
    assert sorted(nets["/CH1_RED"]) == [("J2", "1"), ("R11", "1"), ("R14", "1")]
    assert sorted(nets["/CH1_PLUS"]) == [("J2", "2"), ("R14", "2"), ("U2", "19")]
    assert sorted(nets["/CH1_MINUS"]) == [("R12", "1"), ("R13", "2"), ("U2", "11")]
    assert sorted(nets["/CH1_FOOT"]) == [("J2", "3"), ("Q1", "3"), ("R13", "1")]


def test_every_board_has_the_header_that_is_bought():
    """The first board reads three elements, the second eight: both have one header, all its pins used."""
    design = variant({"array.row_arms": [[4, 7, 6], [8, 5, 4, 5, 7, 8, 5, 4]]})
    whole = expression(board_files.kicad_file(design, board_netlist(design, 3, 3)).decode())
    (header,) = (x for x in part(whole, "libparts")[1:] if part(x, "part")[1] == "HEADER-LEADS")
    numbers = {part(pin, "num")[1] for pin in part(header, "pins")[1:]}
    named = {part(pin, "name")[1] for pin in part(header, "pins")[1:]}
    used = {
        part(x, "pin")[1]
        for net in part(whole, "nets")[1:]
        for x in net
        if x[0] == "node" and part(x, "ref")[1] == "J2"
    }
    assert used == numbers == named == {str(i) for i in range(1, 27)}
    (line,) = (s for s in make_scene(design, "array").supplies if s.part_no == "HEADER-LEADS")
    values = {c.value for c in netlist(Layout(design)).components if c.part_no == "HEADER-LEADS"}
    assert values == {"26 pins"} and "26 pins" in line.designation


def test_table_and_kicads_file_say_the_same():
    design = read("macro-array")
    circuit = netlist(Layout(design))
    kicad = board_files.nets_in_kicad(board_files.kicad_file(design, circuit))
    assert kicad == board_files.nets_in_table(board_files.table_file(design, circuit))


def test_the_owner_stands_in_kicads_title_block():
    design = read("macro-array")
    owned = replace(design, design=replace(design.design, organisation='Our "lab"'))
    block = board_files.kicad_file(owned, netlist(Layout(owned))).decode()
    assert block.count('(company "Our \\"lab\\"")') == 1
    assert "(company)" in board_files.kicad_file(design, netlist(Layout(design))).decode()


def test_a_damaged_netlist_is_refused(monkeypatch):
    kept = board_files.kicad_bytes
    monkeypatch.setattr(
        board_files,
        "kicad_bytes",
        lambda *args: kept(*args).replace(b'(node (ref "B1") (pin "1")', b'(node (ref "B1") (pin "2")'),
    )
    with pytest.raises(CheckFailure, match="E1_TOP"):
        design = read("macro-array")
        board_files.kicad_file(design, netlist(Layout(design)))


def test_equal_bytes_under_any_hash_seed():
    script = (
        "import hashlib\nfrom tactcad.design.load import read\n"
        "from tactcad.export import board_files as f\n"
        "from tactcad.circuit.bridges import netlist\nfrom tactcad.parts.array.layout import Layout\n"
        "d = read('macro-array')\nfor make in (f.kicad_file, f.table_file, f.deck_file, f.wiring_file):\n"
        "    print(hashlib.sha256(make(d, netlist(Layout(d)))).hexdigest())"
    )
    said = {
        subprocess.run(
            [sys.executable, "-c", script],
            env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("0", "1", "12345")
    }
    assert len(said) == 1 and said.pop().count("\n") == 4


@pytest.mark.parametrize("name", FACING_ROWS)
@pytest.mark.parametrize("connection", ["three-wire", "two-wire"])
def test_leads_are_as_long_as_their_way_on_the_scene(name, connection):
    """Measured on the placed elements: the body's end and recess are read off the part's contour."""
    design = variant({"readout.connection": connection}, base=name)
    scene = make_scene(design, "array")
    placed = {
        p.designator: p for p in scene.placements if p.designator[0] == "E" and p.designator[1:].isdigit()
    }
    routes = {f"E{r.place.number}": r for r in lead_routes(Layout(design))}
    assert set(routes) == set(placed)
    groups: dict[tuple[float, int], list[float]] = {}
    rows = design.array.row_arms
    for i, designator in enumerate(sorted(placed, key=lambda d: int(d[1:]))):
        row = 0 if i < len(rows[0]) else 1
        index = i - (len(rows[0]) if row else 0)
        groups.setdefault((row, index // 8), []).append(_middle(placed[designator]))
    for i, designator in enumerate(sorted(placed, key=lambda d: int(d[1:]))):
        p, route = placed[designator], routes[designator]
        row, index = (0, i) if i < len(rows[0]) else (1, i - len(rows[0]))
        own = groups[row, index // 8]
        corners = [q for s in p.part.extrusion.outer for q in (s.start, s.end)]
        end = max(x for x, _ in corners)
        wall = [s for s in p.part.extrusion.outer if s.name == "recess_wall"]
        start = wall[0].start[0]
        middle = (own[0] + own[-1]) / 2
        along = end - (start + 0.5)  # a tool's breadth behind the wall
        along += math.hypot(design.wiring.gather, _middle(p) - middle) + design.wiring.to_board
        assert route.length == pytest.approx(along, abs=1e-6)
        assert route.cut % 5 == 0 and 0 <= route.cut - 1.1 * along < 5
        # the bundle leaves the array on its row's side
        assert math.copysign(1, route.points[-1][0]) == math.copysign(1, p.rotation[0][0])
    rows_listed = list(
        csv.DictReader(io.StringIO(board_files.wiring_file(design, netlist(Layout(design))).decode()))
    )
    count = 3 if connection == "three-wire" else 2
    assert len(rows_listed) == count * len(placed)
    for row_listed in rows_listed:
        assert float(row_listed["cut_length_mm"]) == routes[f"E{row_listed['element']}"].cut


@pytest.mark.parametrize("rows", [None, [[6.0] * 20, [5.0] * 3]])
def test_leads_run_by_clamp_and_socket_of_scene_wiring(rows):
    """Points of the ways, in the frame of an array that lies on its back, against the parts placed there;
    a lead of a board in line is as long from tie to socket as the design says, one aside is longer."""
    design = variant({"array.row_arms": rows} if rows else {})
    wired = make_scene(design, "wiring")
    bench = max(box(p)[1][2] for p in make_scene(design, "array").placements)
    ends = {
        kind: np.array([box(p) for p in wired.placements if p.designator.rstrip("0123456789") == kind])
        for kind in ("LC", "XS")
    }
    to_board = []
    for route in lead_routes(Layout(design)):
        tie, clamp, socket = np.array(route.points[2:]) * (1, -1, -1) + (0, 0, bench)
        middles = {kind: (e[:, 0] + e[:, 1]) / 2 for kind, e in ends.items()}
        n = np.argmin(np.linalg.norm(middles["XS"] - socket, axis=1))
        assert middles["LC"][n][:2] == pytest.approx(clamp[:2], abs=1e-5)
        assert ends["LC"][n][0][2] == pytest.approx(clamp[2])
        assert [*middles["XS"][n][:2], ends["XS"][n][1][2]] == pytest.approx(socket, abs=1e-5)
        to_board.append(math.dist(tie, clamp) + math.dist(clamp, socket))
    assert min(to_board) == pytest.approx(design.wiring.to_board, abs=1e-5)
    assert (max(to_board) > design.wiring.to_board + 10) == bool(rows)


def _middle(placement) -> float:
    """y of an element's mid-plane: half its thickness along its third axis from its origin."""
    half = placement.part.extrusion.thickness / 2
    return placement.origin[1] + placement.rotation[1][2] * half


def test_every_lead_joins_a_terminal_and_a_pin_of_its_own():
    layout = Layout(read("macro-array"))
    leads = wiring(layout, netlist(layout))
    assert len({lead.end for lead in leads}) == len(leads) == 30
    assert {lead.colour for lead in leads if lead.start.endswith(".1")} == {"RD", "WH"}
    assert {lead.colour for lead in leads if lead.start.endswith(".2")} == {"BK"}
    assert {lead.bundle for lead in leads} == {1, 2}, "a bundle a row"


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"readout.connection": "two-wire"},
        {"readout.multiplexer": "ADG1409"},
        {"readout.amplifier": "AD8221"},
        {"array.row_arms": [[4, 7, 6] * 5, [8, 5]]},
    ],
)
def test_the_bill_counts_the_netlist(changes):
    """Every component but a lead is a piece of its line of the bill, and no line has more; a board has a
    bare board and a cable; each colour's wire is as long as its leads."""
    design = variant(changes)
    layout = Layout(design)
    circuit = netlist(layout)
    counted = Counter(c.part_no for c in circuit.components if c.kind != "lead" and c.fitted)
    bill = {s.part_no: s for s in make_scene(design, "array").supplies}
    boards = counted["HEADER-CARD"]
    counted |= {name: boards for name in ("CIRCUIT-BOARD", "CABLE-CARD")}
    used_up = ("ADHESIVE", "COATING", "ASSEMBLY-OIL", "THREAD-LACQUER")
    billed = {n: s.qty for n, s in bill.items() if n not in used_up and "LEAD-WIRE" not in n}
    assert counted == billed
    metres: Counter[str] = Counter()
    for lead in wiring(layout, circuit):
        metres[f"LEAD-WIRE-{lead.colour}"] += lead.length / 1000
    wire = {n: s.qty for n, s in bill.items() if "LEAD-WIRE" in n}
    assert wire == pytest.approx(dict(metres))
    for name, length in wire.items():  # one in five, as gauges
        fifth = max(1, math.ceil(len(layout.elements) / 5)) / len(layout.elements)
        assert bill[name].spares == pytest.approx(fifth * length, abs=0.005)
    assert all(s.spares >= 1 for n, s in bill.items() if n in billed)
    assert bill["STRAIN-GAUGE"].spares == max(1, math.ceil(bill["STRAIN-GAUGE"].qty / 5))


@pytest.mark.parametrize("converter", ["card", "AD7124-8"])
def test_the_bill_names_what_is_on_the_boards(converter, tmp_path):
    """bom.csv against the table of the board that both rows have, and a gauge an element."""
    design = variant({"readout.converter": converter})
    (board,) = boards.laid_out(Layout(design))
    own = csv.DictReader(io.StringIO(board_files.bill_csv(board, ()).decode()))
    meant = {"STRAIN-GAUGE": {f"B{n}" for n in range(1, 11)}}
    for row in own:
        if row["fitted"] == "yes":
            names = {f"A{b}-{name}" for b in (1, 2) for name in row["designators"].split()}
            meant[row["part_no"]] = meant.get(row["part_no"], set()) | names
    pipeline._write_bills(tmp_path, design, [make_scene(design, "array")], [])
    bill = csv.DictReader(io.StringIO((tmp_path / "bom.csv").read_text()))
    told = {row["part_no"]: set(row["designators"].split()) for row in bill}
    assert {part_no: told[part_no] for part_no in meant} == meant


@pytest.mark.parametrize(
    ("design", "boards"), [({}, 2), ({"array.row_arms": [[4]]}, 1), ({"array.row_arms": [[4] * 9, [5]]}, 3)]
)
def test_boards_take_a_rows_elements(design, boards):
    circuit = netlist(Layout(variant(design)))
    assert len(list(circuit.of_kind("amplifier"))) == boards


def test_a_gain_resistor_of_the_series():
    """AD8221 at a gain of 100: 49.4 kohm/99 = 499 ohm, which E192 has."""
    circuit = netlist(Layout(variant({"readout.amplifier": "AD8221"})))
    resistor = next(c for c in circuit.components if c.part_no == "GAIN-RESISTOR")
    assert resistor.figure("ohm") == pytest.approx(499.0)
    assert circuit.on_board("amplifier", 1).figure("gain") == pytest.approx(1 + 49400 / 499)


def test_a_net_or_a_lead_that_is_missing_is_found():
    design = variant()
    circuit = netlist(Layout(design))
    nets = board_files.nets_in_table(board_files.table_file(design, circuit))
    board_files.check_nets("table", nets, circuit)
    for name in ("EXC1", next(iter(sorted(nets)))):
        with pytest.raises(CheckFailure, match=f"other nets: {name}"):
            board_files.check_nets("table", {k: v for k, v in nets.items() if k != name}, circuit)
    data = board_files.wiring_file(design, circuit)
    head, first, rest = data.decode().split("\n", 2)
    for text in (f"{head}\n{rest}", f"{head}\n{first}\n{first}\n{rest}"):
        with pytest.raises(CheckFailure, match="every lead"):
            board_files.check_leads(text.encode(), circuit)


def test_what_is_verified_of_a_part_stands_in_the_bill(monkeypatch):
    """Of every part by its own row: an amplifier whose figures were read says so, and no other line."""
    from dataclasses import replace

    from tactcad.design import sensing

    kinds = (
        (sensing.AMPLIFIERS, "AD621"),
        (sensing.SWITCHES, "IRLML6244"),
        (sensing.MULTIPLEXERS, "ADG1407"),
        (sensing.COMPLETIONS, "foil-0.01"),
    )
    lines = ("AD621ARZ", "IRLML6244TRPBF", "ADG1407BRUZ", "BRIDGE-RESISTOR")
    for (table, name), line in zip(kinds, lines, strict=True):
        for verified in (True, False):
            monkeypatch.setitem(table, name, replace(table[name], verified=verified))
            bill = {s.part_no: s for s in make_scene(variant(), "array").supplies}
            assert bill[line].verified is verified and bill[line].mpn == table[name].mpn


def test_another_tolerance_than_the_named_resistors_is_ordered_by_its_figures():
    """A design's own tolerance stands in the designation, and no maker's number that has another."""
    bill = {
        s.part_no: s for s in make_scene(variant({"readout.completion_tolerance": 0.005}), "array").supplies
    }
    line = bill["BRIDGE-RESISTOR"]
    assert "0.5 %" in line.designation and line.mpn == "" and not line.verified


@pytest.mark.parametrize(
    ("kind", "ohm", "mpn"),
    [
        ("film-0.1", 120, "RT0805BRB07120RL"),
        ("film-1", 1000, "RC0805FR-071KL"),
        ("film-1", 350, ""),  # E192 has 348 and 352
    ],
)
def test_a_film_resistor_has_a_makers_number_where_its_value_is_sold(kind, ohm, mpn):
    changes = {"readout.completion": kind, "gauge.resistance": float(ohm), "readout.excitation": 2.0}
    bill = {s.part_no: s for s in make_scene(variant(changes), "array").supplies}
    line = bill["BRIDGE-RESISTOR"]
    assert (
        line.mpn == mpn and line.manufacturer == ("Yageo" if mpn else "") and "any maker" in line.designation
    )
