"""What drawings and releases cannot do is said in one line, and nothing is written: through the command line,
on a small design."""

from __future__ import annotations

from pathlib import Path

import pytest
from variants import TINY_TEXT

from tactcad.cli.main import main
from tactcad.parts.rules import load

pytestmark = pytest.mark.cad


TITLE = 'title = "Macro tactile array 2 x 5"'


@pytest.fixture
def place(tmp_path) -> Path:
    """A folder with a design whose title is its own, so that no drawing of it is in the cache."""
    assert TITLE in TINY_TEXT
    (tmp_path / "tiny.toml").write_text(TINY_TEXT.replace(TITLE, f'title = "{tmp_path.name}"'))
    return tmp_path


def refused(place: Path, capsys, *arguments: str) -> tuple[int, str]:
    """Status and the last line said; no export and no zip may be there, and no traceback."""
    status = main([*arguments, str(place / "tiny.toml"), "--out", str(place / "out")])
    captured = capsys.readouterr()
    assert captured.out == "" and "Traceback" not in captured.err
    out = place / "out"
    visible = [p for p in out.rglob("*") if not p.is_dir()] if out.exists() else []
    assert visible == [] and not list(place.glob(".out.*"))
    return status, captured.err.splitlines()[-1]


@pytest.mark.by_day(1, "a whole release")
@pytest.mark.parametrize("command", [("export", "--drawings"), ("release", "--sample")], ids=" ".join)
def test_a_missing_font(command, place, capsys, monkeypatch):
    from tactcad.drawing.engine import ink

    monkeypatch.setattr(ink, "_FILE", Path("mpl-data", "fonts", "ttf", "Gone.ttf"))
    status, said = refused(place, capsys, *command)
    assert (
        status == 1
        and "font DejaVu Sans" in said
        and "is missing" in said
        and "no drawing was written" in said
    )


def test_a_letter_that_the_font_lacks(place, capsys):
    (place / "tiny.toml").write_text(TINY_TEXT.replace(TITLE, 'title = "触覚 array"'))
    status, said = refused(place, capsys, "export", "--drawings")
    assert status == 2 and "design.title" in said and "触 (U+89E6)" in said


@pytest.mark.parametrize("command", [("check", "--shop"), ("release", "--shop")], ids=" ".join)
def test_an_unknown_shop_file(command, place, capsys):
    name, option = command
    status = main([name, option, str(place / "no-shop.toml"), str(place / "tiny.toml")])
    captured = capsys.readouterr()
    assert (
        status == 2
        and captured.out == ""
        and captured.err.count("\n") == 1
        and "no-shop.toml" in captured.err
    )


@pytest.mark.nightly
def test_plates_of_two_metres_are_drawn_whole(place):
    """A row of 40 elements 50 mm apart has a stack of 40 x 50 + 30 mm, a stop plate inside its end plates and
    a carrier over both: their sheets are broken, and say the whole length."""
    text = TINY_TEXT.replace("[[5]]", f"[{[5] * 40}]").replace("thickness = 3.0", "thickness = 20.0", 1)
    text = text.replace("\npitch = 4.0", "\npitch = 50.0").replace("spacer = 1.0", "spacer = 30.0")
    (place / "tiny.toml").write_text(text)
    assert main(["export", "--drawings", str(place / "tiny.toml"), "--out", str(place / "out")]) == 0
    clamp = load(place / "tiny.toml").clamp
    ends = {"stop-plate": -2 * clamp.stop_plate_gap, "carrier": 2 * clamp.end_plate_thickness}
    for part, more in ends.items():
        (sheet,) = (place / "out" / "drawings").glob(f"tiny-{part}_*.svg")
        assert f">{2030 + more:g}<" in sheet.read_text(), part


@pytest.mark.slow  # an export with sheets
def test_a_sheet_that_is_too_small_for_a_part(place, capsys, monkeypatch):
    """The same refusal where the only scale left is one at which a plate of 58 mm cannot fit."""
    from tactcad.drawing.parts import compose
    from tactcad.drawing.parts import part_sheet as sheets

    for module in (compose, sheets):
        monkeypatch.setattr(module, "SERIES", ((30, 1),))
    status, said = refused(place, capsys, "export", "--drawings", "--scene", "array")
    assert status == 1 and "finds no place on A0 at 30:1" in said and "no drawing was written" in said
