"""Lines of the bill for what the array is read with: bridge completion, leads, and the boards' parts."""

from __future__ import annotations

from tactcad.design.electronics import AMPLIFIERS, COMPLETIONS, MULTIPLEXERS, SWITCHES, WIRES

from .boards import boards
from .electronic_parts import (
    CARD_SIGNALS,
    COMPLETION,
    DECOUPLING,
    GAIN_RESISTOR,
    LEAD,
    ON_SUPPLIES,
    RESERVOIR,
    TO_CARD,
    TO_LEADS,
    completion_resistance,
    gain_resistance,
)
from .layout import Layout
from .lead_route import lead_routes, leads
from .spares import board_spares, bonded_spares
from .supply import Supply


def electronic_supplies(layout: Layout) -> tuple[Supply, ...]:
    """All of them."""
    return (completion_supply(layout), lead_supply(layout), *board_supplies(layout))


def wire_metres(layout: Layout) -> float:
    """Lead wire in all, m, each lead as cut."""
    return round(sum(route.cut for route in lead_routes(layout)) * leads(layout) * 1e-3, 6)


def lead_supply(layout: Layout) -> Supply:
    """Lead wire, each lead as cut."""
    n, wire, metres = len(layout.elements), WIRES[layout.design.wiring.wire], wire_metres(layout)
    return Supply(
        LEAD,
        f"lead wire, {leads(layout)} per gauge, in their colours",
        metres,
        "m",
        f"{wire.name} stranded, polyimide or PTFE insulated, {wire.outer:g} mm over insulation",
        spares=round(metres * bonded_spares(n) / n, 1),
    )


def board_supplies(layout: Layout) -> tuple[Supply, ...]:
    """What stands on the boards, bought."""
    d, r = layout.design, layout.design.readout
    n, made = len(layout.elements), boards(layout)
    amplifier, switch, multiplexer = AMPLIFIERS[r.amplifier], SWITCHES[r.switch], MULTIPLEXERS[r.multiplexer]
    per_gauge, ohm = leads(layout), gain_resistance(d)
    lines = [
        _part(switch.mpn, "MOSFET in a bridge's return", n, switch.maker, switch.mpn),
        _part(amplifier.mpn, "instrumentation amplifier", len(made), amplifier.maker, amplifier.mpn),
        _part(
            multiplexer.mpn,
            f"differential multiplexer, {multiplexer.channels} channels",
            len(made),
            multiplexer.maker,
            multiplexer.mpn,
        ),
        _part(multiplexer.decoder, "decoder, 3 to 8 lines, 5 V", len(made), designation=multiplexer.decoder),
        _part(
            DECOUPLING,
            "decoupling capacitor",
            (ON_SUPPLIES + 1) * len(made),
            designation="ceramic capacitor 100 nF X7R 50 V, 0805",
        ),
        _part(
            RESERVOIR,
            "capacitor at the bridges' supply",
            len(made),
            designation="ceramic capacitor 10 uF X7R 25 V, 1206",
        ),
        _part(
            TO_LEADS,
            f"pin header for leads, {per_gauge} pins a gauge",
            len(made),
            designation=f"pin header, {per_gauge * multiplexer.channels} pins, 2.54 mm",
        ),
        _part(
            TO_CARD,
            "pin header to the converter's card",
            len(made),
            designation=f"pin header, {CARD_SIGNALS + len(multiplexer.address)} pins, 2.54 mm",
        ),
    ]
    if ohm is not None:
        lines.append(
            _part(
                GAIN_RESISTOR,
                "resistor that sets the gain",
                len(made),
                designation=f"thin film resistor {ohm:g} ohm (E192), 0.1 %, 10 ppm/K",
            )
        )
    return tuple(lines)


def _part(
    number: str, what: str, qty: int, maker: str = "", mpn: str = "", designation: str = "", ok: bool = False
) -> Supply:
    return Supply(
        number,
        what,
        qty,
        "pcs",
        designation,
        spares=board_spares(qty),
        consumable=False,
        manufacturer=maker,
        mpn=mpn,
        verified=ok,
    )


def completion_supply(layout: Layout) -> Supply:
    """The three other arms of every bridge."""
    d, n = layout.design, len(layout.elements)
    row, ohm = COMPLETIONS[d.readout.completion], completion_resistance(d)
    gauges = d.readout.completion == "reference-gauge"
    return Supply(
        COMPLETION,
        f"bridge completion, {ohm:g} ohm, {row.description}",
        3 * n,
        "pcs",
        f"strain gauge {ohm:g} ohm, as STRAIN-GAUGE" if gauges else f"{row.description}, {ohm:g} ohm",
        alternates="" if gauges else "reference gauge on the same alloy",
        spares=3 * bonded_spares(n),
        consumable=False,
        manufacturer=row.maker,
        mpn=row.mpn,
        verified=row.verified,
    )
