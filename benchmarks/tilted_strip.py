"""How far rung `large` errs where a pad tilts: a long rigid strip pressed askew into a neo-Hookean layer.

    python benchmarks/tilted_strip.py

Plane strain, by the elements of `contact.large_strain`. The face sticks to the strip, and leaves it where it
would be pulled. Rung large takes the force of the linear layer under the same strip, times what large strain
adds to a level one that bears as much.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse.linalg import splu
from skfem import MeshQuad

from tactcad.contact.elastic_body import Body
from tactcad.contact.large_strain import ACROSS, EDGE, FREE_SIDE, MOST_CORRECTIONS, _Rings
from tactcad.contact.solid_face import lines_over_pad, outward

STEPS, DEPTH = 12, 0.24  # down to this share of the lesser of half the strip's width and the thickness
SETTLED = 1e-8  # of half the width: the last correction
BODIES = tuple((nu, h) for h in (0.5, 1.0, 3.0) for nu in (0.3, 0.49))  # h in halves of the width
TILTS = (0.5, 1.0, 1.5)  # fall from the middle to an edge, over the depth


class Strip(_Rings):
    """The layer's elements under a strip of half width 1; what rings call r is x here, from one free side to
    the other, and nothing strains along the strip."""

    def __init__(self, body: Body) -> None:
        h = body.thickness
        side = lines_over_pad(1.0, 1.0 + FREE_SIDE * h, ACROSS, EDGE)
        z = np.concatenate([[0.0], outward(0.0, side[ACROSS] - side[ACROSS - 1], h)])
        mesh = MeshQuad.init_tensor(np.concatenate([-side[:0:-1], side]), -z[::-1])
        self.lay(body, mesh, turned=False)
        x, z = self.basis.doflocs
        self.punched = np.flatnonzero((z > -1e-9) & (np.abs(x) < 1 + 1e-9))
        bottom = np.flatnonzero(z < -h + 1e-9)
        self.held = np.concatenate([2 * bottom, 2 * bottom + 1])

    def pressed(self, depth: float, fall: float, linear: bool) -> np.ndarray:
        """Forces at STEPS even steps down to a depth, the fall to an edge in proportion; fewer where an
        element folds."""
        x, down = self.basis.doflocs[0, self.punched], 2 * self.punched + 1
        u, on, forces = np.zeros(2 * self.basis.N), np.ones(len(x), bool), []
        K = self.forces(u)[1]
        for share in np.arange(1, STEPS + 1) / STEPS:
            wanted = -share * (depth + fall * x)
            for _ in range(30):
                set_ = down[on]
                free = np.setdiff1d(np.arange(len(u)), np.concatenate([self.held, set_, set_ - 1]))
                moved = np.zeros(len(u))
                moved[set_] = wanted[on] - u[set_]
                try:
                    u, R = self._linear(u, moved, free, K) if linear else self._large(u, moved, free)
                except FloatingPointError:
                    return np.array(forces)
                now = np.where(on, R[down] < 1e-9, u[down] > wanted + 1e-9)
                if (now == on).all():
                    break
                on = now
            forces.append(float(-R[down[on]].sum()))
        return np.array(forces)

    def _linear(self, u, moved, free, K) -> tuple[np.ndarray, np.ndarray]:
        moved[free] = splu(K[free][:, free]).solve(-(K @ (u + moved))[free])
        return u + moved, K @ (u + moved)

    def _large(self, u, moved, free) -> tuple[np.ndarray, np.ndarray]:
        p = None
        for _ in range(MOST_CORRECTIONS):
            R, K, own, by_u = self.forces(u, p)
            moved[free] = splu(K[free][:, free]).solve(-(R + K @ moved)[free])
            u, p = u + moved, own + np.einsum("epn,en->ep", by_u, moved[self.dofs])
            if np.abs(moved).max() <= SETTLED:
                return u, self.forces(u)[0]
            moved = np.zeros(len(u))
        raise FloatingPointError


def errors(body: Body, tilt: float) -> tuple[np.ndarray, np.ndarray]:
    """Depths of a level strip that bears as much, over the lesser of half the width and the thickness, and
    the errors of rung large there."""
    strip, least = Strip(body), min(1.0, body.thickness)
    at = DEPTH * least * np.arange(1, STEPS + 1) / STEPS
    level, flat = (strip.pressed(at[-1], 0.0, linear) for linear in (False, True))
    right, linear = (strip.pressed(at[-1], tilt * at[-1], linear) for linear in (False, True))
    alone, n = linear / flat[0] * at[0], len(level)
    large = linear * np.interp(alone, np.r_[0.0, at[:n]], np.r_[1.0, level / flat[:n]])
    known = alone[: len(right)] <= at[n - 1] * (1 + 1e-9)
    return (alone[: len(right)] / least)[known], (large[: len(right)] / right - 1)[known]


def coefficients() -> list[float]:
    """The largest error over depth and the square of the tilt, by thickness."""
    largest: dict[float, float] = {}
    for nu, h in BODIES:
        for tilt in TILTS:
            depth, off = errors(Body(1.0, nu, h), tilt)
            print(f"nu {nu:g}, h {h:g}, tilt {tilt:g}:", *(f"{d:.2f} {e:+.1%}" for d, e in zip(depth, off)))
            largest[h] = max(largest.get(h, 0.0), float(np.abs(off / depth).max()) / tilt**2)
    return [*largest.values()]


if __name__ == "__main__":
    print(coefficients())
