"""Rules on bridges that a sigma-delta converter reads."""

from __future__ import annotations

from collections.abc import Iterator

from ..array.converter_figures import bridge_supply, on_time
from ..array.layout import Layout
from ..bought.electronic_parts import converter_of
from ..language.finding import Finding
from .rule import at_least, rule, wrong


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
