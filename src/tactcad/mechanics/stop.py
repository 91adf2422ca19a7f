"""The hinge while a force larger than it could bear presses its arm onto the overload stop."""

from __future__ import annotations

from . import strain
from .section import Array, HingeSection


def equivalent_force(s: HingeSection, stiffness: Array, arm: Array, beyond: Array) -> Array:
    """Force (N) at the load line that would stress the fillet as much as `beyond` does on a closed stop.

    The stop holds the arm's tip, at `arm` (mm) from the hinge's centre, the force presses at L < arm: a beam on
    two supports. Its share V = F (1 - L/arm) goes through the hinge as shear, which bends the peak's section at
    its distance w from the centre by V w. The arm bends between its supports, which turns the hinge by
    F c (arm^2 - c^2)/(6 E I arm), c = arm - L, with I = b h^3/12; the hinge answers with K L^2 times that turn.
    Divided by L + w, the lever of a force at the load line.
    """
    L, w = s.load_arm, strain.peak_position(s)
    c = arm - L
    inertia = s.width * s.arm_height**3 / 12.0
    turn = beyond * c * (arm**2 - c**2) / (6.0 * s.youngs_modulus * inertia * arm)
    return (beyond * (1.0 - L / arm) * w + stiffness * L**2 * turn) / (L + w)


def largest_closing_force(s: HingeSection, stiffness: Array, arm: Array, overload, yield_strength: float) -> Array:
    """Force (N) with which the stop may close at most, so that `overload` (N) on it just does not yield the fillet.

    F + e (overload - F) = force at yield, with e the equivalent of one newton; not positive where the shear
    alone is too much. Beyond the range of the fit the fillet's factor is extrapolated.
    """
    share = equivalent_force(s, stiffness, arm, 1.0)
    return (yield_strength / strain.stress_beyond_the_fit(s, 1.0) - share * overload) / (1.0 - share)
