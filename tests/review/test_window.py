"""The review of FreeCAD's tree fails where the tree is not the bill's, and its settings are those that the
guide names."""

from __future__ import annotations

import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

ROOT = Path(__file__).parents[2]
sys.path.append(str(ROOT / "packaging" / "review"))

import review  # noqa: E402
import screen  # noqa: E402
import window  # noqa: E402

BILL = [
    {"part_no": "d-spacer", "has_solid": True, "designators": "SP1 SP2"},
    {"part_no": "d-plate", "has_solid": True, "designators": "EP1"},
    {"part_no": "GLUE", "has_solid": False, "designators": ""},
]
GREY = [0.5, 0.5, 0.5]


def tree(**changes) -> dict:
    parts = {"SP1": "d-spacer", "SP2": "d-spacer001", "EP1": "d-plate"} | changes
    return {"groups": 1, "children": [{"label": d, "part": p, "colour": GREY} for d, p in parts.items() if p]}


def test_a_tree_as_the_bill_has_it():
    assert window.tree_faults("x", tree(), BILL) == []


@pytest.mark.parametrize(
    ("bad", "said"),
    [
        (None, "ended without a report"),
        ({"groups": 0, "children": []}, "0 assemblies"),
        (tree(SP2=""), "SP2 is not in FreeCAD's tree"),
        (tree(XX="d-plate"), "the bill of materials has not"),
        (tree(EP1="d-spacer"), "EP1 shows d-spacer instead of d-plate"),
        ({"groups": 1, "children": tree()["children"] * 2}, "stands twice"),
        (
            {"groups": 1, "children": [c | {"colour": window.UNCOLOURED} for c in tree()["children"]]},
            "has no colour",
        ),
    ],
)
def test_another_tree_is_seen(bad, said):
    assert any(said in fault for fault in window.tree_faults("x", bad, BILL))


def test_the_guide_names_the_settings_and_their_values():
    guide = (ROOT / "docs" / "freecad.md").read_text(encoding="utf-8")
    for label, (_, _, on) in window.SETTINGS.items():
        assert f"| *{label}* | {'on' if on else 'off'} |" in guide


def test_the_profile_holds_them():
    found = {e.get("Name"): e.get("Value") for e in ElementTree.fromstring(window.settings()).iter("FCBool")}
    assert found == {name: str(int(on)) for _, name, on in window.SETTINGS.values()}


def test_a_scene_without_model_or_bill_is_seen():
    def manifest(*paths: str) -> dict:
        kinds = {"step": "step-assembly", "json": "bom", "csv": "bom"}
        return {"design": "d", "files": [{"path": p, "kind": kinds[p.rpartition(".")[2]]} for p in paths]}

    whole = (
        "step/d-array_A.step",
        "bom.json",
        "bom.csv",
        "step/d-sample-stiffness_A.step",
        "bom-sample-stiffness.json",
    )
    assert review.scene_faults(manifest(*whole)) == []
    for n in (0, 3, 4):
        assert review.scene_faults(manifest(*whole[:n], *whole[n + 1 :]))


@pytest.mark.parametrize(("drawn", "faults"), [(0, 1), (20, 1), (40, 0)])
def test_a_window_that_shows_nothing_fails(tmp_path, monkeypatch, drawn, faults):
    """A stand-in for the screen's program puts its two pictures there: 100 x 100, some rows of them drawn."""
    import numpy as np
    from PIL import Image

    empty = np.full((100, 100, 3), 200, np.uint8)
    full = empty.copy()
    full[:, : drawn // 10] = 90  # so many in a hundred
    for name, picture in (("empty", empty), ("full", full)):
        Image.fromarray(picture).save(tmp_path / f"{name}.png")
    stand_in = tmp_path / "xvfb-run"
    stand_in.write_text(
        f'#!/bin/sh\ncp {tmp_path}/full.png "$REVIEW_FULL"; cp {tmp_path}/empty.png "$REVIEW_EMPTY"\n'
    )
    stand_in.chmod(0o755)
    monkeypatch.setattr(screen, "command", lambda: str(stand_in))
    found = screen.screen_faults("freecad", tmp_path / "d.FCStd", tmp_path / "kept.png")
    assert len(found) == faults and (tmp_path / "kept.png").is_file()


def test_no_picture_is_a_fault(tmp_path, monkeypatch):
    monkeypatch.setattr(screen, "command", lambda: "/bin/true")
    found = screen.screen_faults("freecad", tmp_path / "d.FCStd", tmp_path / "kept.png")
    assert "no picture" in found[0]
