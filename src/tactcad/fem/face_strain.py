"""Strain and stress along the faces of the hinge at mid-width, from the displacements of their nodes."""

from __future__ import annotations

from dataclasses import astuple, dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from .elements import PlaneSolution, SolidSolution
from .shape import ElementShape
from .space import PlaneSpace, gauss, lagrange

Array = NDArray[np.float64]

DENSE = 16  # places searched for a peak or an end, for each point at which the elements are evaluated


@dataclass(frozen=True)
class FaceStrain:
    """Strain and stress per newton at points along one face, in the order of the face.

    along        length along the face from its end at the body, mm
    x            from the hinge's centre towards the arm, mm
    strain       tangential, 1/N; positive in tension, for a force that bends this face convex
    stress       tangential, MPa/N: the largest principal stress; as the others are at most half
                 of it, it is Tresca's too

    The points are Gauss points, where the elements' strains are most accurate; between them cubic splines.
    """

    along: Array
    x: Array
    strain: Array
    stress: Array

    @property
    def peak(self) -> float:
        """Largest strain on the face, 1/N."""
        return self.largest(self.strain)

    @property
    def peak_stress(self) -> float:
        """Largest stress on the face, MPa/N."""
        return self.largest(self.stress)

    @property
    def centre(self) -> float:
        """Strain at the hinge's centre, 1/N."""
        return float(CubicSpline(self.along, self.strain)(self._at(np.zeros(1)))[0])

    def mean(self, grid: Array | float) -> Array:
        """Mean over |x| <= grid/2, weighted by face length, 1/N: the strain that gauges with these grids
        read.
        """
        ends = self._at(np.multiply.outer((-0.5, 0.5), grid))
        integral = CubicSpline(self.along, self.strain).antiderivative()(ends)
        return (integral[1] - integral[0]) / (ends[1] - ends[0])

    def largest(self, values: Array) -> float:
        """Largest value of a quantity that is given at the points."""
        near = slice(max(0, (at := int(values.argmax())) - 1), at + 2)
        places = np.linspace(self.along[near][0], self.along[near][-1], 2 * DENSE + 1)
        return float(CubicSpline(self.along, values)(places).max())

    def _at(self, x: Array) -> Array:
        """Length along the face at places x."""
        return np.interp(x, *self._places)

    @cached_property
    def _places(self) -> tuple[Array, Array]:
        count = len(self.along)
        along = np.interp(np.arange(DENSE * (count - 1) + 1) / DENSE, np.arange(count), self.along)
        return CubicSpline(self.along, self.x)(along), along


@dataclass(frozen=True)
class SurfaceReadings:
    """Strains and stresses of a hinge at mid-width per newton: the mean strain (1/N) under grids on the gauge
    face, and the largest strain (1/N) and principal stress (MPa/N) on the gauge face and on the slot's.
    """

    gauge: Array
    face_strain: float
    face_stress: float
    fillet_strain: float
    fillet_stress: float

    def __mul__(self, other: SurfaceReadings) -> SurfaceReadings:
        return SurfaceReadings(*(a * b for a, b in zip(astuple(self), astuple(other), strict=True)))

    def __truediv__(self, other: SurfaceReadings) -> SurfaceReadings:
        return SurfaceReadings(*(a / b for a, b in zip(astuple(self), astuple(other), strict=True)))


def readings(solution: PlaneSolution | SolidSolution, grid_length: Array | float) -> SurfaceReadings:
    """Strains and stresses per newton, read off a solution.

    Parameters
    ----------
    solution
        Under a unit force.
    grid_length : scalar or ndarray, shape (n,)
        Of the gauges' grids, mm.
    """
    slot, flat = face_strain(solution, "slot"), face_strain(solution, "flat")
    return SurfaceReadings(flat.mean(grid_length), flat.peak, flat.peak_stress, slot.peak, slot.peak_stress)


def solid_readings(
    plane: PlaneSolution, solids: tuple[SolidSolution, ...], grid_length: Array | float
) -> SurfaceReadings:
    """Strains and stresses per newton of the solid, on the mesh of a solution in plane stress.

    They are the readings in plane stress, times the ratio of solid to plane stress with the same coarser
    elements, times the change by elements of a higher order across the width.

    Parameters
    ----------
    plane
        In plane stress, on the finest mesh.
    solids
        As in `convergence.Converged`: the finest in the plane; then two coarser ones there, the first of a
        higher order across, the second of the finest's.
    grid_length : scalar or ndarray, shape (n,)
        Of the gauges' grids, mm.
    """
    fine, across, coarse = (readings(s, grid_length) for s in solids)
    flat = readings(solids[0].flat(), grid_length)
    return readings(plane, grid_length) * fine / flat * across / coarse


def face_strain(solution: PlaneSolution | SolidSolution, face: str) -> FaceStrain:
    """Strain and stress along one face of the hinge, from wall to wall of the slot; on a flat face over its
    length.

    Parameters
    ----------
    solution
        Under a unit force; a solid is read on its mid-plane y = 0.
    face
        "slot" (upper floor with its fillets), or "flat" (below the hinge). A two-sided hinge has slots on
        both sides with opposite strains; its "flat" face is the lower one.
    """
    space, shape = solution.space, solution.mesh.shape
    upper = face == "slot" or shape.two_sided
    walls = shape.arm.slot_corner(upper=True).wall, shape.body.slot_corner(upper=True).wall
    direction = 1.0 if shape.arm.end > shape.body.end else -1.0
    x = direction * (space.nodes[0] - sum(walls) / 2.0)
    edges = _in_order(_face_edges(space, shape, upper), x)
    points, _ = gauss(space.order)
    value, slope = lagrange(space.order, points)
    u = solution.displacement[:2].reshape(2, space.nodes.shape[1], -1)[:, :, 0]  # at mid-width
    tangent, moved = (np.einsum("cen,nq->ceq", q[:, edges], slope) for q in (space.nodes, u))
    speed = np.hypot(*tangent)
    # a force towards +z compresses the upper face
    sign = -1.0 if upper else 1.0
    strain = sign * np.sum(tangent * moved, axis=0) / speed**2
    E, nu = solution.youngs_modulus, solution.poisson
    if isinstance(solution, SolidSolution):
        across = sign * np.einsum("en,nq->eq", _strain_across(solution)[edges], value)
    else:
        across = np.zeros_like(strain) if solution.plane_strain else -nu * strain
    stress = E / (1.0 - nu * nu) * (strain + nu * across)
    columns = _lengths(speed), np.einsum("en,nq->eq", x[edges], value), strain, stress
    return FaceStrain(*(q.ravel() for q in columns))


def _strain_across(solution: SolidSolution) -> Array:
    """d u_y/dy at mid-width at the plane's nodes.

    u_y is odd in y. An odd polynomial through the nodes of the first element gives its slope at y = 0 more
    accurately than the element's own shape functions.
    """
    first = slice(1, solution.across.order + 1)
    y = solution.across.nodes[first]
    return solution.displacement[2][:, first] @ np.linalg.inv(y[:, None] ** (2 * np.arange(len(y)) + 1))[0]


def _face_edges(space: PlaneSpace, shape: ElementShape, upper: bool) -> NDArray[np.int64]:
    """Nodes of the elements' edges on the hinge's face."""
    edges = space.edges
    x, z = space.nodes[:, edges]
    near = 1e-9 * np.ptp(space.nodes[0])
    if not upper:
        return edges[np.all(np.abs(z - shape.low) < near, axis=1)]
    on = np.abs(z - shape.high) < near
    fillets = [shape.arm.slot_corner(upper=True), shape.body.slot_corner(upper=True)]
    inside = (x > min(f.wall for f in fillets) - near) & (x < max(f.wall for f in fillets) + near)
    faces = np.all(on & inside, axis=1)
    for block, fillet in zip((shape.arm, shape.body), fillets):
        outward = 1.0 if block.end > fillet.wall else -1.0
        centre = (fillet.wall - outward * fillet.radius, shape.high + fillet.radius)
        radius = np.hypot(x - centre[0], z - centre[1])
        quarter = (outward * (x - centre[0]) > -near) & (z < centre[1] + near)
        faces |= np.all((np.abs(radius - fillet.radius) < near) & quarter, axis=1)
    return edges[faces]


def _in_order(edges: NDArray[np.int64], x: Array) -> NDArray[np.int64]:
    """The edges one after the other towards rising x, as their nodes."""
    edges = np.where((x[edges[:, 0]] > x[edges[:, -1]])[:, None], edges[:, ::-1], edges)
    return edges[np.argsort(x[edges[:, 0]])]


def _lengths(speed: Array) -> Array:
    """Length along the face (mm) of every Gauss point, from how fast each edge runs there."""
    points, weights = gauss(speed.shape[1])
    powers = np.vander(np.array(points), increasing=True)
    exponents = np.arange(1, len(points) + 1)
    # integrals from -1 to each point of the polynomials through the points
    rising = (
        (np.array(points)[:, None] ** exponents - (-1.0) ** exponents) / exponents @ np.linalg.inv(powers)
    )
    edges = speed @ weights
    return (np.cumsum(edges) - edges)[:, None] + speed @ rising.T
