"""What a budget makes of a study: the rung against every design's own promise, arrays, refusals."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from small_study import SMALL, swept, written

from tactcad.costs import grades
from tactcad.design.allowance import Allowance
from tactcad.design.messages import CheckFailure, InputError
from tactcad.mechanics.accuracy import expected_error_of
from tactcad.mechanics.ladder import RUNGS
from tactcad.parts.array.hinge_section import element_section
from tactcad.sweep.designs_taken import designs_taken
from tactcad.sweep.measured import Refused, alike
from tactcad.sweep.study import read_study
from tactcad.sweep.study_grades import with_allowance


@pytest.fixture(autouse=True)
def published_machine(monkeypatch):
    monkeypatch.setattr(grades, "slowness", lambda: 1.0)


def study(folder, **changes):
    return read_study(written(folder, SMALL, **changes))


@pytest.mark.parametrize("within", [0.9, 0.3, 0.01, 0.002])
def test_the_rung_keeps_its_error_at_every_design(tmp_path, within):
    asked = study(tmp_path)
    chosen, picked = with_allowance(asked, Allowance(within), 2)
    ((_, many),) = alike(asked, designs_taken(asked, 0, asked.count), Refused(asked.count))
    sections = [element_section(many, many.elements[n - 1]) for n in asked.elements]
    worst = {
        rung: max(float(np.nanmax(expected_error_of(section, rung))) for section in sections)
        for rung in RUNGS
    }
    (rung,) = chosen.measure.rungs
    assert rung == next(r for r in RUNGS if worst[r] <= within)
    assert picked.grade.error == pytest.approx(worst[rung], rel=2e-3) and picked.what == "K"
    assert set(chosen.measure.what) == {rung, "strength"} and chosen.vary == asked.vary
    assert (chosen.identity == asked.identity) == (rung == "solid")  # another rung is another study


def test_time_is_shared_by_workers_and_grows_with_designs(tmp_path):
    asked = study(tmp_path)

    def seconds(some, workers):
        return with_allowance(some, Allowance(0.002), workers)[1].grade.seconds

    start = grades.published()["sweep"]["start"]
    one, two = seconds(asked, 1) - start, seconds(asked, 2) - start
    assert one == pytest.approx(2.0 * two, rel=0.02)
    more = replace(asked, study=replace(asked.study, count=4 * asked.study.count))
    assert seconds(more, 1) - start == pytest.approx(4.0 * one, rel=0.2)  # other designs, other meshes


def test_arrays_and_rung_are_picked_together(tmp_path):
    asked = study(tmp_path, what='["solid", "builds"]')
    chosen, picked = with_allowance(asked, Allowance(0.02), 2)
    assert chosen.measure.rungs == ("solid",) and chosen.measure.arrays == 5000
    assert picked.what == "K and half of the yield's 95 % interval" and picked.grade.error <= 0.02
    chosen, picked = with_allowance(study(tmp_path, what='["builds"]', elements=""), Allowance(0.05), 2)
    assert chosen.measure.arrays == 500 and picked.grade.name == "500 arrays"


def test_what_has_nothing_to_pick_or_no_known_error_is_refused(tmp_path):
    with pytest.raises(InputError, match="this study has neither"):
        with_allowance(study(tmp_path, what='["rules"]', elements=""), Allowance(0.01), 2)
    text = SMALL.replace(
        '[vary."array.row_arms[0][3]"]\nrange = [6, 9]', '[vary."material.poisson"]\nvalues = [0.05]'
    )
    with pytest.raises(CheckFailure, match="not measured for any design"):
        with_allowance(read_study(written(tmp_path, text)), Allowance(0.01), 2)
    with pytest.raises(CheckFailure, match="too short.*needs about"):
        with_allowance(study(tmp_path), Allowance(None, 0.01), 2)


@pytest.mark.slow  # a sweep by elements
def test_a_sweep_within_an_error_says_its_budget(tmp_path):
    path = written(tmp_path, SMALL, what='["plane", "strength"]', count="8")
    done = swept(path, "--out", tmp_path / "out", "--workers", "1", "--within", "1%", "--json")
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout)["budget"]
    assert said["chosen"]["name"] == "solid" and said["more"]["name"].startswith("fem-solid")
    manifest = json.loads((tmp_path / "out" / "manifest.json").read_text())
    assert manifest["study"]["measure"]["what"] == ["solid", "strength"]
    for args, word in ((["--in", "9", "--scheduler", "tcp://x:1"], "--in"), (["--within", "0"], "--within")):
        refused = swept(path, "--out", tmp_path / "other", *args)
        assert refused.returncode == 2 and word in refused.stderr and refused.stderr.count("\n") == 1
        assert not (tmp_path / "other").exists()
