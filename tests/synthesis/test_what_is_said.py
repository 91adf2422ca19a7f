"""What a synthesis says of itself is so: what binds, what was not tried, what the base design takes, what is
written where."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from small_target import SMALL

from tactcad.cli.main import main
from tactcad.design.design_text import design_text
from tactcad.design.load import read
from tactcad.design.messages import CheckFailure, InputError
from tactcad.parts.language.finding import Finding
from tactcad.scenes import LeftOut
from tactcad.synthesis import bounds, synthesise
from tactcad.synthesis.bounds import Bound
from tactcad.synthesis.made_arrays import COUNT, variance_shares
from tactcad.synthesis.search import FAR
from tactcad.synthesis.synthesise import LeastChange, Synthesis, attempt, goal_of
from tactcad.synthesis.target import TABLES, Target, parse_target, read_target
from tactcad.synthesis.target_report import answer, no_other_change, record, refuse_unwritable, report_page


def target(*changes: tuple[str, object]) -> Target:
    got = parse_target(SMALL, "t")
    for path, value in changes:
        got = got.with_(path, value)
    return got


@lru_cache
def small() -> Synthesis:
    return attempt(target(), arrays=100, within=0.1)


@pytest.mark.parametrize(
    ("path", "value", "says"),
    [
        ("room.width", 25.0, "misses room.width by"),
        ("room.length", 50.0, "misses room.length by"),
        ("room.height", 10.0, "misses room.height by"),
        ("elements.hinges", (0.005, 0.01), "estimator does not reach"),
        ("elements.arms", (1.2, 1.3), "estimator does not reach"),
        ("stock.sheets", (0.2,), "estimator does not reach"),
    ],
)
def test_the_limit_that_binds_is_the_one_named(path, value, says):
    r = record(attempt(target((path, value)), arrays=10, within=0.5))
    assert not r["met"] and says in answer(r)
    others = ("room.elements", "target.half_width", "e+")
    assert not any(other in answer(r) for other in others)


def test_room_that_is_missed_by_a_little_is_missed_by_that():
    """The carrier of four elements in two rows against a room 3 % narrower."""
    got = small().found.candidate.stand
    narrow = target(("room.width", float(got.widths[2]) / 1.03), ("room.elements", (4, 4)))
    r = record(attempt(narrow, arrays=10, within=0.5))
    assert r["beyond"]["room.width"] == pytest.approx(0.03, abs=1e-6)


def test_fields_not_tried_are_not_said_to_have_been_tried():
    assert no_other_change(small()).startswith("no single field changed")
    missed = replace(small(), met=False, left_out=("least change (2 of 9)",))
    assert no_other_change(missed) == "not tried for time: least change (2 of 9)"
    assert record(missed)["left_out"] == ["least change (2 of 9)"]
    assert b"Not tried for time: least change (2 of 9)" in report_page(missed)
    changed = replace(small(), met=False, changes=(LeastChange("grasp.force", 6.0, 7.0),))
    assert b"No other single field" in report_page(changed)


def test_best_that_writes_nothing_says_so(tmp_path, capsys, answer_only):
    (tmp_path / "t.toml").write_text(SMALL + "[stock]\nsheets = [0.2]\n")
    out = str(tmp_path / "o")
    assert main(["design", str(tmp_path / "t.toml"), "--out", out, "--within", "20%", "--best"]) == 1
    said = capsys.readouterr().out
    assert f"{out}: not written: no candidate keeps every limit" in said and "not tried for time" in said


def test_a_place_that_cannot_be_written_is_refused_before_the_search(tmp_path, monkeypatch, capsys):
    (tmp_path / "file").write_text("x")
    monkeypatch.setattr("tactcad.synthesis.synthesise.design", lambda *_a, **_k: pytest.fail("searched"))
    (tmp_path / "t.toml").write_text(SMALL)
    (tmp_path / "empty").mkdir()
    (tmp_path / "link").symlink_to("empty")  # a new folder cannot take its place in one step
    for place in ("file/out", "x" * 300, "file", "link", "link/"):
        assert main(["design", str(tmp_path / "t.toml"), "--out", f"{tmp_path}/{place}"]) == 2
        assert len(capsys.readouterr().err.splitlines()) == 1
    refuse_unwritable(tmp_path / "new" / "deeper")
    assert {p.name for p in tmp_path.iterdir()} == {"file", "t.toml", "empty", "link"}


def test_a_base_is_named_by_its_field_and_found_from_the_targets_folder(tmp_path, monkeypatch):
    def based(name: str) -> str:
        return SMALL.replace('name = "small"', f'name = "small"\nbase = "{name}"')

    (tmp_path / "there").mkdir()
    base = read("macro-array")
    own = replace(base, design=replace(base.design, name="own"))
    (tmp_path / "there" / "own.toml").write_text(design_text(own))
    (tmp_path / "there" / "t.toml").write_text(based("own.toml"))
    monkeypatch.chdir(tmp_path)
    assert read_target("there/t.toml").base.name == "own"
    (tmp_path / "bad.toml").write_text(design_text(own).replace("thickness = 3.0", "thickness = -3.0"))
    for name, says in (
        ("none", "no design of that name"),
        ("bad.toml", "sheet.thickness"),
        ("gone.toml", ""),
    ):
        with pytest.raises(InputError, match=f"^target.base: .*{says}"):
            parse_target(based(name), "t", tmp_path)


@pytest.mark.slow  # virtual builds
def test_shares_state_their_sampling_error_and_no_cause_has_more_alone_than_with_others():
    sensor = small().sensor
    one, *others = (variance_shares(sensor, COUNT // 16, seed) for seed in range(8))
    assert all(s.first <= s.total for some in (one, *others) for s in some)
    seen = {s.cause: [s] for s in one}
    for some in others:
        for s in some:
            seen[s.cause].append(s)
    largest = max(seen.values(), key=lambda values: np.mean([s.total for s in values]))
    scatter = float(np.std([s.total for s in largest], ddof=1))
    stated = float(np.mean([s.total_error for s in largest]))
    assert 0.5 < stated / scatter < 2.0  # eight samples


def test_an_interval_that_tells_nothing_is_said_to_be_no_sensor():
    assert not any("no useful sensor" in note for note in record(small())["notes"])
    wide = replace(small(), wanted=0.6)
    assert any("no useful sensor" in note for note in record(wide)["notes"])
    asked = replace(wide, target=target(("target.half_width", 60.0)))
    assert not any("no useful sensor" in note for note in record(asked)["notes"])


def test_rigs_that_do_not_take_the_array_are_told(monkeypatch):
    told = [
        LeftOut(scene, Finding("a_rule", "fail", "array.pitch", (), 1.0, "at least 2 mm", "too near"))
        for scene in ("calibration", "grasping")
    ]
    monkeypatch.setattr("tactcad.synthesis.synthesise.left_out", lambda _design: told)
    notes = record(replace(small()))["notes"]
    assert "not on the rig of this design; scene calibration left out" in notes[0]
    assert notes[1] == str(told[1])
    assert b"scene grasping left out" in report_page(replace(small()))


@pytest.mark.slow  # a search under all checks
def test_a_least_change_is_of_a_design_that_passes_the_slow_checks(monkeypatch):
    width = 100.0 * small().found.half_width
    missed = replace(small(), target=target(("target.half_width", round(0.8 * width, 3))), met=False)
    task = next(t for t in synthesise._changes(missed, 50) if t.name.endswith("target.half_width"))
    assert 0.8 * width < task.make().needed < 3.0 * width
    monkeypatch.setattr(synthesise, "slow_failures", lambda _design: ["a web too thin"])
    assert task.make() is None


@pytest.mark.slow  # searches again and again
def test_where_no_margin_is_enough_the_best_is_the_narrowest_and_keeps_every_limit():
    width = 100.0 * small().found.half_width
    asked = target(("target.half_width", round(1.02 * width, 3)), ("target.least", "cut"))
    got = attempt(asked, arrays=200, within=0.1)
    assert not got.met and got.found.accepted and got.made.share > 0.0
    assert got.found.half_width == pytest.approx(small().found.half_width, rel=0.1)
    assert goal_of(asked, 2.0)(got.found.candidate) < FAR


def test_what_solid_elements_cannot_follow_is_said_and_the_rest_is_told(monkeypatch):
    def refused(*_args):
        raise CheckFailure("the body is no rectangle")

    monkeypatch.setattr("tactcad.synthesis.synthesise.array_estimate.estimate", refused)
    told = next(t for t in synthesise._beside(small()) if t.name == "solid elements").make()
    got = replace(small(), unknown=(told,))
    assert "solid elements: not known, because the body is no rectangle" in record(got)["notes"]
    assert b"because the body is no rectangle" in report_page(got)


def test_every_searched_value_says_which_bounds_it_lies_on():
    got = replace(small(), bounds=(Bound("elements.arms[1]", 7.0, "written"),))
    assert got.design.origin["array.row_arms"].endswith("on bounds: elements.arms[1]")
    same = replace(got.found.design, origin=got.target.base.origin)
    kept = replace(got, target=replace(got.target, base=same))  # a search that ends where it began
    assert kept.design.origin["element.hinge_thickness"].startswith("synthesised")


def test_parts_of_the_report_that_were_left_out_have_no_heading():
    page = report_page(small()).decode()
    assert "What limits it" not in page and "by solid elements" not in page and "Stiffness ratio" not in page
    solid = replace(small(), solid=tuple(small().sensor.drawn.stiffness))
    assert "by solid elements" in report_page(solid).decode()


def test_every_field_is_eased_to_what_a_target_file_may_say():
    asked = target(("room.height", 30.0), ("target.half_width", 40.0), ("known.runs", 60), ("room.rows", 1))
    names = []
    for by in (1.1, bounds.FURTHEST):
        for name, other in bounds.eased(asked, by):
            table, field = name.partition("[")[0].split(".")
            value = getattr(getattr(other, table), field)
            spec = TABLES[table].__dataclass_fields__[field].metadata["spec"]
            spec.read(list(value) if isinstance(value, tuple) else value, name)
            names.append(name)
    wanted = {"room.height", "target.share", "elements.kinds", "room.rows"}
    assert wanted <= set(names) and "elements.of_a_kind" not in names  # one is the least
    eased = dict(bounds.eased(target(("elements.of_a_kind", 3)), 2.0))
    assert eased["elements.of_a_kind"].elements.of_a_kind == 2
    assert eased["target.share"].target.share == pytest.approx(0.9)
    assert eased["elements.kinds"].elements.kinds == 4
