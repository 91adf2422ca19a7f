"""Compliance of a layer's face by solid elements: the influence of rung `fem-object`.

Bricks with quadratic displacement and linear pressure (27 nodes; the pressure discontinuous, so that it is
projected element by element), which do not lock up to nu 0.4999. A layer looks the same from everywhere, so a
quarter around one pad is meshed: fine under the pad and graded from its edges outward, free at its far side.
Loads that are even or odd in x and y make up all others.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix, csc_matrix
from scipy.sparse.linalg import splu
from skfem import Basis, ElementHex2, MeshHex

from tactcad.design.messages import InputError
from tactcad.fem.elasticity import lame, stiffness_matrix

from .elastic_body import Body

HALVES = 4  # elements under half a side of a pad: no fewer unknowns than patches anywhere
# Power toward the edges of the pad; at 3, elements in the middle hold more patches than they tell apart.
GRADED = 2.5
GROWTH = 2.0  # of an element's side over the one before, outward from the pad's edges and down from the face
# Thicknesses from the last pad to the free side; at 5, pads on a slipping layer move 0.2 % too far.
FAR_SIDE = 8.0
THICKEST = 20.0  # pad sides: beyond, the far side would have to lie further off than elements reach cheaply
THINNEST = 0.25  # of a pad's side: thinner layers want more patches
LARGEST_POISSON = 0.4999


def outward(start: float, first: float, end: float) -> np.ndarray:
    """Points beyond `start` up to `end`, the first step at most `first`, each GROWTH times the one before."""
    number = int(np.ceil(np.log1p((end - start) / first * (GROWTH - 1)) / np.log(GROWTH)))
    steps = GROWTH ** np.arange(number)
    return start + np.cumsum(steps) * (end - start) / steps.sum()


def lines_over_pad(half: float, end: float, halves: int, graded: float = GRADED) -> np.ndarray:
    """Mesh lines from a pad's middle, 0, over its edge to `end`."""
    inner = half * (1 - (1 - np.linspace(0, 1, halves + 1)) ** graded)
    return np.concatenate([inner, outward(half, inner[-1] - inner[-2], end)])


def _integrals(lines: np.ndarray, at: np.ndarray, odd: bool) -> np.ndarray:
    """Integrals from 0 to every `at` of the lines' quadratic shape functions, [at, 2 lines - 1], of a field
    that is even or odd about 0 and none beyond the last line."""
    size = np.diff(lines)
    s = np.clip((np.abs(at)[:, None] - lines[:-1]) / size, 0.0, 1.0)
    result = np.zeros((len(at), 2 * len(lines) - 1))
    result[:, 0:-1:2] = size * (s - 1.5 * s**2 + 2 / 3 * s**3)
    result[:, 1::2] = size * (2 * s**2 - 4 / 3 * s**3)
    result[:, 2::2] += size * (-0.5 * s**2 + 2 / 3 * s**3)
    return result if odd else result * np.sign(at)[:, None]


def _means(lines: np.ndarray, x: np.ndarray, a: np.ndarray, odd: bool) -> np.ndarray:
    """Mean over every stretch of length a about x, of what `_integrals` integrates."""
    return (_integrals(lines, x + a / 2, odd) - _integrals(lines, x - a / 2, odd)) / a[:, None]


def stiffness(basis: Basis, body: Body) -> csc_matrix:
    """2 mu e:e + lambda (projected div u)^2, the divergence projected on linear functions of each element."""
    lam, mu = lame(body.modulus, body.poisson)
    x, dx = np.asarray(basis.global_coordinates()), basis.dx
    middle = (x.max(2) + x.min(2))[:, :, None] / 2
    p = np.concatenate([np.ones((1, *dx.shape)), (x - middle) / np.ptp(x, axis=2)[:, :, None]])
    grad = np.stack([np.broadcast_to(b[0].grad, (3, *dx.shape)) for b in basis.basis])
    D = np.einsum("peq,aieq,eq->epai", p, grad, dx, optimize=True).reshape(len(dx), 4, -1)
    mass = np.einsum("peq,req,eq->epr", p, p, dx)
    K = lam * D.transpose(0, 2, 1) @ np.linalg.solve(mass, D)
    dofs = (3 * basis.element_dofs.T[:, :, None] + np.arange(3)).reshape(len(dx), -1)
    rows, columns = np.broadcast_arrays(dofs[:, :, None], dofs[:, None, :])
    volume = coo_matrix((K.ravel(), (rows.ravel(), columns.ravel())), shape=(3 * basis.N,) * 2)
    return stiffness_matrix(basis, 0.0, mu) + volume.tocsc()


def _dissected(place: np.ndarray, nodes: np.ndarray) -> np.ndarray:
    """The nodes in an order that keeps factors sparse: halves first, then what parts them."""
    at = place[:, nodes]
    low, high = at.min(1), at.max(1)
    middle = (low + high) // 4 * 2  # elements meet at even places
    cut = [(int((at[i] == middle[i]).sum()), i) for i in range(3) if low[i] < middle[i] < high[i]]
    if not cut:
        return nodes
    _, i = min(cut)
    sides = (nodes[at[i] < middle[i]], nodes[at[i] > middle[i]])
    return np.concatenate([_dissected(place, side) for side in sides] + [nodes[at[i] == middle[i]]])


class SolidFace:
    """Influence of a pad's patches on those of any pad of its shape.

    Raises
    ------
    InputError
        A body that these elements do not reach.
    """

    def __init__(
        self,
        body: Body,
        patches: np.ndarray,
        sides: tuple[float, float],
        reach: tuple[float, float],
        halves: int = HALVES,
    ) -> None:
        """`patches`: x, y and sides of one pad's, [4, patch]; `sides` of the pad; `reach`: how far the pads
        lie apart at the most; both along x and y. All in mm."""
        side = (sides[0] * sides[1]) ** 0.5
        if body.poisson > LARGEST_POISSON:
            legal = f"at most {LARGEST_POISSON:g} by rung fem-object; rung layer reaches 0.5"
            raise InputError("object nu", "out of range", value=body.poisson, legal=legal)
        if body.thickness < THINNEST * side:
            legal = f"at least {THINNEST * side:.3g} mm by rung fem-object, {THINNEST:g} of a pad's side"
            raise InputError("object thickness", "too thin", value=body.thickness, legal=legal)
        if body.thickness > THICKEST * side:
            legal = f"at most {THICKEST * side:.3g} mm by rung fem-object; rung layer reaches the half-space"
            raise InputError("object thickness", "too thick", value=body.thickness, legal=legal)
        h = body.thickness
        self.patches = patches
        self.lines = [lines_over_pad(s / 2, s / 2 + r + FAR_SIDE * h, halves) for s, r in zip(sides, reach)]
        fine = min(line[halves] - line[halves - 1] for line in self.lines)
        z = np.concatenate([[0.0], outward(0.0, fine, h)])
        basis = Basis(MeshHex.init_tensor(*self.lines, -z[::-1]), ElementHex2(), intorder=5)
        A = stiffness(basis, body)
        # every node's place on the grid of elements' corners (even) and middles (odd)
        place = np.stack([np.unique(np.round(p / side, 9), return_inverse=True)[1] for p in basis.doflocs])
        top = np.flatnonzero(place[2] == place[2].max())
        top = top[np.lexsort((place[1, top], place[0, top]))]
        order = (3 * _dissected(place, np.arange(basis.N))[:, None] + np.arange(3)).ravel()
        # a base that slips is kept from turning at its far corner
        corner = (place[0] == place[0].max()) & (place[1] == place[1].max()) & (place[2] == 0)
        x, y = patches[:2]
        quarter = np.flatnonzero((x > 0) & (y > 0))
        # of every patch: which of the quarter's it mirrors
        apart = np.abs(np.abs(x)[:, None] - x[quarter]) + np.abs(np.abs(y)[:, None] - y[quarter])
        self.mirrored = apart.argmin(1)
        self.moved = {}  # the face by 1 N on each patch of the quarter, [patch, x, y]
        for odd in [(False, False), (False, True), (True, False), (True, True)]:
            held = np.zeros((3, basis.N), bool)
            held[0 if body.base == "bonded" else 2 :, place[2] == 0] = True
            held[:, corner] = True
            for axis in (0, 1):
                # in a plane of symmetry nothing moves across it, of antisymmetry only that
                still = [i for i in range(3) if (i == axis) != odd[axis]]
                held[np.ix_(still, place[axis] == 0)] = True
            free = order[~held.T.ravel()[order]]
            factors = splu(
                A[free][:, free], permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
            )
            f = np.zeros((3 * basis.N, len(quarter)))
            f[3 * top + 2] = np.einsum("sx,sy->xys", *self._on_lines(quarter, (0.0, 0.0), odd)).reshape(
                len(top), -1
            )
            u = np.zeros_like(f)
            u[free] = factors.solve(f[free])
            self.moved[odd] = u[3 * top + 2].T.reshape(
                len(quarter), *(2 * len(line) - 1 for line in self.lines)
            )

    def _on_lines(
        self, which: np.ndarray, offset: tuple[float, float], odd: tuple[bool, bool]
    ) -> tuple[np.ndarray, ...]:
        at, sides = self.patches[:2, which], self.patches[2:, which]
        return tuple(_means(self.lines[i], at[i] + offset[i], sides[i], odd[i]) for i in (0, 1))

    def block(self, dx: float, dy: float) -> np.ndarray:
        """Mean displacement of every patch of a pad that lies dx, dy from the one whose patch bears 1 N,
        mm/N, [patch, loaded patch]."""
        x, y = self.patches[:2]
        result = np.zeros((len(x),) * 2)
        for odd, moved in self.moved.items():
            on_x, on_y = self._on_lines(np.arange(len(x)), (dx, dy), odd)
            of_quarter = np.einsum("tx,sxy,ty->ts", on_x, moved, on_y, optimize=True)
            sign = np.where((x < 0) & odd[0], -1, 1) * np.where((y < 0) & odd[1], -1, 1)
            result += of_quarter[:, self.mirrored] * sign / 4
        return result
