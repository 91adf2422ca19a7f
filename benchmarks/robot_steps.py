"""Steps of MuJoCo a second: the exported array against a rigid body alone, free and pressed on a plate.

    python benchmarks/robot_steps.py

Prints the table of docs/benchmarks.md, "In a simulator".
"""

from __future__ import annotations

import tempfile
import time
from dataclasses import replace
from pathlib import Path

import mujoco

from tactcad.export.cache import Cache
from tactcad.export.shapes import Shapes
from tactcad.parts.rules import load
from tactcad.robot import mjcf
from tactcad.robot.cantilevers import cantilevers
from tactcad.robot.robot_files import solids

STEPS, TURNS = 4000, 3  # chosen: a second or so each; the best of them counts


def array(columns: int) -> str:
    """The published array with so many columns, as MJCF without meshes."""
    d = load("macro-array")
    rows = tuple((row * columns)[:columns] for row in d.array.row_arms)
    mechanism = cantilevers(replace(d, array=replace(d.array, row_arms=rows)))
    with tempfile.TemporaryDirectory() as folder:
        base, arms = solids(mechanism, Shapes(Cache(Path(folder), print), "benchmark"), False)
    return mjcf.text(mechanism, base, arms, mjcf.timestep(mechanism, arms)).decode()


def steps_a_second(text: str, pressed: bool, rigid: bool) -> float:
    spec = mujoco.MjSpec.from_string(text)
    spec.option.gravity = [0, 0, 0]
    if rigid:
        for joint in (*spec.sensors, *spec.joints):
            spec.delete(joint)
        spec.body("base").add_freejoint()
    if pressed:
        top = spec.site("E1_taxel")
        high = top.parent.pos[2] + top.pos[2]
        plate = spec.worldbody.add_body(mocap=True, pos=[0, 0, high + 5e-3 - 20e-6])
        plate.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.2, 0.2, 5e-3])
    model = spec.compile()
    data, best = mujoco.MjData(model), 0.0
    for _ in range(TURNS):
        start = time.perf_counter()
        mujoco.mj_step(model, data, nstep=STEPS)
        best = max(best, STEPS / (time.perf_counter() - start))
    return best


def main() -> None:
    print("| array | free, steps/s | pressed, steps/s | all of it one rigid body, steps/s |")
    print("| --- | --- | --- | --- |")
    for columns in (5, 50):
        text = array(columns)
        free, pressed, rigid = (
            steps_a_second(text, *how) for how in ((False, False), (True, False), (False, True))
        )
        print(f"| 2 x {columns} | {free:,.0f} | {pressed:,.0f} | {rigid:,.0f} |")


if __name__ == "__main__":
    main()
