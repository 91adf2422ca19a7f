"""How far a finite-element solution can be trusted: angles of its elements, condition number, rounding
error.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import LinearOperator, onenormest

from tactcad.fem import elasticity
from tactcad.fem.mapped_mesh import PlaneMesh
from tactcad.fem.plane_elements import end_load, fixed_unknowns, solve_plane
from tactcad.fem.shape import ElementShape

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Health:
    """Quality of one plane mesh and of its system of equations. Angles in degrees, at the corners of the
    elements.

    condition: of the stiffness matrix without the held unknowns, in the 1-norm (by Hager's estimate, which is
    deterministic). rounding: relative change of the compliance by one step of iterative refinement, an
    estimate of its rounding error.
    """

    smallest_angle: float
    largest_angle: float
    condition: float
    rounding: float
    compliance: float  # mm/N
    unknowns: int


def plane_health(shape: ElementShape, E: float, nu: float, width: float, density: int) -> Health:
    """Of the plane-stress problem that `solve_plane` solves on that density."""
    solution = solve_plane(shape, E, nu, width, density=density)
    space, mesh = solution.space, solution.mesh
    A = space.stiffness(*elasticity.lame(E, nu, plane_stress=True)) * width
    end, load = end_load(space, mesh)
    f = np.zeros(A.shape[0])
    f[2 * end + 1] = load
    free = np.setdiff1d(np.arange(len(f)), fixed_unknowns(space.nodes, mesh, 2))
    reduced = A[free][:, free].tocsc()
    solve = elasticity.factorised(reduced).solve
    inverse = LinearOperator(reduced.shape, matvec=solve, rmatvec=solve, dtype=float)
    _, rounding = elasticity.refined(reduced, f[free])
    smallest, largest = corner_angles(mesh)
    return Health(
        smallest,
        largest,
        float(abs(reduced).sum(axis=0).max() * onenormest(inverse, t=1)),
        rounding,
        solution.compliance,
        solution.unknowns,
    )


def corner_angles(mesh: PlaneMesh) -> tuple[float, float]:
    """Smallest and largest angle between the two edges that meet at an element's corner, degrees.

    Edges are curved; the angle is that of the tangents of the parabola through an edge's corners and middle.
    """
    angles = []
    for u, v in ((0, 0), (0, 2), (2, 0), (2, 2)):
        corner = mesh.cells[:, u, v]
        along = 4.0 * mesh.cells[:, 1, v] - 3.0 * corner - mesh.cells[:, 2 - u, v]
        across = 4.0 * mesh.cells[:, u, 1] - 3.0 * corner - mesh.cells[:, u, 2 - v]
        cross = along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0]
        angles.append(np.degrees(np.arctan2(np.abs(cross), np.sum(along * across, axis=1))))
    return float(np.min(angles)), float(np.max(angles))
