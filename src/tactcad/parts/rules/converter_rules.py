"""Rules on bridges that a sigma-delta converter reads."""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil, floor

from tactcad.design.sensing import Readout

from ..array.converter_figures import bridge_supply, on_time, rate
from ..array.layout import Layout
from ..bought.electronic_parts import converter_of
from ..language.finding import Finding
from .rule import at_least, rule, wrong

# Fields of amplifier, multiplexer, switch and card.
OF_CARD = tuple(
    "excitation gain supply_negative headroom noise adc_bits adc_range samples on_time reference_mismatch "
    "amplifier switch multiplexer instant timing jitter hum adc_noise excitation_drift inputs "
    "sample_rate".split()
)
OFF_MAINS = 0.01  # relative; the mains' own frequency is off by as much (EN 50160)


@rule()
def converter_takes_field(layout: Layout) -> Iterator[Finding]:
    """Nothing is said of an amplifier or a card where a converter reads the bridges."""
    converter, r, came = converter_of(layout.design), layout.design.readout, Readout()
    if converter is None:
        return
    said = [name for name in OF_CARD if getattr(r, name) != getattr(came, name)]
    if said:
        what = f"the {converter.name} has no amplifier and no card: {', '.join(said)} mean nothing"
        yield wrong(f"readout.{said[0]}", what, getattr(r, said[0]), "without these fields")


@rule(stands_on=("converter",))
def converter_meets_mains(layout: Layout) -> Iterator[Finding]:
    """The filter's first notch, at its clock over a whole number, is no further from the mains than these
    are from their own frequency."""
    converter = converter_of(layout.design)
    if converter is None:
        return
    asked, whole = rate(layout), converter.clock / 32
    if abs(whole / round(whole / asked) / asked - 1) > OFF_MAINS:
        near = f"{whole / ceil(whole / asked):.4g} or {whole / floor(whole / asked):.4g} Hz"
        yield wrong("readout.mains", f"no rate of the {converter.name} is within 1 %", asked, near)


@rule(after="override_names_element", stands_on=("converter",))
def converter_has_reference(layout: Layout) -> Iterator[Finding]:
    """The bridges' supply, which their grids' heat allows, is its reference."""
    converter, gauge = converter_of(layout.design), layout.design.gauge
    if converter is None:
        return
    volts, least = bridge_supply(layout), converter.least_reference
    if volts < least:
        yield wrong(
            "gauge.resistance",
            f"the bridges bear {volts:.3g} V, and the reference of the {converter.name} takes no "
            f"less than {least:g} V",
            gauge.resistance,
            f"at least {gauge.resistance * (least / volts) ** 2 * 1.02:.3g} ohm, or a larger grid",
        )


@rule(after="override_names_element", stands_on=("converter",))
def converter_reads_within_period(layout: Layout) -> Iterator[Finding]:
    """Every element has one result in each period."""
    converter = converter_of(layout.design)
    if converter is None:
        return
    period, needed = layout.design.readout.period, on_time(layout)
    warm = "warm-up and " if layout.design.readout.power == "duty" else ""
    what = f"the {converter.name} takes {needed:.3g} s for {warm}one result of each of its elements"
    yield from at_least("readout.period", what, period, needed, f"at least {needed * 1.005:.3g} s")
