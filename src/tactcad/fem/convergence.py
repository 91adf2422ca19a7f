"""How far a mesh is from converged: observed rates, Richardson's estimate, and the rungs made with them."""

from __future__ import annotations

from dataclasses import dataclass

from .plane_elements import PlaneSolution, solve_plane
from .shape import ElementShape
from .solid_elements import SolidSolution, solve_solid

# Of nine-node elements' energy on this geometry, observed: 4 but for the clamp's corners (tests/fem).
ORDER = 4.0
PLANE_DENSITIES = (3, 6)
SOLID_MESH = 2  # of fem-solid, where none is asked for
# Of the solid's share between plane stress and plane strain, observed: 1.9 to 3.3 over 28 designs of the
# box's edges and of the whole range (measured on densities 1, 2 and 4).
SHARE_ORDER = 2.5
NO_POISSON = 1e-9  # relative: plane stress and plane strain are one problem, and so is the solid


def richardson(compliance: tuple[float, float], densities: tuple[int, int], order: float) -> float:
    """Limit of c(h) = c + k h^order from two meshes, mm/N."""
    coarse, fine = compliance
    return fine + (fine - coarse) / ((densities[1] / densities[0]) ** order - 1.0)


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
    shape: ElementShape, E: float, nu: float, width: float, *, plane_strain: bool = False
) -> Converged:
    """Rung fem-plane: two meshes and Richardson's limit; the error is what the limit adds to the finer."""
    pair = [solve_plane(shape, E, nu, width, density=d, plane_strain=plane_strain) for d in PLANE_DENSITIES]
    limit = richardson((pair[0].compliance, pair[1].compliance), PLANE_DENSITIES, ORDER)
    return Converged(limit, abs(limit / pair[1].compliance - 1.0), pair[1])


def converged_solid(
    shape: ElementShape, E: float, nu: float, width: float, *, mesh: int = SOLID_MESH
) -> Converged:
    """Rung fem-solid on meshes of density mesh - 1 and `mesh` (2 or 3); `error` is what the limit adds to the
    finer.

    On one mesh of the plane the solid stands between plane stress and plane strain, at the share
    chi = (C_stress - C_solid)/(C_stress - C_strain), which converges faster than the compliances: the three
    problems miss the fillets by nearly the same share. Three steps: chi's limit in the plane by Richardson;
    what finer meshes across the width add to it, found on the coarsest mesh in the plane, where it is cheap;
    and the limits of plane stress and plane strain between which it stands.
    """
    stress, strain = (converged_plane(shape, E, nu, width, plane_strain=p) for p in (False, True))
    fine = solve_solid(shape, E, nu, width, density=mesh, across=1)
    if abs(stress.compliance - strain.compliance) < NO_POISSON * stress.compliance:
        return Converged(stress.compliance, stress.error, fine)
    shares = {
        (density, across): _share(shape, E, nu, width, density, across)
        for density, across in {(1, 1), (1, 2), (mesh - 1, 1)}
    } | {(mesh, 1): _share_of(fine, shape, E, nu, width, mesh)}
    across = richardson((shares[1, 1], shares[1, 2]), (1, 2), ORDER) - shares[1, 1]
    in_plane = richardson((shares[mesh - 1, 1], shares[mesh, 1]), (mesh - 1, mesh), SHARE_ORDER)

    def between(share: float) -> float:
        return stress.compliance - share * (stress.compliance - strain.compliance)

    limit = between(in_plane + across)
    return Converged(limit, abs(between(shares[mesh, 1] + across) / limit - 1.0) + stress.error, fine)


def _share(shape: ElementShape, E: float, nu: float, width: float, density: int, across: int) -> float:
    solid = solve_solid(shape, E, nu, width, density=density, across=across)
    return _share_of(solid, shape, E, nu, width, density)


def _share_of(
    solid: SolidSolution, shape: ElementShape, E: float, nu: float, width: float, density: int
) -> float:
    """Where the solid stands between plane stress (0) and plane strain (1) of its own mesh in the plane."""
    stress, strain = (
        solve_plane(shape, E, nu, width, density=density, plane_strain=p).compliance for p in (False, True)
    )
    return (stress - solid.compliance) / (stress - strain)
