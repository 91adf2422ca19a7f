"""The hinge while a force larger than it could bear presses its arm onto the overload stop.

The stop holds the arm's tip, at `arm` (mm) from the hinge's centre, the force presses at L < arm: from there
on the arm is a beam on two supports. What the force has beyond the one that closed the stop reaches the hinge
in two ways, both per newton of it:

  shear   V = 1 - L/arm goes through the hinge
  turn    theta = c (arm^2 - c^2)/(6 E I arm) + give S/arm, c = arm - L, I = b h^3/12: the arm bends between
          its supports, and the stop gives way by `give` mm for each newton of
          S = L/arm / (1 + K give (L/arm)^2), which is what the hinge, of stiffness K at the load line,
          leaves to it
"""

from __future__ import annotations

import numpy as np

from . import strain
from .section import Array, HingeSection


def stress_share(s: HingeSection, stiffness: Array, arm: Array, give: float) -> Array:
    """Force at the load line (N) that would stress the fillet as much as one newton beyond does on a closed
    stop.

    Shear bends the peak's section, at its distance w from the hinge's centre, by V w; the hinge answers the
    turn with K L^2 theta. Divided by L + w, the lever of a force at the load line.
    """
    L, w = s.load_arm, strain.peak_position(s)
    return ((1.0 - L / arm) * w + stiffness * L**2 * _turn(s, stiffness, arm, give)) / (L + w)


def deflection_share(s: HingeSection, stiffness: Array, arm: Array, give: float) -> Array:
    """Force at the load line (N) that would turn the hinge as much as one newton beyond does: K L theta."""
    return stiffness * s.load_arm * _turn(s, stiffness, arm, give)


def largest_closing_force(
    s: HingeSection, stiffness: Array, arm: Array, give: float, overload: float, limit: Array
) -> Array:
    """Force (N) with which the stop may close at most, so that `overload` (N) on it neither turns nor
    stresses the hinge more than `limit` (N) at the free arm's load line does; never more than the limit
    itself.

    F + share (overload - F) = limit; not positive where what passes the closed stop is too much alone: of a
    share of 1 and more it always is.
    """
    share = _share(s, stiffness, arm, give)
    kept = np.where(share < 1.0, 1.0 - share, 1.0)
    closing = limit - share / kept * np.maximum(overload - limit, 0.0)
    return np.where((share < 1.0) | (overload <= limit), closing, 0.0)


def largest_overload(
    s: HingeSection, stiffness: Array, arm: Array, give: float, closing: Array, limit: Array
) -> Array:
    """The overload (N) of `largest_closing_force` for a stop that closes at `closing` (N)."""
    share = _share(s, stiffness, arm, give)
    return (limit - (1.0 - share) * closing) / share


def _share(s: HingeSection, stiffness: Array, arm: Array, give: float) -> Array:
    return np.maximum(stress_share(s, stiffness, arm, give), deflection_share(s, stiffness, arm, give))


def _turn(s: HingeSection, stiffness: Array, arm: Array, give: float) -> Array:
    """Turn of the arm's end at the hinge, held at the tip, per newton at the load line; rad/N."""
    c = arm - s.load_arm
    inertia = s.width * s.arm_height**3 / 12.0
    lever = s.load_arm / arm
    on_stop = lever / (1.0 + stiffness * give * lever**2)
    return c * (arm**2 - c**2) / (6.0 * s.youngs_modulus * inertia * arm) + give * on_stop / arm
