"""Forces at which the hinge yields or fatigues, its rated force, and the load on a hinge whose arm is pressed
onto the overload stop by a force too large for the hinge alone.

The stop holds the arm's tip, at `arm` (mm) from the hinge's centre; the force acts at L < arm. Three beams
are joined end to end: the body, a cantilever of length Lb; the hinge, a leaf of length l; the arm beyond it,
a cantilever. The deflection at i by a unit force at j is, for i <= j (mm from the hinge's centre, L or arm),

  d_ij = C (i j + l^2/12) + rest_ij
  rest_ij = (p q Lb + (p + q) Lb^2/2 + Lb^3/3)/(E b Hb^3/12) + u^2 (3 v - u)/(6 E b h^3/12)
  p = i + l/2, q = j + l/2, u = i - l/2, v = j - l/2
  C = (1/K - rest_LL)/(L^2 + l^2/12), K the stiffness at the load line; not below 0, which it would be for a
  sheet so wide that body and arm cannot curl sideways and are stiffer than by rest_LL

Each newton beyond the force that closed the stop is met at the tip by the reaction

  S = d_La/(d_aa + give), a = arm, with `give` the compliance of the stop in mm/N

and reaches the hinge as the shear V = 1 - S and the moment M = L - S arm. M is negative if the body bends so
far that the arm tilts back over the stopped tip. The initial relief of the hinge is not counted; bending it
too far the other way is.

Of the stop's functions s is the element, `stiffness` (N/mm) is K, `arm` (mm) the tip's distance and `give`
(mm/N) the stop's compliance; arrays broadcast together.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from tactcad.design.materials import Alloy

from . import strain, validity
from .section import Array, HingeSection

if TYPE_CHECKING:
    from tactcad.design.tree import Rating


def yield_force(s: HingeSection, alloy: Alloy) -> Array:
    """Force at which the fillet's surface reaches the yield strength, N.

    Raises CheckFailure, as the module's other functions of a section do, if the closed forms for stress were
    not fitted.
    """
    return alloy.yield_strength / strain.peak_stress(s, 1.0)


def yield_force_where_known(s: HingeSection, alloy: Alloy) -> Array:
    """`yield_force`, N; NaN if the closed forms for stress were not fitted."""
    force = np.full(s.shape, np.nan)
    known = validity.reasons(s, "plane") == ""
    if known.any():
        force[known] = yield_force(s.rows(known.reshape(-1)), alloy)
    return force


def rated_force(at_yield: Array, rating: Rating) -> Array:
    """Force in use of what yields at `at_yield`, N."""
    return np.minimum(rating.force, at_yield / rating.yield_factor)


def rated_deflection(at_yield: Array, stiffness: Array, rating: Rating) -> Array:
    """Deflection that no hinge may exceed, mm, of one that yields at `at_yield` (N)."""
    return at_yield / rating.deflection_factor / stiffness


def elastic(s: HingeSection, alloy: Alloy, force: Array | float) -> np.ndarray:
    """Whether the hinge stays elastic under a force, N; if it does not, its computed strain is
    meaningless.
    """
    return np.asarray(strain.peak_stress(s, force) <= alloy.yield_strength)


def surface_factor(tensile_strength: float) -> float:
    """Marin's factor of a machined surface, k_a = 4.51 S_ut^-0.265, at most 1 (Shigley, Table 6-2).

    Fitted on steels; for a wire-cut aluminium surface no better published figure was found.
    """
    return min(1.0, 4.51 * tensile_strength**-0.265)


def goodman(alloy: Alloy, peak_stress: Array | float) -> Array:
    """Goodman's line for a stress between 0 and peak (MPa): 1/n = sigma_a/(k_a S_f) + sigma_m/S_u.

    sigma_a = sigma_m = peak/2, the fillet's peak taken whole (notch sensitivity 1).
    """
    ultimate = alloy.tensile_strength or alloy.yield_strength
    half = np.asarray(peak_stress) / 2.0
    return 1.0 / (half / (surface_factor(ultimate) * alloy.fatigue_strength) + half / ultimate)


def tip_compliance(s: HingeSection, stiffness: Array, arm: Array) -> Array:
    """d_La: deflection of the free arm's tip by a newton at the load line, mm/N."""
    return _compliance(s, stiffness, s.load_arm, arm)


def stop_share(s: HingeSection, stiffness: Array, arm: Array, give: float) -> Array:
    """S: reaction of the closed stop to one newton at the load line, N/N."""
    return tip_compliance(s, stiffness, arm) / (_compliance(s, stiffness, arm, arm) + give)


def stress_share(s: HingeSection, stiffness: Array, arm: Array, give: float) -> Array:
    """Force at a free arm's load line (N) that stresses the fillet as one newton does on a closed stop.

    The bending moment at the point of largest stress, w from the hinge's centre, is M + V w on the stop and L
    + w by a newton at a free arm's load line; their ratio is returned, with M not below 0.
    """
    L, w, S = s.load_arm, strain.peak_position(s), stop_share(s, stiffness, arm, give)
    return (np.maximum(L - S * arm, 0.0) + (1.0 - S) * w) / (L + w)


def back_share(s: HingeSection, stiffness: Array, arm: Array, give: float) -> Array:
    """As `stress_share`, of the stress in the fillet on the hinge's other side where M bends the hinge back,
    or of that bending's angle: the larger. The force that closed the stop bends the other way; it is left
    out."""
    L, w, S = s.load_arm, strain.peak_position(s), stop_share(s, stiffness, arm, give)
    return np.maximum((S * arm - L + (1.0 - S) * w) / (L + w), S * arm / L - 1.0)


def overload_stress(
    s: HingeSection, stiffness: Array, arm: Array, give: float, closing: Array, load: float
) -> Array:
    """Stress at the fillet under a load (N) whose part beyond `closing` (N) the stop meets, MPa; without a
    check of the fit's range."""
    beyond = load - closing
    forwards = closing + stress_share(s, stiffness, arm, give) * beyond
    backwards = back_share(s, stiffness, arm, give) * beyond
    return strain.stress_beyond_the_fit(s, np.maximum(forwards, backwards))


def deflection_share(s: HingeSection, stiffness: Array, arm: Array, give: float) -> Array:
    """Force at a free arm's load line (N) that bends the hinge by as large an angle as one newton does on a
    closed stop: M/L."""
    return np.maximum(1.0 - stop_share(s, stiffness, arm, give) * arm / s.load_arm, 0.0)


def largest_closing_force(
    s: HingeSection, stiffness: Array, arm: Array, give: float, overload: float, limit: Array
) -> Array:
    """Largest force at the load line that may close the stop, so that the hinge bears an overload.

    F + share (overload - F) = limit.

    Parameters
    ----------
    s, stiffness, arm, give
        As above.
    overload : float
        Force at the load line, N.
    limit : array
        Force at a free arm's load line that gives the hinge's largest allowed angle and stress, N.

    Returns
    -------
    array
        N, at most `limit`. 0 or less if a stop closed from the start would not protect the hinge: its share
        of the overload alone exceeds the limit, or bends the hinge back too far.
    """
    share = _share(s, stiffness, arm, give)
    closing = limit - share / (1.0 - share) * np.maximum(overload - limit, 0.0)
    back = back_share(s, stiffness, arm, give) * overload > limit
    return np.where(back & (overload > limit), 0.0, closing)


def largest_overload(
    s: HingeSection, stiffness: Array, arm: Array, give: float, closing: Array, limit: Array
) -> Array:
    """Largest overload (N) that the hinge bears with a stop that closes at `closing` (N): the inverse of
    `largest_closing_force`."""
    share = _share(s, stiffness, arm, give)
    back = np.maximum(limit / np.maximum(back_share(s, stiffness, arm, give), 1e-9), limit)
    return np.minimum((limit - (1.0 - share) * closing) / np.maximum(share, 1e-9), back)


def _share(s: HingeSection, stiffness: Array, arm: Array, give: float) -> Array:
    """The larger of stress and angle on a closed stop, in newtons at a free arm's load line per newton; less
    than 1, since S is positive."""
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
