"""A rigid round punch pressed deep into a bonded neo-Hookean layer: what large strain adds to linear theory.

    W = mu/2 (J^(-2/3) F:F - 3) + kappa/2 (J - 1)^2,    P = mu J^(-2/3) (F - F:F/3 F^-T) + p J F^-T

with p = kappa (J - 1), J projected on linear functions of each element: quadratic rings that do not lock.
Turned about the punch's axis, with Newton's method in steps of depth. W is CalculiX's neo-Hookean law.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from math import pi

import numpy as np
from scipy.sparse import coo_matrix, csc_matrix
from scipy.sparse.linalg import splu
from skfem import Basis, ElementQuad2, MeshQuad

from tactcad.design.messages import InputError

from .elastic_body import Body
from .press import PadsOnBody, Pressed, pad_stiffness
from .solid_face import LARGEST_POISSON, lines_over_pad, outward
from .stated_errors import REACH, pad_radius

ACROSS, EDGE = 8, 1.0
DEEPEST = 30.0  # radii: of thicker bodies this much is meshed
FREE_SIDE = 5.0  # thicknesses from the punch to the free side; it sticks to its base, so 5 are enough
THINNEST = 0.44  # of the radius: thinner layers were not tried
STEP = 0.02  # of the lesser of radius and thickness, in depth
SETTLED = 1e-9  # of the depth: Newton's last correction
MOST_CORRECTIONS = 15
AXES = ((0, 0), (0, 2), (2, 0), (2, 2), (1, 1))  # r, hoop, z: entries of F that are not always 0


class _Rings:
    """The layer's elements around the punch."""

    def __init__(self, body: Body, radius: float, wall: float | None = None) -> None:
        """`wall`: radius at which the layer's side slips on a rigid wall, as it does halfway between equal
        punches all around, mm; by default the side is free, far away."""
        h = min(body.thickness, DEEPEST * radius)
        lines = lines_over_pad(radius, wall or radius + FREE_SIDE * h, ACROSS, EDGE)
        z = np.concatenate([[0.0], outward(0.0, lines[ACROSS] - lines[ACROSS - 1], h)])
        self.lay(body, MeshQuad.init_tensor(lines, -z[::-1]), turned=True)
        r, z = self.basis.doflocs
        top, near = z > -1e-9 * h, 1e-9 * radius
        self.punched = np.flatnonzero(top & (r < radius + near))
        bottom = np.flatnonzero(z < -h + 1e-9 * h)
        held = [2 * bottom + 1, 2 * np.flatnonzero(r < near)]
        held += [2 * bottom] if body.base == "bonded" else []
        held += [2 * np.flatnonzero(r > wall - near)] if wall else []
        self.held = np.unique(np.concatenate(held))

    def lay(self, body: Body, mesh: MeshQuad, turned: bool) -> None:
        """Set up the elements of a section: turned about z, or endless and strained in its plane alone."""
        basis = self.basis = Basis(mesh, ElementQuad2(), intorder=5)
        self.mu = body.modulus / (2 * (1 + body.poisson))
        self.kappa = body.modulus / (3 * (1 - 2 * body.poisson))
        at = np.asarray(basis.global_coordinates())
        self.volume = 2 * pi * at[0] * basis.dx if turned else np.array(basis.dx)
        middle = (at.max(2) + at.min(2))[:, :, None] / 2
        self.linear = np.concatenate(
            [np.ones((1, *at.shape[1:])), (at - middle) / np.ptp(at, axis=2)[:, :, None]]
        )
        self.mass = np.einsum("peq,req,eq->epr", self.linear, self.linear, self.volume)
        # from an element's displacements to the five entries of F - 1, [element, point, entry, 2 node]
        self.B = np.zeros((*basis.dx.shape, 5, 2 * basis.Nbfun))
        for n, field in enumerate(basis.basis):
            slope = np.broadcast_to(field[0].grad, (2, *basis.dx.shape))
            self.B[:, :, 0, 2 * n], self.B[:, :, 1, 2 * n] = slope
            self.B[:, :, 2, 2 * n + 1], self.B[:, :, 3, 2 * n + 1] = slope
            if turned:
                self.B[:, :, 4, 2 * n] = np.broadcast_to(np.asarray(field[0]), basis.dx.shape) / at[0]
        self.dofs = (2 * basis.element_dofs.T[:, :, None] + np.arange(2)).reshape(len(basis.dx), -1)
        self.rows, self.columns = np.broadcast_arrays(self.dofs[:, :, None], self.dofs[:, None, :])

    def forces(
        self, u: np.ndarray, p: np.ndarray | None = None
    ) -> tuple[np.ndarray, csc_matrix, np.ndarray, np.ndarray]:
        """Forces on the nodes for displacements u, and their derivative; each element's pressure,
        kappa (J - 1), and its derivative by the element's displacements, [element, 4 (, 2 node)].

        The derivative of the forces is taken at the pressures p, if they are given: Newton's method then
        treats them as unknowns of their own. Taken at those of u it diverges from nu 0.4995 on, as the volume
        that a step changes in second order is a large pressure. Raises FloatingPointError if an element is
        turned inside out."""
        F = np.broadcast_to(np.eye(3), (*self.volume.shape, 3, 3)).copy()
        for k, (i, j) in enumerate(AXES):
            F[:, :, i, j] += np.einsum("eqn,en->eq", self.B[:, :, k], u[self.dofs])
        J = np.linalg.det(F)
        if not (J > 0).all():
            raise FloatingPointError
        T = np.linalg.inv(F).swapaxes(2, 3)  # F^-T
        total = np.einsum("peq,eq,eq->ep", self.linear, J, self.volume)
        own = self.kappa * _solve(self.mass, total)
        own[:, 0] -= self.kappa
        now, p = (np.einsum("peq,ep->eq", self.linear, of) for of in (own, own if p is None else p))
        I1, s = np.einsum("eqij,eqij->eq", F, F), self.mu * J ** (-2 / 3)
        P = s[..., None, None] * (F - I1[..., None, None] / 3 * T) + (now * J)[..., None, None] * T
        rows, columns = np.array(AXES).T
        f, t = F[:, :, rows, columns], T[:, :, rows, columns]
        crossed = T[:, :, rows[:, None], columns] * T[:, :, rows, columns[:, None]]  # T_iL T_kJ
        tt = t[..., :, None] * t[..., None, :]
        ft = f[..., :, None] * t[..., None, :]
        A = s[..., None, None] * (
            np.eye(5) - 2 / 3 * (ft + ft.swapaxes(2, 3)) + I1[..., None, None] * (2 / 9 * tt + crossed / 3)
        ) + (p * J)[..., None, None] * (tt - crossed)
        BV = self.B * self.volume[:, :, None, None]
        R = np.einsum("eqkn,eqk->en", BV, P[:, :, rows, columns])
        D = np.einsum("peq,eqkn,eqk->epn", self.linear, BV, J[..., None] * t)
        K = np.einsum("eqkn,eqkm->enm", BV, np.einsum("eqkl,eqlm->eqkm", A, self.B), optimize=True)
        by_u = self.kappa * np.linalg.solve(self.mass, D)
        K += D.swapaxes(1, 2) @ by_u
        size = 2 * self.basis.N
        tangent = coo_matrix((K.ravel(), (self.rows.ravel(), self.columns.ravel())), shape=(size, size))
        return np.bincount(self.dofs.ravel(), R.ravel(), size), tangent.tocsc(), own, by_u


def _solve(mass: np.ndarray, right: np.ndarray) -> np.ndarray:
    return np.linalg.solve(mass, right[..., None])[..., 0]


@lru_cache(maxsize=16)
def punch(
    body: Body, radius: float, depth: float, wall: float | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Force of a rigid round punch, under which the face does not slide, over its depth.

    Parameters
    ----------
    body
        Layer on a base, nu at most LARGEST_POISSON.
    radius
        Of the punch, mm.
    depth
        Down to which, mm.
    wall
        As of `_Rings`.

    Returns
    -------
    depths, forces
        mm, N, from 0 up; they end before `depth` where an element would turn inside out.
    """
    rings = _Rings(body, radius, wall)
    fixed = np.concatenate([rings.held, 2 * rings.punched, 2 * rings.punched + 1])
    steps = int(np.ceil(depth / (STEP * min(radius, body.thickness))))
    depths, forces, u = [0.0], [0.0], np.zeros(2 * rings.basis.N)
    for at in depth * np.arange(1, steps + 1) / steps:
        try:
            u = _step(rings, u, fixed, at)
        except FloatingPointError:
            break
        depths.append(at)
        forces.append(float(-rings.forces(u)[0][2 * rings.punched + 1].sum()))
    return np.array(depths), np.array(forces)


def initial_stiffness(body: Body, radius: float, wall: float | None = None) -> float:
    """Force of the punch over a vanishing depth, N/mm, on the same elements."""
    rings = _Rings(body, radius, wall)
    fixed = np.concatenate([rings.held, 2 * rings.punched, 2 * rings.punched + 1])
    K = rings.forces(np.zeros(2 * rings.basis.N))[1]
    u = np.zeros(K.shape[0])
    u[2 * rings.punched + 1] = -1.0
    free = np.setdiff1d(np.arange(len(u)), fixed)
    u[free] = splu(K[free][:, free]).solve(-(K @ u)[free])
    return float(u @ (K @ u))


def hardening(body: Body, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Force over that of linear theory, by depth (mm) up to REACH of the lesser of radius and thickness.

    Raises
    ------
    InputError
        nu above LARGEST_POISSON, a layer thinner than THINNEST radii.
    """
    if body.poisson > LARGEST_POISSON:
        legal = f"at most {LARGEST_POISSON:g} by rung large; --rung layer reaches 0.5"
        raise InputError("object nu", "out of range", value=body.poisson, legal=legal)
    if body.thickness < THINNEST * radius:
        legal = f"at least {THINNEST * radius:.3g} mm by rung large"
        raise InputError("object thickness", "too thin", value=body.thickness, legal=legal)
    unit = replace(body, modulus=1.0)  # force goes with the modulus: one solution for all
    depths, forces = punch(unit, radius, REACH * min(radius, body.thickness))
    return depths, np.append(1.0, forces[1:] / depths[1:] / initial_stiffness(unit, radius))


def press(contact: PadsOnBody, load: float, angle: tuple[float, float]) -> Pressed:
    """Pads pressed by a total load (N), each pad's force corrected by that of a round pad of its area, which
    alone and level would be pressed as deep.

    Raises
    ------
    InputError
        A body or a load that this rung does not reach.
    """
    pads, body = contact.pads, contact.body
    depths, factor = hardening(body, pad_radius(pads))
    alone = pad_stiffness(body, pads.length, pads.width, pads.disc)
    hard = np.ones(len(pads.x))
    for _ in range(MOST_CORRECTIONS):
        result = contact.press(load=load, angle=angle, hardened=hard)
        depth = result.force / hard / alone
        if depth.max() > depths[-1]:
            what = f"presses a pad {depth.max():.3g} mm deep, and no rung reaches that"
            raise InputError("--load", what, value=load, legal=f"at most {depths[-1]:.3g} mm by rung large")
        before, hard = hard, np.interp(depth, depths, factor)
        if np.abs(hard - before).max() < SETTLED:
            break
    return result


def _step(rings: _Rings, u: np.ndarray, fixed: np.ndarray, depth: float) -> np.ndarray:
    """Displacements at a depth, from those of the step before."""
    free = np.setdiff1d(np.arange(len(u)), fixed)
    pushed = np.zeros(len(u))
    punched = 2 * rings.punched + 1
    pushed[punched] = -depth - u[punched]
    p = None
    for _ in range(MOST_CORRECTIONS):
        R, K, own, by_u = rings.forces(u, p)
        pushed[free] = splu(K[free][:, free]).solve(-(R + K @ pushed)[free])
        u, p = u + pushed, own + np.einsum("epn,en->ep", by_u, pushed[rings.dofs])
        if np.abs(pushed).max() <= SETTLED * depth:
            return u
        pushed = np.zeros(len(u))
    raise FloatingPointError
