"""What an element's read-out shows: sensitivities, signal at a deflection, resolution."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import gauge_signal, ladder, readout
from .gauge_signal import Gauge
from .readout import ReadOut
from .section import Array, HingeSection


@dataclass(frozen=True)
class Signal:
    """Signals by element, as magnitudes: the sign depends on the arm of the bridge that the gauge is in."""

    per_deflection: Array  # K_v, V/mm, at no load
    per_force: Array  # K_v/K, V/N
    strain: Array  # of the foil at the deflection asked for
    volts: Array  # change of the amplifier's output there, exact bridge, held at its limits
    nonlinearity: Array  # of the bridge there, relative
    limited: NDArray  # whether a supply or the converter holds the output
    resolution: Array  # N, two standard deviations of the averaged reading


def predict(
    s: HingeSection,
    gauge: Gauge,
    electronics: ReadOut,
    deflection: ArrayLike,
    rung: str = ladder.DEFAULT_RUNG,
) -> Signal:
    """Signals of all elements.

    Parameters
    ----------
    s
        The elements.
    gauge, electronics
        Alike for all elements.
    deflection
        Of each element at its tip, mm.
    rung
        A closed-form rung.

    Raises
    ------
    CheckFailure
        Where an element is out of the rung's range.
    """
    gain = readout.volts_per_strain(gauge.factor, electronics)
    per_mm = gauge_signal.foil_strain_per_deflection(s, gauge, rung)
    per_newton = gauge_signal.foil_strain_per_force(s, gauge, rung)
    strain = per_mm * np.asarray(deflection, dtype=float)
    volts = readout.output(strain, gauge.factor, electronics)
    return Signal(
        gain * per_mm,
        gain * per_newton,
        strain,
        volts - readout.output(0.0, gauge.factor, electronics),
        readout.bridge_nonlinearity(gauge.factor * strain),
        volts != readout.unlimited_output(strain, gauge.factor, electronics),
        2 * electronics.averaged_noise / (gain * per_newton),
    )
