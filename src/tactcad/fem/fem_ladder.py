"""The finite-element rungs by name, with the gauge's strain and the fillet's peak, for one element."""

from __future__ import annotations

from dataclasses import dataclass

from tactcad.design.messages import CheckFailure
from tactcad.mechanics import friction
from tactcad.mechanics.ladder import require_range
from tactcad.mechanics.section import HingeSection

from .convergence import SOLID_MESH, Converged, converged_plane, converged_solid
from .face_strain import SurfaceReadings, readings, solid_readings
from .shape import ElementShape, reference_shape


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
        Where the design is impossible or the mesh cannot follow it.
    """
    return converged(s, rung, mesh=mesh).stiffness * float(friction.factor(s))


def converged(
    s: HingeSection, rung: str, shape: ElementShape | None = None, mesh: int = SOLID_MESH
) -> Converged:
    """The rung's solution on the shape cut from a contour, or on the reference shape."""
    require_range(s, rung)
    if not float(s.fillet_radius) > 0.0:
        raise CheckFailure(f"rung {rung} needs rounded slot corners: fillet_radius is 0")
    E, nu, b = float(s.youngs_modulus), float(s.poisson), float(s.width)
    shape = shape or reference_shape(s)
    return (
        converged_plane(shape, E, nu, b)
        if rung == "fem-plane"
        else converged_solid(shape, E, nu, b, mesh=mesh)
    )


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
        Where the design is impossible or the mesh cannot follow it.
    """
    solution = converged(s, rung, shape, mesh)
    flat = readings(solution.plane, grid_length)
    read = solid_readings(solution.plane, solution.solids, grid_length) if solution.solids else flat
    return ElementResult(solution.stiffness * float(friction.factor(s)), solution.error, read, flat)
