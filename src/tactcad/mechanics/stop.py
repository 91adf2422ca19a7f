"""The hinge while a force larger than it could bear presses its arm onto the overload stop.

The stop holds the arm's tip, at `arm` (mm) from the hinge's centre, the force presses at L < arm. Three
springs in a row: the body, a cantilever of length Lb; the hinge, a leaf of length l; the arm from there on, a
cantilever. Unit forces at i <= j (mm from the hinge's centre, L or arm) share the compliance

  d_ij = C (i j + l^2/12) + rest_ij
  rest_ij = (p q Lb + (p + q) Lb^2/2 + Lb^3/3)/(E b Hb^3/12) + u^2 (3 v - u)/(6 E b h^3/12)
  p = i + l/2, q = j + l/2, u = i - l/2, v = j - l/2
  C = (1/K - rest_LL)/(L^2 + l^2/12), K the stiffness at the load line; no less than none, where the sheet is
      so wide that body and arm may not curl

Of what the force has beyond the one that closed the stop, each newton is answered at the tip by

  S = d_La/(d_aa + give), a = arm, the stop giving way by `give` mm/N

and reaches the hinge as the shear V = 1 - S and the moment M = L - S arm. M is negative where the body lets
the arm tilt back over the held tip: that help is not counted, only that it may turn the hinge round.
"""

from __future__ import annotations

import numpy as np

from . import strain
from .section import Array, HingeSection


def tip_compliance(s: HingeSection, stiffness: Array, arm: Array) -> Array:
    """d_La: way of the free arm's tip per newton at the load line, mm/N. The hinge's part of it is that at
    the load line times the lever arm/L, the body's part less."""
    return _compliance(s, stiffness, s.load_arm, arm)


def stop_share(s: HingeSection, stiffness: Array, arm: Array, give: float) -> Array:
    """S: force with which the closed stop answers one newton at the load line, N/N."""
    return tip_compliance(s, stiffness, arm) / (_compliance(s, stiffness, arm, arm) + give)


def stress_share(s: HingeSection, stiffness: Array, arm: Array, give: float) -> Array:
    """Force at the load line (N) that would stress the fillet as much as one newton beyond does on a closed
    stop.

    Shear bends the peak's section, at its distance w from the hinge's centre, by V w. Divided by L + w, the
    lever of a force at the load line.
    """
    L, w, S = s.load_arm, strain.peak_position(s), stop_share(s, stiffness, arm, give)
    return (np.maximum(L - S * arm, 0.0) + (1.0 - S) * w) / (L + w)


def back_share(s: HingeSection, stiffness: Array, arm: Array, give: float) -> Array:
    """The same of a load that turned the hinge back, at the peak beyond its centre, or to the turn: whichever
    is more. What closed the stop works against it, and is left out."""
    L, w, S = s.load_arm, strain.peak_position(s), stop_share(s, stiffness, arm, give)
    return np.maximum((S * arm - L + (1.0 - S) * w) / (L + w), S * arm / L - 1.0)


def deflection_share(s: HingeSection, stiffness: Array, arm: Array, give: float) -> Array:
    """Force at the load line (N) that would turn the hinge as much as one newton beyond does: M/L."""
    return np.maximum(1.0 - stop_share(s, stiffness, arm, give) * arm / s.load_arm, 0.0)


def largest_closing_force(
    s: HingeSection, stiffness: Array, arm: Array, give: float, overload: float, limit: Array
) -> Array:
    """Force (N) with which the stop may close at most, so that `overload` (N) on it neither turns nor
    stresses the hinge more than `limit` (N) at the free arm's load line does; never more than the limit
    itself.

    F + share (overload - F) = limit; not positive where what passes the closed stop is too much alone, and
    none where it is so backwards.
    """
    share = _share(s, stiffness, arm, give)
    closing = limit - share / (1.0 - share) * np.maximum(overload - limit, 0.0)
    back = back_share(s, stiffness, arm, give) * overload > limit
    return np.where(back & (overload > limit), 0.0, closing)


def largest_overload(
    s: HingeSection, stiffness: Array, arm: Array, give: float, closing: Array, limit: Array
) -> Array:
    """The overload (N) of `largest_closing_force` for a stop that closes at `closing` (N)."""
    share = _share(s, stiffness, arm, give)
    back = np.maximum(limit / np.maximum(back_share(s, stiffness, arm, give), 1e-9), limit)
    return np.minimum((limit - (1.0 - share) * closing) / np.maximum(share, 1e-9), back)


def _share(s: HingeSection, stiffness: Array, arm: Array, give: float) -> Array:
    """Less than 1: S is positive."""
    return np.maximum(stress_share(s, stiffness, arm, give), deflection_share(s, stiffness, arm, give))


def _compliance(s: HingeSection, stiffness: Array, i: Array, j: Array) -> Array:
    """d_ij, mm/N."""
    L, sideways = s.load_arm, s.hinge_length**2 / 12.0
    C = np.maximum(1.0 / stiffness - _rest(s, L, L), 0.0) / (L**2 + sideways)
    return C * (i * j + sideways) + _rest(s, i, j)


def _rest(s: HingeSection, i: Array, j: Array) -> Array:
    """rest_ij, mm/N."""
    Lb, half, Eb = s.body_length, s.hinge_length / 2.0, s.youngs_modulus * s.width / 12.0
    p, q, u, v = i + half, j + half, i - half, j - half
    body = (p * q * Lb + (p + q) * Lb**2 / 2.0 + Lb**3 / 3.0) / (Eb * s.body_height**3)
    return body + u**2 * (3.0 * v - u) / (6.0 * Eb * s.arm_height**3)
