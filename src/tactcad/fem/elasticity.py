"""Linear elasticity: stiffness matrix, load and solution on scikit-fem's spaces."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix, csc_matrix
from scipy.sparse.linalg import SuperLU, splu
from skfem import Basis

from tactcad.design.messages import CheckFailure

Array = NDArray[np.float64]

# of the compliance; a leaf a hundred times longer than thick stays below 2e-6 (tests/extremes)
MOST_ROUNDING = 1e-4


def lame(E: float, nu: float, plane_stress: bool = False) -> tuple[float, float]:
    """lambda and mu, MPa; for plane stress lambda* = E nu/(1 - nu^2)."""
    lam = E * nu / (1.0 - nu * nu) if plane_stress else E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
    return lam, E / (2.0 * (1.0 + nu))


def stiffness_matrix(basis: Basis, lam: float, mu: float) -> csc_matrix:
    """A[(a,i),(b,j)] = int lam d_i a d_j b + mu (d_j a d_i b + delta_ij grad a . grad b) dx.

    `basis` is scalar; unknown dim n + i is component i of its node n. All elements at once: one
    matrix product an element gives the integrals T[a,i,b,j] = int d_i a d_j b dx.
    """
    dim, functions = basis.mesh.dim(), basis.Nbfun
    # a, i, element, point
    grad = np.stack([np.broadcast_to(b[0].grad, (dim, *basis.dx.shape)) for b in basis.basis])
    g = np.ascontiguousarray(grad.transpose(2, 0, 1, 3)).reshape(len(basis.dx), functions * dim, -1)
    T = np.matmul(g * basis.dx[:, None, :], g.transpose(0, 2, 1))
    T = T.reshape(-1, functions, dim, functions, dim)
    A = lam * T + mu * T.transpose(0, 1, 4, 3, 2)
    trace = mu * np.einsum("eaibi->eab", T)
    for i in range(dim):
        A[:, :, i, :, i] += trace
    dofs = dim * basis.element_dofs.T[:, :, None] + np.arange(dim)
    size = functions * dim
    rows = np.broadcast_to(dofs.reshape(-1, size, 1), (len(A), size, size))
    cols = np.broadcast_to(dofs.reshape(-1, 1, size), (len(A), size, size))
    return coo_matrix((A.ravel(), (rows.ravel(), cols.ravel())), shape=(dim * basis.N,) * 2).tocsc()


def solve(A: csc_matrix, f: Array, fixed: Array) -> Array:
    """Displacements with some unknowns fixed at zero; A symmetric and positive definite, by SuperLU.

    Parameters
    ----------
    A : sparse matrix, shape (n, n)
        Stiffness, N/mm.
    f : ndarray, shape (n,)
        Load, N.
    fixed
        Indices of the fixed unknowns.

    Raises
    ------
    CheckFailure
        If one step of iterative refinement changes the compliance by more than MOST_ROUNDING: for a leaf
        hundreds of times longer than thick double precision is not enough.
    """
    free = np.setdiff1d(np.arange(len(f)), fixed)
    u = np.zeros_like(f)
    u[free], rounding = refined(A[free][:, free].tocsc(), f[free])
    if not rounding <= MOST_ROUNDING:
        raise CheckFailure(
            f"rounding moves the compliance by {rounding:.1g} of itself, more than {MOST_ROUNDING:g}: "
            "the hinge is too long and thin for these elements"
        )
    return u


def refined(A: csc_matrix, f: Array) -> tuple[Array, float]:
    """Solution of A u = f after one step of iterative refinement, and that step's share of f u."""
    factors = factorised(A)
    u = factors.solve(f)
    step = factors.solve(f - A @ u)
    return u + step, abs(float(f @ step)) / float(f @ u)


def factorised(A: csc_matrix) -> SuperLU:
    """Factors of a symmetric positive definite matrix, without pivoting."""
    return splu(A, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
