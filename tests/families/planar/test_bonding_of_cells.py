"""The bonding jig of planar designs: places read from STEP, order and moves from the guide's JSON, the
stack's row by hand."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from built import shape_of

from tactcad.design.load import parse
from tactcad.export.step_file import part_step
from tactcad.export.step_text import Header
from tactcad.families.planar import cell_bonding as bonding
from tactcad.families.planar import parts
from tactcad.families.planar.cell_array import limits
from tactcad.families.planar.cell_layout import PlanarLayout
from tactcad.parts.rules import load
from tactcad.scenes import left_out, make_scene, scene_names
from tactcad.scenes.moves import guide_json

DESIGNS = Path(__file__).parents[3] / "hardware"
NUMBER = r"\s*([-\d.eE+]+)\s*"


@cache
def layout(name: str) -> PlanarLayout:
    return PlanarLayout(load(str(DESIGNS / f"{name}-array.toml")))


@pytest.fixture(params=["planar", "jaw"])
def lay(request):
    return layout(request.param)


def axes(part) -> dict[float, set]:
    """Of the STEP file's cylinders: x and y of their axes by radius."""
    text = part_step(part, shape_of(part), Header("jig", "", "A", "2026-01-01", "", "")).decode()
    entity = dict(re.findall(r"#(\d+)\s*=\s*(.*?);", text, flags=re.S))
    found: dict[float, set] = {}
    for line in entity.values():
        if cylinder := re.match(rf"CYLINDRICAL_SURFACE\s*\('.*?',#(\d+),{NUMBER}\)", line):
            point = re.findall(r"#(\d+)", entity[cylinder[1]])[0]
            x, y, _ = re.search(rf"\({NUMBER},{NUMBER},{NUMBER}\)", entity[point]).groups()
            found.setdefault(round(float(cylinder[2]), 6), set()).add(
                (round(float(x), 6), round(float(y), 6))
            )
    return found


@pytest.mark.cad
def test_bores_are_at_the_cells_and_at_the_pitch(lay):
    p, m = lay.design.planar, lay.design.magnet
    grid = {
        (round((i - (p.columns - 1) / 2) * p.pitch, 6), round((j - (p.rows - 1) / 2) * p.pitch, 6))
        for i in range(p.columns)
        for j in range(p.rows)
    }
    bed, guide = axes(bonding.bed(lay)), axes(bonding.guide(lay))
    (magnets, push), (pin,) = (
        sorted((r for r, at in bed.items() if at == grid), reverse=True),
        [r for r, at in bed.items() if at != grid],
    )
    assert 0.02 < 2 * magnets - m.diameter < 0.04 and push < m.diameter / 2
    ((r, at),) = guide.items()
    assert at == grid and 0 < 2 * r - lay.design.post.pad < 0.1
    (hx, hy) = lay.half  # pins touch the foil's edges within 0.01 mm, and do not cut into it
    low = sorted(bed[pin])
    assert len(low) == 3 and sorted(y for _, y in low)[:2] == pytest.approx([-hy - pin] * 2, abs=0.011)
    assert low[0][0] == pytest.approx(-hx - pin, abs=0.011) and low[0][1] == 0


def test_the_guide_tells_the_order_and_brings_everything_to_its_place(lay):
    scene = make_scene(lay.design, "bonding")
    told = json.loads(guide_json(scene))
    titles = [step["title"] for step in told["steps"]]
    order = ["Bed", "Magnets", "Foil", "Foot plates", "Posts", "Guide and weight", "Cure", "Out of the jig"]
    assert [t for t in titles if t in order] == order
    moved = {m["designator"]: m for step in told["steps"] for m in step["moves"]}
    assert set(moved) == {p.designator for p in scene.placements} | {"AID1"}
    off = {m["designator"] for m in told["steps"][-1]["moves"]}
    assert told["steps"][-1]["apart"] and {"AID1", "BG1", "SP1", "F1", "M1"} <= off
    moved = {m["designator"]: m for step in told["steps"][:-1] for m in step["moves"]}
    assert all(m["path"][-1] == [0, 0, 0] for m in moved.values())
    (beside, there) = moved["F1"]["path"]  # lowered beside the pins, then pushed against them
    assert min(beside[:2]) > 0 and beside[2] == 0 == max(there)
    foil = told["steps"][titles.index("Foil")]
    assert any("DP1 DP2 DP3" in s for s in foil["sets"]) and foil["leaves"]
    assert "mark down" in scene.steps[titles.index("Magnets")].text  # how polarity is checked
    n = len(lay.elements)
    assert f"{10 * n} g" in scene.steps[titles.index("Guide and weight")].text
    assert {s.part_no for s in scene.supplies} == {"ADHESIVE-epoxy", "RELEASE-wax"}


def test_a_finished_foil_is_that_of_the_array(lay):
    """Foil, foot plates and posts have one place in both scenes; magnets but for their adhesive."""
    jig, array = (
        {p.designator: p for p in make_scene(lay.design, s).placements} for s in ("bonding", "array")
    )
    same = [f"{k}{e.number}" for e in lay.elements for k in ("FP", "P", "M")] + ["F1"]
    for name in same:
        film = [0, 0, -0.03 if name[0] == "M" else 0]
        assert np.subtract(jig[name].origin, array[name].origin) == pytest.approx(film, abs=1e-9)


def test_the_magnets_row_by_hand(lay):
    """Play of the least magnet in the largest bore, half zones of bed, pins and foil, the foil's cut edge."""
    d = lay.design
    known, wanted = limits(lay, [make_scene(d, "bonding")])
    worst = {name: v.upper[np.newaxis] for name, v in known.items()}
    made = type("Made", (), {"made": worst})
    zone = {g.features[0]: g.zone for p in (bonding.bed(lay), parts.foil(lay)) for g in p.geometric}
    low, high = map(
        float, re.search(r"counterbores (\S+) to (\S+) wide", " ".join(bonding.bed(lay).notes)).groups()
    )
    smallest, largest = (d.magnet.diameter + s * 0.02 for s in (-1, 1))
    assert low > largest
    off = (high - smallest + zone["magnet"] + zone["pin_hole"] + zone["spigot"]) / 2 + lay.process.tolerance(
        d.planar.thickness
    )
    rows = {r.name: r for r in wanted}
    for axis in "xy":
        row = rows[f"bonding: magnets along {axis}"]
        assert row.value(made).max() == pytest.approx(off, abs=1e-4) and off < row.upper
    # a post at its opening's edge turns the magnet about the foil's middle; a well is off its place too
    t = d.planar.thickness
    tilt = d.housing.side_gap * (t / 2 + d.magnet.height) / (lay.pad_z - d.post.stand_out - t / 2)
    base = parts.base(lay)
    bored = next(c for c in base.characteristics if c.name.startswith("well "))
    place = off + next(g.zone for g in base.geometric if g.name.startswith("well ")) / 2
    well = d.housing.well + (bored.upper - bored.nominal) / 2 - tilt - np.hypot(place, place)
    assert rows["magnets clear of their wells"].value(made).min() == pytest.approx(well, abs=2e-4)
    # a part of the scenes is judged by the jig too, if it takes the design; else by the design's own number
    alone = limits(lay, [make_scene(d, "array")])[0]
    assert alone.keys() == known.keys()
    bare, _ = limits(PlanarLayout(replace(d, post=replace(d.post, pad=7.2))), [])
    assert bare["magnet's place along x"].upper.max() == d.tolerance.magnet_place


@pytest.mark.parametrize(
    "old, new, field",
    [
        ('title = "', 'title = "A ', None),
        ("[housing]", "[magnet]\ndiameter = 0.7\nheight = 0.5\n[housing]", "magnet.diameter"),
        ("pad = 2.4", "pad = 7.2", "post.pad"),
    ],
)
def test_designs_that_the_jig_does_not_take_lose_its_scene_with_a_reason(old, new, field):
    text = (DESIGNS / "planar-array.toml").read_text("utf-8")
    assert old in text
    changed = parse(text.replace(old, new), "changed.toml")
    said = [str(left) for left in left_out(changed) if "jig_takes_magnets" in str(left)]
    assert ("bonding" in scene_names(changed)) is (field is None)
    assert [field in s for s in said] == ([True] if field else [])


def test_a_single_cell_is_bonded_too():
    text = (DESIGNS / "planar-array.toml").read_text("utf-8")
    for old, new in (("rows = 6", "rows = 1"), ("columns = 6", "columns = 1"), ("buses = 3", "buses = 1")):
        text = text.replace(old, new)
    scene = make_scene(parse(text, "one.toml"), "bonding")
    assert {p.designator for p in scene.placements} >= {"BJ1", "F1", "M1", "FP1", "P1", "BG1"}
