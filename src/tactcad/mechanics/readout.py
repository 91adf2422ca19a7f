"""Quarter bridge, instrumentation amplifier and converter: from strain to volts, their noise, and what an
element's read-out then shows.

One active gauge R(1 + x) with three equal ones, x = GF strain + offset: the bridge gives U x/(4 + 2 x),
exactly; x/4 is only its slope at zero (any text on Wheatstone bridges).

White noise e of the amplifier, referred to its input, and Johnson noise 4 k T R of what lies before it (any
text on electronic noise), through one pole at the amplifier's bandwidth B:

    e_out = G sqrt((e^2 + 4 k T R) pi/2 B)

Flicker noise is left out: readings are too short for it.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import gauge_signal
from .gauge_signal import Gauge
from .section import Array, HingeSection


@dataclass(frozen=True)
class ReadOut:
    """Bridge and amplifier; volts, but gain, offset (dR/R of the unloaded bridge) and counts.

    noise: rms of one sample at the amplifier's output, adc_noise: likewise by the converter. headroom: how
    near the output comes to its supplies. adc_range: the converter takes -adc_range to +adc_range.
    transmission: share of the bridge's slope that leads and switch leave.
    """

    excitation: float
    gain: float
    supply_positive: float
    supply_negative: float
    headroom: float
    bridge_offset: float
    noise: float
    adc_bits: int
    adc_range: float
    samples: int
    adc_noise: float = 0.0
    transmission: float = 1.0

    @property
    def highest(self) -> float:
        """Largest output that is still linear, V."""
        return min(self.supply_positive - self.headroom, self.adc_range)

    @property
    def lowest(self) -> float:
        """Least output that is still linear, V."""
        return max(self.supply_negative + self.headroom, -self.adc_range)

    @property
    def adc_step(self) -> float:
        """V"""
        return 2 * self.adc_range / 2**self.adc_bits

    @property
    def averaged_noise(self) -> float:
        """Standard deviation of the mean of `samples` readings, V: noise of amplifier and converter, and
        rounding."""
        return ((self.noise**2 + self.adc_noise**2 + self.adc_step**2 / 12) / self.samples) ** 0.5


def transmission(gauge: float, arm: float, lead: float, on: float, three_wires: bool) -> float:
    """Slope of a bridge with leads and a switch over that of four equal arms alone, at zero.

    Its halves are the gauge's, A + B with A = R + n L and B = C + m L, and that of two arms C; three wires:
    n = m = 1, two: n = 2, m = 0. The switch takes its part of the supply, and the gauge's half divides
    what is left:

        T = 4 R B/(A + B)^2 H/(H + on), H = (A + B) 2 C/(A + B + 2 C)

    Parameters
    ----------
    gauge, arm, lead, on
        R, C, L and the closed switch, ohm.
    three_wires
        Whether each gauge has three leads.
    """
    a, b = (gauge + lead, arm + lead) if three_wires else (gauge + 2 * lead, arm)
    halves = (a + b) * 2 * arm / (a + b + 2 * arm)
    return 4 * gauge * b / (a + b) ** 2 * halves / (halves + on)


def bridge_output(x: ArrayLike) -> Array:
    """Quarter bridge's output over its supply for a relative change of resistance x > -1."""
    x = np.asarray(x, dtype=float)
    return x / (4 + 2 * x)


def bridge_nonlinearity(x: ArrayLike) -> Array:
    """Relative error of the slope x/4: output/(x/4) - 1 = -x/(2 + x)."""
    x = np.asarray(x, dtype=float)
    return -x / (2 + x)


def output(strain: ArrayLike, factor: float, readout: ReadOut) -> Array:
    """Amplifier's output (V) at a foil strain, clipped to the supplies' and the converter's limits."""
    raw = unlimited_output(strain, factor, readout)
    return np.clip(raw, readout.lowest, readout.highest)


def unlimited_output(strain: ArrayLike, factor: float, readout: ReadOut) -> Array:
    """Amplifier's output (V) at a foil strain as if nothing limited it."""
    x = factor * np.asarray(strain, dtype=float) + readout.bridge_offset
    return readout.excitation * readout.gain * readout.transmission * bridge_output(x)


def volts_per_strain(factor: float, readout: ReadOut, strain: ArrayLike = 0.0) -> Array:
    """Sensitivity of the amplifier's output to strain at a foil strain, V: T U G GF 4/(4 + 2 x)^2.

    Parameters
    ----------
    factor
        Gauge factor GF.
    readout
        Supply U, gain G, transmission T and offset; x = GF strain + offset.
    strain
        Foil strain at which the slope is taken.
    """
    x = factor * np.asarray(strain, dtype=float) + readout.bridge_offset
    return readout.excitation * readout.gain * readout.transmission * factor * 4 / (4 + 2 * x) ** 2


BOLTZMANN = 1.380649e-23  # J/K, SI 2019
ROOM = 300.15  # K


def sample_noise(gain: float, density: float, bandwidth: float, resistance: float) -> float:
    """Rms of one sample at the amplifier's output, V.

    Parameters
    ----------
    gain
        Of the amplifier.
    density
        Its white noise referred to the input, V/rtHz.
    bandwidth
        -3 dB, Hz, of one pole.
    resistance
        Between its inputs, ohm: of a bridge of four equal arms R it is R, and two switches of the
        multiplexer.
    """
    return gain * sqrt((density**2 + 4 * BOLTZMANN * ROOM * resistance) * pi / 2 * bandwidth)


@dataclass(frozen=True)
class Signal:
    """Signals by element, as magnitudes: the sign depends on the arm of the bridge that the gauge is in."""

    per_deflection: Array  # K_v, V/mm, at no load
    per_force: Array  # K_v/K, V/N
    strain: Array  # of the foil at the deflection asked for
    volts: Array  # change of the amplifier's output there, exact bridge, clipped to its limits
    nonlinearity: Array  # of the bridge there, relative
    limited: NDArray  # whether a supply or the converter holds the output
    resolution: Array  # N, two standard deviations of the averaged reading


def predict(s: HingeSection, gauge: Gauge, electronics: ReadOut, deflection: ArrayLike) -> Signal:
    """Signals of all elements by the default rung.

    Parameters
    ----------
    s
        The elements.
    gauge, electronics
        The same for all elements.
    deflection
        Of each element at its tip, mm.

    Raises
    ------
    CheckFailure
        If an element is out of the rung's range.
    """
    gain = volts_per_strain(gauge.factor, electronics)
    per_mm = gauge_signal.foil_strain_per_deflection(s, gauge)
    per_newton = gauge_signal.foil_strain_per_force(s, gauge)
    strain = per_mm * np.asarray(deflection, dtype=float)
    volts = output(strain, gauge.factor, electronics)
    return Signal(
        gain * per_mm,
        gain * per_newton,
        strain,
        volts - output(0.0, gauge.factor, electronics),
        bridge_nonlinearity(gauge.factor * strain),
        volts != unlimited_output(strain, gauge.factor, electronics),
        2 * electronics.averaged_noise / (gain * per_newton),
    )
