"""Rigs follow the array: of 1 to 12 elements a row, of sheets of 1 to 6 mm. Every rig is there, or a line
says which field is in the way, its value, and what would do."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import product

import pytest
from variants import DROP, variant

from tactcad.checks.described.goes_together import check_rigidity
from tactcad.checks.run import _left_out, run_checks
from tactcad.cli.main import main
from tactcad.design.load import paths
from tactcad.design.tree import LARGEST_SIDE, Design
from tactcad.parts.array.layout import Layout
from tactcad.parts.bought.standard_parts import STAGES
from tactcad.parts.rigs.cart import cart_layout
from tactcad.parts.rigs.frame import POST_Y, pad_middles
from tactcad.parts.rigs.linear_guide import guide_layout
from tactcad.parts.rigs.stand import calibration_stage
from tactcad.parts.rules import broken_rules
from tactcad.scenes import left_out, make_scene, scene_names
from tactcad.scenes.rig import all_rigs
from tactcad.scenes.rigs.grasping import ballast_range, moving_weight

ARMS = ((4, 7, 6, 8, 6), (8, 5, 4, 5, 7))
LINE = re.compile(r"scene ([\w-]+) left out: rule \w+: .+ \((\S+) = (.+); legal: (.+)\)")
GRID = list(product(range(1, 13), range(1, 7)))
# A gauge that fits a sheet of 1 mm, and dowels that are tilted less in a short stack.
NARROW = {"gauge.carrier_width": 0.9, "gauge.grid_width": 0.5, "tolerance.tilt": 0.2}


def array(count: int, sheet: float, **more: object) -> Design:
    """The published array with rows of another length, of another sheet, 1 mm apart."""
    rows = [[row[i % 5] for i in range(count)] for row in ARMS]
    changes = {"array.row_arms": rows, "sheet.thickness": float(sheet), "array.pitch": sheet + 1.0}
    return variant({**changes, **(NARROW if sheet < 3 else {}), **more})


@pytest.mark.by_day(24, "every rig of a design each")
@pytest.mark.parametrize("count, sheet", GRID)
def test_every_rig_is_there_or_a_line_names_the_field(count, sheet):
    design = array(count, sheet)
    broken = [b for b in broken_rules(design) if b.part.split(".")[0] in ("cart", "holder", "sample")]
    assert broken == []  # what follows the array breaks no rule of its own
    there, lines = scene_names(design), [str(left) for left in left_out(design)]
    said = [LINE.fullmatch(line) for line in lines]
    assert all(said), lines
    assert sorted([*there, *(m[1] for m in said)]) == sorted(all_rigs(Design))
    for m in said:
        assert m[2] in paths(design) and m[3] and m[4]
    assert not [f for f in check_rigidity(design, there, []) if f.severity == "fail"]


def test_how_many_have_which_rig():
    """Seven a row of 3 mm sheet and five of 5 mm lost both once."""
    there = {(n, t): scene_names(array(n, t)) for n, t in GRID if t >= 3}
    for (n, t), scenes in there.items():
        assert ("grasping" in scenes) == (n * (t + 1.0) - 1 <= LARGEST_SIDE), (n, t)
        reach = (n - 1) * (t + 1.0) / 2
        fits = any(reach <= s.travel and s.size / 2 + reach <= POST_Y - 0.5 for s in STAGES)
        assert ("calibration" in scenes) == fits, (n, t)
    assert set(all_rigs(Design)) == set(there[7, 3]) == set(there[5, 5])


@pytest.mark.parametrize("count, sheet", [(10, 3), (7, 5), (12, 6)])
def test_what_the_line_says_would_do_does(count, sheet):
    for scene in ("calibration", "grasping"):
        line = next((str(x) for x in left_out(array(count, sheet)) if x.scene == scene), None)
        if line is None:
            continue
        path, most = re.search(r"\((array\.row_arms) = \d+; legal: at most (\d+) elements", line).groups()
        assert path == "array.row_arms"
        assert scene in scene_names(array(int(most), sheet))
        assert scene not in scene_names(array(int(most) + 1, sheet))


@pytest.mark.parametrize("count, sheet", [(1, 3), (5, 3), (7, 3), (5, 5), (12, 3)])
def test_the_sizes_that_follow(count, sheet):
    design = array(count, sheet)
    layout, rig = Layout(design), cart_layout(design)
    for x, y in pad_middles(layout):
        beyond = rig.sample.side / 2 - max(abs(x) + design.element.pad_length / 2, abs(y) + sheet / 2)
        assert beyond >= 6.0 - 1e-9  # of rubber
    assert rig.cart.wheel_base / 2 >= rig.sample.side / 2 + 2 and rig.cart_half < POST_Y
    stage = calibration_stage(layout)
    if "calibration" in scene_names(design):
        reach = max(max(map(abs, xy)) for xy in pad_middles(layout))
        less = [s for s in STAGES if s.size < stage.size]
        assert stage.travel >= reach
        assert all(
            s.travel < reach or s.hole - 4.2 - 0.5 < min(layout.carrier_size) / 2 for s in less
        )  # M4's counterbore is at least 8.4 wide
    low, high = ballast_range(guide_layout(design))
    assert low <= design.grasping.moving_weight <= high
    assert moving_weight(make_scene(design, "grasping")) == pytest.approx(
        design.grasping.moving_weight, abs=0.005
    )


def test_the_published_set_up_is_what_follows_the_published_array():
    d = variant()
    assert (d.sample.side, d.grasping.moving_weight) == (32.0, 3.235)
    assert (d.cart.length, d.cart.width, d.cart.wheel_base) == (70.0, 54.0, 50.0)
    assert (d.holder.vacuum_diameter, d.holder.rings, d.holder.lid_thickness) == (26.0, 3, 6.0)
    assert calibration_stage(Layout(d)) == STAGES[0] and guide_layout(d).raised == 0.0


def test_what_the_design_says_stays():
    said = {"sample.side": 60.0, "grasping.moving_weight": 4.0, "holder.rings": 5, "cart.length": 99.0}
    d = variant(said)
    assert {path: paths(d)[path] for path in said} == said
    assert d.cart.width == 78.0  # around that sample


def test_a_stage_s_travel_is_at_least_what_the_design_asks_for():
    assert calibration_stage(Layout(variant({"calibration.stage_travel": 20.0}))).travel == 25.0
    (left,) = left_out(variant({"calibration.stage_travel": 26.0}))
    assert "calibration.stage_travel = 26.0; legal: at most 25 mm" in str(left)
    assert calibration_stage(Layout(variant({"calibration.stage_travel": DROP}))) == STAGES[0]


def test_the_catalogue_can_be_what_it_says():
    assert [s.size for s in STAGES] == sorted(s.size for s in STAGES)
    for s in STAGES:
        assert s.hole + 4 < s.size / 2 and s.travel < s.size / 2


# what is said, and the exit status


@pytest.fixture
def too_long(tmp_path, monkeypatch):
    """A design whose calibration cannot be had, and an export that writes nothing."""
    import tactcad.export.pipeline as pipeline
    from tactcad.design.design_text import design_text

    (tmp_path / "long.toml").write_text(design_text(array(10, 3)))
    done = pipeline.Exported(tmp_path / "out", 1, (), (), ())
    monkeypatch.setattr(pipeline, "export", lambda *_: done)
    return str(tmp_path / "long.toml")


@pytest.mark.parametrize(
    "options, status", [((), 0), (("--strict",), 1), (("--strict", "--scene", "array"), 0)]
)
def test_the_export_ends_with_a_warning_and_strict_with_status_1(too_long, options, status, capsys):
    assert main(["export", too_long, *options]) == status
    err = capsys.readouterr().err
    assert ("warning: scene calibration left out: " in err) == ("--scene" not in options)
    if "--scene" not in options:
        last = err.splitlines()[-1]
        assert "array.row_arms = 10; legal: at most 9 elements a row" in last


def test_strict_has_rigs_that_fit_pass(tmp_path, monkeypatch, capsys):
    import tactcad.export.pipeline as pipeline

    done = pipeline.Exported(tmp_path, 1, (), (), ())
    monkeypatch.setattr(pipeline, "export", lambda *_: done)
    assert main(["export", "macro-array", "--strict"]) == 0
    assert "warning" not in capsys.readouterr().err


def test_check_flags_it_and_strict_fails_it():
    design = array(10, 3)
    for severity in ("flag", "fail"):
        (found,) = _left_out(design, severity)
        assert found.severity == severity and "array.row_arms = 10" in found.message


@pytest.mark.slow  # checks a whole design by the kernel twice
@pytest.mark.cad
def test_check_strict_ends_with_status_1(tmp_path, capsys):
    from variants import table

    from tactcad.design.design_text import design_text

    small = {"array.row_arms": [[5], [5]], "calibration.stage_travel": 26.0}
    small |= {name: DROP for name in ("sample", "cart", "holder", "grasping") if name in table()}
    (tmp_path / "small.toml").write_text(design_text(variant(small)))
    for options, status in (((), 0), (("--strict",), 1)):
        assert main(["check", str(tmp_path / "small.toml"), *options]) == status
        assert "calibration.stage_travel = 26.0" in capsys.readouterr().out


@pytest.mark.nightly
@pytest.mark.cad
@pytest.mark.parametrize("count, sheet", [(7, 3), (9, 3), (12, 3), (5, 5), (6, 6), (11, 6), (12, 2), (1, 4)])
def test_every_check_passes_on_what_is_there(count, sheet):
    design = replace(array(count, sheet))
    report = run_checks(design, scene_names(design))
    assert report.failures == []
