"""How far a mesh is from converged: observed rates, Richardson's estimate, and the rungs made with them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import log

from .plane import PlaneSolution, solve_plane
from .shape import HingeShape
from .solid import SolidSolution, solve_solid

# Of nine-node elements' energy on this geometry, observed: 4 but for the clamp's corners (tests/fem).
ORDER = 4.0
PLANE_DENSITIES = (3, 6)
SOLID_DENSITY = 2
SOLID_ACROSS = 1


@dataclass(frozen=True)
class Refinement:
    """Compliances (mm/N) on meshes of growing density, each the double of the one before."""

    densities: tuple[int, ...]
    unknowns: tuple[int, ...]
    compliance: tuple[float, ...]

    @property
    def rates(self) -> tuple[float, ...]:
        """Observed orders: log of the ratio of successive changes to the base of the density's ratio."""
        changes = [b - a for a, b in zip(self.compliance, self.compliance[1:])]
        ratio = log(self.densities[1] / self.densities[0])
        return tuple(log(abs(a / b)) / ratio for a, b in zip(changes, changes[1:]))

    @property
    def extrapolated(self) -> float:
        """Richardson's compliance from the last two meshes, by the last observed order or the known one."""
        order = self.rates[-1] if self.rates else ORDER
        return richardson(self.compliance[-2:], self.densities[-2:], order)

    @property
    def error(self) -> float:
        """Relative error of the finest mesh by Richardson's estimate."""
        return self.compliance[-1] / self.extrapolated - 1.0


def richardson(compliance: tuple[float, float], densities: tuple[int, int], order: float) -> float:
    """Limit of c(h) = c + k h^order from two meshes, mm/N."""
    coarse, fine = compliance
    return fine + (fine - coarse) / ((densities[1] / densities[0]) ** order - 1.0)


def refine(solve: Callable[[int], PlaneSolution | SolidSolution], densities: tuple[int, ...]) -> Refinement:
    """Solve on each density."""
    solutions = [solve(d) for d in densities]
    return Refinement(densities, tuple(s.unknowns for s in solutions), tuple(s.compliance for s in solutions))


@dataclass(frozen=True)
class Converged:
    """Compliance (mm/N), its estimated relative error, and the finest solution behind it."""

    compliance: float
    error: float
    solution: PlaneSolution | SolidSolution

    @property
    def stiffness(self) -> float:
        """N/mm"""
        return 1.0 / self.compliance


def converged_plane(
    shape: HingeShape, E: float, nu: float, width: float, *, plane_strain: bool = False
) -> Converged:
    """Rung fem-plane: two meshes and Richardson's limit; the error is what the limit adds to the finer."""
    pair = [solve_plane(shape, E, nu, width, density=d, plane_strain=plane_strain) for d in PLANE_DENSITIES]
    limit = richardson((pair[0].compliance, pair[1].compliance), PLANE_DENSITIES, ORDER)
    return Converged(limit, abs(limit / pair[1].compliance - 1.0), pair[1])


def converged_solid(shape: HingeShape, E: float, nu: float, width: float) -> Converged:
    """Rung fem-solid: the solid's compliance, corrected by the plane problem's error on the same mesh.

    The solid mesh is the plane mesh swept over the width, so that both miss the fillets by the same
    share: C3D = C3D_h C2D/C2D_h. What is left is the error across the width.
    """
    solid = solve_solid(shape, E, nu, width, density=SOLID_DENSITY, across=SOLID_ACROSS)
    on_mesh = solve_plane(shape, E, nu, width, density=SOLID_DENSITY)
    limit = converged_plane(shape, E, nu, width)
    correction = limit.compliance / on_mesh.compliance
    coarse = solve_solid(shape, E, nu, width, density=1, across=SOLID_ACROSS)
    coarse_factor = coarse.compliance / solve_plane(shape, E, nu, width, density=1).compliance
    change = solid.compliance / on_mesh.compliance / coarse_factor - 1.0
    return Converged(solid.compliance * correction, abs(change), solid)
