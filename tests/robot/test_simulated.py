"""The MJCF file in MuJoCo: stiffness, stops, mass, inertia, energy, K_obj, of shipped and random designs."""

from __future__ import annotations

import json

import mujoco
import numpy as np
import pytest
from simulated import Simulated, check_energy, check_mass, check_plate, polygon_moments, simulated
from sound_designs import as_table, sound_table
from variants import FACING_ROWS

from tactcad.cli.main import main
from tactcad.design.load import from_table
from tactcad.lab.calibration_file import FIELDS
from tactcad.mechanics.ladder import DEFAULT_RUNG
from tactcad.parts.array.element import element
from tactcad.parts.array.hinge_section import hinge_section, not_reached
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.stop_gap import stop_gap
from tactcad.parts.rules import load
from tactcad.robot import read

pytestmark = pytest.mark.cad
SHIPPED = ("macro-array", *sorted({*FACING_ROWS} - {"macro-array"}))
RANDOM = [
    *range(3),
    # slow: 17 more of a kind, simulated in MuJoCo
    *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(3, 20)),
    *(pytest.param(seed, marks=pytest.mark.nightly) for seed in range(20, 50)),
]


def drawn(number: int):
    """A random design that keeps every rule, and that the estimator reaches."""
    for seed in range(1000 * number, 1000 * number + 1000):
        design = from_table(as_table(sound_table(seed, (1, 2, 3, 5))))
        layout = Layout(design)
        section = hinge_section(layout, layout.elements)
        if not not_reached(layout, layout.elements, section, DEFAULT_RUNG):
            return design
    raise AssertionError("none in a thousand")


@pytest.fixture(
    # slow: the first by day: each is simulated in MuJoCo
    scope="module",
    params=[*SHIPPED[:1], *(pytest.param(s, marks=pytest.mark.slow) for s in SHIPPED[1:])],
)
def shipped(request, tmp_path_factory) -> Simulated:
    return simulated(load(request.param), tmp_path_factory.mktemp("cache"))


@pytest.fixture(scope="module", params=RANDOM)
def random(request, tmp_path_factory) -> Simulated:
    return simulated(drawn(request.param), tmp_path_factory.mktemp("cache"))


# --- what holds of every design ---


def check_stops(s: Simulated) -> None:
    """Pushed by thrice the force that closes it, every stop stands where it should, at pad and tip."""
    model = s.model()
    data = mujoco.MjData(model)
    K, reach = s.column("stiffness_N_per_mm"), s.column("range_mm")
    for t, push in zip(s.taxels.taxels, 3 * K * reach):
        turn = push * 1e-3 * t.sink_mm_per_rad[0]  # N m, about the pad's y
        data.xfrc_applied[model.body(t.designator).id, 4] = turn if t.q_w else -turn
    slowest = 2 * np.pi * (model.dof_M0 / model.jnt_stiffness) ** 0.5
    for _ in range(int(4 * slowest.max() / s.step)):
        mujoco.mj_step(model, data)
    assert 1e3 * s.lever * data.qpos == pytest.approx(reach, rel=1e-3)
    half = s.layout.design.element.pad_length / 2
    tip = (1e3 * s.lever + half) * data.qpos
    gaps = [stop_gap(s.layout, p) for p in s.layout.elements]
    assert tip == pytest.approx(np.array(gaps), rel=2e-3)
    assert s.column("stop_gap_mm") == pytest.approx(np.array(gaps))


def check_inertia(s: Simulated) -> None:
    """Masses add up to the parts'; each arm's moment about its hinge is its contour's."""
    model = s.model()
    check_mass(s, model)
    d = s.layout.design
    for i, place in enumerate(s.layout.elements):
        area, polar, first = polygon_moments(element(s.layout, place).extrusion.outer, place.hinge_x)
        per_area = d.sheet.thickness * d.material.density * 1e-9  # kg/mm2
        body = model.body(place.designator).id
        assert model.body_mass[body] == pytest.approx(area * per_area, rel=1e-3)
        x = d.array.row_pitch / 2 + 1e3 * s.lever[i]
        z = place.hinge.t / 2 if d.element.sides == "one" else place.hinge.h / 2
        about = polar - 2 * first @ (x, z) + area * (x * x + z * z)
        assert model.dof_M0[i] == pytest.approx(1e-6 * about * per_area, rel=1e-3)


def pressed_on_springs(s: Simulated, k: float) -> np.ndarray:
    """Joint positions with every pad pressed on a slider on a spring of k N/mm."""
    K, high = s.column("stiffness_N_per_mm"), 1e-3 * s.column("z_mm")[0]
    model = s.model()
    m = model.dof_M0 / s.lever**2  # arm's mass at its pad
    approach = 0.5e-3 * (s.column("range_mm") * (K + k) / k).min()
    half = 0.4e-3 * s.column("length_mm")[0]

    def sliders(spec) -> None:
        for t, mass in zip(s.taxels.taxels, m):
            at = [1e-3 * t.x_mm, 1e-3 * t.y_mm, high + half - approach]
            body = spec.worldbody.add_body(name=f"object{t.number}", pos=at)
            damping = 2 * (1e3 * k * mass) ** 0.5
            axis, slide = [0, 0, 1], mujoco.mjtJoint.mjJNT_SLIDE
            body.add_joint(type=slide, axis=axis, stiffness=1e3 * k, damping=damping)
            size = [half, 0.5e-3 * t.width_mm, half]
            body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=size, mass=mass)

    model = s.model(sliders)
    data = mujoco.MjData(model)
    slowest = 2 * np.pi * (2e-3 * m / (K + k)).max() ** 0.5
    for _ in range(int(6 * slowest / s.step)):
        mujoco.mj_step(model, data)
    return data.qpos[: len(m)].copy()


def check_objects(s: Simulated, k: float) -> None:
    K = s.column("stiffness_N_per_mm")
    q = pressed_on_springs(s, k)
    felt = read(s.taxels, q, coupling=0.0)
    assert felt.force == pytest.approx(1e3 * K * s.lever * q, rel=1e-9)
    if K.max() < 1.3 * K.min() or not felt.used.all():
        return  # elements alike tell nothing of the object; nor do those that it hardly moves
    (found,) = felt.object
    assert found.low < k < found.high
    # the object's relative error over that of the deflections' ratio: soft arms do not feel a stiff object
    condition = (K.max() + k) * (K.min() + k) / (k * (K.max() - K.min()))
    if condition < 100:
        assert found.estimate == pytest.approx(k, rel=0.02)
    (wider,) = read(s.taxels, q).object
    assert wider.estimate == found.estimate and wider.low <= found.low and wider.high >= found.high


CHECKS = (check_plate, check_stops, check_inertia, check_energy)


@pytest.mark.parametrize("check", CHECKS)
def test_a_shipped_design(shipped, check):
    check(shipped)


@pytest.mark.by_day(6, "a simulation each")
@pytest.mark.parametrize("check", CHECKS)
def test_a_random_design(random, check):
    check(random)


@pytest.mark.parametrize("k", [1.0, 4.5, 20.0])
def test_object_of_springs(shipped, k):
    check_objects(shipped, k)


@pytest.mark.parametrize("k", [1.0, 20.0])
def test_object_of_springs_under_random_designs(random, k):
    check_objects(random, k)


def test_frames_read_together_are_those_read_one_by_one(shipped):
    s = shipped
    frames = np.linspace(0.2, 0.9, 4)[:, None] * 1e-3 * s.column("range_mm") / s.lever
    felt = read(s.taxels, frames)
    for i, frame in enumerate(frames):
        one = read(s.taxels, frame)
        assert (one.force == felt.force[i]).all() and one.object[0] == felt.object[i]


def test_deflection_is_a_sensor_too(shipped):
    """Each element's sensor says the joint's own position, which `read` takes."""
    s = shipped
    model = s.model()
    data = mujoco.MjData(model)
    data.qpos[:] = np.linspace(0.1, 0.6, len(s.lever)) * 1e-3 * s.column("range_mm") / s.lever
    mujoco.mj_forward(model, data)
    told = [data.sensor(f"{t.designator}_hinge_deflection").data[0] for t in s.taxels.taxels]
    assert told == pytest.approx(data.qpos, rel=1e-12)


def test_k_obj_is_that_of_the_command(shipped, tmp_path, capsys):
    """The same exact ways on separate springs of 4 N/mm, as volts for `tactcad stiffness`."""
    s, k, steps = shipped, 4.0, 8
    K, V = s.column("stiffness_N_per_mm"), s.column("signal_V_per_mm")
    most = 0.8 * (s.column("range_mm") * (K + k) / k).min()
    way = np.linspace(0, most, steps + 1)[:, None] * k / (K + k)
    heads = ",".join(f.name for f in FIELDS)
    known = [f"{t.number},{a},{1e-3 * a},{b},{1e-3 * b},0,100" for t, a, b in zip(s.taxels.taxels, K, V)]
    (tmp_path / "known.csv").write_text("\n".join([heads, *known]), "utf-8")
    rows = [
        f"{load},{t.number},{v}"
        for load, volts in zip(way @ K, V * way)
        for t, v in zip(s.taxels.taxels, volts)
    ]
    (tmp_path / "grasp.csv").write_text("\n".join(["load_N,element,signal_V", *rows]), "utf-8")
    files = [str(tmp_path / "grasp.csv"), "--calibration", str(tmp_path / "known.csv")]
    assert main(["stiffness", *files, "--coupling", "0", "--json"]) == 0
    (told,) = json.loads(capsys.readouterr().out)["samples"]
    assert told["combined"]["estimate"] == pytest.approx(k, rel=1e-6)
    (own,) = read(s.taxels, way[-1] / (1e3 * s.lever), coupling=0.0).object
    assert own.estimate == pytest.approx(k, rel=1e-6)
