"""Surface strain of the hinge: nominal, as the gauge's grid averages it, and its peak at a fillet."""

from __future__ import annotations

import numpy as np

from . import ladder
from .constants import by_sides
from .section import Array, HingeSection


def nominal(s: HingeSection, force) -> Array:
    """6 F L/(E b t^2), beam theory's surface strain at the hinge's centre; force in N."""
    t = s.hinge_thickness
    return 6.0 * np.asarray(force) * s.load_arm / (s.youngs_modulus * s.width * t * t)


def width_reduction(s: HingeSection, rung: str) -> Array | float:
    """Strain per newton over the plane value: K2D/K3D on the solid rung, 1 on the others.

    Strain per deflection is the same in two and three dimensions within half a per cent.
    """
    if rung != "solid":
        return 1.0
    return ladder.COMPLIANCE["solid"](s) / ladder.COMPLIANCE["plane"](s)


def gauge(s: HingeSection, force, grid_length, rung: str = ladder.DEFAULT_RUNG) -> Array:
    """Mean strain along the gauge face under a grid of that length (mm), centred on the hinge."""
    ladder.require_range(s, rung)
    return nominal(s, force) * grid_factor(s, grid_length) * width_reduction(s, rung)


def peak(s: HingeSection, force, rung: str = ladder.DEFAULT_RUNG) -> Array:
    """Largest surface strain: at the slot-side fillet towards the body."""
    ladder.require_range(s, rung)
    return nominal(s, force) * fillet_factor(s) * width_reduction(s, rung)


def peak_stress(s: HingeSection, force) -> Array:
    """Largest surface stress, MPa: bending stress 6 F L/(b t^2) times the fillet's factor.

    Stress, unlike strain, is not changed by the width: it follows from equilibrium.
    """
    return nominal(s, force) * s.youngs_modulus * fillet_factor(s)


def face_stress(s: HingeSection, force) -> Array:
    """Stress on the flat gauge face at the hinge's centre, MPa."""
    return nominal(s, force) * s.youngs_modulus * grid_factor(s, 0.0)


def fillet_factor(s: HingeSection) -> Array:
    """Peak at the fillet over nominal."""
    k = by_sides("fillet", s.two_sided)
    rho = s.fillet_radius / s.hinge_thickness
    return 1.0 + k["c"] * rho ** k["m"]


def grid_factor(s: HingeSection, grid_length) -> Array:
    """Mean strain under the grid over nominal."""
    k = by_sides("grid", s.two_sided)
    return np.broadcast_to(np.asarray(k["mean"], dtype=float), np.broadcast_shapes(s.shape, np.shape(grid_length)))
