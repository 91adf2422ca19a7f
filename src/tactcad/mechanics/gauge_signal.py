"""From a force on the element to the strain of the gauge's foil, and what the gauge does to the leaf.

The foil lies above the leaf's face by its backing and glue, and it and its carrier stiffen the leaf. Both
follow from one composite beam section: leaf, carrier and foil bend about their common neutral axis.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from . import ladder, strain
from .derivative import elasticity
from .section import Array, HingeSection


@dataclass(frozen=True)
class Gauge:
    """A foil gauge centred on the hinge; lengths mm, moduli MPa.

    grid_height: from the leaf's face to the foil, backing and glue. foil_coverage: share of the grid's
    width that is metal. carrier_width may not exceed the sheet's thickness; what is wider does not lie on
    the leaf.
    """

    factor: float
    grid_length: float
    grid_width: float
    grid_height: float
    carrier_width: float
    carrier_modulus: float
    foil_thickness: float
    foil_modulus: float
    foil_coverage: float


@dataclass(frozen=True)
class Composite:
    """Leaf with its gauge: bending stiffness over the bare leaf's, and foil strain over the bare leaf's
    surface strain at the same moment.
    """

    stiffening: Array
    reading: Array


def composite(s: HingeSection, gauge: Gauge) -> Composite:
    """Section of leaf, carrier and foil by the theory of composite beams (plane sections, E-weighted
    areas).
    """
    t, b, E = s.hinge_thickness, s.width, s.youngs_modulus
    h, f = gauge.grid_height, gauge.foil_thickness
    # E A, centre (from the leaf's mid-plane) and own E I of each layer
    layers = (
        (E * b * t, 0.0 * t, t),
        (gauge.carrier_modulus * np.minimum(gauge.carrier_width, b) * h, t / 2 + h / 2, h),
        (gauge.foil_modulus * gauge.foil_coverage * gauge.grid_width * f, t / 2 + h + f / 2, f),
    )
    axis = sum(a * y for a, y, _ in layers) / sum(a for a, _, _ in layers)
    bending = sum(a * (thick**2 / 12 + (y - axis) ** 2) for a, y, thick in layers)
    stiffening = bending / (E * b * t**3 / 12)
    return Composite(stiffening, (layers[2][1] - axis) / (t / 2) / stiffening)


def leaf_share(s: HingeSection, rung: str = ladder.DEFAULT_RUNG) -> Array:
    """Share of the compliance that is inversely proportional to the leaf's bending stiffness: dln K/dln t
    / 3.
    """
    return elasticity(s, "hinge_thickness", rung) / 3


def stiffness(s: HingeSection, gauge: Gauge, rung: str = ladder.DEFAULT_RUNG) -> Array:
    """Tip stiffness with the gauge on, N/mm.

    An upper bound, since the carrier is taken to cover the whole hinge. Raises CheckFailure out of the rung's
    range.
    """
    K = ladder.stiffness(s, rung)
    return K / (1 - leaf_share(s, rung) * (1 - 1 / composite(s, gauge).stiffening))


def foil_strain_per_force(s: HingeSection, gauge: Gauge, rung: str = ladder.DEFAULT_RUNG) -> Array:
    """Mean strain of the foil per newton at the pad, 1/N."""
    return strain.gauge(s, 1.0, gauge.grid_length, rung) * composite(s, gauge).reading


def foil_strain_per_deflection(s: HingeSection, gauge: Gauge, rung: str = ladder.DEFAULT_RUNG) -> Array:
    """Mean strain of the foil per millimetre of tip deflection, 1/mm.

    Parameters
    ----------
    s
        One design or many.
    gauge
        Its grid, foil and carrier, for every design alike.
    rung
        A closed-form rung.

    Raises
    ------
    CheckFailure
        Where a design is out of the rung's range, or a two-sided hinge's flat part is too short for the grid.
    """
    return foil_strain_per_force(s, gauge, rung) * stiffness(s, gauge, rung)
