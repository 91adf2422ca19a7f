"""`--within` and `--in` as a user gives them."""

from __future__ import annotations

import csv
import json
import math
import re
from pathlib import Path

import pytest
from scipy.stats import binomtest
from variants import TINY_TEXT

from tactcad.cli.main import main
from tactcad.costs import grades
from tactcad.costs.grades import ANGULAR
from tactcad.fem import fem_ladder
from tactcad.mechanics.accuracy import CANDIDATES, expected_error
from tactcad.mechanics.section import REFERENCE
from tactcad.parts.rules import load

HEADER = (
    "hinge_thickness,hinge_length,fillet_radius,load_arm,arm_height,body_height,body_length,"
    "poisson,youngs_modulus,width"
)
ROW = "0.25,0.75,0.15,6,2,4,4,0.33,69000,3"
DEEP = "0.25,2.0,0.8,6,3,4,4,0.33,69000,1.2"  # a narrow leaf with deep fillets, where closed forms err most


@pytest.fixture(autouse=True)
def published_machine(monkeypatch, tmp_path):
    """Costs as published, whatever runs beside."""
    monkeypatch.setattr(grades, "slowness", lambda: 1.0)
    monkeypatch.setenv("TACTCAD_CACHE", str(tmp_path / "cache"))


def budget(capsys, *args):
    assert main([*args, "--json"]) == 0
    return json.loads(capsys.readouterr().out)["budget"]


def test_accuracy_is_within_by_another_name(capsys):
    assert budget(capsys, "estimate", "--accuracy", "1%") == budget(capsys, "estimate", "--within", "0.01")


def test_time_takes_the_most_exact_rung_and_says_its_neighbours(capsys):
    said = budget(capsys, "estimate", "--in", "1")
    assert said["chosen"]["name"] == "solid" and said["within"] is None and said["in_s"] == 1.0
    assert said["less"]["error"] > said["chosen"]["error"] > said["more"]["error"]
    assert said["more"]["seconds"] > 1.0 and said["chosen"]["seconds"] is said["less"]["seconds"] is None


def test_too_short_a_time_ends_before_anything_is_solved(capsys, monkeypatch):
    monkeypatch.setattr(fem_ladder, "solve", lambda *_: pytest.fail("solved"))
    assert main(["estimate", "--within", "0.1%", "--in", "0.5"]) == 1
    said = capsys.readouterr()
    assert said.out == "" and "too short" in said.err and "needs about" in said.err
    assert said.err.count("\n") == 1


def test_no_time_is_foretold_of_closed_forms(capsys):
    assert main(["estimate", "--in", "0.001"]) == 0
    said = capsys.readouterr()
    assert "budget: solid: K within 0.3 %; a step less: plane, 38 %; a step more: " in said.out
    assert re.fullmatch("tactcad: took [0-9.]+ s, more than --in 0.001: .*\n", said.err)
    assert main(["estimate", "--in", "1e6", "--within", "0.5%"]) == 0 and not capsys.readouterr().err


SIZE = ("size", "--stiffness", "10", "--load-arm", "5")
CALIBRATE = ("calibrate", "hardware/examples/calibration.csv")


@pytest.mark.parametrize("args", [SIZE, CALIBRATE])
def test_commands_that_answer_at_once_take_the_options_and_answer_alike(args, capsys):
    assert main([*args]) == 0
    plain = capsys.readouterr().out
    assert main([*args, "--in", "0.001", "--within", "1%"]) == 0
    assert capsys.readouterr().out == plain
    assert main([*args, "--in", "soon"]) == 2


def test_size_takes_the_rung_that_keeps_its_error(capsys):
    assert main([*SIZE, "--within", "50%", "--json"]) == 0
    quick = json.loads(capsys.readouterr().out)
    assert quick["model"] != "solid" and 0.01 < quick["expected_error"] <= 0.5
    assert main([*SIZE, "--within", "0.01%"]) == 1
    assert "nothing keeps K within 0.01 %: the best is solid, " in capsys.readouterr().err
    assert main([*SIZE, "--within", "1%", "--model", "plane"]) == 2


@pytest.mark.parametrize(
    "args,word",
    [
        (["--within", "1%", "--model", "solid"], "leave out --model solid"),
        (["--in", "9", "--model", "solid"], "leave out --model solid"),
        (["--within", "1%", "--accuracy", "1%"], "same as --within"),
        (["--in", "9", "--inspection", "x.csv"], "--inspection"),
        (["--in", "nothing"], "--in"),
        (["--within", "0"], "--within"),
    ],
)
def test_contradictions_are_refused_in_one_line(args, word, capsys):
    assert main(["estimate", *args]) == 2
    message = capsys.readouterr().err
    assert word in message and message.count("\n") == 1


def rows(tmp_path, lines, *args):
    source, target = tmp_path / "in.csv", tmp_path / "out.csv"
    source.write_text("\n".join([HEADER, *lines]) + "\n")
    assert main(["estimate", "--batch", str(source), "--out", str(target), *args]) == 0
    return list(csv.DictReader(target.open(newline="")))


def test_a_table_gets_each_row_its_rung_and_one_budget(tmp_path, capsys):
    found = rows(tmp_path, [ROW, DEEP, ROW.replace("0.33", "0.1")], "--in", "2")
    said = capsys.readouterr().out.splitlines()[-1]
    assert said.startswith("budget: solid: K within 2.8 %")
    assert [row["model"] for row in found] == ["solid", "solid", ""]
    found = rows(tmp_path, [ROW, DEEP], "--within", "1%")
    said = capsys.readouterr().out.splitlines()[-1]
    assert "solid for 1 and fem-solid, mesh 2 for 1: K within 0.59 %" in said
    assert [row["model"] for row in found] == ["solid", "fem-solid"]
    assert all(float(row["expected_error"]) <= 0.01 for row in found)


def test_a_table_of_which_no_row_can_be_answered_promises_nothing(tmp_path, capsys):
    """What no rung keeps is refused; rows that no errors were measured for say so each."""
    source, target = tmp_path / "in.csv", tmp_path / "out.csv"
    source.write_text(f"{HEADER}\n{ROW}\n{DEEP}\n")
    for asked in (["--within", "1e-9"], ["--within", "1e-9", "--in", "0.001"]):
        assert main(["estimate", "--batch", str(source), "--out", str(target), *asked]) == 1
        said = capsys.readouterr()
        assert said.err.startswith("tactcad: nothing keeps K within 1e-07 %: the best is fem-solid, mesh 3")
        assert said.out == "" and said.err.count("\n") == 1 and not target.exists()
    for asked in (["--within", "1%"], ["--in", "0.001"]):
        (row,) = rows(tmp_path, [ROW.replace("0.33", "0.1")], *asked)
        assert row["valid"] == "false" and row["reason"]
        assert "budget" not in capsys.readouterr().out


def test_costs_follow_the_work(monkeypatch):
    many = REFERENCE.with_(load_arm=[5.0, 6.0, 7.0])
    one, three = grades.rung_grades(REFERENCE), grades.rung_grades(many)
    assert [g.name for g in one] == [c.name for c in CANDIDATES]
    assert [g.error for g in one] == [float(expected_error(REFERENCE, c)) for c in CANDIDATES]
    start = grades.published()["start"]
    work = [g.seconds - start["numpy"] - start["elements"] for g in (one[-1], three[-1])]
    assert work[1] == pytest.approx(3.0 * work[0], rel=0.2)
    monkeypatch.setattr(grades, "slowness", lambda: 2.0)
    assert grades.rung_grades(REFERENCE)[-1].seconds == pytest.approx(2.0 * one[-1].seconds, rel=0.06)


def test_a_calibration_is_kept_and_a_damaged_or_unwritable_cache_survived(tmp_path, monkeypatch, capsys):
    runs = []
    monkeypatch.setattr(grades, "calibration", lambda: runs.append(1) or 0.05)
    assert grades.calibrated() == grades.calibrated() == 0.05 and len(runs) == 1
    (entry,) = [p for p in (tmp_path / "cache").rglob("*") if len(p.name) == 64]
    entry.write_bytes(entry.read_bytes()[:-1] + b"x")
    assert grades.calibrated() == 0.05 and len(runs) == 2
    assert "damaged" in capsys.readouterr().err
    monkeypatch.setattr(grades.time, "time", lambda: 4e9)  # a later day
    assert grades.calibrated() == 0.05 and len(runs) == 3
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("TACTCAD_CACHE", str(tmp_path / "file" / "below"))
    assert grades.calibrated() == 0.05 and len(runs) == 4


def test_calibration_measures_this_machine():
    assert 0.0 < grades.calibration() < math.inf


def test_costs_are_published_with_their_machine():
    record = grades.published()
    parts = {"mesh", "check", "export", "drawings", "guides", "build", "array"}
    assert parts | {"start", "sweep", "date", "machine"} <= set(record)
    assert set(record["mesh"]["seconds"]) == {f"{angular:g}" for angular in ANGULAR}
    assert record["calibration_s"] > 0.0 and set(record["elements"]) == {
        c.name for c in CANDIDATES if "fem" in c.rung
    }
    assert Path(grades.DATA).is_file()


@pytest.mark.cad
def test_a_check_meshes_as_finely_as_asked_and_leaves_nothing_out(capsys, tmp_path):
    (tmp_path / "tiny.toml").write_text(TINY_TEXT, "utf-8")
    args = ["check", str(tmp_path / "tiny.toml"), "--scene", "array", "--json"]
    assert main(args) == 0
    usual = json.loads(capsys.readouterr().out)
    assert main([*args, "--within", "0.2%"]) == 0
    fine = json.loads(capsys.readouterr().out)
    assert fine["budget"]["chosen"]["error"] <= 0.002 and "budget" not in usual
    assert fine["runs"] == usual["runs"] and fine["passed"]


@pytest.mark.cad
def test_a_check_refuses_a_time_too_short_before_it_begins(capsys, monkeypatch):
    monkeypatch.setattr("tactcad.checks.run.run_checks", lambda *_: pytest.fail("begun"))
    for command in ("check", "export"):
        assert main([command, "soft-tissue", "--in", "0.5"]) == 1
        said = capsys.readouterr()
        assert "0.5 s are too short: needs about" in said.err and said.err.count("\n") == 1 and not said.out


@pytest.mark.cad
def test_several_designs_share_one_time_and_one_mesh(capsys):
    designs = [(load(name), ("array",)) for name in ("soft-tissue", "macro-array")]
    one, other, both = (grades.check_grades(some) for some in (designs[:1], designs[1:], designs))
    start = grades.published()["check"]["start"]
    for a, b, c in zip(one, other, both, strict=True):
        assert c.seconds == pytest.approx(a.seconds + b.seconds - start, rel=0.01)
        assert a.error == b.error == c.error
    assert main(["check", "soft-tissue", "nowhere", "--in", "0.5"]) == 1
    assert "too short" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["check", "export"])
@pytest.mark.parametrize("option,value", [("--within", "0"), ("--within", "nan"), ("--in", "-1")])
def test_other_commands_refuse_bad_input_alike(command, option, value, capsys):
    assert main([command, "soft-tissue", f"{option}={value}"]) == 2
    message = capsys.readouterr().err
    assert message.startswith(f"tactcad: {option}: ") and message.count("\n") == 1


def test_a_build_makes_as_many_arrays_as_its_interval_needs(capsys):
    assert main(["build", "soft-tissue", "--within", "5%", "--json"]) == 0
    made = json.loads(capsys.readouterr().out)
    assert made["count"] == 500 and made["budget"]["chosen"]["name"] == "500 arrays"
    low, high = made["yield_interval"]
    exact = binomtest(made["assembled"], made["count"]).proportion_ci(0.95, "exact")
    assert (low, high) == pytest.approx((exact.low, exact.high), abs=1e-12)
    assert (high - low) / 2.0 <= made["budget"]["chosen"]["error"] <= 0.05
    assert main(["build", "--within", "5%", "--count", "10"]) == 2
    assert "leave out --count 10" in capsys.readouterr().err
    assert main(["build", "--in", "0.1"]) == 1 and "too short" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["estimate", "check", "export", "build", "design", "sweep"])
def test_help_says_whose_error_p_is(command, capsys):
    with pytest.raises(SystemExit) as ended:
        main([command, "--help"])
    said = " ".join(capsys.readouterr().out.split())
    assert ended.value.code == 0 and "--within P largest " in said and "as 1% or 0.01" in said
    assert f"tactcad {command} " in said and "--within" in said[said.index("examples:") :]
