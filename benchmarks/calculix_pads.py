"""Three scenes of rigid pads on soft layers by CalculiX's hyperelastic bricks and by rung `large`.

    python benchmarks/calculix_pads.py benchmarks/results/calculix_pads.md    4 minutes; needs ccx

A pad is moved in CalculiX as `large` moves it, and the forces are compared. Bricks are too stiff at a pad's
edge: what their mesh adds at a vanishing depth, by the linear layer, is divided out.
"""

from __future__ import annotations

import sys
import tempfile
from dataclasses import dataclass
from functools import cached_property
from math import inf, radians, tan
from pathlib import Path

import calculix
import numpy as np
from numpy.typing import NDArray
from tables import lines, write_tables

from tactcad.contact import large_strain
from tactcad.contact.elastic_body import Body
from tactcad.contact.large_strain import FREE_SIDE
from tactcad.contact.press import Pads, PadsOnBody, Pressed
from tactcad.contact.solid_face import lines_over_pad, outward
from tactcad.contact.stated_errors import pad_radius, stated_error, tilt_error

Array = NDArray[np.float64]

TABLE = "pads by CalculiX"
LENGTH, WIDTH = 2.0, 3.0  # of a pad, mm
HALVES = 3  # bricks under half a side
LITTLE = 1e-4  # of the depth: so much shows what the mesh adds
RIGID = 1e4  # N/mm


@dataclass(frozen=True)
class Scene:
    """Pads at every x and y (mm, symmetric about 0), on springs of K (N/mm) and levers that turn them by
    `turn` (rad/mm) as they sink, pressed by a load (N) on a body inclined by an angle along x (degrees)."""

    name: str
    body: Body
    x: tuple[float, ...]
    y: tuple[float, ...]
    load: float
    turn: float = 0.0
    K: float = RIGID
    angle: float = 0.0

    @cached_property
    def pads(self) -> Pads:
        x, y = (v.ravel() for v in np.meshgrid(self.x, self.y, indexing="ij"))
        move = np.stack([np.ones(len(x)), self.turn * np.sign(x), np.zeros(len(x))], axis=1)
        compliance = move[:, :, None] * move[:, None, :] / self.K
        return Pads(x, y, LENGTH, WIDTH, compliance, np.zeros(len(x)), np.full(len(x), inf))

    @cached_property
    def contact(self) -> PadsOnBody:
        return PadsOnBody(self.pads, self.body)

    @cached_property
    def pressed(self) -> Pressed:
        """By rung large."""
        return large_strain.press(self.contact, self.load, (self.angle, 0.0))

    @property
    def motion(self) -> tuple[float, float]:
        """Of the last pad: the depth of its middle, and by how much its right edge is deeper, mm."""
        slope = self.pressed.slope[-1, 0] + tan(radians(self.angle))
        depth = self.pressed.approach - self.pressed.sink[-1] - self.pads.x[-1] * tan(radians(self.angle))
        return depth, -slope * LENGTH / 2.0

    @property
    def linear(self) -> float:
        """Force on the last pad by the linear layer at the same motion of all, N."""
        depth, fall = self.motion
        side = np.where(self.pads.x < -1e-9, -1.0, 1.0)[:, None]
        down = depth + fall * side * (self.contact.at[0] - self.pads.x[:, None]) / (LENGTH / 2.0)
        unit = np.eye(down.size).reshape(-1, *down.shape)
        face = self.contact.face.moved(unit).reshape(down.size, -1)
        return float(np.linalg.solve(face, down.ravel()).reshape(down.shape)[-1].sum())

    def by_calculix(self, halves: int, share: float = 1.0) -> float:
        """Force on the last pad at that share of its motion, N."""
        h, places = self.body.thickness, (self.pads.x[-1], self.pads.y[-1])
        mirrored = self.angle == 0.0, True
        planes, parts = [], 1.0
        for at, side, mirror in zip(places, (LENGTH, WIDTH), mirrored):
            right = lines_over_pad(side / 2.0, side / 2.0 + FREE_SIDE * h, halves)
            left = lines_over_pad(side / 2.0, at if mirror and at else right[-1], halves)[:0:-1]
            through_the_middle = mirror and not at
            planes.append(at + np.concatenate([[] if through_the_middle else -left, right]))
            parts *= 2.0 if through_the_middle else 1.0
        fine = right[halves] - right[halves - 1]
        z = np.concatenate([[0.0], outward(0.0, fine, h)])
        depth, fall = (share * v for v in self.motion)
        reach = ((at - side / 2.0, at + side / 2.0) for at, side in zip(places, (LENGTH, WIDTH)))
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "pad.inp"
            return parts * calculix.pad_force((*planes, -z[::-1]), self.body, *reach, depth, fall, path)


SCENES = (
    Scene("four level pads, 4 x 4.5 mm apart", Body(0.5, 0.45, 2.0), (-2.0, 2.0), (-2.25, 2.25), 4.0),
    Scene("two facing pads on levers of 4 mm", Body(0.5, 0.49, 3.0), (-2.0, 2.0), (0.0,), 1.2, 0.25, 4.0),
    Scene("a pad on a face inclined by 5 degrees", Body(0.5, 0.49, 3.0), (0.0,), (0.0,), 1.0, angle=5.0),
)


@dataclass(frozen=True)
class Compared:
    """A scene: the pad's depth over the lesser of its radius and the thickness, the fall to its edge over its
    depth, CalculiX's force (N), what its mesh adds, relative, the relative deviations of `large` and of the
    linear layer, and the error stated of `large`."""

    depth: float
    fall: float
    calculix: float
    mesh: float
    large: float
    linear: float
    stated: float


def stated(scene: Scene) -> float:
    angle = scene.angle, 0.0
    own = stated_error("large", scene.pads, scene.body, scene.pressed.force)
    return own + tilt_error(scene.pads, scene.body, scene.pressed, angle)


def compared(scene: Scene) -> Compared:
    little, full = (scene.by_calculix(HALVES, share) / share for share in (LITTLE, 1.0))
    mesh = little / scene.linear - 1.0
    right = full / (1.0 + mesh)
    depth, fall = scene.motion
    least = min(pad_radius(scene.pads), scene.body.thickness)
    force = scene.pressed.force[-1]
    off = force / right - 1.0, scene.linear / right - 1.0
    return Compared(depth / least, abs(fall) / depth, right, mesh, *off, stated(scene))


def table() -> str:
    heads = (
        "scene | nu | thickness, mm | depth over the lesser of radius and thickness | fall over depth | "
        "CalculiX, N | its mesh adds | large differs | stated | layer differs"
    )
    rows = []
    for scene in SCENES:
        one = compared(scene)
        shares = (one.mesh, one.large, one.stated, one.linear)
        where = f"{scene.body.poisson:g}", f"{scene.body.thickness:g}", f"{one.depth:.2g}", f"{one.fall:.2g}"
        rows.append([scene.name, *where, f"{one.calculix:.5g}", *(f"{100.0 * v:.2g} %" for v in shares)])
        print(*rows[-1], sep=" | ", file=sys.stderr, flush=True)
    return lines(heads, rows)


if __name__ == "__main__":
    raise SystemExit(write_tables(__doc__, {TABLE: table}))
