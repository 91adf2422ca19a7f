"""Figures of bridges that a sigma-delta converter reads, one after the other: the grids' heat sets their
supply. They are on all the time (readout.power continuous), or once a period (duty):

    ON ___/----- warm up ----|-- input 1 --|-- input 2 --| ... |\\________ until the period is over
"""

from __future__ import annotations

from dataclasses import replace
from math import hypot

from tactcad.design.sensing import Converter

from ..bought.electronic_parts import SET_AMPERE, bridge_resistance, nearest_e192, regulator_gives
from .layout import Layout
from .leads import boards

MAINS = 50.0  # Hz, if none is said
ORDER = 3  # of the filter: it needs so many of its periods after each change of input
HEAT_LEFT = 0.98  # of what the backing bears: the LT3042's 100 uA may be 1 % more
ANALOGUE_OHM = 33.2e3  # sets the converter's own supply: 3.32 V
SET_FARAD = 1e-7  # across the resistor that sets a supply
WARM = 12.0  # time constants of grid and supply until the first input is read; chosen: 6e-6 are left
E192_STEP = 10 ** (-1 / 192)


def converter_supply() -> float:
    """The converter's supply, V: its reference, which is the bridges' supply, may not exceed it."""
    return SET_AMPERE * ANALOGUE_OHM


def supply_ohm(layout: Layout) -> float:
    """The resistor that sets the bridges' supply, ohm: for the highest supply that grids' backing, converter
    and regulator bear."""
    # these need numpy, which a bill with a card does not
    from tactcad.mechanics.gauge_signal import continuous, switched

    from .bridge_figures import power_of
    from .hinge_section import design_gauge

    d, gauge, power = layout.design, design_gauge(layout.design), power_of(layout)
    if d.readout.power == "duty":
        on = min(on_time(layout), power.period)  # a longer one is refused
        hot = switched(1.0, gauge, replace(power, on_time=on))
    else:
        hot = continuous(1.0, gauge, power)
    borne = (HEAT_LEFT * min(d.gauge.power_density / hot.power_density, d.gauge.rise / hot.rise)) ** 0.5
    given = regulator_gives(d.readout.supply_positive) * bridge_resistance(d) / fullest(layout)
    most = min(borne, 0.99 * converter_supply(), given) / SET_AMPERE
    ohm = nearest_e192(most)
    return ohm if ohm <= most else nearest_e192(ohm * E192_STEP)


def bridge_supply(layout: Layout) -> float:
    """V, while it is on."""
    return SET_AMPERE * supply_ohm(layout)


def converter_noise(layout: Layout, converter: Converter, gain: float) -> float:
    """Noise of one result at the bridge, V rms: the converter's own, which is white and grows as the gain
    falls, and Johnson noise of the bridge up to half the rate."""
    own = converter.noise * converter.noise_gain / gain * (rate(layout) / converter.noise_rate) ** 0.5
    from tactcad.mechanics.readout import BOLTZMANN, ROOM

    return hypot(own, (4 * BOLTZMANN * ROOM * layout.design.gauge.resistance * rate(layout) / 2) ** 0.5)


def fullest(layout: Layout) -> int:
    """Elements of the board that reads most."""
    return max(len(board.places) for board in boards(layout))


def rate(layout: Layout) -> float:
    """Results while one input is read, Hz; chosen: the filter's first notch lies on the mains."""
    return layout.design.readout.mains or MAINS


def settling(layout: Layout) -> float:
    """From one input's result to the next one's, s."""
    return ORDER / rate(layout)


def warm_up(layout: Layout) -> float:
    """From ON to where the first input may be read, s: grids are warm, and their supply has risen."""
    from tactcad.mechanics.gauge_signal import time_constant

    from .bridge_figures import power_of
    from .hinge_section import design_gauge

    grid = time_constant(design_gauge(layout.design), power_of(layout))
    return WARM * max(grid, ANALOGUE_OHM * SET_FARAD)


def on_time(layout: Layout) -> float:
    """Time from ON until every element of the fullest board has one result, s; for bridges always on,
    a round."""
    warm = warm_up(layout) if layout.design.readout.power == "duty" else 0.0
    return fullest(layout) * settling(layout) + warm
