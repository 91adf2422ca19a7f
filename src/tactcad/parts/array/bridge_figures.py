"""Figures of the bridges and of what reads them, by closed forms: imbalance, voltages at the inputs,
settling, drift, and what the instant of the samples costs. Volts, ohm, seconds.
"""

from __future__ import annotations

from math import hypot, log, pi

import numpy as np

from tactcad.design.materials import leaf_conductivity
from tactcad.design.sensing import AMPLIFIERS, JITTER, MULTIPLEXERS, SWITCHES, Readout
from tactcad.design.tree import Design
from tactcad.mechanics import gauge_signal
from tactcad.mechanics.gauge_signal import Heating, Power, leaf_resistance

from ..bought.electronic_parts import completion_drift, completion_resistance, completion_tolerance
from .converter_figures import MAINS
from .hinge_section import design_gauge, design_readout
from .layout import Layout
from .leads import longest_lead_resistance

COPPER = 0.0039  # 1/K, annealed copper at 20 C, IEC 60028
APART = 0.5  # K between the two leads of a bridge; chosen: one lies on the warmer side of its bundle
MAINS_OFF = 0.01  # relative, of the mains' frequency: EN 50160, 1 % for 99.5 % of a year


def bridge_signal(
    design: Design, lead: float, x: float = 0.0, gauge: float = 0.0, arm: float = 0.0
) -> tuple[float, float]:
    """Voltages of a bridge's two outputs over ground while its switch is on: at the gauge, at the other side.

    Parameters
    ----------
    design
        Its nominal resistances, excitation and switch.
    lead
        Of each lead of the gauge, ohm.
    x
        dR/R of the gauge beyond its unloaded `bridge_offset`.
    gauge, arm
        Relative errors of resistance: of the gauge, and of the others, each in the direction that adds to a
        positive one's.
    """
    r, nominal = design.readout, completion_resistance(design)
    active = design.gauge.resistance * (1 + gauge) * (1 + r.bridge_offset + x)
    beside, upper, lower = (nominal * (1 + e) for e in (-arm, arm, -arm))
    three = r.connection == "three-wire"
    active += lead if three else 2 * lead
    beside += lead if three else 0.0
    both = (active + beside) * (upper + lower) / (active + beside + upper + lower)
    on = SWITCHES[r.switch].on_ohm
    foot = r.excitation * on / (on + both)
    over = r.excitation - foot
    return foot + over * active / (active + beside), foot + over * lower / (upper + lower)


def imbalance(design: Design, lead: float, arm: float) -> tuple[float, float]:
    """Least and largest output of the amplifier with no load on any element, V.

    Parameters
    ----------
    design, lead
        As for `bridge_signal`.
    arm
        Tolerance of the completing resistances.
    """
    ends = [amplified(design, lead, 0.0, sign, arm) for sign in (-1.0, 1.0)]
    return min(ends), max(ends)


def amplified(design: Design, lead: float, x: float, sign: float, arm: float) -> float:
    """The amplifier's output (V) at a dR/R of x, every tolerance at its worst in one direction (sign).

    Parameters
    ----------
    design, lead, x
        As for `bridge_signal`.
    sign
        1 or -1.
    arm
        Tolerance of the completing resistances.
    """
    gauge = sign * design.gauge.resistance_tolerance
    plus, minus = bridge_signal(design, lead, x, gauge, sign * arm)
    return design.readout.gain * (
        plus - minus + sign * AMPLIFIERS[design.readout.amplifier].offset(design.readout.gain)
    )


def settling_time(design: Design) -> float:
    """From the address to an output within half the converter's step of a whole range, s: the multiplexer's
    own time, then bridge and switches into the capacitances behind them, and the amplifier's pole."""
    r = design.readout
    amplifier, multiplexer = AMPLIFIERS[r.amplifier], MULTIPLEXERS[r.multiplexer]
    side = max(completion_resistance(design), design.gauge.resistance) / 2 + multiplexer.on_ohm
    tau = side * (multiplexer.output_capacitance + amplifier.input_capacitance)
    tau += 1 / (2 * pi * amplifier.bandwidth(r.gain))
    return multiplexer.settling + max(log(2.0 ** (r.adc_bits + 1)) * tau, amplifier.settling)


def heating(layout: Layout) -> Heating:
    """Heating of a gauge at the end of a reading in the settled cycle."""
    d = layout.design
    return gauge_signal.switched(d.readout.excitation, design_gauge(d), power_of(layout))


def power_of(layout: Layout) -> Power:
    """The power in the design's gauges, on the leaf with the worst heat conduction."""
    d = layout.design
    gauge, r, conducts = d.gauge, d.readout, leaf_conductivity(d.material.conductivity)
    return Power(
        gauge.resistance,
        gauge.carrier_conductivity,
        gauge.resistance_per_kelvin,
        r.reference_mismatch,
        r.on_time,
        r.period,
        max(leaf_resistance(p.hinge.l, p.hinge.t, d.sheet.thickness, conducts) for p in layout.elements),
    )


def drift(layout: Layout) -> float:
    """Drift of the amplifier's output between zero and reading, V, as the half-width of a band.

    Root of the sum of squares of: the gauge's thermal output, the completion's three arms, the amplifier's
    offset, the bridges' supply over their largest imbalance, the leads' warmth (`zero_drift`; of two wires
    also their whole resistance in the gauge's arm). Self-heating is equal in all readings of a settled cycle,
    and so cancels with the zero, except for jitter of the samples (`instant_error`).
    """
    d = layout.design
    r, span = d.readout, d.readout.temperature_span
    per_x = r.excitation * r.gain / 4
    unloaded = imbalance(d, longest_lead_resistance(layout), completion_tolerance(d))
    leads = zero_drift(layout)
    if r.connection == "two-wire":
        leads += 2 * longest_lead_resistance(layout) / d.gauge.resistance * COPPER * span
    shares = (
        per_x * d.gauge.factor * d.gauge.thermal_output * span,
        per_x * 3**0.5 * completion_drift(d) * span,
        r.gain * AMPLIFIERS[r.amplifier].drift(r.gain) * span,
        r.excitation_drift * max(map(abs, unloaded)),
        per_x * leads,
    )
    return sum(share**2 for share in shares) ** 0.5


def zero_drift(layout: Layout) -> float:
    """dR/R by which a bridge's zero drifts during a grasp, by its leads' warmth: tolerance.zero_drift, or
    that of the longest lead's copper, APART kelvin between the two of a bridge."""
    own = layout.design.tolerance.zero_drift
    if own is not None:
        return own
    return longest_lead_resistance(layout) / layout.design.gauge.resistance * COPPER * APART


def sample_spacing(r: Readout) -> float:
    """From sample to sample of a reading, s."""
    return 1 / r.sample_rate if r.mains is None else 1 / (r.mains * r.samples)


def sampling_time(design: Design) -> float:
    """First sample to earliest switch-off, s: that is a spacing after the last, or its jitter if longer."""
    apart = sample_spacing(design.readout)
    return (design.readout.samples - 1) * apart + max(apart, jitter(design))


def instants(design: Design) -> np.ndarray:
    """Instants of a reading's samples after ENABLE, s."""
    r = design.readout
    apart = sample_spacing(r)
    first = r.on_time - sampling_time(design) if r.instant is None else r.instant
    return first + apart * np.arange(r.samples)


def warm_output(layout: Layout, after: np.ndarray) -> np.ndarray:
    """Contribution of the grid's warmth to the amplifier's output, V, at instants after ENABLE in the settled
    cycle."""
    d = layout.design
    power, gauge, chain = power_of(layout), design_gauge(d), design_readout(d)
    rise = np.array([gauge_signal.warmth(chain.excitation, gauge, power, float(t)) for t in after])
    x = rise * power.resistance_per_kelvin * power.reference_mismatch
    return chain.excitation * chain.gain * chain.transmission * x / 4


def jitter(design: Design) -> float:
    """Jitter of the samples' instant from reading to reading, s, plus and minus."""
    own = design.readout.jitter
    return JITTER[design.readout.timing] if own is None else own


def instant_error(layout: Layout) -> float:
    """Half-width of what the instant's jitter costs a reading, V: the grid warms while the samples are
    taken."""
    at, late = instants(layout.design), jitter(layout.design)
    means = [float(warm_output(layout, np.maximum(at + shift, 0.0)).mean()) for shift in (-late, 0.0, late)]
    return max(abs(m - means[1]) for m in means)


def hum_left(design: Design) -> float:
    """Rms of the mains left in the mean of a reading's samples, V: over whole periods by the deviation of the
    mains' frequency only, else nearly all."""
    r, at = design.readout, instants(design)
    about = (r.mains or MAINS) * (1 + MAINS_OFF * np.array([-1.0, 1.0]))
    return r.hum * float(np.abs(np.exp(2j * pi * about[:, None] * at).mean(1)).max())


def reading_scatter(layout: Layout) -> float:
    """Standard deviation of one reading, V: noise and rounding, hum, and half of what the instant's jitter
    costs."""
    noise = design_readout(layout.design).averaged_noise
    return hypot(noise, hum_left(layout.design), instant_error(layout) / 2)
