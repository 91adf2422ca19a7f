"""The benchmarks in smoke mode: every one runs, says what it measured on, and writes a whole report."""

from __future__ import annotations

import json
import math
import shutil
import sys
import xml.etree.ElementTree as ET

import bench
import calculix
import pytest
from bench import SCHEMA, main
from measuring import BENCHMARKS, PEERS, Benchmark, array_of, freecad_version, measured, python

from tactcad.design.messages import CheckFailure


def follows_schema(result: dict) -> None:
    """The document's promises: keys, types, tables whose rows have only described columns and plain
    values."""
    assert result["schema"] == SCHEMA and result["mode"] in ("smoke", "short", "full")
    assert isinstance(result["seed"], int) and result["seconds"] > 0 and len(result["date"]) == 10
    assert {"processor", "cores", "memory_GB", "system", "load"} <= set(result["machine"]) and result[
        "machine"
    ]["cores"] >= 1
    assert {"python", "tactcad", "numpy", "scipy", "scikit-fem", "cadquery-ocp"} <= set(result["versions"])
    assert set(result["peers"]) == {"CalculiX", "FreeCAD"}
    for name, entry in result["benchmarks"].items():
        assert (
            name in BENCHMARKS
            and entry["title"]
            and entry["question"].endswith("?")
            and entry["seconds"] >= 0
        )
        assert "failed" not in entry, entry["failed"]
        assert all(
            isinstance(line, str) and line.endswith(".") for line in entry["findings"] + entry["missing"]
        ), entry["findings"]
        for data in entry["tables"].values():
            assert set(data) == {"title", "columns", "rows", "note"} and data["columns"]
            assert all(set(c) == {"key", "heading", "unit", "scale"} for c in data["columns"])
            for row in data["rows"]:
                assert all(
                    v is None or isinstance(v, str | bool | int) or math.isfinite(v) for v in row.values()
                )
                assert set(row) & {c["key"] for c in data["columns"]}


# Whole exports in processes of their own, or elements solved often.
LONG = ("detail", "element", "export", "rungs", "scaling", "sheets", "step")


@pytest.mark.by_day(1, "a benchmark each")
@pytest.mark.cad
@pytest.mark.parametrize(
    "name", [pytest.param(b, marks=pytest.mark.nightly) if b in LONG else b for b in BENCHMARKS]
)
def test_every_benchmark_runs_in_smoke_mode(name, tmp_path, capsys):
    out = tmp_path / "report"
    assert main(["--smoke", "--only", name, "--out", str(out)]) == 0
    result = json.loads((out / "report.json").read_text("utf-8"))
    follows_schema(result)
    (entry,) = result["benchmarks"].values()
    assert any(data["rows"] for data in entry["tables"].values()) and entry["findings"] is not None
    said = (out / "report.md").read_text("utf-8")
    assert capsys.readouterr().out == said + "\n"
    for line in (*entry["findings"], *entry["missing"], entry["question"]):
        assert line in said
    assert {p.stem for p in (out / "tables").iterdir()} == set(entry["tables"])
    for plot in out.glob("plots/*.svg"):
        assert ET.parse(plot).getroot().tag.endswith("svg") and f"plots/{plot.name}" in said
    check_contents(name, entry["tables"])


def measuring(monkeypatch, name, measure):
    """The benchmark of that name measures what the test wants."""
    monkeypatch.setitem(BENCHMARKS, name, Benchmark("T", "Q?", measure, False))


def test_a_fault_in_one_benchmark_loses_nothing_of_the_others(tmp_path, monkeypatch):
    def broken(plan):
        return 1 / 0

    measuring(monkeypatch, "element", lambda plan: {"findings": ["Measured."]})
    measuring(monkeypatch, "meshes", broken)
    done = bench.run(bench.RunPlan("smoke", 1, tmp_path), ["meshes", "element"])["benchmarks"]
    assert "ZeroDivisionError in broken" in done["meshes"]["failed"] and done["element"]["findings"] == [
        "Measured."
    ]


def check_contents(name: str, made: dict) -> None:
    """What must be true of the figures whatever the machine."""
    rows = next(iter(made.values()))["rows"]
    if name == "rungs":
        by = {row["rung"]: row for row in rows}
        assert by["solid"]["solid worst"] < 0.004 < 0.05 < by["plane"]["solid worst"], (
            "plane stress is no thick sheet"
        )
        assert by["plane"]["plane worst"] < 0.004 and by["short"]["solid worst"] > 0.5
        assert all(row["solid mean"] <= row["solid worst"] for row in rows)
    elif name == "meshes":
        plane = [row for row in rows if row["elements"] == "plane" and row["code"] == "tactcad"]
        assert [row["worst"] for row in plane] == sorted((row["worst"] for row in plane), reverse=True)
        assert any(row["code"] == "CalculiX" for row in rows) == bool(calculix.executable())
    elif name == "tessellation":
        assert (
            rows[0]["volume error"] > rows[-1]["volume error"]
            and rows[0]["triangles"] < rows[-1]["triangles"]
        )
    elif name == "interference":
        assert rows[0]["by"] == "kernel" and rows[0]["wrong"] == 0 and rows[1]["wrong"] > 0
        assert all(row["same verdicts"] for row in made["situations"]["rows"])
    elif name == "detail":
        full, light = rows
        assert (
            light["bytes"] < full["bytes"]
            and light["solids"] == full["solids"]
            and full["peak_bytes"] > 100e6
        )
    elif name == "step":
        assert rows[1]["form"] == "copies" and rows[1]["size ratio"] > 1.0
    elif name == "element":
        assert {row["program"] for row in rows} == {"tactcad", "bare kernel"} | (
            {"FreeCAD"} if freecad_version() else set()
        )
        assert all(row["off"] < 1e-9 and row["read off"] < 1e-9 for row in rows)
    elif name == "sheets":
        assert rows[0]["sheets"] == rows[1]["sheets"] >= 8 and rows[1]["seconds"] < rows[0]["seconds"]
    elif name == "export":
        assert rows[0]["cold"] > rows[0]["unchanged"]


def test_a_peer_that_is_not_installed_is_said(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(calculix, "executable", lambda: None)
    assert main(["--smoke", "--only", "meshes", "--out", str(tmp_path / "out")]) == 0
    assert "CalculiX (ccx) is not installed: not compared." in capsys.readouterr().out


def test_without_the_kernel_it_says_so_and_measures_the_rest(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(bench, "_kernel", lambda: False)
    assert main(["--smoke", "--only", "tessellation", "--out", str(tmp_path / "out")]) == 0
    assert "The CAD kernel is not installed: not measured." in capsys.readouterr().out


def test_a_benchmark_that_fails_is_reported_and_the_status_is_one(monkeypatch, tmp_path, capsys):
    def fail(plan):
        raise CheckFailure("the mesh is torn")

    measuring(monkeypatch, "meshes", fail)
    assert main(["--smoke", "--only", "meshes", "--out", str(tmp_path / "out")]) == 1
    assert "FAILED: the mesh is torn" in capsys.readouterr().out


def test_a_folder_with_other_things_is_refused_before_anything_is_measured(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(bench, "run", lambda *args: pytest.fail("measured"))
    (tmp_path / "thesis.tex").write_text("mine")
    with pytest.raises(SystemExit) as refused:
        main(["--smoke", "--out", str(tmp_path)])
    assert refused.value.code == 2 and (tmp_path / "thesis.tex").read_text() == "mine"


def test_a_childs_memory_is_its_own():
    """Two children of this large process: one that takes 200 MB more shows 200 MB more, and the other one
    little."""
    ballast = bytearray(300_000_000)
    small = measured(python("-S", "-c", "pass"))
    large = measured(python("-S", "-c", "x = bytearray(200_000_000); x[::4096] = b'1' * len(x[::4096])"))
    assert len(ballast) > 0 and small.peak_bytes < 60e6
    assert 190e6 < large.peak_bytes - small.peak_bytes < 230e6


def test_a_child_that_fails_is_a_failure_with_its_last_words():
    with pytest.raises(CheckFailure, match="status 3: no more"):
        measured(python("-c", "import sys; print('no more', file=sys.stderr); sys.exit(3)"))


def test_the_peers_know_nothing_of_tactcad():
    peers = sorted(PEERS.glob("*.py"))
    assert [p.stem for p in peers] == ["freecad_element", "kernel_element", "plain_export"]
    assert not [p for p in peers if "import tactcad" in p.read_text() or "from tactcad" in p.read_text()]


@pytest.mark.nightly
def test_baseline_and_export_write_the_same_number_of_solids(tmp_path):
    from tactcad.scenes.rigs.array import array

    run = measured(python(PEERS / "plain_export.py", "10", str(tmp_path / "plain")))
    scene = array(array_of(10))
    assert f"{len(scene.parts)} distinct parts, {len(scene.placements)} solids" in run.output


def test_freecad_is_found_where_it_is():
    assert bool(freecad_version()) == bool(shutil.which("freecadcmd") or shutil.which("FreeCADCmd")), sys.path
