"""An export's robot/: read by yourdfpy, MuJoCo and trimesh, frames compared; what is refused."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
import yourdfpy
from faults.command_line import one_by_one
from simulated import check_frames
from trimesh import load_mesh

from tactcad.cli.main import main
from tactcad.design.messages import InputError
from tactcad.parts.array.layout import Layout
from tactcad.parts.rules import load
from tactcad.robot import read, read_taxels
from tactcad.robot.cantilevers import cantilevers
from tactcad.robot.mechanism import Mechanism
from tactcad.robot.robot_files import refuse_foreign_meshes
from tactcad.scenes import make_scene

pytestmark = pytest.mark.cad


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """robot/ of an array of two facing elements."""
    work = tmp_path_factory.mktemp("robot")
    text = one_by_one(6, "A").replace("row_arms = [[6]]", "row_arms = [[6], [4]]")
    assert "[4]]" in text
    (work / "two.toml").write_text(text, "utf-8")
    asked = ["export", str(work / "two.toml"), "--scene", "array", "--robot"]
    assert main([*asked, "--out", str(work / "full")]) == 0
    assert main([*asked, "--detail", "envelope", "--out", str(work / "envelope")]) == 0
    return work / "full" / "robot"


@pytest.mark.slow  # a whole export
def test_the_manifest_lists_them(folder):
    listed = json.loads((folder.parent / "manifest.json").read_text())["files"]
    own = {f["path"] for f in listed if f["kind"] == "robot"}
    found = {p.relative_to(folder.parent).as_posix() for p in folder.rglob("*") if p.is_file()}
    assert own == found and {"robot/taxels.csv", "robot/macro-array.urdf", "robot/macro-array.xml"} < own


def test_frames_are_those_of_taxels_urdf_and_mjcf(folder):
    """At rest and turned: pads by both models; at rest also the table's, and the layout's own numbers."""
    check_frames(folder, "macro-array", 0.0)
    taxels, data = check_frames(folder, "macro-array", 0.7)
    for t in taxels.taxels:  # a positive angle sinks the pad
        sunk = t.z_mm - 1e3 * data.site(f"{t.designator}_taxel").xpos[2]
        assert sunk == pytest.approx(0.7 * t.range_mm, rel=0.02)


def test_pads_stand_where_the_array_has_them():
    """Contact pads of the shipped array by its own description, seen from the carrier's upper face."""
    d, layout = load("macro-array"), Layout(load("macro-array"))
    carrier = next(p for p in make_scene(d, "array").placements if p.designator == "CA1")
    top = carrier.origin[2] + carrier.part.extrusion.thickness
    for m, place in zip(cantilevers(d).moving, layout.elements):
        side = 1 if place.row == 1 else -1
        x, y = side * (layout.pad_inner + layout.pad_outer) / 2, side * place.y
        at = (m.taxel.x_mm, m.taxel.y_mm, m.taxel.z_mm)
        assert at == pytest.approx((x, -y, top + d.element.pad_height))
    beside = {m.taxel.number: m.taxel.neighbours for m in cantilevers(d).moving}
    assert beside[1] == (2, 10) and beside[3] == (2, 4, 8)


def test_meshes_are_found_in_metres_and_closed(folder):
    """The arms' and the bodies' meshes together are the elements'."""
    urdf = yourdfpy.URDF.load(str(folder / "macro-array.urdf"))
    box = urdf.scene.bounds
    d = load(str(folder.parents[1] / "two.toml"))
    assert 0.01 < np.ptp(box, axis=0).max() < 0.1  # m
    whole = {p.designator: p.part for p in make_scene(d, "array").placements}["E1"]
    parts = [load_mesh(folder / "meshes" / f"{whole.part_no}-{piece}.stl") for piece in ("arm", "body")]
    assert all(mesh.is_volume for mesh in parts)
    assert sum(m.volume for m in parts) == pytest.approx(1e-9 * whole.volume, rel=2e-3)


def test_inertia_is_that_of_the_meshes(folder):
    """The whole, about the mount: by triangles with the parts' densities."""
    model = mujoco.MjModel.from_xml_path(str(folder / "macro-array.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    found = cantilevers(load(str(folder.parents[1] / "two.toml")))
    tensor, mass = np.zeros((3, 3)), 0.0
    for p in (*found.fixed, *(p for m in found.moving for p in m.parts)):
        mesh = load_mesh(folder / "meshes" / f"{p.part.part_no}.stl")
        mesh.density = 1e-3 * p.part.mass / mesh.volume
        place = np.eye(4)
        place[:3, :3], place[:3, 3] = p.rotation, 1e-3 * np.array(p.origin)
        mesh.apply_transform(place)
        tensor += mesh.moment_inertia_frame(np.eye(4))
        mass += mesh.mass
    own = np.zeros((3, 3))
    for i in range(model.nbody):
        turn, r = data.ximat[i].reshape(3, 3), data.xipos[i]
        own += turn @ np.diag(model.body_inertia[i]) @ turn.T
        own += model.body_mass[i] * (r @ r * np.eye(3) - np.outer(r, r))
    assert model.body_mass.sum() == pytest.approx(mass, rel=1e-6)
    assert np.abs(own - tensor).max() < 1e-3 * np.abs(tensor).max()


def test_an_envelope_has_no_meshes_and_the_same_springs(folder):
    bare = folder.parents[1] / "envelope" / "robot"
    assert sorted(p.name for p in bare.iterdir()) == sorted(p.name for p in folder.iterdir() if p.is_file())
    models = [mujoco.MjModel.from_xml_path(str(f / "macro-array.xml")) for f in (folder, bare)]
    for name in ("jnt_stiffness", "jnt_range", "body_mass", "body_inertia"):
        assert (getattr(models[0], name) == getattr(models[1], name)).all()
    assert models[1].nmesh == 0 < models[0].nmesh


def test_the_table_as_csv_is_the_one_as_json(folder):
    rows = list(csv.DictReader((folder / "taxels.csv").open(encoding="utf-8")))
    taxels = read_taxels(folder)
    assert [row["schema"] for row in rows] == ["tactcad-taxels-1"] * len(taxels.taxels)
    for row, t in zip(rows, taxels.taxels):
        assert float(row["stiffness_N_per_mm"]) == t.stiffness_N_per_mm
        assert tuple(map(int, row["neighbours"].split())) == t.neighbours
    told = json.loads((folder / "taxels.json").read_text())
    model = mujoco.MjModel.from_xml_path(str(folder / "macro-array.xml"))
    assert told["version"] == "1.1" and told["timestep_s"] == model.opt.timestep


# --- what is refused ---


@pytest.mark.parametrize(
    "field, value, said",
    [
        ("stiffness_N_per_mm", 0.0, "taxels[1]: stiffness_N_per_mm: out of range; found 0.0; legal: above 0"),
        ("stiffness_N_per_mm", None, "taxels[1]: stiffness_N_per_mm: missing"),
        ("stop_gap_mm", -0.01, "taxels[1]: stop_gap_mm: out of range; found -0.01; legal: above 0"),
        ("range_mm", 0, "taxels[1]: range_mm: out of range; found 0; legal: above 0"),
        ("sink_mm_per_rad", [], "taxels[1]: sink_mm_per_rad: out of range"),
        ("shear_x_N_per_rad", [1.0, 2.0], "taxels[1]: shear_x_N_per_rad: out of range"),
        ("noise_V", None, "taxel 2: signal and noise: missing; legal: both in V, or both in mT"),
        ("sink_mm_per_rad", [-3.0], "taxels[1]: sink_mm_per_rad: out of range; found -3.0; legal: above 0"),
        ("sink_mm_per_rad", [True], "taxels[1]: sink_mm_per_rad: out of range"),
        ("joints", [], "taxels[1]: sink_mm_per_rad: out of range"),
        ("joints", ["E1_hinge"], "taxels.json: joints: of two taxels; found 'E1_hinge'; legal: each once"),
        ("number", 1, "taxels.json: number: of two taxels; found 1; legal: each once"),
        ("variance_offset_mm2", -1.0, "taxels[1]: variance_offset_mm2: below zero; found -1.0"),
    ],
)
def test_a_table_that_cannot_be_is_refused(folder, tmp_path, field, value, said):
    data = json.loads((folder / "taxels.json").read_text())
    data["taxels"][1][field] = value
    (tmp_path / "taxels.json").write_text(json.dumps(data))
    with pytest.raises(InputError) as refused:
        read_taxels(tmp_path)
    assert said in str(refused.value) and "\n" not in str(refused.value)


def test_another_version_is_refused(folder, tmp_path):
    told = json.loads((folder / "taxels.json").read_text()) | {"version": "1.0"}
    (tmp_path / "taxels.json").write_text(json.dumps(told))
    with pytest.raises(InputError, match="version: another one; found '1.0'; legal: 1.1: export again"):
        read_taxels(tmp_path)


def test_other_files_are_refused(tmp_path):
    (tmp_path / "taxels.json").write_text('{"schema": "other", "taxels": []}')
    with pytest.raises(InputError, match="schema: not a table of taxels; found 'other'"):
        read_taxels(tmp_path)


@pytest.fixture(scope="module")
def mechanism() -> Mechanism:
    return cantilevers(load("macro-array"))


@pytest.mark.parametrize(
    "field, value",
    [("stiffness_N_per_mm", 0.0), ("stop_gap_mm", -0.02), ("designator", "E 1"), ("designator", "<E1")],
)
def test_an_element_that_cannot_move_or_be_named_is_refused(mechanism, field, value):
    first, *rest = mechanism.moving
    bad = replace(first, taxel=replace(first.taxel, **{field: value}))
    with pytest.raises(InputError, match=f"element .*; found {value!r}; legal: "):
        replace(mechanism, moving=(bad, *rest))


def test_a_joint_that_never_moves_is_refused(mechanism):
    first, *rest = mechanism.moving
    stuck = replace(first.joints[0], reach=float("nan"))
    with pytest.raises(
        InputError, match="element E1: E1_hinge reach: out of range; found nan; legal: above 0"
    ):
        replace(mechanism, moving=(replace(first, joints=(stuck,)), *rest))


@pytest.mark.parametrize("file", ["../other.stl", "/etc/passwd", "meshes/missing.stl", ""])
def test_meshes_outside_the_folder_are_refused(file):
    text = f'<robot name="r"><link name="a"><visual><mesh filename="{file}"/></visual></link></robot>'
    with pytest.raises(InputError, match="r.urdf: mesh: leads out of the folder, or to nothing; found"):
        refuse_foreign_meshes("r.urdf", text.encode(), {"meshes/known.stl": None})


@pytest.mark.parametrize("joints", [[0.0], [[[0.0, 0.0]]], [0.0, float("nan")], np.zeros((0, 2))])
def test_positions_that_do_not_fit_are_refused(folder, joints):
    with pytest.raises(InputError, match="joints: not a position for each joint"):
        read(read_taxels(folder), joints)


def test_a_force_on_one_pad_is_no_object(folder):
    felt = read(read_taxels(folder), [1e-3, 0.0])
    assert felt.object == (None,) and felt.used.tolist() == [True, False]
