"""Whether a prism passes through itself, told in its plane: against the kernel, and against all pairs."""

from __future__ import annotations

import numpy as np
import pytest

from tactcad.contour import Arc, Contour, Corner, Line, chain, circle, rectangle, rounded_polygon
from tactcad.contour.inside import keep_clear, self_intersections
from tactcad.parts.language.description import Extrusion, Hole, Material, Part

CLEAR = 1e-6


def random_chains(number: int):
    """Polygons of a few random corners, half of them star-shaped and so simple; some with rounded corners."""
    rng = np.random.default_rng(5)
    for n in range(number):
        corners = rng.integers(0, 40, (rng.integers(4, 9), 2)) / 4.0
        if n % 2:
            off = corners - corners.mean(axis=0)
            corners = corners[np.argsort(np.arctan2(off[:, 1], off[:, 0]), kind="stable")]
        points = [tuple(map(float, p)) for p in corners]
        if len(set(points)) == len(points):
            yield points


def test_clear_is_what_no_pair_of_pieces_contradicts():
    answers = []
    for points in random_chains(300):
        contour = chain(points)
        folded = any(_back(points, i) for i in range(len(points)))
        answers.append(keep_clear(list(contour), CLEAR))
        assert answers[-1] == (not self_intersections(contour) and not folded), points
    assert 60 < sum(answers) < len(answers) - 60


def _back(points, i: int) -> bool:
    """Whether the chain turns back on itself in a corner."""
    a, b, c = (np.array(points[(i + k) % len(points)]) for k in (-1, 0, 1))
    u, v = a - b, c - b
    return bool(abs(u[0] * v[1] - u[1] * v[0]) < 1e-9 and u @ v > 0)


@pytest.mark.parametrize(
    "apart, clear", [(0.5, True), (2e-6, True), (5e-7, False), (0.0, False), (-0.1, False)]
)
def test_two_round_openings_that_come_near(apart, clear):
    pieces = [*circle((0.0, 0.0), 2.0), *circle((2.0 + apart, 0.0), 2.0)]
    assert keep_clear(pieces, CLEAR) is clear


def test_rounded_corners_touch_their_neighbours_only():
    corners = [
        Corner((0.0, 0.0), 0.3),
        Corner((4.0, 0.0), 0.1),
        Corner((4.0, 3.0), 1.0),
        Corner((0.0, 3.0), 0.0),
    ]
    assert keep_clear(list(rounded_polygon(corners)), CLEAR)


def test_neighbours_that_meet_again():
    """A line from an arc's end is inside it or beside it; one that ends on or beyond it crosses it."""
    half = Arc((1.0, 0.0), (-1.0, 0.0), (0.0, 0.0), True)
    for end, clear in (((0.5, 0.2), True), ((1.0, -0.5), True), ((0.6, 0.8), False), ((1.5, 0.6), False)):
        assert keep_clear([half, Line((-1.0, 0.0), end)], CLEAR) is clear, end


def prism(*contours: Contour):
    """As the kernel moves a face, sound or not."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
    from OCP.gp import gp_Pln, gp_Vec

    from tactcad.solids.build import wire

    maker = BRepBuilderAPI_MakeFace(gp_Pln(), wire(contours[0]), True)
    for opening in contours[1:]:
        maker.Add(wire(opening.reversed()))
    return BRepPrimAPI_MakePrism(maker.Face(), gp_Vec(0, 0, 0.5)).Shape()


SQUARE = rectangle(-10, -10, 10, 10)
BOW_TIE = chain([(0, 0), (4, 3), (4, 0), (0, 3)])
WAIST = chain([(0, 0), (4, 0), (4, 3), (2, 0), (0, 3)])  # a corner on an edge


@pytest.mark.cad
@pytest.mark.parametrize(
    "contours, faulty",
    [
        ((SQUARE,), False),
        ((SQUARE, circle((0, 0), 3), rectangle(3, 3, 5, 5)), False),
        ((BOW_TIE,), True),
        ((WAIST,), True),
        ((SQUARE, circle((0, 0), 3), circle((2, 0), 3)), True),
        ((SQUARE, rectangle(0, 0, 3, 3), rectangle(3, 1, 5, 2)), True),
        ((SQUARE, rectangle(8, 0, 12, 3)), True),
    ],
)
def test_the_plane_and_the_kernel_agree(contours, faulty):
    from tactcad.checks.on_solids import soundness
    from tactcad.solids.valid import is_clear_prism, prism_edges

    shape = prism(*contours)
    edges = prism_edges(shape)
    assert edges is not None and sum(e.length for e in edges) == pytest.approx(
        sum(c.length for c in contours)
    )
    assert keep_clear(edges, CLEAR) is not faulty
    assert is_clear_prism(shape) is not faulty
    assert soundness.meets_itself(shape) is faulty


@pytest.mark.cad
def test_what_is_no_prism_is_left_to_the_kernel():
    from build123d import Box, Cone, Cylinder, Pos, Rotation

    from tactcad.solids.build import build
    from tactcad.solids.valid import prism_edges

    block = Box(4, 3, 2)
    assert len(prism_edges(block.wrapped)) == 4
    for other in (
        block - Pos(0, 0, 1) * Cylinder(0.5, 1),
        block + Pos(0, 0, 2) * Box(1, 1, 2),
        block - Rotation(90, 0, 0) * Cylinder(0.3, 9),
        Rotation(0, 1, 0) * block,
        Cone(2, 1, 2),
        Pos(0, 0, 1) * block - Pos(0, 0, 1.5) * Rotation(0, 45, 0) * Box(0.5, 9, 0.5),
    ):
        assert prism_edges(other.solid().wrapped) is None
    bored = Part(
        "P",
        "plate",
        "milled",
        Material("steel", 7850.0),
        Extrusion(SQUARE, 2.0),
        (Hole("bore", (0.0, 0.0, 0.0), (0, 0, 1), 3.0, 2.0, True),),
    )
    assert len(prism_edges(build(bored))) == 5


def respoiled(shape, spoil: str):
    """The solid's shell with one of its faces left out, turned over, or put 1 um off its edges."""
    from OCP.BRep import BRep_Builder
    from OCP.Geom import Geom_Plane
    from OCP.gp import gp_Dir, gp_Pln, gp_Pnt
    from OCP.TopAbs import TopAbs_FACE, TopAbs_SHELL, TopAbs_WIRE
    from OCP.TopoDS import TopoDS_Face, TopoDS_Shell, TopoDS_Solid

    from tactcad.solids.occt import subshapes

    make, shell, solid = BRep_Builder(), TopoDS_Shell(), TopoDS_Solid()
    make.MakeShell(shell)
    faces = subshapes(shape, TopAbs_FACE)
    cap = max(faces, key=lambda f: len(subshapes(f, TopAbs_WIRE)))
    for face in faces:
        if face.IsSame(cap):
            if spoil == "open":
                continue
            if spoil == "turned":
                face = face.Reversed()
            if spoil == "off":
                off = TopoDS_Face()
                make.MakeFace(off, Geom_Plane(gp_Pln(gp_Pnt(0, 0, 0.001), gp_Dir(0, 0, 1))), 1e-7)
                for wire in subshapes(face, TopAbs_WIRE):
                    make.Add(off, wire)
                face = off
        make.Add(shell, face)
    shell.Closed(spoil != "open")
    make.MakeSolid(solid)
    make.Add(solid, shell)
    assert len(subshapes(solid, TopAbs_SHELL)) == 1
    return solid


@pytest.mark.cad
@pytest.mark.parametrize("spoil", ["", "open", "turned", "off"])
def test_wire_by_wire_a_prism_is_as_valid_as_to_the_kernel(spoil):
    from tactcad.solids.valid import is_valid

    shape = respoiled(prism(SQUARE, rectangle(-3, -3, 0, 0), rectangle(3, 3, 5, 5)), spoil)
    assert is_valid(shape, True) == is_valid(shape, False) == (not spoil)


@pytest.mark.cad
def test_an_opening_that_runs_the_wrong_way_is_seen_wire_by_wire():
    from tactcad.solids.valid import is_clear_prism, is_valid

    shape = prism(SQUARE, rectangle(0, 0, 3, 3).reversed())
    assert is_clear_prism(shape) and not is_valid(shape, True) and not is_valid(shape, False)


@pytest.mark.cad
@pytest.mark.parametrize(
    "openings, valid",
    [
        ((rectangle(20, 0, 23, 3),), False),  # beside the outline: the signed volume agrees
        ((rectangle(-5, -5, 5, 5), rectangle(-1, -1, 1, 1)), False),
        ((rectangle(-5, -5, 5, 5), rectangle(-4, -4, 4, 4), rectangle(-1, -1, 1, 1)), False),
        ((rectangle(-5, -5, 5, 5), rectangle(6, -1, 8, 1), rectangle(-8, -1, -6, 1)), True),
    ],
)
def test_openings_lie_side_by_side_in_the_outline(openings, valid):
    from tactcad.checks.on_solids.soundness import check_brep
    from tactcad.solids.valid import is_clear_prism, is_valid

    shape = prism(SQUARE, *openings)
    assert is_clear_prism(shape) == is_valid(shape, False) == valid
    part = Part("P", "plate", "milled", Material("steel", 7850.0), Extrusion(SQUARE, 0.5, openings))
    assert ("brep-valid" in [f.check for f in check_brep(part, shape)]) is not valid


@pytest.mark.cad
def test_many_holes_make_the_same_solid_as_few(monkeypatch):
    """Bored and as openings: the closed form, and each other's surface, box and places of holes."""
    from tactcad.checks.on_solids.soundness import check_brep, check_step
    from tactcad.solids import build as module
    from tactcad.solids.measure import holes_through, measure

    holes = [
        Hole("bore", (x, y, 0.5 if y > 0 else 0.0), (0, 0, -1 if y > 0 else 1), 0.6, 0.5, True)
        for x in range(-9, 10)
        for y in (-8, -5, -2, 1, 4, 7)
    ]
    sunk = Hole("sunk", (0.0, 9.0, 0.5), (0, 0, -1), 0.5, 0.5, True, counterbore=(0.9, 0.2))
    part = Part(
        "P",
        "grid",
        "milled",
        Material("steel", 7850.0),
        Extrusion(SQUARE, 0.5, (rectangle(-9, 8.2, -2, 9.8),)),
        (*holes, sunk),
    )
    assert len(holes) > module.MANY
    many = module.build(part)
    monkeypatch.setattr(module, "MANY", len(holes))
    few = module.build(part)
    assert check_brep(part, many) == check_step(part, many) == []
    one, other = measure(many), measure(few)
    for key in ("volume", "area", "centre", "box"):
        assert np.array(one[key]) == pytest.approx(np.array(other[key]), rel=1e-9, abs=1e-9), key
    assert holes_through(many) == holes_through(few) and len(holes_through(many)) == len(holes) + 2
