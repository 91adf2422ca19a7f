"""Measurements on every numbered element as cut: the part's characteristics, and inputs of the estimator;
and the limits that a bonded gauge is checked against before its element goes into the array, each with its
origin.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log10

import numpy as np

from tactcad.design.fields import present
from tactcad.design.messages import CheckFailure
from tactcad.mechanics import gauge_signal, readout, strain
from tactcad.mechanics.section import Array

from ..language.limits import Characteristic
from .bridge_figures import zero_drift
from .element import LEDGE, PAD_HEIGHT, element, element_number
from .hinge_section import design_gauge, design_readout, hinge_section
from .layout import ElementPlace, Layout


@dataclass(frozen=True)
class Measurement:
    """One dimension of one element, mm. `enters` is the field of HingeSection that it sets, "" if none."""

    name: str
    nominal: float
    lower: float
    upper: float
    key: bool
    enters: str
    where: str
    how: str


# By name: the field of HingeSection, the place of measurement, and the instrument.
MICROSCOPE = "measuring microscope, 0.001 or better"
WAYS = {
    "hinge thickness": (
        "hinge_thickness",
        "thinnest place between the hinge's two faces (mean of both edges of the sheet)",
        MICROSCOPE,
    ),
    PAD_HEIGHT: (
        "",
        "pad face over the centre of the dowel hole, square to the flat face",
        "coordinate measuring machine, or height gauge over a pin in the dowel hole",
    ),
    LEDGE: ("", "ledge over the pad's face, square to the flat face", MICROSCOPE),
    "stop gap": ("", "stop land below the ledge, square to the flat face", MICROSCOPE),
    "slot length": ("hinge_length", "between the slot's two walls, along the arm", MICROSCOPE),
    "load arm": ("load_arm", "middle of the slot to middle of the pad's face, along the arm", MICROSCOPE),
    "fillet radius": ("fillet_radius", "both fillets at the slot's floor (mean)", MICROSCOPE),
    "arm height": (
        "arm_height",
        "arm's back over its flat face, beside the slot",
        "micrometer or measuring microscope, 0.002",
    ),
    "arm length": ("", "arm's tip to the middle of the slot, along the arm", MICROSCOPE),
    "pad length": ("", "pad's face, along the arm", MICROSCOPE),
    "tip from dowel hole": ("", "arm's tip to the centre of the dowel hole, along the arm", MICROSCOPE),
    "dowel hole diameter": ("", "across the hole, at both faces", "plug gauges, or measuring microscope"),
    "sheet thickness": ("width", "across the element, on arm and body beside the slot", "micrometer, 0.002"),
}
AS_DRAWN = ("", "as dimensioned on the part's drawing sheet", "as its tolerance asks for")


def measurements(layout: Layout) -> list[tuple[ElementPlace, str, tuple[Measurement, ...]]]:
    """Every element by number: its place, its part number, and its measurements.

    These are its part's characteristics, and the load arm that follows from two of them.
    """
    known: dict[str, tuple[Measurement, ...]] = {}  # a long row has few kinds of element
    measured = []
    for place in layout.elements:
        part_no = element_number(layout.design, place)
        if part_no not in known:
            own = element(layout, place).characteristics
            known[part_no] = tuple(_measurement(c) for c in (*own, _load_arm(own)))
        measured.append((place, part_no, known[part_no]))
    return measured


def _load_arm(limits: tuple[Characteristic, ...]) -> Characteristic:
    """The arm's length less half the pad's, with limits that follow from theirs."""
    named = {c.name: c for c in limits}
    arm, pad = named["arm length"], named["pad length"]
    return Characteristic(
        "load arm", arm.nominal - pad.nominal / 2, arm.upper - pad.lower / 2, arm.lower - pad.upper / 2
    )


def _measurement(c: Characteristic) -> Measurement:
    # to a nanometre: 0.25 - 0.005 is a binary fraction
    nominal, lower, upper = (round(value, 6) for value in (c.nominal, c.lower, c.upper))
    enters, where, how = WAYS.get(c.name, AS_DRAWN)
    return Measurement(c.name, nominal, lower, upper, c.key, enters, where, how)


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
