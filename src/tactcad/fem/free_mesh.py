"""Six-node triangles in any contour with holes: for the uncut part with pad, stop land and holes, which the
mapped mesh cannot follow, and its compliance between its spacers.

Points on the boundary at a graded spacing, points inside from lattices of halving size, thinned and
smoothed, joined by Delaunay's triangulation; mid-side nodes of the boundary lie on its arcs.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay, cKDTree
from skfem import Basis, ElementTriP2, MeshTri, MeshTri2
from skfem.assembly.dofs import Dofs

from tactcad.contour import Arc, Contour, Segment
from tactcad.design.messages import CheckFailure
from tactcad.fem import elasticity

from .shape import ElementShape
from .space import line_load

Array = NDArray[np.float64]

ARC_STEPS = 6.0  # elements along a radius' length of arc, at least
GROWTH = 0.3  # growth of the element size per distance from a seed
CLEAR = 0.55  # inner points keep this share of the local size from the boundary
APART = 0.75  # and this from each other
SMOOTHING = 8


@dataclass(frozen=True)
class Fine:
    """Element size (mm) wanted at a place (x, z)."""

    at: tuple[float, float]
    size: float


def triangle_mesh(
    outer: Contour, holes: tuple[Contour, ...], fine: tuple[Fine, ...], largest: float
) -> MeshTri2:
    """Mesh of a contour with holes, finer at arcs.

    Parameters
    ----------
    outer, holes
        Simple closed contours, mm.
    fine
        Places that want smaller elements.
    largest
        Largest element, mm.

    Raises
    ------
    CheckFailure
        If the triangles do not follow the boundary.
    """
    contours = (outer, *holes)
    size = _Size(_seeds(contours, fine), largest)
    loops = [_boundary(c, size) for c in contours]
    border = np.concatenate([points for points, _ in loops])
    inner = _inner_points(contours, border, size)
    points = np.concatenate([border, inner])
    for _ in range(SMOOTHING):
        points = _smoothed(points, _triangles(points, contours, len(border)), len(border))
    cells = _triangles(points, contours, len(border))
    return _quadratic(points, cells, loops)


@dataclass(frozen=True)
class _Size:
    """Wanted element size at any place: the smallest of what each seed allows at its distance."""

    seeds: tuple[Fine, ...]
    largest: float

    def __call__(self, p: Array) -> Array:
        size = np.full(len(p), self.largest)
        for seed in self.seeds:
            size = np.minimum(size, seed.size + GROWTH * np.hypot(*(p - seed.at).T))
        return size


def _seeds(contours: tuple[Contour, ...], fine: tuple[Fine, ...]) -> tuple[Fine, ...]:
    arcs = [s for c in contours for s in c if isinstance(s, Arc)]
    return fine + tuple(
        Fine(arc.at(u), 1.5 * arc.radius / ARC_STEPS) for arc in arcs for u in (0.0, 0.25, 0.5, 0.75, 1.0)
    )


def _boundary(contour: Contour, size: _Size) -> tuple[Array, list[Segment]]:
    """Points along the contour, each with the segment that leads from it to the next."""
    points, owners = [], []
    for s in contour:
        u = np.linspace(0.0, 1.0, 201)
        local = size(np.array([s.at(v) for v in u]))
        steps = np.concatenate([[0.0], np.cumsum(s.length / 200 * 2.0 / (local[1:] + local[:-1]))])
        count = max(1, ceil(steps[-1] - 1e-6))
        for v in np.interp(np.linspace(0.0, steps[-1], count + 1)[:-1], steps, u):
            points.append(s.at(float(v)))
            owners.append(s)
    return np.array(points), owners


def _inner_points(contours: tuple[Contour, ...], border: Array, size: _Size) -> Array:
    low, high = border.min(axis=0), border.max(axis=0)
    accepted = border
    level = 2.0 ** np.floor(np.log2(min(s.size for s in size.seeds)))
    while level <= size.largest:
        x = np.arange(low[0], high[0] + level, level)
        z = np.arange(low[1], high[1] + level, level * np.sqrt(0.75))
        lattice = np.stack(np.meshgrid(x, z, indexing="ij"), axis=-1)
        lattice[:, 1::2, 0] += level / 2.0
        near = np.full(lattice.shape[:2], 2.0 * level > size.largest)
        for seed in size.seeds:  # elsewhere larger elements are wanted
            reach = (2.0 * level - seed.size) / GROWTH + level
            (i, k), (j, l) = (np.searchsorted(a, (at - reach, at + reach)) for a, at in zip((x, z), seed.at))
            near[i:k, j:l] = True
        p = lattice[near]
        wanted = size(p)
        p, wanted = (a[(wanted >= level) & (wanted < 2.0 * level)] for a in (p, wanted))
        p, wanted = (a[inside(contours, p)] for a in (p, wanted))
        if len(p):
            distance, _ = cKDTree(border).query(p)
            p = p[distance > CLEAR * wanted]
        if len(p):
            distance, _ = cKDTree(accepted).query(p)
            accepted = np.concatenate([accepted, p[distance > APART * level]])
        level *= 2.0
    return accepted[len(border) :]


def inside(contours: tuple[Contour, ...], p: Array) -> NDArray[np.bool_]:
    """Whether points lie in the first contour and in none of the others: crossings of a ray towards +x."""
    odd = np.zeros(len(p), dtype=bool)
    for c in contours:
        corners = np.array(
            [s.at(u) for s in c for u in (np.linspace(0, 1, 33)[:-1] if isinstance(s, Arc) else (0.0,))]
        )
        for (x0, z0), (x1, z1) in zip(corners, np.roll(corners, -1, axis=0)):
            if z0 == z1:
                continue
            spans = (z0 > p[:, 1]) != (z1 > p[:, 1])
            odd ^= spans & (p[:, 0] < x0 + (p[:, 1] - z0) * (x1 - x0) / (z1 - z0))
    return odd


def _triangles(points: Array, contours: tuple[Contour, ...], border: int) -> NDArray[np.int64]:
    cells = Delaunay(points).simplices
    return cells[inside(contours, points[cells].mean(axis=1))]


def _smoothed(points: Array, cells: NDArray[np.int64], border: int) -> Array:
    """Inner points moved to the mean of their neighbours."""
    total, count = np.zeros_like(points), np.zeros(len(points))
    for i, j in ((0, 1), (1, 2), (2, 0), (1, 0), (2, 1), (0, 2)):
        np.add.at(total, cells[:, i], points[cells[:, j]])
        np.add.at(count, cells[:, i], 1.0)
    moved = points.copy()
    free = np.flatnonzero(count[border:] > 0) + border
    moved[free] = total[free] / count[free, None]
    return moved


def _quadratic(points: Array, cells: NDArray[np.int64], loops: list[tuple[Array, list[Segment]]]) -> MeshTri2:
    used = np.unique(cells)
    renumber = np.full(len(points), -1)
    renumber[used] = np.arange(len(used))
    mesh = MeshTri(np.ascontiguousarray(points[used].T), np.ascontiguousarray(renumber[cells].T))
    dofs = Dofs(mesh, ElementTriP2())
    nodes = np.empty((2, dofs.N))
    nodes[:, : mesh.p.shape[1]] = mesh.p
    middles = dofs.facet_dofs[0]
    nodes[:, middles] = mesh.p[:, mesh.facets].mean(axis=1)
    facet_of = {tuple(f): i for i, f in enumerate(np.sort(mesh.facets, axis=0).T.tolist())}
    on_border, start = set(), 0
    for border, owners in loops:
        for i, segment in enumerate(owners):
            a, b = (renumber[start + (i + k) % len(owners)] for k in (0, 1))
            facet = facet_of.get((min(a, b), max(a, b)))
            if facet is None:
                raise CheckFailure(f"the free mesh lost the boundary {segment.name!r} near {segment.start}")
            on_border.add(facet)
            if isinstance(segment, Arc):
                chord = mesh.p[:, [a, b]].mean(axis=1) - segment.centre
                nodes[:, middles[facet]] = segment.centre + chord * segment.radius / np.hypot(*chord)
        start += len(owners)
    if set(mesh.boundary_facets().tolist()) != on_border:
        raise CheckFailure("the free mesh has a boundary that the contour has not")
    return MeshTri2(nodes, mesh.t)


LARGEST = 0.6  # mm: element size away from the hinge


def uncut_compliance(
    outer: Contour,
    holes: tuple[Contour, ...],
    shape: ElementShape,
    spacer: tuple[float, float, float],
    pad: tuple[float, float, float],
    E: float,
    nu: float,
    width: float,
    *,
    per_thickness: float = 3.0,
) -> float:
    """Plane-stress compliance of the part under 1 N spread evenly over the pad's face, mm/N.

    The deflection is the mean over the face (work-conjugate).

    Parameters
    ----------
    outer, holes
        Contours of the part, mm.
    shape
        Its hinge, meshed with elements of t/per_thickness mm.
    spacer
        x beyond which (away from the arm) the sheet is clamped between spacers, and the range of z, mm.
    pad
        x from, x to and z of the pad's face, mm.
    E, nu
        Young's modulus, MPa, and Poisson's ratio.
    width
        Of the sheet, mm.
    per_thickness
        Elements over the hinge's thickness.
    """
    fillets = [f for b in (shape.arm, shape.body) for f in (b.low_fillet, b.high_fillet) if f]
    walls = sorted({f.wall for f in fillets})
    middle = (shape.low + shape.high) / 2.0
    fine = tuple(
        Fine((x, middle), shape.hinge_thickness / per_thickness) for x in np.linspace(walls[0], walls[-1], 9)
    )
    mesh = triangle_mesh(outer, holes, fine, LARGEST)
    basis = Basis(mesh, ElementTriP2(), intorder=4)
    A = elasticity.stiffness_matrix(basis, *elasticity.lame(E, nu, plane_stress=True)) * width
    x, z = basis.doflocs
    edge, low, high = spacer
    direction = 1.0 if edge > shape.arm.end else -1.0
    held = np.flatnonzero((direction * (x - edge) > -1e-9) & (z >= low - 1e-9) & (z <= high + 1e-9))
    x0, x1, face = pad
    on_pad = np.flatnonzero((np.abs(z - face) < 1e-9) & (x > x0 - 1e-9) & (x < x1 + 1e-9))
    on_pad = on_pad[np.argsort(x[on_pad])]
    f = np.zeros(A.shape[0])
    f[2 * on_pad + 1] = line_load(x[on_pad], lambda q: np.full_like(q, 1.0 / (x1 - x0)), basis.elem.maxdeg)
    u = elasticity.solve(A, f, np.concatenate([2 * held, 2 * held + 1]))
    return float(f @ u)
