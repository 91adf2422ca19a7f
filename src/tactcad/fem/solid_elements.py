"""Rung fem-solid: 27-node hexahedra, the plane mesh swept over half the width."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from skfem import Basis, ElementHex2

from tactcad.account import making

from . import elasticity
from .mapped_mesh import PlaneMesh, hex_mesh, plane_mesh
from .plane_elements import Array, end_nodes, fixed_unknowns, parabola
from .shape import ElementShape


@dataclass(frozen=True)
class SolidSolution:
    """Under unit force at the load line: compliance (mm/N), displacements (3, nodes: x, z, y) in mm."""

    compliance: float
    displacement: Array
    basis: Basis
    mesh: PlaneMesh
    unknowns: int

    @property
    def stiffness(self) -> float:
        """N/mm"""
        return 1.0 / self.compliance


def solve_solid(
    shape: ElementShape, E: float, nu: float, width: float, *, density: int = 2, across: int | None = None
) -> SolidSolution:
    """Clamped at the body's end, shear of 1 N on the arm's end, parabolic in z and even in y.

    `across` is the density over the width, by default the same as in the plane.
    """
    across = across or density
    with making("elements", f"solid, density {density} and {across} across"):
        return _solved(shape, E, nu, width, density, across)


def _solved(
    shape: ElementShape, E: float, nu: float, width: float, density: int, across: int
) -> SolidSolution:
    mesh = plane_mesh(shape, density)
    hexes = hex_mesh(mesh, width / 2.0, across)
    basis = Basis(hexes, ElementHex2(), intorder=5)
    A = elasticity.stiffness_matrix(basis, *elasticity.lame(E, nu))
    f = np.zeros(A.shape[0])
    end = end_nodes(basis.doflocs, mesh)
    y = np.unique(basis.doflocs[2, end])
    z = basis.doflocs[1, end[:: len(y)]]
    along = elasticity.line_load(z, lambda z: parabola(z, mesh))
    sideways = elasticity.line_load(y, lambda y: np.full_like(y, 1.0 / width))
    f[3 * end + 1] = np.outer(along, sideways).ravel()
    u = elasticity.solve(A, f, fixed_unknowns(basis.doflocs, mesh, 3))
    # by symmetry the meshed part carries 1/2 or 1/4 of the force, and as much of the energy
    compliance = (4.0 if mesh.half else 2.0) * (f @ u)
    return SolidSolution(float(compliance), u.reshape(-1, 3).T, basis, mesh, A.shape[0])
