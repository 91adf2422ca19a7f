"""`tactcad estimate --inspection`: the sheet of an export, filled in as a shop would, and everything that can
be wrong with it."""

from __future__ import annotations

import csv
import io
import json
import re

import numpy as np
import pytest
from variants import FACING_ROWS, HARDWARE

from tactcad.cli.main import main
from tactcad.export.inspection import inspection_bytes
from tactcad.mechanics import ladder
from tactcad.mechanics.as_built import in_clamp, without_layer
from tactcad.parts.array.hinge_section import hinge_section
from tactcad.parts.array.layout import Layout
from tactcad.parts.rules import load

LAYOUT = Layout(load("macro-array"))
BLANK = inspection_bytes(LAYOUT).decode()
LETTER = BLANK.splitlines()[1].split(",")[1]


def filled(values: dict[tuple[str, str], dict[str, str]], text: str = BLANK) -> str:
    """The sheet with cells set, by element and characteristic."""
    rows = list(csv.DictReader(io.StringIO(text, newline="")))
    for row in rows:
        row.update(values.get((row["element"], row["characteristic"]), {}))
    out = io.StringIO(newline="")
    writer = csv.DictWriter(out, rows[0])
    writer.writeheader()
    writer.writerows(rows)
    return out.getvalue()


def measured(element: str, name: str, value: str, uncertainty: str = "") -> dict:
    return {(element, name): {"measured": value, "uncertainty_k2": uncertainty}}


def estimated(tmp_path, capsys, text: str | bytes, *arguments: str) -> dict:
    path = tmp_path / "sheet.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    assert main(["estimate", "--inspection", str(path), "--json", *arguments]) == 0
    return json.loads(capsys.readouterr().out)


def refused(tmp_path, capsys, text: str | bytes, *arguments: str) -> str:
    path = tmp_path / "sheet.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    assert main(["estimate", "--inspection", str(path), *arguments]) == 2
    out, err = capsys.readouterr()
    assert out == "" and err.count("\n") == 1
    return err.removeprefix(f"tactcad: {path}")


def line_of(element: str, name: str) -> int:
    return next(
        n for n, line in enumerate(BLANK.splitlines(), 1) if f",{element}," in line and f",{name}," in line
    )


COLUMN = {name: n for n, name in enumerate(BLANK.splitlines()[0].split(","), 1)}


def test_a_blank_sheet_gives_the_nominal_stiffness_and_the_tolerances_interval(tmp_path, capsys):
    document = estimated(tmp_path, capsys, BLANK)
    assert main(["estimate", "--json"]) == 0
    nominal = json.loads(capsys.readouterr().out)
    assert document["blank"] == len(document["readings"]) == BLANK.count("\n") - 1
    tolerance = LAYOUT.design.tolerance
    for made, row in zip(document["elements"], nominal["elements"]):
        assert {k: made[k] for k in row} == row == made["nominal"]
        low, high = made["intervals"]["stiffness"]
        # K goes with t^3, b, about L^-2: the first alone, and all three added as squares at most
        share = (high - low) / 2 / row["stiffness"]
        least = 2.5 * tolerance.hinge_thickness / 0.25
        squares = (3 * tolerance.hinge_thickness / 0.25) ** 2 + (tolerance.sheet_thickness / 3) ** 2
        squares += (2.5 * tolerance.load_arm / row["load_arm"]) ** 2 + (tolerance.hinge_length / 0.88) ** 2
        # what no sheet asks for: modulus of the lot, fillets (exponent 0.5), layer of two faces, clamp (2 to
        # 5 % at most)
        squares += tolerance.youngs_modulus**2 + (0.5 * tolerance.fillet_radius / 0.3) ** 2
        squares += (3 * 2 * tolerance.recast_layer / 0.25) ** 2 + 0.04**2
        assert least < share < squares**0.5 * 1.05


def test_measured_dimensions_give_the_ladders_stiffness_of_that_element_alone(tmp_path, capsys):
    text = filled(
        measured("E4", "hinge thickness", "0.2541")
        | measured("E4", "slot length", "0.87")
        | measured("E4", "load arm", "7.02")
        | measured("E4", "arm height", "2.61")
        | measured("E4", "sheet thickness", "2.96")
    )
    nominal = hinge_section(LAYOUT, LAYOUT.elements)
    own = nominal.rows(3).with_(
        hinge_thickness=0.2541, hinge_length=0.87, load_arm=7.02, arm_height=2.61, width=2.96
    )
    for rung in ladder.CLOSED_FORMS:
        rows = estimated(tmp_path, capsys, text, "--model", rung, "--force", "0.5")["elements"]
        assert rows[3]["stiffness"] == pytest.approx(float(ladder.stiffness(own, rung)), rel=1e-12)
        assert rows[3]["deflection"] == pytest.approx(0.5 / rows[3]["stiffness"])
        expected = ladder.stiffness(nominal, rung)
        for i in (0, 1, 2, 4, 5, 6, 7, 8, 9):
            assert rows[i]["stiffness"] == pytest.approx(float(expected[i]), rel=1e-12)


def test_a_blank_load_arm_follows_from_arm_and_pad(tmp_path, capsys):
    """Who fills in the two that the sheet dimensions gets what who fills in the third would."""
    two = {**measured("E1", "arm length", "4.03", "0.004"), **measured("E1", "pad length", "2.02", "0.006")}
    told = estimated(tmp_path, capsys, filled(measured("E1", "load arm", "3.02", "0.005")))
    followed = estimated(tmp_path, capsys, filled(two))
    for name in ("stiffness", "gauge_strain"):
        assert followed["elements"][0][name] == pytest.approx(told["elements"][0][name], rel=1e-12)
        ends = (sheet["elements"][0]["intervals"][name] for sheet in (followed, told))
        assert next(ends) == pytest.approx(next(ends), rel=1e-12)
    # a load arm that was measured itself stands
    both = filled({**two, **measured("E1", "load arm", "3.00")})
    assert estimated(tmp_path, capsys, both)["elements"][0]["stiffness"] == pytest.approx(
        estimated(tmp_path, capsys, BLANK)["elements"][0]["stiffness"]
    )


def test_a_measured_fillet_narrows_the_interval(tmp_path, capsys):
    def width(text: str) -> float:
        low, high = estimated(tmp_path, capsys, text)["elements"][0]["intervals"]["stiffness"]
        return high - low

    assert width(filled(measured("E1", "fillet radius", "0.30", "0.002"))) < 0.97 * width(BLANK)


def test_a_full_round_beside_other_fillets_is_read(tmp_path, capsys):
    """It has no radius to measure: its slot's width is its diameter."""
    text = (HARDWARE / "macro-array.toml").read_text()
    mixed = tmp_path / "mixed.toml"
    mixed.write_text(text.replace("[holes]", "[element.override.1]\nfillet_radius = 0.44\n\n[holes]", 1))
    sheet = inspection_bytes(Layout(load(str(mixed)))).decode()
    rows = [row for row in csv.DictReader(io.StringIO(sheet)) if row["characteristic"] == "fillet radius"]
    assert len(rows) == 9
    narrower = filled(measured("E1", "slot length", "0.87"), sheet)
    made = estimated(tmp_path, capsys, narrower, str(mixed))["elements"][0]
    drawn = estimated(tmp_path, capsys, sheet, str(mixed))["elements"][0]
    assert made["stiffness"] > drawn["stiffness"]


def test_the_short_rungs_interval_is_the_textbooks(tmp_path, capsys):
    """K = E b t^3/(12 l L^2): relative deviations add as squares with the exponents 3, 1, 1, 2; half of a
    half-width where measured, uniform between limits where not. 96 % of draws of these lie within."""
    text = filled(
        {
            key: value
            for name, v, u in (
                ("hinge thickness", 0.249, 0.0005),
                ("slot length", 0.881, 0.002),
                ("load arm", 3.004, 0.003),
                ("sheet thickness", 3.02, 0.004),
                ("arm height", 2.6, 0.005),
            )
            for key, value in measured("E1", name, str(v), str(u)).items()
        }
    )
    row = estimated(tmp_path, capsys, text, "--model", "short")["elements"][0]
    K = 69000 * 3.02 * 0.249**3 / (12 * 0.881 * 3.004**2)
    assert row["stiffness"] == pytest.approx(K, rel=1e-12)
    relative = (
        (3 * 0.0005 / 0.249) ** 2 + (0.002 / 0.881) ** 2 + (2 * 0.003 / 3.004) ** 2 + (0.004 / 3.02) ** 2
    )
    tolerance = LAYOUT.design.tolerance  # of what the sheet does not ask for: fillets do not enter this rung
    c, lever = tolerance.recast_layer, 3.004 + 0.881 / 2 + LAYOUT.elements[0].body_length
    left = K * (1 - 2 * c / 0.249) ** 3 / (1 + 2 * c / 0.881)
    turned = 1 - 1 / (1 + K * tolerance.clamp_compliance * lever**2)
    limits = np.array([tolerance.youngs_modulus, 1 - left / K, turned])
    rng, draws = np.random.default_rng(1), 400_000
    drawn = rng.uniform(-1, 1, (draws, 3)) @ limits + rng.normal(0, relative**0.5 / 2, draws)
    low, high = row["intervals"]["stiffness"]
    held = np.mean(np.abs(drawn) <= (high - low) / 2 / K)
    assert 0.95 < held < 0.97
    assert (low + high) / 2 == pytest.approx(K)


def test_interval_covers_what_random_dimensions_within_it_give(tmp_path, capsys):
    """Monte Carlo over the stated uncertainties (k = 2): about 95 % of the stiffnesses lie inside."""
    given = {
        "hinge thickness": (0.2512, 0.001),
        "slot length": (0.872, 0.004),
        "load arm": (5.01, 0.01),
        "arm height": (2.603, 0.004),
        "sheet thickness": (2.98, 0.004),
    }
    cells = {}
    for name, (value, u) in given.items():
        cells |= measured("E3", name, str(value), str(u))
    low, high = estimated(tmp_path, capsys, filled(cells))["elements"][2]["intervals"]["stiffness"]
    rng = np.random.default_rng(7)
    fields = ("hinge_thickness", "hinge_length", "load_arm", "arm_height", "width")
    drawn = {f: rng.normal(v, u / 2, 20_000) for f, (v, u) in zip(fields, given.values())}
    nominal, tolerance = hinge_section(LAYOUT, [LAYOUT.elements[2]]), LAYOUT.design.tolerance
    anywhere = rng.uniform(-1, 1, (4, 20_000))
    drawn["fillet_radius"] = 0.3 + tolerance.fillet_radius * anywhere[0]
    drawn["youngs_modulus"] = 69000 * (1 + tolerance.youngs_modulus * anywhere[1])
    left = without_layer(nominal.with_(**drawn), tolerance.recast_layer * anywhere[2])
    K = in_clamp(left, ladder.stiffness(left), tolerance.clamp_compliance * anywhere[3])
    assert 0.95 < np.mean((low < K) & (high > K)) < 0.97


def test_verdicts(tmp_path, capsys):
    """ISO 14253-1: inside or outside only where the uncertainty does not reach across the limit."""
    text = filled(
        measured("E1", "hinge thickness", "0.2549", "0.0001")  # upper limit 0.255
        | measured("E2", "hinge thickness", "0.2551")
        | measured("E3", "hinge thickness", "0.2551", "0.0005")
        | measured("E4", "hinge thickness", "0.2449", "0.00005")
        | measured("E5", "hinge thickness", "0.245")
        | measured("E6", "stop gap", "0.08")
        | measured("E7", "pad height over the dowel hole's centre", "6.7")
    )
    document = estimated(tmp_path, capsys, text)
    verdicts = {
        (r["number"], r["characteristic"]): r["verdict"]
        for r in document["readings"]
        if r["measured"] is not None
    }
    t = [verdicts[n, "hinge thickness"] for n in range(1, 6)]
    assert t == ["inside", "outside", "undecided", "outside", "inside"]
    assert (
        verdicts[6, "stop gap"] == "outside"
        and verdicts[7, "pad height over the dowel hole's centre"] == "inside"
    )
    assert main(["estimate", "--inspection", str(tmp_path / "sheet.csv")]) == 0
    shown = capsys.readouterr().out
    assert (
        f"outside its tolerance: no. 2, hinge thickness 0.2551, 0.245 to 0.255 mm (line "
        f"{line_of('E2', 'hinge thickness')})" in shown
    )
    assert "undecided" in shown and "not measured: arm height, every element: nominal" in shown
    assert "no uncertainty given: hinge thickness, no. 2, 5: taken as exact" in shown


# what a spreadsheet may make of the file without changing what it says


def semicolons(text: str, comma: bool) -> str:
    rows = csv.reader(io.StringIO(text, newline=""))
    out = io.StringIO(newline="")
    decimal = lambda cell: cell.replace(".", ",") if comma and re.fullmatch(r"[\d.]+", cell) else cell  # noqa: E731
    csv.writer(out, delimiter=";").writerows([decimal(cell) for cell in row] for row in rows)
    return out.getvalue()


SAME = filled(measured("E2", "hinge thickness", "0.2481", "0.0012") | measured("E9", "load arm", "4.01"))
SPREADSHEETS = {
    "byte order mark": b"\xef\xbb\xbf" + SAME.encode(),
    "semicolons": semicolons(SAME, comma=False),
    "semicolons and decimal commas throughout": semicolons(SAME, comma=True),
    "tabs": semicolons(SAME, comma=True).replace(";", "\t"),
    "sep line": "sep=;\r\n" + semicolons(SAME, comma=False),
    "line feeds": SAME.replace("\r\n", "\n"),
    "carriage returns": SAME.replace("\r\n", "\r"),
    "no last line end": SAME.rstrip("\r\n"),
    "rows sorted otherwise": "".join(SAME.splitlines(True)[:1] + sorted(SAME.splitlines(True)[1:])),
    "blank rows and cells at the end": SAME.replace("\r\n", ",,\r\n") + ",,,\r\n,,,\r\n\r\n",
    "a column of remarks": SAME.replace("\r\n", ",\r\n").replace(",\r\n", ",remarks\r\n", 1),
    "trailing zeros": SAME.replace(",0.25,", ",0.2500,"),
    "blanks around": SAME.replace(",0.2481,", ", 0.2481 ,"),
    "columns in another order": "\r\n".join(
        ",".join(f'"{cell}"' for cell in reversed(row)) for row in csv.reader(io.StringIO(SAME, newline=""))
    ),
}


@pytest.mark.by_day(7, "two commands each")
@pytest.mark.parametrize("form", SPREADSHEETS)
def test_spreadsheets_ways_of_writing_mean_the_same(form, tmp_path, capsys):
    lines = lambda document: {k: v for k, v in document.items() if k != "readings"}  # noqa: E731
    assert lines(estimated(tmp_path, capsys, SPREADSHEETS[form])) == lines(estimated(tmp_path, capsys, SAME))


# what is refused: the text, and where and what the message says

E5 = line_of("E5", "hinge thickness")
T = f":{E5}:{COLUMN['measured']}: measured"


def t5(value: str, uncertainty: str = "") -> str:
    return filled(measured("E5", "hinge thickness", value, uncertainty))


def replaced(line: int, old: str, new: str) -> str:
    lines = BLANK.splitlines(True)
    assert old in lines[line - 1]
    lines[line - 1] = lines[line - 1].replace(old, new, 1)
    return "".join(lines)


BAD = {
    "another design": (BLANK.replace("macro-array,", "soft-tissue,"), ":2:1: design"),
    "another revision": (BLANK.replace(f",{LETTER},E", ",ZZ,E"), ":2:2: revision"),
    "one row of another revision": (replaced(E5, f",{LETTER},", ",ZZ,"), f":{E5}:2: revision"),
    "changed nominal": (replaced(E5, ",0.25,", ",0.26,"), f":{E5}:{COLUMN['nominal']}: nominal"),
    "widened limit": (replaced(E5, ",0.255,", ",0.26,"), f":{E5}:{COLUMN['upper']}: upper"),
    "nominal that a spreadsheet took for a date": (
        replaced(E5, ",0.25,", ",25. Jan,"),
        f":{E5}:{COLUMN['nominal']}: nominal",
    ),
    "unknown element": (replaced(E5, ",E5,", ",E11,"), f":{E5}:3: element"),
    "unknown dimension": (
        replaced(E5, "hinge thickness", "hinge width"),
        f":{E5}:{COLUMN['characteristic']}: ",
    ),
    "another part": (replaced(E5, "-a6mm", "-a7mm"), f":{E5}:{COLUMN['part_no']}: part_no"),
    "another unit": (replaced(E5, ",mm,", ",um,"), f":{E5}:{COLUMN['unit']}: unit"),
    "word": (t5("ok"), T),
    "NaN": (t5("nan"), T),
    "infinity": (t5("inf"), T),
    "underscore": (t5("0_25"), T),
    "other digits": (t5("٠.٢٥"), T),
    "unit beside the number": (t5("0.25 mm"), T),
    "formula": (t5("=0.25"), T),
    "two numbers": (t5("0.249/0.251"), T),
    "overflow": (t5("1e999"), T),
    "zero": (t5("0"), T),
    "negative": (t5("-0.25"), T),
    "micrometres": (t5("251.2"), T),
    "metres": (t5("0.000251"), T),
    "inches": (t5("0.00985"), T),
    "decimal comma, quoted": (t5("0,251"), T),
    "decimal comma in a sheet of points": (semicolons(t5("0,251"), comma=False), T),
    "decimal point in a sheet of commas": (
        semicolons(BLANK, True).replace(";mm;;", ";mm;0.251;", 1),
        ":2:11: measured",
    ),
    "decimal comma that splits the cell": (replaced(E5, ",mm,,", ",mm,0,251,"), f":{E5}:{len(COLUMN) + 1}: "),
    "uncertainty in micrometres": (t5("0.251", "1"), f":{E5}:{COLUMN['uncertainty_k2']}: "),
    "negative uncertainty": (t5("0.251", "-0.001"), f":{E5}:{COLUMN['uncertainty_k2']}: "),
    "uncertainty of nothing": (t5("", "0.001"), f":{E5}:{COLUMN['uncertainty_k2']}: "),
    "a row twice": (
        BLANK + BLANK.splitlines(True)[-1],
        f":{BLANK.count(chr(10)) + 1}:{COLUMN['characteristic']}: ",
    ),
    "a row left out": ("".join(BLANK.splitlines(True)[:-1]), f":{BLANK.count(chr(10))}:1: "),
    "cut off in a row": (BLANK[: BLANK.rindex(",mm,")], f":{BLANK.count(chr(10))}:"),
    "cut off after a row": (BLANK[: BLANK.index("macro-array", 2000)], ":"),
    "header alone": (BLANK.splitlines(True)[0], ":2:1: "),
    "no header": ("".join(BLANK.splitlines(True)[1:]), ":1:"),
    "column left out": (BLANK.replace("measured", "meas", 1), ":1:"),
    "column twice": (BLANK.replace("where", "measured", 1), f":1:{COLUMN['where']}: "),
    "empty": ("", ":1:1: "),
    "blank lines": ("\n\n\n", ":1:1: "),
    "UTF-16": (BLANK.encode("utf-16"), ":1:1: "),
    "latin-1": (t5("0.25\xb5").encode("latin-1"), f":{E5}:"),
    "NUL": (t5("0.2\0"), f":{E5}:1: "),
    "a picture": (b"\x89PNG\r\n\x1a\n" + bytes(range(256)), ":1:1: "),
    "open quote": (replaced(E5, ",mm,", ',"mm,'), ":"),
}


@pytest.mark.parametrize("fault", BAD)
def test_a_sheet_that_cannot_be_used_is_refused_with_its_place(fault, tmp_path, capsys):
    text, where = BAD[fault]
    said = refused(tmp_path, capsys, text)
    assert said.startswith(where), said
    assert re.match(r":\d+:\d+: ", said), said


def test_units_are_guessed_in_the_message(tmp_path, capsys):
    assert "in micrometres?" in refused(tmp_path, capsys, t5("251.2"))
    assert "in inches?" in refused(tmp_path, capsys, t5("0.00985"))


def test_requests_that_do_not_go_together(tmp_path, capsys):
    for arguments, named in (
        (("--model", "fem-plane"), "--model"),
        (("--out", "x.csv"), "--out"),
        (("--batch", "x.csv", "--out", "y.csv"), "--batch"),
        (("--force", "0"), "--force"),
    ):
        path = tmp_path / "sheet.csv"
        path.write_text(BLANK)
        assert main(["estimate", "--inspection", str(path), *arguments]) == 2
        assert capsys.readouterr().err.startswith(f"tactcad: {named}")
    assert main(["estimate", "--inspection", str(tmp_path / "none.csv")]) == 2
    assert "none.csv" in capsys.readouterr().err


@pytest.mark.parametrize("name", FACING_ROWS)
def test_every_shipped_designs_sheet_reads_back(name, tmp_path, capsys):
    text = inspection_bytes(Layout(load(name)))
    path = tmp_path / "sheet.csv"
    path.write_bytes(text)
    assert main(["estimate", name, "--inspection", str(path), "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["elements"]
    assert all(row["stiffness"] == row["nominal"]["stiffness"] for row in rows)
