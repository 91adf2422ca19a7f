"""What a gauge reads that does not lie on the middle of its hinge.

Along the leaf the moment of the load falls towards the pad, and at both roots the strain of the face fades.
A grid that is bonded `shift` mm towards the pad (negative: towards the clamp) takes the mean of another
stretch.
"""

from __future__ import annotations

import numpy as np

from . import strain
from .section import Array, HingeSection

GAUSS = 16  # points: the profile's integral is smooth, and kinked at most once
HALVINGS = 40  # of the stretch in which the allowed place is sought: 1e-12 of it


def reading(s: HingeSection, grid_length: Array | float, shift: Array | float) -> Array:
    """Mean strain under a grid bonded `shift` mm towards the pad, over that of one on the hinge's middle.

    The face's strain is (1 - x/L) p(|x|), x towards the pad: the load's moment times the profile that
    `strain.grid_factor` was fitted for. By parts, with P the integral of p from 0,
    mean = [(1 - x1/L) P(x1) - (1 - x0/L) P(x0) + int P dx/L]/grid. Within 0.7 % of plane elements 0.1 mm off
    the middle, and 0.4 % where the slot has a flat part (tests/mechanics/test_gauge_place.py).

    Parameters
    ----------
    s
        One design or many.
    grid_length, shift
        mm.

    Raises
    ------
    CheckFailure
        Where a two-sided hinge's flat part is too short for the grid at that place.
    """
    grid, middle = np.asarray(grid_length, dtype=float), np.asarray(shift, dtype=float)
    L = s.load_arm
    points, weights = np.polynomial.legendre.leggauss(GAUSS)
    along = np.concatenate([[-1.0, 1.0], points])  # the grid's ends, and what its integral takes
    flat = (1,) * max(len(s.shape), grid.ndim, middle.ndim)
    x = middle + grid / 2 * along.reshape(-1, *flat)
    P = _profile_integral(s, x)
    low, high = (1 - x[:2] / L) * P[:2]
    mean = (high - low) / grid + np.tensordot(weights, P[2:], axes=1) / (2 * L)
    return mean / strain.grid_factor(s, grid)


def _profile_integral(s: HingeSection, x: Array) -> Array:
    """P(x), mm: what a centred grid of length 2|x| takes on one side, with the sign of x."""
    return x * strain.grid_factor(s, 2 * np.abs(x))


def error(s: HingeSection, grid_length: Array | float, shift: Array | float) -> Array:
    """Largest relative error of the reading of a grid that lies `shift` mm off the hinge's middle, either
    way."""
    off = np.broadcast_to(shift, np.broadcast_shapes(s.shape, np.shape(grid_length), np.shape(shift)))
    return np.abs(reading(s, grid_length, np.stack([off, -off])) - 1).max(axis=0)


def allowed(s: HingeSection, grid_length: float, share: float) -> Array:
    """How far off the hinge's middle a grid may lie for its reading to err by `share` at most, mm.

    The error grows with the distance. Beyond a grid's length nothing is asked; on a two-sided hinge it may
    not climb its fillets. Raises CheckFailure where it does even in the middle.
    """
    flat = s.straight_length + s.fillet_radius
    room = np.where(s.two_sided, np.maximum(flat - grid_length, 0.0) / 2, grid_length)
    low, high = np.zeros(s.shape), np.broadcast_to(room, s.shape)
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        kept = error(s, grid_length, middle) <= share
        low, high = np.where(kept, middle, low), np.where(kept, high, middle)
    return low
