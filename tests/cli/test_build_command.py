"""`tactcad build`: what it prints, in words and as JSON, its status, and what it refuses."""

import json

import pytest
from variants import TINY_TEXT

from tactcad.cli.main import main
from tactcad.design.load import find

TWO = TINY_TEXT.replace("[[5]]", "[[5, 7]]")


def test_the_shipped_array_goes_together(capsys):
    assert main(["build", "macro-array", "--count", "200", "--json"]) == 0
    made = json.loads(capsys.readouterr().out)
    assert {"count", "assembled", "yield", "failures", "elements", "seconds", "seed"} <= set(made)
    assert made["count"] == 200 and made["assembled"] == round(200 * made["yield"])
    assert made["yield"] == min(made["distributions"][d]["yield"] for d in ("normal", "uniform"))
    assert [e["number"] for e in made["elements"]] == list(range(1, 11))
    for line in made["requirements"]:
        assert line["worst_low"] <= line["nominal"] <= line["worst_high"]
        assert sum(c["share"] for c in line["contributors"]) == pytest.approx(1.0)


def test_what_has_no_stiffness_says_null(tmp_path, capsys):
    """A hinge of 0.05 mm lies outside the closed form: JSON has no NaN (RFC 8259), and Python's reader would
    take one."""

    def no_number(text):
        raise AssertionError(text)

    text = TWO.replace("hinge_thickness = 0.25", "hinge_thickness = 0.05")
    (tmp_path / "thin.toml").write_text(text)
    main(["build", str(tmp_path / "thin.toml"), "--count", "5", "--json"])
    made = json.loads(capsys.readouterr().out, parse_constant=no_number)
    assert len(made["elements"]) == 2
    for element in made["elements"]:
        assert element["stiffness"] == [None, None] and element["stop_closes_at_least"] is None
        assert element["stop_gap"][0] > 0


def test_what_has_no_stiffness_says_why(tmp_path, capsys):
    """In words: no nan, and for every element the field that keeps the estimator from it."""
    text = TWO.replace("hinge_thickness = 0.25", "hinge_thickness = 0.05")
    (tmp_path / "thin.toml").write_text(text)
    main(["build", str(tmp_path / "thin.toml"), "--count", "5"])
    said = capsys.readouterr().out
    assert "nan" not in said
    for n in (1, 2):
        (why,) = (line for line in said.splitlines() if f"E{n} has no stiffness" in line)
        assert "element.hinge_thickness" in why or "element.hinge_length" in why


def test_a_place_on_the_hinge_that_is_missed_names_its_fields(tmp_path, capsys):
    text = find("macro-array").read_text().replace("hinge_thickness = 0.25", "hinge_thickness = 0.1")
    (tmp_path / "thin.toml").write_text(text)
    assert main(["build", str(tmp_path / "thin.toml")]) == 1
    said = capsys.readouterr().err
    assert "look at bonding.sight = 0.03 and bonding.signal_share = 0.03" in said


def test_the_same_seed_says_the_same(capsys):
    said = []
    for _ in range(2):
        assert main(["build", "soft-tissue", "--count", "50", "--seed", "3"]) == 0
        said.append(capsys.readouterr().out)
    assert said[0] == said[1] and "normal" in said[0] and "largest contributor" in said[0]


def test_the_tables_columns_stand_under_each_other(capsys):
    main(["build", "macro-array", "--count", "20"])
    lines = capsys.readouterr().out.splitlines()
    head = next(n for n, line in enumerate(lines) if line.startswith("  requirement"))
    end = lines[head].index("nominal") + len("nominal")
    rows = lines[head + 1 : next(n for n, line in enumerate(lines) if line.startswith("  element  K"))]
    assert len(rows) > 50
    for row in rows:
        float(row[:end].split()[-1])  # a number ends under the head's last letter
        assert row[end] == " " and row[end - 10] == " "


@pytest.mark.parametrize(
    ("options", "what"),
    [(["--count", "0"], "--count"), (["--count", "x"], "--count"), (["--seed", "-1"], "--seed")],
)
def test_bad_numbers_are_refused_in_one_line(options, what, capsys):
    try:
        status = main(["build", "macro-array", *options])
    except SystemExit as ended:
        status = ended.code
    error = capsys.readouterr().err.strip()
    assert status == 2 and what in error and "\n" not in error
