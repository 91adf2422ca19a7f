"""Golden geometry: what is compared, what fails, what is flagged, and that nothing else writes it."""

from __future__ import annotations

import copy
import dataclasses
import json
import re
import tomllib
from pathlib import Path

import pytest
from variants import variant, without_rigs

from tactcad.cli.main import main
from tactcad.contour import Line
from tactcad.design.load import names, read
from tactcad.design.messages import CheckFailure
from tactcad.export.difference import differences
from tactcad.export.geometry import contour_record, contours
from tactcad.export.golden_file import (
    accept,
    check_golden,
    golden_bytes,
    golden_path,
    golden_record,
    judge,
    read_golden,
)
from tactcad.parts.array.element import element
from tactcad.parts.array.layout import Layout
from tactcad.parts.language.finding import Finding
from tactcad.parts.rules import load

ROOT = Path(__file__).parents[2]
# the letter that the shipped file has now, and one that it will not have soon
REVISION = tomllib.loads((ROOT / "hardware" / "soft-tissue.toml").read_text())["design"]["revision"]
NEXT = "Z"


@pytest.fixture(scope="module")
def record():
    return golden_record(variant())


def edited(record, path, change):
    """A copy of the record with the value at `path` changed."""
    other = copy.deepcopy(record)
    node = other
    for key in path[:-1]:
        node = node[key]
    node[path[-1]] = change(node[path[-1]])
    return other


def severities(findings: list[Finding]) -> set[str]:
    return {f.severity for f in findings}


@pytest.mark.parametrize("name", names())
def test_every_design_has_its_golden_file_and_agrees_with_it(name):
    path = ROOT / "exports" / "golden" / f"{name}.json"
    assert path.is_file(), "lost: take it back from git, or `make golden`"
    assert check_golden(load(name), path) == []


def test_it_holds_what_the_design_file_and_the_paper_say(record):
    arms = [e["arm_mm"] for e in record["elements"].values()]
    assert arms == [4, 7, 6, 8, 6, 8, 5, 4, 5, 7]
    K = {e["arm_mm"]: e["stiffness_n_per_mm"] for e in record["elements"].values()}
    assert K[4] > K[5] > K[6] > K[7] > K[8]
    part = record["parts"]["macro-array-spacer"]
    (x0, y0, z0), (x1, y1, z1) = part["box_mm"]
    assert z1 - z0 == 1.0 and part["volume_mm3"] < (x1 - x0) * (y1 - y0)
    aluminium = 2.81e-3
    assert part["mass_g"] == pytest.approx(part["volume_mm3"] * aluminium)
    placed = record["scenes"]["array"]["placed"]
    assert sum(row["qty"] for row in record["scenes"]["array"]["bom"].values() if row["has_solid"]) == len(
        placed
    )


def test_it_holds_no_digest_and_reads_back(record):
    text = golden_bytes(record).decode()
    assert not re.search(r"[0-9a-f]{32}", text)
    assert json.loads(text) == record


def test_equal_designs_give_equal_bytes(record):
    assert golden_bytes(golden_record(variant())) == golden_bytes(record)


def test_same_revision_with_other_geometry_fails_with_old_and_new_value(record):
    design = variant()
    thicker = dataclasses.replace(design, sheet=dataclasses.replace(design.sheet, thickness=2.9))
    findings = judge(record, golden_record(thicker))
    assert severities(findings) == {"fail"}
    assert "new revision letter" in findings[0].message
    [box] = [f for f in findings if f.part == "macro-array-element-a4mm" and "box_mm" in f.message]
    assert "3]] -> " in box.message and box.message.endswith("2.9]]")


def test_a_new_revision_is_flagged_until_it_is_taken_up(record):
    design = variant()
    changed = dataclasses.replace(
        design,
        sheet=dataclasses.replace(design.sheet, thickness=2.9),
        design=dataclasses.replace(design.design, revision=NEXT),
    )
    findings = judge(record, golden_record(changed))
    assert severities(findings) == {"flag"} and len(findings) > 10
    assert "make golden" in findings[0].message


def test_other_stiffness_alone_fails_but_asks_for_no_letter(record):
    other = copy.deepcopy(record)
    other["elements"]["E1"]["stiffness_n_per_mm"] *= 1.01
    head, change = judge(record, other)
    assert head.severity == "fail" and "revision letter" not in head.message
    assert change.part == "E1" and "(+1 %)" in change.message


@pytest.mark.parametrize(
    ("path", "below", "above"),
    [
        (("parts", "macro-array-spacer", "volume_mm3"), lambda v: v * (1 + 5e-7), lambda v: v * (1 + 2e-6)),
        (("parts", "macro-array-spacer", "cut_length_mm"), lambda v: v + 5e-7, lambda v: v + 2e-6),
        (("elements", "E3", "stiffness_n_per_mm"), lambda v: v * (1 - 5e-7), lambda v: v * (1 - 2e-6)),
        (
            ("scenes", "array", "placed", "E2", "origin_mm"),
            lambda v: [v[0], v[1] + 5e-7, v[2]],
            lambda v: [v[0], v[1] + 2e-6, v[2]],
        ),
    ],
)
def test_tolerances(record, path, below, above):
    assert differences(record, edited(record, path, below)) == []
    [change] = differences(record, edited(record, path, above))
    assert change.path == path and change.kind == "changed"


def test_added_and_removed_count_once(record):
    fewer = copy.deepcopy(record)
    part = fewer["parts"].pop("macro-array-spacer")
    [removed] = differences(record, fewer)
    assert (removed.kind, removed.path, removed.old) == ("removed", ("parts", "macro-array-spacer"), part)
    [added] = differences(fewer, record)
    assert (added.kind, added.new) == ("added", part)


def test_a_hole_that_moved_is_seen(record):
    holes = record["parts"]["macro-array-element-a4mm"]["holes"]
    assert len(holes) == 3  # two screws and a dowel
    path = ("parts", "macro-array-element-a4mm", "holes", "dowel_hole 1", "at_mm")
    [change] = differences(record, edited(record, path, lambda at: [at[0] + 0.01, *at[1:]]))
    assert change.path == path


def test_a_contour_is_compared_as_a_curve():
    layout = Layout(variant())
    outer = contours(element(layout, layout.elements[0]))[0]
    rows = contour_record(outer)
    n = next(i for i, s in enumerate(outer) if isinstance(s, Line) and s.name == "rear_top")
    x0, y0, x1, y1 = rows[n]
    middle = [(x0 + x1) / 2, (y0 + y1) / 2]
    split = [*rows[:n], [x0, y0, *middle], [*middle, x1, y1], *rows[n + 1 :]]
    turned = rows[5:] + rows[:5]
    assert differences({"contours": [rows]}, {"contours": [split]}) == []
    assert differences({"contours": [rows]}, {"contours": [turned]}) == []
    bent = [*split[:n], [x0, y0, middle[0], y0 + 0.02], [middle[0], y0 + 0.02, x1, y1], *split[n + 2 :]]
    [change] = differences({"contours": [rows]}, {"contours": [bent]})
    assert change.moved == pytest.approx(0.02, rel=1e-6)


@pytest.mark.by_day(3, "a design's geometry each")
@pytest.mark.parametrize(
    "spoil",
    [
        lambda data: data[: len(data) // 2],
        lambda data: b"[]",
        lambda data: data.replace(b"tactcad-golden-1", b"tactcad-golden-0"),
        lambda data: data.replace(b'"elements"', b'"element"'),
        lambda data: b"[" * 100_000,
        lambda data: b"\xff" + data,
    ],
)
def test_a_damaged_golden_file_is_no_agreement(record, tmp_path, spoil):
    path = tmp_path / "macro-array.json"
    path.write_bytes(spoil(golden_bytes(record)))
    [finding] = check_golden(variant(), path)
    assert finding.severity == "fail" and "cannot be used" in finding.message
    with pytest.raises(CheckFailure):
        accept(variant(), path, [])


def test_only_a_design_in_a_hardware_folder_has_one(tmp_path):
    design = read("macro-array")
    assert golden_path(tmp_path / "macro-array.toml", design) is None
    there = golden_path(tmp_path / "hardware" / "x.toml", design)
    assert there == (tmp_path / "exports" / "golden" / "macro-array.json").resolve()


def test_a_link_in_a_hardware_folder_has_one(tmp_path):
    """By the name that was given: a release asks there."""
    (tmp_path / "hardware").mkdir()
    (tmp_path / "x.toml").touch()
    (tmp_path / "hardware" / "x.toml").symlink_to("../x.toml")
    golden = tmp_path / "exports" / "golden" / "macro-array.json"
    assert golden_path(tmp_path / "hardware" / "x.toml", read("macro-array")) == golden


def test_accept_writes_a_new_revision_and_refuses_the_rest(tmp_path):
    path = tmp_path / "exports" / "golden" / "macro-array.json"
    design = variant()
    wrong = Finding("overlap", "fail", "E1", (), 1, 0, "E1 and E2 overlap")
    with pytest.raises(CheckFailure, match="checks failed"):
        accept(design, path, [wrong])
    assert not path.exists()
    accept(design, path, [])
    first = path.read_bytes()
    changed = dataclasses.replace(design, sheet=dataclasses.replace(design.sheet, thickness=2.9))
    with pytest.raises(CheckFailure, match="new revision letter"):
        accept(changed, path, [])
    assert path.read_bytes() == first
    accept(dataclasses.replace(changed, design=dataclasses.replace(design.design, revision=NEXT)), path, [])
    assert read_golden(path)["revision"] == NEXT
    assert [p.name for p in path.parent.iterdir()] == [path.name]


@pytest.mark.cad
@pytest.mark.slow  # all checks, three times
def test_commands_from_first_file_to_new_revision(tmp_path, capsys):
    """What a user does: golden, change, check fails, new letter, golden, check passes."""
    hardware = tmp_path / "hardware"
    hardware.mkdir()
    file, golden = hardware / "soft-tissue.toml", tmp_path / "exports" / "golden" / "soft-tissue.json"
    file.write_text(re.sub("(?m)^row_arms = .*$", "row_arms = [[5]]", without_rigs("soft-tissue")))
    assert main(["golden", str(file)]) == 0
    assert main(["check", str(file)]) == 0
    assert "golden:" not in capsys.readouterr().out

    text = file.read_text()
    file.write_text(text.replace("[[5]]", "[[6]]"))
    before = golden.read_bytes()
    assert main(["check", str(file)]) == 1
    out = capsys.readouterr().out
    assert "new revision letter" in out and "arm_mm: 5 -> 6" in out
    assert main(["golden", str(file)]) == 1
    assert golden.read_bytes() == before

    file.write_text(file.read_text().replace(f'revision = "{REVISION}"', f'revision = "{NEXT}"'))
    assert main(["golden", str(file)]) == 0
    assert f"changed revision: {REVISION} -> {NEXT}" in capsys.readouterr().out
    assert main(["check", str(file)]) == 0
    assert golden.read_bytes() != before
