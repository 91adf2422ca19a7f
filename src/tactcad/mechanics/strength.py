"""At which force the hinge yields or fatigues, and which force it is rated for."""

from __future__ import annotations

import numpy as np

from tactcad.design.materials import Alloy

from . import strain, validity
from .section import Array, HingeSection


def yield_force(s: HingeSection, alloy: Alloy) -> Array:
    """Force at which the fillet's surface reaches the yield strength, N.

    Raises CheckFailure, as the module's other functions of a section do, where the closed forms
    for stress were not fitted.
    """
    return alloy.yield_strength / strain.peak_stress(s, 1.0)


def yield_force_where_known(s: HingeSection, alloy: Alloy) -> Array:
    """`yield_force`, N; NaN where the closed forms for stress were not fitted."""
    force = np.full(s.shape, np.nan)
    known = validity.reasons(s, "plane") == ""
    if known.any():
        force[known] = yield_force(s.rows(known.reshape(-1)), alloy)
    return force


def yield_factor(s: HingeSection, alloy: Alloy, force: Array | float) -> Array:
    """Yield strength over the fillet's stress under a force, N; below 1 the hinge does not stay elastic."""
    return yield_force(s, alloy) / force


def rated_force(s: HingeSection, alloy: Alloy, requested: Array | float, factor: float) -> Array:
    """The lesser of the requested force and the force at yield over `factor`, N."""
    return np.minimum(requested, yield_force(s, alloy) / factor)


def elastic(s: HingeSection, alloy: Alloy, force: Array | float) -> np.ndarray:
    """Whether the hinge stays elastic under a force, N; where it does not, its computed strain is
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
