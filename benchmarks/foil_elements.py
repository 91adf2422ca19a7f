"""A foil beam with filleted roots between a rigid island and a clamped frame, by solid elements.

The beam is symmetric in all three planes through its middle, so its ends' six relative motions do not mix,
and each is solved on an eighth of the beam: Lagrange elements of order 4 in the foil's plane and quadratic
through half its thickness (tactcad.fem.space). The root's fillet is tangent to the rigid edge.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import pi

import numpy as np
from numpy.typing import NDArray

from tactcad.design.messages import CheckFailure
from tactcad.families.planar.beam import MODES, FoilBeam
from tactcad.fem import elasticity
from tactcad.fem.mapped_mesh import merged
from tactcad.fem.space import AcrossSpace, PlaneSpace

Array = NDArray[np.float64]
ORDER = 4
KEEP = 0.3  # fillet radii off the clamped edge: nearer, a rigid edge makes the stress grow without limit
WIDER = 1.7  # from a column of elements to the next one away from the root
BANDS = {"inside": (-0.01, 0.5), "beside": (0.5, 0.97), "edge": (0.97, 1.01)}  # shares of the half width
SITES = tuple(f"{place} {band}" for place in ("root", "span") for band in BANDS)

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
    return _meshed(cells)


def _meshed(blocks: list[Array]) -> PlaneSpace:
    every = np.concatenate([_split(grid) for grid in blocks])
    points, index = merged(every.reshape(len(every), -1, 2))
    return PlaneSpace(np.ascontiguousarray(points.T), index.reshape(len(every), ORDER + 1, ORDER + 1))


def _split(grid: Array) -> Array:
    """Elements of a block of nodes, each with its (ORDER + 1)^2 own."""
    nx, ny = ((n - 1) // ORDER for n in grid.shape[:2])
    step = np.arange(ORDER + 1)
    return np.array([grid[np.ix_(ORDER * i + step, ORDER * j + step)] for i in range(nx) for j in range(ny)])


def stress_mesh(beam: FoilBeam, density: int = 2) -> PlaneSpace:
    """The same quarter for stresses: columns that widen away from the root, and a line of nodes KEEP fillet
    radii off the clamped edge."""
    half, w, r = beam.length / 2.0, beam.width / 2.0, beam.fillet
    straight, step, ends = half - r, min(beam.width / 2.0, (half - r) / 1.5) / density, [0.0]
    while ends[-1] < straight:
        ends.append(ends[-1] + step)
        step *= WIDER
    along = 1.0 - _nodes(np.array(ends[::-1])) / ends[-1]
    across = _nodes(1.0 - (1.0 - np.linspace(0.0, 1.0, 2 * density + 1)) ** 1.5)
    x = np.broadcast_to((straight * along)[:, None], (len(along), len(across)))
    cells = [np.stack([x, np.broadcast_to(w * across, x.shape)], axis=-1)]
    cut = np.arcsin(1.0 - KEEP)
    turns = np.linspace(0.0, cut, 2 * density + 1), np.linspace(cut, pi / 2.0, density + 1)
    angle = _nodes(np.concatenate([turns[0], turns[1][1:]]))[:, None]
    edge = w + r * (1.0 - np.cos(angle))
    x = np.broadcast_to(straight + r * np.sin(angle), (len(angle), len(across)))
    cells.append(np.stack([x, across * edge], axis=-1))
    return _meshed(cells)


def _nodes(ends: Array) -> Array:
    """Nodes of elements with these ends."""
    return np.interp(np.arange(ORDER * (len(ends) - 1) + 1) / ORDER, np.arange(len(ends)), ends)


def solved(beam: FoilBeam, density: int = 1) -> dict[str, float]:
    """Stiffness of every mode, N/mm; N mm a radian for bending and twist."""
    space = quarter_mesh(beam, density)
    across = AcrossSpace(np.linspace(0.0, beam.thickness / 2.0, 3), 2)
    return {mode: k for mode, k, _ in _modes(beam, space, across)}


def stresses(beam: FoilBeam, density: int = 2) -> tuple[dict[str, float], dict[str, Array]]:
    """Stiffness of every mode, and the largest von Mises stress of the foil's faces by SITES per unit of its
    relative motion, MPa/mm or MPa/rad."""
    space = stress_mesh(beam, density)
    across = AcrossSpace(np.linspace(0.0, beam.thickness / 2.0, 4), 3)
    lam, mu = elasticity.lame(beam.youngs_modulus, beam.poisson)
    x, y = space.nodes
    half, r = beam.length / 2.0, beam.fillet
    into = np.maximum(x - (half - r), 0.0)  # the fillet
    share = y / (beam.width / 2.0 + r - np.sqrt(np.maximum(r**2 - into**2, 0.0)))
    near = 1e-9 * beam.length
    places = {"root": (x >= half - r - near) & (x <= half - KEEP * r + near), "span": x <= half - r + near}
    picked = [
        places[place] & (share > low) & (share <= high) for place in places for low, high in BANDS.values()
    ]
    stiffness, found = {}, {}
    for mode, k, u in _modes(beam, space, across):
        face = _face_stress(space, u, across, lam, mu)
        stiffness[mode] = k
        found[mode] = np.array([face[own].max() for own in picked])
    return stiffness, found


def _modes(beam: FoilBeam, space: PlaneSpace, across: AcrossSpace) -> Iterator[tuple[str, float, Array]]:
    """Every mode with its stiffness and its displacements [node, place through the foil, component]."""
    count, places = space.nodes.shape[1], len(across.nodes)
    lam, mu = elasticity.lame(beam.youngs_modulus, beam.poisson)
    A = space.swept_stiffness(across, lam, mu)
    x, y = (np.repeat(v, places) for v in space.nodes)
    z = np.tile(across.nodes, count)
    planes = [np.abs(v) < 1e-9 for v in (x, y, z)]
    end = np.abs(x - beam.length / 2.0) < 1e-9
    component = {"x": 0, "y": 1, "z": 2}
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
        yield mode, float(8.0 * known @ (A @ known)), known.reshape(count, places, 3)


def _face_stress(space: PlaneSpace, u: Array, across: AcrossSpace, lam: float, mu: float) -> Array:
    """Von Mises stress at the nodes of the foil's face, of stresses averaged over the elements that meet."""
    nodes = np.linspace(-1.0, 1.0, space.order + 1)
    V = np.vander(nodes, increasing=True)
    powers = np.zeros_like(V)
    powers[:, 1:] = V[:, :-1] * np.arange(1, space.order + 1)
    D = powers @ np.linalg.inv(V)  # d/dxi of nodal values, at the nodes
    last = across.nodes[-across.order - 1 :]
    by_height = np.linalg.inv(np.vander(last - last[-1], increasing=True))[1]
    dz = np.einsum("k,nkc->nc", by_height, u[:, -across.order - 1 :])
    e = space.elements
    p = space.nodes[:, e]
    along, over = np.einsum("ai,ceij->ceaj", D, p), np.einsum("bj,ceij->ceib", D, p)
    det = along[0] * over[1] - along[1] * over[0]
    det = np.where(np.abs(det) < 1e-12 * np.abs(det).max(), np.nan, det)  # where the fillet meets the edge
    v = u[e, -1]
    g0, g1 = np.einsum("ai,eijc->eajc", D, v), np.einsum("bj,eijc->eibc", D, v)
    gx = (g0 * over[1][..., None] - g1 * along[1][..., None]) / det[..., None]
    gy = (g1 * along[0][..., None] - g0 * over[0][..., None]) / det[..., None]
    gradient = np.stack([gx, gy, dz[e]], axis=-1)  # component, direction
    strain = 0.5 * (gradient + np.swapaxes(gradient, -1, -2))
    s = 2.0 * mu * strain + lam * np.trace(strain, axis1=-2, axis2=-1)[..., None, None] * np.eye(3)
    total, count = np.zeros((space.nodes.shape[1], 3, 3)), np.zeros(space.nodes.shape[1])
    known = np.isfinite(s).all(axis=(-1, -2))
    np.add.at(total, e[known], s[known])
    np.add.at(count, e[known], 1.0)
    mean = total / np.maximum(count, 1.0)[:, None, None]
    deviator = mean - np.trace(mean, axis1=-2, axis2=-1)[:, None, None] / 3.0 * np.eye(3)
    return np.asarray(np.sqrt(1.5 * np.einsum("nij,nij->n", deviator, deviator)))
