"""Limits that a bonded gauge is checked against before its element goes into the array, each with its
origin."""

from __future__ import annotations

from dataclasses import dataclass
from math import log10

import numpy as np

from tactcad.design.fields import present
from tactcad.design.messages import CheckFailure
from tactcad.mechanics import gauge_signal, readout, strain
from tactcad.mechanics.section import Array

from .bridge_figures import zero_drift
from .hinge_section import design_gauge, design_readout, hinge_section
from .layout import Layout

# Relative change of resistance by bonding that shows a damaged grid, if the gauge's own tolerance is less;
# chosen: with a gauge factor near 2 it is as much as 2500 microstrain, more than curing strains a foil.
HURT = 0.005
# ohm: least insulation of a fresh installation under laboratory conditions (Micro-Measurements, Gage
# Installation Tester 1300).
FRESH_INSULATION = 1e10
CREEP_FROM, CREEP_TO = 1.0, 60.0  # min of the held load; chosen: an hour shows 1.8 decades
PUSH = 0.2  # N on the pad for sign and size of the signal, or rating.force; chosen: a weight of 20 g


@dataclass(frozen=True)
class GaugeChecks:
    """Limits of one gauge.

    hurt         relative change of resistance by bonding that shows a damaged grid
    resistance   ohm, least and most after bonding
    insulation   ohm, least when fresh; leak: below this in use, the leak alone reads as the bridge's drift
    zero         dR/R, most of the bonded gauge against its bridge, so that no reading leaves amplifier or
                 converter
    creep        share of the signal, most between CREEP_FROM and CREEP_TO under a held load
    push, rise   N on the pad, away from the object, and by arm length (mm) dR/R under it, about
    """

    hurt: float
    resistance: tuple[float, float]
    insulation: float
    leak: float
    zero: float
    creep: float
    push: float
    rise: tuple[tuple[float, float], ...]


def gauge_checks(layout: Layout) -> GaugeChecks:
    """The limits, from read-out, tolerances and the elements' own strain.

    Strains are the foil's by the estimator, as every signal is; where an element is out of its range, by
    beam theory on the composite section.
    """
    d = layout.design
    R, factor = d.gauge.resistance, d.gauge.factor
    hurt = max(HURT, d.gauge.resistance_tolerance)
    s = hinge_section(layout, layout.elements)
    gauge, electronics = design_gauge(d), design_readout(d)
    leak = zero_drift(layout)
    try:
        per_newton = gauge_signal.foil_strain_per_force(s, gauge)
    except CheckFailure:  # out of the rung's range; beam theory gives up to a fifth more
        per_newton = strain.nominal(s, 1.0) * gauge_signal.composite(s, gauge).reading
    signal = factor * per_newton * d.rating.force
    # as 4 V/(U G) of what the output may span less the signal: the bridge's slope at zero
    room = 4 * min(electronics.highest, -electronics.lowest) / (electronics.excitation * electronics.gain)
    push = min(PUSH, d.rating.force)
    arms = dict(zip((p.arm for p in layout.elements), factor * per_newton * push, strict=True))
    return GaugeChecks(
        hurt,
        (R * (1 - hurt), R * (1 + hurt)),
        FRESH_INSULATION,
        R / leak if leak else FRESH_INSULATION,
        max(0.0, room - float(np.max(signal))),
        d.tolerance.creep * log10(CREEP_TO / CREEP_FROM),
        push,
        tuple(sorted((arm, float(rise)) for arm, rise in arms.items())),
    )


def allowed_places(layout: Layout) -> Array:
    """Largest offset of each gauge from its hinge's middle, along the element, with a signal error of at most
    bonding.signal_share; mm, in the elements' order."""
    share = present(layout.design.bonding).signal_share
    return gauge_signal.allowed(
        hinge_section(layout, layout.elements), layout.design.gauge.grid_length, share
    )


def volts(layout: Layout, change: float) -> float:
    """Output of the amplifier, or of the bridge that a converter reads, for a relative change of one gauge,
    V."""
    own = design_readout(layout.design)
    return float(own.excitation * own.gain * readout.bridge_output(change))
