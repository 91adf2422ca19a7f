"""The review page in a real browser: opened from its file, with the network off."""

from __future__ import annotations

import copy
import os
from pathlib import Path

import numpy as np
import pytest
from browser import BROKEN, Opened, chromium

from tactcad.scenes import make_scene

pytestmark = pytest.mark.slow  # starts a browser

SCENES = ("array", "sample-stiffness", "calibration")
EACH = """() => [...document.querySelectorAll('#tree [data-designator]')].map((leaf) => {
  leaf.querySelector('b').click();
  return [leaf.dataset.designator, document.getElementById('part-number').textContent];
})"""
# Colours of a canvas where it is drawn on, each to three bits.
COLOURS = """(canvas) => {
  const all = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
  const seen = new Set();
  for (let i = 0; i < all.length; i += 4) {
    if (all[i + 3]) seen.add(`${all[i] >> 5} ${all[i + 1] >> 5} ${all[i + 2] >> 5}`);
  }
  return [...seen];
}"""
MOVED = 300  # pixels that differ at least where something moves
HOSTILE = "</script><img/src=x/onerror=alert(1)>'\"&amp;\u202e"
# What the page's script compares or looks up; no text of a design.
NOT_TEXT = ("colour", "kind", "schema", "severity", "kept", "failures", "sheets")


@pytest.fixture(scope="module")
def record(macro, tmp_path_factory):
    """The record and the arrays of two scenes; the checks are the array's, which take less."""
    chromium()
    from tactcad.export.cache import Cache
    from tactcad.export.shapes import Shapes
    from tactcad.review import facts
    from tactcad.review.review_record import review_record

    whole = facts.checked
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(facts, "checked", lambda d, names, cache, say: whole(d, names[:1], cache, say=say))
        shapes = Shapes(Cache(Path(os.environ["TACTCAD_CACHE"])), "tests")
        return review_record(macro, SCENES, shapes, lambda *_: None, {})


def written(path, record):
    from tactcad.review.review_page import review_page, viewer_library

    path.write_bytes(review_page(*record, viewer_library()))
    return path


@pytest.fixture(scope="module")
def opened(running, record, tmp_path_factory):
    page = Opened(running, written(tmp_path_factory.mktemp("page") / "review.html", record))
    yield page
    page.close()


@pytest.fixture
def fresh(opened):
    """The array's scene with all parts shown, together, whole."""
    if opened.page.locator("[data-scene=array]").get_attribute("aria-selected") != "true":
        opened.page.click("[data-scene=array]")
    opened.page.click("[data-tab=Part]")
    opened.page.click("#show-all")
    opened.page.evaluate("document.getElementById('motions').open = true")
    yield opened
    assert opened.troubles == []
    assert all(url.startswith(("file:", "blob:", "data:")) for url in opened.requests)


def differ(a: np.ndarray, b: np.ndarray) -> int:
    """Pixels that differ clearly."""
    return int((np.abs(a - b).max(axis=2) > 30).sum())


def test_the_picture_shows_every_colour_of_its_parts(fresh, macro_scene):
    fresh.page.click("#open-cover")
    shown = fresh.picture().reshape(-1, 3)
    # elements have the colour of their stiffness: of ten the softest and the stiffest two
    others = [p.part for p in macro_scene.placements if p.designator not in macro_scene.cover]
    hues = {part.colour for part in others if part.kind != "element"} | {"#fde725", "#482475"}
    assert len(np.unique(shown, axis=0)) > 50
    for colour in hues:
        # lighting scales a colour: pixels whose direction is the colour's
        c = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)], float)
        cosine = shown @ c / np.linalg.norm(c) / np.maximum(np.linalg.norm(shown, axis=1), 1e-9)
        dark = shown.max(axis=1) < 250
        assert ((cosine > 0.998) & dark).sum() > 50, colour


def tree_holds(opened, placed) -> None:
    """Every designator stands in the tree, and a click on it gives its part's number."""
    said = opened.page.evaluate(EACH)  # all at once in the page; another test clicks by the mouse
    assert sorted(said) == sorted([p.designator, p.part.part_no] for p in placed)


SIZES = ((1400, 900), (1920, 1080), (800, 1000), (390, 844))
EYE = "() => started.then(({view: {viewer: v}}) => v.getCameraPosition()[2] - v.getCameraTarget()[2])"
# Tables wider than what shows them.
WIDE = """() => [...document.querySelectorAll('.wide')]
  .filter((box) => box.scrollWidth > box.clientWidth + 1).map((box) => box.textContent.slice(0, 60))"""


def test_the_array_opens_on_its_sensing_side_and_a_rig_from_above(fresh):
    fresh.page.click("[data-scene=calibration]")
    assert fresh.page.evaluate(EYE) > 1.0
    fresh.page.click("[data-scene=array]")
    assert fresh.page.evaluate(EYE) < -1.0
    assert fresh.text("#stiffness-scale").split() == ["Stiffness", "K,", "N/mm", "7.18", "16.5", "38"]


@pytest.mark.parametrize("size", SIZES)
def test_no_cell_of_a_table_is_narrower_than_its_longest_word(running, record, tmp_path, size):
    page = Opened(running, written(tmp_path / "review.html", record), "light", size)
    page.page.locator("[data-designator=E1] > .row > b").click()
    for tab in ("Part", "Findings", "Array", "Bill"):
        page.page.click(f"[data-tab={tab}]")
        assert page.page.evaluate(BROKEN) == [] and page.page.evaluate(WIDE) == [], tab
    assert page.page.evaluate("document.documentElement.scrollWidth") <= size[0]
    page.close()


def test_findings_that_differ_in_numbers_alone_are_one_sentence(fresh, record):
    fresh.page.click("[data-tab=Findings]")
    rated = [f for f in record[0]["findings"] if f["check"] == "rated-force"]
    (card,) = (t for t in fresh.page.locator(".finding").all_inner_texts() if "not at the 2 N" in t)
    assert card.startswith(f"{len(rated)} flags") and "rated at 1.21 to 1.67 N, not at the 2 N" in card
    assert all(f["designators"][0] in card.split() for f in rated)


def test_the_tree_has_every_designator_and_a_click_gives_its_number(fresh, macro_scene):
    tree_holds(fresh, macro_scene.placements)


def test_the_panel_says_what_the_descriptions_say(fresh, macro_scene):
    fresh.page.click("[data-designator=E1] > .row > b")
    said = fresh.text("#panel")
    rows = [line.split("\t") for line in said.splitlines()]
    assert ["hinge thickness", "0.250", "0.245", "0.255", "slot floor, flat face"] in rows
    part = next(p for p in macro_scene.parts if p.part_no.endswith("element-a4mm"))
    for piece in (
        str(part.material),
        f"{part.mass:.4g} g",
        "Pairs",
        "37.99 N/mm",
        "Bill",
        "Datums",
        "Fit, as built",
    ):
        assert piece in said


def test_a_click_in_the_picture_picks_the_part_there(fresh):
    fresh.page.click("#open-cover")
    fresh.page.hover("[data-designator=E4] > .row")
    fresh.page.click("[data-designator=E4] > .row > .alone")
    box = fresh.page.locator("#canvas canvas").first.bounding_box()
    seen = (fresh.picture().min(axis=2) < 150).nonzero()  # the softest is yellow, the ground white
    row, column = int(np.median(seen[0])), int(np.median(seen[1]))
    fresh.page.mouse.click(box["x"] + column, box["y"] + row)
    assert fresh.text("#part-number") == "macro-array-element-a8mm"
    assert fresh.page.locator("[data-designator=E4]").get_attribute("aria-selected") == "true"


def moves_and_comes_back(opened, slider: str, value: float) -> None:
    """The slider changes the picture; at rest, or taken off, the picture is as before."""
    at_rest, before = opened.picture(), opened.page.locator(slider).input_value()
    opened.set(slider, value)
    assert differ(opened.picture(), at_rest) > MOVED
    if slider.startswith("#cut"):
        opened.page.click(f"{slider}-on")
    else:
        opened.set(slider, float(before))
    assert differ(opened.picture(), at_rest) < MOVED


def test_the_strain_is_shown_on_the_body_with_its_scale(fresh):
    fresh.page.click("[data-designator=E1] > .row > b")
    fresh.page.click("#views button >> nth=0")
    before = fresh.picture()
    # a box stands in the line of its own words: the name at its right end is not on the next one
    name = fresh.page.locator("label:has(#strain-body)")
    letters = name.evaluate("e => parseFloat(getComputedStyle(e).fontSize)")
    assert name.bounding_box()["height"] < 1.6 * letters
    fresh.page.check("#strain-body")
    shown = fresh.picture()
    red, blue = shown[..., 0] - shown[..., 2] > 60, shown[..., 2] - shown[..., 0] > 60
    assert red[80:].sum() > 10 and blue[80:].sum() > 10  # below the scale
    assert fresh.text("#strain-scale .ends").split("\n") == fresh.text("#panel .ends").split("\n")
    fresh.set("[aria-label='Force on the pad, N']", 0)
    assert differ(fresh.picture(), shown) > MOVED
    still = fresh.picture()
    assert not (still[80:, :, 0] - still[80:, :, 2] > 60).any()
    # another part is chosen: the body is a part again
    fresh.page.click("[data-designator=E2] > .row > b")
    assert fresh.page.locator("#strain-scale").is_hidden()
    fresh.page.click("#show-all")
    fresh.page.click("[data-designator=E1] > .row > b")
    fresh.page.click("#views button >> nth=0")
    assert not fresh.page.is_checked("#strain-body") and differ(fresh.picture(), before) < MOVED


@pytest.mark.parametrize("slider, value", [("#explode", 4), ("#cut-y", 1)])
def test_sliders_move_the_picture_and_bring_it_back(fresh, slider, value):
    moves_and_comes_back(fresh, slider, value)


def test_a_rig_has_its_parts_and_moves(fresh, macro):
    fresh.page.click("[data-scene=sample-stiffness]")
    tree_holds(fresh, make_scene(macro, "sample-stiffness").placements)
    at_rest, down = fresh.picture(), fresh.page.locator("#motion-0").input_value()
    fresh.set("#motion-1", 0)  # the cart rolls: the tip of #motion-0 is a few hundred pixels in all
    assert differ(fresh.picture(), at_rest) > MOVED
    fresh.set("#motion-0", float(down))
    assert differ(fresh.picture(), at_rest) < MOVED


def test_the_light_comes_from_the_eye_in_the_first_picture(fresh):
    """The viewer alone moves its light after each picture: the next one differed."""
    fresh.page.click("#views button >> nth=1")
    fresh.picture()
    fresh.page.click("#views button >> nth=2")
    first = fresh.picture()
    fresh.page.click("#views button >> nth=2")
    assert np.abs(fresh.picture() - first).max() <= 1


def test_each_element_is_brought_under_the_sensor(fresh):
    fresh.page.click("[data-scene=calibration]")
    at_rest = fresh.picture()
    fresh.page.select_option("#pose", label="E9")
    assert differ(fresh.picture(), at_rest) > MOVED
    fresh.set("#motion-0", 0.5)  # motions are declared with the first element under the sensor
    assert fresh.page.input_value("#pose") == "0"
    fresh.page.select_option("#pose", label="E9")
    fresh.page.select_option("#pose", label="E1")
    assert differ(fresh.picture(), at_rest) < MOVED


def test_the_tree_works_by_keyboard_alone(fresh):
    fresh.page.focus("#tree [tabindex='0']")
    for key in ("ArrowDown", "ArrowDown", "Enter"):
        fresh.page.keyboard.press(key)
    assert fresh.text("#part-number")
    whole = fresh.picture()
    fresh.page.keyboard.press("i")
    assert fresh.page.locator("#tree [data-designator] > .row > input:checked").count() == 1
    assert differ(fresh.picture(), whole) > MOVED
    fresh.page.keyboard.press("a")
    assert fresh.page.locator("#tree [data-designator] > .row > input:checked").count() == 40
    fresh.page.keyboard.press("ArrowLeft")
    fresh.page.keyboard.press("ArrowLeft")
    assert fresh.page.locator("#tree > [aria-expanded=false]").count() == 1
    fresh.page.keyboard.press("ArrowRight")


def test_measuring_reads_the_descriptions(fresh):
    fresh.page.click("[data-tab=Measure]")
    ends = (("From", "E1", "slot floor"), ("To", "E1", "flat face"))
    for end, part, feature in ends:
        fresh.page.select_option(f"[aria-label='{end}: part']", part)
        fresh.page.select_option(f"[aria-label='{end}: feature']", label=feature)
    assert fresh.text("#measured") == "0.250 mm"
    # two elements that face each other: the published gap of 2 mm lies between their arms' tips
    for end, part in (("From", "E1"), ("To", "E6")):
        fresh.page.select_option(f"[aria-label='{end}: part']", part)
        fresh.page.select_option(f"[aria-label='{end}: feature']", label="tip")
    assert fresh.text("#measured") == "2.000 mm"
    fresh.page.click("[data-tab=Part]")


def test_a_finding_shows_its_part_and_its_place(fresh, record):
    found = [f for f in record[0]["findings"] if f["place"]][0]
    fresh.page.click("[data-tab=Findings]")
    whole = fresh.picture()
    fresh.page.locator(f".finding .link[title*='{found['about']}']").first.click()
    assert fresh.page.locator(".finding .link").count() == len(record[0]["findings"])
    shown = fresh.page.locator("#tree [data-designator]:has(> .row > input:checked)")
    assert shown.evaluate_all("all => all.map((e) => e.dataset.designator)") == list(found["designators"])
    fresh.page.wait_for_selector("#marker", state="visible")  # it is put there with the next picture
    assert differ(fresh.picture(), whole) > MOVED
    assert found["message"] in fresh.text("#status")


def test_the_strain_is_drawn_in_colours_with_its_scale(fresh, record):
    fresh.page.click("[data-designator=E1] > .row > b")
    canvas = fresh.page.locator("canvas.strain")
    drawn = canvas.evaluate(COLOURS)
    reds = [c for c in drawn if int(c.split()[0]) > int(c.split()[2]) + 2]
    blues = [c for c in drawn if int(c.split()[2]) > int(c.split()[0]) + 2]
    assert reds and blues and len(drawn) > 10
    estimate = record[0]["array"]["elements"]["E1"]
    said = fresh.text("#panel .ends").split("\n")
    most = float(said[-1])
    # the picture's largest strain is at the fillet: the estimate's there, within its stated error and a tenth
    assert most == pytest.approx(1e6 * estimate["fillet_per_newton"] * 2.0, rel=0.16)


BODY = """(share) => started.then((page) => {
  const part = page.panel.placed.get('E1').part_no;
  const {rated_force} = page.record.array.elements.E1.estimate;
  const field = page.panel.on.strain(part);
  return [...strainBody(field, page.meshes.get(part), share * rated_force, 1).positions];
})"""


def test_the_pressed_body_is_the_part_and_gives_way_as_estimated(fresh, record, macro_scene):
    """Without force the triangles cover the part's profile but for the rounded corners at both ends of the
    finite elements; at the rated force the load line moves by the estimate's K, drawn five times."""
    still, pressed = (np.array(fresh.page.evaluate(BODY, share)).reshape(-1, 3, 3) for share in (0, 1))
    part = next(p.part for p in macro_scene.placements if p.designator == "E1")
    front = still[np.ptp(still[..., 2], axis=1) == 0.0][..., :2]
    areas = np.linalg.det(np.stack([front[:, 1] - front[:, 0], front[:, 2] - front[:, 0]], axis=1)) / 2.0
    for side in (areas[areas > 0], -areas[areas < 0]):
        assert side.sum() == pytest.approx(part.volume / part.body.thickness, rel=1e-3)
    e = record[0]["array"]["elements"]["E1"]["estimate"]
    line = record[0]["strains"][part.part_no]["hinge_x"] - e["load_arm"]
    moved = (pressed - still)[np.abs(still[..., 0] - line) < 1e-3][:, 1].mean() / 5.0
    # the field is of plane stress; the hinge, wider than thick, bends between that and plane strain
    assert 1.0 < moved / (e["rated_force"] / e["stiffness"]) < 1.0 / (1.0 - 0.33**2)
    assert np.allclose((pressed - still)[still[..., 0] > still[..., 0].max() - 5.0], 0.0)


def test_texts_are_never_markup(running, record, tmp_path):
    def bad(value, key=""):
        if key in NOT_TEXT:
            return value
        if isinstance(value, dict):
            return {(bad(k) if key in ("elements", "strains") else k): bad(v, k) for k, v in value.items()}
        if isinstance(value, list | tuple):
            return [bad(v, key) for v in value]
        return value + HOSTILE if isinstance(value, str) else value

    plain, block = record
    page = Opened(running, written(tmp_path / "bad.html", (bad(copy.deepcopy(plain)), block)))
    assert page.troubles == [] and page.page.get_attribute("html", "data-ready") == "true"
    assert page.text("#title") == plain["design"]["title"] + HOSTILE
    assert page.page.title().startswith(plain["design"]["title"] + "</script>")
    for tab in ("Findings", "Array", "Bill", "Measure"):
        page.page.click(f"[data-tab={tab}]")
    page.page.click("[data-tab=Part]")
    page.page.locator("#tree [data-designator^=E1] > .row > b").first.click()
    assert page.text("#part-number").endswith(HOSTILE)
    assert page.page.locator("img:not(#printed)").count() == 0 and page.troubles == []
    page.close()


@pytest.mark.nightly
@pytest.mark.parametrize("scheme, size", [("dark", (1200, 800)), ("light", (390, 844)), ("dark", (390, 844))])
def test_it_is_readable_dark_and_on_a_phone(running, record, tmp_path, scheme, size):
    page = Opened(running, written(tmp_path / "review.html", record), scheme, size)
    ground = page.page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert (ground == "rgb(255, 255, 255)") == (scheme == "light")
    corner = page.picture()[5, 5]
    assert (corner.max() < 60) == (scheme == "dark")
    wide = page.page.evaluate("document.documentElement.scrollWidth")
    assert wide <= size[0] and page.troubles == []
    page.close()
