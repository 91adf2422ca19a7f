"""The finite-element rungs by name, with the gauge's strain and the fillet's peak, for one element; how far a
mesh is from converged: observed rates, Richardson's estimate, and the rungs made with them."""

from __future__ import annotations

import logging
from dataclasses import dataclass, fields

import numpy as np

from tactcad.design.messages import CheckFailure
from tactcad.mechanics.ladder import require_range
from tactcad.mechanics.register import rungs
from tactcad.mechanics.section import HingeSection, friction_factor

from .elements import PlaneSolution, SolidSolution, solve_plane, solve_solid
from .face_strain import SurfaceReadings, readings, solid_readings
from .shape import ElementShape, reference_shape

# Of the elements of one solution: within 0.02 % of the converged value in the plane, 0.2 % as a solid.
ORDER, SOLID_ORDER = 4, 3
PLANE_DENSITIES = (1, 2)
# Rate of the energy on these meshes, observed: 3.3 to 4.4, limited by the clamp's corners and by the fillets'
# ends, where the faces' curvature jumps (tests/fem).
RATE = 4.0
SOLID_MESH = 2  # of fem-solid, if none is asked for
ACROSS = 2  # order of the elements over the width, with the finest in the plane
# Factor by which doubling the elements' order reduces the error of the solid's share between plane stress and
# plane strain: observed 37 or more over the range's corners (tests/fem).
GAIN = 16.0
NO_POISSON = 1e-9  # relative: with nu = 0 plane stress, plane strain and the solid are the same problem


@dataclass(frozen=True)
class ElementResult:
    """Result for one element: stiffness (N/mm, friction at the pad included), its estimated relative error
    from the mesh, and strains and stresses per newton, at mid-width (`readings`) and in plane stress
    (`flat`). By equilibrium the stress in plane stress is the mean over a solid's width.
    """

    stiffness: float
    error: float
    readings: SurfaceReadings
    flat: SurfaceReadings


@dataclass(frozen=True)
class Converged:
    """Compliance (mm/N), its estimated relative error, and the solutions behind it.

    plane     plane stress, on the finest mesh
    solids    of a solid, otherwise empty: the finest in the plane; then two on the plane's coarsest mesh, the
              first with finer elements across, the second with the finest's
    """

    compliance: float
    error: float
    plane: PlaneSolution
    solids: tuple[SolidSolution, ...] = ()

    @property
    def stiffness(self) -> float:
        """N/mm"""
        return 1.0 / self.compliance


def stiffness(s: HingeSection, rung: str, mesh: int = SOLID_MESH) -> float:
    """Tip stiffness of one reference element by a finite-element rung, friction at the pad included, N/mm.

    Parameters
    ----------
    s
        One design (scalars).
    rung
        "fem-plane" or "fem-solid".
    mesh
        Half the order of fem-solid's finest elements in the plane.

    Raises
    ------
    CheckFailure
        If the design is impossible or the mesh cannot follow it.
    """
    return converged(s, rung, mesh=mesh).stiffness * float(friction_factor(s))


def converged(
    s: HingeSection, rung: str, shape: ElementShape | None = None, mesh: int = SOLID_MESH
) -> Converged:
    """The rung's solution on the shape cut from a contour, or on the reference shape."""
    require_range(s, rung)
    if not float(s.fillet_radius) > 0.0:
        raise CheckFailure(f"rung {rung} needs rounded slot corners: fillet_radius is 0")
    E, nu, b = float(s.youngs_modulus), float(s.poisson), float(s.width)
    shape = shape or reference_shape(s)
    declared = rungs()[rung]
    assert declared.elements is not None
    chosen = {} if declared.meshes == (None,) else {"mesh": mesh}
    return declared.elements(shape, E, nu, b, **chosen)


def solve(
    s: HingeSection, rung: str, grid_length: float, shape: ElementShape | None = None, mesh: int = SOLID_MESH
) -> ElementResult:
    """Stiffness, strains and stresses of one element by a finite-element rung.

    Parameters
    ----------
    s
        One design (scalars).
    rung
        "fem-plane" or "fem-solid".
    grid_length
        Of the gauge's grid, mm.
    shape
        The shape cut from the element's contour; by default the reference shape.
    mesh
        Half the order of fem-solid's finest elements in the plane.

    Raises
    ------
    CheckFailure
        If the design is impossible or the mesh cannot follow it.
    """
    solution = converged(s, rung, shape, mesh)
    flat = readings(solution.plane, grid_length)
    read = solid_readings(solution.plane, solution.solids, grid_length) if solution.solids else flat
    return ElementResult(solution.stiffness * float(friction_factor(s)), solution.error, read, flat)


def richardson(compliance: tuple[float, float], densities: tuple[int, int], order: float) -> float:
    """Limit of c(h) = c + k h^order from two meshes, mm/N.

    Parameters
    ----------
    compliance
        On the two meshes, mm/N.
    densities
        Of the two meshes, inversely proportional to h.
    order
        Rate of convergence.
    """
    coarse, fine = compliance
    return fine + (fine - coarse) / ((densities[1] / densities[0]) ** order - 1.0)


def converged_plane(
    shape: ElementShape, E: float, nu: float, width: float, *, plane_strain: bool = False
) -> Converged:
    """Rung fem-plane: Richardson's limit of two meshes.

    Parameters
    ----------
    shape
        Of the element, mm.
    E, nu
        Young's modulus, MPa, and Poisson's ratio.
    width
        Of the sheet, mm.
    plane_strain
        Instead of plane stress.

    Returns
    -------
    Converged
        Its error is the difference between the limit and the finer mesh.
    """
    pair = [
        solve_plane(shape, E, nu, width, density=d, order=ORDER, plane_strain=plane_strain)
        for d in PLANE_DENSITIES
    ]
    limit = richardson((pair[0].compliance, pair[1].compliance), PLANE_DENSITIES, RATE)
    return Converged(limit, abs(limit / pair[1].compliance - 1.0), pair[1])


def converged_solid(
    shape: ElementShape, E: float, nu: float, width: float, *, mesh: int = SOLID_MESH
) -> Converged:
    """Rung fem-solid.

    On one mesh of the plane the solid's compliance lies between plane stress and plane strain, at the share
    chi = (C_stress - C_solid)/(C_stress - C_strain). It converges faster than the compliances, since the
    three problems have nearly the same relative error at the fillets. Three steps: chi by the finest elements
    in the plane; its change by elements of a higher order across the width, found with quadratic elements in
    the plane, which is cheap; and the limits of plane stress and plane strain, between which chi
    interpolates.

    Parameters
    ----------
    shape
        Of the element, mm.
    E, nu
        Young's modulus, MPa, and Poisson's ratio.
    width
        Of the sheet, mm.
    mesh
        Half the order of the finest elements in the plane.
    """
    stress, strain = (converged_plane(shape, E, nu, width, plane_strain=p) for p in (False, True))

    orders = (2 * mesh, ACROSS), (2, ACROSS * mesh), (2, ACROSS)  # in the plane, across
    solids = tuple(solve_solid(shape, E, nu, width, density=1, order=n, order_across=m) for n, m in orders)
    if abs(stress.compliance - strain.compliance) < NO_POISSON * stress.compliance:
        return Converged(stress.compliance, stress.error, stress.plane, solids)
    fine, across, coarse = (_share(solid) for solid in solids)
    limit = stress.compliance - (fine + across - coarse) * (stress.compliance - strain.compliance)
    left = abs(fine - coarse) * (stress.compliance - strain.compliance) / GAIN
    return Converged(limit, left / limit + stress.error, stress.plane, solids)


def _share(solid: SolidSolution) -> float:
    """The solid's share between plane stress (0) and plane strain (1), by the same elements of the plane."""
    stress, strain = (solid.flat(plane_strain).compliance for plane_strain in (False, True))
    return (stress - solid.compliance) / (stress - strain)


def stiffnesses(s: HingeSection) -> dict[str, np.ndarray]:
    """K (N/mm) of every element by the rungs fem-plane and fem-solid, each element cut at its load line."""
    logging.getLogger("skfem").setLevel(logging.ERROR)  # it warns about the order of arrays in memory
    columns = [np.broadcast_to(getattr(s, f.name), s.shape) for f in fields(s)]
    distinct, index = np.unique(np.column_stack(columns).astype(float), axis=0, return_inverse=True)
    K = {"fem-plane": np.empty(len(distinct)), "fem-solid": np.empty(len(distinct))}
    for i, row in enumerate(distinct):
        one = HingeSection.of(**dict(zip((f.name for f in fields(s)), row)))
        shape = reference_shape(one)
        material = (float(one.youngs_modulus), float(one.poisson), float(one.width))
        K["fem-plane"][i] = solve_plane(shape, *material, density=1, order=ORDER).stiffness
        K["fem-solid"][i] = solve_solid(
            shape, *material, density=1, order=SOLID_ORDER, order_across=2
        ).stiffness
    return {name: values[index.ravel()] for name, values in K.items()}
