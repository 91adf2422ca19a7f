"""Rung fem-solid: the plane mesh swept over half the width."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactcad.account import making

from . import elasticity
from .mapped_mesh import PlaneMesh, plane_mesh
from .plane_elements import Array, PlaneSolution, end_load, fixed_unknowns, solved
from .shape import ElementShape
from .space import AcrossSpace, PlaneSpace, line_load


@dataclass(frozen=True)
class SolidSolution:
    """Under unit force at the load line: compliance (mm/N), and displacements in mm, of shape (3, nodes of
    the plane, places across) in the order x, z, y.
    """

    compliance: float
    displacement: Array
    space: PlaneSpace
    across: AcrossSpace
    mesh: PlaneMesh
    unknowns: int
    youngs_modulus: float
    poisson: float

    @property
    def stiffness(self) -> float:
        """N/mm"""
        return 1.0 / self.compliance

    def flat(self, plane_strain: bool = False) -> PlaneSolution:
        """The same problem in plane stress or plane strain, by the same elements of the plane."""
        width = 2.0 * float(self.across.nodes[-1])
        return solved(self.youngs_modulus, self.poisson, width, self.mesh, self.space, plane_strain)


def solve_solid(
    shape: ElementShape,
    E: float,
    nu: float,
    width: float,
    *,
    density: int = 2,
    across: int | None = None,
    order: int = 2,
    order_across: int | None = None,
) -> SolidSolution:
    """Solid problem of an element: clamped at the body's end, shear of 1 N on the arm's end, parabolic in z.

    Parameters
    ----------
    shape
        Of the element, mm.
    E, nu
        Young's modulus, MPa, and Poisson's ratio.
    width
        Of the sheet, mm.
    density, order
        Of the plane's mesh, as for `plane_mesh`.
    across
        Density over the width, by default that of the plane.
    order_across
        Of the elements over the width, by default that in the plane.
    """
    across = across or density
    with making("elements", f"solid, density {density} and {across} across, order {order}"):
        mesh = plane_mesh(shape, density, order=order)
        space, sideways = (
            PlaneSpace.of(mesh),
            AcrossSpace.of(mesh, width / 2.0, across, order_across or order),
        )
        return _solved(mesh, space, sideways, E, nu, width)


def _solved(
    mesh: PlaneMesh, space: PlaneSpace, across: AcrossSpace, E: float, nu: float, width: float
) -> SolidSolution:
    A = space.swept_stiffness(across, *elasticity.lame(E, nu))
    places, count = len(across.nodes), space.nodes.shape[1]
    f = np.zeros((count, places, 3))
    end, along = end_load(space, mesh)
    sideways = line_load(across.nodes, lambda y: np.full_like(y, 1.0 / width), across.order)
    f[end, :, 1] = np.outer(along, sideways)
    nodes = np.stack([*np.repeat(space.nodes, places, axis=1), np.tile(across.nodes, count)])
    u = elasticity.solve(A, f.ravel(), fixed_unknowns(nodes, mesh, 3))
    # by symmetry the meshed part carries 1/2 or 1/4 of the force, and as much of the energy
    compliance = (4.0 if mesh.half else 2.0) * (f.ravel() @ u)
    u = np.moveaxis(u.reshape(count, places, 3), -1, 0)
    return SolidSolution(float(compliance), u, space, across, mesh, A.shape[0], E, nu)
