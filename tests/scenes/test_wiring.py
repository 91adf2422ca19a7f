"""Scene wiring: it goes together for boards of every kind, the leads' socket comes last and comes off again,
and the plates' holes are the board's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from built import shapes_of
from variants import variant

from tactcad.checks.on_solids.interference import check_interference
from tactcad.checks.on_solids.steps import check_steps
from tactcad.checks.on_solids.tools import check_tools
from tactcad.circuit.boards import laid_out
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.leads import boards
from tactcad.scenes import make_scene
from tactcad.scenes.bom import bom_rows
from tactcad.scenes.moves import step_moves
from tactcad.scenes.scene import STILL, Move, Scene

KINDS = {
    "two rows": {},
    "one row": {"array.row_arms": [[6.0] * 3]},
    "three boards": {"array.row_arms": [[6.0] * 9, [5.0] * 3]},
    "thick leads, far off": {"wiring.wire": "AWG30", "wiring.to_board": 2000.0},
}
CAP = "ISO4762-M3x"


@pytest.mark.cad
@pytest.mark.parametrize(
    "kind", [k if k == "one row" else pytest.param(k, marks=pytest.mark.slow) for k in sorted(KINDS)]
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
    rows = {row.part_no: row.qty for row in bom_rows(scene, "A", {})}
    own = {f"{design.name}-{part}": 1 for part in ("board-plate", "lead-clamp", "fitted-board")}
    own |= {
        "SOCKET-LEADS-26-strip": 1,
        "STAND-OFF-M3x10-6-bolt": 4,
        f"{CAP}6-A2-70-screw": 4,
        f"{CAP}12-A2-70-screw": 2,
    }
    extra = {row.part_no: row.qty for row in bom_rows(make_scene(design, "array"), "A", {})}
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
