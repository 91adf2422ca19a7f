"""Places along a part that count as one situation have one verdict: against every pair on its own."""

from __future__ import annotations

import numpy as np
import pytest

from tactcad.checks.on_solids.interference import Surroundings, check_interference
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


def seen(part: Part, *at: float) -> tuple | None:
    """What lies around a cube of 1 mm at a place."""
    return Surroundings(part).near(np.array([at, np.add(at, 1.0)]), np.array(at))


ALIKE = {  # places of the cube, and how far along an axis it sees the same
    "on the upper edge": ((4, 5, 2), (11, 5, 2)),
    "before the step, beyond the hole": ((22, 5, 2), (58.5, 5, 2)),
    "beyond the step": ((61, 8, 2), (98.5, 8, 2)),
    "inside, off all faces": ((4, 2, 2), (11, 3, 4)),
}


@pytest.mark.parametrize("name", ALIKE)
def test_places_alike(name):
    one, other = ALIKE[name]
    assert seen(STEPPED, *one) == seen(STEPPED, *other)


def test_places_that_differ():
    """In and off the material, by the ends, over hole, pocket and step, a micrometre higher or deeper."""
    edge = (4, 5, 2)
    others = [
        (4, 30, 2), (4, 2, 2), (0, 5, 2), (18, 3.5, 5), (30, 3.5, 5), (40, 3.5, 5), (60, 5, 2), (70, 7, 2),
        (4, 5.001, 2), (4, 5, 5.95), (4, 5, 6.0), (4, 5, 6.001), (4, 5, -0.5),
    ]  # fmt: skip
    told = [seen(STEPPED, *at) for at in (edge, *others)]
    assert len({*told}) == len(told)


def test_a_slope_an_arc_and_a_shaft():
    wedge = made(
        "W", Extrusion(Contour((Line((0, 0), (10, 0)), Line((10, 0), (0, 5)), Line((0, 5), (0, 0)))), 1.0)
    )
    assert seen(wedge, 4, 3, 0) != seen(wedge, 2, 4, 0)
    disc = made("D", Extrusion(circle((5, 0), 4), 1.0))
    assert seen(disc, 4, -0.5, 0) != seen(disc, 4.1, -0.5, 0)
    assert seen(SHAFT, 2, 0, 5) == seen(SHAFT, 2, 0, 25) != seen(SHAFT, 2, 0, 35) != seen(SHAFT, 2.1, 0, 35)
    assert seen(made("FILE", ModelFile("x.step", "", 1.0, ((0, 0, 0), (1, 1, 1)))), 0, 0, 0) is None


@pytest.mark.by_day(2, "a second each")
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
