"""Boards: opened and checked by KiCad, their pins read back, their pads against KiCad's own library."""

from __future__ import annotations

import json
import os
import re
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from variants import variant

from tactcad.circuit import board_layout as boards
from tactcad.circuit.board_layout import lay_out
from tactcad.circuit.bridges import netlist
from tactcad.circuit.copper import BoardCopper
from tactcad.circuit.footprints import FOOTPRINTS, footprint
from tactcad.circuit.gerber import gerber_files, places_csv
from tactcad.circuit.kicad_board import board_bytes
from tactcad.circuit.netlist_files import kicad_bytes
from tactcad.circuit.read_board import board_netlist
from tactcad.design.messages import CheckFailure
from tactcad.export.board_files import check_flashes
from tactcad.parts.array.board_plate import BOARD_OUTLINE
from tactcad.parts.array.layout import Layout
from tactcad.parts.bought.electronic_parts import COMPLETION

KICADS_PYTHON = Path("/usr/bin/python3")
CONVERTERS = ("card", "AD7124-8")
LIBRARY = Path("/usr/share/kicad/footprints")


def laid_out(changes: dict | None = None, used: int = 5, wires: int = 3) -> BoardCopper:
    design = variant(changes or {})
    return lay_out(board_netlist(design, used, wires), BOARD_OUTLINE)


def needs_kicad() -> None:
    if not LIBRARY.is_dir() or not KICADS_PYTHON.is_file():
        if os.environ.get("TACTCAD_NEEDS_KICAD"):
            pytest.fail("KiCad is missing: apt-get install kicad kicad-footprints")
        pytest.skip("KiCad 6 is not there")


def in_kicad(file: Path, *folder: Path) -> tuple[str, dict[str, str]]:
    """What KiCad reports of its rules, and the net of every pin that it read."""
    report = file.with_suffix(".rpt")
    script = Path(__file__).with_name("in_kicad.py")
    done = subprocess.run(
        [KICADS_PYTHON, script, file, report, *folder],
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    return report.read_text(encoding="utf-8"), json.loads(done.stdout.splitlines()[-1])


def checked(board: BoardCopper, tmp_path: Path) -> None:
    """KiCad finds nothing, and its netlist is ours pin by pin."""
    file = tmp_path / "board.kicad_pcb"
    file.write_bytes(board_bytes(board, "NAME A", "title", "2026-01-01", "A"))
    report, pins = in_kicad(file)
    assert "Found 0 DRC violations" in report and "Found 0 unconnected pads" in report, report
    ours = {
        f"{c.designator}.{p.number}": f"/{p.net}" for c in board.netlist.components for p in c.pins if p.net
    }
    assert {pin: net for pin, net in pins.items() if net} == ours
    assert set(ours) <= set(pins)


def test_kicad_finds_nothing(tmp_path):
    needs_kicad()
    checked(laid_out(), tmp_path)


def test_kicad_finds_a_track_that_is_missing_and_one_that_is_too_near(tmp_path):
    needs_kicad()
    board = laid_out()
    gone = next(t for t in board.tracks if t.net == "CH2_PLUS")
    moved = replace(gone, start=(gone.start[0] + 0.5, gone.start[1]), end=(gone.end[0] + 0.5, gone.end[1]))
    file = tmp_path / "bad.kicad_pcb"
    bad = replace(board, tracks=(*(t for t in board.tracks if t != gone), moved))
    file.write_bytes(board_bytes(bad, "NAME A", "title", "2026-01-01", "A"))
    report, _ = in_kicad(file)
    assert "/CH2_PLUS" in report and "Found 0 DRC violations" not in report
    assert "clearance" in report and "unconnected" in report


@pytest.mark.slow  # starts KiCad
@pytest.mark.parametrize("wires", [2, 3])
@pytest.mark.parametrize(
    ("changes", "channels"),
    [
        ({}, 8),
        ({"readout.multiplexer": "ADG1409", "readout.completion": "film-0.1"}, 4),
        ({"readout.amplifier": "AD8221", "readout.gain": 20.0, "readout.completion": "film-1"}, 8),
        ({"readout.amplifier": "AD623", "readout.multiplexer": "ADG1409"}, 4),
        ({"readout.gain": 10.0}, 8),
    ],
)
def test_kicad_finds_nothing_on_any_board(changes, channels, wires, tmp_path):
    """Arrays of 1 to 20 elements read from 1 to all channels of a board."""
    needs_kicad()
    for used in range(1, channels + 1):
        checked(laid_out(changes, used, wires), tmp_path)


def pads_in_library(name: str) -> dict[str, tuple[float, ...]]:
    folder, _, part = name.partition(":")
    text = (LIBRARY / f"{folder}.pretty" / f"{part}.kicad_mod").read_text(encoding="utf-8")
    number = r"([-\d.]+)"
    found = re.findall(
        rf'\(pad "([^"]+)" \w+ \w+ \(at {number} {number}(?: \d+)?\) \(size {number} {number}\)', text
    )
    return {pin: tuple(map(float, numbers)) for pin, *numbers in found}


@pytest.mark.parametrize(
    "name", [f.name for f in FOOTPRINTS.values() if f.library] + [f"pin-header-{n}" for n in (9, 11, 26)]
)
def test_pads_lie_where_kicads_library_has_them(name):
    """Middles within 0.14 mm (the diode's; others 0.03), so that either's pads carry the package."""
    needs_kicad()
    land = footprint(name)
    theirs = pads_in_library(land.library)
    assert set(theirs) == {pad.number for pad in land.pads}
    header = name.startswith("pin")
    for pad in land.pads:
        x, y, w, h = theirs[pad.number]
        if header:  # theirs run down from the first pin
            x, y = y + land.pads[0].x, x
        assert abs(pad.x - x) < (0.14 if name == "SOD-123" else 0.03) and abs(pad.y - y) < 0.03
        if not header and name != "SOD-123":
            assert min(pad.w, w) > 0.9 * max(pad.w, w) and min(pad.h, h) > 0.9 * max(pad.h, h)


@pytest.mark.parametrize("converter", CONVERTERS)
def test_every_pin_has_a_pad(converter):
    (board,) = boards.laid_out(Layout(variant({"readout.converter": converter})))
    for component in board.netlist.components:
        pads = {pad.number for pad in footprint(component.footprint).pads}
        assert {pin.number for pin in component.pins} <= pads


def test_what_is_left_off_is_in_no_table_of_places():
    """Five of eight channels: three have neither switch nor third arm, and links in the others' places."""
    board = laid_out({"readout.completion": "film-0.1"})
    off = {c.designator for c in board.netlist.components if not c.fitted}
    assert off == {f"R{n}4" for n in range(1, 6)} | {f"R{n}3" for n in (6, 7, 8)} | {"Q6", "Q7", "Q8"}
    named = {row.split(",")[0] for row in places_csv(board).decode().splitlines()[1:]}
    assert not named & off
    placed = {c.designator for c in board.netlist.components if c.kind != "connector"}
    assert named == placed - off


def test_a_board_that_is_too_small_is_refused():
    design = variant()
    outline = BOARD_OUTLINE
    circuit = board_netlist(design, 5, 3)
    with pytest.raises(CheckFailure, match="too narrow by"):
        lay_out(circuit, replace(outline, width=60.0))
    with pytest.raises(CheckFailure, match=r"needs a height of \d+"):
        lay_out(circuit, replace(outline, height=80.0))


def test_gerber_files_with_other_pads_are_refused():
    board = laid_out()
    files = gerber_files(board, "any", "2026-01-01")
    check_flashes(board, files)
    for layer in ("F_Cu.gbr", "B_Cu.gbr"):
        lost = files[layer].decode().replace("D03*", "D02*", 1).encode()
        with pytest.raises(CheckFailure, match=f"{layer} reads back with other pads"):
            check_flashes(board, files | {layer: lost})


def test_equal_designs_give_equal_bytes():
    first, second = (gerber_files(laid_out(), "N", "2026-01-01") for _ in range(2))
    assert first == second and len(first) == 11


def rendered(file: Path) -> np.ndarray:
    """Copper of a Gerber file by pygerber, 25 dots a mm, as true and false, cut to its extent."""
    from PIL import Image
    from pygerber.gerberx3.api.v2 import GerberFile

    picture = file.with_suffix(".png")
    GerberFile.from_file(file).parse().render_raster(picture, dpmm=25)
    copper = np.asarray(Image.open(picture).convert("L")) > 50
    rows, columns = np.flatnonzero(copper.any(1)), np.flatnonzero(copper.any(0))
    return copper[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]


@pytest.mark.slow  # starts KiCad and draws its layers
@pytest.mark.parametrize("converter", ["card", pytest.param("AD7124-8", marks=pytest.mark.nightly)])
def test_the_gerber_files_show_the_copper_that_kicad_plots(converter, tmp_path):
    """KiCad plots the board file by its own, pygerber draws both: they differ at edges alone, by a dot."""
    from scipy.ndimage import binary_dilation, binary_erosion

    needs_kicad()
    (board,) = boards.laid_out(Layout(variant({"readout.converter": converter})))
    file = tmp_path / "board.kicad_pcb"
    file.write_bytes(board_bytes(board, "NAME A", "title", "2026-01-01", "A"))
    in_kicad(file, tmp_path)
    ours = gerber_files(board, "NAME A", "2026-01-01")
    for layer in ("F_Cu", "In1_Cu", "In2_Cu", "B_Cu"):
        (plotted,) = (p for p in tmp_path.iterdir() if f"-{layer}." in p.name)
        mine = tmp_path / f"{layer}.gbr"
        mine.write_bytes(ours[mine.name])
        theirs = tmp_path / f"theirs-{layer}.gbr"
        theirs.write_bytes(plotted.read_bytes())
        a, b = rendered(mine), rendered(theirs)
        assert np.ptp([a.shape, b.shape], axis=0).max() <= 1 and 0.01 < a.mean() < 0.99
        a, b = (copper[: min(len(a), len(b)), : min(a.shape[1], b.shape[1])] for copper in (a, b))
        assert not (a & ~binary_dilation(b, iterations=2)).any()
        assert not (binary_erosion(b, iterations=2) & ~a).any()


@pytest.mark.slow  # kinparse takes a second a netlist; by day KiCad reads the boards
@pytest.mark.parametrize("converter", CONVERTERS)
def test_kinparse_reads_a_boards_netlist(converter):
    from kinparse import parse_netlist

    for used in (1, 5) if converter == "card" else (5,):  # a second each; others differ by what is fitted
        circuit = boards.netlist_of_board(Layout(variant({"readout.converter": converter})), used)
        read = parse_netlist(kicad_bytes(circuit, "title", None, "2026-01-01", "A").decode())
        pins = {net.name.removeprefix("/"): {(p.ref, p.num) for p in net.pins} for net in read.nets}
        assert pins == {n: {(c.designator, p.number) for c, p in nodes} for n, nodes in circuit.nets.items()}
        assert {part.footprint for part in read.parts} <= {
            f"tactcad:{c.footprint}" for c in circuit.components
        }


@pytest.mark.parametrize("converter", CONVERTERS)
@pytest.mark.parametrize("count", [1, 2, 7, 8, 9, 15, 16, 17, 20])
def test_arrays_of_1_to_20_elements_have_their_boards(count, converter):
    """A row or two; every element is read by one fitted channel, and what is not read is left off."""
    rows = [[4.0] * count] if count < 9 else [[4.0] * (count - count // 2), [4.0] * (count // 2)]
    layout = Layout(variant({"array.row_arms": rows, "readout.converter": converter}))
    fitted = {
        b.netlist.name: sum(c.part_no == COMPLETION and c.fitted for c in b.netlist.components) / 3
        for b in boards.laid_out(layout)
    }
    assert {f"macro-array-board-{n:g}" for n in fitted.values()} >= set(fitted)
    circuit = netlist(layout)
    read_by = circuit.of_kind("switch" if converter == "card" else "converter")
    pins = {p.net for c in read_by for p in c.pins}
    ends = ("FOOT",) if converter == "card" else ("PLUS", "MINUS")
    assert {net for net in pins if re.fullmatch(r"E\d+_[A-Z]+", net) and not net.endswith("GATE")} == {
        f"E{n}_{end}" for n in range(1, count + 1) for end in ends
    }
