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
from tactcad.families.planar.checks import CHECKS
from tactcad.families.planar.parts import frame
from tactcad.parts.rules import load
from tactcad.scenes import make_scene
from tactcad.scenes.bom import bom_rows

SCREWED = {"joint": "screwed", "border": 8.2, "side": 5.8}
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


def test_kicad_finds_nothing_on_the_jaws_board(tmp_path):
    needs_kicad()
    checked(laid_out(name="jaw"), tmp_path)


CLOSE_BOARDS = [  # rows, columns, pitch, buses, border, side
    (1, 1, 4.0, 1, 5.7, 1.2), (1, 1, 7.9, 1, 4.6, 4.4), (4, 8, 4.0, 2, 1.9, 1.1), (3, 8, 4.0, 3, 7.4, 5.9),
    (3, 1, 4.0, 3, 9.8, 1.2), (2, 1, 5.3, 2, 7.4, 6.0), (1, 7, 4.58, 1, 2.6, 2.1), (2, 2, 4.0, 1, 6.6, 4.6),
    (3, 3, 4.55, 2, 8.1, 5.6), (4, 2, 7.42, 1, 4.9, 5.7), (4, 5, 6.6, 2, 4.5, 4.5), (2, 6, 6.19, 2, 3.7, 3.7),
    (4, 7, 7.23, 2, 7.9, 5.8), (2, 8, 4.05, 1, 2.0, 1.2), (4, 4, 4.8, 2, 2.2, 5.4), (3, 5, 5.0, 3, 4.4, 2.2),
]  # fmt: skip


@pytest.mark.slow  # starts KiCad
@pytest.mark.parametrize(
    "values", [*CLOSE_BOARDS[:8], *(pytest.param(v, marks=pytest.mark.nightly) for v in CLOSE_BOARDS[8:])]
)
def test_kicad_finds_nothing_on_boards_of_a_small_pitch(values, tmp_path):
    """One to four rows, one to eight columns, one bus to three; screwed where screws find room. The second
    half is nightly: slow tests are near their time."""
    needs_kicad()
    rows, columns, pitch, buses, border, side = values
    joint = "screwed" if border >= 6.6 and side >= 4.6 else "bonded"
    housing = {"joint": joint, "border": border, "side": side}
    checked(
        laid_out(name="jaw", rows=rows, columns=columns, pitch=pitch, hall={"buses": buses}, housing=housing),
        tmp_path,
    )


@pytest.mark.slow  # starts KiCad
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


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"rows": 1, "columns": 7, "pitch": 10.7, "hall": {"buses": 2}},
        {"name": "jaw"},
        {"rows": 2, "pitch": 7.0, "hall": {"buses": 1}},
    ],
)
def test_no_bare_or_upper_copper_lies_under_the_metal_frame(changes):
    """Vias, pads and upper tracks keep inside the frame's opening, or lie on the tongue."""
    changes = changes | {"housing": {"joint": "bonded"}} if changes else changes
    layout, board = PlanarLayout(design(**changes)), laid_out(**changes)
    hx, hy = layout.half
    (opening,) = frame(layout).extrusion.openings
    x, y = (max(at) for at in zip(*(segment.start for segment in opening.segments)))
    places = [(v.at, 0.3, 0.3) for v in board.vias]
    places += [(at, *(size / 2 for size in placed.size(pad))) for placed, pad, at, _ in board.pads]
    places += [
        (p, t.width / 2, t.width / 2) for t in board.tracks if t.layer == "F.Cu" for p in (t.start, t.end)
    ]
    for (u, v), w, h in places:
        assert v > 2 * hy or (abs(u - hx) + w <= x + 1e-9 and abs(v - hy) + h <= y + 1e-9)
    assert hx - x > 0.79 and hy - y > 0.79


@pytest.mark.parametrize("name", ["planar", "jaw"])
def test_no_two_chips_of_a_bus_share_an_address(name):
    """Read off KiCad's file: first address by the order code, plus A0, plus twice A1, tied to the supply."""
    board, chips = laid_out(name=name), len(PlanarLayout(design(name)).elements)
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
    assert len(values) == chips and set(found.values()) == {1}


def test_the_bill_counts_what_is_fitted(board):
    """Lines of the scene's bill against the board's components; chips are solids of the scene too."""
    scene = make_scene(design(), "array")
    lines = Counter({s.part_no: s.qty for s in scene.supplies})
    chips = Counter(p.part.part_no.removesuffix("-chip") for p in scene.placements if p.designator[0] == "U")
    fitted = Counter(c.part_no for c in board.netlist.components)
    assert lines - Counter(["CIRCUIT-BOARD"]) == fitted and chips <= fitted
    assert {p.part.process for p in scene.placements if p.designator[0] == "U"} == {"included"}
    rows = bom_rows(scene, None, {})  # whoever buys by the parts list finds one line with an order code
    sold = {s.mpn for s in scene.supplies if s.description == "three-axis Hall chip"}
    for code in sold:
        (line,) = (r for r in rows if r.mpn == code)
        assert line.process == "electronic" and line.spares
    for row in (r for r in rows if r.process == "included"):
        assert not row.mpn and not row.spares and "ordered by" in row.standard_designation


def of_board(d) -> list:
    """What the family's checks find about its board."""
    return [f for check in CHECKS for f in check.run(d, None) if f.check == "planar-board"]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"name": "jaw", "pitch": 3.9}, "the chips are 3.9 mm apart"),
        ({"name": "jaw", "hall": {"buses": 3}}, "2 of 3 hall.buses are used"),
        ({"name": "jaw", "columns": 9}, "more than 16 chips would share one"),
        ({"name": "jaw", "housing": {"side": 1.0}}, "under the metal frame: a wider"),
        ({"name": "jaw", "columns": 1}, "wider than the board"),
        (
            {"name": "jaw", "rows": 6, "columns": 2, "pitch": 7.35, "hall": {"buses": 2}, "housing": SCREWED},
            "a screw's head",
        ),
        ({"hall": {"chip": "TMAG5273A2"}}, "pins of TMAG5273A2 are unknown"),
        ({"hall": {"buses": 4}}, "at most 3 buses pass"),
        ({"rows": 1, "hall": {"buses": 3}, "housing": {"joint": "bonded"}}, "on 3 buses, at most 2"),
        ({"columns": 1, "hall": {"buses": 1}, "housing": {"joint": "bonded"}}, "no bus passes"),
        ({"rows": 1, "hall": {"buses": 2}, "housing": {"joint": "bonded"}}, "pass under the metal frame"),
    ],
)
def test_where_none_is_laid_out_a_flag_says_why(changes, words):
    d = design(**changes)
    (finding,) = of_board(d)
    assert finding.severity == "flag" and words in finding.message
    layout = PlanarLayout(d)
    assert cell_board.made(layout) == () and not cell_board.supplies(layout) and not cell_board.tongue(layout)
    assert not of_board(design())


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
