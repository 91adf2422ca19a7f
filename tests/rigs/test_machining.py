"""Each machining rule is seen to fail on a part made bad for it, and to be silent on one made just right."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tactcad.checks.described.machining import check_machining
from tactcad.checks.shop import load_shop
from tactcad.contour import Corner, chain, circle, rectangle, rounded_polygon
from tactcad.design.load import names
from tactcad.parts.language.description import Extrusion, Hole, Material, Part, Pocket, Revolution
from tactcad.parts.rules import load
from tactcad.scenes import make_scene, scene_names

USUAL = load_shop().machining
UP, DOWN, X = (0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (1.0, 0.0, 0.0)
BLOCK = Extrusion(rectangle(0, 0, 40, 30), 20)


def part(*features, body=BLOCK, process="milled") -> Part:
    return Part("bad", "bad part", process, Material("6061-T6", 2700), body, tuple(features))


def rounded(r: float):
    return rounded_polygon([Corner(p, r) for p in ((10, 10), (30, 10), (30, 20), (10, 20))])


def pocket(contour, depth: float, *island) -> Pocket:
    return Pocket("pocket", (0, 0, 20), DOWN, X, contour, depth, island)


def hole(at=(20, 15, 20), axis=DOWN, d=3.0, depth=10.0, through=False, **more) -> Hole:
    return Hole("hole", at, axis, d, depth, through, **more)


def notch(r: float):
    corners = [(0, 0), (40, 0), (40, 30), (25, 30), (25, 20), (15, 20), (15, 30), (0, 30)]
    return Extrusion(rounded_polygon([Corner(p, r if p[1] == 20 else 0.0) for p in corners]), 8)


# rule -> (bad part, the same just mended)
CASES = {
    "mill-corner": [
        (part(pocket(rectangle(10, 10, 30, 20), 4)), part(pocket(rounded(0.5), 4))),  # sharp
        (
            part(pocket(rounded(1.2), 10)),
            part(pocket(rounded(1.25), 10)),
        ),  # 2.5 mm cutter is 4 diameters deep
        (part(body=notch(0.0)), part(body=notch(1.0))),  # outline
        (
            part(body=Extrusion(rectangle(0, 0, 40, 30), 8, (rectangle(10, 10, 30, 20),))),
            part(body=Extrusion(rectangle(0, 0, 40, 30), 8, (rounded(1.0),))),
        ),
    ],
    "mill-groove": [
        (
            part(pocket(circle((20, 15), 10), 1, circle((20, 15), 8.2))),
            part(pocket(circle((20, 15), 10), 1, circle((20, 15), 8))),
        ),
        (
            part(pocket(circle((20, 15), 10), 6, circle((20, 15), 7.2))),
            part(pocket(circle((20, 15), 10), 6, circle((20, 15), 7))),
        ),
    ],
    "mill-floor": [(part(pocket(rounded(4), 19.3)), part(pocket(rounded(4), 19.2)))],
    "drill-diameter": [(part(hole(d=0.4, depth=2)), part(hole(d=0.5, depth=2)))],
    "drill-depth": [
        (part(hole(d=1.0, depth=10.1)), part(hole(d=1.0, depth=10.0))),
        (
            part(hole(d=1.0, depth=14, counterbore=(2.0, 3.9))),
            part(hole(d=1.0, depth=14, counterbore=(2.0, 4.0))),
        ),
    ],
    "drill-floor": [
        (part(hole(depth=19.3)), part(hole(depth=19.2))),
        (part(hole(depth=19.0, drill_point=True)), part(hole(depth=18.2, drill_point=True))),
    ],
    "counterbore": [
        (
            part(hole(depth=20, through=True, counterbore=(6.0, 19.3))),
            part(hole(depth=20, through=True, counterbore=(6.0, 19.2))),
        ),
        (part(hole(depth=10, counterbore=(6.0, 10.0))), part(hole(depth=10, counterbore=(6.0, 9.0)))),
    ],
    "thread-depth": [
        (
            part(hole(d=2.5, depth=12, thread="M3", thread_depth=9.1)),
            part(hole(d=2.5, depth=12, thread="M3", thread_depth=9.0)),
        )
    ],
    "tap-reach": [  # an M2 tap's shank of 2.8 mm stops at a bore of 2.4 and enters one of 2.9
        (
            part(hole(d=1.6, depth=10, counterbore=(2.4, 4.0), thread="M2", thread_depth=5)),
            part(hole(d=1.6, depth=10, counterbore=(2.9, 4.0), thread="M2", thread_depth=5)),
        ),
        (
            part(hole(d=1.6, depth=10, counterbore=(2.4, 3.1), thread="M2", thread_depth=5)),
            part(hole(d=1.6, depth=10, counterbore=(2.4, 3.0), thread="M2", thread_depth=5)),
        ),
    ],
    "thread-run-out": [
        (
            part(hole(d=2.5, depth=8.9, thread="M3", thread_depth=8)),
            part(hole(d=2.5, depth=9, thread="M3", thread_depth=8)),
        )
    ],
    "hole-wall": [
        (part(hole(at=(2.2, 15, 20))), part(hole(at=(2.3, 15, 20)))),
        (part(hole(at=(0, 15, 2.2), axis=X)), part(hole(at=(0, 15, 2.3), axis=X))),
        (
            part(hole(at=(3.7, 15, 20), counterbore=(6.0, 3.0))),
            part(hole(at=(3.8, 15, 20), counterbore=(6.0, 3.0))),
        ),
        (part(hole(at=(-3.0, 15, 20))), part(hole(at=(3.0, 15, 20)))),  # outside altogether
    ],
    "hole-web": [
        (part(hole(), hole(at=(23.7, 15, 20))), part(hole(), hole(at=(23.8, 15, 20)))),
        # crossing bores at right angles
        (
            part(hole(), hole(at=(0, 18.7, 15), axis=X, depth=30)),
            part(hole(), hole(at=(0, 18.8, 15), axis=X, depth=30)),
        ),
    ],
    "turn-slender": [
        (
            part(body=Extrusion(circle((0, 0), 5), 61), process="turned"),
            part(body=Extrusion(circle((0, 0), 5), 60), process="turned"),
        ),
        (
            part(body=Revolution(chain([(0, 0), (2.5, 0), (2.5, 61), (0, 61)])), process="turned"),
            part(body=Revolution(chain([(0, 0), (2.5, 0), (2.5, 60), (0, 60)])), process="turned"),
        ),
    ],
    "turn-wall": [
        (
            part(body=Extrusion(circle((0, 0), 5.5), 1, (circle((0, 0), 5),)), process="turned"),
            part(body=Extrusion(circle((0, 0), 5.6), 1, (circle((0, 0), 5),)), process="turned"),
        )
    ],
}


@pytest.mark.parametrize(
    ("rule", "bad", "mended"), [(rule, *case) for rule, cases in CASES.items() for case in cases]
)
def test_a_bad_part_is_seen_and_its_mended_twin_passes(rule, bad, mended):
    found = check_machining(bad, USUAL)
    assert rule in {f.check for f in found}
    assert all(f.part == "bad" and f.message for f in found)
    assert rule not in {f.check for f in check_machining(mended, USUAL)}


def test_thin_webs_are_for_the_quotation_and_broken_ones_fail():
    for some in (
        (part(hole(), hole(at=(20 + d, 15, 20))) for d in (3.5, 3.49)),
        (part(hole(at=(x, 15, 20))) for x in (2.0, 1.99)),
    ):
        thin, broken = (check_machining(one, USUAL) for one in some)
        assert [f.severity for f in thin] == ["flag"]
        assert [f.severity for f in broken] == ["fail"]


@pytest.mark.parametrize("depth", [10.0, 1.0])
def test_webs_of_flat_blind_holes_are_those_of_deep_ones(depth):
    """Two holes of 6 mm, 6.3 mm apart; the flat one is shallower than its radius, both are."""
    for other in (depth, 1.0):
        found = check_machining(
            part(hole(d=6.0, depth=depth), hole(at=(26.3, 15, 20), d=6.0, depth=other)), USUAL
        )
        assert {f.message.split(" mm")[0] for f in found if f.check == "hole-web"} == {"0.3"}


def test_bought_and_wire_cut_parts_are_not_looked_at():
    bad = part(hole(d=0.1))
    assert (
        check_machining(replace(bad, process="bought"), USUAL)
        == check_machining(replace(bad, process="wire-cut"), USUAL)
        == []
    )


def test_a_workshop_may_have_other_limits():
    fine = replace(USUAL, drill=0.2)
    assert check_machining(part(hole(d=0.3, depth=2)), fine) == []


@pytest.mark.parametrize("name", names())
def test_every_part_of_the_shipped_designs_can_be_made(name):
    design = load(name)
    parts = {p.part_no: p for scene in scene_names(design) for p in make_scene(design, scene).parts}
    assert [str(f) for p in parts.values() for f in check_machining(p, USUAL)] == []
