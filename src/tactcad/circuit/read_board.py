"""One board's netlist, however many elements it reads: every channel of a multiplexer before an amplifier, or
of a sigma-delta converter.

    VPOS --[U4]-- EXC --+---------+         Designators: of channel c Qc and R(10 c + 1) to
                     Rc1|      Rc2|         R(10 c + 4); U1 amplifier, U2 multiplexer, U3 decoder,
      J2 RED  o-----+---+         |         U4 the bridges' supply, J1 to the card, J2 to the leads.
             Rc4 [0 ohm]          +-- MINUS
      J2 PLUS o-----+------------ | - PLUS
                               Rc3|
      J2 FOOT o--------------+----+
                             Qc
                             GND

Bare boards are equal. A channel that reads no element has its switch and Rc3 left off, and links for Rc1 and
Rc2: its two outputs lie at EXC, and no input floats. Rc4 joins RED and PLUS in such a channel, and for leads
of two wires; of three wires it is left off.

The bridges' supply is made from VPOS, and D1 keeps it below VPOS as that falls: supplies may come in any
order. D2 and D3 keep VNEG below and VPOS above ground while one of them is missing. R5 to R8 limit the
current into U2 and U3 while they have no supply, R91 to R94 keep their inputs low while the card's cable is
off.

With a converter the bridges lie between EXC and ground:

    VPOS --[U4]-- EXC --+---------+--- REFIN1+      Designators: of channel c R(10 c + 1) to R(10 c + 4) and
      |              Rc1|      Rc2|                 C(10 c + 1); U1 converter, U4 the bridges' supply, U5 the
      | J2 RED  o---+---+         |                 converter's, J1 to the controller, J2 to the leads.
      |          Rc4 [0 ohm]      +--- AIN(2c-1)
      | J2 PLUS o---+----[Cc1]----|--- AIN(2c-2)
      |                        Rc3|
      | J2 FOOT o-------------+---+
      |                      GND ----- REFIN1-
      '--[U5]-- V33 --- AVDD, IOVDD

Where no element is read Cc1 is left off too. D1 keeps EXC below V33, which the converter's inputs may not
exceed, in any order of power-up; D3 protects against a reversed VPOS. ON high switches U4 on: by the
controller, or by a jumper to VPOS next to it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from tactcad.design.sensing import AMPLIFIERS, COMPLETIONS, MULTIPLEXERS, SWITCHES, Converter, Multiplexer
from tactcad.design.tree import Design
from tactcad.parts.array.converter_figures import ANALOGUE_OHM, bridge_supply, supply_ohm
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.leads import leads
from tactcad.parts.bought.electronic_parts import (
    ACROSS_BRIDGE,
    ANTI_ALIAS,
    CLAMP,
    COMPLETION,
    DECOUPLING,
    FILTER_OHM,
    FILTER_RESISTOR,
    GAIN_RESISTOR,
    LINK,
    PULL_DOWN,
    REFERENCE,
    RESERVOIR,
    SERIES,
    SET_AMPERE,
    SET_RESISTOR,
    SUPPLY_RESISTOR,
    TO_CARD,
    TO_LEADS,
    WIRE_LINK,
    completion_resistance,
    gain_resistance,
    set_gain,
    supply_resistance,
)

from .netlist import GROUND, Component, Kind, Netlist, Pin

EXCITATION, POSITIVE, NEGATIVE, LOGIC = "EXC", "VPOS", "VNEG", "V5"
# Of the 74HCT238, as of the 74HC238: address, outputs in order, enables.
DECODER_ADDRESS, DECODER_OUTPUTS = ("1", "2", "3"), ("15", "14", "13", "12", "11", "10", "9", "7")
# Of the LT3042 in MSOP: role, pin, net; PGFB on VPOS, as its sheet states for unused power-good.
REFERENCE_PINS = (
    ("in", "1", POSITIVE),
    ("in2", "2", POSITIVE),
    ("enable", "3", POSITIVE),
    ("power_good", "4", ""),
    ("limit", "5", GROUND),
    ("feedback", "6", POSITIVE),
    ("set", "7", "SET"),
    ("ground", "8", GROUND),
    ("sense", "9", EXCITATION),
    ("out", "10", EXCITATION),
    ("slug", "11", GROUND),
)
OUTSIDE = "_IN"  # of a digital line's net between the card's connector and its series resistor


def board_netlist(design: Design, used: int, wires: int) -> Netlist:
    """The board that reads `used` elements by leads of two or three `wires`."""
    r, part = design.readout, MULTIPLEXERS[design.readout.multiplexer]
    components = [
        *_amplifier(design),
        _multiplexer(part),
        _decoder(part),
        *_reference(design),
        *_around(design, part),
    ]
    for channel in range(1, part.channels + 1):
        components += _channel(design, channel, channel <= used, wires)
    components += _connectors(part)
    supplies = ((POSITIVE, r.supply_positive), (NEGATIVE, r.supply_negative), (LOGIC, 5.0))
    return Netlist(f"{design.name}-board-{used}", r.excitation, supplies, tuple(components))


def lines(part: Multiplexer) -> tuple[str, ...]:
    """The board's digital lines."""
    return (*(f"A{i}" for i in range(len(part.address))), "ENABLE")


def two(
    designator: str, kind: Kind, value: str, part_no: str, nets: tuple[str, str], package: str = "",
    fitted: bool = True, **figures: float,
) -> Component:  # fmt: skip
    """A component with two pins."""
    pins = (Pin("1", "1", nets[0]), Pin("2", "2", nets[1]))
    return Component(
        designator, kind, value, part_no, pins, tuple(figures.items()), footprint=package, fitted=fitted
    )


def bridge_arms(design: Design, c: int, used: bool, wires: int, foot: str) -> Iterator[Component]:
    """Channel c: the bridge's three resistors, the third down to `foot`; and the link of red and plus."""
    package, arm = COMPLETIONS[design.readout.completion].package, completion_resistance(design)
    red, plus, minus = (f"CH{c}_{end}" for end in ("RED", "PLUS", "MINUS"))
    for k, nets in enumerate(((red, EXCITATION), (minus, EXCITATION), (foot, minus)), start=1):
        name = f"R{10 * c + k}"
        if used:
            yield two(name, "resistor", f"{arm:g} ohm", COMPLETION, nets, package, ohm=arm)
        elif k < 3:
            link = LINK if package == "0805" else WIRE_LINK
            yield two(name, "resistor", "0 ohm link", link, nets, package, ohm=1e-3)
        else:
            yield two(name, "resistor", "left off", COMPLETION, nets, package, False, ohm=1e12)
    linked = wires == 2 or not used
    yield two(
        f"R{10 * c + 4}", "resistor", "0 ohm", LINK, (red, plus), "0805", linked, ohm=1e-3 if linked else 1e12
    )


def _channel(design: Design, c: int, used: bool, wires: int) -> Iterator[Component]:
    switch, foot = SWITCHES[design.readout.switch], f"CH{c}_FOOT"
    yield from bridge_arms(design, c, used, wires, foot)
    on = {"gate": f"GATE{c}", "source": GROUND, "drain": foot}
    pins = tuple(Pin(switch.pins[role], role, net) for role, net in on.items())
    ohm = (("ohm", switch.on_ohm),)
    yield Component(f"Q{c}", "switch", switch.name, switch.mpn, pins, ohm, footprint="SOT-23", fitted=used)


def _amplifier(design: Design) -> Iterator[Component]:
    amplifier = AMPLIFIERS[design.readout.amplifier]
    resistance = gain_resistance(design)
    gain = set_gain(design)
    strapped = amplifier.gains and design.readout.gain == max(amplifier.gains)
    first = "GAIN" if resistance or strapped else ""
    second = "GAIN_B" if resistance else first
    nets = {
        "rg1": first,
        "minus": "IN_MINUS",
        "plus": "IN_PLUS",
        "negative": NEGATIVE,
        "ref": GROUND,
        "out": "OUT",
        "positive": POSITIVE,
        "rg2": second,
    }
    pins = tuple(Pin(amplifier.pins[role], role, net) for role, net in nets.items())
    figures = (
        ("gain", gain),
        ("noise", amplifier.noise_density(gain)),
        ("bandwidth", amplifier.bandwidth(gain)),
    )
    value = f"{amplifier.name}, gain {gain:.6g}"
    yield Component("U1", "amplifier", value, amplifier.mpn, pins, figures, footprint="SOIC-8")
    if resistance:
        yield two(
            "R1", "resistor", f"{resistance:g} ohm", GAIN_RESISTOR, (first, second), "0805", ohm=resistance
        )


def _multiplexer(part: Multiplexer) -> Component:
    """Enabled always: so the amplifier's inputs hang on the addressed bridge, which no open switch cuts off
    its supply, and never float."""
    nets = {
        "out_a": "SEL_PLUS",
        "out_b": "SEL_MINUS",
        "enable": POSITIVE,
        "positive": POSITIVE,
        "negative": NEGATIVE,
        "ground": GROUND,
    }
    pins = [Pin(part.pins[role], role, net) for role, net in nets.items()]
    pins += [Pin(number, f"A{i}", f"A{i}") for i, number in enumerate(part.address)]
    for c, (a, b) in enumerate(zip(part.inputs_a, part.inputs_b), start=1):
        pins += [Pin(a, f"S{c}A", f"CH{c}_PLUS"), Pin(b, f"S{c}B", f"CH{c}_MINUS")]
    package = "TSSOP-28" if part.channels == 8 else "TSSOP-16"
    return Component(
        "U2", "multiplexer", part.name, part.mpn, tuple(pins), (("ohm", part.on_ohm),), footprint=package
    )


def _decoder(part: Multiplexer) -> Component:
    count = len(part.address)
    pins = [
        Pin(number, f"A{i}", f"A{i}" if i < count else GROUND) for i, number in enumerate(DECODER_ADDRESS)
    ]
    pins += [Pin("4", "E1", GROUND), Pin("5", "E2", GROUND), Pin("6", "E3", "ENABLE")]
    for i, number in enumerate(DECODER_OUTPUTS):
        pins.append(Pin(number, f"Y{i}", f"GATE{i + 1}" if i < part.channels else ""))
    pins += [Pin("8", "ground", GROUND), Pin("16", "positive", LOGIC)]
    return Component("U3", "decoder", part.decoder, part.decoder, tuple(pins), footprint="SOIC-16")


def _regulator(
    name: str, kind: Kind, volts: float, out: str, enable: str, set_net: str, resistor: tuple[str, str, float]
) -> Iterator[Component]:
    """An LT3042 from VPOS, and the resistor that sets it: name, line of the bill, ohm."""
    nets, (own, part_no, ohm) = {EXCITATION: out, "SET": set_net}, resistor
    pins = tuple(
        Pin(number, role, enable if role == "enable" else nets.get(net, net))
        for role, number, net in REFERENCE_PINS
    )
    yield Component(name, kind, "LT3042", REFERENCE, pins, (("volts", volts),), footprint="MSOP-10-EP")
    yield two(own, "resistor", f"{ohm:g} ohm", part_no, (set_net, GROUND), "0805", ohm=ohm)


def _reference(design: Design) -> Iterator[Component]:
    resistor = ("R2", SET_RESISTOR, supply_resistance(design))
    return _regulator("U4", "regulator", design.readout.excitation, EXCITATION, POSITIVE, "SET", resistor)


def _digital_lines(names: Sequence[str]) -> Iterator[Component]:
    """A series and a pull-down resistor each."""
    for k, line in enumerate(names):
        yield two(f"R{5 + k}", "resistor", "1 kohm", SERIES, (line + OUTSIDE, line), "0805", ohm=1e3)
        yield two(f"R{91 + k}", "resistor", "100 kohm", PULL_DOWN, (line, GROUND), "0805", ohm=1e5)


def _capacitors(small: Sequence[str], large: Sequence[str]) -> Iterator[Component]:
    """To ground: 100 nF each, then 10 uF each, counted from C1 on."""
    for k, net in enumerate(small, start=1):
        yield two(f"C{k}", "capacitor", "100 nF", DECOUPLING, (net, GROUND), "0805", farad=1e-7)
    for k, net in enumerate(large, start=len(small) + 1):
        yield two(f"C{k}", "capacitor", "10 uF", RESERVOIR, (net, GROUND), "1206", farad=1e-5)


def _diodes(**nets: tuple[str, str]) -> Iterator[Component]:
    """Cathode, which is pin 1, and anode of each."""
    return (two(name, "diode", "1N5819HW", CLAMP, ends, "SOD-123") for name, ends in nets.items())


def _around(design: Design, part: Multiplexer) -> Iterator[Component]:
    """Filter, series and pull-down resistors, capacitors, diodes."""
    for name, end in (("R3", "PLUS"), ("R4", "MINUS")):
        nets = (f"SEL_{end}", f"IN_{end}")
        yield two(name, "resistor", f"{FILTER_OHM:g} ohm", FILTER_RESISTOR, nets, "0805", ohm=FILTER_OHM)
    yield from _digital_lines(lines(part))
    yield from _capacitors((POSITIVE, NEGATIVE, POSITIVE, NEGATIVE, LOGIC), (POSITIVE, EXCITATION))
    yield two("C8", "capacitor", "100 nF", DECOUPLING, ("SET", GROUND), "0805", farad=1e-7)
    yield two("C9", "capacitor", "100 pF", ANTI_ALIAS, ("IN_PLUS", "IN_MINUS"), "0805", farad=1e-10)
    yield from _diodes(D1=(POSITIVE, EXCITATION), D2=(GROUND, NEGATIVE), D3=(POSITIVE, GROUND))


def _connectors(part: Multiplexer) -> Iterator[Component]:
    card = [EXCITATION, GROUND, POSITIVE, NEGATIVE, LOGIC]
    card += [*(line + OUTSIDE for line in lines(part)), "OUT", GROUND]
    ends = [f"CH{c}_{end}" for c in range(1, part.channels + 1) for end in ("RED", "PLUS", "FOOT")]
    yield from headers(card, [(net, net) for net in ends])


def headers(card: list[str], ends: list[tuple[str, str]]) -> Iterator[Component]:
    """The connectors, to card or controller and to the leads, each a net and what its pin is called."""
    leads = [*ends, (GROUND, "SHIELD"), (GROUND, "ARRAY")]
    for name, part_no, nets in (("J1", TO_CARD, [(net, net) for net in card]), ("J2", TO_LEADS, leads)):
        pins = tuple(Pin(str(i), f"{i} {role}", net) for i, (net, role) in enumerate(nets, start=1))
        yield Component(
            name, "connector", f"{len(pins)} pins", part_no, pins, footprint=f"pin-header-{len(pins)}"
        )


SUPPLY = "V33"  # of the converter
LINES = ("ON", "SCLK", "DIN", "CS")
OUTPUT = "DOUT"


def digital_netlist(layout: Layout, converter: Converter, used: int) -> Netlist:
    """The board that reads `used` elements."""
    parts = [_converter(converter), *_supplies(layout), *_around_converter()]
    for channel in range(1, converter.inputs + 1):
        parts += _converter_channel(layout, channel, channel <= used)
    parts += _controller(converter)
    volts = bridge_supply(layout)
    rails = ((POSITIVE, layout.design.readout.supply_positive),)
    return Netlist(f"{layout.design.name}-board-{used}", volts, rails, tuple(parts))


def _converter(converter: Converter) -> Component:
    nets = {
        "IOVDD": SUPPLY,
        "AVDD": SUPPLY,
        "SYNC": SUPPLY,
        "DGND": GROUND,
        "AVSS": GROUND,
        "EP": GROUND,
        "REFIN1+": EXCITATION,
        "REFIN1-": GROUND,
        OUTPUT: OUTPUT,
        **{name: name for name in ("REGCAPD", "REGCAPA", *LINES[1:])},
    }
    for c in range(1, converter.inputs + 1):
        nets |= {f"AIN{2 * c - 2}": f"CH{c}_PLUS", f"AIN{2 * c - 1}": f"CH{c}_MINUS"}
    pins = tuple(Pin(number, role, nets.get(role, "")) for role, number in converter.pins.items())
    return Component("U1", "converter", converter.name, converter.mpn, pins, footprint=converter.package)


def _converter_channel(layout: Layout, c: int, used: bool) -> Iterator[Component]:
    yield from bridge_arms(layout.design, c, used, leads(layout), GROUND)
    nets = f"CH{c}_PLUS", f"CH{c}_MINUS"
    yield two(f"C{10 * c + 1}", "capacitor", "10 nF", ACROSS_BRIDGE, nets, "0805", used, farad=1e-8)


def _supplies(layout: Layout) -> Iterator[Component]:
    """Of the bridges, which ON switches, and of the converter."""
    bridges, own = ("R2", SET_RESISTOR, supply_ohm(layout)), ("R3", SUPPLY_RESISTOR, ANALOGUE_OHM)
    volts = [SET_AMPERE * ohm for *_, ohm in (bridges, own)]
    yield from _regulator("U4", "regulator", volts[0], EXCITATION, "ON", f"SET_{EXCITATION}", bridges)
    yield from _regulator("U5", "supply", volts[1], SUPPLY, POSITIVE, f"SET_{SUPPLY}", own)


def _around_converter() -> Iterator[Component]:
    yield from _digital_lines(LINES)
    small = (SUPPLY, SUPPLY, "REGCAPA", "REGCAPD", f"SET_{EXCITATION}", f"SET_{SUPPLY}")
    yield from _capacitors(small, (POSITIVE, EXCITATION, SUPPLY, POSITIVE))
    yield from _diodes(D1=(SUPPLY, EXCITATION), D3=(POSITIVE, GROUND))


def _controller(converter: Converter) -> Iterator[Component]:
    controller = [EXCITATION, GROUND, POSITIVE, *(line + OUTSIDE for line in LINES), OUTPUT, GROUND]
    ends = [
        (GROUND if end == "FOOT" else f"CH{c}_{end}", f"CH{c}_{end}")
        for c in range(1, converter.inputs + 1)
        for end in ("RED", "PLUS", "FOOT")
    ]
    yield from headers(controller, ends)
