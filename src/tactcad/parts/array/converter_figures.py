"""Figures of bridges that a sigma-delta converter reads: they stay warm, so the grids' heat sets their
supply, and the converter takes one after the other.
"""

from __future__ import annotations

from tactcad.design.sensing import Converter

from ..bought.electronic_parts import SET_AMPERE, nearest_e192
from .layout import Layout

RATE = 50.0  # Hz, results while one input is read; chosen: the filter's first notch lies on the mains
ORDER = 3  # of the filter: it needs so many of its periods after each change of input
HEAT_LEFT = 0.98  # of what the backing bears: the LT3042's 100 uA may be 1 % more
ANALOGUE_OHM = 33.2e3  # sets the converter's own supply: 3.32 V
E192_STEP = 10 ** (-1 / 192)


def converter_supply() -> float:
    """Of the converter, V: its reference, which the bridges' supply is, may not exceed it."""
    return SET_AMPERE * ANALOGUE_OHM


def supply_ohm(layout: Layout) -> float:
    """Of the resistor that sets the bridges' supply, ohm: what a grid's backing bears all the time."""
    from .hinge_section import design_gauge  # needs numpy, which a bill with a card does not

    d, gauge = layout.design, design_gauge(layout.design)
    area = gauge.grid_length * gauge.grid_width * 1e-6
    borne = 2 * (HEAT_LEFT * d.gauge.power_density * 1e3 * area * d.gauge.resistance) ** 0.5
    most = min(borne, 0.99 * converter_supply()) / SET_AMPERE
    ohm = nearest_e192(most)
    return ohm if ohm <= most else nearest_e192(ohm * E192_STEP)


def bridge_supply(layout: Layout) -> float:
    """V, all the time."""
    return SET_AMPERE * supply_ohm(layout)


def settling() -> float:
    """From one input's result to the next one's, s."""
    return ORDER / RATE


def round_time(layout: Layout, converter: Converter) -> float:
    """Until every element of the fullest board has one result, s."""
    rows = [sum(p.row == row for p in layout.elements) for row in (1, 2)]
    return max(min(n, converter.inputs) for n in rows) * settling()
