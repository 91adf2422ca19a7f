"""Plane elements (rung fem-plane: plane stress or strain) and the plane mesh swept over half the width (rung
fem-solid)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tactcad.profiling import making

from . import elasticity
from .mapped_mesh import PlaneMesh, plane_mesh
from .shape import ElementShape
from .space import AcrossSpace, PlaneSpace, line_load

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PlaneSolution:
    """Under unit force at the load line: compliance (mm/N), displacements (2, nodes) in mm and the space."""

    compliance: float
    displacement: Array
    space: PlaneSpace
    mesh: PlaneMesh
    unknowns: int
    youngs_modulus: float
    poisson: float
    plane_strain: bool

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
    order: int = 2,
    plane_strain: bool = False,
    whole: bool = False,
) -> PlaneSolution:
    """Plane problem of an element: clamped at the body's end, parabolic shear of 1 N on the arm's end.

    Parameters
    ----------
    shape
        Of the element, mm.
    E, nu
        Young's modulus, MPa, and Poisson's ratio.
    width
        Of the sheet, mm.
    density, order, whole
        Of the mesh, as for `plane_mesh`.
    plane_strain
        Instead of plane stress.

    Returns
    -------
    PlaneSolution
        Its compliance is that of the work-conjugate deflection.
    """
    with making("elements", f"plane, density {density}, order {order}"):
        mesh = plane_mesh(shape, density, whole, order)
        return solved(E, nu, width, mesh, PlaneSpace.of(mesh), plane_strain)


def solved(
    E: float, nu: float, width: float, mesh: PlaneMesh, space: PlaneSpace, plane_strain: bool
) -> PlaneSolution:
    """`solve_plane` on a given mesh and its space."""
    A = space.stiffness(*elasticity.lame(E, nu, plane_stress=not plane_strain)) * width
    f = np.zeros(A.shape[0])
    end, load = end_load(space, mesh)
    f[2 * end + 1] = load
    u = elasticity.solve(A, f, fixed_unknowns(space.nodes, mesh, 2))
    # the mirrored half carries the other half of the force, and as much energy
    compliance = (2.0 if mesh.half else 1.0) * (f @ u)
    u = u.reshape(-1, 2).T
    return PlaneSolution(float(compliance), u, space, mesh, A.shape[0], E, nu, plane_strain)


def end_load(space: PlaneSpace, mesh: PlaneMesh) -> tuple[NDArray[np.int64], Array]:
    """Nodes on the arm's end, sorted by z, and the parabolic shear's forces there, N."""
    x, z = space.nodes
    end = np.flatnonzero(np.abs(x - mesh.load_x) < 1e-9 * np.ptp(x))
    end = end[np.argsort(z[end])]
    return end, line_load(z[end], lambda z: parabola(z, mesh), space.order)


def parabola(z: Array, mesh: PlaneMesh) -> Array:
    """Shear traction per unit width of a unit force: 6 (z - low)(high - z)/h^3."""
    low, high = mesh.shape.arm.low, mesh.shape.arm.high
    return 6.0 * (z - low) * (high - z) / (high - low) ** 3


def fixed_unknowns(nodes: Array, mesh: PlaneMesh, dim: int) -> Array:
    """Unknowns fixed at zero: all at the body's end; on y = 0, by symmetry, those across.

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
        space = PlaneSpace.of(mesh)
        sideways = AcrossSpace.of(mesh, width / 2.0, across, order_across or order)
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
