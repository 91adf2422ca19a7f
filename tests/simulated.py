"""A sensor's model in MuJoCo, and what must hold of it in every family."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
import pytest
import yourdfpy

from tactcad.design.family import family_of
from tactcad.export.cache import Cache
from tactcad.export.shapes import Shapes
from tactcad.mechanics.ladder import DEFAULT_RUNG
from tactcad.robot import Taxels, mjcf, read_taxels
from tactcad.robot.robot_files import solids
from tactcad.robot.taxel_table import as_made
from tactcad.scenes import make_scene


@dataclass
class Simulated:
    """A design, its model as text, and its table."""

    layout: Any
    text: str
    taxels: Taxels
    step: float

    def model(self, change=lambda spec: None) -> mujoco.MjModel:
        """Compiled, after `change`; with all joints damped critically, so that it comes to rest at once."""
        spec = mujoco.MjSpec.from_string(self.text)
        change(spec)
        model = spec.compile()
        n = sum(len(t.joints) for t in self.taxels.taxels)
        model.opt.gravity[:] = 0
        model.dof_damping[:n] *= 1 / mjcf.DAMPING
        return model

    def column(self, name: str) -> np.ndarray:
        return self.taxels.column(name)

    @property
    def lever(self) -> np.ndarray:
        """Hinge to pad's middle, m."""
        return 1e-3 * self.column("sink_mm_per_rad")[:, 0]


def simulated(design, folder) -> Simulated:
    """Made as an export makes it, without meshes to look at."""
    family = family_of(design)
    mechanism = family.robot.mechanism(design)
    shapes = Shapes(Cache(folder, lambda text: None), "test")
    base, arms = solids(mechanism, shapes, False)
    step = mjcf.timestep(mechanism, arms)
    text = mjcf.text(mechanism, base, arms, step).decode()
    return Simulated(family.layout(design), text, as_made(design, (m.taxel for m in mechanism.moving)), step)


def check_plate(s: Simulated) -> None:
    """Pressed by a rigid plate: force over way is what `estimate` says."""
    depth = 0.4e-3 * s.column("range_mm").min()
    high = 1e-3 * s.column("z_mm")[0]

    def plate(spec) -> None:
        thick = 5e-3
        body = spec.worldbody.add_body(name="plate", mocap=True, pos=[0, 0, high + thick - depth])
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.5, 0.5, thick])

    model = s.model(plate)
    data = mujoco.MjData(model)
    for _ in range(600):
        mujoco.mj_step(model, data)
    rows = family_of(s.layout.design).estimate.rows(s.layout, DEFAULT_RUNG, None)
    K = np.array([row.stiffness for row in rows])
    force = np.array([data.sensor(f"{t.designator}_force").data[0] for t in s.taxels.taxels])
    assert force / (1e3 * depth) == pytest.approx(K, rel=0.01)
    # the contact's own softness
    assert len(data.contact.dist) >= len(K)
    assert np.abs(data.contact.dist).max() < 1e-3 * depth


def check_energy(s: Simulated) -> None:
    """Free and undamped: kept to 0.1 % over 100 shortest periods; the step is a tenth of one at most."""
    model = s.model()
    model.dof_damping[:] = 0
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    assert (model.dof_armature == 0).all()
    periods = 2 * np.pi * (model.dof_M0 / model.jnt_stiffness) ** 0.5
    assert model.opt.timestep == s.step <= periods.min() / 10
    data = mujoco.MjData(model)
    data.qpos[:] = 0.3 * model.jnt_range[:, 1]
    mujoco.mj_forward(model, data)
    stored, swing = data.energy.sum(), 0.5 * model.jnt_stiffness @ data.qpos**2
    worst = 0.0
    for _ in range(int(100 * periods.min() / s.step) + 1):
        mujoco.mj_step(model, data)
        worst = max(worst, abs(data.energy.sum() - stored))
    assert worst < 1e-3 * swing


def check_mass(s: Simulated, model: mujoco.MjModel) -> None:
    """Masses add up to the parts'."""
    parts = make_scene(s.layout.design, "array").placements
    assert model.body_mass.sum() == pytest.approx(1e-3 * sum(p.part.mass for p in parts), rel=1e-6)


def check_frames(folder, name: str, share: float) -> tuple[Taxels, mujoco.MjData]:
    """Frames of pads and elements by both models, with joints at that share of their range; and MuJoCo's."""
    taxels = read_taxels(folder)
    urdf = yourdfpy.URDF.load(str(folder / f"{name}.urdf"), build_collision_scene_graph=True)
    model = mujoco.MjModel.from_xml_path(str(folder / f"{name}.xml"))
    data = mujoco.MjData(model)
    data.qpos[:] = share * model.jnt_range[:, 1]
    mujoco.mj_kinematics(model, data)
    urdf.update_cfg(dict(zip([j for t in taxels.taxels for j in t.joints], data.qpos)))
    for t in taxels.taxels:
        for frame, of in ((f"{t.designator}_taxel", data.site), (t.designator, data.body)):
            by_urdf, by_mjcf = urdf.get_transform(frame, "mount"), of(frame)
            assert np.abs(by_urdf[:3, 3] - by_mjcf.xpos).max() < 1e-9
            assert np.abs(by_urdf[:3, :3] - by_mjcf.xmat.reshape(3, 3)).max() < 1e-9
        if share == 0:
            site = data.site(f"{t.designator}_taxel")
            assert np.abs(1e-3 * np.array([t.x_mm, t.y_mm, t.z_mm]) - site.xpos).max() < 1e-9
            assert site.xmat[2::3] == pytest.approx([t.normal_x, t.normal_y, t.normal_z])
            turn = np.zeros(9)
            mujoco.mju_quat2Mat(turn, np.array([t.q_w, t.q_x, t.q_y, t.q_z]))
            assert turn == pytest.approx(site.xmat, abs=1e-12)
    return taxels, data


def polygon_moments(contour, x: float) -> tuple[float, float, np.ndarray]:
    """Area, polar moment about the origin and first moments of what lies left of x, by a fine polygon."""
    points = np.array([s.at(u) for s in contour for u in np.linspace(0, 1, 200, endpoint=False)])
    points[:, 0] = np.minimum(points[:, 0], x)
    (a, b), (c, d) = points.T, np.roll(points, -1, axis=0).T
    cross = a * d - c * b
    ixx, iyy = ((p * p + p * q + q * q) @ cross / 12 for p, q in ((a, c), (b, d)))
    return cross.sum() / 2, ixx + iyy, np.array([(a + c) @ cross, (b + d) @ cross]) / 6
