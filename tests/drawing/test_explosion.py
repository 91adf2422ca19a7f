"""Exploded sub-assemblies: nothing overlaps, screws come out on the side of their heads, distances worked out
by hand."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from sound_designs import as_table, sound_table
from variants import variant

from tactcad.contour import rectangle
from tactcad.design.load import from_table
from tactcad.drawing.assemblies.apart import Piece, pieces_of, pulled_apart
from tactcad.drawing.assemblies.exploded import unit_views
from tactcad.drawing.engine.boxes import projected_box
from tactcad.parts.bought.screws import cap_screw
from tactcad.parts.language.description import Extrusion, Part
from tactcad.parts.language.stock import STAINLESS
from tactcad.scenes import make_scene, scene_names
from tactcad.scenes.scene import ALONG_Y, DOWN, Contact, Placement, Scene

GAP = 5.0


def block(name: str, x: float, y: float, z: float) -> Part:
    return Part(name, name, "milled", STAINLESS, Extrusion(rectangle(-x / 2, -y / 2, x / 2, y / 2), z))


def shifts(scene: Scene, placements=None) -> dict[str, tuple[float, ...]]:
    pieces = pieces_of(scene, placements or scene.placements)
    moved = pulled_apart(scene, pieces, GAP, {})
    return {
        p.designator: tuple(b - a for a, b in zip(p.origin, q.origin))
        for piece, there in zip(pieces, moved)
        for p, q in zip(piece.placements, there.placements)
    }


def test_a_lid_and_its_screws_by_hand():
    """Lid 2 thick on a plate 10 thick, M3x8 through it: the lid rises by the gap, the screw's tip from z = 4
    to gap over the lid's top, 12 + 5 + 5; a block at the front face comes forward by the gap, its own screw's
    tip to gap before it."""
    scene = Scene(
        "test",
        (
            Placement("PL", block("PLATE", 20, 20, 10)),
            Placement("LI", block("LID", 20, 20, 2), (0, 0, 10)),
            Placement("S1", cap_screw("M3", 8.0), (5, 5, 12), DOWN),
            Placement("S2", cap_screw("M3", 8.0), (-5, 5, 12), DOWN),
            Placement("FR", block("FRONT", 8, 4, 8), (0, -12, 1)),
            Placement("S3", cap_screw("M4", 8.0), (0, -14, 5), ALONG_Y),
        ),
        (
            Contact("PL", "LI", "touch"),
            Contact("S1", "LI", "touch"),
            Contact("S1", "PL", "thread"),
            Contact("S2", "LI", "touch"),
            Contact("S2", "PL", "thread"),
            Contact("PL", "FR", "touch"),
            Contact("S3", "FR", "touch"),
            Contact("S3", "PL", "thread"),
        ),
    )
    assert shifts(scene) == {
        "PL": (0, 0, 0),
        "LI": (0, 0, GAP),
        "S1": (0, 0, 12 + 2 * GAP - 4),
        "S2": (0, 0, 12 + 2 * GAP - 4),
        "FR": (0, -GAP, 0),
        "S3": (0, pytest.approx(-14 - 2 * GAP + 14 - 8), 0),
    }


def test_equal_parts_on_each_other_stay_together_and_clear_of_the_pin_through_them():
    disc = block("DISC", 30, 30, 5)
    scene = Scene(
        "test",
        (
            Placement("PL", block("PLATE", 40, 40, 10)),
            Placement("PN", block("PIN", 4, 4, 60), (0, 0, 10)),
            *(Placement(f"D{n}", disc, (0, 0, 10.0 + 5 * n)) for n in range(3)),
        ),
        (
            Contact("PL", "PN", "touch"),
            Contact("PL", "D0", "touch"),
            Contact("D0", "D1", "touch"),
            Contact("D1", "D2", "touch"),
        ),
    )
    way = shifts(scene)
    assert way["PN"] == (0, 0, GAP)
    assert way["D0"] == way["D1"] == way["D2"] == (0, 0, 60 + 2 * GAP)  # over the pin's upper end


def test_what_was_asked_to_come_farther_does_and_what_hangs_on_it_follows():
    scene = Scene(
        "test",
        (
            Placement("A", block("A", 20, 20, 10)),
            Placement("B", block("B", 10, 10, 5), (0, 0, 10)),
            Placement("C", block("C", 8, 8, 2), (0, 0, 15)),
        ),
        (Contact("A", "B", "touch"), Contact("B", "C", "touch")),
    )
    moved = pulled_apart(scene, [Piece((p,)) for p in scene.placements], GAP, {1: 40.0})
    assert [piece.placements[0].origin[2] for piece in moved] == [0.0, 10.0 + 40.0, 15.0 + 80.0]


@pytest.mark.by_day(3, "a rig each")
@pytest.mark.parametrize("seed", [None, *range(6)])
def test_sub_assemblies_of_rigs_come_apart(seed):
    """Of the macro array and of drawn designs that keep every rule."""
    design = (
        variant() if seed is None else from_table(as_table(sound_table(seed, (1, 2, 3, 5, 8, 13), rigs=True)))
    )
    for name in scene_names(design):
        if name in ("array", "setting", "wiring", "bonding"):  # which are one unit
            continue
        scene = make_scene(design, name)
        views = unit_views(scene)
        inside = [p.designator for view in views[1:] for piece in view.pieces for p in piece.placements]
        assert sorted(inside) == sorted(p.designator for p in scene.placements)  # every part in one unit
        on = {c.first: c.second for c in scene.contacts if c.kind == "touch" and c.first.startswith("RS")}
        for view in views:
            if not view.pieces:
                continue
            gap = 12 * GAP if all(piece.letter for piece in view.pieces) else GAP
            moved = pulled_apart(scene, view.pieces, gap, {})
            at = {
                p.designator: (np.array(p.origin), i)
                for i, piece in enumerate(moved)
                for p in piece.placements
            }
            before = {p.designator: p for p in scene.placements}
            way = {d: here - np.array(before[d].origin) for d, (here, _) in at.items()}
            for piece in view.pieces:
                assert len({tuple(np.round(way[p.designator], 6)) for p in piece.placements}) == 1
            for screw, under in on.items():
                if screw in at and under in at and at[screw][1] != at[under][1]:
                    outwards = -np.array(
                        [row[2] for row in before[screw].rotation]
                    )  # a cap screw's local z is where it points
                    apart = way[screw] - way[under]
                    assert (
                        apart @ outwards > GAP
                        and np.linalg.norm(apart - (apart @ outwards) * outwards) < 1e-6
                    ), screw
            if {"BP1", "CT1"} <= set(at):  # wheels stand on the plate
                assert way["CT1"][2] - way["BP1"][2] >= GAP
            boxes = [np.array([_box(p) for p in piece.placements]) for piece in moved]
            for a, b in combinations(boxes, 2):
                low = np.maximum(a[:, None, 0], b[None, :, 0])
                high = np.minimum(a[:, None, 1], b[None, :, 1])
                assert not (high - low > 0.05).all(axis=2).any(), (name, view.title)


def _box(p: Placement) -> np.ndarray:
    """From the points of the part's surface, seen from above and from the front."""
    x0, y0, x1, y1 = projected_box([p], (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    _, z0, _, z1 = projected_box([p], (1.0, 0.0, 0.0), (0.0, -1.0, 0.0))
    return np.array([[x0, y0, z0], [x1, y1, z1]])
