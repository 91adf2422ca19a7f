"""A board's STEP file, read as text by a parser of our own, against KiCad's file of the same board."""

from __future__ import annotations

import re
from math import pi

import numpy as np
import pytest
from part21 import Text
from variants import variant

from tactcad.circuit.board_layout import lay_out
from tactcad.circuit.kicad_board import board_bytes
from tactcad.circuit.read_board import board_netlist
from tactcad.design.messages import CheckFailure
from tactcad.export.board_files import board_step, check_bare_board
from tactcad.export.cache import Cache
from tactcad.export.shapes import Shapes
from tactcad.export.step_text import Header
from tactcad.parts.array.board_plate import BOARD_OUTLINE

pytestmark = pytest.mark.cad

NAME = "macro-array-board-5"


@pytest.fixture(scope="module")
def files(tmp_path_factory) -> tuple[str, Text]:
    """KiCad's file and the STEP file."""
    design = variant()
    board = lay_out(board_netlist(design, 5, 3), BOARD_OUTLINE)
    kicad = board_bytes(board, "NAME A", "title", "2026-01-01", "A")
    shapes = Shapes(Cache(tmp_path_factory.mktemp("cache")), "here")
    step = board_step(board, kicad, shapes, Header(NAME, "a board", "A", "2026-01-01", "", ""))
    return kicad.decode(), Text(step)


def below(text: Text, product: str) -> set[int]:
    """Entities of a product's solid, by its name."""
    pairs = (text.references(n) for n in text.of("SHAPE_DEFINITION_REPRESENTATION"))
    shape = next(s for what, s in pairs if text.product_of(text.references(what)[0]) == product)
    found, stack = set(), [shape]
    while stack:
        if (n := stack.pop()) not in found:
            found.add(n)
            stack += text.references(n)
    return found


def at(text: Text, n: int) -> list[float]:
    """An axis placement's point."""
    return text.numbers(text.references(n)[0])


def test_the_bare_board_has_kicads_edge_and_holes(files):
    kicad, text = files
    own = below(text, f"{NAME}-bare")
    points = np.array([at(text, n) for n in own & set(text.of("VERTEX_POINT"))])
    edge = re.findall(r"gr_line \(start ([\d.]+) ([\d.]+)\).*Edge.Cuts", kicad)
    width, height = np.ptp(np.array(edge, float), axis=0)
    assert points.min(axis=0) == pytest.approx([0, 0, 0], abs=1e-9)
    assert points.max(axis=0) == pytest.approx([width, height, 1.6])
    cylinders = {
        (*np.round(at(text, text.references(n)[0])[:2], 6), 2 * text.numbers(n)[-1])
        for n in own & set(text.of("CYLINDRICAL_SURFACE"))
    }
    holes = re.findall(r'tactcad:hole".*\(at ([\d.]+) ([\d.]+)\)\n.*\n.*\(drill ([\d.]+)\)', kicad)
    meant = {(float(x), round(height - float(y), 6), float(d)) for x, y, d in holes}
    assert cylinders == meant and len(meant) == 10


def test_its_volume_is_the_edges_without_the_holes(files, tmp_path):
    from build123d import import_step

    kicad, text = files
    (tmp_path / "board.step").write_text(text.text)
    solids = {s.label: s.volume for s in import_step(tmp_path / "board.step").children}
    drills = [float(d) for d in re.findall(r'tactcad:hole".*\n.*\n.*\(drill ([\d.]+)\)', kicad)]
    assert solids[f"{NAME}-bare"] == pytest.approx(
        1.6 * (90 * 102 - pi / 4 * sum(d * d for d in drills)), rel=1e-6
    )
    assert solids[f"{NAME}-pin-header-26"] == pytest.approx(
        26 * 2.54 * 2.54 * 8.5
    )  # 26 pins: insulator and pins


def test_what_is_fitted_stands_on_the_board_as_in_kicad(files):
    """The lead connector's block on the upper face, 10 mm from the edge; each part by its turn."""
    kicad, text = files
    placed = text.placements()
    (x, y, z) = placed["J2"][1][:3, 3]
    assert (x, y, z) == pytest.approx((45.0, 92.0, 1.6))
    found = re.findall(
        r'\(at ([\d.]+) ([\d.]+) (\d+)\)\n\(property "part_no" "[^"]*"\) \(property "fitted" "yes"\)'
        r'.*\n.*\n\(fp_text reference "(\w+)"',
        kicad,
    )  # fmt: skip
    assert {name for *_, name in found} | {"BOARD"} == set(placed)
    for x, y, turn, name in found:
        matrix = placed[name][1]
        assert matrix[:3, 3] == pytest.approx((float(x), 102 - float(y), 1.6))
        turned = np.degrees(np.arctan2(matrix[1, 0], matrix[0, 0])) % 360
        assert turned == pytest.approx(float(turn)), name


def test_a_solid_that_is_not_kicads_board_is_refused(files):
    kicad, _ = files
    box = ((0.0, 0.0, 0.0), (90.0, 102.0, 1.6))
    found = re.findall(r'tactcad:hole".*\(at ([\d.]+) ([\d.]+)\)\n.*\n.*\(drill ([\d.]+)\)', kicad)
    holes = [(float(x), 102 - float(y), float(d)) for x, y, d in found]
    check_bare_board("any", box, holes, kicad.encode())
    with pytest.raises(CheckFailure, match="reads back in a box of"):
        check_bare_board("any", (box[0], (90.0, 102.01, 1.6)), holes, kicad.encode())
    with pytest.raises(CheckFailure, match="reads back with other holes"):
        check_bare_board("any", box, [(holes[0][0] + 0.01, *holes[0][1:]), *holes[1:]], kicad.encode())
