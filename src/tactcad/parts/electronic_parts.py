"""Part numbers and values of the electronic parts, and how many the array needs."""

from __future__ import annotations

from math import floor, log10

from tactcad.design.electronics import AMPLIFIERS, COMPLETIONS, MULTIPLEXERS, SWITCHES
from tactcad.design.tree import Design

from .boards import boards
from .layout import Layout
from .lead_route import lead_routes, leads
from .spares import board_spares, bonded_spares
from .supply import Supply

GAUGE, COMPLETION, TERMINAL, LEAD = "STRAIN-GAUGE", "BRIDGE-RESISTOR", "TERMINAL", "LEAD-WIRE"
GAIN_RESISTOR = "GAIN-RESISTOR"
# At every supply pin of every circuit, and at the bridges' supply of every board; chosen: usual practice.
DECOUPLING, RESERVOIR = "CAPACITOR-100N", "CAPACITOR-10U"
TO_LEADS, TO_CARD = "HEADER-LEADS", "HEADER-CARD"
ON_SUPPLIES = 5  # of decoupling capacitors: two at the amplifier, two at the multiplexer, one at the decoder
CARD_SIGNALS = 8  # of the connector to the card beside the address: supplies, ground twice, enable, output


def completion_resistance(design: Design) -> float:
    """Of each of a bridge's three other arms, ohm."""
    own = design.readout.completion_resistance
    return design.gauge.resistance if own is None else own


def gain_resistance(design: Design) -> float | None:
    """Between the amplifier's RG pins, ohm, of the series E192; None where pins set the gain or none is
    needed."""
    amplifier, gain = AMPLIFIERS[design.readout.amplifier], design.readout.gain
    return None if amplifier.gains or gain == 1 else nearest_e192(amplifier.gain_ohm / (gain - 1))


def nearest_e192(ohm: float) -> float:
    """The value of the series E192 (IEC 60063) that is nearest by ratio."""
    decade = 10.0 ** floor(log10(ohm))
    series = [round(100 * 10 ** (i / 192)) for i in range(193)]
    series[185] = 920  # IEC 60063 has 920 where the formula gives 919
    return min((decade * s / 100 for s in series), key=lambda r: abs(log10(r / ohm)))


def set_gain(design: Design) -> float:
    """The gain that the parts give: the design's, or by the resistor's standard value."""
    ohm = gain_resistance(design)
    return design.readout.gain if ohm is None else 1 + AMPLIFIERS[design.readout.amplifier].gain_ohm / ohm


def wire_metres(layout: Layout) -> float:
    """Lead wire in all, m, each lead as cut."""
    return round(sum(route.cut for route in lead_routes(layout)) * leads(layout) * 1e-3, 6)


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
