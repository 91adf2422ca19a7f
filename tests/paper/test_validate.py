"""The report as files: whole or not at all, offline, equal bytes, numbers in JSON; commands from end to
end.
"""

from __future__ import annotations

import json
import re
from pathlib import Path

import example_readings
import pytest

from tactcad.cli.main import main
from tactcad.design.messages import InputError
from tactcad.paper import validation
from tactcad.report import report as reporting

ROOT = Path(__file__).parents[2]
CALIBRATION, GRASP = ROOT / "hardware/examples/calibration.csv", ROOT / "hardware/examples/grasp.csv"


@pytest.mark.slow  # all pictures of the report
def test_report_has_ten_sections_with_findings_tables_and_pictures(report):
    assert len(report.sections) == 10
    for section in report.sections:
        assert section.findings and section.tables and section.figures


def test_page_stands_alone(report):
    page = reporting.to_html(report)
    outside = [u for u in re.findall(r'(?:src|href)\s*=\s*"([^"]*)"', page) if not u.startswith("#")]
    assert not outside and "@import" not in page and "<script" not in page
    assert not re.findall(r"url\((?!#)", page)
    ids = re.findall(r'\bid="([^"]+)"', page)
    for target in re.findall(r'xlink:href="#([^"]+)"', page) + re.findall(r"url\(#([^)]+)\)", page):
        assert target in ids


def test_json_is_strict_and_says_what_the_page_says(report):
    data = json.loads(reporting.to_json(report), parse_constant=lambda c: pytest.fail(f"{c} is not JSON"))
    assert data["sections"]["table2"]["findings"] == list(report.sections[4].findings)
    assert data["sections"]["stiffness"]["values"]["measured"][0] == 40.12
    assert {"fem-plane", "fem-solid", "solid", "plane", "section", "beam", "short"} <= set(
        data["sections"]["stiffness"]["values"]["predicted"]
    )


def test_finite_elements_agree_with_their_closed_forms(report):
    """Coarse solid elements and the plane mesh against the fitted forms: two ways to the same number."""
    K = report.sections[0].values.predicted
    assert K["fem-plane"] == pytest.approx(K["plane"], rel=4e-3)
    assert K["fem-solid"] == pytest.approx(K["solid"], rel=1.5e-2)


@pytest.mark.slow  # the whole report again
def test_same_data_give_equal_bytes(report, paper, array):
    again = validation.validate(paper, array)
    assert reporting.to_html(again) == reporting.to_html(report)
    assert reporting.to_json(again) == reporting.to_json(report)


def test_findings_quoted_in_the_docs_stand_in_the_report(report):
    """Every number of the findings in docs/validation.md."""
    text = reporting.to_text(report)
    findings = (ROOT / "docs" / "validation.md").read_text("utf-8").split("## What it found")[1]
    # numbers with a decimal point or a unit, as the report writes them
    numbers = re.findall(r"(?<![\w.])\d+\.\d+(?![\w.])|\d+ (?=%)", findings.split("\n## ")[0])
    assert len(numbers) > 10
    assert [n for n in numbers if n.strip() not in text] == []


def test_validate_writes_a_folder_and_replaces_it(tmp_path, capsys, monkeypatch, report):
    monkeypatch.setattr(validation, "validate", lambda data, array: report)
    out = tmp_path / "deep" / "validation"
    for _ in range(2):
        assert main(["validate", "--out", str(out)]) == 0
        names = {p.relative_to(out).as_posix() for p in out.rglob("*") if p.is_file()}
        assert {"report.html", "report.json", "plots/reference-stiffness.svg"} <= names
        assert [p.name for p in out.parent.iterdir()] == ["validation"]
    assert "9. Inversion" in capsys.readouterr().out
    assert main(["validate", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["schema"] == "tactcad-validation-1"


def test_bad_table_exits_2_and_writes_nothing(tmp_path, capsys):
    bad = tmp_path / "bad.csv"
    bad.write_text("element,stiffness_N_per_mm\n1,-4\n")
    assert main(["validate", "--table1", str(bad), "--out", str(tmp_path / "out")]) == 2
    assert f"{bad}:1:3: column 'max_deflection_um' is missing" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_design_without_the_paper_s_elements_is_refused(paper, array):
    from dataclasses import replace

    with pytest.raises(InputError, match="does not have Table 1's elements"):
        validation.validate(paper, replace(array, number=array.number + 100))


def test_examples_are_simulated_say_so_and_can_be_made_again(tmp_path):
    example_readings.write(tmp_path)
    for file in (CALIBRATION, GRASP):
        assert (tmp_path / file.name).read_text() == file.read_text()
        assert "SIMULATED" in file.read_text().splitlines()[0]


@pytest.mark.slow  # the example's two samples three times
def test_from_readings_to_object_stiffness(tmp_path, capsys):
    """The two commands one after the other on the shipped examples: the truth that their comments state."""
    table = tmp_path / "calibration.csv"
    assert main(["calibrate", str(CALIBRATION), "--out", str(table)]) == 0
    assert "load cell in series: 57.04" in capsys.readouterr().out
    assert main(["stiffness", str(GRASP), "--calibration", str(table), "--json"]) == 0
    soft, stiff = json.loads(capsys.readouterr().out)["samples"]
    assert (
        soft["combined"]["low"] < 3.85 < soft["combined"]["high"] and soft["combined"]["verdict"] == "bounded"
    )
    assert len(soft["pairs"]) == 8 and {p["reference"] for p in soft["pairs"]} == {8}
    assert stiff["combined"]["low"] < 3000 and any(p["object"]["high"] == "inf" for p in stiff["pairs"])
    assert main(["stiffness", str(GRASP), "--calibration", str(table)]) == 0
    assert "bounded from below only" in capsys.readouterr().out


def test_calibration_as_json_serves_as_well(tmp_path, capsys):
    assert main(["calibrate", str(CALIBRATION), "--json"]) == 0
    table = tmp_path / "calibration.json"
    table.write_text(capsys.readouterr().out)
    assert main(["stiffness", str(GRASP), "--calibration", str(table), "--reference", "1"]) == 0
    assert "sample 1: K_obj = 3.8" in capsys.readouterr().out


@pytest.mark.parametrize("level, said", [("0.95", "95%"), ("0.975", "97.5%"), ("0.999", "99.9%")])
def test_an_interval_is_called_by_its_level(capsys, level, said):
    assert main(["calibrate", str(CALIBRATION), "--level", level]) == 0
    assert f" {said} interval" in capsys.readouterr().out


@pytest.mark.parametrize(
    "arguments, named",
    [
        (["calibrate", "none.csv"], "cannot be read"),
        (["calibrate", str(CALIBRATION), "--load-cell", "-1"], "load cell: not a stiffness"),
        (["calibrate", str(CALIBRATION), "--level", "2"], "level"),
        (["stiffness", str(GRASP), "--calibration", str(CALIBRATION)], "'stiffness_N_per_mm' is missing"),
        (["stiffness", str(GRASP), "--calibration", "none.json"], "cannot be read"),
    ],
)
def test_bad_requests_exit_2_with_one_line(arguments, named, capsys):
    assert main(arguments) == 2
    error = capsys.readouterr().err
    assert named in error and error.count("\n") == 1
