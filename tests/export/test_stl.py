"""STL of parts: read by another library, volume against the kernel's own, and what is refused."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh
from trimesh.exchange.stl import export_stl

from tactcad.cli.main import main
from tactcad.costs.grades import ANGULAR, promised
from tactcad.design.messages import CheckFailure
from tactcad.export.part_formats.usual import check_stl, part_stl
from tactcad.scenes import make_scene
from tactcad.solids import Meshing
from tactcad.solids.build import build
from tactcad.solids.measure import measure

pytestmark = pytest.mark.cad
BOX = trimesh.creation.box((3.0, 2.0, 1.0))


def spoiled(keep: np.ndarray, turned: int = 0) -> bytes:
    """A box of those of its triangles, the first so many of which lie inside out."""
    faces = BOX.faces[keep].copy()
    faces[:turned] = faces[:turned, ::-1]
    return export_stl(trimesh.Trimesh(BOX.vertices, faces, process=False))


def test_a_closed_surface_of_its_volume_is_let_through():
    check_stl("box", spoiled(np.arange(12)), 6.0, 1e-6)
    with pytest.raises(
        CheckFailure, match=r"box: its STL file is 1.00% off the solid's volume; allowed are 0.90%"
    ):
        check_stl("box", spoiled(np.arange(12)), 6.0 / 1.01, 0.009)


@pytest.mark.parametrize(
    "data",
    [
        spoiled(np.arange(1, 12)),
        spoiled(np.r_[np.arange(12), 0]),
        spoiled(np.arange(12), turned=1),
        spoiled(np.arange(12), turned=12),
    ],
)
def test_what_is_no_closed_surface_is_refused(data):
    with pytest.raises(CheckFailure, match="do not close, or lie inside out"):
        check_stl("box", data, 6.0, None)


def read_by_the_kernel(path: Path) -> trimesh.Trimesh:
    """Its triangles."""
    from OCP.RWStl import RWStl

    read = RWStl.ReadFile_s(str(path))
    points = [read.Node(i + 1).Coord() for i in range(read.NbNodes())]
    faces = [[corner - 1 for corner in read.Triangle(i + 1).Get()] for i in range(read.NbTriangles())]
    return trimesh.Trimesh(points, faces)


@pytest.mark.by_day(2, "meshes of a whole array each")
@pytest.mark.parametrize("angular", ANGULAR[:5])
def test_every_part_keeps_the_promise_against_the_kernels_volume(macro_shapes, angular, tmp_path):
    """All scenes' parts, by the kernel's reader; `tactcad export` and `check` hold each again."""
    meshing = Meshing(angular, promised(angular))
    worst = 0.0
    for part_no, shape in macro_shapes.items():
        (tmp_path / "part.stl").write_bytes(part_stl(part_no, shape, meshing))
        read = read_by_the_kernel(tmp_path / "part.stl")
        assert read.is_watertight
        worst = max(worst, abs(read.volume / measure(shape)["volume"] - 1.0))
    assert 0.1 * promised(angular) < worst <= promised(angular)


def test_a_mesh_too_coarse_for_the_promise_is_refused(macro):
    pin = next(p for p in make_scene(macro, "array").parts if "pin" in p.part_no)
    with pytest.raises(CheckFailure, match="off the solid's volume; allowed are 0.01%"):
        part_stl(pin.part_no, build(pin), Meshing(0.5, 1e-4))


def test_an_export_within_an_error_holds_the_meshes_and_one_without_none(tmp_path, capsys):
    out = tmp_path / "out"
    args = ["export", "soft-tissue", "--scene", "array", "--out", str(out)]
    assert main([*args, "--within", "0.5%", "--json"]) == 0
    said = json.loads(capsys.readouterr().out)["budget"]
    assert said["chosen"]["error"] <= 0.005 and said["of"] == "each meshed volume"
    files = json.loads((out / "manifest.json").read_text())
    made = {
        p["part_no"]: p["volume_mm3"] for p in files["parts"] if p["process"] not in ("bought", "reference")
    }
    meshes = {f["part_no"]: f["path"] for f in files["files"] if f["kind"] == "stl"}
    assert set(meshes) == set(made) and len(made) >= 5
    for number, path in meshes.items():
        read = trimesh.load(out / path)
        assert read.is_watertight and read.volume == pytest.approx(made[number], rel=said["chosen"]["error"])
    assert main([*args, "--within", "0.5%"]) == 0 and "nothing was rebuilt" in capsys.readouterr().err
    assert main(args) == 0 and not (out / "stl").exists()
