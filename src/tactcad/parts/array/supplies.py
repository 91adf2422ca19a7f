"""Lines of the bill that are not modelled as a solid: gauges, adhesive and terminals; bridge completion,
leads, and the boards' parts.

A designation says all that a part is ordered by; where it names a maker's number, an equal part will do.
"""

from __future__ import annotations

from dataclasses import dataclass

from tactcad.design.materials import family
from tactcad.design.sensing import AMPLIFIERS, COMPLETIONS, MULTIPLEXERS, SWITCHES, WIRES, Bought

from ..bought.electronic_parts import (
    BOARD,
    CARD_CABLE,
    COMPLETION,
    DECOUPLING,
    GAIN_RESISTOR,
    GAUGE,
    ON_SUPPLIES,
    RESERVOIR,
    STANDOFFS,
    TERMINAL,
    TO_CARD,
    TO_LEADS,
    completion_drift,
    completion_resistance,
    completion_tolerance,
    gain_resistance,
    lead_part,
)
from ..bought.supply import Supply, board_spares, bonded_spares
from .layout import Layout
from .leads import board_size, boards, colours, header_pins, lead_routes, leads


def array_supplies(layout: Layout) -> tuple[Supply, ...]:
    """Gauge and bonding supplies of the array, none of them verified in a maker's own data."""
    g, material = layout.design.gauge, layout.design.material
    n = len(layout.elements)
    bonding = layout.design.bonding
    longest = f", at most {bonding.terminal_length:g} mm long" if bonding else ""
    spare_gauges = bonded_spares(n)
    ohm, metal = f"{g.resistance:g} ohm", family(material.density) or material.alloy
    return (
        Supply(
            GAUGE,
            f"foil strain gauge, {ohm}, grid {g.grid_length:g} x {g.grid_width:g} mm, for {metal}",
            n,
            "pcs",
            f"foil strain gauge {ohm}, grid {g.grid_length:g} x "
            f"{g.grid_width:g} mm, self-compensated for {metal}, tabs at one end; carrier trimmed to "
            f"{g.carrier_arm_side + g.carrier_body_side:g} x {g.carrier_width:g} mm; any maker's",
            alternates="any foil gauge of that grid and resistance",
            spares=spare_gauges,
            consumable=False,
        ),
        Supply(
            TERMINAL,
            "solder terminal pair, self-adhesive",
            n,
            "pcs",
            f"solder terminal for strain gauges, two pads{longest}; any maker's",
            spares=spare_gauges,
        ),
        Supply("ADHESIVE", "strain gauge adhesive, cold curing", 1, "pack", "cyanoacrylate gauge adhesive"),
        Supply(
            "COATING",
            "protective coating over gauge and terminals",
            1,
            "pack",
            "polyurethane or silicone gauge coating",
        ),
    )


def bonding_supplies() -> tuple[Supply, ...]:
    """What the bonding fixture's guide uses up beside the array's gauges, adhesive, terminals and coating."""
    return (
        Supply(
            "SURFACE-PREPARATION",
            "solvent, acid conditioner and neutraliser for the elements' metal, lint-free swabs",
            1,
            "set",
            "surface preparation set for strain gauges",
        ),
        Supply(
            "ABRASIVE",
            "silicon carbide paper, strips of 3 mm on a flat stick",
            1,
            "sheet",
            "silicon carbide paper P400, wet and dry",
        ),
        Supply("GAUGE-TAPE", "clear tape that leaves no residue", 1, "roll", "strain gauge mounting tape"),
        Supply(
            "RELEASE-FILM", "film between gauge and rubber", 1, "sheet", "PTFE film 0.05 mm, or polyethylene"
        ),
    )


COLOUR_NAMES = {"RD": "red", "WH": "white", "BK": "black"}


@dataclass(frozen=True)
class _Order:
    """Who makes a part under which number; `verified`: read in the maker's own sheet."""

    maker: str = ""
    mpn: str = ""
    verified: bool = False


def electronic_supplies(layout: Layout) -> tuple[Supply, ...]:
    """All of them."""
    return (completion_supply(layout), *lead_supplies(layout), *board_supplies(layout))


def wire_metres(layout: Layout) -> float:
    """Lead wire of one colour, m, each lead as cut."""
    return round(sum(route.cut for route in lead_routes(layout)) * 1e-3, 6)


def lead_supplies(layout: Layout) -> tuple[Supply, ...]:
    """Lead wire, a line a colour, each lead as cut; spares by the rule for the gauges that they are for."""
    n, wire, metres = len(layout.elements), WIRES[layout.design.wiring.wire], wire_metres(layout)
    return tuple(
        Supply(
            lead_part(colour),
            f"lead wire, {COLOUR_NAMES[colour]}, one lead a gauge",
            metres,
            "m",
            f"{wire.name} stranded, {COLOUR_NAMES[colour]}, polyimide or PTFE insulated, "
            f"{wire.outer:g} mm over insulation",
            spares=round(metres * bonded_spares(n) / n, 2),
        )
        for colour in colours(layout)
    )


def board_supplies(layout: Layout) -> tuple[Supply, ...]:
    """The boards, and what stands on them."""
    d, r = layout.design, layout.design.readout
    n, count = len(layout.elements), len(boards(layout))
    amplifier, switch, multiplexer = AMPLIFIERS[r.amplifier], SWITCHES[r.switch], MULTIPLEXERS[r.multiplexer]
    to_leads, to_card = header_pins(d)
    length, width = board_size(d)
    ohm = gain_resistance(d)
    lines = [
        _part(
            switch.mpn,
            "MOSFET in a bridge's return",
            n,
            f"N-channel MOSFET {switch.mpn}, SOT-23, at most {switch.on_ohm:g} ohm at a gate of 4.5 V, "
            f"{switch.most_volts:g} V",
            _by(switch),
        ),
        _part(
            amplifier.mpn,
            "instrumentation amplifier",
            count,
            f"instrumentation amplifier {amplifier.mpn}, SOIC-8",
            _by(amplifier),
        ),
        _part(
            multiplexer.mpn,
            f"differential multiplexer, {multiplexer.channels} channels",
            count,
            f"differential analogue multiplexer {multiplexer.mpn}",
            _by(multiplexer),
        ),
        _part(
            multiplexer.decoder,
            "decoder, 3 to 8 lines, 5 V",
            count,
            "74HC238 decoder, outputs active high, SO16 (74HC238D); any maker's 74HC238",
            _Order("Nexperia", "74HC238D"),
        ),
        _part(
            DECOUPLING,
            "decoupling capacitor",
            (ON_SUPPLIES + 1) * count,
            "ceramic capacitor 100 nF, 10 %, X7R, 50 V, 0805; or equal",
            _Order("KEMET", "C0805C104K5RAC"),
        ),
        _part(
            RESERVOIR,
            "capacitor at the bridges' supply",
            count,
            "ceramic capacitor 10 uF, 10 %, X7R, 25 V, 1206; any maker's",
        ),
        _part(TO_LEADS, f"pin header for leads, {leads(layout)} pins a gauge", count, _header(to_leads)),
        _part(TO_CARD, "pin header to the converter's card", count, _header(to_card)),
        _part(
            CARD_CABLE,
            "cable from a board to the converter's card",
            count,
            f"cable, {to_card} wires AWG 26, 0.5 m: crimp socket 2.54 mm, {to_card} pins in one row, at one "
            "end, the other end free for the card's terminals",
        ),
        _part(
            BOARD,
            "circuit board, bare; laid out by who makes it",
            count,
            f"circuit board to the netlist {d.name}-circuit, all boards alike, with every channel of the "
            f"multiplexer: FR-4 1.6 mm, 2 layers, copper 35 um, tin or gold on pads, at least {length:g} x "
            f"{width:g} mm, a hole of 3.2 mm in each corner",
        ),
        _part(
            STANDOFFS,
            "standoffs under a board",
            count,
            "set of 4 standoffs M3 x 10, threaded at both ends, with 8 screws M3 x 6",
        ),
    ]
    if ohm is not None:
        lines.append(
            _part(
                GAIN_RESISTOR,
                "resistor that sets the gain",
                count,
                f"thin film resistor {ohm:g} ohm (E192), 0.1 %, 10 ppm/K, 0.1 W, 0805; any maker's",
            )
        )
    return tuple(lines)


def _by(part: Bought) -> _Order:
    return _Order(part.maker, part.mpn, part.verified)


def _header(pins: int) -> str:
    return f"pin header 2.54 mm, {pins} pins in one row, straight, through hole; any maker's"


def _part(number: str, what: str, qty: int, designation: str, order: _Order = _Order()) -> Supply:
    return Supply(
        number,
        what,
        qty,
        "pcs",
        designation,
        spares=board_spares(qty),
        consumable=False,
        manufacturer=order.maker,
        mpn=order.mpn,
        verified=order.verified,
    )


def completion_supply(layout: Layout) -> Supply:
    """The three other arms of every bridge."""
    d, n = layout.design, 3 * len(layout.elements)
    row, ohm = COMPLETIONS[d.readout.completion], completion_resistance(d)
    tolerance, drift = completion_tolerance(d), completion_drift(d)
    own = tolerance == row.tolerance and drift == row.drift
    return _part(
        COMPLETION,
        "resistor that completes a bridge, three a gauge",
        n,
        f"{row.description} {ohm:g} ohm, {100 * tolerance:g} %, {1e6 * drift:g} ppm/K, {row.watts:g} W, "
        f"{row.package}" + (f" ({row.mpn}); or equal" if row.mpn and own else "; any maker's"),
        _by(row) if own else _Order(),
    )
