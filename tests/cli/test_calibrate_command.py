"""`tactcad calibrate --design`: the load cell of the design's own rig stands in series."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from variants import HARDWARE

from tactcad.cli.main import main

READINGS, GRASP = (str(HARDWARE / "examples" / f"{name}.csv") for name in ("calibration", "grasp"))


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


NO_CELLS = (
    "inf+-1 inf+-inf inf+-0% inf+-2% 57+- 57+-nan 57+-inf 57+-1e400 57+--1 57+-100% 1e400 -inf nan 0 -57"
)


@pytest.mark.parametrize(
    "cell", [*NO_CELLS.split(), "+-1", "4_0", "57+-1_0", "\uff15\uff17", "57+-\u0661", "1e12", "57+-1+-1"]
)
def test_what_is_no_load_cell_is_refused_in_one_line(cell, tmp_path, capsys):
    assert main(["calibrate", READINGS, f"--load-cell={cell}", "--out", str(tmp_path / "c.csv")]) == 2
    said = capsys.readouterr()
    assert said.out == "" and len(said.err.splitlines()) == 1 and said.err.startswith("tactcad: load cell: ")
    assert not list(tmp_path.iterdir())


def test_limits_are_read_with_blanks_and_in_per_cent(capsys):
    plain = calibrated(capsys, "--load-cell", "50+-1")
    for same in (" 50 \u00b1 1 ", "50+-2 %"):
        assert calibrated(capsys, "--load-cell", same) == plain


NAMES = {  # a column's name and its wrong one: the first warning's end
    (READINGS, "signal_V", "signal_mV"): "(signal_mV in V?)",
    (READINGS, "force_N", "force_mN"): "(force_mN in N?)",
    # 8 weights of 100 g are added to an array of ten elements, nine of which are read
    (GRASP, "signal_V", "signal_mV"): "expected about 7.06 N (load_N in mN or signal_mV in V?)",
    (GRASP, "load_N", "load_mN"): "expected about 0.00706 N (load_mN in N or signal_V in mV?)",
}


@pytest.mark.parametrize("file, name, wrong", [*NAMES, (READINGS, "", ""), (GRASP, "", "")])
def test_a_column_in_another_unit_is_named_in_text_and_json(file, name, wrong, tmp_path, capsys):
    table, known = tmp_path / "r.csv", str(tmp_path / "c.csv")
    table.write_text(Path(file).read_text().replace(name or "\0", wrong))
    calibrated(capsys, "--out", known)
    given = (
        ["stiffness", "--coupling", "1", "--design", "macro-array", "--calibration", known]
        if file == GRASP
        else ["calibrate", "--design", "macro-array"]
    )
    assert main([*given, str(table)]) == 0
    text = capsys.readouterr().out
    assert main([*given, str(table), "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    warnings = record.get("samples", [record])[0]["warnings"]
    assert bool(warnings) == ("warning" in text) == bool(name)
    if name:
        assert warnings[0].endswith(NAMES[file, name, wrong]) and text.startswith(f"warning: {warnings[0]}\n")
