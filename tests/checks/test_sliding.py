"""Places along a part that count as one situation have one verdict: against every pair on its own."""

from __future__ import annotations

import numpy as np
import pytest

from tactcad.checks.on_solids.interference import check_interference, stretch, zones
from tactcad.contour import Contour, Line, chain, circle, rectangle
from tactcad.parts.language.description import Extrusion, Hole, Material, ModelFile, Part, Pocket, Revolution
from tactcad.scenes.scene import Placement, Scene

STEEL = Material("steel", 7850.0)


def made(name: str, body, *features) -> Part:
    return Part(name, name, "milled", STEEL, body, features)


STEPPED = made(  # a bar along x that grows thicker, with a hole and a pocket
    "BAR",
    Extrusion(chain([(0, 0), (100, 0), (100, 8), (60, 8), (60, 5), (0, 5)]), 6.0),
    Hole("hole", (20, 2.5, 6), (0, 0, -1), 3, 6, True),
    Pocket("pocket", (40, 0, 6), (0, 0, -1), (1, 0, 0), rectangle(-3, -4, 3, -1), 2),
)
SHAFT = made("SHAFT", Revolution(chain([(0, 0), (3, 0), (3, 30), (2, 30), (2, 50), (0, 50)])))


def test_zones_by_hand():
    x, y, z = zones(STEPPED)
    assert x == ((0, 0), (18.5, 21.5), (37, 43), (60, 60), (100, 100))
    assert z == ((0, 6),)  # the hole goes all through
    assert y[0] == (0, 0) and y[-1] == (8, 8)
    _, _, along = zones(SHAFT)
    assert along == ((0, 0), (30, 30), (50, 50))
    assert zones(made("FILE", ModelFile("x.step", "", 1.0, ((0, 0, 0), (1, 1, 1))))) is None


def test_a_slope_and_an_arc_change_all_along():
    wedge = made(
        "W", Extrusion(Contour((Line((0, 0), (10, 0)), Line((10, 0), (0, 5)), Line((0, 5), (0, 0)))), 1.0)
    )
    assert zones(wedge)[0] == ((0, 10),)
    assert zones(made("D", Extrusion(circle((5, 0), 4), 1.0)))[0] == ((3, 7),)


@pytest.mark.parametrize(
    ("low", "high", "expected"),
    [
        (1, 2, 1),
        (-5, -1, 0),
        (5, 7, 2),
        (0.05, 2, None),
        (-1, 1, None),
        (2, 3.95, None),
        (4.5, 4.6, None),
        (11, 12, 3),
    ],
)
def test_stretch(low, high, expected):
    assert stretch(((0.0, 0.0), (4.0, 5.0 - 0.2), (10.0, 10.0)), low, high) == expected


@pytest.mark.cad
@pytest.mark.parametrize("bar", [STEPPED, SHAFT], ids=["bar", "shaft"])
@pytest.mark.parametrize("seed", range(3))
def test_many_places_along_a_part_against_each_alone(bar, seed):
    """Small cubes at random places and depths: clear, touching, inside, over hole, step and end."""
    from tactcad.solids.build import build

    random = np.random.default_rng(seed)
    cube = made("CUBE", Extrusion(rectangle(0, 0, 1.5, 1.5), 1.5))
    shapes = {part.part_no: build(part) for part in (bar, cube)}
    if bar is STEPPED:
        along = random.uniform(-3, 102, 60)
        others = random.choice([[1.0, 6.0], [1.0, 5.5], [5.0, 2.0], [5.05, 2.0], [8.0, 2.0], [1.0, 4.5]], 60)
        places = [(x, y, z) for x, (y, z) in zip(along, others)]
    else:
        along = random.uniform(-3, 52, 60)
        others = random.choice([[3.0, -0.75], [2.0, -0.75], [2.5, -0.5], [0.5, 0.5]], 60)
        places = [(x, y, z) for z, (x, y) in zip(along, others)]
    base = Placement("A", bar)
    pieces = [Placement(f"C{i}", cube, tuple(map(float, p))) for i, p in enumerate(places)]
    kinds = set()
    pairs = {}
    # only pairs with the bar are of interest: cubes stand in one another
    for finding in check_interference(Scene("all", (base, *pieces)), shapes):
        if finding.part == "A":
            pairs[finding.message.split(" and ")[1].split()[0]] = finding
    for piece in pieces:
        alone = check_interference(Scene("one", (base, piece)), shapes)
        shared = pairs.get(piece.designator)
        assert [f.check for f in alone] == ([shared.check] if shared else []), piece.origin
        if alone:
            kinds.add(alone[0].check)
            assert shared.value == pytest.approx(alone[0].value, abs=1e-9)
            reach = [abs(c - (o + 0.75)) <= 0.75 + 1e-6 for c, o in zip(shared.place, piece.origin)]
            assert all(reach), "the place named lies in the cube itself"
    assert kinds == {"overlap", "undeclared-touch"}
