"""Scenes made of blocks and pins, each wrong in one way, and the shipped array with one thing moved."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations, product
from math import pi

import numpy as np
import pytest
from built import shape_of, shapes_of

from tactcad.checks.on_solids import interference
from tactcad.checks.on_solids.interference import TOUCH_MM, check_interference, near_pairs, relative
from tactcad.contour import chain, circle, rectangle
from tactcad.parts.language.description import Extrusion, Hole, Material, Part, Revolution
from tactcad.parts.language.finding import Finding
from tactcad.scenes.scene import UPRIGHT, Contact, Placement, Scene

pytestmark = pytest.mark.cad

STEEL = Material("steel", 7850.0)
TURNED = ((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))  # a quarter turn about z


def block(name: str, x: float, y: float, z: float, *holes: Hole) -> Part:
    return Part(name, name, "milled", STEEL, Extrusion(rectangle(0, 0, x, y), z), holes)


def pin(name: str, d: float, length: float) -> Part:
    return Part(name, name, "turned", STEEL, Extrusion(circle((0, 0), d), length))


CUBE = block("CUBE", 10, 10, 10)
BORED = block("BORED", 10, 10, 10, Hole("bore", (5, 5, 0), (0, 0, 1), 4.0, 10, True))
TAPPED = block(
    "TAPPED", 10, 10, 10, Hole("tap", (5, 5, 0), (0, 0, 1), 3.3, 10, True, thread="M4", thread_depth=10)
)
PIN = pin("PIN", 4.0, 20.0)
STEP = chain([(0, -3), (0.7, -3), (0.7, 0), (1.1, 0), (1.1, 6), (0, 6)])
STEPPED = Part("STEPPED", "STEPPED", "turned", STEEL, Revolution(STEP))


def found(placements, contacts=()) -> list[Finding]:
    scene = Scene("test", tuple(placements), tuple(contacts))
    return check_interference(scene, shapes_of(scene))


def checks(placements, contacts=()) -> list[tuple[str, str]]:
    return [(f.check, f.part) for f in found(placements, contacts)]


def two(first: Part, second: Part, origin, rotation=UPRIGHT, kind: str = "") -> list[tuple[str, str]]:
    return [(f.check, f.part) for f in findings_of(first, second, origin, rotation, kind)]


def findings_of(first: Part, second: Part, origin, rotation=UPRIGHT, kind: str = "") -> list[Finding]:
    placements = [Placement("A", first), Placement("B", second, origin, rotation)]
    return found(placements, [Contact("A", "B", kind)] if kind else [])


CASES = {
    "apart": (two, (CUBE, CUBE, (10.1, 0, 0)), []),
    "apart by ten times what counts as touching": (two, (CUBE, CUBE, (10 + 10 * TOUCH_MM, 0, 0)), []),
    "boxes meet at a corner only": (two, (pin("P", 4, 5), CUBE, (1.5, 1.5, 0)), []),
    "faces touch, not declared": (two, (CUBE, CUBE, (10, 3, 2)), [("undeclared-touch", "A")]),
    "faces touch, declared": (two, (CUBE, CUBE, (10, 3, 2), UPRIGHT, "touch"), []),
    "edges touch, not declared": (two, (CUBE, CUBE, (10, 10, 0)), [("undeclared-touch", "A")]),
    "corners touch, not declared": (two, (CUBE, CUBE, (10, 10, 10)), [("undeclared-touch", "A")]),
    "overlap": (two, (CUBE, CUBE, (9.9, 3, 2)), [("overlap", "A")]),
    "overlap of a thousandth": (two, (CUBE, CUBE, (9.999, 3, 2)), [("overlap", "A")]),
    "overlap, although touch is declared": (
        two,
        (CUBE, CUBE, (9.999, 3, 2), UPRIGHT, "touch"),
        [("overlap", "A")],
    ),
    "overlap, although press is declared": (
        two,
        (CUBE, CUBE, (9.9, 3, 2), UPRIGHT, "press"),
        [("overlap", "A")],
    ),
    "one inside the other": (two, (CUBE, block("SMALL", 2, 2, 2), (4, 4, 4)), [("overlap", "A")]),
    "the same place": (two, (CUBE, CUBE, (0, 0, 0)), [("overlap", "A")]),
    "declared, but apart": (two, (CUBE, CUBE, (10.1, 0, 0), UPRIGHT, "touch"), [("contact", "A")]),
    "thread declared, but apart": (
        two,
        (TAPPED, pin("ROD", 3.2, 20), (5, 5, -5), UPRIGHT, "thread"),
        [("contact", "A")],
    ),
    "declared, far apart": (two, (CUBE, CUBE, (1000, 0, 0), UPRIGHT, "press"), [("contact", "A")]),
    "pin in its own size, declared": (two, (BORED, PIN, (5, 5, -5), UPRIGHT, "press"), []),
    "pin in its own size, not declared": (two, (BORED, PIN, (5, 5, -5)), [("undeclared-touch", "A")]),
    "loose pin": (two, (BORED, pin("LOOSE", 3.9, 20), (5, 5, -5)), []),
    "pin too thick": (two, (BORED, pin("THICK", 4.01, 20), (5, 5, -5), UPRIGHT, "press"), [("overlap", "A")]),
    "screw in its thread, declared": (two, (TAPPED, PIN, (5, 5, -5), UPRIGHT, "thread"), []),
    "screw in its thread, not declared": (two, (TAPPED, PIN, (5, 5, -5)), [("overlap", "A")]),
    "a turned part whose box would not meet": (
        two,
        (CUBE, block("BAR", 30, 1, 1), (5, -20, 5), TURNED),
        [("overlap", "A")],
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_two_parts(name):
    call, arguments, expected = CASES[name]
    assert call(*arguments) == expected


def tapped(depth: float, full: float, counterbore: tuple[float, float] | None = None) -> Part:
    hole = Hole(
        "tap", (5, 5, 0), (0, 0, 1), 3.3, depth, depth == 10, counterbore, thread="M4", thread_depth=full
    )
    return block("TAPPED", 10, 10, 10, hole)


THREADS = {
    "as far as the full thread": (tapped(10, 6), PIN, (5, 5, -14), []),
    "beyond the full thread": (tapped(10, 6), PIN, (5, 5, -13.9), [("thread", "A")]),
    "into the floor of a blind hole": (tapped(8, 8), PIN, (5, 5, -11), [("thread", "A")]),
    "a thicker screw": (tapped(10, 10), pin("M5", 5.0, 20), (5, 5, -5), [("thread", "A")]),
    "beside the hole's axis": (tapped(10, 10), PIN, (5.01, 5, -5), [("thread", "A")]),
    "in no tapped hole": (CUBE, PIN, (5, 5, -5), [("thread", "A")]),
    "in a hole that is not tapped": (
        block("DRILLED", 10, 10, 10, Hole("d", (5, 5, 0), (0, 0, 1), 3.3, 10, True)),
        PIN,
        (5, 5, -5),
        [("thread", "A")],
    ),
    "in the clearance over a thread": (tapped(10, 5, (4.5, 5)), PIN, (5, 5, -10.1), []),
}


@pytest.mark.parametrize("name", THREADS)
def test_a_thread_explains_its_own_ring_and_no_more(name):
    first, second, origin, expected = THREADS[name]
    placements = [Placement("A", first), Placement("B", second, origin)]
    contact = [Contact("A", "B", "thread")]
    assert checks(placements, contact) == expected
    # and the other way round: the screw is declared first
    turned = [Placement("A", second, origin), Placement("B", first)]
    assert checks(turned, contact) == expected


def test_where_and_how_much_stands_in_the_finding():
    scene = Scene("test", (Placement("A", CUBE), Placement("B", CUBE, (9.0, 4.0, 0.0))))
    (finding,) = check_interference(scene, {"CUBE": shape_of(CUBE)})
    assert finding.value == pytest.approx(1 * 6 * 10)
    assert finding.place == pytest.approx((9.5, 7.0, 5.0))
    assert "A (CUBE)" in finding.message and "B (CUBE)" in finding.message and finding.severity == "fail"


def test_every_bad_pair_of_many_is_reported():
    """A row of touching cubes, one contact not declared, and one cube standing in another row."""
    row = [Placement(f"C{i}", CUBE, (10.0 * i, 0, 0)) for i in range(6)]
    contacts = [Contact(f"C{i}", f"C{i + 1}", "touch") for i in range(5) if i != 2]
    assert checks(row, contacts) == [("undeclared-touch", "C2")]
    odd = Placement("X", BORED, (25.0, 5.0, 0.0))
    found = checks([*row, odd], contacts)
    assert sorted(found) == [("overlap", "C2"), ("overlap", "C3"), ("undeclared-touch", "C2")]


def test_a_verdict_is_not_carried_to_another_situation():
    """Pairs of the same parts, alike but for the last micrometre or a turn, get their own verdicts."""
    placements = [
        Placement("A1", CUBE),
        Placement("B1", CUBE, (10.001, 0, 0)),
        Placement("A2", CUBE, (0, 100, 0)),
        Placement("B2", CUBE, (9.999, 100, 0)),
        Placement("A3", CUBE, (0, 200, 0)),
        Placement("B3", CUBE, (10.001, 200, 0), TURNED),
    ]
    # B3, turned about its own corner, lies across x 0.001 to 10.001
    assert checks(placements) == [("overlap", "A2"), ("overlap", "A3")]


def test_relative_places_are_the_same_wherever_a_pair_stands():
    first, second = Placement("A", CUBE, (1.0, 2.0, 3.0)), Placement("B", CUBE, (4.0, 6.0, 3.0), TURNED)
    turn = np.array(TURNED)

    def moved(p: Placement) -> Placement:
        origin = tuple(turn @ np.array(p.origin) + [7.0, -5.0, 0.25])
        return replace(p, origin=origin, rotation=tuple(map(tuple, turn @ np.array(p.rotation))))

    assert relative(moved(first), moved(second)) == relative(first, second)
    assert relative(second, first) != relative(first, second)


@pytest.mark.parametrize("seed", range(20))
def test_near_pairs_against_brute_force(seed):
    random = np.random.default_rng(seed)
    n = int(random.integers(2, 60))
    low = random.integers(0, 12, (n, 3)).astype(float)  # whole numbers: many boxes touch exactly
    size = random.integers(0, 5, (n, 3)).astype(float)
    boxes = np.stack([low, low + size], axis=1)
    brute = [
        (i, j)
        for i, j in combinations(range(n), 2)
        if all(boxes[i, 0, k] <= boxes[j, 1, k] and boxes[j, 0, k] <= boxes[i, 1, k] for k in range(3))
    ]
    assert list(near_pairs(boxes)) == brute


def test_boxes_that_are_a_hair_apart_still_meet():
    boxes = np.array(
        [[[0, 0, 0], [1, 1, 1]], [[1 + 1e-7, 0, 0], [2, 1, 1]], [[2.001, 0, 0], [3, 1, 1]]], float
    )
    assert list(near_pairs(boxes)) == [(0, 1)]


def sheet(columns: int, rows: int, *odd: tuple[float, float]) -> Part:
    """A sheet with a grid of slots and holes, pitch 8 mm; slots and holes at `odd` places are 0.2 wider."""
    middles = [(8.0 * i, 8.0 * j) for i, j in product(range(columns), range(rows))]
    wide = {at: 0.2 if at in odd else 0.0 for at in middles}
    slots = tuple(rectangle(x - 3, y - 1 - w, x - 1, y + 1 + w) for (x, y), w in wide.items())
    holes = tuple(Hole("h", (x + 1, y, 0), (0, 0, 1), 2.0 + w, 1.0, True) for (x, y), w in wide.items())
    outer = rectangle(-4, -4, 8 * columns - 4, 8 * rows - 4)
    return Part("SHEET", "SHEET", "milled", STEEL, Extrusion(outer, 1.0, slots), holes)


@pytest.mark.by_day(2, "a second each")
@pytest.mark.parametrize("seed", range(6))
def test_pairs_alike_have_the_verdict_that_each_has_alone(seed):
    random = np.random.default_rng(seed)
    parts = [block("BIT", 1.7, 2, 0.5), pin("ROUND", 1.8, 3.0), STEPPED]
    base = Placement("S", sheet(4, 3, (8.0, 8.0)))
    placed = []
    for n in range(30):
        x, y, turned = 8.0 * random.integers(0, 4), 8.0 * random.integers(0, 3), random.random() < 0.3
        dx, dz = random.choice([-3.0, -2.85, 1.0, 1.0, 1.1]), random.choice([-0.5, 0.0, 0.2, 1.0])
        at = (float(x + dx), float(y + random.choice([-1.0, 0.0, 0.0, 0.1])), float(dz))
        placed.append(Placement(f"P{n}", parts[n % 3], at, TURNED if turned else UPRIGHT))
    placed += [Placement(f"CLEAR{n}", parts[1], (8.0 * n + 1, 0.0, -1.0)) for n in range(3)]
    together = [f for f in found([base, *placed]) if "S (SHEET)" in f.message]
    alone = [f for p in placed for f in found([base, p])]
    assert [(f.check, f.message.split(" overlap")[0]) for f in together] == [
        (f.check, f.message.split(" overlap")[0]) for f in alone
    ]
    assert [f.value for f in together] == pytest.approx([f.value for f in alone], rel=1e-6, abs=1e-9)
    assert len({f.check for f in alone}) == 2 and len(alone) < len(placed)
    assert all(abs(p - q) < 10.0 for f, g in zip(together, alone) for p, q in zip(f.place, g.place)), (
        "in the same opening"
    )


def test_a_larger_grid_asks_the_kernel_no_more(monkeypatch):
    def asked(columns: int, rows: int) -> int:
        calls = []
        real = interference.meeting
        monkeypatch.setattr(interference, "meeting", lambda *a: calls.append(a) or real(*a))
        places = product(range(columns), range(rows))
        pins = [Placement(f"P{i} {j}", PIN, (8.0 * i + 5, 8.0 * j, -1.0)) for i, j in places]
        found([Placement("S", sheet(columns + 1, rows)), *pins])
        return len(calls)

    assert asked(2, 2) == asked(5, 4) < 4


# --- the shipped array ---


def test_the_shipped_array_is_clean(macro_scene, macro_shapes):
    assert check_interference(macro_scene, macro_shapes) == []


def changed(scene: Scene, designator: str, **changes) -> Scene:
    placements = tuple(replace(p, **changes) if p.designator == designator else p for p in scene.placements)
    return replace(scene, placements=placements)


def shifted(scene: Scene, designator: str, dx: float, dy: float, dz: float) -> Scene:
    (x, y, z) = next(p.origin for p in scene.placements if p.designator == designator)
    return changed(scene, designator, origin=(x + dx, y + dy, z + dz))


@pytest.mark.by_day(4, "half a second each")
@pytest.mark.parametrize(
    ("designator", "move", "found"),
    [
        ("E3", (0, 0.01, 0), "overlap"),  # into its spacer
        ("ST1", (0, 0, 0.01), "contact"),  # off the ledges
        ("ST1", (0, 0, -0.01), "overlap"),  # into them
        ("SS1", (0, 0, 0.01), "contact"),  # a set screw that does not press
        ("DW1", (0.02, 0, 0), "overlap"),  # a dowel beside its press fit
        ("SC1", (0.3, 0, 0), "overlap"),  # a screw through the rim of its clearance holes
        ("CA1", (0, 0, -0.5), "overlap"),
        ("E1", (-20, 0, 0), "overlap"),  # an arm in the opposite row
    ],
)
def test_one_part_of_the_array_out_of_place_is_seen(macro_scene, macro_shapes, designator, move, found):
    findings = check_interference(shifted(macro_scene, designator, *move), macro_shapes)
    assert found in {f.check for f in findings}
    assert all(designator in f.message or f.part == designator for f in findings)


def test_every_declared_contact_of_the_array_is_needed(macro_scene, macro_shapes):
    """Without contacts each declared pair is reported, and nothing else."""
    findings = check_interference(replace(macro_scene, contacts=()), macro_shapes)
    reported = [tuple(w.strip("()") for w in f.message.split()[0:4:3]) for f in findings]
    declared = {frozenset((c.first, c.second)) for c in macro_scene.contacts}
    assert len(reported) == len(declared)
    kinds = {c.kind for c in macro_scene.contacts}
    assert kinds == {"thread", "press", "touch"}
    threads = sum(c.kind == "thread" for c in macro_scene.contacts)
    assert sum(f.check == "overlap" for f in findings) == threads


def test_threads_overlap_by_what_their_screws_cut(macro_scene, macro_shapes):
    """M3 in its 2.5 mm tap drill: pi/4 (3^2 - 2.5^2) for each mm engaged."""
    findings = check_interference(replace(macro_scene, contacts=()), macro_shapes)
    ring = pi / 4 * (3.0**2 - 2.5**2)
    clamping = [f for f in findings if f.check == "overlap" and "EP2" in f.message and "M3x30" in f.message]
    head_plate = next(p.part for p in macro_scene.placements if p.designator == "EP1")
    counterbored = next(f for f in head_plate.features if f.counterbore)
    engaged = 30 - 21 - (8 - counterbored.counterbore[1])  # length less stack less plate under the head
    assert 4.5 <= engaged < 8, "at least 1.5 d, and not through the plate"
    assert [f.value for f in clamping] == pytest.approx([ring * engaged] * 4, rel=1e-9)
