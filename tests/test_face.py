"""`import tactcad as tc`: few names, loaded late, and answers that other code gives too."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import types
from dataclasses import replace
from pathlib import Path

import pytest
from variants import variant

import tactcad as tc
from tactcad.design.load import parse

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "python.md").read_text("utf-8")
SQUARE = tc.Extrusion(tc.rectangle(-5, -5, 5, 5), 3.0)


def own(part_no: str = "own") -> tc.Part:
    return tc.Part(part_no, "Cover", "milled", tc.Material("6061-T6", 2700), SQUARE)


def drilled(**wrong):
    hole = {"at": (1, 1, 3), "axis": (0, 0, -1), "diameter": 2.0, "depth": 3.0, "through": True} | wrong
    return replace(own(), features=(tc.Hole("mount", **hole),))


def test_loading_a_design_loads_neither_numpy_nor_the_kernel():
    script = "import tactcad as tc, sys; tc.load('macro-array'); print(*sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, cwd=ROOT, check=True
    )
    loaded = {name.split(".")[0] for name in done.stdout.split()}
    assert "tactcad" in loaded and not loaded & {"numpy", "OCP", "build123d", "scipy", "matplotlib"}


def test_the_names_are_few_and_each_is_shown_once():
    assert len(tc.__all__) <= 20 and f"has {len(tc.__all__)} names" in PAGE
    for name in tc.__all__:
        assert callable(getattr(tc, name)), name
        assert re.search(rf"(?:tc\.|`)({name})\b", PAGE) or name in ("LoadedDesign", "OpenScene"), name
    with pytest.raises(AttributeError, match="it has CheckFailure"):
        _ = tc.nonsense


def test_a_bare_name_is_a_dimension_and_never_its_tolerance():
    d = tc.load("macro-array")
    thicker = d.with_(hinge_thickness=0.3).design
    assert thicker.element.hinge_thickness == 0.3
    assert thicker.tolerance == d.design.tolerance == variant().tolerance
    assert d.design.element.hinge_thickness == 0.25  # as it was
    assert d.with_({"tolerance.hinge_thickness": 0.004}).design.tolerance.hinge_thickness == 0.004


def test_what_follows_from_a_value_follows_it():
    wider = tc.load("macro-array").with_({"array.pitch": 4.5})
    assert wider.design.array.pitch == 4.5 and wider.design.array.spacer is None
    assert wider.size[1] - tc.load("macro-array").size[1] > 4 * 0.5  # five elements in a row
    steel = tc.load("soft-tissue").with_({"material.alloy": "1.4310-C1300"})
    assert steel.design.material.yield_strength > 1000
    assert "tougher" not in steel.design.origin.get("material.alloy", "")


@pytest.mark.parametrize(
    ("ask", "said"),
    [
        (lambda d: d.with_(thickness=2.0), "sheet.thickness or cart.thickness or sample.thickness"),
        (lambda d: d.with_(hinge_thicknes=0.3), "did you mean hinge_thickness"),
        (lambda d: d.with_({"array.ptch": 4}), "did you mean array.pitch"),
        (lambda d: d.with_(rows=3), "did you mean row_arms"),  # not of another family
        (lambda d: d.with_({"array": {"pitch": 4}}), "a table, not a field"),
        (lambda d: d.with_({"array.pitch.x": 4}), "is no table"),
        (lambda d: d.with_(pitch=2.0), "pitch_is_sheet_and_spacer"),
        (lambda d: d.with_(row_arms=[[4, "x"]]), "array.row_arms"),
        (lambda d: d.scene("arrays"), "no scene 'arrays'; there are array, .*did you mean array"),
        (lambda d: d.estimate(model="best"), "one of short, beam"),
        (lambda d: d.estimate(force=-1), "force"),
        (lambda d: d.scene("array").add("a cover"), "a tc.Part or a build123d solid"),
        (lambda d: d.scene("array").add(own(), at=(1, 2)), "x, y, z in mm"),
        (lambda d: d.scene("array").add(own(), at=(0, 0, float("nan"))), "x, y, z in mm"),
        (lambda d: d.scene("array").add(own(), at="top"), "x, y, z in mm"),
        (lambda d: d.scene("array").add(own(), step=3), "step: not text"),
        (lambda d: d.scene("array").add(own(), touches=3), "a designator of scene array"),
        (lambda d: d.scene("array").add(own("../own")), "part.part_no: not usable"),
        (lambda d: d.scene("array").add(replace(own(), process="forged")), "one of wire-cut, etched"),
        (lambda d: d.scene("array").add(replace(own(), material="6061-T6")), "a tc.Material"),
        (lambda d: d.scene("array").add(replace(own(), body=replace(SQUARE, outer=3))), "part.body"),
        (lambda d: d.scene("array").add(replace(own(), body=replace(SQUARE, thickness=-1))), "part.body"),
        (lambda d: d.scene("array").add(drilled(at=(1, 2))), "part.features: not usable.*a list of tc.Hole"),
        (lambda d: d.scene("array").add(drilled(axis=(0, 0, -2))), "unit axis"),
        (lambda d: d.scene("array").add(drilled(diameter="3")), "sizes above 0"),
        (lambda d: d.scene("array").add(drilled(depth=0.0)), "sizes above 0"),
        (lambda d: d.scene("array").add(drilled(thread="X9")), "thread as M3"),
        (lambda d: d.scene("array").add(replace(own(), features="hole")), "part.features"),
        (lambda d: d.scene("array").add(replace(own(), material=tc.Material("a", "b"))), "part.material"),
        (lambda d: d.scene("array").add(replace(own(), body=replace(SQUARE, thickness="3"))), "part.body"),
        (lambda d: d.scene("array").check("array"), r"check: too many .*; legal: check\(\)"),
        (lambda d: d.estimate(forc=1), r"'forc'; legal: estimate\(model='solid', force=None\)"),
        (lambda d: d.export("out", drawings="maybe"), "drawings: not a yes or no; found 'maybe'"),
        (lambda d: d.estimate()["K"], "records by number"),
        (lambda d: tc.rectangle("a"), r"missing .*'y0'; legal: rectangle\(x0, y0, x1, y1\)"),
        (lambda d: tc.rectangle(0, 0, 1, "a"), "y1: not a number; found 'a'; legal: a length in mm"),
        (lambda d: tc.rectangle(0, 0, 1, float("inf")), "y1: not a number"),
        (lambda d: tc.rectangle(1, 0, 0, 1), "no area; .*x0 < x1"),
        (lambda d: tc.circle(3, 1.0), r"centre: not a place; found 3; legal: \(x, y\) in mm"),
        (lambda d: tc.circle((0, 0), 0), "diameter: not a size; found 0; legal: above 0 mm"),
        (lambda d: tc.stiffness("none.csv", d), "calibration: not a path"),
        (lambda d: tc.calibrate(None), "file: not a path"),
        (lambda d: tc.design(5), "target: not a path"),
        (lambda d: d.scene(None), "no scene None"),
        (lambda d: d.with_(3), "not fields and values"),
        (lambda d: d.with_({3: 4}), "3: unknown field"),
        (lambda d: d.with_(alloy="stainless"), "did you mean 17-4PH-H900 or 1.4310-C1300 or 1.4034-hardened"),
        (lambda d: d.export(None), "not a path"),
        (lambda d: d.scene("array").add(own(), touches="CA9"), "CA1"),
        (lambda d: d.scene("array").add(own("macro-array-carrier")), "two parts share the number"),
        (lambda d: tc.load("macro"), "macro-array"),
        (lambda d: tc.new("soft-tissue", name="a b"), "a b"),
        (lambda d: tc.calibrate("none.csv"), "no such file"),
        (lambda d: tc.calibrate("none.csv", load_cells=3), "unknown argument"),
    ],
)
def test_a_wrong_question_is_refused_in_our_words(ask, said):
    with pytest.raises(tc.InputError, match=said):
        ask(tc.load("macro-array"))


def test_an_estimate_is_the_model_s_and_shows_itself():
    answer = tc.load("macro-array").with_(hinge_thickness=0.3).estimate(model="short", force=1.0)
    # rung short: K L^2 = E b t^3 / (12 (1 - nu^2) l) to a constant, so K goes with t^3 alone
    before = tc.load("macro-array").estimate(model="short", force=1.0)
    assert answer[3].stiffness / before[3].stiffness == pytest.approx((0.3 / 0.25) ** 3)
    assert answer.to_dict()["elements"][3]["stiffness"] == answer[3].stiffness
    assert f"{answer[3].stiffness:.4g}" in repr(answer) and "N/mm" in repr(answer)
    assert answer._repr_html_().count("<tr>") == 11


def test_a_frame_where_pandas_is_there(monkeypatch):
    answer = tc.load("macro-array").estimate()
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(tc.CheckFailure, match="pip install pandas"):
        answer.to_frame()
    monkeypatch.setitem(sys.modules, "pandas", types.SimpleNamespace(DataFrame=list))
    assert [row["number"] for row in answer.to_frame()] == list(range(1, 11))


@pytest.mark.slow  # the example's two samples twice
def test_readings_give_what_a_file_between_them_gives(tmp_path):
    readings, grasps = (str(ROOT / "hardware" / "examples" / f"{n}.csv") for n in ("calibration", "grasp"))
    calibration = tc.calibrate(readings)
    file = tmp_path / "calibration.json"
    file.write_text(json.dumps(calibration.to_dict()), "utf-8")
    got = tc.stiffness(grasps, calibration)
    assert got.to_dict() == tc.stiffness(grasps, file).to_dict() and len(got) == 2


def test_a_new_design_is_a_file_of_its_own(tmp_path):
    mine = tc.new("soft-tissue", name="my-tissue").with_(pitch=4.2)
    assert mine.name == "my-tissue"
    mine.save(tmp_path / "my-tissue.toml")
    assert parse((tmp_path / "my-tissue.toml").read_text("utf-8"), "mine") == mine.design
    with pytest.raises(tc.InputError, match="there already"):
        mine.save(tmp_path / "my-tissue.toml")


def test_an_added_part_is_in_bill_steps_and_size():
    d = tc.load("macro-array")
    scene = d.scene("array").add(own(), at=(0, 0, 40), step="Cover")
    (row,) = [row for row in scene.bill if "OWN1" in row.designators]
    assert (row.part_no, row.mass_g) == ("own", pytest.approx(10 * 10 * 3 * 2.7e-3))
    assert scene.made.steps[-1].designators == ("OWN1",)
    assert scene.size[2] == pytest.approx(43 - min(p.origin[2] for p in scene.made.placements), abs=2.0)
    assert len(d.scene("array").made.placements) == len(scene.made.placements)
    assert len(tc.load("macro-array").scene("array").made.placements) == len(scene.made.placements) - 1
    assert len(d.with_(pitch=4.2).scene("array").made.placements) == len(scene.made.placements)


@pytest.mark.slow  # exports and checks by the kernel
@pytest.mark.cad
def test_parts_of_one_s_own_are_exported_checked_and_shown(tmp_path):
    from build123d import Box, import_step

    d = tc.load("macro-array").with_({"array.row_arms": [[5], [5]]})
    free = d.scene("array").add(own(), at=(0, 0, 40)).add(Box(4, 4, 4), at=(0, 0, 60), name="Block")
    assert free.check().to_dict()["passed"]
    free.export(tmp_path / "out")
    solids = import_step(
        tmp_path / "out" / "step" / f"{d.name}-array_{d.design.design.revision}.step"
    ).solids()
    assert sum(abs(s.volume - 64) < 1e-6 and abs(s.center().Z - 60) < 1e-6 for s in solids) == 1
    assert len(solids) == len(free.made.placements)
    assert "Block" in (tmp_path / "out" / "bom.csv").read_text("utf-8")
    assert b"<html" in free.show().html
    free.add(own(), at=(0, 0, 20))  # in the carrier
    assert any("OWN3" in f.message for f in free.check() if f.severity == "fail")


@pytest.mark.slow  # the page's examples, export and search among them
@pytest.mark.cad
def test_the_page_s_examples_run(tmp_path, monkeypatch):
    (tmp_path / "hardware").symlink_to(ROOT / "hardware")
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for block in re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL):
        exec(block, names)
    assert (tmp_path / "out" / "manifest.json").is_file() and (tmp_path / "my-tissue.toml").is_file()
