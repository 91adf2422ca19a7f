"""Strain along the faces of the hinge, from the displacements of the nodes on them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from .plane_elements import PlaneSolution
from .solid_elements import SolidSolution

Array = NDArray[np.float64]

# Gauss points of two an edge, where the derivative of a quadratic interpolation is most accurate
_POINTS = np.array([-1.0, 1.0]) / np.sqrt(3.0)


@dataclass(frozen=True)
class FaceStrain:
    """Tangential strain per newton at points along one face; x from the hinge's centre towards the arm, mm.

    `length` is the face's length (mm) that each point stands for. Positive in tension, for a force
    that bends this face convex.
    """

    x: Array
    length: Array
    strain: Array

    @property
    def peak(self) -> float:
        """Largest strain on the face, 1/N."""
        return float(self.strain.max())

    @property
    def centre(self) -> float:
        """Strain at the hinge's centre, 1/N, by a parabola through the nearest points."""
        near = np.argsort(np.abs(self.x))[:6]
        return float(np.polynomial.polynomial.polyfit(self.x[near], self.strain[near], 2)[0])

    def mean(self, grid: float) -> float:
        """Mean over |x| <= grid/2, weighted by face length, 1/N: what a gauge's grid of that length reads."""
        order = np.argsort(self.x)
        total = np.concatenate([[0.0], np.cumsum((self.strain * self.length)[order])])
        along = np.concatenate([[0.0], np.cumsum(self.length[order])])
        # points stand for equal shares left and right of them: cumulative sums hold at the borders between
        x = self.x[order]
        borders = np.concatenate([[2 * x[0] - x[1]], (x[1:] + x[:-1]) / 2.0, [2 * x[-1] - x[-2]]])
        ends = (-grid / 2.0, grid / 2.0)
        return float(
            np.diff(np.interp(ends, borders, total))[0] / np.diff(np.interp(ends, borders, along))[0]
        )


def face_strain(solution: PlaneSolution | SolidSolution, face: str) -> FaceStrain:
    """Strain along the "slot" face (upper floor and its fillets), or the "flat" face below the hinge.

    A solid is read on its mid-plane y = 0. A two-sided hinge has a slot face on both sides, equal and
    opposite; its "flat" face is the lower one. Reaches from wall to wall of the slot, on a flat
    face over its whole length.
    """
    mesh = solution.mesh
    shape = mesh.shape
    upper = face == "slot" or shape.two_sided
    nodes = solution.basis.doflocs
    on_plane = np.ones(nodes.shape[1], dtype=bool) if len(nodes) == 2 else nodes[2] < 1e-9
    fillets = (shape.arm.slot_corner(upper=True), shape.body.slot_corner(upper=True))
    centre = (fillets[0].wall + fillets[1].wall) / 2.0
    edges = _face_edges(mesh.cells, shape, upper)
    index = _lookup(nodes[:2, on_plane], edges)
    u = solution.displacement[:2, on_plane][:, index]  # component, edge, node
    p = np.moveaxis(edges, -1, 0)
    # derivative of the quadratic through nodes at -1, 0, 1
    xi = _POINTS
    weights = np.stack([xi - 0.5, -2.0 * xi, xi + 0.5])  # node, point
    dp, du = (np.einsum("cen,nq->ceq", q, weights) for q in (p, u))
    speed = np.hypot(*dp)
    value = np.stack([xi * (xi - 1.0) / 2.0, 1.0 - xi * xi, xi * (xi + 1.0) / 2.0])
    x = np.einsum("en,nq->eq", p[0], value) - centre
    direction = 1.0 if shape.arm.end > shape.body.end else -1.0
    strain = np.sum(dp * du, axis=0) / speed**2
    # a force towards +z bends the upper face hollow
    sign = -1.0 if upper else 1.0
    return FaceStrain(direction * x.ravel(), speed.ravel(), sign * strain.ravel())


def _face_edges(cells: Array, shape, upper: bool) -> Array:
    """(edges, 3, 2) node coordinates of element edges on the hinge's face."""
    sides = np.concatenate([cells[:, :, 0], cells[:, :, 2], cells[:, 0], cells[:, 2]])
    x, z = sides[..., 0], sides[..., 1]
    near = 1e-9 * np.ptp(cells[..., 0])
    if not upper:
        return sides[np.all(np.abs(z - shape.low) < near, axis=1)]
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
    return sides[faces]


def _lookup(nodes: Array, edges: Array) -> NDArray[np.int64]:
    """Index of the node at each edge point."""
    _, index = cKDTree(nodes.T).query(edges.reshape(-1, 2))
    return index.reshape(edges.shape[:2])
