"""The grasping set-up's guide: what is handled stands by then; what was put together is not listed again."""

from __future__ import annotations

import re
from html import unescape

import numpy as np
import pytest
from variants import variant

from tactcad.drawing import guide
from tactcad.parts.rules import load
from tactcad.scenes import make_scene
from tactcad.scenes.moves import box, moments
from tactcad.scenes.scene import STILL


@pytest.fixture(scope="module", params=["grasping", "calibration"])
def case(request):
    design = variant()
    scene = make_scene(design, request.param)
    return scene, guide.page(design, scene).decode()


def sections(page):
    """Text and table of each step, by title, in order."""
    found = re.findall(r"<h2>\d+\. (.*?)</h2>\s*<p>(.*?)</p>(.*?)</section>", page, re.S)
    return {unescape(title): (unescape(text), rest) for title, text, rest in found}


def test_the_finished_array_is_one_line(case):
    """Every designator of the array's own parts is left out, every other one listed once."""
    scene, page = case
    ready = {p.designator for p in scene.ready[0].placements}
    cells = " ".join(re.findall(r"<td>([A-Z]{2}\d+(?: [A-Z]{2}\d+)*|E\d+(?: E\d+)*)</td>", page)).split()
    assert sorted(cells) == sorted(p.designator for p in scene.placements if p.designator not in ready)
    assert page.count("array, put together by its own guide") == 1
    assert "strain gauge adhesive" not in page


def test_latch_and_stop_are_there_before_they_are_used():
    page = guide.page(variant(), make_scene(variant(), "grasping")).decode()
    steps = sections(page)
    order = list(steps)
    first = {
        word: next(n for n, title in enumerate(order) if word in steps[title][0])
        for word in ("latch", "end stop")
    }
    rail = order.index("Guide rail")
    assert "ES1" in steps["End stop"][1] and "LP1" in steps["Guide rail"][1]
    assert first["end stop"] == order.index("End stop") < order.index("Riser") < first["latch"] == rail
    # the carriage is held while something is screwed on it, and no sample lies yet where the flat plate does
    text = steps["Bar on the carriage"][0]
    assert text.index("set the latch under it") < text.index("screw it on the carriage")
    level, sample = order.index("Pads level with the lid"), order.index("Sample")
    cart, boards = order.index("Cart on the base plate"), order.index("Boards on the bench")
    assert cart < boards < level < sample < order.index("Weights")


def test_levelling_is_measured():
    """To a quarter of 0.1 degree over rows of 16 mm, 4 mm apart, and over a sample of 32 mm."""
    text = sections(guide.page(load("macro-array"), make_scene(load("macro-array"), "grasping")).decode())
    said = re.findall(r"within ([\d.]+) um", text["Pads level with the lid"][0])
    sides = np.array([16.0, 4.0, 32.0])
    assert [float(v) for v in said[:3]] == pytest.approx(1e3 * sides * np.tan(np.radians(0.025)), rel=0.03)


def test_one_row_is_levelled_by_its_own_ends():
    design = variant({"array.row_arms": [[4.0, 7.0, 6.0, 8.0]]})
    text = sections(guide.page(design, make_scene(design, "grasping")).decode())["Pads level with the lid"][0]
    assert "both ends of the row within" in text and "rows" not in text


def test_the_moving_weight_is_in_grams_too():
    """3.235 N at standard gravity."""
    text = sections(guide.page(variant(), make_scene(variant(), "grasping")).decode())["Ballast"][0]
    newton, gram = map(float, re.search(r"([\d.]+) N, ([\d.]+) g", text).groups())
    assert gram == pytest.approx(newton / 9.80665e-3, abs=0.05)


@pytest.mark.parametrize("weights", [0, 3])
def test_every_part_ends_at_its_place(weights):
    """Without weights nobody was told to lower the array."""
    scene = make_scene(variant({"grasping.weights": weights}), "grasping")
    at = {}
    for moment in moments(scene):
        at |= dict.fromkeys(moment.move.designators, moment.move.path[-1])
    assert {at[p.designator] for p in scene.placements} == {STILL}
    assert scene.steps[-1].title == ("Weights" if weights else "Lower")


def test_a_stage_of_long_travel_is_not_driven_into_the_base_plate():
    scene = make_scene(variant({"calibration.axis_travel": 100.0}), "sample-stiffness")
    stage, base = (next(p for p in scene.placements if p.designator == name) for name in ("SM1", "BP1"))
    lowest = min(z for m in moments(scene) if "SM1" in m.move.designators for *_, z in m.move.path)
    assert box(stage)[0][2] + lowest > box(base)[1][2]
