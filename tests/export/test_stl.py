"""STL of parts: read by another library, volume against the kernel's own, and what is refused."""

from __future__ import annotations

import io
import json

import numpy as np
import pytest
import trimesh

from tactcad.bench.kernel_costs import promised
from tactcad.bench.tessellation import ANGULAR
from tactcad.cli.main import main
from tactcad.design.messages import CheckFailure
from tactcad.export.stl import open_edges, part_stl, read_stl, stl_bytes, volume_of
from tactcad.scenes import make_scene
from tactcad.solids.build import build
from tactcad.solids.measure import measure
from tactcad.solids.meshing import Meshing

pytestmark = pytest.mark.cad
BOX = trimesh.creation.box((3.0, 2.0, 1.0)).triangles


def test_a_box_is_read_back_as_it_is():
    data = stl_bytes("box", BOX)
    again = read_stl(data)
    assert len(data) == 84 + 50 * 12 and np.array_equal(again, BOX.astype(np.float32))
    assert volume_of(again) == pytest.approx(6.0, rel=1e-12) and open_edges(again) == 0
    other = trimesh.load(io.BytesIO(data), file_type="stl")
    assert other.is_watertight and other.volume == pytest.approx(6.0) and not data.startswith(b"solid")


@pytest.mark.parametrize(
    "spoiled", [BOX[1:], np.concatenate([BOX, BOX[:1]]), np.concatenate([BOX[:1, ::-1], BOX[1:]])]
)
def test_what_is_no_closed_surface_is_seen(spoiled):
    assert open_edges(read_stl(stl_bytes("box", spoiled))) > 0


@pytest.mark.parametrize("cut", [slice(50), slice(-1), slice(84)])
def test_a_file_cut_short_is_refused(cut):
    with pytest.raises(CheckFailure, match="cannot hold"):
        read_stl(stl_bytes("box", BOX)[cut])


@pytest.mark.parametrize("angular", ANGULAR[:5])
def test_every_part_keeps_the_promise_against_the_kernels_volume(macro, macro_shapes, angular):
    """All scenes' parts, by another library's reader; `tactcad export` and `check` hold each again."""
    meshing = Meshing(angular, promised(angular))
    worst = 0.0
    for part_no, shape in macro_shapes.items():
        read = trimesh.load(io.BytesIO(part_stl(part_no, shape, meshing)), file_type="stl")
        assert read.is_watertight
        worst = max(worst, abs(read.volume / measure(shape)["volume"] - 1.0))
    assert 0.1 * promised(angular) < worst <= promised(angular)


def test_a_mesh_too_coarse_for_the_promise_is_refused(macro):
    pin = next(p for p in make_scene(macro, "array").parts if "pin" in p.part_no)
    with pytest.raises(CheckFailure, match="off the solid's volume; allowed are 0.01%"):
        part_stl(pin.part_no, build(pin).wrapped, Meshing(0.5, 1e-4))


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
