"""From a force on the element to the strain of the gauge's foil, and what the gauge does to the leaf.

The foil lies above the leaf's face by its backing and glue, and it and its carrier stiffen the leaf. Both
follow from one composite beam section: leaf, carrier and foil bend about their common neutral axis.

Along the leaf the moment of the load falls towards the pad, and at both roots the strain of the face fades. A
grid that is bonded `shift` mm towards the pad (negative: towards the clamp) takes the mean of another
stretch.

The grid's heat (U/2)^2/R goes through the backing into the leaf, and along it to the body. Grid and half the
backing store heat, so a short reading ends before the grid is warm: an exponential approach with one time
constant. The leaf is taken without heat of its own: it is as warm as with power on all the time while power
is on, which is an upper bound.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp

import numpy as np

from tactcad.design.messages import InputError

from . import ladder, strain
from .ladder import elasticity
from .section import Array, HingeSection


@dataclass(frozen=True)
class Gauge:
    """A foil gauge centred on the hinge; lengths mm, moduli MPa.

    grid_height: from the leaf's face to the foil, backing and glue. foil_coverage: share of the grid's
    width that is metal. carrier_width may not exceed the sheet's thickness: a wider one does not fit on the
    leaf.
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
        Its grid, foil and carrier, the same for every design.
    rung
        A closed-form rung.

    Raises
    ------
    CheckFailure
        If a design is out of the rung's range, or a two-sided hinge's flat part is too short for the grid.
    """
    return foil_strain_per_force(s, gauge, rung) * stiffness(s, gauge, rung)


GAUSS = 16  # points: the profile's integral is smooth, and kinked at most once
HALVINGS = 40  # bisections of the stretch in which the allowed place is sought: to 1e-12


def reading(s: HingeSection, grid_length: Array | float, shift: Array | float) -> Array:
    """Mean strain under a grid bonded `shift` mm towards the pad, over that of one on the hinge's middle.

    The face's strain is (1 - x/L) p(|x|), x towards the pad: the load's moment times the profile that
    `strain.grid_factor` was fitted for. By parts, with P the integral of p from 0,
    mean = [(1 - x1/L) P(x1) - (1 - x0/L) P(x0) + int P dx/L]/grid. Within 0.7 % of plane elements 0.1 mm off
    the middle, and 0.4 % if the slot has a flat part (tests/mechanics/test_gauge_place.py).

    Parameters
    ----------
    s
        One design or many.
    grid_length, shift
        mm.

    Raises
    ------
    CheckFailure
        If a two-sided hinge's flat part is too short for the grid at that place.
    """
    grid, middle = np.asarray(grid_length, dtype=float), np.asarray(shift, dtype=float)
    L = s.load_arm
    points, weights = np.polynomial.legendre.leggauss(GAUSS)
    along = np.concatenate([[-1.0, 1.0], points])  # the grid's ends, and what its integral takes
    flat = (1,) * max(len(s.shape), grid.ndim, middle.ndim)
    x = middle + grid / 2 * along.reshape(-1, *flat)
    # P(x), mm: the share of a centred grid of length 2|x| on one side, with the sign of x.
    P = x * strain.grid_factor(s, 2 * np.abs(x))
    low, high = (1 - x[:2] / L) * P[:2]
    mean = (high - low) / grid + np.tensordot(weights, P[2:], axes=1) / (2 * L)
    return mean / strain.grid_factor(s, grid)


def error(s: HingeSection, grid_length: Array | float, shift: Array | float) -> Array:
    """Largest relative error of the reading of a grid that lies `shift` mm off the hinge's middle, either
    way."""
    off = np.broadcast_to(shift, np.broadcast_shapes(s.shape, np.shape(grid_length), np.shape(shift)))
    return np.abs(reading(s, grid_length, np.stack([off, -off])) - 1).max(axis=0)


def allowed(s: HingeSection, grid_length: float, share: float) -> Array:
    """Largest offset of a grid from the hinge's middle with an error of reading of at most `share`, mm.

    The error grows with the distance. Distances beyond a grid's length are not searched; on a two-sided hinge
    it may not climb its fillets. Raises CheckFailure if it does even in the middle.
    """
    flat = s.straight_length + s.fillet_radius
    room = np.where(s.two_sided, np.maximum(flat - grid_length, 0.0) / 2, grid_length)
    low, high = np.zeros(s.shape), np.broadcast_to(room, s.shape)
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        kept = error(s, grid_length, middle) <= share
        low, high = np.where(kept, middle, low), np.where(kept, high, middle)
    return low


FOIL_HEAT = 3.6e6  # J/(m3 K), constantan: 8900 kg/m3 x 410 J/(kg K)
BACKING_HEAT = 1.55e6  # J/(m3 K), polyimide: 1420 kg/m3 x 1090 J/(kg K)


@dataclass(frozen=True)
class Power:
    """The power in a gauge. resistance ohm; conductivity of the backing W/(m K); on_time and period s.

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
        If on_time is longer than the period.
    """
    if power.on_time > power.period:
        legal = f"up to {power.period:g} s"
        raise InputError("readout.on_time", "longer than readout.period", value=power.on_time, legal=legal)
    steady = continuous(excitation, gauge, power)
    tau = time_constant(gauge, power)
    if tau == 0.0:  # a grid on the bare metal
        return _heating(steady.power * power.on_time / power.period, steady.rise, gauge, power)
    on, off = exp(-power.on_time / tau), exp(-(power.period - power.on_time) / tau)
    leaf = steady.power * power.leaf_resistance
    rise = leaf + (steady.rise - leaf) * (1 - on) / (1 - on * off)
    return _heating(steady.power * power.on_time / power.period, rise, gauge, power)


def warmth(excitation: float, gauge: Gauge, power: Power, after: float) -> float:
    """Rise of the grid over the body, K, `after` s from the moment that its power comes on in the settled
    cycle.

    Parameters
    ----------
    excitation
        Of the bridge, V.
    gauge, power
        The gauge, and what heats it.
    after
        s, up to power.on_time.
    """
    steady, tau = continuous(excitation, gauge, power), time_constant(gauge, power)
    if tau == 0.0:
        return steady.rise
    leaf = steady.power * power.leaf_resistance
    on, off = exp(-power.on_time / tau), exp(-(power.period - power.on_time) / tau)
    cold = 1 - (1 - on) * off / (1 - on * off)  # share of the way that is left as power comes on
    return leaf + (steady.rise - leaf) * (1 - cold * exp(-after / tau))


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
