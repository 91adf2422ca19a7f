"""Rules on gauges' power, bridges, amplifiers, multiplexers and converter: that they take each other."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import wraps
from math import ceil, dist, floor, log10, sqrt
from typing import Any

from tactcad.design.sensing import AMPLIFIERS, MULTIPLEXERS, SWITCHES, WIRES, Readout, StrainGauge, Wiring
from tactcad.design.tree import Design

from ..array.bridge_figures import bridge_signal, heating, imbalance, jitter, sampling_time, settling_time
from ..array.converter_figures import bridge_supply, converter_supply, on_time, rate
from ..array.hinge_section import design_readout
from ..array.layout import Layout
from ..array.leads import (
    AHEAD_OF_LEADS,
    LAST,
    WHOLE,
    boards,
    lead_routes,
    least_to_board,
    longest_lead_resistance,
    recess_length,
)
from ..bought.electronic_parts import (
    DROPOUT,
    REFERENCE,
    REFERENCE_MOST_VOLTS,
    bridge_resistance,
    completion_resistance,
    completion_tolerance,
    converter_of,
    regulator_gives,
)
from ..language.finding import SAME, Finding
from .gauge_rules import lead
from .rule import at_least, at_most, rule, wrong

# Least bonded length of leads, in their diameters; chosen: enough for the glue to take the pull of a wire by
# its insulation.
RELIEF = 10


@rule(after="no_slivers")
def gauge_lies_in_slot(layout: Layout) -> Iterator[Finding]:
    """A hinge that is slotted from both sides has no flat face but the slots' floors."""
    if layout.design.element.sides == "one":
        return
    gauge = layout.design.gauge
    reach = max(gauge.carrier_arm_side, gauge.carrier_body_side, gauge.grid_length / 2)
    for p in layout.elements:
        flat = round(p.hinge.l / 2 - p.hinge.r, 9)
        if reach > flat + SAME:
            yield wrong(
                "element.sides",
                f"no gauge can be bonded on element {p.number}: the floor of its slots is flat for "
                f"{2 * flat:g} mm between the fillets, the carrier reaches {reach:g} mm to a side of "
                "its middle",
                "two",
                f'"one"; or gauge.carrier_arm_side and gauge.carrier_body_side of at most {flat:g} mm',
            )


def _set_first(r: Readout, *names: str) -> str:
    """The first of these fields that differs from its default, or the first of all."""
    came = Readout()
    return next((name for name in names if getattr(r, name) != getattr(came, name)), names[0])


def _borne(fits: Callable[[float], bool]) -> float:
    """The largest share, from 0 to 1, up to which all fit; 0 if none does."""
    least, most = 0.0, 1.0
    for _ in range(30 if fits(0.0) else 0):
        middle = (least + most) / 2
        least, most = (middle, most) if fits(middle) else (least, middle)
    return least


def by_card(find: Callable[[Layout], Iterator[Finding]]) -> Callable[[Layout], Iterable[Finding]]:
    """A rule's function that passes if a sigma-delta converter reads the bridges."""

    @wraps(find)
    def found(layout: Layout) -> Iterable[Finding]:
        return () if converter_of(layout.design) else find(layout)

    return found


@rule()
@by_card
def reading_within_period(layout: Layout) -> Iterator[Finding]:
    r = layout.design.readout
    if r.on_time > r.period:
        what = f"readout.on_time = {r.on_time:g} is longer than readout.period = {r.period:g}"
        legal = {"on_time": f"at most {r.period:g} s", "period": f"at least {r.on_time:g} s"}
        name = _set_first(r, *legal)
        yield wrong(f"readout.{name}", what, getattr(r, name), legal[name])


@rule(stands_on=("amplifier",))
@by_card
def amplifier_has_gain(layout: Layout) -> Iterator[Finding]:
    r = layout.design.readout
    amplifier = AMPLIFIERS[r.amplifier]
    if not amplifier.takes(r.gain):
        yield wrong("readout.gain", f"no gain of the {r.amplifier}", r.gain, amplifier.legal_gains)


@rule(stands_on=("amplifier", "multiplexer", "switch"))
@by_card
def supplies_suit_parts(layout: Layout) -> Iterator[Finding]:
    r = layout.design.readout
    parts = (AMPLIFIERS[r.amplifier], MULTIPLEXERS[r.multiplexer])
    least, most = max(p.least_supply for p in parts), min(p.most_supply for p in parts)
    between = round(r.supply_positive - r.supply_negative, 9)
    if not least <= between <= most:
        name = _set_first(r, "supply_positive", "supply_negative")
        positive = name == "supply_positive"
        other = "supply_negative" if positive else "supply_positive"
        fixed = getattr(r, other)
        low, high = (least + fixed, most + fixed) if positive else (fixed - most, fixed - least)
        yield wrong(
            f"readout.{name}",
            f"{between:g} V between the supplies is not for {r.amplifier} and {r.multiplexer}",
            getattr(r, name),
            f"from {low:g} to {high:g} V with readout.{other} = {fixed:g}",
        )
    yield from at_most(
        "readout.excitation",
        f"more than an open {r.switch} bears",
        r.excitation,
        SWITCHES[r.switch].most_volts,
        f"at most {SWITCHES[r.switch].most_volts:g} V",
    )


@rule(after="override_names_element", stands_on=("multiplexer",))
@by_card
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
@by_card
def gauge_bears_power(layout: Layout) -> Iterator[Finding]:
    d = layout.design
    r, hot = d.readout, heating(layout)

    def load(**changed: Any) -> float:
        """Share of the backing's limit."""
        found = heating(Layout(replace(d, readout=replace(r, **changed)))) if changed else hot
        return max(found.power_density / d.gauge.power_density, found.rise / d.gauge.rise)

    if load() <= 1.0 + SAME:
        return
    name = _set_first(r, "excitation", "on_time", "period")
    if name == "on_time" and (share := _borne(lambda s: load(on_time=max(s, SAME) * r.on_time) <= 1.0)):
        legal = f"at most {rounded_down(share * r.on_time)} s"
    elif name == "period" and (share := _borne(lambda s: load(period=r.period / max(s, SAME)) <= 1.0)):
        legal = f"at least {1 / float(rounded_down(share / r.period)):.4g} s"
    else:
        name = "excitation"
        legal = f"at most {rounded_down(r.excitation / load() ** 0.5)} V, or shorter readings"
    yield wrong(
        f"readout.{name}",
        f"more than the gauge's backing bears: {hot.power_density:.3g} kW/m2 of grid on average "
        f"(gauge.power_density = {d.gauge.power_density:g}), {hot.rise:.3g} K over the body "
        f"(gauge.rise = {d.gauge.rise:g})",
        getattr(r, name),
        legal,
    )


@rule(after="override_names_element", stands_on=("amplifier", "multiplexer", "switch", "completion"))
@by_card
def bridge_stays_in_range(layout: Layout) -> Iterator[Finding]:
    """With no load, every tolerance at its worst."""
    d, chain, lead = layout.design, design_readout(layout.design), longest_lead_resistance(layout)
    arm = completion_tolerance(d)
    low, high = imbalance(d, lead, arm)
    if chain.lowest <= low and high <= chain.highest:
        return
    said = (
        f"unloaded bridges reach {low:.3g} to {high:.3g} V behind the amplifier, whose range is "
        f"{chain.lowest:.3g} to {chain.highest:.3g}"
    )

    def bearable(reach: Callable[[float], tuple[float, float]]) -> float:
        """Share of a cause that the range leaves room for."""

        def fits(share: float) -> bool:
            lowest, highest = reach(share)
            return chain.lowest <= lowest and highest <= chain.highest

        return _borne(fits)

    borne = [(cause, share) for cause in _causes(layout, arm) if (share := bearable(cause.reach)) > 0]
    if borne:  # the largest contribution
        cause, share = min(borne, key=lambda found: max(map(abs, found[0].reach(0.0))))
        yield wrong(cause.path, said, cause.value, cause.legal(share))
    elif too_small := _too_small_a_range(d.readout, said, low, high):
        yield too_small
    elif not chain.lowest < 0.0 < chain.highest:
        yield wrong("readout.headroom", said, d.readout.headroom, "both supplies further than this from 0 V")
    else:
        yield _too_much_gain(d, said, bearable(lambda share: (share * low, share * high)))


def _too_small_a_range(r: Readout, said: str, low: float, high: float) -> Finding | None:
    """The first field, set otherwise than by default, for which another value alone brings these volts into
    range."""
    needed: dict[str, Any] = {
        "headroom": min(r.supply_positive - high, low - r.supply_negative),
        "adc_range": max(high, -low),
        "supply_negative": low - r.headroom,
        "supply_positive": high + r.headroom,
    }
    for name in (name for name in needed if getattr(r, name) != getattr(Readout(), name)):
        now = replace(r, **{name: needed[name]})
        reach = min(low - now.supply_negative, now.supply_positive - high) - now.headroom
        if needed[name] and min(reach, now.adc_range - max(high, -low), now.headroom) >= -SAME:
            upper = needed[name] < getattr(r, name)
            legal = f"at {'most' if upper else 'least'} {_inward(needed[name], upper)} V"
            return wrong(f"readout.{name}", said, getattr(r, name), legal)
    return None


@dataclass(frozen=True)
class _Cause:
    """A cause of an unbalanced bridge: a field and its value; the bridges' output with a share of it, V; the
    legal value if the range allows that share."""

    path: str
    value: object
    reach: Callable[[float], tuple[float, float]]
    legal: Callable[[float], str]


def _causes(layout: Layout, arm: float) -> Iterator[_Cause]:
    """Fields that the design sets otherwise than by default."""
    d, lead = layout.design, longest_lead_resistance(layout)
    r, ohm, tolerance = d.readout, completion_resistance(d), d.gauge.resistance_tolerance
    if ohm != d.gauge.resistance:
        alike = replace(d, readout=replace(r, completion_resistance=d.gauge.resistance))
        yield _Cause(
            "readout.completion_resistance",
            ohm,
            lambda share: imbalance(alike, lead, arm),
            lambda share: f"{d.gauge.resistance:g} ohm, the gauge's",
        )
    if r.bridge_offset:
        yield _Cause(
            "readout.bridge_offset",
            r.bridge_offset,
            lambda s: imbalance(replace(d, readout=replace(r, bridge_offset=s * r.bridge_offset)), lead, arm),
            lambda share: f"at most {rounded_down(share * abs(r.bridge_offset))}, plus or minus",
        )
    if r.connection == "two-wire":
        yield _Cause(
            "wiring.to_board",
            d.wiring.to_board,
            lambda share: imbalance(d, share * lead, arm),
            lambda share: _shorter(layout, share),
        )
    own = r.completion_tolerance is not None
    if own or r.completion != Readout().completion:
        yield _Cause(
            "readout.completion_tolerance" if own else "readout.completion",
            arm if own else r.completion,
            lambda share: imbalance(d, lead, share * arm),
            lambda share: f"resistors within {rounded_down(arm * share)} of their value",
        )
    elif tolerance != StrainGauge().resistance_tolerance:
        yield _Cause(
            "gauge.resistance_tolerance",
            tolerance,
            lambda s: imbalance(
                replace(d, gauge=replace(d.gauge, resistance_tolerance=s * tolerance)), lead, arm
            ),
            lambda share: f"at most {rounded_down(tolerance * share)}",
        )


def _shorter(layout: Layout, share: float) -> str:
    """Leads cut to a share of their length; they are cut to whole steps."""
    w, longest = layout.design.wiring, max(lead_routes(layout), key=lambda route: route.cut)
    less = longest.length - (share * longest.cut - WHOLE) / (1 + w.slack)
    most = w.to_board - less
    if less > longest.loop:  # then the stretch from tie to clamp, which may run aslant
        tie, clamp = longest.points[2:4]
        run = max(dist(tie, clamp) - (less - longest.loop), 0.0)
        most = LAST + sqrt(max(run**2 - (clamp[1] - tie[1]) ** 2, 0.0))
    three = 'readout.connection = "three-wire"'
    return f"at most {floor(most)} mm, or {three}" if most >= least_to_board(layout) else three


def _too_much_gain(design: Design, said: str, share: float) -> Finding:
    """If no single cause is to blame: a gain that the amplifier has, or less excitation."""
    r, amplifier = design.readout, AMPLIFIERS[design.readout.amplifier]
    most = r.gain * share
    fitting = [f"{g:g}" for g in amplifier.gains if g <= most]
    if fitting:
        return wrong("readout.gain", said, r.gain, f"{' or '.join(fitting)}, or less excitation")
    if not amplifier.gains and most >= amplifier.least_gain:
        return wrong("readout.gain", said, r.gain, f"at most {rounded_down(most)}, or less excitation")
    return wrong("readout.excitation", said, r.excitation, f"at most {rounded_down(r.excitation * share)} V")


def rounded_down(value: float) -> str:
    """To three digits, not above the value (> 0)."""
    return _inward(value, True)


def _inward(bound: float, upper: bool) -> str:
    """A bound (not 0) to three digits, on its legal side."""
    step = 10.0 ** (floor(log10(abs(bound))) - 2)
    steps = floor(bound / step + SAME) if upper else ceil(bound / step - SAME)
    return f"{steps * step:g}"


@rule(after="override_names_element", stands_on=("amplifier", "multiplexer", "switch"))
@by_card
def inputs_within_common_mode(layout: Layout) -> Iterator[Finding]:
    """Both outputs of a bridge lie where amplifier and multiplexer take them: while it is read, and at its
    supply while its switch is open."""
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
    least = r.excitation + amplifier.below_positive
    if r.supply_positive < least - SAME:
        legal = {"supply_positive": f"at least {least:.3g} V, or less excitation"}
        if r.supply_positive > amplifier.below_positive:
            legal |= {"excitation": f"at most {rounded_down(r.supply_positive - amplifier.below_positive)} V"}
        name = _set_first(r, *legal)
        yield wrong(
            f"readout.{name}",
            f"bridges fed with {r.excitation:g} V lie above the {r.amplifier}'s common mode while no switch "
            "is closed",
            getattr(r, name),
            legal[name],
        )


@rule(stands_on=("amplifier", "multiplexer"))
@by_card
def switching_settles(layout: Layout) -> Iterator[Finding]:
    r = layout.design.readout
    late, sampling = jitter(layout.design), sampling_time(layout.design)
    settling = settling_time(layout.design) + late
    least, left = settling + sampling, r.on_time - settling
    if r.mains is not None and r.samples * r.mains > r.sample_rate:
        what = f"{r.samples} samples in a period of the mains are more than readout.sample_rate gives"
        yield wrong("readout.samples", what, r.samples, f"at most {floor(r.sample_rate / r.mains)}")
    elif (
        r.instant is not None
        and r.on_time >= least
        and not settling - SAME <= r.instant <= r.on_time - sampling + SAME
    ):
        span = f"from {settling:.3g} s, when the output has settled, to {r.on_time - sampling:.3g} s"
        what = f"the samples, {late:.3g} s early or late, are not within the settled, powered time"
        yield wrong("readout.instant", what, r.instant, span)
    elif r.mains is not None and r.on_time < least:
        what = f"settling and jitter take {settling:.3g} s and a period of the mains {sampling:.3g} s"
        yield wrong("readout.on_time", what, r.on_time, f"at least {least * 1.005:.3g} s")
    elif r.on_time < least:
        legal = {"on_time": f"at least {least * 1.005:.3g} s"}
        if (most := floor(min(left * r.sample_rate, (left - late) * r.sample_rate + 1))) >= 1:
            legal |= {"samples": f"at most {most}"}
        if left > late:
            fastest = max(r.samples / left, (r.samples - 1) / (left - late))
            legal |= {"sample_rate": f"at least {_inward(fastest, False)} Hz"}
        name = _set_first(r, *legal)
        yield wrong(
            f"readout.{name}",
            f"settling and jitter take {settling:.3g} s and {r.samples} samples {sampling:.3g} s, more than "
            f"readout.on_time = {r.on_time:g} of each readout.period = {r.period:g}",
            getattr(r, name),
            legal[name],
        )


@rule(after="recess_fits_rear")
def leads_are_relieved(layout: Layout) -> Iterator[Finding]:
    """The leads are bonded into the recess over a length that holds them."""
    d = layout.design
    behind_wall = recess_length(layout) - AHEAD_OF_LEADS
    terminals = d.bonding.terminal_length if d.bonding else 0.0
    bonded, least, room = d.wiring.bonded, RELIEF * lead(layout), behind_wall - terminals
    if d.bonding and room < least - SAME <= behind_wall:
        legal = f"at most {behind_wall - least:g} mm, or a longer element.rear_length"
        yield wrong("bonding.terminal_length", "no room to bond leads behind it", terminals, legal)
        return
    w, came = d.wiring, Wiring()
    if bonded < least - SAME and w.wire != came.wire and bonded == came.bonded:  # the wire alone was set
        fitting = [name for name, wire in WIRES.items() if RELIEF * wire.outer <= bonded + SAME]
        legal = f"{', '.join(fitting)}, or wiring.bonded from {least:g} mm"
        what = f"a lead needs {RELIEF} of its diameters, {least:g} mm, bonded for its strain relief"
        yield wrong("wiring.wire", f"{what}; wiring.bonded is {bonded:g}", w.wire, legal)
        return
    legal = f"from {least:g} mm, {RELIEF} diameters of the lead, to {room:g} mm, behind the terminals"
    yield from at_least("wiring.bonded", "leads without strain relief", bonded, least, legal)
    yield from at_most("wiring.bonded", "reaches over the gauge's terminals", bonded, room, legal)


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
