"""A foil beam with filleted roots between a rigid island and a clamped frame, by solid elements.

The beam is symmetric in all three planes through its middle, so its ends' six relative motions do not mix,
and each is solved on an eighth of the beam: Lagrange elements of order 4 in the foil's plane and quadratic
through half its thickness (tactcad.fem.space). The root's fillet is tangent to the rigid edge.
"""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.typing import NDArray

from tactcad.design.messages import CheckFailure
from tactcad.fem import elasticity
from tactcad.fem.mapped_mesh import merged
from tactcad.fem.space import AcrossSpace, PlaneSpace

from .beam import MODES, FoilBeam

Array = NDArray[np.float64]
ORDER = 4
KEEP = 0.3  # fillet radii off the clamped edge: nearer, a rigid edge makes the stress grow without limit

# Components (x along, y across, z through the foil) that vanish on the planes x = 0, y = 0 and z = 0, and the
# motion of the end x = s/2 under a relative motion 1 of the two ends.
_PARITY = {
    "axial": ("x", "y", "z"),
    "twist": ("yz", "xz", "xy"),
    "bend_out": ("x", "y", "xy"),
    "shear_out": ("yz", "y", "xy"),
    "bend_in": ("x", "xz", "z"),
    "shear_in": ("yz", "xz", "z"),
}


def _end_motion(mode: str, y: Array, z: Array) -> Array:
    zero = np.zeros_like(y)
    return np.stack(
        {
            "axial": (zero + 0.5, zero, zero),
            "twist": (zero, -0.5 * z, 0.5 * y),
            "bend_out": (0.5 * z, zero, zero),
            "shear_out": (zero, zero, zero + 0.5),
            "bend_in": (0.5 * y, zero, zero),
            "shear_in": (zero, zero + 0.5, zero),
        }[mode]
    )


def quarter_mesh(beam: FoilBeam, density: int = 1) -> PlaneSpace:
    """The quarter 0 <= x <= s/2, y >= 0 of the beam's plane, rows graded towards its edge, columns towards
    root and fillet, mm."""
    half, w, r = beam.length / 2.0, beam.width / 2.0, beam.fillet
    straight, rows = half - r, 2 * density
    columns = max(2, round(2.5 * straight / beam.width)) * density
    turns = 3 * density
    cells = []
    across = 1.0 - (1.0 - np.linspace(0.0, 1.0, ORDER * rows + 1)) ** 1.5
    along = np.linspace(0.0, 1.0, ORDER * columns + 1)
    along = 1.0 - (1.0 - along) ** 1.3
    x = np.broadcast_to((straight * along)[:, None], (len(along), len(across)))
    cells.append(np.stack([x, np.broadcast_to(w * across, x.shape)], axis=-1))
    angle = np.linspace(0.0, pi / 2.0, ORDER * turns + 1)[:, None]
    blend = across**2  # the middle's columns are even, the edge's follow the arc
    x = straight + r * ((1.0 - blend) * angle / (pi / 2.0) + blend * np.sin(angle))
    edge = w + r * (1.0 - np.cos(angle))
    cells.append(np.stack([x, across * edge], axis=-1))
    blocks = [_split(grid) for grid in cells]
    every = np.concatenate(blocks)
    points, index = merged(every.reshape(len(every), -1, 2))
    return PlaneSpace(np.ascontiguousarray(points.T), index.reshape(len(every), ORDER + 1, ORDER + 1))


def _split(grid: Array) -> Array:
    """Elements of a block of nodes, each with its (ORDER + 1)^2 own."""
    nx, ny = ((n - 1) // ORDER for n in grid.shape[:2])
    step = np.arange(ORDER + 1)
    return np.array([grid[np.ix_(ORDER * i + step, ORDER * j + step)] for i in range(nx) for j in range(ny)])


def solved(beam: FoilBeam, density: int = 1) -> tuple[dict[str, float], dict[str, float]]:
    """Stiffness of every mode (N/mm; N mm a radian for bending and twist), and the largest von Mises stress
    of the foil's faces per unit of its relative motion (MPa/mm; MPa/rad)."""
    space = quarter_mesh(beam, density)
    count = space.nodes.shape[1]
    across = AcrossSpace(np.linspace(0.0, beam.thickness / 2.0, 3), 2)
    places = len(across.nodes)
    lam, mu = elasticity.lame(beam.youngs_modulus, beam.poisson)
    A = space.swept_stiffness(across, lam, mu)
    x, y = (np.repeat(v, places) for v in space.nodes)
    z = np.tile(across.nodes, count)
    planes = [np.abs(v) < 1e-9 for v in (x, y, z)]
    end = np.abs(x - beam.length / 2.0) < 1e-9
    component = {"x": 0, "y": 1, "z": 2}
    stiffness, stress = {}, {}
    for mode in MODES:
        u, held = np.zeros((len(x), 3)), np.zeros((len(x), 3), dtype=bool)
        for plane, letters in zip(planes, _PARITY[mode]):
            for letter in letters:
                held[plane, component[letter]] = True
        u[end] = _end_motion(mode, y[end], z[end]).T
        held[end] = True
        known, fixed = u.ravel(), held.ravel()
        free = ~fixed
        f = -(A[free][:, fixed] @ known[fixed])
        part, rounding = elasticity.refined(A[free][:, free].tocsc(), f)
        if not rounding <= elasticity.MOST_ROUNDING:
            raise CheckFailure(
                f"rounding moves mode {mode} by {rounding:.1g} of itself: the foil is too thin"
            )
        known[free] = part
        stiffness[mode] = float(8.0 * known @ (A @ known))
        stress[mode] = _largest_stress(
            space, known.reshape(count, places, 3), across, lam, mu, KEEP * beam.fillet
        )
    return stiffness, stress


def _largest_stress(
    space: PlaneSpace, u: Array, across: AcrossSpace, lam: float, mu: float, keep: float
) -> float:
    """Largest von Mises stress at the nodes of the foil's face, `keep` mm off the clamped edge."""
    order, top = space.order, len(across.nodes) - 1
    nodes = np.linspace(-1.0, 1.0, order + 1)
    V = np.vander(nodes, increasing=True)
    powers = np.zeros_like(V)
    powers[:, 1:] = V[:, :-1] * np.arange(1, order + 1)
    D = powers @ np.linalg.inv(V)  # d/dxi of nodal values, at the nodes
    h = across.nodes
    dz = (u[:, top] * 3.0 - 4.0 * u[:, top - 1] + u[:, top - 2]) / (h[top] - h[top - 2])
    worst, last = 0.0, space.nodes[0].max() - keep
    for element in space.elements:
        p = space.nodes[:, element]
        dxi = np.einsum("ai,cij->caj", D, p), np.einsum("bj,cij->cib", D, p)
        det = dxi[0][0] * dxi[1][1] - dxi[0][1] * dxi[1][0]
        ok = p[0] <= last
        v = u[element, top]  # (i, j, component)
        g0, g1 = np.einsum("ai,ijc->ajc", D, v), np.einsum("bj,ijc->ibc", D, v)
        with np.errstate(divide="ignore", invalid="ignore"):
            gx = (g0 * dxi[1][1][..., None] - g1 * dxi[0][1][..., None]) / det[..., None]
            gy = (g1 * dxi[0][0][..., None] - g0 * dxi[1][0][..., None]) / det[..., None]
        gradient = np.stack([gx, gy, dz[element]], axis=-1)[ok]  # (point, component, direction)
        strain = 0.5 * (gradient + gradient.transpose(0, 2, 1))
        s = 2.0 * mu * strain + lam * np.trace(strain, axis1=1, axis2=2)[:, None, None] * np.eye(3)
        deviator = s - np.trace(s, axis1=1, axis2=2)[:, None, None] / 3.0 * np.eye(3)
        if len(s):
            worst = max(worst, float(np.sqrt(1.5 * np.einsum("pij,pij->p", deviator, deviator)).max()))
    return worst
