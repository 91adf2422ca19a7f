"""Noise of one sample, from the amplifier's and the resistors before it.

White noise e of the amplifier, referred to its input, and Johnson noise 4 k T R of what lies before it (any
text on electronic noise), through one pole at the amplifier's bandwidth B:

    e_out = G sqrt((e^2 + 4 k T R) pi/2 B)

Flicker noise is left out: a reading lasts too short a time for it.
"""

from __future__ import annotations

from math import pi, sqrt

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
