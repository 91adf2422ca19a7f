"""The leaf with its bonded gauge, by plane elements: adhesive, backing and foil as separate layers; and the
leaf under a clamp's pressure on the gauge.

Each layer transfers load to the next by shear, over its length only. The closed form of
`mechanics.gauge_signal.composite`, with plane sections over the whole hinge, neglects that.

The clamp: plane stress on the element's own section. The pressure acts on the gauge's face, over the clamp's
rubber. If `backed`, the leaf's other face lies on a tongue in the slot, and the rear body on its rest: two
supports, so that errors of their heights do not bend the leaf. Otherwise the body is fixed and arm and leaf
hang from it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tactcad.mechanics.section import HingeSection

from . import elasticity
from .elements import PlaneSolution, end_load, fixed_unknowns
from .face_strain import face_strain
from .mapped_mesh import PlaneMesh, plane_mesh
from .shape import reference_shape
from .space import PlaneSpace, gauss, lagrange

Array = NDArray[np.float64]

# Stiffening within 3 %, the clamp's stress within 4 % of finer meshes (tests/fem).
ORDER, DENSITY = 3, 2
SLIVER = 1e-6  # of an element: less is rounding
POLYMER = 0.35  # Poisson's ratio of layers: of polyimide and cured adhesives; it hardly matters


@dataclass(frozen=True)
class Layer:
    """A layer on the gauge's face, over the one before: thickness (mm), Young's modulus (MPa), width across
    the element (mm), and how far it reaches from the hinge's middle towards pad and clamp (mm)."""

    thickness: float
    modulus: float
    width: float
    reach: tuple[float, float]


def stiffness(s: HingeSection, layers: Sequence[Layer]) -> float:
    """Tip stiffness of one element (scalars) with its layers, N/mm, in plane stress.

    An element in which a layer ends carries by the share of it that the layer covers.
    """
    bare = plane_mesh(reference_shape(s), DENSITY, whole=True, order=ORDER)
    b = float(s.width)
    groups = [(bare.cells, float(s.youngs_modulus), float(s.poisson))]
    face = bare.shape.low
    # x of the nodes of every element's edge on the gauge's face, (edges, order + 1), rising
    sides = np.concatenate([bare.cells[:, :, 0], bare.cells[:, :, -1], bare.cells[:, 0], bare.cells[:, -1]])
    on = np.all(np.abs(sides[..., 1] - bare.shape.low) < 1e-9 * np.ptp(bare.cells[..., 0]), axis=1)
    x = sides[on][..., 0]
    x = np.where((x[:, 0] > x[:, -1])[:, None], x[:, ::-1], x)
    edges = x[np.argsort(x[:, 0])]
    for layer in layers:
        covered = _covered(edges, layer.reach)
        for share in np.unique(covered[covered > 0.0]):
            cells = _cells(edges[covered == share], face, layer.thickness)
            groups.append((cells, float(share) * layer.modulus * layer.width / b, POLYMER))
        face -= layer.thickness
    mesh = replace(bare, cells=np.concatenate([cells for cells, _, _ in groups]))
    space = PlaneSpace.of(mesh)
    parts = np.split(space.elements, np.cumsum([len(cells) for cells, _, _ in groups])[:-1])
    A = sum(
        PlaneSpace(space.nodes, own).stiffness(*elasticity.lame(E, nu, plane_stress=True)) * b
        for own, (_, E, nu) in zip(parts, groups, strict=True)
    )
    f = np.zeros(A.shape[0])
    end, load = end_load(space, mesh)
    f[2 * end + 1] = load
    u = elasticity.solve(A, f, fixed_unknowns(space.nodes, mesh, 2))
    return float(1.0 / (f @ u))


def _covered(edges: Array, reach: tuple[float, float]) -> Array:
    """Share of each edge that lies within reach."""
    to_arm, to_body = reach
    x0, x1 = edges[:, 0], edges[:, -1]
    over = np.minimum(x1, to_arm) - np.maximum(x0, -to_body)
    share = np.clip(over / (x1 - x0), 0.0, 1.0)
    return np.where(share > SLIVER, share, 0.0)


def _cells(edges: Array, face: float, thickness: float) -> Array:
    """One element under each edge, (edges, order + 1, order + 1, 2)."""
    z = face - thickness * np.linspace(0.0, 1.0, edges.shape[1])
    return np.stack(np.broadcast_arrays(edges[:, :, None], z), axis=-1)


POINTS = 40  # Gauss points for each edge: a pressure that ends inside one is met to some per mille


@dataclass(frozen=True)
class Clamped:
    """The leaf under a pressure of 1 MPa.

    stress        largest on its two faces, MPa; not where the tongue's edges touch, which give way
    gauge_strain  mean over the grid on the gauge's face
    on_tongue     force, N; 0 if it does not back the leaf
    """

    stress: float
    gauge_strain: float
    on_tongue: float


def clamped(
    s: HingeSection,
    rubber: tuple[float, float],
    width: float,
    grid_length: float,
    tongue: float | None = None,
) -> Clamped:
    """One element under 1 MPa.

    Parameters
    ----------
    s
        One element (scalars); its body ends at the rest if the leaf is backed, else at its fixed end.
    rubber
        Reach of the pressed stretch from the hinge's middle towards the pad, and towards the clamp, mm.
    width
        Of the rubber across the element, mm.
    grid_length
        Of the gauge's grid, mm.
    tongue
        Flat length of its tip, mm; None: the leaf is not backed.

    Raises
    ------
    CheckFailure
        If the leaf is too long and thin for these elements, or the mesh does not reach the design.
    """
    mesh = plane_mesh(reference_shape(s), DENSITY, whole=True, order=ORDER)
    space = PlaneSpace.of(mesh)
    E, nu, b = float(s.youngs_modulus), float(s.poisson), float(s.width)
    A = space.stiffness(*elasticity.lame(E, nu, plane_stress=True)) * b
    f = np.zeros(A.shape[0])
    f[1::2] = width * pressed(space, mesh, rubber)
    if tongue is None:
        clamped = np.flatnonzero(np.abs(space.nodes[0] - mesh.clamp_x) < 1e-9 * np.ptp(space.nodes[0]))
        fixed = np.unique(np.concatenate([2 * clamped, 2 * clamped + 1]))
    else:
        fixed = _lain(space, mesh, tongue)
    u = elasticity.solve(A, f, fixed)
    on_tongue = 0.0
    if tongue is not None:
        reactions = (A @ u - f)[_tip(space, mesh, tongue) * 2 + 1]
        on_tongue = -float(reactions.sum())
    solution = PlaneSolution(np.nan, u.reshape(-1, 2).T, space, mesh, len(u), E, nu, False)
    flat, slot = face_strain(solution, "flat"), face_strain(solution, "slot")
    free = np.abs(slot.x) > ((tongue or 0.0) + float(s.hinge_thickness)) / 2
    stress = np.abs(np.concatenate([flat.stress, slot.stress[free]])).max()
    return Clamped(float(stress), float(flat.mean(grid_length)), on_tongue)


def pressed(space: PlaneSpace, mesh: PlaneMesh, rubber: tuple[float, float]) -> Array:
    """Nodal forces along z (N for 1 mm of width) of 1 MPa on the hinge's lower face."""
    x, z = space.nodes
    size = np.ptp(x)
    edges = space.edges
    edges = edges[np.all(np.abs(z[edges] - mesh.shape.low) < 1e-9 * size, axis=1)]
    edges = np.unique(edges[np.arange(len(edges))], axis=0)
    points, weights = gauss(POINTS)
    value, slope = lagrange(space.order, points)
    to_arm, to_body = rubber
    at, step = x[edges] @ value, np.abs(x[edges] @ slope)
    inside = (at <= to_arm) & (at >= -to_body)
    f = np.zeros(len(x))
    np.add.at(f, edges, (inside * step * weights) @ value.T)
    return f


def _lain(space: PlaneSpace, mesh: PlaneMesh, tongue: float) -> Array:
    """On the tongue along z, one of its nodes along x too; at the body's far upper corner along z."""
    tip = _tip(space, mesh, tongue)
    x, z = space.nodes
    corner = np.argmin(np.hypot(x - mesh.clamp_x, z - mesh.shape.body.high))
    middle = tip[np.argmin(np.abs(x[tip]))]
    return np.unique(np.concatenate([2 * tip + 1, [2 * middle, 2 * corner + 1]]))


def _tip(space: PlaneSpace, mesh: PlaneMesh, tongue: float) -> NDArray[np.int64]:
    """Nodes of the slot's floor on the tongue's tip; the middle one if the tip is narrower than their
    spacing."""
    x, z = space.nodes
    near = 1e-9 * np.ptp(x)
    walls = mesh.shape.arm.slot_corner(upper=True), mesh.shape.body.slot_corner(upper=True)
    inside = (x < max(w.wall for w in walls)) & (x > min(w.wall for w in walls))
    floor = np.flatnonzero(inside & (np.abs(z - mesh.shape.high) < near))
    if not len(floor):  # a full round's fillets meet in its lowest point
        floor = np.flatnonzero(inside)[[np.argmin(np.abs(z[inside] - mesh.shape.high))]]
    on = floor[np.abs(x[floor]) <= tongue / 2 + near]
    return on if len(on) else floor[[np.argmin(np.abs(x[floor]))]]
