"""FreeCAD's document holds what the design says, and its review fails where it does not."""

from __future__ import annotations

import ast
import json
import re
import subprocess
import sys
import tomllib
from dataclasses import replace
from math import isclose
from pathlib import Path

import pytest

from tactcad.cli.main import main
from tactcad.design.load import read
from tactcad.review import freecad
from tactcad.review.facts import FindingFact, scene_facts
from tactcad.review.freecad import freecad_record, parameter_rows
from tactcad.scenes import make_scene

ROOT = Path(__file__).parents[2]
sys.path.append(str(ROOT / "packaging" / "review"))

import document  # noqa: E402


def test_every_value_of_the_design_file_stands_among_the_parameters():
    with (ROOT / "hardware" / "macro-array.toml").open("rb") as file:
        tables = tomllib.load(file)
    rows = {row[0]: row for row in parameter_rows(read("macro-array"))}
    for section, table in tables.items():
        for name, value in table.items() if section != "origin" else ():
            if isinstance(value, (int, float, str)):
                assert rows[f"{section}.{name}"][1] == value
    assert rows["element.hinge_thickness"][1:3] == (0.25, "mm")
    assert all(rows[path][4] == text for path, text in tables["origin"].items() if path in rows)


def record(*findings: FindingFact, scene: str = "grasping"):
    design = read("macro-array")
    made = make_scene(design, scene)
    parts = {p.part_no: p for p in made.parts}
    return made, freecad_record(design, [scene_facts(design, made)], parts, findings)


def test_a_finding_is_marked_at_its_place_on_every_part_that_it_is_about():
    finding = FindingFact("hinge", "flag", "x", "thin", "", ("E1", "E6"), (4.86, 0.125))
    made, got = record(finding)
    marks = {m["label"]: m["at"] for m in got["scenes"][0]["findings"]}
    assert set(marks) == {"flag: E1", "flag: E6"}
    for p in made.placements:
        if p.designator in ("E1", "E6"):
            # the same place by columns: x times where local x points, and so on
            x, y, z = (tuple(row[k] for row in p.rotation) for k in range(3))
            at = [4.86 * a + 0.125 * b + 0.0 * c + o for a, b, c, o in zip(x, y, z, p.origin)]
            assert marks[f"flag: {p.designator}"] == pytest.approx(at)


def test_a_finding_of_another_scene_has_no_mark_here():
    other = FindingFact("interference", "fail", "E1", "meet", "array", ("E1",), (0.0, 0.0, 0.0))
    here = replace(other, scene="grasping", place=(1.0, 2.0, 3.0))
    _, got = record(other, here)
    assert [(m["label"], m["at"]) for m in got["scenes"][0]["findings"]] == [
        ("fail: interference", (1.0, 2.0, 3.0))
    ]


PLACED = {"part": "d-plate", "scene": ["array"], "volume": 8.0, "valid": True, "at": [0, 0, 0]}
FOUND = {"placed": [{**PLACED, "label": "EP1", "apart": [0, 0, 9]}]}
BILLS = {"array": [{"part_no": "d-plate", "has_solid": True, "designators": "EP1"}]}
PARTS = {"d-plate": {"volume_mm3": 8.0}}
SHOWN = {"colours": {"d-plate": "#101010"}}
WANT = {"d-plate": "#101010"}


def test_a_document_as_it_is_meant():
    assert document.document_faults(FOUND, SHOWN, BILLS, PARTS, WANT) == []


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"label": "EP2"}, "EP1 of d-plate is not in the document"),
        ({"scene": ["grasping"]}, "EP1 of d-plate is not in the document"),
        ({"volume": 8.1}, "volume 8.1"),
        ({"valid": False}, "volume 8"),
        ({"apart": [0, 0, 0]}, "nothing moves"),
    ],
)
def test_a_document_that_is_wrong(change, said):
    found = {"placed": [FOUND["placed"][0] | change]}
    assert any(said in text for text in document.document_faults(found, SHOWN, BILLS, PARTS, WANT))
    grey = {"colours": {"d-plate": "#cccccc"}}
    assert any("#cccccc" in text for text in document.document_faults(FOUND, grey, BILLS, PARTS, WANT))


def test_where_freecad_is_missing_it_says_how_to_get_it(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(freecad, "COMMANDS", ("no-such-program",))
    out = tmp_path / "x.FCStd"
    assert main(["review", "soft-tissue", "--freecad", str(out)]) == 1
    assert "apt-get install freecad" in capsys.readouterr().err and not out.exists()
    assert main(["review", "soft-tissue", "--freecad", str(tmp_path / "x.step")]) == 2
    assert "NAME.FCStd" in capsys.readouterr().err


def test_the_macro_runs_this_tactcad_whatever_the_folder_holds(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tactcad.py").write_text("raise SystemExit('theirs')")
    text = freecad.reload_macro(["schema"], tmp_path / "d.FCStd").decode()
    said = dict(re.findall(r"^(COMMAND|FOLDER) = (.*)$", text, re.MULTILINE))
    command, folder = (ast.literal_eval(said[name]) for name in ("COMMAND", "FOLDER"))
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert run.returncode == 0 and "[element]" in run.stdout, run.stderr


freecad_is_here = pytest.mark.skipif(
    not any(map(freecad.shutil.which, freecad.COMMANDS)), reason="FreeCAD is not installed"
)


@pytest.mark.cad
@freecad_is_here
@pytest.mark.slow  # starts FreeCAD
def test_freecad_opens_its_document_and_takes_it_apart(tmp_path):
    """Texts of the design are shown as they stand: none is a formula or markup. `make review` holds every
    shipped design's document against its export."""
    import review

    text = (ROOT / "hardware" / "soft-tissue.toml").read_text()
    title = "=1+1 <b>'A1"
    (tmp_path / "d.toml").write_text(text.replace(text.split('title = "')[1].split('"')[0], title))
    path = tmp_path / "d.FCStd"
    assert main(["review", str(tmp_path / "d.toml"), "--scene", "array", "--freecad", str(path)]) == 0
    command = next(c for c in review.CANDIDATES if review.answers(c))
    found = review.open_files(command, [str(path)])["files"][str(path)]
    scene = make_scene(read("soft-tissue"), "array")
    at = {p.designator: p for p in scene.placements}
    assert sorted(p["label"] for p in found["placed"]) == sorted(at)
    for p in found["placed"]:
        placed = at[p["label"]]
        assert p["part"] == placed.part.part_no and p["at"] == pytest.approx(placed.origin, abs=1e-9)
        assert isclose(p["volume"], placed.part.volume, rel_tol=1e-6)
    step = next(s for s in scene.steps if "CA1" in s.designators)
    cover = next(p for p in found["placed"] if p["label"] == "CA1")
    assert [b - a for a, b in zip(cover["at"], cover["apart"])] == pytest.approx(step.explode, abs=1e-6)
    assert found["sheets"]["Review"][0] == ["title", "'" + title] or found["sheets"]["Review"][0][1].endswith(
        title
    )
    assert document.colours(path)["colours"] == {p.part_no: p.colour for p in scene.parts}


IN_FREECAD = """\
import json, os, traceback, FreeCAD, FreeCADGui
def state(document):
    return {"placed": {o.Label: o.Shape.Volume for o in document.Objects if o.TypeId == "App::Link"},
            "camera": FreeCADGui.activeDocument().activeView().getCamera()}
try:
    document = FreeCAD.openDocument(os.environ["REVIEW_FILE"])
    FreeCADGui.activeDocument().activeView().viewTop()
    said = [state(document)]
    for text in json.loads(os.environ["REVIEW_TEXTS"]):
        with open(os.environ["REVIEW_DESIGN"], "w") as out:
            out.write(text)
        with open(os.environ["REVIEW_MACRO"]) as macro:
            exec(macro.read(), {"__name__": "__main__"})
        said.append(state(FreeCAD.ActiveDocument))
    said.append(len(FreeCAD.listDocuments()))
except Exception:
    said = traceback.format_exc()
with open(os.environ["REVIEW_OUT"], "w") as out:
    json.dump(said, out)
os._exit(0)
"""


@pytest.mark.slow  # starts FreeCAD's window program
@pytest.mark.cad
@freecad_is_here
def test_the_macro_makes_the_document_again_and_keeps_the_eye(tmp_path, monkeypatch):
    """Run inside FreeCAD's window program, after a change of the design, and after one that breaks a rule."""
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "hardware" / "soft-tissue.toml").read_text()
    design, path = tmp_path / "d.toml", tmp_path / "d.FCStd"
    design.write_text(text)
    assert main(["review", "d.toml", "--scene", "array", "--freecad", "d.FCStd"]) == 0
    thicker, broken = (text.replace("hinge_thickness = 0.15", f"hinge_thickness = {t}") for t in (0.2, 9.0))
    (tmp_path / "inside.py").write_text(IN_FREECAD)
    (tmp_path / "user.cfg").write_text(freecad.profile())
    own = freecad.environment(tmp_path) | {
        "REVIEW_FILE": str(path),
        "REVIEW_MACRO": str(path.with_suffix(".FCMacro")),
        "REVIEW_DESIGN": str(design),
        "REVIEW_TEXTS": json.dumps([thicker, broken]),
        "REVIEW_OUT": str(tmp_path / "out.json"),
    }
    command = [freecad.program(), "-u", str(tmp_path / "user.cfg"), str(tmp_path / "inside.py")]
    subprocess.run(command, env=own, capture_output=True, check=False, timeout=300)
    before, after, still, documents = json.loads((tmp_path / "out.json").read_text())
    design.write_text(thicker)
    for state, source in ((before, "soft-tissue"), (after, str(design))):
        for p in make_scene(read(source), "array").placements:
            assert state["placed"][p.designator] == pytest.approx(p.part.volume, rel=1e-6)
    assert before["placed"]["E1"] < after["placed"]["E1"]
    assert still == after and documents == 1 and after["camera"] == before["camera"]
