"""Scene wiring: it goes together for boards of every kind, the leads' socket comes last and comes off again,
and the plates' holes are the board's."""

from __future__ import annotations

import re
from dataclasses import replace
from math import dist

import numpy as np
import pytest
from built import shapes_of
from variants import DROP, variant

from tactcad.checks.on_solids.interference import check_interference
from tactcad.checks.on_solids.steps import check_steps
from tactcad.checks.on_solids.tools import check_tools
from tactcad.circuit.board_layout import laid_out
from tactcad.drawing.guide import page
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.leads import boards
from tactcad.parts.rules import load
from tactcad.scenes import make_scene, scene_names
from tactcad.scenes.bom import bom_rows
from tactcad.scenes.moves import box, step_moves
from tactcad.scenes.scene import STILL, Move, Placement, Scene

KINDS = {
    "two rows": {},
    "one row": {"array.row_arms": [[6.0] * 3]},
    "three boards": {"array.row_arms": [[6.0] * 9, [5.0] * 3]},
    "a converter on the board": {"readout.converter": "AD7124-8"},
    "thick leads, far off": {"wiring.wire": "AWG30", "wiring.to_board": 2000.0},
}
CAP = "ISO4762-M3x"


@pytest.mark.cad
@pytest.mark.parametrize(
    # slow: one kind by day: all checks on solids
    "kind",
    [k if k == "one row" else pytest.param(k, marks=pytest.mark.slow) for k in sorted(KINDS)],
)
def test_it_goes_together(kind):
    scene = make_scene(variant(KINDS[kind]), "wiring")
    shapes = shapes_of(scene)
    for check in (check_interference, check_steps, check_tools):
        assert check(scene, shapes) == []


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_every_board_has_a_plate_of_its_own(kind):
    """Counted off the boards; a plate's threads and the board's holes, as routed, lie over each other."""
    design = variant(KINDS[kind])
    scene, n = make_scene(design, "wiring"), len(boards(Layout(design)))
    rows = {row.part_no: row.qty for row in bom_rows(scene, None, {})}
    own = {f"{design.name}-{part}": 1 for part in ("board-plate", "lead-clamp", "fitted-board")}
    own |= {
        "SOCKET-LEADS-26-strip": 1,
        "STAND-OFF-M3x10-6-bolt": 4,
        f"{CAP}6-A2-70-screw": 4,
        f"{CAP}12-A2-70-screw": 2,
    }
    extra = {row.part_no: row.qty for row in bom_rows(make_scene(design, "array"), None, {})}
    assert {part: rows[part] - extra.get(part, 0) for part in own} == {p: n * k for p, k in own.items()}
    plate = next(p.part for p in scene.placements if p.designator == "BH1")
    threads = sorted(f.at[:2] for f in plate.features if f.name == "stand_off")
    (routed, *_) = laid_out(Layout(design))
    corners = sorted((x, routed.height - y) for x, y, d in routed.holes if d > 3.0)
    assert np.allclose(threads, corners)


def plugged(scene: Scene) -> list[Move]:
    return [m for m in step_moves(scene)[-1] if m.designators[0].startswith("XS")]


def test_the_socket_comes_last_and_off_again():
    """In every last move of a socket it ends on its header, having been lifted off by more than the header's
    pins are long, 6 mm."""
    scene = make_scene(variant(), "wiring")
    moves = plugged(scene)
    assert len(step_moves(scene)[-1]) == len(moves) == 2 * 3
    for name in ("XS1", "XS2"):
        on, off, again = (m for m in moves if m.designators == (name,))
        assert on.path[-1] == off.start == again.path[-1] == STILL
        assert off.path[-1] == again.start and off.path[-1][2] > 6.0
    assert "supplies off" in scene.steps[-1].text


@pytest.mark.cad
def test_a_socket_that_cannot_be_lifted_is_found():
    """Pushed straight from its place before the board to the header it passes through the board's edge."""
    scene = make_scene(variant(), "wiring")
    (first, *_), last = plugged(scene), scene.steps[-1]
    low = replace(
        scene,
        steps=(*scene.steps[:-1], replace(last, order=(replace(first, path=(STILL,)), *last.order[1:]))),
    )
    said = [f.message for f in check_steps(low, shapes_of(low))]
    assert any("XS1" in s and "into A1" in s for s in said)


def ends(p: Placement, axis: int) -> tuple[float, float]:
    """Of a part's box along an axis, mm."""
    low, high = box(p)
    return low[axis], high[axis]


@pytest.mark.parametrize("name", ["calibration", "grasping"])
@pytest.mark.parametrize("rows", [5, 9])
def test_leads_reach_the_boards_on_the_bench(rows, name):
    """Read off the scenes: from the tie of every board's leads, wherever a pad is under the roller or the
    array is lifted, to the clamp and the socket of a board that lies as the guide says; and with plates a
    millimetre lower they would not, where these have to be raised."""
    design = variant({"array.row_arms": [[6.0] * rows] * 2})
    rig, wired = make_scene(design, name), make_scene(design, "wiring")
    (text,) = [s.text for s in rig.steps if s.title == "Boards on the bench"]
    block = float((re.findall(r"blocks (\d+) mm high", text) or [0])[0])
    off = float(re.findall(r"([\d.]+) mm off the ends", text)[0])
    there, here = ({p.designator: p for p in s.placements} for s in (rig, wired))
    base = there["BP1"]
    cx, cy = (sum(ends(there["CA1"], axis)) / 2 for axis in (0, 1))
    bench, last = ends(base, 2)[0], []
    up = design.grasping.lift if name == "grasping" else 0.0
    for board in boards(Layout(design)):
        n = board.number
        plate, clamp, socket = (here[f"{kind}{n}"] for kind in ("BH", "LC", "XS"))
        before = min(abs(v) for v in ends(plate, 0))
        held = [abs(sum(ends(clamp, 0)) / 2), sum(ends(clamp, 1)) / 2, ends(plate, 2)[1]]
        tails = [abs(sum(ends(socket, 0)) / 2), sum(ends(socket, 1)) / 2, ends(socket, 2)[1]]
        moved = [ends(base, 0)[1] + off - before, 0.0, bench + block]
        ways = []
        for pad in there.values() if name == "calibration" else [there["E1"]]:
            if pad.part.kind != "element":
                continue
            out = pad.part.extrusion.outer.named("pad_face")
            middle = (out.start[0] + out.end[0]) / 2
            x = pad.origin[0] + pad.rotation[0][0] * middle - cx
            y = sum(ends(pad, 1)) / 2 - cy
            at_roller = (x, y) if name == "calibration" else (0.0, 0.0)
            row = [there[p.designator] for p in board.places]
            rear = max(abs(v - cx) for v in ends(row[0], 0)) + design.wiring.gather - abs(at_roller[0])
            tied = (sum(ends(row[0], 1)) + sum(ends(row[-1], 1))) / 4 - cy
            away = abs(tied - held[1] * (1 if name == "calibration" else -1)) + abs(at_roller[1])
            face = there["E1"].origin[2] + there["E1"].rotation[2][1] * design.element.recess_depth + up
            ways.append(dist((rear, away, face), (held[0] + moved[0], 0.0, held[2] + moved[2])))
        last.append(max(ways) + dist(held, tails))
    assert max(last) <= design.wiring.to_board + 1e-6
    assert block == 0.0 or max(last) > design.wiring.to_board - 1.5
    assert (block > 0) == (rows == 9 and name == "calibration")


def test_every_step_that_moves_something_has_its_picture():
    design = load("macro-array")
    for name in scene_names(design):
        scene = make_scene(design, name)
        shown = re.findall(rf'src="{name}-(\d\d)\.svg"', page(design, scene).decode())
        assert [int(n) for n in shown] == [n for n, moves in enumerate(step_moves(scene), start=1) if moves]


def test_boards_of_a_row_stand_beside_their_elements():
    """As the step says: nearest to the first board of a row is the first of its elements."""
    design = variant(KINDS["three boards"])
    scene = make_scene(design, "wiring")
    assert "A1 beside E1 to A2 beside E9" in scene.steps[0].text
    at = {p.designator: sum(ends(p, 1)) / 2 for p in scene.placements}
    assert (at["A1"] - at["A2"]) * (at["E1"] - at["E9"]) > 0.0
    assert "A1 of board-8, A2 of board-1, A3 of board-3." in scene.steps[2].text
    assert "order of their elements" not in make_scene(variant(), "wiring").steps[0].text


def test_solder_is_ordered_once_whether_gauges_are_bonded_in_a_fixture_or_not():
    for changes in ({}, {"bonding": DROP}):
        design = variant(changes)
        lines = [s for n in scene_names(design) for s in make_scene(design, n).supplies]
        assert [s.qty for s in lines if s.part_no == "SOLDER"] == [1]


def test_leads_are_cut_and_bonded_before_they_are_pulled_at():
    """As long as the wiring plan's strain relief, whether there is a bonding fixture or not."""
    for name, changes in (("bonding", {}), ("array", {"bonding": DROP})):
        said = " ".join(s.text for s in make_scene(variant({**changes, "wiring.bonded": 3.7}), name).steps)
        assert "wiring list" in said and "over its last 3.7 mm" in said


@pytest.mark.parametrize("columns", [5, 12])
def test_only_an_array_with_that_scene_is_still_to_be_calibrated(columns):
    """The calibration's rig does not take 2 x 12: its scene is left out, and no guide speaks of it."""
    design = variant({"array.row_arms": [[6.0] * columns, [5.0] * columns]})
    names = scene_names(design)
    said = " ".join(s.text for n in ("array", "setting", "wiring") for s in make_scene(design, n).steps)
    assert ("calibrat" in said) == ("calibration" in names) == (columns == 5)
    (on_its_back,) = (s.text for s in make_scene(design, "wiring").steps if s.title == "Array on its back")
    assert ("still to be calibrated" in on_its_back) == (columns == 5)
