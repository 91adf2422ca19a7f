"""The array's guide, followed to the letter, builds the array of the scene."""

from __future__ import annotations

import re
from html import unescape
from xml.etree import ElementTree

import numpy as np
import pytest
from variants import variant

from tactcad.drawing import guide
from tactcad.drawing.engine.boxes import box_corners, placed
from tactcad.drawing.engine.layout_check import layout_faults
from tactcad.drawing.guide import face_map
from tactcad.parts.language.metric import METRIC
from tactcad.scenes import make_scene, scene_names
from tactcad.scenes.moves import moments
from tactcad.scenes.scene import Placement, Scene

DESIGNS = {
    "macro": variant(),
    "soft": variant(base="soft-tissue"),
    "one row": variant({"array.row_arms": [[4, 7, 6]]}),
    "unequal rows": variant({"array.row_arms": [[4, 7, 6, 8], [5, 6]]}),
    "tie rods": variant({"array.row_arms": [[4, 7, 6, 8, 6] * 2, [8, 5, 4, 5, 7] * 2]}),
}


@pytest.fixture(scope="module", params=DESIGNS)
def case(request):
    design = DESIGNS[request.param]
    scene = make_scene(design, "array")
    return design, scene, guide.page(design, scene).decode()


def box(p: Placement) -> np.ndarray:
    corners = np.array([placed(p, c) for c in box_corners(p.part.body.box)])
    return np.array([corners.min(axis=0), corners.max(axis=0)])


def step_text(page: str, title: str) -> str:
    (text,) = re.findall(rf"<h2>\d+\. {title}</h2>\s*<p>(.*?)</p>", page)
    return unescape(text)


def orders(page: str) -> dict[int, tuple[str, list[str]]]:
    """Side and designators by row, as the page says."""
    text = step_text(page, "Stack")
    return {
        int(row): (side, re.findall(r"(?:SP|E|BL)\d+", names))
        for row, side, names in re.findall(r"Row (\d), on the (\w+) \([+-]x\): (.*?)\.", text)
    }


def test_the_words_stacked_part_on_part_are_the_scene(case):
    """EP2 lies on its outer face, the carrier's threads away from the mechanic, who looks along +y."""
    _, scene, page = case
    at = {p.designator: p for p in scene.placements}
    first = step_text(page, "End plate and dowels")
    assert "EP2" in first and "on its outer face" in first and "carrier's threads away from you" in first
    (thread,) = {f.axis for f in at["EP2"].part.features if f.name == "carrier"}
    away = -np.array(at["EP2"].rotation, float) @ np.array(thread, float)
    along = np.array([0.0, 1.0, 0.0])
    assert box(at["EP2"])[0][1] == max(box(p)[1][1] for d, p in at.items() if d[:2] in ("SP", "BL"))
    right = np.cross(along, away)
    said = orders(page)
    stacked = [p for d, p in at.items() if re.fullmatch(r"(SP|E|BL)\d+", d)]
    assert sorted(d for _, names in said.values() for d in names) == sorted(p.designator for p in stacked)
    for row, (side, names) in said.items():
        top = box(at["EP2"])[0][1]
        for name in names:
            low, high = box(at[name])
            assert high[1] == pytest.approx(top, abs=1e-6), f"row {row}: {name} out of order"
            top -= at[name].part.extrusion.thickness
            assert low[1] == pytest.approx(top, abs=1e-6)
            assert ((low + high) / 2 @ right > 0) == (side == "right"), f"{name} on the wrong side"
        assert top == pytest.approx(box(at["EP1"])[1][1], abs=1e-6)


def test_rows_are_as_alike_as_the_head_plates_holes_allow(case):
    """Stacks that differ by d lean the plate by d over the rows' distance: over its thickness a third of the
    play that its least holes leave the largest pins."""
    design, scene, page = case
    alike = float(re.search(r"the two lengths agree within ([\d.]+) mm", step_text(page, "Stack"))[1])
    at = {p.designator: p for p in scene.placements}
    pins = [p.origin[0] for d, p in at.items() if d.startswith("DW")]
    apart = 2 * min(abs(x) for x in pins)
    (bore,) = [c for c in at["EP1"].part.characteristics if c.name == "dowel hole diameter"]
    assert design.clamp.dowel == "3"
    play, thick = bore.lower - 3.008, at["EP1"].part.extrusion.thickness  # 3 m6
    assert alike / apart * thick <= play / 3 < (alike + 0.01) / apart * thick


def test_what_is_read_off_the_indicator_is_whole_micrometres(case):
    _, _, page = case
    less, more = re.search(r"to ([\d.]+) mm less, or ([\d.]+) mm more", page).groups()
    assert float(more) > float(less)
    assert len(more.partition(".")[2]) <= 3


def test_arms_in_the_text_are_the_parts_numbers(case):
    _, scene, page = case
    said = dict(re.findall(r"(E\d+) \(arm ([\d.]+)\)", step_text(page, "Stack")))
    made = {
        p.designator: re.search(r"-a([\d.]+)mm", p.part.part_no)[1]
        for p in scene.placements
        if re.fullmatch(r"E\d+", p.designator)
    }
    assert said == made


def test_dowels_stand_as_deep_as_the_text_and_the_sheet_say(case):
    _, scene, page = case
    at = {p.designator: p for p in scene.placements}
    deep, out = map(
        float,
        re.search(
            r"([\d.]+) mm deep: ([\d.]+) mm stand out", step_text(page, "End plate and dowels")
        ).groups(),
    )
    face, (low, high) = box(at["EP2"])[0][1], box(at["DW1"])[:, 1]
    assert (high - face, face - low) == (pytest.approx(deep), pytest.approx(out))
    (note,) = [n for n in at["EP2"].part.notes if "dowels" in n]
    assert f"{deep:g} deep: {out:g} stand out" in note
    assert not [n for n in at["EP1"].part.notes if "dowels" in n]


def test_nothing_is_pushed_between_the_pads_and_one_row_has_no_gap(case):
    design, _, page = case
    text = step_text(page, "Coplanar pads")
    assert "gauge block" not in text and "Put" not in text
    assert ("force nothing between the pads" in text) == (len(design.array.row_arms) == 2)


def test_an_end_plate_is_called_what_it_is(case):
    _, scene, page = case
    at = {p.designator: p for p in scene.placements}
    features = {d: at[d].part.features for d in ("EP1", "EP2")}
    sunk = any(getattr(f, "counterbore", None) for f in features["EP1"])
    threaded = any(f.name.startswith("screw") and f.thread for f in features["EP2"])
    assert ("counterbore" in step_text(page, "Other end plate")) == sunk
    assert ("tapped" in at["EP2"].part.name) == threaded
    assert ("nuts" in step_text(page, "Coplanar pads")) == any(d.startswith("NU") for d in at)


def test_tools_drive_every_screw_and_nut_at_its_torque(case):
    design, scene, page = case
    listed = re.search(r"<h2>Tools</h2><ul>(.*?)</ul>", page)[1]
    for p in scene.placements:
        thread = re.match(r"ISO(\d+)-(M[\d.]+)", p.part.part_no)
        if thread and thread[1] in ("4762", "4026", "4032"):
            m = METRIC[thread[2]]
            size = {"4762": m.key, "4026": m.set_key, "4032": m.nut}[thread[1]]
            assert re.search(rf"(key|nut drivers) {size:g} mm: [^<]*{thread[2]} ", listed)
            tight = guide.torque(p.part, design)
            assert tight is not None
            assert not tight or re.search(rf"torque driver for [\d., ]*\b{tight:g}\b", listed)
            assert not tight or f"<td>{tight:g} N m</td>" in page
    assert page.index("<h2>Tools") < page.index("<h2>1.")
    for tool in ("surface plate", "lever indicator", "feelers"):
        assert tool in listed


def test_hinges_are_spared_and_pads_read_again_whenever_something_was_loosened(case):
    design, _, page = case
    assert "never by its arm" in step_text(page, "Gauges")
    assert "whenever the clamping has been loosened" in step_text(page, "Coplanar pads")
    for title in ("Carrier", "Hold the stop plate down"):
        assert "pads' heights" in step_text(page, title)
    assert ("pads' heights" in step_text(page, "Stop plate")) == ("calibration" in scene_names(design))


def test_the_map_shows_every_element_where_it_stands(case):
    """Of the written picture: pads as in the scene, seen from below; each name at its element's height, on
    its row's side."""
    _, scene, page = case
    root = ElementTree.fromstring(guide.sensing_face_map(scene))
    texts = {
        e.text.split(" ")[0].strip(",:"): (float(e.get("x")), float(e.get("y")) - 1.25)
        for e in root.iter("{http://www.w3.org/2000/svg}text")
    }
    pads, outlines = [], []
    for e in root.iter("{http://www.w3.org/2000/svg}path"):
        pairs = re.findall(r"[\d.]+,[\d.]+", e.get("d"))
        points = np.array([[float(v) for v in pair.split(",")] for pair in pairs])
        if len(points) == 4:
            (pads if e.get("fill") else outlines).append(points.mean(axis=0))
    at = {p.designator: p for p in scene.placements}
    elements = [d for d in at if re.fullmatch(r"E\d+", d)]
    middles = {}
    for d in elements:
        face = at[d].part.extrusion.outer.named("pad_face")
        ends = [
            placed(at[d], (*e, z))
            for e in (face.start, face.end)
            for z in (0.0, at[d].part.extrusion.thickness)
        ]
        middles[d] = np.mean(ends, axis=0)[:2]
    # x to the right, y down: one scale and one shift take all pads to the drawn ones
    want = np.array([middles[d] for d in elements])
    drawn = np.array(pads)
    assert len(drawn) == len(want)
    k = np.ptp(want, axis=0).argmax()
    f = np.ptp(drawn, axis=0)[k] / np.ptp(want, axis=0)[k]
    shift = drawn.mean(axis=0) - f * want.mean(axis=0)
    for d in elements:
        here = f * middles[d] + shift
        assert np.abs(drawn - here).max(axis=1).min() < 0.01
        body = f * box(at[d])[:, :2].mean(axis=0) + shift
        assert np.abs(np.array(outlines) - body).max(axis=1).min() < 0.01
        if d in texts:
            x, y = texts[d]
            assert abs(y - here[1]) < 0.5, d
            assert (x > f * 0.0 + shift[0]) == (middles[d][0] > 0), d
    numbers = sorted(int(d[1:]) for d in elements)
    assert {f"E{numbers[0]}", f"E{numbers[-1]}"} <= set(texts)
    assert len(elements) > 12 or set(elements) <= set(texts)
    assert texts["EP1"][1] < texts["EP2"][1] and {"+x", "+y"} <= set(texts)
    for section in page.split("<section>"):
        title = re.search(r"<h2>(?:\d+\. )?(.*?)</h2>", section)
        handles = title and title[1] in ("Gauges", "Stack", "Coplanar pads", "Hold the stop plate down")
        assert bool(handles) == ("sensing-face.svg" in section)


@pytest.mark.parametrize("length", [1, 5, 25, 100])
def test_nothing_on_the_map_covers_its_texts(length):
    scene = make_scene(variant({"array.row_arms": [[4.0] * length, [5.0] * length]}), "array")
    assert [fault for fault in layout_faults(face_map(scene, "x")) if " over " in fault] == []


@pytest.mark.cad
def test_the_pictures_show_the_stack_as_it_stands(case):
    """EP2 at the bottom, row 1 to the right, pads towards the eye; from the clamping on, pads down."""
    from tactcad.drawing.engine.picture import VIEWS

    _, scene, _ = case
    for step in scene.steps:
        view = VIEWS[step.view]
        eye, right, up = view.eye, view.right, view.up
        if step.title in ("End plate and dowels", "Stack", "Other end plate"):
            assert up[1] == -1 and right[0] > 0.5 and eye[2] < 0
        else:
            assert up[2] == 1 and right[0] > 0.5


def test_what_was_taken_away_is_in_no_later_picture():
    """The gauge block comes in the step Roller tip, goes in the next, and boards stay."""
    scene = make_scene(variant(), "calibration")
    shown = {
        step.title: {p.designator for some in guide.at_step(scene, moments(scene), n) for p in some}
        for n, step in enumerate(scene.steps, start=1)
        if guide.pictured(step)
    }
    with_block = [title for title, names in shown.items() if "AID1" in names]
    assert with_block == ["Roller tip", "Stiffness of gauge and stand"]
    assert {"AID2", "AID3"} <= shown["Calibrate"] and "AID2" not in shown["Mount on the stages"]


def test_an_exploded_stack_lies_open(case):
    """Between neighbours of a row there is air, in the order in which they go on."""
    design, scene, page = case
    out = {p.designator: p for p in guide.exploded(scene)}
    for _, names in orders(page).values():
        for before, after in zip(names, names[1:]):
            assert box(out[before])[0][1] - box(out[after])[1][1] > design.array.pitch / 2, (before, after)
    # both rows' parts of one place stay abreast
    (_, right), (_, left) = orders(page).values()
    for a, b in zip(right, left):
        assert box(out[a])[1][1] == pytest.approx(box(out[b])[1][1])


def test_rigs_that_handle_the_array_show_the_map_too():
    design = variant()
    for name, titles in (("calibration", ["Calibrate"]), ("grasping", ["Array under the foot"])):
        scene: Scene = make_scene(design, name)
        assert [step.title for step in scene.steps if step.elements] == titles
        assert guide.sensing_face_map(scene).count(b"E10, arm 7") == 1
    assert guide.sensing_face_map(make_scene(design, "sample-stiffness")) is None


@pytest.mark.parametrize("count", [1, 2, 3, 7])
def test_numbers_beside_a_row_never_lie_on_each_other(count):
    """However small the picture: of a row of two, too, both stand there."""
    scene = make_scene(variant({"array.row_arms": [[6.0] * count, [6.0] * count]}), "array")
    for scale in (2.0, 0.5, 0.1, 0.01):
        texts = guide.numbers(scene, scale, 10.0)
        for side in ("start", "end"):
            column = sorted((t for t in texts if t.anchor == side), key=lambda t: t.at[1])
            assert len(column) >= min(count, 2)
            for below, above in zip(column, column[1:]):
                assert above.at[1] - below.at[1] >= below.height
