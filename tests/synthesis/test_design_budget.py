"""`tactcad design` with a budget: as many arrays as its yield needs, no more searched than counted."""

from __future__ import annotations

import json

import pytest
from small_target import SMALL

from tactcad.cli.main import main
from tactcad.costs import grades
from tactcad.synthesis.synthesise import work_ahead
from tactcad.synthesis.target import parse_target


def test_a_design_makes_as_many_arrays_as_its_interval_needs(tmp_path, capsys, monkeypatch, time_is_over):
    monkeypatch.setattr(grades, "slowness", lambda: 1.0)
    (tmp_path / "small.toml").write_text(SMALL)
    args = ["design", str(tmp_path / "small.toml"), "--out", str(tmp_path / "out")]
    assert main([*args, "--within", "5%", "--in", "40", "--json"]) == 0
    made = json.loads(capsys.readouterr().out)
    assert made["yield_arrays"] == 500 and made["budget"]["chosen"]["name"] == "500 arrays"
    low, high = made["yield_interval"]
    assert (high - low) / 2.0 <= made["budget"]["chosen"]["error"] <= 0.05
    assert made["evaluations"] <= work_ahead(parse_target(SMALL, "t"), False)["candidate"]
    monkeypatch.setattr("tactcad.synthesis.synthesise.design", lambda *_, **__: pytest.fail("begun"))
    args[-1] = str(tmp_path / "other")
    assert main([*args, "--in", "0.5"]) == 1
    assert "too short" in capsys.readouterr().err and not (tmp_path / "other").exists()
