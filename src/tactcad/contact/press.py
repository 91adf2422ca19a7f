"""Rigid pads that sink and tilt, pressed on an elastic body: which parts touch, and the force on each pad.

Each pad is cut into patches of even pressure, finer toward its edges, where the pressure of a rigid punch is
singular. A pad gives way by its compliance: sink (mm) and slopes along x and y under a force (N) and its
moments (N mm) about the pad's middle. Force f of every patch and gap g between patch and face obey f >= 0, g
>= 0, f g = 0 with

    g = C f + (pads' own giving way) + height + inclination - approach,

which has one solution, since the compliances are positive definite. A pad that reaches its stop sinks no
further.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from math import inf, radians, tan

import numpy as np
from scipy.linalg.lapack import dpotrf, dpotrs  # thousands of calls: without checks a third quicker

from tactcad.design.messages import InputError

from .elastic_body import Body, influence

# A side of a pad: a round punch on a layer is 0.07 to 0.18 % soft by Hayes' equation (with 8: 0.3 to 0.8 %).
PATCHES = 12
GRADING = 2.0  # power toward the edges; 3 and 4 are as good on thick layers, and 1 to 16 % off on thin ones
SOLVED = 1e-13  # relative, of displacements by the forces on patches
PATIENCE = 10  # rounds in which as many patches are wrong as before
THINNEST = 0.25  # of the root of a pad's area: thinner layers want more patches, 0.4 % at 0.17


@dataclass(frozen=True)
class Pads:
    """Rigid pads, each on a spring of its own.

    x, y        middles, mm, [pad]
    length      along x, mm
    width       along y, mm; a disc's diameter is its length and width
    compliance  of each pad, [pad, 3, 3]: from force (N) and its moments (N mm) along x and y to sink (mm) and
                slopes
    height      distance of each pad below the plane of the highest, mm, [pad]
    stop        sink at which each is stopped, mm, [pad]; inf without
    disc        round pads
    """

    x: np.ndarray
    y: np.ndarray
    length: float
    width: float
    compliance: np.ndarray
    height: np.ndarray
    stop: np.ndarray
    disc: bool = False


@dataclass(frozen=True)
class Pressed:
    """Pads pressed on a body.

    approach  of the array toward the body since the plane of its pads met the body's middle, mm
    force     on each pad, N, [pad]
    sink      of each pad's middle, mm, [pad]
    slope     of each pad along x and y, [pad, 2]
    contact   share of each pad's area that presses, [pad]
    stopped   whether each pad rests on its stop, [pad]
    patches   x, y, sides along x and y (mm) of every patch, and its force (N), [5, pad, patch]
    """

    approach: float
    force: np.ndarray
    sink: np.ndarray
    slope: np.ndarray
    contact: np.ndarray
    stopped: np.ndarray
    patches: np.ndarray


@lru_cache(maxsize=16)
def patches(length: float, width: float, disc: bool, number: int = PATCHES) -> np.ndarray:
    """x, y and sides of one pad's patches about its middle, mm, [4, patch]; a disc's rows have its area."""
    t = np.linspace(-1, 1, number + 1)
    edges = np.sign(t) * (1 - (1 - np.abs(t)) ** GRADING) / 2
    middle, side = (edges[1:] + edges[:-1]) / 2, np.diff(edges)
    y, b = np.repeat(middle, number), np.repeat(side, number)
    below = edges * np.sqrt(np.maximum(1 - 4 * edges**2, 0.0)) / 2 + np.arcsin(2 * edges) / 4  # a disc's area
    chord = np.repeat(np.diff(below), number) / b if disc else 1.0
    x, a = np.tile(middle, number) * chord, np.tile(side, number) * chord
    return np.array([x * length, y * width, a * length, b * width])


class Face:
    """Compliance of a body's face under equal pads, which depends on their distance only: `blocks`, [place,
    patch, patch], and the place that pad i has from pad j, ~place where the block is turned round, [i, j]."""

    def __init__(self, blocks: np.ndarray, place: np.ndarray) -> None:
        self.blocks, self.place = blocks, place
        self.pairs = [np.nonzero(place == k) for k in range(-len(blocks), len(blocks))]

    def moved(self, f: np.ndarray) -> np.ndarray:
        """Displacements by forces, both [..., pad, patch]."""
        out, blocks = np.zeros_like(f), (*self.blocks[::-1], *self.blocks.swapaxes(1, 2))
        for (i, j), block in zip(self.pairs, blocks):
            if len(i):
                out[..., i, :] += f[..., j, :] @ block
        return out


class PadsOnBody:
    """The pads on one body, set up once: then `press` as often as wanted.

    Raises
    ------
    InputError
        A body that the rung does not reach.
    """

    def __init__(self, pads: Pads, body: Body, rung: str = "layer") -> None:
        """`rung`: "layer", or "fem-object", where solid elements give the body's influence."""
        self.pads, self.body = pads, body
        one = patches(pads.length, pads.width, pads.disc)
        block = (_block_by_elements if rung == "fem-object" else _block_of_layer)(pads, body, one)
        n, m = len(pads.x), one.shape[1]
        self.at = np.empty((4, n, m))
        self.at[0], self.at[1] = pads.x[:, None] + one[0], pads.y[:, None] + one[1]
        self.at[2:] = one[2:, None, :]
        apart = np.stack([pads.x[:, None] - pads.x, pads.y[:, None] - pads.y], axis=-1).reshape(-1, 2)
        apart = np.round(apart, 9)
        turned = (apart[:, 0] < 0) | (apart[:, 0] == 0) & (apart[:, 1] < 0)
        places, which = np.unique(np.where(turned[:, None], -apart, apart), axis=0, return_inverse=True)
        # elements differ from pad to pad, and sixteen differences of a rectangle lose digits
        blocks = np.array(
            [
                (block(dx, dy) + block(-dx, -dy).T) / 2
                if rung == "fem-object" or not (dx or dy)
                else block(dx, dy)
                for dx, dy in places
            ]
        )
        self.face = Face(blocks, np.where(turned, ~which.ravel(), which.ravel()).reshape(n, n))
        # sink and slopes to displacement of a patch, [3, patch]
        self.modes = np.stack([np.ones(m), one[0], one[1]])

    def press(
        self,
        load: float | None = None,
        approach: float | None = None,
        angle: tuple[float, float] = (0.0, 0.0),
        modulus: float | None = None,
        hardened: np.ndarray | None = None,
    ) -> Pressed:
        """Press by a total force (N) or by an approach (mm).

        Parameters
        ----------
        load, approach
            One of them.
        angle
            Inclination of the face along x and along y, degrees: positive where it falls away toward +x, +y.
        modulus
            Of the body, MPa, instead of its own.
        hardened
            Force on each pad over what a linear body would bear at the same depth, [pad]; 1 by default.

        Raises
        ------
        InputError
            No load or approach above zero.
        """
        given = approach if load is None else load
        if given is None or not 0 < given < inf:
            what = "approach" if load is None else "load"
            raise InputError(what, "out of range", value=given, legal="above 0")
        soft = 1.0 if modulus is None else self.body.modulus / modulus
        n, m = self.at.shape[1:]
        back = (
            self.pads.height[:, None]
            + self.at[0] * tan(radians(angle[0]))
            + self.at[1] * tan(radians(angle[1]))
        )
        stopped = np.zeros(n, bool)
        hard = np.ones(n) if hardened is None else hardened
        for _ in range(4 * n + 4):
            result, held = self._with_stops(soft, hard, back, stopped, load, approach)
            beyond = ~stopped & (result.sink > self.pads.stop * (1 + 1e-12))
            free = stopped & (held < 0)
            if not beyond.any() and not free.any():
                return result
            stopped = (stopped | beyond) & ~free
        raise RuntimeError("stops neither close nor open")

    def _with_stops(
        self,
        soft: float,
        hard: np.ndarray,
        back: np.ndarray,
        stopped: np.ndarray,
        load: float | None,
        approach: float | None,
    ) -> tuple[Pressed, np.ndarray]:
        """Contact with the given pads on their stops, and the force of each stop (N)."""
        n, m = back.shape
        D = self.pads.compliance.copy()
        lever = D[:, :, 0] / D[:, :1, 0]  # how a pad moves where its middle sinks by 1
        fixed = np.where(stopped, self.pads.stop, 0.0)[:, None] * lever
        D[stopped] -= lever[stopped][:, :, None] * D[stopped][:, :1, :]
        springs = hard[:, None, None] * D
        # the unknown is the force on a linear body; the pad bears `hard` times as much
        own = soft * self.face.blocks[self.face.place[0, 0]] + self.modes.T @ springs @ self.modes
        gap = back + np.where(stopped[:, None], fixed @ self.modes, 0.0)
        right = np.stack([np.ones((n, m)), gap])
        close = SOLVED * np.abs(right).max((1, 2), keepdims=True)
        last = [np.zeros((n, m), bool), np.broadcast_to(np.eye(m), own.shape).copy(), 0.0 * right]

        def moved(f: np.ndarray) -> np.ndarray:
            turned = np.einsum("nij,...nj->...ni", springs, f @ self.modes.T)
            return soft * self.face.moved(f) + turned @ self.modes

        def solve(active: np.ndarray) -> np.ndarray:
            """By conjugate gradients: each pad alone is solved, its neighbours follow."""
            on = active.reshape(n, m)
            was, inverse, f = last
            other = (on != was).any(1)
            inverse[other] = np.linalg.inv(
                np.where(on[other, :, None] & on[other, None, :], own[other], np.eye(m))
            )
            eased = lambda left: (inverse @ left[..., None])[..., 0]  # noqa: E731
            f = _conjugate(lambda f: moved(f) * on, eased, right * on, f * on, close)
            last[:] = on, inverse, f
            return f.reshape(2, -1)

        every, share = np.ones(n * m, bool), np.repeat(hard, m)
        over = lambda f: moved(f.reshape(n, m)).ravel()  # noqa: E731
        f, at = _exchange(solve, over, gap.ravel(), load, approach, share, every)
        f = hard[:, None] * f.reshape(n, m)
        generalised = f @ self.modes.T  # force and moments of each pad
        motion = np.einsum("nij,nj->ni", D, generalised) + fixed
        area = self.at[2] * self.at[3]
        # what the pad's own spring does not bear at its stop's sink
        held = np.einsum("ni,ni->n", lever, generalised) - self.pads.stop / self.pads.compliance[:, 0, 0]
        result = Pressed(
            at,
            generalised[:, 0],
            motion[:, 0],
            motion[:, 1:],
            (area * (f > 0)).sum(1) / area.sum(1),
            stopped,
            np.concatenate([self.at, f[None]]),
        )
        return result, np.where(stopped, held, 0.0)


def complementary(
    M: np.ndarray,
    gap: np.ndarray,
    load: float | None,
    approach: float | None,
    share: np.ndarray,
    first: np.ndarray | None = None,
) -> tuple[np.ndarray, float]:
    """f >= 0 with M f + gap - approach >= 0 and one of them zero; the approach where the load, the sum of
    share f, is given. `first`: the patches assumed in contact at the start; by default all.
    """
    n = len(gap)

    def solve(active: np.ndarray) -> np.ndarray:
        f, rows = np.zeros((2, n)), np.flatnonzero(active)
        if len(rows):
            factor, failed = dpotrf(M.take(rows, 0).take(rows, 1), lower=1, clean=0)
            if failed:
                raise np.linalg.LinAlgError(f"influence of patches is not positive definite ({failed})")
            f[:, rows] = dpotrs(factor, np.column_stack([np.ones(len(rows)), gap[rows]]), lower=1)[0].T
        return f

    active = np.ones(n, bool) if first is None or not first.any() else first
    return _exchange(solve, lambda f: M @ f, gap, load, approach, share, active)


def _exchange(
    solve: Callable[[np.ndarray], np.ndarray],
    moved: Callable[[np.ndarray], np.ndarray],
    gap: np.ndarray,
    load: float | None,
    approach: float | None,
    share: np.ndarray,
    active: np.ndarray,
) -> tuple[np.ndarray, float]:
    """As `complementary`; `solve` gives the forces on active patches for a displacement of 1 and for the gap.

    Patches in tension leave, patches that overlap come back, until neither is left. Should their number stay,
    one at a time, which ends for every positive definite matrix (Murty 1974).
    """
    fewest, patience = len(gap) + 1, PATIENCE
    while True:
        both = solve(active)
        at = (load + share @ both[1]) / (share @ both[0]) if approach is None else approach
        f = at * both[0] - both[1]
        wrong = np.where(active, f < 0, moved(f) + gap - at < -1e-12 * max(abs(at), 1e-300))
        if not (count := int(wrong.sum())):
            return f, float(at)
        if count < fewest:
            fewest, patience = count, PATIENCE
        elif patience:
            patience -= 1
        else:
            wrong[: np.flatnonzero(wrong)[-1]] = False
        active = active ^ wrong


def _conjugate(
    moved: Callable[[np.ndarray], np.ndarray],
    eased: Callable[[np.ndarray], np.ndarray],
    right: np.ndarray,
    x: np.ndarray,
    close: np.ndarray,
) -> np.ndarray:
    """Solves moved(x) = right for several right sides, [side, ...], from x, until what is left is as small as
    `close`; `eased` is a rough inverse."""
    inner = lambda a, b: np.einsum("sij,sij->s", a, b)[:, None, None]  # noqa: E731
    left = right - moved(x)
    way = eased(left)
    energy = inner(left, way)
    for _ in range(right[0].size):
        if not (np.abs(left) > close).any():
            break
        back = moved(way)
        step = energy / np.maximum(inner(way, back), 1e-300)
        x, left = x + step * way, left - step * back
        now = eased(left)
        energy, before = inner(left, now), np.maximum(energy, 1e-300)
        way = now + energy / before * way
    return x


def _block_of_layer(pads: Pads, body: Body, one: np.ndarray) -> Callable[[float, float], np.ndarray]:
    least = THINNEST * (pads.length * pads.width) ** 0.5
    if body.thickness < least:
        legal = f"at least {least:.3g} mm, a quarter of a pad's side"
        raise InputError("object thickness", "too thin for this rung", value=body.thickness, legal=legal)
    return lambda dx, dy: influence(body, (one[0] + dx, one[1] + dy, *one[2:]), tuple(one))


def _block_by_elements(pads: Pads, body: Body, one: np.ndarray) -> Callable[[float, float], np.ndarray]:
    from .solid_face import SolidFace  # scikit-fem takes a while to load

    reach = float(np.ptp(pads.x)), float(np.ptp(pads.y))
    return SolidFace(body, one, (pads.length, pads.width), reach).block


@lru_cache(maxsize=64)
def pad_stiffness(body: Body, length: float, width: float, disc: bool = False) -> float:
    """Force on one rigid pad that does not tilt over its displacement, N/mm: K_obj of a body."""
    C = influence(body, tuple(patches(length, width, disc)))
    return float(np.linalg.solve(C, np.ones(len(C))).sum())
