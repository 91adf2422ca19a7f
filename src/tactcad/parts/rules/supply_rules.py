"""A rule on the regulators that make a board's own supplies from VPOS."""

from __future__ import annotations

from collections.abc import Iterator

from ..array.converter_figures import converter_supply
from ..array.layout import Layout
from ..bought.electronic_parts import (
    DROPOUT,
    REFERENCE,
    REFERENCE_MOST_VOLTS,
    bridge_resistance,
    converter_of,
    regulator_gives,
)
from ..language.finding import Finding
from .readout_rules import rounded_down
from .rule import at_least, at_most, rule


@rule(after="override_names_element")
def regulators_take_supply(layout: Layout) -> Iterator[Finding]:
    """VPOS is within what they take, and above what they make; they give a warm bridge its current. A
    converter's bridges are fed with no more than they give (`supply_ohm`)."""
    r, converter = layout.design.readout, converter_of(layout.design)
    made = converter_supply() if converter else r.excitation
    limits = f"from {made + DROPOUT:.3g} to {REFERENCE_MOST_VOLTS:g} V"
    what = f"more than the board's regulator, {REFERENCE}, bears"
    yield from at_most("readout.supply_positive", what, r.supply_positive, REFERENCE_MOST_VOLTS, limits)
    what = f"the board's regulator, {REFERENCE}, cannot make {made:.3g} V from it"
    yield from at_least("readout.supply_positive", what, r.supply_positive, made + DROPOUT, limits)
    if converter is None:
        ohm, given = bridge_resistance(layout.design), regulator_gives(r.supply_positive)
        what = f"a bridge of {ohm:.3g} ohm takes more than the {given * 1e3:g} mA of the {REFERENCE}"
        legal = f"at most {rounded_down(given * ohm)} V"
        yield from at_most("readout.excitation", what, r.excitation, given * ohm, legal)
