"""A foil beam with filleted roots between a rigid island and a clamped frame, by solid elements.

The beam is symmetric in all three planes through its middle, so its ends' six relative motions do not mix,
and each is solved on an eighth of the beam: Lagrange elements of order 4 in the foil's plane and cubic
through half its thickness (tactcad.fem.space). The root's fillet is tangent to the rigid edge.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import pi

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix, csc_matrix

from tactcad.design.messages import CheckFailure
from tactcad.families.planar.beam import MODES, FoilBeam
from tactcad.fem import elasticity
from tactcad.fem.mapped_mesh import merged
from tactcad.fem.space import AcrossSpace, PlaneSpace, gauss, lagrange

Array = NDArray[np.float64]
Index = NDArray[np.int64]
ORDER = 4
KEEP = 0.3  # fillet radii off the clamped edge: nearer, a rigid edge makes the stress grow without limit
WIDER = 1.7  # from a column of elements to the next one away from the root
BANDS = {"inside": (-0.01, 0.5), "beside": (0.5, 0.97), "edge": (0.97, 1.01)}  # shares of the half width
# of the foil's face by shares of the half width, and of the beam's side
SITES = (*(f"{place} {band}" for place in ("root", "span") for band in BANDS), "root side", "span side")

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


def quarter_mesh(beam: FoilBeam, density: int) -> PlaneSpace:
    """The quarter 0 <= x <= s/2, y >= 0 of the beam's plane, mm: rows graded towards its edge, columns that
    widen away from the root, and a line of nodes KEEP fillet radii off the clamped edge."""
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


def _meshed(blocks: list[Array]) -> PlaneSpace:
    every = np.concatenate([_split(grid) for grid in blocks])
    points, index = merged(every.reshape(len(every), -1, 2))
    return PlaneSpace(np.ascontiguousarray(points.T), index.reshape(len(every), ORDER + 1, ORDER + 1))


def _split(grid: Array) -> Array:
    """Elements of a block of nodes, each with its (ORDER + 1)^2 own."""
    nx, ny = ((n - 1) // ORDER for n in grid.shape[:2])
    step = np.arange(ORDER + 1)
    return np.array([grid[np.ix_(ORDER * i + step, ORDER * j + step)] for i in range(nx) for j in range(ny)])


def _nodes(ends: Array) -> Array:
    """Nodes of elements with these ends."""
    return np.interp(np.arange(ORDER * (len(ends) - 1) + 1) / ORDER, np.arange(len(ends)), ends)


def solid(beam: FoilBeam, density: int, through: tuple[int, int] = (1, 3)) -> Solid:
    """With so many elements `through` half the thickness, of that order: a quadratic one leaves narrow beams'
    twist 1 % too stiff."""
    count, order = through
    across = AcrossSpace(np.linspace(0.0, beam.thickness / 2.0, count * order + 1), order)
    return Solid(beam, quarter_mesh(beam, density), across)


def solved(
    beam: FoilBeam, density: int = 2, modes: Sequence[str] = MODES, through: tuple[int, int] = (1, 3)
) -> dict[str, float]:
    """Stiffness of these modes, N/mm; N mm a radian for bending and twist."""
    return {mode: k for mode, k, _ in _modes(beam, solid(beam, density, through), modes)}


def stresses(
    beam: FoilBeam, density: int = 2, modes: Sequence[str] = MODES
) -> tuple[dict[str, float], dict[str, Array]]:
    """Stiffness of these modes, and the largest von Mises stress of the foil's surface by SITES per unit of
    its relative motion, MPa/mm or MPa/rad."""
    # elements as high as the root is round: one leaves sharp roots' sides 3 % too low
    layers = min(3, int(np.ceil(beam.thickness / beam.fillet / 2.0 - 1e-9)))
    eighth = solid(beam, density, (layers, 3))
    x, y = eighth.plane
    half, r = beam.length / 2.0, beam.fillet
    share = y / half_width(beam, x)
    near = 1e-9 * beam.length
    places = {"root": (x >= half - r - near) & (x <= half - KEEP * r + near), "span": x <= half - r + near}
    stiffness, found = {}, {}
    for mode, k, u in _modes(beam, eighth, modes):
        every = eighth.von_mises(u)
        stiffness[mode] = k
        face = [
            every[on & (share > low) & (share <= high), -1]
            for on in places.values()
            for low, high in BANDS.values()
        ]
        side = [every[on & (share > BANDS["edge"][0]), :] for on in places.values()]
        found[mode] = np.array([one.max() for one in (*face, *side)])
    return stiffness, found


def half_width(beam: FoilBeam, x: Array) -> Array:
    """Half the width at half the thickness."""
    r = beam.fillet
    into = np.maximum(x - (beam.length / 2.0 - r), 0.0)
    return np.asarray(beam.width / 2.0 + r - np.sqrt(np.maximum(r**2 - into**2, 0.0)))


class Solid:
    """The eighth: a mesh of the plane and of half the thickness, narrower towards the face by the bevel.

    plane    nodes' x and y at half the thickness, mm
    points   of every node, mm, [node of the plane, place through the foil, component]
    """

    def __init__(self, beam: FoilBeam, space: PlaneSpace, across: AcrossSpace) -> None:
        self.plane, z = space.nodes, across.nodes
        x, y = self.plane
        narrower = 1.0 - np.outer(1.0 / half_width(beam, x), 2.0 * beam.bevel * z / beam.thickness)
        shape = len(x), len(z)
        self.points = np.stack(
            [np.broadcast_to(x[:, None], shape), y[:, None] * narrower, np.broadcast_to(z, shape)], axis=-1
        )
        self.lame = elasticity.lame(beam.youngs_modulus, beam.poisson)
        layers = np.arange(0, len(z) - 1, across.order)[:, None] + np.arange(across.order + 1)
        plane = space.elements.reshape(len(space.elements), -1)
        # [element, node]: the place of each in the list of all
        self.elements = (len(z) * plane[:, None, :, None] + layers[None, :, None, :]).reshape(
            len(plane) * len(layers), -1
        )
        self.orders = space.order, space.order, across.order

    def _slopes(self, points: list[tuple[float, ...]], own: Index) -> tuple[Array, Array]:
        """Derivatives by x, y and z of an element's functions at local points, [node, component, point], and
        the determinants there."""
        values, slopes = zip(*(lagrange(n, p) for n, p in zip(self.orders, points)))
        local = []
        for way in range(3):
            a, b, c = (slopes[i] if i == way else values[i] for i in range(3))
            local.append(np.einsum("ap,bq,cr->abcpqr", a, b, c).reshape(len(own), -1))
        J = np.einsum("nc,knp->pkc", self.points.reshape(-1, 3)[own], np.array(local), optimize=True)
        det = np.linalg.det(J)
        flat = np.abs(det) < 1e-12 * np.abs(det).max()  # where the fillet meets the edge
        J[flat] = np.nan * np.eye(3)
        inverse = np.full_like(J, np.nan)
        inverse[~flat] = np.linalg.inv(J[~flat])
        return np.einsum("pck,knp->ncp", inverse, np.array(local), optimize=True), det

    def stiffness(self) -> csc_matrix:
        """Unknown 3 n + i is component i of node n."""
        lam, mu = self.lame
        points, weights = zip(*(gauss(n + 1) for n in self.orders))
        weight = np.einsum("p,q,r->pqr", *weights).ravel()
        size = 3 * self.elements.shape[1]
        values, rows, columns = [], [], []
        for own in self.elements:
            slope, det = self._slopes(points, own)
            g = slope.reshape(size, -1)
            T = ((g * (np.abs(det) * weight)) @ g.T).reshape(len(own), 3, len(own), 3)
            A = lam * T + mu * T.transpose(0, 3, 2, 1)
            trace = mu * np.einsum("aibi->ab", T)
            for i in range(3):
                A[:, i, :, i] += trace
            place = (3 * own[:, None] + np.arange(3)).ravel()
            values.append(A.ravel())
            rows.append(np.repeat(place, size))
            columns.append(np.tile(place, size))
        count = self.points.size
        data, row, column = (np.concatenate(v) for v in (values, rows, columns))
        return coo_matrix((data, (row, column)), shape=(count, count)).tocsc()

    def von_mises(self, u: Array) -> Array:
        """Stress at every node, averaged over the elements that meet there, [node of the plane, place]."""
        lam, mu = self.lame
        corners = [tuple(np.linspace(-1.0, 1.0, n + 1)) for n in self.orders]
        flat = u.reshape(-1, 3)
        total, count = np.zeros((len(flat), 3, 3)), np.zeros(len(flat))
        for own in self.elements:
            slope, _ = self._slopes(corners, own)
            gradient = np.einsum("nc,ndp->pcd", flat[own], slope, optimize=True)
            strain = 0.5 * (gradient + gradient.transpose(0, 2, 1))
            s = 2.0 * mu * strain + lam * np.trace(strain, axis1=1, axis2=2)[:, None, None] * np.eye(3)
            known = np.isfinite(s).all(axis=(1, 2))
            total[own[known]] += s[known]
            count[own[known]] += 1.0
        mean = total / np.maximum(count, 1.0)[:, None, None]
        deviator = mean - np.trace(mean, axis1=1, axis2=2)[:, None, None] / 3.0 * np.eye(3)
        return np.sqrt(1.5 * np.einsum("nij,nij->n", deviator, deviator)).reshape(u.shape[:2])


def _modes(beam: FoilBeam, solid: Solid, modes: Sequence[str]) -> Iterator[tuple[str, float, Array]]:
    """These modes with its stiffness and its displacements [node, place through the foil, component]."""
    A = solid.stiffness()
    x, y, z = solid.points.reshape(-1, 3).T
    planes = [np.abs(v) < 1e-9 for v in (x, y, z)]
    end = np.abs(x - beam.length / 2.0) < 1e-9
    component = {"x": 0, "y": 1, "z": 2}
    for mode in modes:
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
        yield mode, float(8.0 * known @ (A @ known)), known.reshape(solid.points.shape)
