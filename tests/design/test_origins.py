"""An origin belongs to a value: of another value it is stale, and that is said."""

from __future__ import annotations

from pathlib import Path

from variants import HARDWARE

from tactcad.cli.main import main
from tactcad.design.load import names, parse, read, stale_origins


def test_what_ships_has_no_stale_origin():
    assert [said for name in names() for said in stale_origins(read(name))] == []


def test_a_value_that_is_changed_leaves_its_origin_behind(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["new", "mine.toml", "--from", "soft-tissue"]) == 0
    file = Path("mine.toml")
    assert stale_origins(read(file)) == []
    text = file.read_text("utf-8")
    assert "hinge_thickness = 0.15" in text and '"element.hinge_thickness"' in text
    file.write_text(text.replace("hinge_thickness = 0.15", "hinge_thickness = 0.16"), "utf-8")
    (said,) = stale_origins(read(file))
    assert "element.hinge_thickness: stale" in said and "0.15" in said and "0.16" in said
    assert main(["estimate", "mine.toml"]) == 0
    assert f"flag: origin: {said}" in capsys.readouterr().out
    own = text.replace("hinge_thickness = 0.15", "hinge_thickness = 0.16")
    own = "\n".join(line for line in own.split("\n") if not line.startswith('"element.hinge_thickness"'))
    file.write_text(own, "utf-8")
    assert stale_origins(read(file)) == []


def test_a_changed_alloy_says_that_its_reason_is_another_s():
    text = (
        (HARDWARE / "soft-tissue.toml").read_text("utf-8").replace('alloy = "2024-T3"', 'alloy = "7075-T6"')
    )
    changed = parse(text, "mine")
    assert any(
        "tougher than 7075" not in said and "material.alloy: stale" in said for said in stale_origins(changed)
    )
