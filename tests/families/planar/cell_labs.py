"""A lab's readings of cells, by a simulator of its own: magnets as stacks of current loops, turned and moved
exactly, each tilted and off its place; the program has discs of charge, and turns of first order.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation
from scipy.special import ellipe, ellipk

from tactcad.families.planar.cell import wrench
from tactcad.families.planar.cell_layout import PlanarLayout

LOOPS = 12  # of a magnet, at Gauss' points over its height
MU0 = 4e-7 * np.pi


def loops_field(radius: float, height: float, remanence: float, at: np.ndarray) -> np.ndarray:
    """Field (mT) of a magnet whose lower face's middle is the origin, at points [..., 3], mm."""
    z, weight = np.polynomial.legendre.leggauss(LOOPS)
    total = np.zeros(at.shape)
    for zi, wi in zip(height * (z + 1) / 2, weight * height / 2):
        rho = np.maximum(np.hypot(at[..., 0], at[..., 1]), 1e-12)
        dz = at[..., 2] - zi
        a, b = (radius + rho) ** 2 + dz**2, (radius - rho) ** 2 + dz**2
        m = 4 * radius * rho / a
        current = wi * remanence / MU0  # of the sheet, in A/m times mm
        base = MU0 * current / (2 * np.pi * np.sqrt(a))
        along = base * (ellipk(m) + (radius**2 - rho**2 - dz**2) / b * ellipe(m))
        out = base * dz / rho * (-ellipk(m) + (radius**2 + rho**2 + dz**2) / b * ellipe(m))
        total += np.stack([out * at[..., 0] / rho, out * at[..., 1] / rho, along], axis=-1)
    return 1e3 * total


@dataclass(frozen=True)
class Lab:
    """A made array of n cells.

    straight  field of every chip by forces on every pad, [n, 3, n, 3]; forces as readings give them
    bent      second derivatives by forces on the own pad, [n, 3, 3, 3]; third by the normal force, [n, 3]
    rest      field without load, mT, [n, 3]
    stiffness N/mm, [n]
    """

    layout: PlanarLayout
    straight: np.ndarray
    bent: np.ndarray
    third: np.ndarray
    rest: np.ndarray
    stiffness: np.ndarray

    def fields(self, force: np.ndarray) -> np.ndarray:
        """At every chip, mT, for forces [..., n, 3]."""
        line = np.einsum("icjd,...jd->...ic", self.straight, force)
        bend = 0.5 * np.einsum("icde,...id,...ie->...ic", self.bent, force, force)
        return self.rest + line + bend + self.third * force[..., 2:] ** 3 / 6


def made(layout: PlanarLayout, rng: np.random.Generator, spread: float = 1.0) -> Lab:
    """An array whose magnets and chips are off their places, magnets tilted and beams off their widths."""
    tol, cells = layout.design.tolerance, layout.elements
    n, m = len(cells), layout.magnet
    tilt = np.radians(tol.magnet_tilt) / 2 * spread * rng.standard_normal((n, 2))
    off = tol.magnet_place / 2 * spread * rng.standard_normal((n, 2))
    chip = tol.chip_place / 2 * spread * rng.standard_normal((n, 2))
    soft = 1 + 0.02 * spread * rng.standard_normal(n)
    load = np.stack([wrench(f, layout.pad_height) for f in np.diag([1.0, 1.0, -1.0])], axis=1)
    lever = layout.design.planar.thickness / 2 + layout.design.magnet.height

    def felt(i: int, j: int, force: np.ndarray) -> np.ndarray:
        """The field of magnet j at chip i."""
        kind = cells[j].kind
        move = soft[j] * kind.cell.compliance @ load @ force
        straight = move[2]
        for _ in range(60):  # u (1 + c u^2) = straight
            move[2] = straight / (1 + kind.cell.stiffening * move[2] ** 2)
        turned = Rotation.from_rotvec(move[3:])
        magnet = turned * Rotation.from_rotvec([*tilt[j], 0.0])
        low = move[:3] + turned.apply([*off[j], -lever])
        at = np.array([cells[i].x - cells[j].x, cells[i].y - cells[j].y, 0.0])
        at += [*chip[i], -lever - layout.design.hall.gap]
        return magnet.apply(loops_field(m.radius, m.height, m.remanence, magnet.inv().apply(at - low)))

    e, h = np.eye(3), 0.02
    straight, rest = np.zeros((n, 3, n, 3)), np.zeros((n, 3))
    bent, third = np.zeros((n, 3, 3, 3)), np.zeros((n, 3))
    for i in range(n):
        for j in range(n):
            nought = felt(i, j, np.zeros(3))
            rest[i] += nought
            for d in range(3):
                straight[i, :, j, d] = (felt(i, j, h * e[d]) - felt(i, j, -h * e[d])) / (2 * h)
        for d in range(3):
            for g in range(3):
                four = [felt(i, i, h * (s * e[d] + t * e[g])) * s * t for s in (-1, 1) for t in (-1, 1)]
                bent[i, :, d, g] = sum(four) / (4 * h * h)
        k = 0.1
        f = [felt(i, i, s * k * e[2]) for s in (-2, -1, 1, 2)]
        third[i] = (f[3] - 2 * f[2] + 2 * f[1] - f[0]) / (2 * k**3)
    K = np.array([1 / (s * (load.T @ c.kind.cell.compliance @ load)[2, 2]) for s, c in zip(soft, cells)])
    return Lab(layout, straight, bent, third, rest, K)


@dataclass(frozen=True)
class Errors:
    """Standard deviations: of a reading's field (mT) along x, y, z; of a set-up's force, N a N, each cell's
    own and what all cells of a run share; of a reading's sink, mm."""

    field: tuple[float, float, float] = (2e-3, 2e-3, 3e-3)
    own: float = 3e-3
    shared: float = 0.0
    sink: float = 5e-4


def calibration_csv(
    lab: Lab, rng: np.random.Generator, errors: Errors, largest: float, runs: int = 4, sinks: bool = False
) -> str:
    """Readings of `runs` set-ups along each axis, of loads 0, 1/2 and 1 times the largest (N)."""
    n, loads = len(lab.stiffness), np.array([0.0, 0.5, 1.0])
    lines = ["element,run,fx,fy,fz,bx,by,bz" + ",sink" * sinks]
    for axis in range(3):
        for run in range(runs):
            together = errors.shared * rng.standard_normal(3)
            for i in range(n):
                way = np.eye(3)[axis] + together + errors.own * rng.standard_normal(3)
                force = np.zeros((3, n, 3))
                said = np.zeros((3, 3))
                said[:, axis] = largest * loads * (0.4 if axis < 2 else 1.0)
                force[:, i] = said[:, axis, None] * way
                b = lab.fields(force)[:, i] + np.array(errors.field) * rng.standard_normal((3, 3))
                straight = force[:, i, 2] / lab.stiffness[i]
                u = straight.copy()
                for _ in range(60):
                    u = straight / (1 + lab.layout.elements[i].kind.cell.stiffening * u**2)
                u += errors.sink * rng.standard_normal(3)
                for f, v, s in zip(said, b, u):
                    values = [*f, *v, *([s] if sinks else [])]
                    lines.append(f"{i + 1},{3 * run + axis + 1}," + ",".join(f"{x:.9g}" for x in values))
    return "\n".join(lines) + "\n"


def pressed(lab: Lab, load: np.ndarray, objects: np.ndarray | float) -> np.ndarray:
    """Normal forces [state, n] of pads on springs of the object (N/mm) that share the load."""
    each = 1 / (1 / lab.stiffness + 1 / np.broadcast_to(objects, lab.stiffness.shape))
    return load[:, None] * each / each.sum()


def grasp_csv(lab: Lab, rng: np.random.Generator, errors: Errors, load: np.ndarray, force: np.ndarray) -> str:
    """Readings at every load, and without; forces [state, n, 3]."""
    lines = ["load,element,bx,by,bz"]
    for p, f in zip([0.0, *load], np.concatenate([np.zeros_like(force[:1]), force])):
        b = lab.fields(f) + np.array(errors.field) * rng.standard_normal((len(lab.stiffness), 3))
        lines += [f"{p:.9g},{i + 1}," + ",".join(f"{x:.9g}" for x in v) for i, v in enumerate(b)]
    return "\n".join(lines) + "\n"
