"""`tactcad new`: what it writes is the other design under the file's name, and nothing is ever lost."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import pytest

from tactcad.cli.main import main
from tactcad.design.load import names, parse
from tactcad.parts.rules import load
from tactcad.scenes import make_scene

HARDWARE = Path(__file__).parents[2] / "hardware"


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("source", names())
def test_only_identity_changes(source, folder):
    """And the title is left out: it follows the array."""
    assert main(["new", "my-sensor.toml", "--from", source]) == 0
    old = tomllib.loads((HARDWARE / f"{source}.toml").read_text("utf-8"))
    new = tomllib.loads((folder / "my-sensor.toml").read_text("utf-8"))
    assert not {"title", "unchanged"} & {*new["design"]}
    assert new["design"].pop("name") == "my-sensor" and new["design"].pop("revision") == "A"
    for table in (old["design"], new["design"]):
        for key in ("name", "revision", "date", "title", "unchanged"):
            table.pop(key, None)
    identity = {"design.name", "design.revision", "design.date", "design.title"}
    origins = [{k: v for k, v in t.pop("origin", {}).items() if k not in identity} for t in (old, new)]
    assert old == new and origins[0] == origins[1]


@pytest.mark.parametrize(
    ("rows", "title"), [("[[4], [5]]", "2 x 1"), ("[[4, 7, 6]]", "1 x 3"), ("[[4, 7, 6], [8, 5]]", "3 + 2")]
)
def test_the_title_follows_the_array_unless_it_is_set(rows, title, folder):
    main(["new", "my-sensor.toml", "--from", "macro-array"])
    text = (folder / "my-sensor.toml").read_text("utf-8")
    other = text.replace("[[4, 7, 6, 8, 6], [8, 5, 4, 5, 7]]", rows)
    assert parse(text, "").design.title == "Tactile array 2 x 5"
    assert parse(other, "").design.title == f"Tactile array {title}"
    named = other.replace('name = "my-sensor"', 'name = "my-sensor"\ntitle = "Mine"')
    assert parse(named, "").design.title == "Mine"


def test_comments_stay(folder):
    main(["new", "my-sensor.toml", "--from", "soft-tissue"])
    comments = [line for line in (HARDWARE / "soft-tissue.toml").read_text().splitlines() if "#" in line]
    assert comments and set(comments) <= set((folder / "my-sensor.toml").read_text().splitlines())


@pytest.mark.parametrize("source", names())
def test_what_is_written_keeps_every_rule_and_is_placed_under_its_own_name(source):
    main(["new", "my-sensor.toml", "--from", source])
    scene = make_scene(load("my-sensor.toml"), "array")
    assert any(p.part.part_no.startswith("my-sensor-") for p in scene.placements)
    assert not any(source in p.part.part_no for p in scene.placements)


def test_a_design_of_ones_own_is_started_from_by_its_path(folder):
    main(["new", "one.toml"])
    assert main(["new", "two.toml", "--from", "one.toml"]) == 0
    assert load("two.toml").name == "two"


@pytest.mark.parametrize(
    "file, why",
    [
        ("con.toml", "no device of Windows"),
        ("My.toml", "of a-z, 0-9 and '-'"),
        ("a b.toml", "of a-z, 0-9 and '-'"),
        ("x" * 41 + ".toml", "1 to 40"),
        (".toml", "NAME.toml"),
        ("sensor", "NAME.toml"),
        ("sensor.json", "NAME.toml"),
        ("macro-array.toml", "a name other than"),
        ("nowhere/sensor.toml", "a writable place"),
        ("", "empty"),
    ],
)
def test_names_that_cannot_be_are_refused_and_nothing_is_written(file, why, folder, capsys):
    try:
        assert main(["new", file]) == 2
    except SystemExit as ended:
        assert ended.code == 2
    said = capsys.readouterr().err
    assert why in said and said.count("\n") == 1 and ".tactcad-" not in said  # no temporary path
    assert not list(folder.iterdir())


@pytest.mark.parametrize("kind", ["file", "folder", "link to nowhere"])
def test_what_is_there_stays(kind, folder, capsys):
    place = folder / "sensor.toml"
    {
        "file": lambda: place.write_text("mine"),
        "folder": place.mkdir,
        "link to nowhere": lambda: place.symlink_to(folder / "other.toml"),
    }[kind]()
    assert main(["new", "sensor.toml"]) == 2
    assert "is there already" in capsys.readouterr().err
    assert [p.name for p in folder.iterdir()] == ["sensor.toml"]
    assert kind != "file" or place.read_text() == "mine"


@pytest.mark.parametrize(
    "change",
    [
        lambda text: "design = " + json.dumps("x"),
        lambda text: text.replace("fillet_radius = 0.30", "fillet_radius = 0.50"),
        lambda text: text.replace("[design]\nname = ", '[design]\nname = """\n[material]\n""" # '),
        lambda text: text.replace("[design]\n", "").replace("name =", "design.name =", 1),
    ],
    ids=["no table", "breaks a rule", "text of several lines", "dotted"],
)
def test_a_source_that_is_no_sound_design_is_refused(change, folder, capsys):
    source = folder / "source.toml"
    source.write_text(change((HARDWARE / "macro-array.toml").read_text()))
    assert main(["new", "sensor.toml", "--from", "source.toml"]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and "Traceback" not in said
    assert [p.name for p in folder.iterdir()] == ["source.toml"]
