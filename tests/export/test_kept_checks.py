"""Checks that ran before are not run again, and nothing else is taken for them."""

from __future__ import annotations

from dataclasses import replace

import pytest
from variants import TINY_TEXT

from tactcad.checks import run
from tactcad.checks.check_report import as_record
from tactcad.checks.shop import DEFAULT
from tactcad.design.load import parse
from tactcad.export.cache import Cache
from tactcad.export.kept_checks import checked

pytestmark = pytest.mark.cad


@pytest.fixture
def kept(tmp_path, monkeypatch):
    """A cache that holds the array's report, that report, and how many runs there were since."""
    design, cache, runs = parse(TINY_TEXT, "tiny"), Cache(tmp_path / "cache"), []
    first = checked(design, ["array"], cache)
    monkeypatch.setattr(run, "run_checks", lambda *args: runs.append(args) or first)
    return design, cache, first, runs


def test_the_same_report_without_a_run(kept):
    design, cache, first, runs = kept
    owned = replace(design, design=replace(design.design, organisation="A lab", contact="a@lab.example"))
    again = checked(owned, ["array"], cache)
    assert not runs and again == first and as_record(again) == as_record(first)
    assert first.findings and first.deflections and first.size


def test_anything_else_is_checked(kept, tmp_path, monkeypatch):
    design, cache, first, runs = kept
    shop = tmp_path / "shop.toml"
    shop.write_text(DEFAULT.read_text("utf-8").replace("wall = 0.5\n", "wall = 0.4\n", 1), "utf-8")
    assert shop.read_text("utf-8") != DEFAULT.read_text("utf-8")
    thicker = replace(design, element=replace(design.element, hinge_thickness=0.26))
    for n, (one, names, more) in enumerate(
        (
            (thicker, ["array"], {}),
            (design, ["array"], {"shop_file": shop}),
            (design, ["array"], {"strict": True}),
            (design, [], {}),
            (design, ["array"], {"anew": True}),
        ),
        start=1,
    ):
        checked(one, names, cache, **more)
        assert len(runs) == n
    monkeypatch.setattr("tactcad.export.kept_checks.source_digest", lambda room: f"{room} of tomorrow")
    checked(design, ["array"], cache)
    assert len(runs) == 6
