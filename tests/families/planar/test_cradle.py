"""The calibration of planar designs by weights: statics by hand, places read from STEP, links from DXF, moves
from the guide's JSON."""

from __future__ import annotations

import io
import json
import math
import re
from functools import cache
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from built import shape_of

from tactcad.design.load import parse
from tactcad.export.dxf import dxf_bytes
from tactcad.export.step_file import part_step
from tactcad.export.step_text import Header
from tactcad.families.planar import cell_cradle as cradle
from tactcad.families.planar.cell_calibration import calibrate
from tactcad.families.planar.cell_cradle import CradleLayout
from tactcad.families.planar.cell_layout import PlanarLayout
from tactcad.families.planar.cell_loads import OFF_AXIS, STEPS, loads, requirements
from tactcad.parts.rules import load
from tactcad.scenes import left_out, make_scene, scene_names
from tactcad.scenes.moves import guide_json
from tactcad.scenes.scene import Pose
from tactcad.stacks.virtual_build import sensor

DESIGNS = Path(__file__).parents[3] / "hardware"
DOWN = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, -1)}  # of the array's axes, by the scene's load


@cache
def layout(name: str) -> PlanarLayout:
    return PlanarLayout(load(str(DESIGNS / f"{name}-array.toml")))


@pytest.fixture(params=["planar", "jaw"])
def lay(request):
    return layout(request.param)


def centre(placement) -> np.ndarray:
    """Centre of mass of a placed part, by its own closed form."""
    return np.array(placement.rotation) @ np.array(placement.part.centre) + np.array(placement.origin)


@pytest.mark.parametrize("along", "zxy")
def test_what_hangs_pulls_along_its_axis_through_the_pad(lay, along):
    """Under the point that carries it lies the centre of mass of hanger or link; that point is on the pad's
    axis, and of a link in the pad's plane. So the moment about the island is that of a force on the pad."""
    for number in (1, len(lay.elements)):
        scene = make_scene(lay.design, f"calibration-{along}", Pose(element=number))
        at = {p.designator: p for p in scene.placements}
        array, e = at["AR1"], lay.elements[number - 1]
        turn = np.array(array.rotation) @ np.diag([1, -1, -1])  # the array lies with its pads in z = 0
        assert turn @ np.array(DOWN[along]) == pytest.approx([0, 0, -1])
        pad = np.array(array.origin) + turn @ np.array([e.x, e.y, 0.0])
        hung = centre(at["HA1" if along == "z" else "LI1"])
        assert hung[:2] == pytest.approx(pad[:2], abs=1e-9) and hung[2] < pad[2]
        assert np.array(at["CA1"].origin) == pytest.approx(pad, abs=1e-9)


def test_hanger_and_link_touch_their_cap_and_nothing_else(lay):
    """The nib's edge is as long as the sheet is thick: its ends touch a cone of 90 degrees where that is as
    wide, half of it above the cone's point. The link's edges touch flanks at 45 degrees likewise."""
    rig = CradleLayout(lay)
    nib = rig.tip - lay.pad_z
    point, mouth = 0.7, 0.5  # mm over the pad; radius
    assert nib - point == pytest.approx(0.5 / 2) and math.hypot(0.25, 0.0) < mouth
    assert rig.hung - rig.groove == pytest.approx(0.5 / 2) and rig.hung < rig.cap < rig.arc
    neighbour = lay.design.planar.pitch - lay.design.post.pad / 2
    assert rig.arc + 1.0 < neighbour  # leg
    assert lay.design.post.stand_out - 0.25 > 0.1  # over the cover


@pytest.mark.cad
def test_the_link_s_dxf_passes_every_post(lay):
    """Its window and outline as the shop gets them, hung on every cell: no other pad in the material."""
    part = cradle.link(CradleLayout(lay))
    drawing = ezdxf.read(io.StringIO(dxf_bytes(part).decode()))
    arcs = drawing.modelspace().query("ARC")
    inner, outer = sorted(a.dxf.radius for a in arcs if math.hypot(*a.dxf.center) < 1e-6)
    ys = [p[1] for e in drawing.modelspace().query("LINE") for p in (e.dxf.start, e.dxf.end)]
    rig, d = CradleLayout(lay), lay.design
    assert (inner, outer) == pytest.approx((rig.arc, rig.arc + 1.0), abs=1e-3)
    r, (hx, hy) = d.post.pad / 2, lay.half
    for e in lay.elements:
        for o in lay.elements:
            for off, along in ((abs(o.y - e.y), o.x - e.x), (abs(o.x - e.x), o.y - e.y)):
                if along > 0:
                    assert off + r < inner or off - r > outer
        assert -min(ys) - 5.0 - 1.0 > max(hx - e.x, hy - e.y)  # its lower end hangs beyond array and cradle


@pytest.mark.cad
def test_the_cradle_s_feet_are_square_in_its_step_file(lay):
    """Planes of the file's text: foot z and seat parallel, feet x and y at right angles to both."""
    part = cradle.cradle(CradleLayout(lay))
    text = part_step(part, shape_of(part), Header("cradle", "", "A", "2026-01-01", "", "")).decode()
    entity = dict(re.findall(r"#(\d+)\s*=\s*(.*?);", text, flags=re.S))
    normals = set()
    for line in entity.values():
        if plane := re.match(r"PLANE\s*\('.*?',#(\d+)\)", line):
            _, axis, _ = re.findall(r"#(\d+)", entity[plane[1]])
            x, y, z = re.search(r"\(\s*([-\d.eE+]+),([-\d.eE+]+),([-\d.eE+]+)\s*\)", entity[axis]).groups()
            normals.add(tuple(abs(round(float(v), 12)) for v in (x, y, z)))
    assert normals == {(1, 0, 0), (0, 1, 0), (0, 0, 1)}


def test_the_guide_s_moves_bring_everything_to_its_place(lay):
    for along in "zxy":
        scene = make_scene(lay.design, f"calibration-{along}")
        told = json.loads(guide_json(scene))
        titles = [step["title"] for step in told["steps"]]
        assert (
            titles[-3:] == ["Weights", "Every cell", "Readings"] and f"Cradle on its foot {along}" in titles
        )
        moved = {m["designator"]: m for step in told["steps"] for m in step["moves"]}
        assert set(moved) == {p.designator for p in scene.placements}
        for m in moved.values():
            assert m["path"][-1] == [0, 0, 0]
        last = moved["HA1" if along == "z" else "LI1"]
        assert last["path"][0][2] > 0 and last["path"][-1] == [0, 0, 0]  # let down at the end
        step = told["steps"][titles.index("Hanger" if along == "z" else "Link")]
        assert step["sets"] and step["leaves"]


@pytest.mark.parametrize("along", "zxy")
def test_cap_and_what_hangs_on_it_come_to_every_pad_in_the_guide_s_moves(lay, along):
    """From any first pad: the cap's stops, from its place in the scene, are the pads' middles, each once and
    the first one at last; hanger or link is off whenever the cap moves, and comes after it to its pad."""
    for first in (1, len(lay.elements)):
        scene = make_scene(lay.design, f"calibration-{along}", Pose(element=first))
        at = {p.designator: p for p in scene.placements}
        turn = np.array(at["AR1"].rotation) @ np.diag([1, -1, -1])
        pads = [np.array(at["AR1"].origin) + turn @ np.array([e.x, e.y, 0.0]) for e in lay.elements]
        steps = json.loads(guide_json(scene))["steps"]
        moves = next(s for s in steps if s["title"] == "Every cell")["moves"]
        stops, hung = [], np.zeros(3)
        for m in moves:
            if m["designator"] == "CA1":
                stops.append(np.array(at["CA1"].origin) + m["path"][-1])
                assert np.linalg.norm(hung - m["from"]) > 50.0
            else:
                hung = np.array(m["path"][-1])
                assert np.linalg.norm(hung) > 50.0 or hung == pytest.approx(stops[-1] - at["CA1"].origin)
        order = [*range(first, len(pads)), *range(first)]
        assert np.array(stops) == pytest.approx(np.array([pads[k] for k in order]), abs=1e-6)


def test_loads_stay_within_what_a_cell_bears(lay):
    """All steps on, no root yields by the cell's own stress, and no stop closes; weights by 9.80665 N/kg."""
    from tactcad.families.planar.cell import wrench

    rig = CradleLayout(lay)
    for along, force in (("z", (0.0, 0.0, -1.0)), ("x", (1.0, 0.0, 0.0))):
        for found in loads(rig, along):
            kind, weight = lay.kinds[found.kind], found.most
            hung = cradle.cap(rig).mass + (cradle.hanger(rig) if along == "z" else cradle.link(rig)).mass
            assert weight == pytest.approx((hung + STEPS * found.step) * 9.80665e-3)
            wrenched = weight * wrench(np.array(force), lay.pad_height)
            assert kind.cell.stress(wrenched) < lay.design.material.yield_strength
            motion = kind.cell.compliance @ wrenched
            assert -motion[2] < kind.table.stop_gap and abs(motion[4]) * kind.reach < lay.design.housing.lift
            assert found.step >= 0.5  # g: four steps of the 0.1 % that class M1 errs by, or less


def test_angles_by_hand(lay):
    """Zones over lengths: feet over the cradle's 25 mm, pins over their distance, a level of 0.2 mm/m."""
    known: dict = {}
    wanted = {r.name: r for r in requirements(lay, known)}
    assert all(v.stated or "table" in n or "dimple" in n for n, v in known.items())
    rig = CradleLayout(lay)
    x0, y0, x1, y1 = rig.box
    side, apart = min(x1 - x0, y1 - y0), rig.pins[1][0] - rig.pins[0][0]
    by_hand = {
        "calibration: load along z": 0.2 + 10 / side,
        "calibration: load across, out of the pads' plane": 0.2 + 10 / 25,
        "calibration: load across, in the pads' plane": 0.2 + 10 / side + 2 * 10 / apart,
    }
    worst = {name: v.upper[np.newaxis] for name, v in known.items()}
    for name, value in by_hand.items():
        found = wanted[name].value(type("Made", (), {"made": worst}))
        assert found.max() == pytest.approx(value) and value < OFF_AXIS


@pytest.mark.parametrize(
    "old, new, why",
    [
        ("stand_out = 1.0", "stand_out = 0.3", "cap_fits_pads"),
        ("pad = 2.4", "pad = 7.0", "cap_fits_pads"),
        ("rows = 6", "rows = 12", "cradle_holds_array"),
        ("border = 5.0", "border = 5.0\nside = 30.0", "cradle_holds_array"),
        ("rows = 6\ncolumns = 6", "rows = 1\ncolumns = 1", "cradle_holds_array"),
        ("force = 0.8", "force = 0.02", "cells_bear_hangers"),
    ],
)
def test_designs_that_the_rig_does_not_take_lose_its_scenes_with_a_reason(old, new, why):
    text = (DESIGNS / "planar-array.toml").read_text("utf-8")
    assert old in text
    changed = parse(text.replace(old, new), "changed.toml")
    assert not [name for name in scene_names(changed) if "calibration" in name]
    said = [str(left) for left in left_out(changed) if "calibration" in str(left)]
    assert len(said) == 3 and all(f"rule {why}: " in s for s in said)


def test_a_single_cell_is_calibrated_too():
    text = (DESIGNS / "planar-array.toml").read_text("utf-8")
    one = (
        text.replace("rows = 6", "rows = 1")
        .replace("columns = 6", "columns = 1")
        .replace("buses = 3", "buses = 1")
    )
    (said, *_) = [str(left) for left in left_out(parse(one, "one.toml"))]
    assert "do not hold the array square" in said
    border = re.search(r"at least (\S+) mm", said)[1]
    design = parse(one.replace("border = 5.0", f"border = {border}"), "one.toml")
    (line,) = sensor(design).stack("calibration: load across, in the pads' plane")
    assert 0.7 * OFF_AXIS < line.worst_high <= OFF_AXIS
    assert scene_names(design) == ("array", "bonding", "calibration-z", "calibration-x", "calibration-y")
    assert {p.designator for p in make_scene(design, "calibration-x").placements} >= {"CR1", "CA1", "LI1"}


def test_a_table_of_these_loads_gives_the_matrix_back(lay, tmp_path):
    """Readings as the guide asks for them, from a field that is exactly a matrix times the load."""
    from tactcad.families.planar.sensor import chip_matrix

    rig, rows, m = CradleLayout(lay), ["element,run,fx,fy,fz,bx,by,bz"], {}
    for e in lay.elements[:2]:
        m[e.number] = chip_matrix(lay, e.kind) @ np.diag([1.0, 1.0, -1.0])
        for k, along in enumerate("xyz"):
            found = next(x for x in loads(rig, "z" if along == "z" else "x") if x.kind == e.kind.name)
            for run in (1, 2):
                for g in [0.0] + [found.tare + n * found.step * 9.80665e-3 for n in range(STEPS + 1)]:
                    force = np.eye(3)[k] * g * 1e-2  # small: the design's own bend is nothing
                    field = m[e.number] @ force
                    rows.append(",".join(f"{v:.12g}" for v in (e.number, 10 * k + run, *force, *field)))
    path = tmp_path / "readings.csv"
    path.write_text("\n".join(rows) + "\n")
    for cell in calibrate(lay, path, 0.95):
        assert cell.matrix == pytest.approx(m[cell.element], rel=1e-2, abs=1e-2)
