"""`tactcad design --within`: as many arrays as its yield's interval needs."""

from __future__ import annotations

import json

import pytest
from small_target import SMALL

from tactcad.cli.main import main


@pytest.mark.slow  # a synthesis and 500 arrays
def test_a_design_makes_as_many_arrays_as_its_interval_needs(tmp_path, capsys, answer_only):
    (tmp_path / "small.toml").write_text(SMALL)
    args = ["design", str(tmp_path / "small.toml"), "--out", str(tmp_path / "out")]
    assert main([*args, "--within", "5%", "--json"]) == 0
    made = json.loads(capsys.readouterr().out)
    assert made["yield_arrays"] == 500 and made["budget"]["chosen"]["name"] == "500 arrays"
    low, high = made["yield_interval"]
    assert (high - low) / 2.0 <= made["budget"]["chosen"]["error"] <= 0.05
