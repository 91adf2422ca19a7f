"""`tactcad calibrate --design`: the load cell of the design's own rig stands in series."""

from __future__ import annotations

import json

import pytest
from variants import HARDWARE

from tactcad.cli.main import main

READINGS = str(HARDWARE / "examples" / "calibration.csv")


def calibrated(capsys, *options):
    assert main(["calibrate", READINGS, "--json", *options]) == 0
    return json.loads(capsys.readouterr().out)


def test_the_design_s_load_cell_is_the_one_typed(tmp_path, capsys):
    text = (HARDWARE / "macro-array.toml").read_text("utf-8")
    other = "load_cell_stiffness = 80.0\nload_cell_accuracy = 0.01"
    (tmp_path / "mine.toml").write_text(text.replace("load_cell_stiffness = 57.04", other))
    by_design = calibrated(capsys, "--design", str(tmp_path / "mine.toml"))
    assert by_design == calibrated(capsys, "--load-cell", "80+-1%")
    # springs in series: 1/k = 1/K + 1/K_c, of the same readings
    plain = calibrated(capsys)
    for mine, papers in zip(by_design["elements"], plain["elements"]):
        K, known = mine["stiffness"]["value"], papers["stiffness"]["value"]
        assert 1 / K + 1 / 80.0 == pytest.approx(1 / known + 1 / 57.04, rel=1e-9)


@pytest.mark.parametrize(
    "options", [("--design", "soft-tissue"), ("--design", "macro-array", "--load-cell", "57")]
)
def test_a_design_without_a_load_cell_and_two_load_cells_are_refused(options, tmp_path, capsys):
    out = tmp_path / "calibration.csv"
    assert main(["calibrate", READINGS, "--out", str(out), *options]) == 2
    said = capsys.readouterr()
    assert said.out == "" and len(said.err.splitlines()) == 1 and not out.exists()
