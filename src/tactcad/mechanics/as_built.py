"""Differences of an element as built from its drawing, and their effects on its stiffness.

All differences are half-widths of `[tolerance]`, by the names of its fields: parts lie anywhere between their
limits. Two of them can only soften the element: a surface layer that carries no load, and a clamp that turns.
They still count both ways.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from . import ladder
from .ladder import elasticity
from .section import Array, HingeSection

if TYPE_CHECKING:
    from tactcad.design.tree import Tolerance

# By field of [tolerance]: the section's parameter.
DIMENSIONS = {
    "hinge_thickness": "hinge_thickness",
    "hinge_length": "hinge_length",
    "fillet_radius": "fillet_radius",
    "load_arm": "load_arm",
    "arm_height": "arm_height",
    "sheet_thickness": "width",
}
# Change of each dimension (mm) for each mm of layer taken off every cut face: webs get thinner, the slot
# grows.
CUT_FACES = {
    "hinge_thickness": -2.0,
    "hinge_length": 2.0,
    "fillet_radius": 1.0,
    "arm_height": -2.0,
    "body_height": -2.0,
    "body_length": -1.0,
}
COMMON = ("sheet_thickness", "youngs_modulus", "recast_layer")  # one sheet, one cut: equal in all elements


def without_layer(s: HingeSection, layer: Array | float) -> HingeSection:
    """The section that carries load if a layer (mm) on every wire-cut face carries none."""
    return s.with_(**{name: getattr(s, name) + by * layer for name, by in CUT_FACES.items()})


def in_clamp(s: HingeSection, stiffness: Array, turn: Array | float) -> Array:
    """Tip stiffness in a clamp that turns under the moment at its edge, N/mm.

    Parameters
    ----------
    s
        One design or many.
    stiffness
        Tip stiffness in a rigid clamp, N/mm.
    turn
        Rotation of the clamp per moment, rad/(N mm).
    """
    lever = s.load_arm + s.hinge_length / 2.0 + s.body_length
    return stiffness / (1.0 + stiffness * turn * lever * lever)


def half_widths(s: HingeSection, tolerance: Tolerance, rung: str = ladder.DEFAULT_RUNG) -> dict[str, Array]:
    """Relative half-width of every design's tip stiffness, to first order.

    Parameters
    ----------
    s
        One design or many.
    tolerance
        Half-widths of the dimensions, mm; of Young's modulus, relative; of the clamp, rad/(N mm).
    rung
        The closed form that is differentiated.

    Returns
    -------
    dict of str to Array
        By field of [tolerance]; each of the section's shape.

    Raises
    ------
    CheckFailure
        If a design is out of the rung's range.
    """
    names = dict.fromkeys((*DIMENSIONS.values(), *CUT_FACES))
    per_mm = {name: elasticity(s, name, rung) / getattr(s, name) for name in names}
    by_field = {field: getattr(tolerance, field) * per_mm[name] for field, name in DIMENSIONS.items()}
    by_field["youngs_modulus"] = np.full(s.shape, tolerance.youngs_modulus)  # K goes with it
    by_field["recast_layer"] = tolerance.recast_layer * sum(
        by * per_mm[name] for name, by in CUT_FACES.items()
    )
    K = ladder.stiffness(s, rung)
    by_field["clamp_compliance"] = np.log(in_clamp(s, K, tolerance.clamp_compliance) / K)
    return {field: np.broadcast_to(np.abs(half), s.shape) for field, half in by_field.items()}


# Half-width that holds 96 % of the sum of a number that is uniform between its limits and a normal one, over
# its standard deviation (95 for how K bends), by the uniform one's share of the variance: G(u) = u Phi(u)
# + phi(u),
# P = [G((q + h)/s) - G((q - h)/s)] s/h - 1.
SHARES = (0.0, 0.2, 0.4, 0.6, 0.8, 0.9, 1.0)
QUANTILES = (2.054, 2.047, 2.022, 1.968, 1.87, 1.791, 1.663)


def together(limits: Iterable[Array], measured: Iterable[Array] = ()) -> Array:
    """Half-width for 95 % of what differs by all causes at once.

    Parameters
    ----------
    limits
        Half-width by each cause that is somewhere between limits. The largest counts as uniform, the others
        together as normal.
    measured
        Half-width by each that was measured: two standard deviations.
    """
    squares = [limit * limit / 3.0 for limit in limits]
    variance = sum(squares) + sum(half * half / 4.0 for half in measured)
    share = np.maximum.reduce(squares) / np.where(variance > 0.0, variance, 1.0)
    return np.interp(share, SHARES, QUANTILES) * np.sqrt(variance)
