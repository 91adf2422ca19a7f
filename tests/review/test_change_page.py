"""The page of a change, in a real browser: it lists exactly what was seeded, and shows it in its colours."""

from __future__ import annotations

import json

import numpy as np
import pytest
from browser import Opened, chromium
from variants import HARDWARE

from tactcad.cli.main import main
from tactcad.design.load import read
from tactcad.scenes import make_scene

pytestmark = [pytest.mark.cad, pytest.mark.slow]  # starts a browser
GREEN, RED = 1, 0  # the channel that stands above the others
MARKUP = "<img src=x onerror=alert(1)>"
SHOWN = """() => [...document.querySelectorAll('#tree [data-designator]')]
  .filter((leaf) => leaf.querySelector('input').checked).map((leaf) => leaf.dataset.designator)"""
EACH = """() => Object.fromEntries([...document.querySelectorAll('#tree [data-designator]')].map((leaf) => {
  leaf.querySelector('b').click();
  return [leaf.dataset.designator, ['part-number', 'piece-kind', 'piece-volume'].map((id) =>
    document.getElementById(id).textContent)];
}))"""


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """A small design before and after: a hinge thicker by 0.01, a carrier by 1, and markup for a title."""
    folder = tmp_path_factory.mktemp("change")
    text = (HARDWARE / "soft-tissue.toml").read_text("utf-8")
    assert "[clamp]" not in text  # the carrier's 6 mm are the default
    changed = text.replace("hinge_thickness = 0.15", "hinge_thickness = 0.16")
    changed = changed.replace('title = "Soft tissue array 2 x 4"', f'title = "{MARKUP}"')
    changed = changed.replace("\n[origin]\n", "\n[clamp]\ncarrier_thickness = 7.0\n\n[origin]\n")
    for name, content in (("before", text), ("after", changed)):
        (folder / f"{name}.toml").write_text(content, "utf-8")
    return folder / "before.toml", folder / "after.toml"


@pytest.fixture(scope="module")
def scenes(files):
    """The array's placements by designator, before and after."""
    return [{p.designator: p for p in make_scene(read(str(f)), "array").placements} for f in files]


def written(files, path, cache, times: int = 1):
    """The page; its record and arrays, made so many times, are equal."""
    from tactcad.export.shapes import Shapes
    from tactcad.export.sides import compare_sides, read_side
    from tactcad.review.change_record import change_record
    from tactcad.review.consequences import kept_designs, meaning
    from tactcad.review.review_page import review_page, viewer_library

    old, new = (read_side(str(f)) for f in files)
    told, made = (compare_sides(old, new), meaning(old, new)), []
    for _ in range(times):
        shapes = [Shapes(cache, "tests") for _ in range(2)]
        designs = kept_designs(old, new)
        made.append(change_record((old, new), designs, (shapes[0], shapes[1]), *told, lambda *_: None))
    assert all(json.dumps(m[0]) == json.dumps(made[0][0]) and m[1] == made[0][1] for m in made)
    path.write_bytes(review_page(*made[0], viewer_library()))
    return path


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    from tactcad.export.cache import Cache

    return Cache(tmp_path_factory.mktemp("cache"))


@pytest.fixture(scope="module")
def page(files, cache, tmp_path_factory):
    """Made of parts from nothing, then from the cache."""
    chromium()
    return written(files, tmp_path_factory.mktemp("change") / "changes.html", cache, times=2)


@pytest.fixture(scope="module")
def opened(running, page):
    one = Opened(running, page)
    yield one
    one.close()


@pytest.fixture
def fresh(opened):
    opened.page.click("[data-tab=Changes]")
    opened.page.click("#show-all")
    yield opened
    assert opened.troubles == []
    assert all(url.startswith(("file:", "blob:", "data:")) for url in opened.requests)


def moved(a, b) -> bool:
    return not np.allclose(a.origin, b.origin) or (a.part.body, a.part.features) != (
        b.part.body,
        b.part.features,
    )


def pixels(opened, channel: int) -> int:
    """Pixels of a colour, also seen through clear parts."""
    shown = opened.picture()
    return int((shown[..., channel] - np.delete(shown, channel, axis=2).max(axis=2) > 40).sum())


def causes(opened) -> list[str]:
    return opened.page.locator(".cause > b").all_inner_texts()


def test_the_pieces_are_those_of_what_was_seeded_and_no_others(fresh, scenes):
    said = fresh.page.evaluate(EACH)
    before, after = scenes
    seeded = {d for d in after if moved(before[d], after[d])}
    assert {f"E{n}" for n in range(1, 9)} | {"CA1"} < seeded and not any(d[:2] == "SP" for d in seeded)
    assert {name.split()[0] for name, (_, kind, _) in said.items() if kind != "same"} == seeded
    assert {name.split()[0] for name, (_, kind, _) in said.items() if kind == "same"} == set(after) - seeded
    for name, (number, kind, _) in said.items():
        designator, told = name.split()
        assert (number, kind) == (after[designator].part.part_no, told)


def test_volumes_add_up_to_the_closed_forms(fresh, scenes):
    volumes = {name: float(v.split()[0]) for name, (_, _, v) in fresh.page.evaluate(EACH).items()}
    before, after = scenes
    for designator in ("E1", "E2", "CA1"):
        came, went = (volumes.get(f"{designator} {kind}", 0.0) for kind in ("added", "removed"))
        gained = after[designator].part.volume - before[designator].part.volume
        assert came > 0 and came - went == pytest.approx(gained, rel=1e-4)


def test_causes_stand_by_consequence_and_a_click_shows_what_each_names(fresh, scenes):
    told = causes(fresh)
    assert [t.split(":")[0] for t in told] == [
        "element.hinge_thickness",
        "clamp.carrier_thickness",
        "design.title",
        "Other material that changed",
    ]
    assert "K +19 %" in fresh.page.locator(".cause").nth(0).inner_text()
    named = []
    for n in (0, 1, 3):
        fresh.page.locator(".cause").nth(n).click()
        named.append({name.split()[0] for name in fresh.page.evaluate(SHOWN)})
        assert not any(name.endswith("same") for name in fresh.page.evaluate(SHOWN))
    assert named[0] == {d for d in scenes[1] if d.startswith("E") and d[1:].isdigit()}
    assert "CA1" in named[1] and not named[0] & named[1]
    assert set().union(*named) == {d for d in scenes[1] if moved(scenes[0][d], scenes[1][d])}
    assert fresh.page.locator(".cause").nth(2).is_disabled()  # a title is no material


def test_what_came_is_green_and_what_went_is_red(fresh):
    fresh.page.click("#open-cover")
    assert fresh.page.locator("#open-cover").inner_text() == "Changed only"
    assert pixels(fresh, GREEN) > 5000 and pixels(fresh, RED) > 500
    fresh.page.locator("[aria-label=added] > .row > input").click()
    assert pixels(fresh, GREEN) == 0 and pixels(fresh, RED) > 500
    fresh.page.click("#show-all")
    fresh.page.locator(".cause").nth(0).click()  # a thicker hinge takes nothing away
    assert pixels(fresh, GREEN) > 300 and pixels(fresh, RED) == 0


def test_a_click_in_the_picture_tells_the_piece(fresh):
    fresh.page.locator("[data-designator='CA1 added'] > .row > .alone").dispatch_event("click")
    fresh.page.click("#views >> text=Above")
    picture = fresh.picture()
    row, column = (int(v) for v in np.argwhere(picture.max(axis=2) - picture.min(axis=2) > 60)[500])
    box = fresh.page.locator("#canvas canvas").first.bounding_box()
    fresh.page.mouse.click(box["x"] + column, box["y"] + row)
    assert fresh.text("#part-number") == "soft-tissue-carrier" and fresh.text("#piece-kind") == "added"


def test_a_title_is_text(fresh):
    assert fresh.text("#title") == f"What changed: {MARKUP}"
    assert any(MARKUP in text for text in causes(fresh))
    assert fresh.page.locator("img:not(#printed)").count() == 0


def test_a_rebuild_shows_nothing(running, files, tmp_path, capsys):
    again = tmp_path / "again.toml"
    again.write_bytes(files[0].read_bytes())
    out = tmp_path / "none.html"
    assert main(["diff", str(files[0]), str(again), "--review", str(out), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["identical"]
    one = Opened(running, out)
    assert one.text("#heading") == "Nothing changed" and causes(one) == []
    assert one.page.locator("#tree > li").evaluate_all("all => all.map((e) => e.ariaLabel)") == ["same"]
    assert pixels(one, GREEN) == pixels(one, RED) == 0 and one.troubles == []
    one.close()


def test_pieces_of_elements_that_take_others_designators_are_told_apart(files, tmp_path):
    """An element less in front of each row: what stood as E1 went, and E2, which is E1 now, moved."""
    from tactcad.export.sides import read_side
    from tactcad.review.change_record import change_record
    from tactcad.review.consequences import Meaning, kept_designs
    from tactcad.review.subject import shapes_of

    rows, shorter = "[[5, 9, 5, 9], [9, 5, 9, 5]]", "[[9, 5, 9], [5, 9, 5]]"
    text = files[0].read_text("utf-8")
    assert rows in text
    (tmp_path / "less.toml").write_text(text.replace(rows, shorter), "utf-8")
    old, new = read_side(str(files[0])), read_side(str(tmp_path / "less.toml"))
    designs = kept_designs(old, new)
    shapes = shapes_of(designs[0], lambda _: None), shapes_of(designs[1], lambda _: None)
    record, _ = change_record((old, new), designs, shapes, [], Meaning(), lambda *_: None)
    labels = [p["designator"] for p in record["scenes"][0]["placed"]]
    assert len(set(labels)) == len(labels) and {"E1 removed", "E1 removed 2"} < set(labels)
    assert sum(label.startswith("E") and "removed" in label and label[1].isdigit() for label in labels) == 8


def test_a_side_without_a_design_is_refused_and_nothing_is_written(files, tmp_path, capsys):
    golden = str(HARDWARE.parent / "exports" / "golden" / "soft-tissue.json")
    out, other = tmp_path / "page.html", tmp_path / "light.html"
    assert main(["diff", golden, str(files[0]), "--review", str(out), "--html", str(other)]) == 2
    assert "does not tell its design" in capsys.readouterr().err
    assert not out.exists() and not other.exists()


@pytest.mark.parametrize(
    "asked, said",
    [
        (["--review", "x.html", "--html", "x.html"], "--html is written there"),
        (["--review", "nowhere/x.html"], "no such folder"),
    ],
)
def test_a_place_that_cannot_be_written_is_refused_before_any_work(
    files, tmp_path, monkeypatch, capsys, asked, said
):
    monkeypatch.chdir(tmp_path)
    assert main(["diff", *map(str, files), *asked]) == 2
    assert said in capsys.readouterr().err and not list(tmp_path.iterdir())


def test_material_told_apart_by_meshes_is_labelled(running, files, scenes, cache, tmp_path, monkeypatch):
    import tactcad.solids.changed as module

    def fails(*_):
        raise ValueError("injected")

    monkeypatch.setattr(module, "_by_kernel", fails)
    opened = Opened(running, written(files, tmp_path / "meshes.html", cache))
    assert "by meshes, for the kernel's boolean failed" in opened.text("#panel")
    pieces = opened.page.evaluate(EACH)
    before, after = (scenes[n]["E1"].part.volume for n in (0, 1))
    assert float(pieces["E1 added"][2].split()[0]) == pytest.approx(after - before, rel=1e-3)
    opened.page.click("[data-designator='E1 added'] > .row > b")
    assert "by meshes" in opened.text("#panel") and opened.troubles == []
    assert pixels(opened, GREEN) > 50
    opened.close()
