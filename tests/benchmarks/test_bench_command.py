"""`tactcad bench` in smoke mode: every benchmark runs, says what it measured on, and writes a whole
report."""

from __future__ import annotations

import json
import math
import shutil
import sys
import xml.etree.ElementTree as ET

import pytest

from tactcad.bench import freecad
from tactcad.bench.process import measured, python
from tactcad.bench.session import BENCHMARKS, SCHEMA
from tactcad.cli.main import main
from tactcad.fem import calculix


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


# Whole exports in processes of their own, or elements solved often. `detail` is one too, and test_exits.py
# starts it.
LONG = ("detail", "element", "export", "rungs", "scaling", "sheets", "step")


@pytest.mark.cad
@pytest.mark.parametrize(
    "name", [pytest.param(b, marks=pytest.mark.nightly) if b in LONG else b for b in BENCHMARKS]
)
def test_every_benchmark_runs_in_smoke_mode(name, tmp_path, capsys):
    out = tmp_path / "report"
    assert main(["bench", "--smoke", "--only", name, "--json", "--out", str(out)]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert json.loads((out / "report.json").read_text("utf-8")) == printed
    follows_schema(printed)
    (entry,) = printed["benchmarks"].values()
    assert any(data["rows"] for data in entry["tables"].values()) and entry["findings"] is not None
    said = (out / "report.md").read_text("utf-8")
    for line in (*entry["findings"], *entry["missing"], entry["question"]):
        assert line in said
    assert {p.stem for p in (out / "tables").iterdir()} == set(entry["tables"])
    for plot in out.glob("plots/*.svg"):
        assert ET.parse(plot).getroot().tag.endswith("svg") and f"plots/{plot.name}" in said
    check_contents(name, entry["tables"])


def test_a_fault_in_one_benchmark_loses_nothing_of_the_others(tmp_path, monkeypatch):
    from tactcad.bench import one_element, session
    from tactcad.bench.run_plan import RunPlan

    def broken(plan):
        return 1 / 0

    monkeypatch.setattr(one_element, "measure", lambda plan: {"findings": ["Measured."]})
    monkeypatch.setattr("tactcad.bench.meshes.measure", broken)
    done = session.run(RunPlan("smoke", 1, tmp_path), ["meshes", "element"], lambda *_: None)["benchmarks"]
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
            {"FreeCAD"} if freecad.version() else set()
        )
        assert all(row["off"] < 1e-9 and row["read off"] < 1e-9 for row in rows)
    elif name == "sheets":
        assert rows[0]["sheets"] == rows[1]["sheets"] >= 8 and rows[1]["seconds"] < rows[0]["seconds"]
    elif name == "export":
        assert rows[0]["cold"] > rows[0]["unchanged"]


def test_a_peer_that_is_not_installed_is_said(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(calculix, "executable", lambda: None)
    assert main(["bench", "--smoke", "--only", "meshes", "--json"]) == 0
    (entry,) = json.loads(capsys.readouterr().out)["benchmarks"].values()
    assert any("CalculiX" in line and "not installed" in line for line in entry["missing"])


def test_without_the_kernel_it_says_so_and_measures_the_rest(monkeypatch, capsys):
    from tactcad.bench import session

    monkeypatch.setattr(session, "missing", lambda extra: [extra])
    assert main(["bench", "--smoke", "--only", "tessellation"]) == 0
    assert "The CAD kernel is not installed: not measured." in capsys.readouterr().out


def test_a_benchmark_that_fails_is_reported_and_the_status_is_one(monkeypatch, capsys):
    from tactcad.bench import meshes
    from tactcad.design.messages import CheckFailure

    def fail(plan):
        raise CheckFailure("the mesh is torn")

    monkeypatch.setattr(meshes, "measure", fail)
    assert main(["bench", "--smoke", "--only", "meshes"]) == 1
    assert "FAILED: the mesh is torn" in capsys.readouterr().out


@pytest.mark.parametrize(
    "arguments, words",
    [(["--only", "speed"], ("--only", "speed", "rungs")), (["--seed", "-1"], ("--seed", "-1"))],
)
def test_bad_arguments_are_refused(arguments, words, capsys):
    assert main(["bench", "--smoke", *arguments]) == 2
    line = capsys.readouterr().err.strip().splitlines()[-1]
    assert all(word in line for word in words)


def test_a_folder_with_other_things_is_refused_before_anything_is_measured(tmp_path, capsys, monkeypatch):
    from tactcad.bench import session

    monkeypatch.setattr(session, "run", lambda *args: pytest.fail("measured"))
    (tmp_path / "thesis.tex").write_text("mine")
    assert main(["bench", "--smoke", "--out", str(tmp_path)]) == 2
    assert "thesis.tex" in capsys.readouterr().err and (tmp_path / "thesis.tex").read_text() == "mine"


def test_a_childs_memory_is_its_own():
    """Two children of this large process: one that takes 200 MB more shows 200 MB more, and the other one
    little."""
    ballast = bytearray(300_000_000)
    small = measured(python("-S", "-c", "pass"))
    large = measured(python("-S", "-c", "x = bytearray(200_000_000); x[::4096] = b'1' * len(x[::4096])"))
    assert len(ballast) > 0 and small.peak_bytes < 60e6
    assert 190e6 < large.peak_bytes - small.peak_bytes < 230e6


def test_a_child_that_fails_is_a_failure_with_its_last_words():
    from tactcad.design.messages import CheckFailure

    with pytest.raises(CheckFailure, match="status 3: no more"):
        measured(python("-c", "import sys; print('no more', file=sys.stderr); sys.exit(3)"))


def test_the_peers_know_nothing_of_tactcad():
    peers = sorted((freecad.SCRIPT.parent).glob("*.py"))
    assert [p.stem for p in peers] == ["freecad_element", "kernel_element", "plain_export"]
    assert not [p for p in peers if "import tactcad" in p.read_text() or "from tactcad" in p.read_text()]


@pytest.mark.nightly
def test_baseline_and_export_write_the_same_number_of_solids(tmp_path):
    from tactcad.bench import arrays
    from tactcad.bench.export_times import PLAIN_SCRIPT
    from tactcad.scenes.array import array

    run = measured(python(str(PLAIN_SCRIPT), "10", str(tmp_path / "plain")))
    scene = array(arrays.of(10))
    assert f"{len(scene.parts)} distinct parts, {len(scene.placements)} solids" in run.output


def test_freecad_is_found_where_it_is():
    assert bool(freecad.version()) == bool(shutil.which("freecadcmd") or shutil.which("FreeCADCmd")), sys.path
