"""Parts that are good, and shapes that are bad in one way each."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
import trimesh

from tactcad.checks.on_solids import soundness
from tactcad.checks.on_solids.soundness import (
    check_brep,
    check_mesh,
    check_step,
    check_step_file,
    check_triangles,
)
from tactcad.checks.run import run_checks
from tactcad.contour import chain, circle, rectangle
from tactcad.parts.language.description import Extrusion, Material, Part
from tactcad.solids import build as builder
from tactcad.solids.step import write_step
from tactcad.solids.triangles import triangles

pytestmark = pytest.mark.cad

STEEL = Material("steel", 7850.0)
BLOCK = Part("BLOCK", "block", "milled", STEEL, Extrusion(rectangle(0, 0, 10, 8), 5, (circle((5, 4), 3),)))


@pytest.fixture(scope="module")
def shape():
    return builder.build(BLOCK)


def test_a_good_part_has_no_findings(shape):
    assert check_brep(BLOCK, shape) == []
    assert check_mesh(BLOCK, shape) == []


def test_every_shipped_part_is_good(macro_scene, macro_shapes):
    for part in macro_scene.parts:
        assert check_brep(part, macro_shapes[part.part_no]) == []
        assert check_mesh(part, macro_shapes[part.part_no]) == []


def test_bad_shapes_are_seen(shape):
    from build123d import Box, Compound, Pos, Shell, Solid, Sphere

    two = Compound([Box(1, 1, 1).solid(), Pos(5, 0, 0) * Box(1, 1, 1).solid()]).wrapped
    assert [f.check for f in check_brep(BLOCK, two)] == ["one-solid"]
    hollow = (Box(10, 8, 5) - Sphere(1)).solid().wrapped
    assert [f.check for f in check_brep(BLOCK, hollow)] == ["one-solid"]
    five_faces = Shell(Box(10, 8, 5).faces()[:5])
    opened = Solid(_solid_of(five_faces.wrapped))
    assert "shell-closed" in [f.check for f in check_brep(BLOCK, opened.wrapped)]


def test_a_part_of_many_faces_is_meshed_by_the_other_method_on_the_same_points():
    """A plate with 60 square openings: its volume by hand, and the usual method's vertices."""
    openings = tuple(rectangle(x, y, x + 0.5, y + 0.4) for x in range(1, 11) for y in range(1, 7))
    part = replace(BLOCK, body=Extrusion(rectangle(0, 0, 12, 8), 0.1, (*openings, circle((11.5, 7.5), 0.6))))
    solid = builder.build(part)
    assert check_mesh(part, solid) == []
    points, faces = triangles(solid, 0.05, 0.2)
    mesh = trimesh.Trimesh(points, faces, process=False)
    hole = np.count_nonzero(np.linalg.norm(points[:, :2] - (11.5, 7.5), axis=1) < 0.31) / 2  # of a polygon
    area = 12 * 8 - 60 * 0.2 - hole / 2 * np.sin(2 * np.pi / hole) * 0.09
    assert mesh.is_watertight and mesh.volume == pytest.approx(0.1 * area, rel=1e-9)
    usual, others = triangles(solid, 0.05, 0.2, many=10**6)
    assert len(others) == len(faces) and usual == pytest.approx(points)
    assert not np.array_equal(others, faces)


def _solid_of(shell):
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Solid

    solid, make = TopoDS_Solid(), BRep_Builder()
    make.MakeSolid(solid)
    make.Add(solid, shell)
    return solid


@pytest.mark.parametrize(("step", "expected"), [(5e-4, {"tiny-edge"}), (2e-3, set())])
def test_tiny_edges_are_seen_where_they_are(step, expected):
    contour = chain([(0, 0), (10, 0), (10, 4), (10 + step, 4), (10 + step, 8), (0, 8)])
    part = replace(BLOCK, body=Extrusion(contour, 5.0))
    found = check_brep(part, builder.build(part))
    assert {f.check for f in found} == expected
    assert all(f.place[:2] == pytest.approx((10, 4), abs=1e-3) for f in found)


def test_a_tiny_face_is_seen():
    contour = chain([(0, 0), (10, 0), (10, 4), (10.0009, 4), (10.0009, 8), (0, 8)])
    part = replace(BLOCK, body=Extrusion(contour, 0.001))
    assert "tiny-face" in {f.check for f in check_brep(part, builder.build(part))}


def test_a_solid_that_passes_through_itself_is_seen():
    part, solid = bent_tube()
    assert "self-intersection" in {f.check for f in check_brep(part, solid.wrapped)}


def bent_tube():
    """A tube bent so tightly that its ends cross: each face is good, and two of them meet. And a part of its
    volume."""
    from build123d import Plane, Rectangle, Solid, Spline

    path = Spline((0, 0, 0), (20, 0, 0), (20, 20, 0.2), (10, 20, 0), (10, -10, 0))
    profile = Plane(path @ 0, z_dir=path % 0) * Rectangle(2, 2)
    solid = Solid.sweep(profile.face(), path)
    return replace(BLOCK, body=Extrusion(rectangle(0, 0, 1, 1), solid.volume)), solid


def test_another_volume_is_seen(shape):
    larger = replace(BLOCK, body=Extrusion(BLOCK.body.outer, 5.00001, BLOCK.body.openings))
    assert [f.check for f in check_brep(larger, shape)] == ["volume"]


def test_an_invalid_solid_is_seen():
    assert "brep-valid" in [f.check for f in check_brep(BLOCK, bow_tie().wrapped)]


def bow_tie():
    """A face whose wire crosses itself, extruded: the kernel builds it and calls it invalid."""
    from build123d import Solid
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakePolygon
    from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
    from OCP.gp import gp_Pnt, gp_Vec

    polygon = BRepBuilderAPI_MakePolygon()
    for x, y in ((0, 0), (9, 9), (9, 0), (0, 8)):
        polygon.Add(gp_Pnt(x, y, 0))
    polygon.Close()
    face = BRepBuilderAPI_MakeFace(polygon.Wire()).Face()
    return Solid(BRepPrimAPI_MakePrism(face, gp_Vec(0, 0, 5)).Shape())


# --- read back from STEP ---


def test_the_shipped_parts_come_back_from_step_as_they_were(macro_scene, macro_shapes):
    for part in macro_scene.parts:
        assert check_step(part, macro_shapes[part.part_no]) == []


def without_a_face(data: bytes) -> bytes:
    """The file with the first face taken off its shell's list."""
    return re.sub(rb"(CLOSED_SHELL\('',\()#\d+,", rb"\1", data, count=1)


def stretched(data: bytes) -> bytes:
    """Every point 1 % further out along x."""
    return re.sub(
        rb"CARTESIAN_POINT\('',\(([-0-9.E+]+),",
        lambda m: b"CARTESIAN_POINT('',(%r," % (1.01 * float(m[1])),
        data,
    )


def cut_off(data: bytes) -> bytes:
    return data[: len(data) // 2]


@pytest.mark.parametrize(
    ("spoil", "expected"),
    [(without_a_face, {"one-solid"}), (stretched, {"volume", "step-volume", "step-area", "step-box"})],
)
def test_a_spoilt_step_file_is_seen(shape, spoil, expected):
    data = write_step(shape)
    assert check_step_file(BLOCK, shape, data) == []
    assert spoil(data) != data
    found = {f.check for f in check_step_file(BLOCK, shape, spoil(data))}
    assert found == expected


def test_a_shape_that_was_moved_before_it_was_written_is_seen(shape):
    from OCP.gp import gp_Trsf, gp_Vec
    from OCP.TopLoc import TopLoc_Location

    moved = gp_Trsf()
    moved.SetTranslation(gp_Vec(0.0, 0.0, 2e-6))
    found = check_step_file(BLOCK, shape, write_step(shape.Moved(TopLoc_Location(moved))))
    assert {f.check for f in found} == {"step-box"} and "STEP" in found[0].message


def test_a_step_file_that_ends_early_cannot_be_read(shape, monkeypatch):
    with pytest.raises(ValueError, match="STEP"):
        check_step_file(BLOCK, shape, cut_off(write_step(shape)))
    monkeypatch.setattr(soundness, "write_step", lambda s: cut_off(write_step(s)))
    (finding,) = check_step(BLOCK, shape)
    assert (finding.check, finding.severity, finding.part) == ("step-file", "fail", "BLOCK")


# --- meshes ---


def soup(shape) -> tuple[np.ndarray, np.ndarray]:
    return triangles(shape, 0.05, 0.2)


def checked(vertices, faces) -> list[str]:
    return [f.check for f in check_triangles("BLOCK", trimesh.Trimesh(vertices, faces, process=False))]


def test_meshes_that_are_open_turned_or_doubled_are_seen(shape):
    vertices, faces = soup(shape)
    assert checked(vertices, faces) == []
    assert checked(vertices, faces[1:]) == ["mesh-watertight"]
    flipped = faces.copy()
    flipped[0] = flipped[0][::-1]
    assert checked(vertices, flipped) == ["mesh-winding"]
    assert checked(vertices, faces[:, ::-1]) == ["mesh-winding"]
    assert checked(vertices, np.vstack([faces, faces[:1]])) == ["mesh-watertight"]


def test_the_mesh_is_the_solid_within_its_tessellation(shape):
    """Inscribed facets of a bore: the block keeps a little more than the circle would leave; within w^2/6 of
    the bore."""
    vertices, faces = soup(shape)
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    bore = np.pi * 1.5**2 * 5
    assert 0 < mesh.volume - BLOCK.volume < bore * 0.2**2 / 6
    assert mesh.is_watertight and mesh.euler_number == 0  # one through hole


def test_a_mesh_of_another_size_is_seen(shape, monkeypatch):
    larger = lambda s, a, b: (soup(s)[0] * 1.02, soup(s)[1])  # noqa: E731
    monkeypatch.setattr(soundness, "triangles", larger)
    assert [f.check for f in check_mesh(BLOCK, shape)] == ["mesh-volume", "mesh-area"]


def test_run_reports_what_cannot_be_built(macro, monkeypatch):
    """A part whose solid does not hold is a finding, not a crash, and its scene is not called free of
    overlap."""
    from tactcad.checks import run

    def refuse(part: Part):
        if part.part_no.endswith("carrier"):
            raise builder.SolidError(f"{part.part_no}: the kernel calls the solid invalid")
        return builder.build(part)

    monkeypatch.setattr(run, "build", refuse)
    report = run_checks(macro, ["array"])
    assert [(f.check, f.severity, f.part) for f in report.failures] == [
        ("build", "fail", "macro-array-carrier")
    ]
    assert "interference" not in report.runs
    assert report.runs["brep"] == report.runs["mesh"] == 13
    assert len([f for f in report.findings if f.severity == "flag" and "hinge" in f.check]) == 5
