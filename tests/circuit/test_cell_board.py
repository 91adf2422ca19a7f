"""The board under cells in a plane: checked by KiCad, its chips' addresses read off the written board."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import replace
from pathlib import Path

import pytest
from test_boards import checked, needs_kicad

from tactcad.circuit import printed
from tactcad.circuit.kicad_board import board_bytes
from tactcad.export.board_files import nets_in_board
from tactcad.families.planar import cell_board
from tactcad.families.planar.cell_layout import PlanarLayout
from tactcad.families.planar.checks import check_board
from tactcad.parts.rules import load
from tactcad.scenes import make_scene

DESIGNS = Path(__file__).parents[2] / "hardware"


def design(name: str = "planar", hall: dict | None = None, housing: dict | None = None, **planar):
    d = load(str(DESIGNS / f"{name}-array.toml"))
    return replace(
        d,
        planar=replace(d.planar, **planar),
        hall=replace(d.hall, **(hall or {})),
        housing=replace(d.housing, **(housing or {})),
    )


def laid_out(**changes):
    (board,) = cell_board.made(PlanarLayout(design(**changes)))
    return board


@pytest.fixture(scope="module")
def board():
    return laid_out()


def test_kicad_finds_nothing(board, tmp_path):
    needs_kicad()
    checked(board, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize(
    "changes",
    [
        {"rows": 1, "columns": 2, "hall": {"buses": 1}, "housing": {"joint": "bonded"}},
        {"rows": 1, "columns": 7, "pitch": 10.7, "hall": {"buses": 2}, "housing": {"side": 4.4}},
        {"rows": 9, "columns": 7, "pitch": 10.7, "hall": {"buses": 4}, "housing": {"joint": "bonded"}},
        {"rows": 5, "columns": 6, "hall": {"buses": 4}, "housing": {"joint": "bonded"}},
        {"rows": 5, "columns": 7, "pitch": 8.3, "hall": {"buses": 3, "board": 1.6}},
    ],
)
def test_kicad_finds_nothing_on_other_boards(changes, tmp_path):
    """One chip to 63, one bus or two in a row, at the least pitch and above."""
    needs_kicad()
    checked(laid_out(**changes), tmp_path)


def test_a_chip_lies_below_every_magnet_and_the_board_takes_the_screws(board):
    """Against the scene: chips' middles below the magnets', screws in their holes."""
    d = design()
    scene = make_scene(d, "array")
    magnets = {p.origin[:2] for p in scene.placements if p.part.part_no.startswith("MAGNET")}
    x, y = PlanarLayout(d).half

    def there(at):
        return round(at[0] - x, 6), round(y - at[1], 6)

    assert {there(p.at) for p in board.placed if p.component.kind == "sensor"} == magnets
    screws = {p.origin[:2] for p in scene.placements if p.part.kind == "cap screw"}
    assert {there(hole) for hole in board.holes} == screws
    body = next(p.part for p in scene.placements if p.designator.startswith("PCB")).body
    xs, ys = zip(*(point for segment in body.outer.segments for point in (segment.start, segment.end)))
    assert (max(xs) - min(xs), max(ys) - min(ys)) == pytest.approx((board.width, board.height))


@pytest.mark.parametrize("changes", [{}, {"rows": 1, "columns": 7, "pitch": 10.7, "hall": {"buses": 2}}])
def test_no_bare_or_upper_copper_lies_under_the_metal_frame(changes):
    """Vias and upper tracks keep inside the room that the frame leaves around the chips, or on the tongue."""
    changes = changes | {"housing": {"joint": "bonded"}} if changes else changes
    layout, board = PlanarLayout(design(**changes)), laid_out(**changes)
    (hx, hy), (x, y) = layout.half, layout.field_half
    places = [v.at for v in board.vias] + [
        p for t in board.tracks if t.layer == "F.Cu" for p in (t.start, t.end)
    ]
    for u, v in places:
        assert v > 2 * hy or (abs(u - hx) + 0.3 <= x + 1e-9 and abs(v - hy) + 0.3 <= y + 1e-9)


def test_no_two_chips_of_a_bus_share_an_address(board):
    """Read off KiCad's file: first address by the order code, plus A0, plus twice A1, tied to the supply."""
    text = board_bytes(board, "NAME A", "title", "2026-01-01", "A")
    nets = {pin: net for net, pins in nets_in_board(text).items() for pin in pins}
    first = {"011": 0x0C, "012": 0x10, "013": 0x14, "014": 0x18}
    found = Counter()
    values = re.findall(
        r'reference "(U\d+)".*\n\(fp_text value "MLX90393SLW-ABA-(\d+) (0x\w+)"', text.decode()
    )
    for name, code, said in values:
        at = first[code] + (nets[name, "12"] == "VDD") + 2 * (nets[name, "11"] == "VDD")
        assert at == int(said, 16)
        assert nets[name, "3"].removeprefix("SCL") == nets[name, "5"].removeprefix("SDA")
        found[nets[name, "5"], at] += 1
    assert len(values) == 36 and set(found.values()) == {1}


def test_the_bill_counts_what_is_fitted(board):
    """Lines of the scene's bill against the board's components; chips are solids of the scene too."""
    scene = make_scene(design(), "array")
    lines = Counter({s.part_no: s.qty for s in scene.supplies})
    chips = Counter(p.part.part_no.removesuffix("-chip") for p in scene.placements if p.designator[0] == "U")
    fitted = Counter(c.part_no for c in board.netlist.components)
    assert lines - Counter(["CIRCUIT-BOARD"]) == fitted and chips <= fitted
    assert {p.part.process for p in scene.placements if p.designator[0] == "U"} == {"included"}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"name": "jaw"}, "the chips are 4 mm apart"),
        ({"hall": {"chip": "TMAG5273A2"}}, "pins of TMAG5273A2 are unknown"),
        ({"hall": {"buses": 4}}, "at most 3 buses pass"),
        ({"rows": 1, "hall": {"buses": 3}, "housing": {"joint": "bonded"}}, "on 3 buses, at most 2"),
        ({"columns": 1, "hall": {"buses": 1}, "housing": {"joint": "bonded"}}, "no bus passes"),
        ({"rows": 1, "hall": {"buses": 2}, "housing": {"joint": "bonded"}}, "pass under the metal frame"),
    ],
)
def test_where_none_is_laid_out_a_flag_says_why(changes, words):
    d = design(**changes)
    (finding,) = check_board(d)
    assert finding.severity == "flag" and words in finding.message
    layout = PlanarLayout(d)
    assert cell_board.made(layout) == () and not cell_board.supplies(layout) and not cell_board.tongue(layout)
    assert not list(check_board(design()))


def test_words_on_the_board_stand_apart(board, monkeypatch):
    """By the strokes of each: at least a line's width between the inks of two words; J1 was 0.05 mm from its
    neighbours' letters."""
    words, strokes = [], printed._lines

    def kept(text, at, upright):
        lines = list(strokes(text, at, upright))
        x, y = zip(*(p for line in lines for p in line))
        words.append((text, min(x), min(y), max(x), max(y)))
        return lines

    monkeypatch.setattr(printed, "_lines", kept)
    list(printed.printed(board, "planar-array-board B"))
    assert {"J1", "SCL1", "U36"} <= {word for word, *_ in words}
    for i, (one, *a) in enumerate(words):
        for other, *b in words[:i]:
            apart = max(a[0] - b[2], b[0] - a[2], a[1] - b[3], b[1] - a[3]) - printed.INK
            assert apart >= 0.15 - 1e-6, (one, other, apart)
