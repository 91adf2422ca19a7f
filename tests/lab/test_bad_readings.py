"""Readings that a lab can hand in by mistake: one line that says which, exit status 2, nothing written."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from example_readings import Noise, calibration_rows

from tactcad.cli.main import main
from tactcad.design import csv_table
from tactcad.design.csv_table import Field
from tactcad.design.messages import InputError
from tactcad.export.inspection import COLUMNS
from tactcad.lab import batch, calibration, calibration_file, readings, regression
from tactcad.lab.inspection_sheet import read_sheet
from tactcad.lab.load_cell import LoadCell
from tactcad.mechanics.section import REQUIRED
from tactcad.paper.grasp_figures import Truth
from tactcad.parts.array.layout import Layout
from tactcad.parts.rules import load

HEADER = "element,run,displacement,force,signal"
STEPS = np.arange(1, 7) * 0.025


def rows(noise: Noise = Noise(), steps: np.ndarray = STEPS, runs: int = 3) -> np.ndarray:
    """Element 1 of 16.7 N/mm on a load cell of 57.04: element, run, displacement, force, signal."""
    truth = Truth(np.array([1]), np.array([16.7]), np.array([-9.0]), np.array([2.0]))
    return calibration_rows(truth, 57.04, steps, runs, noise, np.random.default_rng(5))


def text(table: np.ndarray, header: str = HEADER, form: str = "{:g},{:g},{:.6g},{:.6g},{:.6g}") -> str:
    return "\n".join([header, *(form.format(*row) for row in table)]) + "\n"


def changed(column: int, factor: float, noise: Noise = Noise()) -> np.ndarray:
    table = rows(noise)
    table[:, column] *= factor
    return table


NO_FORCE = rows()
NO_FORCE[:, 3] = 0.25
NO_SIGNAL = rows()
NO_SIGNAL[:, 4] = -1.5
FAR_DOWN, FAR_UP = rows(), rows()
FAR_DOWN[2, 3] = FAR_UP[5, 3] = 999.0
BAD = {
    "force reversed": (
        text(changed(3, -1)),
        r"element 1: the force falls with displacement, by 12\.\d+ N/mm",
    ),
    "displacement reversed": (text(changed(2, -1)), r":7:3: element 1 is pressed to negative displacements"),
    "both reversed": (text(rows() * [1, 1, -1, -1, 1]), r":7:3: element 1 is pressed to negative displ"),
    "metres": (text(changed(2, 1e-3)), r"the force rises by 1\.\d+e\+04 N/mm, which the load cell of 57.04"),
    "no force": (text(NO_FORCE), "element 1: the force does not change with displacement"),
    "no signal": (text(NO_SIGNAL), "element 1: the signal does not change with displacement"),
    "a large force at the last step": (
        text(FAR_UP),
        r"element 1: the force rises by more than the load cell can, because .*: line 7; found '",
    ),
    "a large force early": (
        text(FAR_DOWN),
        r"element 1: the force falls .* from the other readings: line 4; found '-.*--drop-outliers",
    ),
    "another separator": (
        text(rows(), HEADER.replace(",", "|"), "{:g}|{:g}|{:g}|{:g}|{:g}"),
        r":1:2: column 'element' is missing; found 'element\|run.* commas, semicolons or tabs between$",
    ),
    "no header": (text(rows()).partition("\n")[2], r":1:1: no header line: numbers alone; found '1,1,0"),
    "two units": (
        text(
            np.column_stack([rows(), rows()[:, 3] * 1e3]),
            HEADER + ",force_mN",
            "{:g},{:g},{:g},{:g},{:g},{:g}",
        ),
        r":1:6: force and force_mN are both the force; found 'force_mN'; legal: one of force, force_N, "
        r"force_mN",
    ),
    "thousands": (
        text(rows() * [1, 1, 1, 1, 1], HEADER.replace(",", "\t"), "{:g}\t{:g}\t1,250\t{:g}\t1,000"),
        "is not a number",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_readings_are_refused_in_one_line(tmp_path, monkeypatch, capfd, name):
    monkeypatch.chdir(tmp_path)
    said, expected = BAD[name]
    Path("r.csv").write_text(said)
    assert main(["calibrate", "r.csv", "--out", "out.csv"]) == 2
    out, err = capfd.readouterr()
    assert out == "" and re.fullmatch(r"tactcad: r\.csv:.*\n", err) and re.search(expected, err), err
    assert [p.name for p in tmp_path.iterdir()] == ["r.csv"]


def test_noise_about_zero_is_no_reversed_sign():
    """A spring far softer than the noise may come out negative: that is said, not refused."""
    table = rows(Noise(force=1.0))
    table[:, 3] -= 12.9 * table[:, 2] + 0.001 * table[:, 2]
    data = readings.CalibrationReadings(
        *(c for c in table.T[:2].astype(int)), *table.T[2:], np.arange(len(table))
    )
    found = calibration.calibrate(data, LoadCell(57.04))[0]
    assert "do not tell the stiffness from zero" in " ".join(found.notes) and found.stiffness.low == 0


SPREADSHEETS = {
    "semicolons": (";", "."),
    "tabs": ("\t", "."),
    "semicolons and decimal commas": (";", ","),
    "tabs and decimal commas": ("\t", ","),
}


@pytest.mark.parametrize("name", SPREADSHEETS)
def test_spreadsheets_separators_are_read_as_what_they_are(tmp_path, name):
    """The same numbers, whatever stands between them; with Excel's hint, comments, and empty cells at the
    end."""
    separator, point = SPREADSHEETS[name]
    plain, other = tmp_path / "plain.csv", tmp_path / "other.csv"
    plain.write_text(text(rows()))
    lines = [line.replace(",", separator).replace(".", point) for line in text(rows()).splitlines()]
    lines = [f"sep={separator}", "# a,b,c,d,e,f,g", *(line + separator for line in lines), "", separator * 5]
    other.write_bytes("\r\n".join(lines).encode("utf-8-sig"))
    a, b = readings.calibration(plain), readings.calibration(other)
    for field in ("element", "run", "displacement", "force", "signal"):
        assert np.array_equal(getattr(a, field), getattr(b, field))
    assert b.line.tolist() == [n + 2 for n in a.line]


CAREFUL = {
    "a quoted number": ("a,b\n1,2\n3,4\n", 'a,b\n"1",2\n3,"4"\n'),
    "blanks": ("a,b\n1,2\n3,4\n", "a , b\n 1, 2\n3 ,4 \n"),
    "a text column": ("a,b\n1,2\n3,4\n", 'name,a,b\n"x, y",1,2\n"z\nw",3,4\n'),
    "empty rows": ("a,b\n1,2\n3,4\n", "a,b\n\n1,2\n,\n3,4\n\n"),
}


@pytest.mark.parametrize("name", CAREFUL)
def test_both_ways_of_reading_give_the_same(tmp_path, name):
    """What is parsed at once, and what needs a careful look at every cell."""
    found = []
    for n, said in enumerate(CAREFUL[name]):
        (tmp_path / f"{n}.csv").write_text(said)
        read = csv_table.read(tmp_path / f"{n}.csv", (Field("a", "1"), Field("b", "1")))
        found.append([read.values(c).tolist() for c in "ab"])
    assert found == [[[1, 3], [2, 4]]] * 2


@pytest.mark.parametrize("bad", ["1_0", "\u0663", "0x10", "1e999", "-inf", "", "1,5", "1 2", "nan"])
def test_one_bad_cell_of_many_is_named_with_line_and_column(tmp_path, bad):
    lines = [f"{n},{n / 7:.4f}" for n in range(3000)]
    lines[2345] = f'2345,"{bad}"' if "," in bad else f"2345,{bad}"
    (tmp_path / "r.csv").write_text("a,b\n" + "\n".join(lines) + "\n")
    with pytest.raises(
        InputError, match=rf"^{tmp_path}/r.csv:2347:2: column 'b' is (not a number|out of range)"
    ):
        csv_table.read(tmp_path / "r.csv", (Field("a", "1"), Field("b", "1")))


READERS = {
    readings.calibration: HEADER,
    readings.grasps: "load,element,signal",
    calibration_file.read: "element,stiffness_N_per_mm,signal_per_deflection_V_per_mm",
    batch.read_table: ",".join(REQUIRED),
    lambda path: read_sheet(path, Layout(load("macro-array"))): ",".join(COLUMNS),
}


@pytest.mark.parametrize("below", ["", "\n\n \n", "\n,,\n", '\n""\n'])
def test_a_header_without_rows_is_refused_by_all_who_read_a_table(tmp_path, below):
    for read, header in READERS.items():
        (tmp_path / "h.csv").write_text(header + below.replace(",,", "," * header.count(",")))
        with pytest.raises(InputError, match="h.csv:2:1: a header and no rows; legal: one row at least$"):
            read(str(tmp_path / "h.csv"))


def test_an_optional_column_is_not_ignored_because_of_its_spelling(tmp_path):
    """Two samples would be taken for one. A column beside the one that is meant is any other's."""
    rows = [f",{s},{s}.{n},{e},{n}\n" for s in (1, 2) for n in (1, 2) for e in (1, 2)]
    (tmp_path / "r.csv").write_text(",Sample,load,element,signal\n" + "".join(rows))
    with pytest.raises(InputError, match="r.csv:1:2: column is written otherwise; .*; legal: sample$"):
        readings.grasps(tmp_path / "r.csv")
    (tmp_path / "r.csv").write_text("Sample,sample,load,element,signal\n" + "".join(rows))
    assert [g.sample for g in readings.grasps(tmp_path / "r.csv")] == [1, 2]


@pytest.mark.parametrize("value", ["#N/A", "#DIV/0!", "#VALUE!", "#NAME?"])
def test_a_spreadsheet_s_error_value_is_no_comment(value, tmp_path):
    (tmp_path / "r.csv").write_text(f"a,b\n# a comment\n#N,B.\n1,2\n{value},3\n")
    with pytest.raises(InputError, match="r.csv:5:1: column 'a' is not a number"):
        csv_table.read(tmp_path / "r.csv", (Field("a", "1"), Field("b", "1")))


def test_outliers_cost_no_fit_each(monkeypatch):
    """Extreme deviates are downdated: the same readings as by weighted fits again after each, in 60 random
    cases."""
    rng, compared = np.random.default_rng(11), 0
    for _ in range(60):
        run = np.repeat(np.arange(rng.integers(1, 6)), rng.integers(6, 20))
        x = rng.random(len(run))
        y = 3 * x + run + 0.01 * rng.standard_normal(len(run))
        for i in rng.integers(0, len(run), rng.integers(0, 4)):
            y[i] += rng.choice([-1, 1]) * 10 ** rng.uniform(-1.5, 1)
        weight = regression.weights([regression.Readings(x, x, y, run)])[0]
        named = regression.extreme_deviates(x, y, run, weight)
        left = np.ones(len(x), bool)
        for i in named:  # by fits of what is left: each one named was the most extreme
            index = np.flatnonzero(left)
            lines = regression.fit_lines(x[index], y[index, None], run[index], weight[index])
            ratio = np.abs(lines.residual[:, 0]) * np.sqrt(
                lines.weight / np.maximum(1 - lines.leverage, 1e-12)
            )
            assert index[np.argmax(ratio)] == i
            left[i] = False
            compared += 1
    assert compared > 30
