"""Whether the circuit works: every gauge in one bridge, the read-out's rules kept, signals in range, and the
asked force resolved; whether the gauges bear their foil's strain.

The rules (parts/rules/readout_rules.py) refuse a design that fails here; this check reads the written
netlist. A limit that nobody read in a maker's sheet never decides silently: results that depend on it are
flagged, with the parts.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from tactcad.checks.check import Check
from tactcad.circuit.bridges import netlist
from tactcad.circuit.digital_readout import DigitalReadout, digital_readout
from tactcad.circuit.element_signals import ElementSignal, element_signals
from tactcad.circuit.netlist import GROUND, Component, Kind, Netlist
from tactcad.design.messages import CheckFailure
from tactcad.design.sensing import FOILS
from tactcad.design.tree import Design
from tactcad.parts.array.hinge_section import design_readout
from tactcad.parts.array.layout import Layout
from tactcad.parts.bought.electronic_parts import LINK, WIRE_LINK, converter_of, parts_used, unread
from tactcad.parts.language.finding import Finding
from tactcad.parts.rules.gauge_rules import leads_have_room
from tactcad.parts.rules.readout_rules import (
    boards_have_inputs,
    bridge_stays_in_range,
    converter_has_reference,
    converter_reads_within_period,
    gauge_bears_power,
    inputs_within_common_mode,
    leads_are_relieved,
    switching_settles,
)

Arms = dict[str, dict[str, list[Component]]]


def check_circuit(design: Design) -> Iterator[Finding]:
    """Findings on the array's netlist, and on its bridges, inputs, power, times and leads."""
    layout = Layout(design)
    circuit = netlist(layout)
    yield from check_bridges(circuit)
    yield from check_inputs(circuit)
    for check, rule in (
        ("channels", boards_have_inputs),
        ("bridge-balance", bridge_stays_in_range),
        ("common-mode", inputs_within_common_mode),
        ("gauge-power", gauge_bears_power),
        ("settling", switching_settles),
        ("converter-reference", converter_has_reference),
        ("converter-time", converter_reads_within_period),
        ("lead-room", leads_have_room),
        ("strain-relief", leads_are_relieved),
    ):
        for f in rule(layout):
            message = f"{f.message} ({f.part} = {f.value}; legal: {f.limit})"
            yield Finding(check, "fail", design.name, (), f.value, f.limit, message)


def check_bridges(circuit: Netlist) -> Iterator[Finding]:
    """A failure for every gauge that is not in just one whole bridge, whose outputs are one channel's."""
    joined = _joined_by_leads(circuit)
    arms, pairs = _arms(circuit, joined), _channels(circuit, joined)
    found: Counter[str] = Counter()
    for switch in circuit.of_kind("switch"):
        supply = joined[circuit.on_board("regulator", switch.board).net("out")]
        found.update(_gauges_of_bridge(arms, pairs, supply, joined[switch.net("drain")]))
    for converter in circuit.of_kind("converter"):
        ends = joined[circuit.on_board("regulator", converter.board).net("out")], joined[GROUND]
        for pair in _inputs(converter):
            found.update(_gauges_on_inputs(arms, [joined[net] for net in pair], ends))
    for gauge in circuit.of_kind("gauge"):
        count = found[gauge.designator]
        if count != 1:
            message = f"gauge {gauge.designator} of E{gauge.element} is in {count} bridges that are read"
            yield Finding("one-bridge", "fail", gauge.designator, (), count, 1, message)


def check_inputs(circuit: Netlist) -> Iterator[Finding]:
    """A failure for every multiplexer that leaves its amplifier's inputs without a way for their bias
    currents at some address, or while it is not enabled; all switches open."""
    fed = _fed(circuit)
    supplies = {net for net, _ in circuit.supplies}
    for part in circuit.of_kind("multiplexer"):
        floating = [p.role for p in part.pins if p.role.startswith("S") and p.net not in fed]
        cut_off = part.net("enable") not in supplies
        if cut_off or floating:
            when = f"{part.net('enable')} is low" if cut_off else f"{floating[0]} is addressed"
            amplifier = circuit.on_board("amplifier", part.board).designator
            message = f"the inputs of {amplifier} float while {when}"
            yield Finding("floating-input", "fail", part.designator, (), len(floating), 0, message)
    for part in circuit.of_kind("converter"):
        if floating := [net for pair in _inputs(part) for net in pair if net not in fed]:
            message = f"inputs of {part.designator} float: {', '.join(floating)}"
            yield Finding("floating-input", "fail", part.designator, (), len(floating), 0, message)


def _inputs(converter: Component) -> list[tuple[str, str]]:
    """Nets of a converter's differential inputs."""
    nets = {p.role: p.net for p in converter.pins}
    count = sum(role.startswith("AIN") for role in nets)
    return [(nets[f"AIN{i}"], nets[f"AIN{i + 1}"]) for i in range(0, count, 2)]


def _gauges_on_inputs(arms: Arms, middles: Sequence[str], ends: tuple[str, str]) -> list[str]:
    """Gauges of the bridge whose outputs these are; none if an output has other than one arm to each
    end."""
    around = [arms.get(middle, {}).get(end, []) for middle in middles for end in ends]
    others = [c for middle in middles for found in arms.get(middle, {}).values() for c in found]
    if any(len(found) != 1 for found in around) or len(others) != 4 or middles[0] == middles[1]:
        return []
    return [c.designator for (c,) in around if c.kind == "gauge"]


def _fed(circuit: Netlist) -> set[str]:
    """Nets that resistors, gauges and leads join to the bridges' supply or to ground."""
    beside: dict[str, set[str]] = {}
    kinds: tuple[Kind, ...] = ("resistor", "gauge", "lead")
    for kind in kinds:
        for component in circuit.of_kind(kind):
            a, b = component.net("1"), component.net("2")
            beside.setdefault(a, set()).add(b)
            beside.setdefault(b, set()).add(a)
    reached, new = set[str](), {*circuit.excitations, GROUND}
    while new:
        reached |= new
        new = {net for at in new for net in beside.get(at, ())} - reached
    return reached


def _joined_by_leads(circuit: Netlist) -> dict[str, str]:
    """One name for all nets that leads, terminals and links join."""
    parent = {net: net for net in circuit.nets}

    def root(net: str) -> str:
        while parent[net] != net:
            net = parent[net]
        return net

    links = (c for c in circuit.of_kind("resistor") if c.part_no in (LINK, WIRE_LINK))
    for joint in (*circuit.of_kind("lead"), *links):
        parent[root(joint.net("2"))] = root(joint.net("1"))
    return {net: root(net) for net in parent}


def _arms(circuit: Netlist, joined: dict[str, str]) -> Arms:
    """Resistors and gauges by the nets at their two ends, either way round."""
    arms: Arms = {}
    resistors = (c for c in circuit.of_kind("resistor") if c.part_no not in (LINK, WIRE_LINK))
    for component in (*resistors, *circuit.of_kind("gauge")):
        first, second = (joined[component.net(role)] for role in "12")
        for a, b in ((first, second), (second, first)):
            arms.setdefault(a, {}).setdefault(b, []).append(component)
    return arms


def _channels(circuit: Netlist, joined: dict[str, str]) -> set[frozenset[str]]:
    """The two nets of every channel of the multiplexers."""
    pairs: dict[tuple[str, str], set[str]] = {}
    for multiplexer in circuit.of_kind("multiplexer"):
        for pin in multiplexer.pins:
            if pin.role.startswith("S"):
                pairs.setdefault((multiplexer.designator, pin.role[:-1]), set()).add(joined[pin.net])
    return set(map(frozenset, pairs.values()))


def _gauges_of_bridge(arms: Arms, pairs: set[frozenset[str]], supply: str, foot: str) -> list[str]:
    """Gauges among the four arms between the bridges' supply and a switch; none if there are not four, their
    middles have other connections, or are no channel's pair."""
    upper, lower = arms.get(supply, {}), arms.get(foot, {})
    middles = [net for net in lower if net in upper]
    around = [c for net in middles for c in (*upper[net], *lower[net])]
    ends = sum(len(found) for net in middles for found in arms[net].values())
    if len(middles) != 2 or len(around) != 4 or ends != 4 or frozenset(middles) not in pairs:
        return []
    return [c.designator for c in around if c.kind == "gauge"]


def check_signals(design: Design) -> Iterator[Finding]:
    """Failures by element. Raises CheckFailure if one is out of the estimator's range."""
    layout, wish = Layout(design), design.readout.force_resolution
    signals, converter = element_signals(layout), converter_of(design)
    if converter:
        found = digital_readout(layout, converter.name)
        yield from _beyond_converter(found, signals, unread(design, ("converter", "completion")))
    else:
        yield from _beyond_range(design, signals)
    stands_on = ("converter", "amplifier", "multiplexer", "switch", "completion")
    for signal in signals:
        least = signal.resolution * 1e3
        if wish is not None and least > wish:
            message = (
                f"tells no less than {least:.3g} mN from none (noise, quantisation, drift); "
                f"readout.force_resolution asks for {wish:g} mN{unread(design, stands_on)}"
            )
            who = signal.place.designator
            yield Finding("force-resolution", "fail", who, (), least, wish, message)


def _beyond_converter(
    found: DigitalReadout, signals: Sequence[ElementSignal], said: str
) -> Iterator[Finding]:
    """A bridge's output, out of balance by all its tolerances and under overload, if it exceeds the
    converter's input range at its gain."""
    most = found.excitation / found.gain
    for signal, reach in zip(signals, found.largest):
        if reach > most:
            message = (
                f"at the overload its bridge reaches {reach * 1e3:.3g} mV, tolerances at their worst; the "
                f"{found.converter.name} takes {most * 1e3:.3g} at a gain of {found.gain:g}{said}"
            )
            yield Finding("signal-range", "fail", signal.place.designator, (), reach, most, message)


def _beyond_range(design: Design, signals: Sequence[ElementSignal]) -> Iterator[Finding]:
    """Outputs beyond the range of amplifier and card."""
    chain = design_readout(design)
    said = unread(design, ("amplifier", "multiplexer", "switch", "completion"))
    for signal in signals:
        who = signal.place.designator
        for load, (low, high) in (("rated force", signal.rated), ("overload", signal.overload)):
            if low < chain.lowest or high > chain.highest:
                message = (
                    f"at the {load} its output reaches {low:.3g} or {high:.3g} V, tolerances at their worst; "
                    f"amplifier and converter take {chain.lowest:.3g} to {chain.highest:.3g}{said}"
                )
                yield Finding("signal-range", "fail", who, (), max(-low, high), chain.highest, message)
                break


# Results that depend on the figures of each kind of part.
STAND_ON = {
    "amplifier": "range, common mode, settling, noise, drift",
    "multiplexer": "supplies, settling, noise",
    "switch": "signal, the bridges' supply",
    "converter": "range, noise, time, drift",
    "completion": "imbalance, drift",
    "foil": "strain and fatigue of the gauge",
}


def check_gauges(design: Design) -> Iterator[Finding]:
    """Flags on the foil's strain, and on figures that were not read."""
    foil = FOILS[design.gauge.foil]
    try:
        signals = element_signals(Layout(design))
    except CheckFailure:  # out of the estimator's range: reported by the check of signals
        signals = []
    unread = "" if foil.verified else "; the limit is unread"
    tried = f"makers try them for {foil.cycles:.0e} cycles at"
    for check, strain, limit, said in (
        ("gauge-fatigue", _rated, foil.fatigue, f"at the rated force; {tried} +-{foil.fatigue * 1e6:g}"),
        ("gauge-strain", _overload, foil.strain, f"at overload; it bears {foil.strain * 1e6:g}"),
    ):
        if over := [s for s in signals if strain(s) > limit]:
            worst = max(over, key=strain)
            message = (
                f"foil {foil.name} of {len(over)} of {len(signals)} elements is strained by up to "
                f"{strain(worst) * 1e6:.0f} e-6 {said} e-6{unread}"
            )
            yield Finding(check, "flag", worst.place.designator, (), strain(worst), limit, message)
    if from_memory := {kind: part for kind, part in parts_used(design).items() if not part.verified}:
        names = "; ".join(f"{part.name} ({STAND_ON[kind]})" for kind, part in from_memory.items())
        message = f"not every figure was read in the maker's own sheet of: {names}"
        yield Finding("unread-figures", "flag", design.name, (), len(from_memory), 0, message)


def _rated(signal: ElementSignal) -> float:
    return signal.rated_strain


def _overload(signal: ElementSignal) -> float:
    return signal.overload_strain


CHECKS = (
    Check("circuit", "design", lambda design, _: check_circuit(design), place=50, quick=True),
    Check("signals", "design", lambda design, _: check_signals(design), place=60, quick=True),
    Check("gauge limits", "design", lambda design, _: check_gauges(design), place=65),
)
