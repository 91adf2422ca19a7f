"""The board of a sigma-delta converter: bridges between EXC and ground, their outputs on the converter.

    VPOS --[U4]-- EXC --+---------+--- REFIN1+      Designators: of channel c R(10 c + 1) to R(10 c + 4) and
      |              Rc1|      Rc2|                 C(10 c + 1); U1 converter, U4 the bridges' supply, U5 the
      | J2 RED  o---+---+         |                 converter's, J1 to the controller, J2 to the leads.
      |          Rc4 [0 ohm]      +--- AIN(2c-1)
      | J2 PLUS o---+----[Cc1]----|--- AIN(2c-2)
      |                        Rc3|
      | J2 FOOT o-------------+---+
      |                      GND ----- REFIN1-
      '--[U5]-- V33 --- AVDD, IOVDD

Bare boards are equal. A channel that reads no element has links for Rc1 and Rc2, and neither Rc3 nor Cc1. D1
keeps EXC below V33, which the converter's inputs may not exceed, in any order of power-up; D3 protects
against a reversed VPOS. ON high switches U4 on: by the controller, or by a jumper to VPOS next to it. R5 to
R8 limit the current from the controller into an unpowered converter, R91 to R94 keep its lines low while the
cable is off.
"""

from __future__ import annotations

from collections.abc import Iterator

from tactcad.design.sensing import Converter
from tactcad.parts.array.converter_figures import ANALOGUE_OHM, bridge_supply, supply_ohm
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.leads import leads
from tactcad.parts.bought.electronic_parts import (
    ACROSS_BRIDGE,
    CLAMP,
    DECOUPLING,
    PULL_DOWN,
    REFERENCE,
    RESERVOIR,
    SERIES,
    SET_AMPERE,
    SET_RESISTOR,
    SUPPLY_RESISTOR,
)

from .netlist import GROUND, Component, Kind, Netlist, Pin
from .read_board import EXCITATION, OUTSIDE, POSITIVE, REFERENCE_PINS, bridge_arms, headers, two

SUPPLY = "V33"  # of the converter
LINES = ("ON", "SCLK", "DIN", "CS")
OUTPUT = "DOUT"


def digital_netlist(layout: Layout, converter: Converter, used: int) -> Netlist:
    """The board that reads `used` elements."""
    parts = [_converter(converter), *_supplies(layout), *_around()]
    for channel in range(1, converter.inputs + 1):
        parts += _channel(layout, channel, channel <= used)
    parts += _connectors(converter)
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


def _channel(layout: Layout, c: int, used: bool) -> Iterator[Component]:
    yield from bridge_arms(layout.design, c, used, leads(layout), GROUND)
    nets = f"CH{c}_PLUS", f"CH{c}_MINUS"
    yield two(f"C{10 * c + 1}", "capacitor", "10 nF", ACROSS_BRIDGE, nets, "0805", used, farad=1e-8)


def _supplies(layout: Layout) -> Iterator[Component]:
    """Two LT3042 from VPOS."""
    kinds: tuple[Kind, Kind] = ("regulator", "supply")
    for kind, name, out, ohm, part_no, resistor in (
        (kinds[0], "U4", EXCITATION, supply_ohm(layout), SET_RESISTOR, "R2"),
        (kinds[1], "U5", SUPPLY, ANALOGUE_OHM, SUPPLY_RESISTOR, "R3"),
    ):
        set_net = f"SET_{out}"
        nets = {EXCITATION: out, "SET": set_net}
        pins = tuple(
            Pin(number, role, "ON" if (role, out) == ("enable", EXCITATION) else nets.get(net, net))
            for role, number, net in REFERENCE_PINS
        )
        figures = (("volts", SET_AMPERE * ohm),)
        yield Component(name, kind, "LT3042", REFERENCE, pins, figures, footprint="MSOP-10-EP")
        yield two(resistor, "resistor", f"{ohm:g} ohm", part_no, (set_net, GROUND), "0805", ohm=ohm)


def _around() -> Iterator[Component]:
    for k, line in enumerate(LINES):
        yield two(f"R{5 + k}", "resistor", "1 kohm", SERIES, (line + OUTSIDE, line), "0805", ohm=1e3)
        yield two(f"R{91 + k}", "resistor", "100 kohm", PULL_DOWN, (line, GROUND), "0805", ohm=1e5)
    small = (SUPPLY, SUPPLY, "REGCAPA", "REGCAPD", f"SET_{EXCITATION}", f"SET_{SUPPLY}")
    for k, net in enumerate(small, start=1):
        yield two(f"C{k}", "capacitor", "100 nF", DECOUPLING, (net, GROUND), "0805", farad=1e-7)
    for k, net in enumerate((POSITIVE, EXCITATION, SUPPLY, POSITIVE), start=7):
        yield two(f"C{k}", "capacitor", "10 uF", RESERVOIR, (net, GROUND), "1206", farad=1e-5)
    # pin 1 is the cathode
    for name, nets in (("D1", (SUPPLY, EXCITATION)), ("D3", (POSITIVE, GROUND))):
        yield two(name, "diode", "1N5819HW", CLAMP, nets, "SOD-123")


def _connectors(converter: Converter) -> Iterator[Component]:
    controller = [EXCITATION, GROUND, POSITIVE, *(line + OUTSIDE for line in LINES), OUTPUT, GROUND]
    ends = [
        (GROUND if end == "FOOT" else f"CH{c}_{end}", f"CH{c}_{end}")
        for c in range(1, converter.inputs + 1)
        for end in ("RED", "PLUS", "FOOT")
    ]
    yield from headers(controller, ends)
