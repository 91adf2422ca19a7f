"""Rung fem-plane: plane stress or plane strain on the mapped mesh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from skfem import Basis, ElementQuad2

from tactcad.account import making

from . import elasticity
from .mapped_mesh import PlaneMesh, plane_mesh, quad_mesh
from .shape import ElementShape

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PlaneSolution:
    """Under unit force at the load line: compliance (mm/N), displacements (2, nodes) in mm and the space."""

    compliance: float
    displacement: Array
    basis: Basis
    mesh: PlaneMesh
    unknowns: int

    @property
    def stiffness(self) -> float:
        """N/mm"""
        return 1.0 / self.compliance


def solve_plane(
    shape: ElementShape,
    E: float,
    nu: float,
    width: float,
    *,
    density: int = 3,
    plane_strain: bool = False,
    whole: bool = False,
) -> PlaneSolution:
    """Clamped at the body's end, parabolic shear of 1 N on the arm's end; work-conjugate deflection."""
    with making("elements", f"plane, density {density}"):
        return _solved(shape, E, nu, width, density, plane_strain, whole)


def _solved(
    shape: ElementShape, E: float, nu: float, width: float, density: int, plane_strain: bool, whole: bool
) -> PlaneSolution:
    mesh = plane_mesh(shape, density, whole)
    quads = quad_mesh(mesh)
    basis = Basis(quads, ElementQuad2(), intorder=4)
    A = elasticity.stiffness_matrix(basis, *elasticity.lame(E, nu, plane_stress=not plane_strain)) * width
    f = np.zeros(A.shape[0])
    end = end_nodes(basis.doflocs, mesh)
    f[2 * end + 1] = elasticity.line_load(basis.doflocs[1, end], lambda z: parabola(z, mesh))
    u = elasticity.solve(A, f, fixed_unknowns(basis.doflocs, mesh, 2))
    # the mirrored half carries the other half of the force, and as much energy
    compliance = (2.0 if mesh.half else 1.0) * (f @ u)
    return PlaneSolution(float(compliance), u.reshape(-1, 2).T, basis, mesh, A.shape[0])


def end_nodes(nodes: Array, mesh: PlaneMesh) -> NDArray[np.int64]:
    """Indices of the nodes on the arm's end, sorted by z, and for a solid by y within that."""
    found = np.flatnonzero(np.abs(nodes[0] - mesh.load_x) < 1e-9 * np.ptp(nodes[0]))
    keys = [np.rint(row[found] / (1e-7 * np.ptp(nodes[0]))) for row in nodes[1:]]
    return found[np.lexsort(keys[::-1])]


def parabola(z: Array, mesh: PlaneMesh) -> Array:
    """Shear traction per unit width of a unit force: 6 (z - low)(high - z)/h^3."""
    low, high = mesh.shape.arm.low, mesh.shape.arm.high
    return 6.0 * (z - low) * (high - z) / (high - low) ** 3


def fixed_unknowns(nodes: Array, mesh: PlaneMesh, dim: int) -> Array:
    """Unknowns held at zero: all at the body's end; on y = 0, by symmetry, those across.

    On the mid-line of a half mesh all but those along z: bending is odd in z there.
    """
    size = np.ptp(nodes[0])
    clamped = np.flatnonzero(np.abs(nodes[0] - mesh.clamp_x) < 1e-9 * size)
    fixed = [dim * clamped + i for i in range(dim)]
    if mesh.half:
        on_middle = dim * np.flatnonzero(np.abs(nodes[1] - mesh.middle) < 1e-9 * size)
        fixed += [on_middle + i for i in range(dim) if i != 1]
    if dim == 3:
        fixed.append(dim * np.flatnonzero(nodes[2] < 1e-9 * size) + 2)
    return np.unique(np.concatenate(fixed))
