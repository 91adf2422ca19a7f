"""`tactcad estimate --accuracy` as a user runs it."""

from __future__ import annotations

import csv
import json

import pytest
from variants import TINY_TEXT

from tactcad.cli.main import main
from tactcad.mechanics import ladder
from tactcad.mechanics.accuracy import accuracy_data

HEADER = (
    "hinge_thickness,hinge_length,fillet_radius,load_arm,arm_height,body_height,body_length,"
    "poisson,youngs_modulus,width"
)
ROW = "0.25,0.75,0.15,6,2,4,4,0.33,69000,3"


def document(capsys, *args):
    assert main(["estimate", *args, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_one_per_cent_takes_a_closed_form_and_says_what_it_promises(capsys):
    chosen, named = document(capsys, "--accuracy", "1%"), document(capsys, "--model", "solid")
    assert chosen["model"] == "solid" and chosen["mesh"] is None
    assert 0 < chosen["expected_error"] <= 0.01 == chosen["budget"]["within"]
    assert chosen["expected_error"] == chosen["budget"]["chosen"]["error"]
    assert chosen["budget"]["chosen"]["seconds"] is None  # no time is foretold of a closed form
    assert chosen["reference"] == accuracy_data()["reference"] and "solid elements" in chosen["reference"]
    assert chosen["elements"] == named["elements"]
    assert (named["expected_error"], named["reference"]) == (chosen["expected_error"], chosen["reference"])


@pytest.mark.parametrize("text", ["1%", "1 %", " 1% ", "0.01", "1e-2"])
def test_an_accuracy_may_be_written_as_per_cent_or_as_a_fraction(text, capsys):
    assert document(capsys, "--accuracy", text)["budget"]["within"] == pytest.approx(0.01)


@pytest.mark.parametrize("text", ["0", "-1%", "1", "100%", "nan", "inf%", "about 1%", "%"])
def test_what_is_no_accuracy_is_refused(text, capsys):
    assert main(["estimate", f"--accuracy={text}"]) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1 and "--accuracy" in message and '"0.1%", "1%", 0.01' in message


@pytest.mark.parametrize(
    "args,word",
    [
        (["--accuracy", "1%", "--model", "solid"], "leave out --model solid"),
        (["--accuracy", "1%", "--inspection", "x.csv"], "--inspection"),
    ],
)
def test_conflicts_are_refused(args, word, capsys):
    assert main(["estimate", *args]) == 2
    assert word in capsys.readouterr().err


def test_more_than_can_be_kept_is_refused_with_status_one(capsys):
    assert main(["estimate", "--accuracy", "0.0001%"]) == 1
    message = capsys.readouterr().err
    assert (
        "no rung is known to keep 0.0001 %" in message
        and "the best is fem-solid" in message
        and "(element " in message
    )


@pytest.mark.slow  # solid elements
def test_a_tenth_of_a_per_cent_is_solved_by_solid_elements(capsys, tmp_path):
    two = tmp_path / "two.toml"  # of different arms
    two.write_text(TINY_TEXT.replace("[[5]]", "[[5, 7]]"), "utf-8")
    chosen, plain = document(capsys, str(two), "--accuracy", "0.1%"), document(capsys, str(two))
    assert chosen["model"] == "fem-solid" and chosen["mesh"] in (2, 3) and len(chosen["elements"]) == 2
    for a, b in zip(chosen["elements"], plain["elements"], strict=True):
        assert a["stiffness"] == pytest.approx(b["stiffness"], rel=5e-3) and a["stiffness"] != b["stiffness"]


def test_report_names_rung_error_and_time(capsys):
    assert main(["estimate", "--accuracy", "5%"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[-1].startswith("budget: solid: K within 0.")
    assert sum(line.startswith("K within 0.") and "docs/accuracy.md" in line for line in lines) == 1


@pytest.mark.parametrize("model", [None, "plane", "short"])
def test_every_stiffness_carries_its_expected_error(model, capsys, tmp_path):
    """In text, in JSON (of every element, and the worst) and in a table: what the measured errors promise."""
    args = ["--model", model] if model else []
    promised = {zone["promised"][model or "solid"] for zone in accuracy_data()["zones"]}
    found = document(capsys, *args)
    errors = [row["expected_error"] for row in found["elements"]]
    assert set(errors) <= promised and found["expected_error"] == max(errors)
    assert main(["estimate", *args]) == 0
    assert f"K within {100 * max(errors):.2g} % of solid elements" in capsys.readouterr().out
    status, (inside, outside) = batch(tmp_path, [ROW, ROW.replace("0.33", "0.1")], *args)
    assert status == 0 and float(inside["expected_error"]) in promised and outside["expected_error"] == ""


def test_a_size_carries_its_expected_error(capsys):
    args = ["size", "--stiffness", "10", "--load-arm", "6"]
    assert main([*args, "--json"]) == 0
    error = json.loads(capsys.readouterr().out)["expected_error"]
    assert error in {zone["promised"]["solid"] for zone in accuracy_data()["zones"]}
    assert main(args) == 0 and f"K within {100 * error:.2g} % of" in capsys.readouterr().out


def batch(tmp_path, rows, *args):
    source, target = tmp_path / "in.csv", tmp_path / "out.csv"
    source.write_text("\n".join([HEADER, *rows]) + "\n")
    status = main(["estimate", "--batch", str(source), "--out", str(target), *args])
    return status, list(csv.DictReader(target.open(newline=""))) if target.exists() else None


def test_every_row_of_a_table_has_its_own_rung(tmp_path):
    """An ordinary hinge, one outside what was measured, and one that is impossible."""
    outside, impossible = ROW.replace("0.33", "0.1"), ROW.replace(",6,", ",0.3,")
    status, rows = batch(tmp_path, [ROW, outside, impossible], "--accuracy", "1%")
    assert status == 0 and [r["valid"] for r in rows] == ["true", "false", "false"]
    assert rows[0]["model"] == "solid" and 0 < float(rows[0]["expected_error"]) <= 0.01
    assert (
        "not measured" in rows[1]["reason"] and "poisson" in rows[1]["reason"] and rows[1]["stiffness"] == ""
    )
    assert "load inside the slot" in rows[2]["reason"] and rows[2]["expected_error"] == rows[2]["model"] == ""
    from tactcad.mechanics.section import REFERENCE

    assert float(rows[0]["stiffness"]) == float(ladder.stiffness(REFERENCE))


def test_one_row_is_a_table_too(tmp_path):
    for wanted, model in (("1%", "solid"), ("40%", "plane")):
        status, rows = batch(tmp_path, [ROW], "--accuracy", wanted)
        assert status == 0 and rows[0]["model"] == model
    assert batch(tmp_path, [], "--accuracy", "1%")[0] == 2


def test_a_table_that_has_the_added_column_is_refused(tmp_path, capsys):
    (tmp_path / "in.csv").write_text(f"{HEADER},expected_error\n{ROW},1\n")
    args = ["--batch", str(tmp_path / "in.csv"), "--out", str(tmp_path / "out.csv"), "--accuracy", "1%"]
    assert main(["estimate", *args]) == 2 and "in.csv:1:11" in capsys.readouterr().err
    assert not (tmp_path / "out.csv").exists()
