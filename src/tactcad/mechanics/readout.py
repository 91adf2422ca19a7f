"""Quarter bridge, instrumentation amplifier and converter: from strain to volts.

One active gauge R(1 + x) with three equal ones, x = GF strain + offset: the bridge gives
U x/(4 + 2 x), exactly; x/4 is only its slope at zero (any text on Wheatstone bridges).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .section import Array


@dataclass(frozen=True)
class ReadOut:
    """Bridge and amplifier; volts, but gain, offset (dR/R of the unloaded bridge) and counts.

    noise: rms of one sample at the amplifier's output. headroom: how near the output comes to its supplies.
    adc_range: the converter takes -adc_range to +adc_range. transmission: share of the bridge's slope that
    leads and switch leave.
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
        """Standard deviation of the mean of `samples` readings, V: noise and rounding by the converter."""
        return ((self.noise**2 + self.adc_step**2 / 12) / self.samples) ** 0.5


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
    """Amplifier's output (V) at a foil strain, held at the supplies' and the converter's limits."""
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
