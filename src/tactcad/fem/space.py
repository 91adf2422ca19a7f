"""Lagrange elements of any order on a mapped mesh of the plane, and swept over half the width.

A swept mesh's functions are products a(x, z) f(y), so every integral of two of them is a product of one over
the plane and one over the width: the solid's matrix is assembled from six integrals over the plane and three
over the width.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import bmat, coo_matrix, csc_matrix, csr_matrix, kron

from .mapped_mesh import PlaneMesh, layers, merged

Array = NDArray[np.float64]


@lru_cache
def lagrange(order: int, points: tuple[float, ...]) -> tuple[Array, Array]:
    """Values and slopes (node, point) of the polynomials on order + 1 even nodes of -1 to 1."""
    nodes = np.linspace(-1.0, 1.0, order + 1)
    coefficients = np.linalg.inv(np.vander(nodes, increasing=True))
    powers = np.vander(np.array(points), order + 1, increasing=True)
    slopes = np.zeros_like(powers)
    slopes[:, 1:] = powers[:, :-1] * np.arange(1, order + 1)
    return (powers @ coefficients).T, (slopes @ coefficients).T


@lru_cache
def gauss(count: int) -> tuple[tuple[float, ...], Array]:
    """Points of -1 to 1 and weights."""
    points, weights = np.polynomial.legendre.leggauss(count)
    return tuple(points.tolist()), weights


@dataclass(frozen=True)
class PlaneSpace:
    """`nodes` (2, nodes): x and z in mm. `elements` (n, order + 1, order + 1): their nodes by local (x, z)
    index."""

    nodes: Array
    elements: NDArray[np.int64]

    @classmethod
    def of(cls, mesh: PlaneMesh) -> PlaneSpace:
        """The space of a mesh, each node once. Raises RuntimeError if neighbouring blocks do not share
        their nodes.
        """
        count, side = mesh.cells.shape[:2]
        points, index = merged(mesh.cells.reshape(count, side * side, 2))
        elements = index.reshape(count, side, side)
        corners = elements[:, [0, -1, -1, 0], [0, 0, -1, -1]]
        edges = np.sort(np.stack([corners, np.roll(corners, 1, axis=1)], axis=-1), axis=-1).reshape(-1, 2)
        # Euler: a disc without holes
        if len(np.unique(corners)) - len(np.unique(edges, axis=0)) + count != 1:
            raise RuntimeError("the mapped mesh is torn: blocks do not share their nodes")
        return cls(np.ascontiguousarray(points.T), elements)

    @property
    def order(self) -> int:
        return self.elements.shape[1] - 1

    @property
    def edges(self) -> NDArray[np.int64]:
        """(edges, order + 1): nodes along every side of every element; a side shared by two elements is
        listed twice.
        """
        e = self.elements
        return np.concatenate([e[:, :, 0], e[:, :, -1], e[:, 0], e[:, -1]])

    @cached_property
    def area(self) -> float:
        """mm2"""
        return float(self._integrals["1"].sum())

    def stiffness(self, lam: float, mu: float) -> csc_matrix:
        """Per mm of width; unknown 2 n + i is component i of node n."""
        q = self._integrals
        return _joined([[q["xx"], q["xz"]], [q["xz"].T, q["zz"]]], lam, mu)

    def swept_stiffness(self, across: AcrossSpace, lam: float, mu: float) -> csc_matrix:
        """Stiffness of the solid; unknown 3 (n m + k) + i is component i (x, z, y) of node n at the k-th of m
        places across."""
        q = {name: csr_matrix(matrix) for name, matrix in self._integrals.items()}
        mass, stretch, slope = (csr_matrix(m) for m in across.integrals)
        xy, zy = kron(q["x"], slope, "csr"), kron(q["z"], slope, "csr")
        xz = kron(q["xz"], mass, "csr")
        rows = [
            [kron(q["xx"], mass, "csr"), xz, xy],
            [xz.T, kron(q["zz"], mass, "csr"), zy],
            [xy.T, zy.T, kron(q["1"], stretch, "csr")],
        ]
        return _joined(rows, lam, mu)

    @cached_property
    def _integrals(self) -> dict[str, csr_matrix]:
        """Integrals of a b ("1"), d_i a b ("x", "z") and d_i a d_j b ("xx", "xz", "zz") over the plane."""
        points, weights = gauss(self.order + 1)
        value, slope = lagrange(self.order, points)

        def product(f: Array, g: Array) -> Array:
            return np.einsum("aq,br->abqr", f, g).reshape(value.shape[0] ** 2, -1)

        local = np.stack([product(slope, value), product(value, slope)])  # direction, node, point
        count = len(self.elements)
        nodes = self.elements.reshape(count, -1)
        J = np.einsum("cen,knq->eckq", self.nodes[:, nodes], local, optimize=True)
        determinant = J[:, 0, 0] * J[:, 1, 1] - J[:, 0, 1] * J[:, 1, 0]
        # c, k, element, point
        inverse = np.stack([[J[:, 1, 1], -J[:, 1, 0]], [-J[:, 0, 1], J[:, 0, 0]]]) / determinant
        x, z = np.einsum("ckeq,knq->cenq", inverse, local, optimize=True)
        area = (np.abs(determinant) * np.outer(weights, weights).ravel())[:, None]
        one = np.broadcast_to(product(value, value), x.shape)
        rows = np.broadcast_to(nodes[:, :, None], (*nodes.shape, nodes.shape[1])).ravel()
        columns = np.broadcast_to(nodes[:, None, :], (*nodes.shape, nodes.shape[1])).ravel()
        size = self.nodes.shape[1]

        def integral(f: Array, g: Array) -> csr_matrix:
            values = np.matmul(f * area, g.transpose(0, 2, 1)).ravel()
            return coo_matrix((values, (rows, columns)), shape=(size, size)).tocsr()

        pairs = {"xx": (x, x), "xz": (x, z), "zz": (z, z), "x": (x, one), "z": (z, one), "1": (one, one)}
        return {name: integral(f, g) for name, (f, g) in pairs.items()}


@dataclass(frozen=True)
class AcrossSpace:
    """Elements of the same order over half the width: `nodes` from y = 0 to the free side, mm."""

    nodes: Array
    order: int

    @classmethod
    def of(cls, mesh: PlaneMesh, half_width: float, density: int, order: int) -> AcrossSpace:
        ends = layers(half_width, mesh.shape.hinge_thickness, density)
        return cls(
            np.interp(np.arange(order * (len(ends) - 1) + 1) / order, np.arange(len(ends)), ends), order
        )

    @property
    def integrals(self) -> tuple[Array, Array, Array]:
        """Integrals of f g, f' g' and f g' over half the width."""
        points, weights = gauss(self.order + 1)
        value, slope = lagrange(self.order, points)
        size = len(self.nodes)
        mass, stretch, mixed = (np.zeros((size, size)) for _ in range(3))
        for start in range(0, size - 1, self.order):
            own = slice(start, start + self.order + 1)
            half = np.ptp(self.nodes[own]) / 2.0
            mass[own, own] += (value * weights) @ value.T * half
            stretch[own, own] += (slope * weights) @ slope.T / half
            mixed[own, own] += (value * weights) @ slope.T
        return mass, stretch, mixed


def _joined(gradients: list[list[csr_matrix]], lam: float, mu: float) -> csc_matrix:
    """lambda d_i a d_j b + mu (d_j a d_i b + delta_ij grad a . grad b), components of a node side by side."""
    size, dim = gradients[0][0].shape[0], len(gradients)
    trace = mu * sum(gradients[i][i] for i in range(dim))
    blocks = [
        [
            lam * gradients[i][j] + mu * gradients[j][i] + (trace if i == j else 0.0 * trace)
            for j in range(dim)
        ]
        for i in range(dim)
    ]
    by_component = bmat(blocks).tocoo()
    place = lambda at: dim * (at % size) + at // size  # noqa: E731
    return coo_matrix(
        (by_component.data, (place(by_component.row), place(by_component.col))), shape=by_component.shape
    ).tocsc()


def line_load(nodes: Array, load: Callable[[Array], Array], order: int) -> Array:
    """int N_i load dx over a line of elements with sorted nodes, by Gauss points: exact for cubic loads."""
    points, weights = gauss(order + 2)
    value, slope = lagrange(order, points)
    f = np.zeros(len(nodes))
    for start in range(0, len(nodes) - 1, order):
        own = slice(start, start + order + 1)
        x = nodes[own]
        f[own] += value @ (load(x @ value) * (x @ slope) * weights)
    return f
