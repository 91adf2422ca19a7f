"""The command's tables, read by other libraries, hold what `tactcad estimate` and the like say of each
design."""

from __future__ import annotations

import csv
import dataclasses
import hashlib
import io
import json
import math
import re
import subprocess
import sys

import numpy as np
import pyarrow.parquet as pq
import pytest
from small_study import ONE_THREAD, SMALL, THREE, WORDS, entries, finished, swept, tables, written

from tactcad.cli.main import main
from tactcad.design.design_text import design_text
from tactcad.design.load import from_table, read
from tactcad.design.messages import CheckFailure
from tactcad.sweep.designs_taken import designs_taken, table_of
from tactcad.sweep.measured import made_by
from tactcad.sweep.on_dask import SweepTask
from tactcad.sweep.store import claimed
from tactcad.sweep.study import read_study


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sweep")
    got = swept(written(folder), "--out", folder / "out", "--json")
    assert got.returncode == 0, got.stderr
    return folder, json.loads(got.stdout)


def rows(folder) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO((folder / "out" / "results.csv").read_text())))


@pytest.mark.slow  # an estimate in a process for every row
def test_every_row_is_what_estimate_says_of_that_design(done, tmp_path, capsys):
    folder, _ = done
    study = read_study(folder / "study.toml")
    columns = designs_taken(study, 0, study.count)
    table = rows(folder)
    assert [int(row["number"]) for row in table] == list(range(1, 25))
    compared = 0
    for i in (0, 7, 23):
        path = tmp_path / "one.toml"
        path.write_text(design_text(from_table(table_of(study, columns, i))))
        if main(["estimate", str(path), "--json"]):
            capsys.readouterr()
            continue  # a rule is broken, which closed forms alone do not ask for
        told = {e["number"]: e for e in json.loads(capsys.readouterr().out)["elements"]}
        for number in (4, 9):
            for name in ("stiffness", "expected_error", "yield_force", "rated_force"):
                assert float(table[i][f"solid.E{number}.{name}"]) == pytest.approx(
                    told[number][name], rel=1e-12
                )
            assert float(table[i][f"solid.E{number}.rated_deflection"]) > 0
            compared += 1
        assert float(table[i]["element.hinge_thickness"]) == columns["element.hinge_thickness"][i]
    assert compared >= 2


def test_parquet_holds_what_csv_holds(done):
    folder, record = done
    table = pq.read_table(folder / "out" / "results.parquet").to_pylist()
    assert len(table) == record["designs"] == 24
    for written_, kept in zip(rows(folder), table, strict=True):
        assert list(written_) == list(kept)
        for name, value in kept.items():
            text = written_[name]
            assert text == value if isinstance(value, str) else json.loads(text or "null") == value


def test_the_manifest_says_what_was_made_of_what(done):
    folder, record = done
    manifest = json.loads((folder / "out" / "manifest.json").read_text())
    for file in manifest["files"]:
        data = (folder / "out" / file["path"]).read_bytes()
        assert hashlib.sha256(data).hexdigest() == file["sha256"] and len(data) == file["bytes"]
    assert [f["path"] for f in manifest["files"]] == ["results.parquet", "results.csv"]
    assert manifest["designs"] == 24 and manifest["versions"]["numpy"] == np.__version__
    assert record["computed"] == 24 and record["kept"] == 0


def test_run_again_it_computes_nothing_and_gives_the_same_bytes(done):
    folder, _ = done
    before, kept = tables(folder / "out"), entries(folder / "out")
    again = swept(folder / "study.toml", "--out", folder / "out", "--json")
    assert json.loads(again.stdout)["computed"] == 0 and json.loads(again.stdout)["kept"] == 24
    assert "dashboard" not in again.stderr  # no process was started
    assert tables(folder / "out") == before and entries(folder / "out") == kept


@pytest.mark.slow  # sweeps again and again
def test_a_damaged_entry_is_computed_again(done, scheduler):
    folder, _ = done
    before = tables(folder / "out")
    (entry,) = entries(folder / "out")
    path = folder / "out" / "store" / entry[:2] / entry
    path.write_bytes(path.read_bytes()[:-20])
    again = swept(folder / "study.toml", "--out", folder / "out", "--json", "--scheduler", scheduler)
    assert json.loads(again.stdout)["computed"] == 24 and tables(folder / "out") == before


def test_another_study_is_refused_and_what_is_there_stays(done, capsys):
    folder, _ = done
    before = tables(folder / "out")
    other = folder / "other"
    other.mkdir()
    path = written(other, seed="4")
    assert main(["sweep", str(path), "--out", str(folder / "out"), "--store", str(other / "far")]) == 2
    err = capsys.readouterr().err
    assert "holds another study" in err and err.count("\n") == 1 and not (other / "far").exists()
    assert tables(folder / "out") == before


def test_comments_and_order_do_not_make_another_study(done):
    folder, _ = done
    moved = folder / "moved"
    moved.mkdir()
    head, _, measure = SMALL.partition("[measure]")
    path = written(moved, f"# the same\n[measure]{measure}\n{head}")
    assert json.loads(swept(path, "--out", folder / "out", "--json").stdout)["computed"] == 0


def test_refused_designs_are_rows_with_their_reason(tmp_path, scheduler):
    text = SMALL.replace('"sobol"', '"list"').replace("count = 24", "").replace('"strength"', '"rules"')
    text = text.replace("range = [0.2, 0.4]", "values = [0.25, 2.5, 0.25]")
    text = text.replace("range = [6, 9]", "values = [8.0, 8.0, 30.0]").replace("[4, 9]", "[4]")
    got = swept(written(tmp_path, text), "--out", tmp_path / "out", "--scheduler", scheduler)
    assert got.returncode == 0 and "3 designs, 2 refused" in got.stdout, got.stderr
    first, second, third = rows(tmp_path)
    assert first["valid"] == "true" and first["reason"] == "" and float(first["solid.E4.stiffness"]) > 0
    for row, said in ((second, ": rule "), (third, "solid E4: (L - l/2)/h is outside")):
        assert row["valid"] == "false" and said in row["reason"] and row["solid.E4.stiffness"] == ""


def test_a_study_all_of_whose_designs_are_refused_ends_with_one_line(tmp_path, scheduler):
    text = SMALL.replace("[0.2, 0.4]", "[2.6, 3.0]")
    got = swept(written(tmp_path, text), "--out", tmp_path / "out", "--scheduler", scheduler)
    assert got.returncode == 1
    last = got.stderr.splitlines()[-1]
    assert last.startswith("tactcad: small: every design is refused (24 of them: solid E4: fillets higher")
    assert len(rows(tmp_path)) == 24


def test_words_and_whole_arrays_vary_too(tmp_path, scheduler):
    text = SMALL.replace('"sobol"', '"grid"').replace("count = 24", "")
    text = text.partition("[vary")[0] + (
        '[vary."material.alloy"]\nvalues = ["7075-T6", "own alloy"]\n'
        '[vary."array.row_arms"]\nvalues = [[[6.0], [5.0]], [[7.0]]]\n'
        '[measure]\nwhat = ["solid"]\nelements = [2]\n'
    )
    got = swept(written(tmp_path, text), "--out", tmp_path / "out", "--scheduler", scheduler)
    assert got.returncode == 0, got.stderr
    table = rows(tmp_path)
    assert [row["array.row_arms"] for row in table] == ["[[6.0], [5.0]]", "[[7.0]]"] * 2
    assert [row["reason"] for row in table] == ["", "the design has no element 2"] * 2
    assert math.isclose(float(table[0]["solid.E2.stiffness"]), float(table[2]["solid.E2.stiffness"]))


@pytest.mark.slow  # virtual builds
def test_yield_is_what_build_says(tmp_path, capsys, scheduler):
    text = SMALL.replace('"sobol"', '"list"').replace("count = 24", "")
    text = text.partition("[vary")[0] + (
        '[vary."tolerance.tip"]\nvalues = [0.02]\n[measure]\nwhat = ["builds"]\narrays = 40\n'
    )
    got = swept(written(tmp_path, text), "--out", tmp_path / "out", "--scheduler", scheduler)
    assert got.returncode == 0, got.stderr
    main(["build", "macro-array", "--count", "40", "--json"])
    assert float(rows(tmp_path)[0]["yield"]) == json.loads(capsys.readouterr().out)["yield"]


@pytest.mark.slow  # exports on a cluster
@pytest.mark.cad
def test_exports_are_kept_until_they_are_gone(tmp_path):
    """In this machine's own processes, which may start those that an export needs."""
    macro = read("macro-array")
    rigs = dict.fromkeys(("cart", "holder", "sample", "calibration", "grasping"))
    one = dataclasses.replace(macro, array=dataclasses.replace(macro.array, row_arms=((6.0,),)), **rigs)
    origin = {"material.youngs_modulus": "the paper's"}
    (tmp_path / "one.toml").write_text(design_text(dataclasses.replace(one, origin=origin)))
    text = '[study]\nname = "files"\ndesign = "one.toml"\n[vary."element.hinge_thickness"]\nvalues = [0.3]\n'
    path = written(tmp_path, text + '[measure]\nwhat = ["export"]\n')
    got = swept(path, "--out", tmp_path / "out")
    assert got.returncode == 0, got.stderr
    (row,) = rows(tmp_path)
    manifest = tmp_path / "out" / "exports" / "000001" / "manifest.json"
    assert hashlib.sha256(manifest.read_bytes()).hexdigest() == row["manifest_sha256"]
    assert int(row["files"]) == sum(p.is_file() for p in manifest.parent.rglob("*"))
    before = tables(tmp_path / "out")
    manifest.unlink()
    for left in sorted(manifest.parent.rglob("*"), reverse=True):
        left.unlink() if left.is_file() else left.rmdir()
    again = swept(path, "--out", tmp_path / "out", "--json")
    assert json.loads(again.stdout)["computed"] == 1 and tables(tmp_path / "out") == before
    assert manifest.exists()


@pytest.mark.slow  # starts two clusters
def test_two_sweeps_of_one_process(tmp_path):
    """The first leaves Dask's settings as the second needs them."""
    script = (
        "import sys\nfrom tactcad.cli.main import main\n"
        "if __name__ == '__main__':\n"
        "    study, out = sys.argv[1:]\n"
        "    sys.exit(any(main(['sweep', study, '--out', out + n, '--workers', '1']) for n in 'ab'))\n"
    )
    (tmp_path / "twice.py").write_text(script)
    command = [sys.executable, tmp_path / "twice.py", written(tmp_path), tmp_path / "out"]
    got = subprocess.run(command, env=ONE_THREAD, capture_output=True, text=True, timeout=300, check=False)
    assert got.returncode == 0, got.stderr
    assert tables(tmp_path / "outa") == tables(tmp_path / "outb")


def test_a_task_handed_out_twice_is_computed_once(tmp_path):
    """As Dask does with what a dead worker had finished."""
    study = read_study(written(tmp_path))
    folder = claimed(study, tmp_path / "out")
    task = SweepTask(study, made_by(study.measure.what), str(folder), 0, 24)
    first, kept = task.carry_out(), entries(folder)
    second = task.carry_out()
    assert (first.computed, second.computed) == (True, False) and first.designs == second.designs == 24
    assert len(kept) == 1 and entries(folder) == kept


def test_a_folder_in_the_place_of_an_entry_is_named(tmp_path):
    path, out = written(tmp_path), tmp_path / "out"
    assert finished(path, out) == 0
    (name,) = entries(out)
    place = out / "store" / name[:2] / name
    place.unlink()
    place.mkdir()
    with pytest.raises(CheckFailure, match=re.escape(f"Is a directory: {place}")):
        finished(path, out)


def test_what_a_killed_run_left_of_its_mark_is_no_reason_to_refuse(tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / ".study.json.tactcad-abcd1234.part").write_text("{")
    claimed(read_study(written(tmp_path)), tmp_path / "out")
    assert [p.name for p in (tmp_path / "out").iterdir()] == ["study.json"]


def test_no_word_of_the_csv_is_a_formula(tmp_path):
    """Parquet has the words as they are, and of CSV one apostrophe is taken away."""
    assert finished(written(tmp_path, THREE), tmp_path / "out") == 0
    kept = [row["design.title"] for row in rows(tmp_path)]
    assert kept == ["'=cmd|' /C calc'!A0", "'@SUM(1)", "''-plain"] and [word[1:] for word in kept] == WORDS
    table = pq.read_table(tmp_path / "out" / "results.parquet").to_pylist()
    assert [row["design.title"] for row in table] == WORDS
