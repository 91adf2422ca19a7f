"""What a study file may say, and that everything else is refused in one line."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest
from small_study import SMALL, written

from tactcad.cli.main import main
from tactcad.design.design_text import design_text
from tactcad.design.messages import InputError
from tactcad.parts.rules import load
from tactcad.sweep import on_dask
from tactcad.sweep.measured import measured
from tactcad.sweep.study import read_study, study_schema

THICKNESS = '[vary."element.hinge_thickness"]'
BAD = {
    "unknown field": (SMALL.replace("hinge_thickness", "hinge_thicknes"), "did you mean element.hinge_thick"),
    "unknown table": (SMALL + "[mesure]\n", "mesure: unknown field"),
    "unknown place": (SMALL.replace("[0][3]", "[0][7]"), "array.row_arms[0][7]: unknown field"),
    "no quotes": (SMALL.replace(THICKNESS, "[vary.element.hinge_thickness]"), "with the path in quotes"),
    "empty range": (SMALL.replace("[0.2, 0.4]", "[0.4, 0.2]"), "range: is empty; found [0.4, 0.2]"),
    "illegal end": (SMALL.replace("[0.2, 0.4]", "[0.2, 40]"), "range[1]: out of range; found 40"),
    "no number": (SMALL.replace("[0.2, 0.4]", '[0.2, "x"]'), "range[1]: not a number"),
    "two ways": (SMALL.replace("[0.2, 0.4]", "[0.2, 0.4]\nnormal = 0.01"), "range and normal"),
    "no way": (SMALL.replace("range = [0.2, 0.4]", "steps = 3"), "needs one of values, range and normal"),
    "steps of draws": (SMALL.replace("[0.2, 0.4]", "[0.2, 0.4]\nsteps = 4"), "belongs to a range in a grid"),
    "no values": (SMALL.replace("range = [0.2, 0.4]", "values = []"), "not a list of values"),
    "illegal value": (SMALL.replace("range = [0.2, 0.4]", "values = [0.2, -1]"), "values[1]: out of range"),
    "a word's range": (SMALL.replace("element.hinge_thickness", "element.sides"), "takes no numbers between"),
    "grid of draws": (SMALL.replace('"sobol"', '"grid"').replace("count = 24", ""), "needs steps"),
    "count of a grid": (SMALL.replace('"sobol"', '"grid"').replace("0.4]", "0.4]\nsteps = 3"), "needs steps"),
    "no count": (SMALL.replace("count = 24\n", ""), "study.count: missing"),
    "too many": (SMALL.replace('"sobol"', '"latin-hypercube"').replace("24", "2000000"), "sampling sobol"),
    "unknown measure": (SMALL.replace('"solid"', '"soild"'), "did you mean solid?"),
    "strength alone": (SMALL.replace('"solid", ', ""), "strength goes with a rung"),
    "no such element": (SMALL.replace("[4, 9]", "[4, 11]"), "no such element; found 11; legal: 1 to 10"),
    "an element twice": (SMALL.replace("[4, 9]", "[4, 4]"), "an element twice"),
    "unknown design": (SMALL.replace('"macro-array"', '"macro-aray"'), "did you mean macro-array?"),
    "nothing varies": (SMALL.partition("[vary")[0] + '[measure]\nwhat = ["solid"]\n', "vary: missing table"),
    "a list and a place in it": (
        SMALL.replace("[measure]", '[vary."array.row_arms"]\nvalues = [[[5, 5], [5, 5]]]\n[measure]'),
        "vary: array.row_arms and array.row_arms[0][3] vary the same value; legal: one of the two",
    ),
    "a place by another name": (SMALL.replace("[0][3]", "[0][03]"), "array.row_arms[0][03]: unknown field"),
    "override of no element": (
        SMALL.replace('"element.hinge', '"element.override.11.hinge'),
        "vary.element.override.11.hinge_thickness: no such element; found 11; legal: 1 to 10",
    ),
    "not TOML": ("[study\n", "is not TOML"),
}


@pytest.mark.parametrize("text, said", BAD.values(), ids=BAD)
def test_bad_input_is_one_line_and_nothing_is_written(tmp_path, capsys, text, said):
    path = written(tmp_path, text)
    assert main(["sweep", str(path), "--out", str(tmp_path / "out")]) == 2
    out, err = capsys.readouterr()
    assert out == "" and err.count("\n") == 1 and said in err, err
    assert not (tmp_path / "out").exists()


def test_lists_are_of_one_length(tmp_path):
    text = SMALL.replace('"sobol"', '"list"').replace("count = 24", "")
    text = text.replace("range = [0.2, 0.4]", "values = [0.2, 0.3]").replace("range = [6, 9]", "values = [6]")
    with pytest.raises(InputError, match=r"hinge_thickness: 2, array.row_arms\[0\]\[3\]: 1"):
        read_study(written(tmp_path, text))


@pytest.mark.parametrize(
    "arguments, said",
    [
        ("{study}", "--out: missing"),
        ("{study} {study} --out o", "more than one"),
        ("{study} --out o --workers 0", "--workers: out of range"),
        ("{study} --out o --workers 2 --scheduler tcp://x:1", "the scheduler's own"),
        ("{study} --out o --scheduler nobody:1", "no scheduler answers there; found 'nobody:1'"),
        ("{study} --out {folder}", "holds files that are no study's, such as study.toml"),
        ("plot", "takes one folder"),
        ("plot o --workers 2", "--workers: belongs to a study, not to its plot; found 2"),
        ("plot o --in abc", "--in: belongs to a study, not to its plot; found 'abc'"),
        ("{study} --out o --within -1%", "--within: not an accuracy; found '-1%'"),
        ("{study} --out o --in -1e-3", "--in: no time; found '-1e-3'"),
        ("plot {folder}", "is not the folder of a study"),
    ],
)
def test_bad_arguments(tmp_path, capsys, monkeypatch, arguments, said):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(on_dask, "ANSWER", "1s")
    path = written(tmp_path)
    words = arguments.format(study=path, folder=tmp_path).split()
    assert main(["sweep", *words]) == 2
    last = capsys.readouterr().err.splitlines()[-1]
    assert said in last and not (tmp_path / "o").exists()


@pytest.mark.parametrize("what", ["checks", "export"])
def test_what_needs_solids_is_refused_where_there_is_no_kernel(what, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("tactcad.design.messages.find_spec", lambda name: None if name == "OCP" else ...)
    study = written(tmp_path, what=f'["{what}"]', elements="")
    assert main(["sweep", str(study), "--out", str(tmp_path / "o")]) == 2
    said = f"tactcad: measure.what, {what}: needs OCP, not installed here; legal: pip install '.[cad]' in a "
    assert capsys.readouterr().err == f"{said}checkout of tactcad\n" and not (tmp_path / "o").exists()


def test_the_schema_names_every_field_and_takes_the_study(tmp_path, capsys):
    assert main(["schema", "--study"]) == 0
    said = capsys.readouterr().out
    assert main(["schema", "--study", "--json"]) == 0
    schema = json.loads(capsys.readouterr().out)
    assert schema == study_schema() and set(schema["properties"]) == {"study", "vary", "measure"}
    for table in ("study", "measure"):
        for name in schema["properties"][table]["properties"]:
            assert f"\n  {name} " in said


def test_a_tomls_own_date_is_no_hindrance(tmp_path):
    from tactcad.design.load import find

    text = find("macro-array").read_text()
    day = text.partition('date = "')[2][:10]
    (tmp_path / "own.toml").write_text(text.replace(f'date = "{day}"', f"date = {day}"))
    study = read_study(written(tmp_path, design='"own.toml"'))
    assert study.design.design.date == day and study.count == 24
    text = SMALL.replace("[measure]", f'[vary."design.date"]\nvalues = [{day}]\n[measure]')
    study = read_study(written(tmp_path, text))
    assert study.vary["design.date"].values == (day,) and study.identity


def test_the_order_in_which_fields_run_makes_another_study(tmp_path):
    """In a grid the last field runs fastest, and draws go by their order: their results are told apart."""
    head, thickness, rest = SMALL.partition(THICKNESS)
    fields, measure = rest.split("[measure]")
    field, arm, more = fields.partition("[vary.")
    swapped = f"{head}{arm}{more}{thickness}{field}[measure]{measure}"
    one, other = read_study(written(tmp_path)), read_study(written(tmp_path, swapped))
    assert one.vary == other.vary and list(one.vary) == list(other.vary)[::-1]
    assert one.identity != other.identity


@pytest.mark.parametrize("design", ["planar-array", "macro-array"])
def test_what_estimate_says_is_measured_for_any_family(design, tmp_path, capsys):
    """The table's numbers are those of `tactcad estimate --json`; a refused design is a row with a reason."""
    path, field = ("hall.gap", 1.9) if design == "planar-array" else ("element.fillet_radius", 0.2)
    (tmp_path / "one.toml").write_text(
        f'[study]\nname = "one"\ndesign = "{design}"\n[vary."{path}"]\nvalues = [{field}, 0.3]\n'
        '[measure]\nwhat = ["estimate"]\nelements = [2]\n'
    )
    study = read_study(tmp_path / "one.toml")
    table = measured(study, 0, 2, tmp_path).to_pylist()
    (tmp_path / "same.toml").write_text(load_text(design, path, field))
    assert main(["estimate", str(tmp_path / "same.toml"), "--json"]) == 0
    said = next(e for e in json.loads(capsys.readouterr().out)["elements"] if e["number"] == 2)
    for name in ("stiffness", "rated_force"):
        assert table[0][f"estimate.E2.{name}"] == pytest.approx(said[name], rel=1e-9)
    if design == "planar-array":
        assert table[1]["valid"] is False and "field_in_scale" in table[1]["reason"]
        assert table[0]["estimate.E2.force_noise_z"] == pytest.approx(said["force_noise_z"], rel=1e-9)


def load_text(design: str, path: str, value: float) -> str:
    d = load(design)
    table, name = path.split(".")
    return design_text(replace(d, **{table: replace(getattr(d, table), **{name: value})}), "")
