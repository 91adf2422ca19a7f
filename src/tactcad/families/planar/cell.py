"""A cell: a rigid island on four foil beams. Its stiffness in six freedoms, its beams' stress, its linear
range.

Freedoms x, y, z (mm) and turns about them (rad) of the island's middle, in the foil's mid-plane; z towards
the object. Foot plate and post keep the island rigid, spacers clamp the frame at its opening's edge.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from . import beam as closed
from .beam import MODES, Array, FoilBeam

NEWTON = 8  # steps to the root of a cubic that hardly bends


@dataclass(frozen=True)
class Root:
    """The point at which a beam leaves the island (x, y, mm), and the unit direction in which it runs to the
    frame."""

    at: tuple[float, float]
    along: tuple[float, float]


def roots(form: str, island: float, along: float, offset: float) -> tuple[Root, ...]:
    """The four beams' roots, each a quarter turn on.

    Of form "straight" from the middle of the island's sides (`island` long, mm), "pinwheel" beside the
    island, from an ear at a corner: x where the first beam leaves it, and y of its axis, mm.
    """
    first = Root((island / 2.0, 0.0), (1.0, 0.0)) if form == "straight" else Root((along, offset), (1.0, 0.0))
    turned = [first]
    for _ in range(3):
        (x, y), (u, v) = turned[-1].at, turned[-1].along
        turned.append(Root((-y, x), (-v, u)))
    return tuple(turned)


@dataclass(frozen=True)
class Cell:
    """Four equal beams about a rigid island."""

    beam: FoilBeam
    roots: tuple[Root, ...]

    @cached_property
    def modes(self) -> Array:
        """Relative motions of the beams' ends by the island's freedoms, (beams, modes, 6).

        A motion of the island's end by v across and a turn p is the rigid turn p/2 about the middle, even
        bending by p, and a guided end's v - s p/2.
        """
        half, rows = self.beam.length / 2.0, []
        for root in self.roots:
            (x, y), (u, v) = root.at, root.along
            # along, across, out: frame to island
            e = np.array([[-u, -v, 0.0], [v, -u, 0.0], [0.0, 0.0, 1.0]])
            move = np.zeros((3, 6))
            move[:, :3] = np.eye(3)
            move[:, 3:] = [[0.0, 0.0, -y], [0.0, 0.0, x], [y, -x, 0.0]]  # turns times the root's place
            d, turn = e @ move, np.hstack([np.zeros((3, 3)), e])
            rows.append([d[0], turn[0], -turn[1], d[2] + half * turn[1], turn[2], d[1] - half * turn[2]])
        return np.array(rows)

    @cached_property
    def stiffness(self) -> Array:
        """6 x 6: N/mm, N, N mm."""
        k = np.array([closed.stiffness(self.beam)[m] for m in MODES])
        return np.einsum("bmi,m,bmj->ij", self.modes, k, self.modes)

    @cached_property
    def compliance(self) -> Array:
        return np.asarray(np.linalg.inv(self.stiffness), dtype=float)

    def stress(self, wrench: Array) -> float:
        """Largest stress of any beam under a wrench on the island's middle (N, N mm), MPa: the modes' own
        largest von Mises stresses added, so never less than that of their sum."""
        per_motion = np.array([closed.stress(self.beam)[m] for m in MODES])
        motion = self.modes @ (self.compliance @ wrench)
        return float((np.abs(motion) @ per_motion).max())

    @cached_property
    def held(self) -> float:
        """Share of its beams' stretch that the island cannot give back by moving: 1 of straight beams,
        little of a pinwheel's, which turns."""
        k = closed.stiffness(self.beam)["axial"]
        pulled = k * self.modes[:, 0].sum(axis=0)
        return float(1.0 - pulled @ self.compliance @ pulled / (k * len(self.roots)))

    @cached_property
    def stiffening(self) -> float:
        """c of F = K z (1 + c z^2), 1/mm2, of the island pressed straight down.

        A guided end that sinks by z stretches its beam by 3 z^2/(5 s), the integral of half the slope's
        square of z (3 u^2 - 2 u^3); the energy of the constrained part of that stretch is added.
        """
        k = closed.stiffness(self.beam)["axial"] * len(self.roots) * self.held
        return float(2.0 * k * (3.0 / (5.0 * self.beam.length)) ** 2 / self.stiffness[2, 2])

    def sunk(self, straight: Array) -> Array:
        """Sink u where the stiffness at rest would give `straight`, mm: u (1 + c u^2) = straight."""
        c, u = self.stiffening, straight.copy()
        for _ in range(NEWTON):
            u -= (u * (1.0 + c * u * u) - straight) / (1.0 + 3.0 * c * u * u)
        return u

    def linear_range(self, share: float) -> float:
        """Sink up to which K differs by at most that share from its value at rest, mm."""
        return float(np.sqrt(share / self.stiffening))


def wrench(force: Array, height: float) -> Array:
    """The wrench at the island's middle of a force (N) on the pad, `height` mm over the foil's mid-plane."""
    return np.concatenate([force, np.cross([0.0, 0.0, height], force)])


def unit_loads(height: float) -> Array:
    """Wrenches of 1 N on the pad along x, y and z, as columns."""
    return np.stack([wrench(f, height) for f in np.eye(3)], axis=1)
