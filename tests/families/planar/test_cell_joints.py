"""A planar array for robots, in MuJoCo and yourdfpy: sink, tilts, stops, inertia, forces back."""

from __future__ import annotations

import json
import re
from pathlib import Path

import mujoco
import numpy as np
import pytest
import yourdfpy
from simulated import (
    Simulated,
    check_energy,
    check_frames,
    check_mass,
    check_plate,
    polygon_moments,
    simulated,
)

from tactcad.cli.main import main
from tactcad.design.messages import InputError
from tactcad.families.planar.sensor import rows
from tactcad.parts.rules import load
from tactcad.robot import read, read_taxels
from tactcad.scenes import make_scene

pytestmark = pytest.mark.cad
DESIGNS = Path(__file__).parents[3] / "hardware"


@pytest.fixture(scope="module", params=["jaw", "planar"])
def cells(request, tmp_path_factory) -> Simulated:
    design = load(str(DESIGNS / f"{request.param}-array.toml"))
    return simulated(design, tmp_path_factory.mktemp("cache"))


@pytest.mark.by_day(1, "a simulation each")
@pytest.mark.parametrize("check", [check_plate, check_energy])
def test_what_holds_of_every_family(cells, check):
    check(cells)


def at_rest(s: Simulated, model: mujoco.MjModel, push) -> mujoco.MjData:
    """After four of the slowest periods, damped critically, under forces that `push` applies."""
    data = mujoco.MjData(model)
    push(data)
    slowest = 2 * np.pi * (model.dof_M0 / model.jnt_stiffness) ** 0.5
    for _ in range(int(4 * slowest.max() / s.step)):
        mujoco.mj_step(model, data)
    return data


def pushed(s: Simulated, forces: np.ndarray) -> mujoco.MjData:
    """Every pad pushed at its middle, N in the mount's frame, [taxel, 3]."""
    model = s.model()

    def push(data) -> None:
        mujoco.mj_forward(model, data)
        for t, force in zip(s.taxels.taxels, forces):
            body = model.body(t.designator).id
            at = data.site(f"{t.designator}_taxel").xpos - data.xipos[body]
            data.xfrc_applied[body] = [*force, *np.cross(at, force)]

    return at_rest(s, model, push)


def test_a_force_on_the_pad_moves_it_as_the_matrix_says(cells):
    """Tilt, and the pad's way across within the share that the island's shift has, by K across of the
    estimate; `read` gives the force back."""
    s, H = cells, cells.layout.pad_height
    K = np.array([t.stiffness_N_per_mm for t in s.taxels.taxels])
    gap = np.array([t.range_mm for t in s.taxels.taxels])
    # a dead weight on a tipped pad would tip it further, which a linear estimate leaves out
    forces = (K * gap)[:, None] * np.array([0.02, -0.01, 0.0])
    data = pushed(s, forces)
    q = data.qpos.reshape(-1, 3)
    for e, (sink, tilt_x, tilt_y), force in zip(s.layout.elements, q, forces):
        motion = e.kind.cell.compliance @ [*force, *np.cross([0, 0, H], force)]
        assert [tilt_x, tilt_y] == pytest.approx(motion[3:5], rel=1e-3)
        assert abs(1e3 * sink) < 1e-3 * e.kind.table.stop_gap
    across = 1e3 * (np.array([data.site(f"{t.designator}_taxel").xpos for t in s.taxels.taxels]))[:, 0]
    by_estimate = forces[:, 0] / [row.shear_stiffness for row in rows(s.layout, "", None)]
    assert across - s.column("x_mm") == pytest.approx(by_estimate, rel=2e-3)
    assert read(s.taxels, data.qpos).shear == pytest.approx(forces[:, :2], rel=1e-3)


def test_a_plate_that_rubs_is_felt(cells):
    """Pressed by a heavy plate that moves across: pads stick to it, and feel what tilts them."""
    s, depth, speed = cells, 0.5e-3 * cells.column("range_mm").min(), 5e-4
    high = 1e-3 * s.column("z_mm")[0]

    def plate(spec) -> None:
        body = spec.worldbody.add_body(name="plate", pos=[0, 0, high + 5e-3 - depth])
        body.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[1, 0, 0])
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.5, 0.5, 5e-3], mass=1e4)

    model = s.model(plate)
    data = mujoco.MjData(model)
    for _ in range(600):
        mujoco.mj_step(model, data)
    data.qvel[-1], data.qpos[-1] = speed, 0.0
    for _ in range(600):
        mujoco.mj_step(model, data)
    felt, across = read(s.taxels, data.qpos[:-1]), data.qpos[-1]
    assert across == pytest.approx(600 * s.step * speed, rel=1e-3)
    K = np.array([row.shear_stiffness for row in rows(s.layout, "", None)])
    assert felt.shear[:, 0] == pytest.approx(1e3 * across * K, rel=0.02)
    assert np.abs(felt.shear[:, 1]).max() < 1e-3 * felt.shear[:, 0].max()
    assert felt.force == pytest.approx(1e3 * depth * s.column("stiffness_N_per_mm"), rel=1e-3)
    assert felt.used.all()


def test_stops_close_at_their_gaps(cells):
    """Down by thrice the force: every island on its land. Tipped by twice the moment: the first of its
    island's edge, its foot and its post is where it meets base or cover."""
    s, layout, house = cells, cells.layout, cells.layout.design.housing
    K, gap = s.column("stiffness_N_per_mm"), s.column("stop_gap_mm")
    assert gap.tolist() == [e.kind.table.stop_gap for e in layout.elements]
    data = pushed(s, np.outer(3 * K * gap, [0, 0, -1]))
    assert 1e3 * data.qpos[::3] == pytest.approx(gap, rel=1e-3)
    model = s.model()
    for axis, sign in ((0, 1), (1, -1)):
        moment = sign * 2 * model.jnt_range[1::3, 1] * model.jnt_stiffness[1::3]

        def tip(data) -> None:
            for t, M in zip(s.taxels.taxels, moment):
                data.xfrc_applied[model.body(t.designator).id, 3 + axis] = M

        tilts = at_rest(s, model, tip).qpos.reshape(-1, 3)[:, 1 + axis]
        up = layout.cover_z + house.cover_thickness - layout.design.planar.thickness / 2
        for e, angle in zip(layout.elements, np.abs(tilts)):
            ways = (angle * e.kind.reach, angle * e.kind.reach, angle * up)
            gaps = (e.kind.table.stop_gap, house.lift, house.side_gap)
            assert max(way / room for way, room in zip(ways, gaps)) == pytest.approx(1, rel=2e-3)


def test_mass_and_inertia_by_cylinders_and_polygons(cells):
    """Of what moves: post and magnet as cylinders, foot plate and the foil's piece as thin polygons. Its
    outline by area: island and ears, half of every beam, the fillets at its roots."""
    s, model, d, layout = cells, cells.model(), cells.layout.design, cells.layout
    check_mass(s, model)
    t, foot = d.planar.thickness, d.post.foot
    scene = {p.designator: p.part for p in make_scene(d, "array").placements}

    def cylinder(diameter: float, low: float, high: float, density: float) -> tuple[float, float]:
        r, h, middle = diameter / 2, high - low, (low + high) / 2
        m = density * np.pi * r**2 * h
        return m, m * (r**2 / 4 + h**2 / 12 + middle**2)

    for e in layout.elements[:2]:
        kind, r = e.kind, e.kind.table.fillet
        steel, post, magnet = scene["F1"], scene[f"P{e.number}"], scene[f"M{e.number}"]
        rho = 1e-9 * steel.material.density
        own = [cylinder(d.magnet.diameter, -t / 2 - d.magnet.height, -t / 2, 1e-9 * magnet.material.density)]
        up, bar = t / 2 + foot, 1e-9 * post.material.density
        own.append(cylinder(d.post.pad, up, layout.pad_height, bar))
        own.append(cylinder(d.post.spigot, -t / 2 + 0.02, up, bar))  # ends 0.02 inside the foil
        outline = kind.parted(layout.corner, (0.0, 0.0))[0]
        plate = scene[f"FP{e.number}"].extrusion.outer
        for contour, low, high in ((outline, -t / 2, t / 2), (plate, t / 2, up)):
            area, polar, _ = polygon_moments(contour, np.inf)
            h, middle = high - low, (low + high) / 2
            m = rho * area * h
            own.append((m, rho * h * polar / 2 + m * (h**2 / 12 + middle**2)))
            m, about = cylinder(d.post.spigot + 0.02, low, high, -rho)
            own.append((m, about))
        mass, moment = np.sum(own, axis=0)
        body = model.body(e.designator).id
        assert model.body_mass[body] == pytest.approx(mass, rel=1e-3)
        at = model.body_jntadr[body]
        assert model.dof_M0[at : at + 3] == pytest.approx([mass, 1e-6 * moment, 1e-6 * moment], rel=1e-3)
        area = kind.table.island**2 + 2 * kind.beam_length * kind.table.beam_width
        area += 4 * kind.table.ear * (kind.reach - kind.table.island / 2) if kind.pinwheel else 0
        fillets = 8 * (1 - np.pi / 4) * r**2
        assert polygon_moments(outline, np.inf)[0] == pytest.approx(area + fillets, rel=1e-3)


# --- files ---


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """robot/ of two cells."""
    work = tmp_path_factory.mktemp("cells")
    text = (DESIGNS / "jaw-array.toml").read_text("utf-8")
    for old, new in (("rows = 2", "rows = 1"), ("columns = 6", "columns = 2")):
        assert old in text
        text = text.replace(old, new)
    text = re.sub(r"(?s)\[design\.unchanged\..*?\n\]\n", "", text)  # other parts, so no kept letters
    (work / "two.toml").write_text(text, "utf-8")
    assert main(["export", str(work / "two.toml"), "--robot", "--out", str(work / "out")]) == 0
    return work / "out" / "robot"


@pytest.mark.parametrize("share", [0.0, 0.7])
def test_frames_are_those_of_taxels_urdf_and_mjcf(folder, share):
    taxels, data = check_frames(folder, "jaw-array", share)
    for t in taxels.taxels:  # a slide that goes down sinks the island
        down = t.z_mm - 1e3 * data.body(t.designator).xpos[2] - 2.02
        assert down == pytest.approx(share * t.range_mm, abs=1e-9)


def test_models_meshes_and_table_are_one(folder):
    urdf = yourdfpy.URDF.load(str(folder / "jaw-array.urdf"))
    assert 0.005 < np.ptp(urdf.scene.bounds, axis=0).max() < 0.02  # m
    assert len(urdf.actuated_joint_names) == 6
    model = mujoco.MjModel.from_xml_path(str(folder / "jaw-array.xml"))
    told = json.loads((folder / "taxels.json").read_text())
    names = [model.joint(i).name for i in range(model.njnt)]
    assert names == [j for t in told["taxels"] for j in t["joints"]]
    assert told["timestep_s"] == model.opt.timestep and (model.dof_armature == 0).all()
    first, second = read_taxels(folder).taxels
    assert (first.kind, second.kind, first.neighbours) == ("reference", "measuring", (2,))
    assert first.variance_stiffness_N2_per_mm2 > 0 and first.variance_offset_mm2 > 0


def test_mujoco_takes_the_urdf_and_its_mass_is_the_mjcf_s(folder):
    """Links between a cell's joints weigh next to nothing; without any inertia simulators refuse them."""
    own = mujoco.MjModel.from_xml_path(str(folder / "jaw-array.xml"))
    urdf = yourdfpy.URDF.load(str(folder / "jaw-array.urdf"))
    links = {name: link.inertial for name, link in urdf.link_map.items() if link.inertial}
    for cell in ("E1", "E2"):
        between = [i for name, i in links.items() if name.startswith(f"{cell}_")]
        assert len(between) == 2
        mass = sum(i.mass for i in between) + links[cell].mass
        assert mass == pytest.approx(own.body(cell).mass[0], rel=1e-3)
    text = (folder / "jaw-array.urdf").read_text()
    spec = mujoco.MjSpec.from_string(re.sub(r"<visual>.*?</visual>", "", text, flags=re.S))
    assert spec.compile().njnt == own.njnt == 6


def test_a_pad_touched_beside_its_middle_is_felt(folder):
    """By a small ball 1.5 mm beside it: the sensor's force is the contacts' own."""
    taxels = read_taxels(folder)
    first = taxels.taxels[0]
    spec = mujoco.MjSpec.from_file(str(folder / "jaw-array.xml"))
    spec.option.gravity = [0, 0, 0]
    x, y, z = 1e-3 * np.array([first.x_mm, first.y_mm - 1.5, first.z_mm])
    r, deep = 2e-3, 1e-3 * (2.02 - (2.02**2 - 1.5**2) ** 0.5)  # where the pad's ball is, 1.5 mm beside
    ball = spec.worldbody.add_body(mocap=True, pos=[x, y, z + r - deep])
    ball.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[r, 0, 0])
    model = spec.compile()
    data = mujoco.MjData(model)
    for _ in range(2000):
        mujoco.mj_step(model, data)
    force = np.zeros(6)
    touched = 0.0
    for i in range(data.ncon):
        mujoco.mj_contactForce(model, data, i, force)
        touched += force[0]
    assert touched > 0 and data.sensor(f"{first.designator}_force").data[0] == pytest.approx(
        touched, rel=1e-6
    )


def test_frames_together_and_k_obj_refused(folder):
    taxels = read_taxels(folder)
    frames = np.array([[1e-5, 0, 1e-3, 2e-5, 0, 0], [2e-5, 1e-3, 0, 1e-5, 0, 0]])
    felt = read(taxels, frames)
    assert felt.shear.shape == (2, 2, 2)
    for i, frame in enumerate(frames):
        one = read(taxels, frame)
        assert (one.shear == felt.shear[i]).all() and (one.force == felt.force[i]).all()
    with pytest.raises(InputError, match="K_obj: is read from volts only") as refused:
        _ = felt.object
    assert "\n" not in str(refused.value)
