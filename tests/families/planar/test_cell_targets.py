"""`tactcad design` of planar targets: half-widths against simulated readings, the design against every rule,
what is answered and refused."""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from tactcad.cli.main import main
from tactcad.families.planar import cell_targets
from tactcad.families.planar.cell_layout import PlanarLayout
from tactcad.families.planar.cell_targets import (
    CellChoice,
    CellFound,
    CellMeans,
    CellRead,
    evaluated,
    half_width,
    of_kind,
    read_target,
)
from tactcad.parts.rules import load

TARGET = Path(__file__).parents[3] / "hardware" / "targets" / "jaw-array.toml"
TEXT = TARGET.read_text("utf-8").replace("foils = [0.04, 0.05]", "foils = [0.04]")


@pytest.fixture(autouse=True)
def few(monkeypatch):
    """Arrays enough to see that nearly all keep the half-width."""
    monkeypatch.setattr(cell_targets, "ARRAYS", 30)


@pytest.fixture(scope="module")
def file(tmp_path_factory) -> Path:
    """One foil, which takes a third of a second."""
    path = tmp_path_factory.mktemp("target") / "one.toml"
    path.write_text(TEXT)
    return path


@cache
def answer(path: Path) -> cell_targets.CellAnswer:
    return cell_targets.search(read_target(path))


@pytest.mark.parametrize("k", [0.7, 3.0, 12.0])
def test_half_widths_are_those_of_simulated_readings(k):
    """Springs in series, pressed alike; forces drawn with their noise, matrices with their errors, and K_obj
    solved for: 95 % of the answers lie within the half-width."""
    soft, stiff = CellRead(1.3, 0.1, 2e-4), CellRead(9.0, 0.3, 1e-3)
    means = CellMeans(force=0.3, pitch=(4.0, 4.0), length=28.0, width=10.0, readings=4, matrices=0.004)
    rng, series = np.random.default_rng(5), [1 / c.stiffness + 1 / k for c in (soft, stiff)]
    way = min(c.rated * s for c, s in zip((soft, stiff), series))
    felt = [
        way / s * (1 + 0.004 * rng.standard_normal(20000)) + c.noise / 2 * rng.standard_normal(20000)
        for c, s in zip((soft, stiff), series)
    ]
    q = felt[0] / felt[1]  # (1/stiff + x) = q (1/soft + x)
    found = (1 - q) / (q / soft.stiffness - 1 / stiff.stiffness)
    width = half_width(soft, stiff, means, np.array([k]))[0]
    assert np.mean(np.abs(found / k - 1) < width) == pytest.approx(0.95, abs=0.01)


def test_kinds_alike_tell_nothing():
    one = CellRead(2.0, 0.1, 1e-4)
    means = CellMeans(force=0.3, pitch=(4.0, 4.0), length=28.0, width=10.0)
    assert np.isinf(half_width(one, one, means, np.array([1.0]))).all()


def test_the_answer_is_a_design_that_loads_and_reads_as_said(file, tmp_path, capsys):
    """Read back from its file, where every rule is tried."""
    assert main(["design", str(file), "--out", str(tmp_path / "jaw"), "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert json.loads((tmp_path / "jaw" / "report.json").read_text()) == said
    layout = PlanarLayout(load(str(tmp_path / "jaw" / "design.toml")))
    soft, stiff = (of_kind(layout, name) for name in ("measuring", "reference"))
    k = np.array([at["object"] for at in said["object_interval"]])
    width = half_width(soft, stiff, CellMeans(0.3, (3.6, 4.0), 28.0, 10.0), k)
    assert width.max() == pytest.approx(said["half_width"]) and said["half_width"] < said["wanted_half_width"]
    assert [at["high"] - at["low"] for at in said["object_interval"]] == pytest.approx(list(2 * width * k))
    assert said["met"] is True and said["yield"] >= 0.95 and said["yield_interval"][0] < said["yield"]
    assert sum(s["share"] for s in said["shares"]) == pytest.approx(1.0)
    assert [b["field"] for b in said["binding"]][0] == "planar.matrices"
    x, y = layout.half
    assert 2 * x <= 28.0 + 1e-9 and 2 * y <= 10.0 + 1e-9 and len(layout.elements) == 12


def test_no_design_drawn_by_chance_near_it_is_better(file):
    """By noise alone, which every dimension changes."""
    t = read_target(file)
    t = replace(t, planar=replace(t.planar, matrices=0.0))
    best = cell_targets.search(t).best
    assert best
    rng, tried = np.random.default_rng(2), 0
    for _ in range(40):
        values = {name: round(v * rng.uniform(0.97, 1.06), 3) for name, v in asdict(best.choice).items()}
        values |= {"foil": best.choice.foil, "pitch": min(max(values["pitch"], 3.6), 4.0)}
        found = evaluated(t, CellChoice(**values))
        if isinstance(found, CellFound):
            tried += 1
            assert found.half_width > 0.97 * best.half_width, values
    assert tried > 5


def test_a_target_that_cannot_be_met_writes_nothing_but_on_demand(file, tmp_path, capsys, monkeypatch):
    known = answer(file)
    monkeypatch.setattr(cell_targets, "search", lambda t: replace(known, target=t))
    monkeypatch.setattr(cell_targets, "binding", lambda *_: [])
    path = tmp_path / "hard.toml"
    path.write_text(TEXT.replace("half_width = 5.0", "half_width = 0.5"))
    assert main(["design", str(path), "--out", str(tmp_path / "out")]) == 1
    assert capsys.readouterr().out.startswith("Impossible as asked, the best there is: a pair feels")
    assert not (tmp_path / "out").exists()
    assert main(["design", str(path), "--out", str(tmp_path / "out"), "--best"]) == 1
    assert (tmp_path / "out" / "design.toml").exists()


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("length = 28.0           # mm along x\nwidth = 10.0", "length = 6.0\nwidth = 5.0"),
        ("pitch = [3.6, 4.0]", "pitch = [1.0, 1.2]"),
    ],
)
def test_room_for_no_pair_is_impossible(old, new, tmp_path, capsys):
    path = tmp_path / "small.toml"
    assert old in TEXT
    path.write_text(TEXT.replace(old, new))
    assert main(["design", str(path), "--out", str(tmp_path / "out"), "--best"]) == 1
    assert "no design keeps every rule" in capsys.readouterr().out and not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("stiffness = [1.0, 5.0]", "stiffness = [5.0, 1.0]", "object.stiffness: its first value is above"),
        ("force = 0.3", "force = -1", "planar.force: out of range"),
        ("shear = 0.05", "sheer = 0.05", "planar.sheer: unknown field"),
        ('base = "jaw-array"', 'base = "macro-array"', "target.base: not a planar design"),
        ("[object]", "[objects]", "objects: unknown"),
        ("foils = [0.04]", "foils = [4.0]", "planar.foils"),
    ],
)
def test_bad_targets_are_refused_in_one_line(old, new, said, tmp_path, capsys):
    path = tmp_path / "bad.toml"
    assert old in TEXT
    path.write_text(TEXT.replace(old, new, 1))
    assert main(["design", str(path), "--out", str(tmp_path / "out")]) == 2
    told = capsys.readouterr().err
    assert told.startswith(f"tactcad: {said}") and told.count("\n") == 1
    assert not (tmp_path / "out").exists()
