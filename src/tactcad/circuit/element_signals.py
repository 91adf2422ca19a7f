"""Every element's channel: volts at its loads, and the smallest force that it resolves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactcad.mechanics import gauge_signal, readout
from tactcad.parts.array.bridge_figures import amplified, drift, reading_scatter
from tactcad.parts.array.hinge_section import design_gauge, design_readout, hinge_section
from tactcad.parts.array.layout import ElementPlace, Layout
from tactcad.parts.array.leads import longest_lead_resistance
from tactcad.parts.array.stop_gap import overloads
from tactcad.parts.bought.electronic_parts import completion_tolerance, converter_of

from .digital_readout import digital_readout


@dataclass(frozen=True)
class ElementSignal:
    """One element's.

    per_force   V/N behind the amplifier, at no load; of a converter at the bridge
    rated       least and largest output at the rated force, V, of either sign, tolerances at their worst, of
                an amplifier
    overload    likewise with the stop closed under the overload force
    rated_strain, overload_strain   of the foil at these two
    resolution  N: two standard deviations of a reading, and drift, by the root of their squares
    """

    place: ElementPlace
    per_force: float
    rated: tuple[float, float]
    overload: tuple[float, float]
    resolution: float
    rated_strain: float
    overload_strain: float


def smallest_output(layout: Layout) -> float:
    """Smallest change resolved at the amplifier's output, or at the bridge's for a converter, V: two standard
    deviations of a reading, warm-up between its samples' instants included, and drift, by the root of their
    squares."""
    if converter := converter_of(layout.design):
        found = digital_readout(layout, converter.name)
        return float(np.hypot(2 * found.noise, found.drift))
    return float(np.hypot(2 * reading_scatter(layout), drift(layout)))


def reading_noise(layout: Layout, alike: bool = False) -> float:
    """Standard deviation of one reading, V, without drift.

    alike: for readings that the mains and the instant of the samples shift equally, as in one run.
    """
    if converter := converter_of(layout.design):
        return digital_readout(layout, converter.name).noise
    return design_readout(layout.design).averaged_noise if alike else reading_scatter(layout)


def element_signals(layout: Layout) -> list[ElementSignal]:
    """Every element's, by number. Raises CheckFailure if one is out of the estimator's range."""
    design, places = layout.design, layout.elements
    section, gauge, chain = hinge_section(layout, places), design_gauge(design), design_readout(design)
    shape = (len(places),)
    foil = np.broadcast_to(gauge_signal.foil_strain_per_force(section, gauge), shape)
    bent = np.broadcast_to(gauge_signal.foil_strain_per_deflection(section, gauge), shape)
    volts = float(readout.volts_per_strain(gauge.factor, chain))
    least = smallest_output(layout)
    lead, arm = longest_lead_resistance(layout), completion_tolerance(design)

    def extremes(x: float) -> tuple[float, float]:
        """Signals of either sign: a load's sign depends on the arm of the bridge."""
        least = max(-x, -1.0)  # no resistance is negative
        return amplified(design, lead, least, -1.0, arm), amplified(design, lead, x, 1.0, arm)

    found = []
    for i, state in enumerate(overloads(layout)):
        per_force = volts * float(foil[i])
        strains = float(foil[i]) * state.rated_force, float(bent[i]) * state.deflection
        at_rated, at_overload = (gauge.factor * strain for strain in strains)
        found.append(
            ElementSignal(
                state.place,
                per_force,
                extremes(at_rated),
                extremes(at_overload),
                least / abs(per_force),
                *strains,
            )
        )
    return found
