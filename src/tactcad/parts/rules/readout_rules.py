"""Rules on gauges' power, bridges, amplifiers, multiplexers and converter: that they take each other."""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil, inf

from tactcad.design.electronics import AMPLIFIERS, MULTIPLEXERS, SWITCHES

from ..boards import boards
from ..bridge_figures import bridge_signal, completion_tolerance, heating, imbalance, settling_time
from ..electronic_parts import completion_resistance
from ..finding import Finding
from ..hinge_section import design_readout
from ..layout import Layout
from ..lead_route import longest_lead_resistance, recess_length
from .gauge_rules import lead
from .rule import at_least, at_most, rule, wrong

# Leads are bonded over so many of their own diameters at least; chosen: as far as glue takes up the pull of
# a wire whose insulation it holds.
RELIEF = 10


@rule()
def reading_within_period(layout: Layout) -> Iterator[Finding]:
    r = layout.design.readout
    yield from at_most(
        "readout.on_time", "longer than readout.period", r.on_time, r.period, f"at most {r.period:g} s"
    )


@rule()
def amplifier_has_gain(layout: Layout) -> Iterator[Finding]:
    r = layout.design.readout
    amplifier = AMPLIFIERS[r.amplifier]
    if not amplifier.takes(r.gain):
        yield wrong("readout.gain", f"no gain of the {r.amplifier}", r.gain, amplifier.legal_gains)


@rule()
def supplies_suit_parts(layout: Layout) -> Iterator[Finding]:
    r = layout.design.readout
    parts = (AMPLIFIERS[r.amplifier], MULTIPLEXERS[r.multiplexer])
    least, most = max(p.least_supply for p in parts), min(p.most_supply for p in parts)
    between = round(r.supply_positive - r.supply_negative, 9)
    if not least <= between <= most:
        yield wrong(
            "readout.supply_positive",
            f"{between:g} V between the supplies is not for {r.amplifier} and {r.multiplexer}",
            r.supply_positive,
            f"from {least + r.supply_negative:g} to {most + r.supply_negative:g} V "
            f"with readout.supply_negative = {r.supply_negative:g}",
        )
    yield from at_most(
        "readout.excitation",
        f"more than an open {r.switch} bears",
        r.excitation,
        SWITCHES[r.switch].most_volts,
        f"at most {SWITCHES[r.switch].most_volts:g} V",
    )


@rule(after="override_names_element")
def boards_have_inputs(layout: Layout) -> Iterator[Finding]:
    r = layout.design.readout
    needed, channels = len(boards(layout)), MULTIPLEXERS[r.multiplexer].channels
    if r.inputs is not None and r.inputs < needed:
        most = max(m.channels for m in MULTIPLEXERS.values())
        fewest = sum(ceil(len(row) / most) for row in layout.design.array.row_arms)
        other = f", or a readout.multiplexer of {most} channels" if fewest <= r.inputs else ""
        yield wrong(
            "readout.inputs",
            f"{len(layout.elements)} elements need {needed} boards of {channels} channels (a row's own), "
            "each with an input",
            r.inputs,
            f"at least {needed}{other}",
        )


@rule(after="reading_within_period")
def gauge_bears_power(layout: Layout) -> Iterator[Finding]:
    d = layout.design
    hot, volts = heating(d), d.readout.excitation
    mean, rise = hot.power_density / d.gauge.power_density, hot.rise / d.gauge.rise
    most = volts / max(mean, rise) ** 0.5
    yield from at_most(
        "readout.excitation",
        f"more than the gauge's backing bears: {hot.power_density:.3g} kW/m2 of grid on average "
        f"(gauge.power_density = {d.gauge.power_density:g}), {hot.rise:.3g} K over the leaf "
        f"(gauge.rise = {d.gauge.rise:g})",
        volts,
        most,
        f"at most {rounded_down(most)} V, or shorter readings",
    )


@rule(after="override_names_element")
def bridge_stays_in_range(layout: Layout) -> Iterator[Finding]:
    """With no load, every tolerance at its worst."""
    d, chain = layout.design, design_readout(layout.design)
    low, high = imbalance(layout)
    if chain.lowest <= low and high <= chain.highest:
        return
    off = completion_tolerance(d)
    own = d.readout.completion_tolerance is not None
    same = d.readout.completion_resistance in (None, d.gauge.resistance)
    without_low, without_high = imbalance(layout, 0.0)
    most = d.readout.gain * min(_share(chain.lowest, 0.0, low), _share(chain.highest, 0.0, high))
    path, legal = "readout.gain", f"at most {rounded_down(most)}, or less excitation"
    value: object = d.readout.gain
    if not chain.lowest < 0.0 < chain.highest:
        r = d.readout
        path, value = "readout.headroom", r.headroom
        legal = f"less than either supply: {min(r.supply_positive, -r.supply_negative):g} V"
    elif not same:
        path, value = "readout.completion_resistance", completion_resistance(d)
        legal = f"{d.gauge.resistance:g} ohm, the gauge's"
    elif chain.lowest < without_low and without_high < chain.highest:
        tolerance = off * min(
            _share(chain.lowest, without_low, low), _share(chain.highest, without_high, high)
        )  # linear within a hundredth
        path = "readout.completion_tolerance" if own else "readout.completion"
        value = off if own else d.readout.completion
        legal = f"resistors within {rounded_down(0.99 * tolerance)} of their value"
    yield wrong(
        path,
        f"unloaded bridges reach {low:.3g} to {high:.3g} V behind the amplifier, whose range is "
        f"{chain.lowest:.3g} to {chain.highest:.3g}",
        value,
        legal,
    )


def _share(limit: float, without: float, with_all: float) -> float:
    """Share of the way from `without` to `with_all` at which the limit is met; inf where it leads away."""
    moved = with_all - without
    return (limit - without) / moved if moved * limit > 0 else inf


def rounded_down(value: float) -> str:
    """To three digits, not above the value."""
    text = f"{value:.3g}"
    return text if float(text) <= value else f"{value * 0.999:.3g}"


@rule(after="override_names_element")
def inputs_within_common_mode(layout: Layout) -> Iterator[Finding]:
    """Both outputs of a bridge lie where amplifier and multiplexer take them."""
    r, amplifier = layout.design.readout, AMPLIFIERS[layout.design.readout.amplifier]
    volts = bridge_signal(layout.design, longest_lead_resistance(layout))
    low, high = min(volts), max(volts)
    under = f"bridges at {low:.3g} to {high:.3g} V"
    least = max(low - amplifier.above_negative, -30.0)
    yield from at_most(
        "readout.supply_negative",
        f"{under} lie below the {r.amplifier}'s common mode",
        r.supply_negative,
        min(least, low),
        f"at most {least:.3g} V, or more excitation",
    )
    most = max(high + amplifier.below_positive, r.excitation)
    yield from at_least(
        "readout.supply_positive",
        f"{under}, fed with {r.excitation:g} V, lie above the {r.amplifier}'s common mode or the "
        f"{r.multiplexer}'s supply",
        r.supply_positive,
        most,
        f"at least {most:.3g} V, or less excitation",
    )


@rule()
def switching_settles(layout: Layout) -> Iterator[Finding]:
    r = layout.design.readout
    settling, sampling = settling_time(layout.design), r.samples / r.sample_rate
    least = settling + sampling
    if r.on_time < least:
        yield wrong(
            "readout.on_time",
            f"settling takes {settling:.3g} s and {r.samples} samples {sampling:.3g} s",
            r.on_time,
            f"at least {least * 1.005:.3g} s",
        )


@rule(after="recess_fits_rear")
def leads_are_relieved(layout: Layout) -> Iterator[Finding]:
    """The leads are bonded into the recess over a length that holds them."""
    bonded, least, room = layout.design.wiring.bonded, RELIEF * lead(layout), recess_length(layout)
    legal = f"from {least:g} mm, {RELIEF} diameters of the lead, to {room:g} mm, the wire recess"
    yield from at_least("wiring.bonded", "leads without strain relief", bonded, least, legal)
    yield from at_most("wiring.bonded", "longer than the wire recess", bonded, room, legal)
