"""Temperature rise of a gauge, with power on continuously and with power on only while it is read.

The grid's heat (U/2)^2/R goes through the backing into the leaf, and along it to the body. Grid and half the
backing store heat, so a short reading ends before the grid is warm: an exponential approach with one time
constant. The leaf is taken without heat of its own: it is as warm as with power on all the time while power
is on, which is an upper bound.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp

from tactcad.design.messages import InputError

from .gauge_signal import Gauge

FOIL_HEAT = 3.6e6  # J/(m3 K), constantan: 8900 kg/m3 x 410 J/(kg K)
BACKING_HEAT = 1.55e6  # J/(m3 K), polyimide: 1420 kg/m3 x 1090 J/(kg K)


@dataclass(frozen=True)
class Power:
    """What heats a gauge. resistance ohm; conductivity of the backing W/(m K); on_time and period s.

    resistance_per_kelvin: dR/R of a grid warmer than its leaf, 1/K. reference_mismatch: share of it that
    the bridge's three other arms do not cancel. leaf_resistance: from under the grid to the body, K/W
    (`leaf_resistance`); 0 for a leaf that conducts perfectly.
    """

    resistance: float
    conductivity: float
    resistance_per_kelvin: float
    reference_mismatch: float
    on_time: float
    period: float
    leaf_resistance: float = 0.0


@dataclass(frozen=True)
class Heating:
    """power W at the grid, power_density kW/m2 of grid, rise K of grid over body, drift dR/R left in the
    bridge.
    """

    power: float
    power_density: float
    rise: float
    drift: float


def continuous(excitation: float, gauge: Gauge, power: Power) -> Heating:
    """Heating with power on all the time.

    Parameters
    ----------
    excitation
        Of the bridge, V.
    gauge, power
        The gauge, and what heats it.
    """
    watts = (excitation / 2) ** 2 / power.resistance
    return _heating(watts, watts * (thermal_resistance(gauge, power) + power.leaf_resistance), gauge, power)


def switched(excitation: float, gauge: Gauge, power: Power) -> Heating:
    """Heating with power on for on_time in every period, at the end of a reading in the settled cycle, its
    warmest moment.

    Parameters
    ----------
    excitation
        Of the bridge, V.
    gauge, power
        The gauge, and what heats it.

    Raises
    ------
    InputError
        Where on_time is longer than the period.
    """
    if power.on_time > power.period:
        raise InputError(
            "readout.on_time",
            "longer than readout.period",
            value=power.on_time,
            legal=f"up to {power.period:g} s",
        )
    steady = continuous(excitation, gauge, power)
    tau = time_constant(gauge, power)
    if tau == 0.0:  # a grid on the bare metal
        return _heating(steady.power * power.on_time / power.period, steady.rise, gauge, power)
    on, off = exp(-power.on_time / tau), exp(-(power.period - power.on_time) / tau)
    leaf = steady.power * power.leaf_resistance
    rise = leaf + (steady.rise - leaf) * (1 - on) / (1 - on * off)
    return _heating(steady.power * power.on_time / power.period, rise, gauge, power)


def leaf_resistance(hinge_length: float, thickness: float, width: float, conductivity: float) -> float:
    """From the middle of a leaf to the body, K/W: half its length conducts, the arm beyond takes no heat.

    Lengths in mm, conductivity of the leaf in W/(m K).
    """
    return hinge_length / 2 / (conductivity * thickness * width) * 1e3


def thermal_resistance(gauge: Gauge, power: Power) -> float:
    """Grid to leaf through the backing, K/W."""
    return gauge.grid_height * 1e-3 / (power.conductivity * _area(gauge))


def time_constant(gauge: Gauge, power: Power) -> float:
    """s; half the backing's heat counts, its temperature falling linearly to the leaf."""
    foil = FOIL_HEAT * gauge.foil_coverage * gauge.foil_thickness * 1e-3
    backing = BACKING_HEAT * gauge.grid_height * 1e-3 / 2
    return thermal_resistance(gauge, power) * (foil + backing) * _area(gauge)


def _area(gauge: Gauge) -> float:
    return gauge.grid_length * gauge.grid_width * 1e-6  # m2


def _heating(watts: float, rise: float, gauge: Gauge, power: Power) -> Heating:
    return Heating(
        watts,
        watts / _area(gauge) * 1e-3,
        rise,
        rise * power.resistance_per_kelvin * power.reference_mismatch,
    )
