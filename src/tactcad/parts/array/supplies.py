"""Lines of the bill that are not modelled as a solid: gauges, adhesive and terminals; bridge completion,
leads, and the boards' parts; what the guides use up. They are rows of data/supplies.csv.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from math import ceil

from tactcad.design.materials import family
from tactcad.design.sensing import AMPLIFIERS, COMPLETIONS, MULTIPLEXERS, SWITCHES, WIRES
from tactcad.design.text_values import data_rows

from ..bought.electronic_parts import (
    ON_SUPPLIES,
    Supply,
    board_spares,
    bonded_spares,
    completion_drift,
    completion_resistance,
    completion_tolerance,
    converter_of,
    gain_resistance,
    lead_part,
    nearest_e192,
    supply_resistance,
    value_code,
)
from .board_plate import BOARD_OUTLINE, BRAID, bundle, card_pins, channels_of, lead_pins
from .converter_figures import ANALOGUE_OHM, bridge_supply, supply_ohm
from .layout import Layout
from .leads import boards, colours, lead_routes, leads

COLOUR_NAMES = {"RD": "red", "WH": "white", "BK": "black"}
ROWS = data_rows(__file__, "supplies")
# Spares of so many.
SPARES: dict[str, Callable[[float], int]] = {"": lambda _: 0, "bonded": bonded_spares, "board": board_spares}


def supplies(group: str, counts: Mapping[str, float], **figures: object) -> Iterator[Supply]:
    """The rows of a group: quantities from `counts`, by the unit counted, and texts with these figures."""
    for row in (row for row in ROWS if row["group"] == group):
        said = {name: text.format(**figures) for name, text in row.items()}
        qty = counts[said["qty"]] if said["qty"] in counts else int(said["qty"])
        same = "part_no description unit designation alternates manufacturer mpn process".split()
        yield Supply(
            **{name: said[name] for name in same},
            qty=qty,
            spares=SPARES[said["spares"]](qty),
            consumable=said["consumable"] == "true",
            verified=said["verified"] == "True",
        )


def array_supplies(layout: Layout) -> tuple[Supply, ...]:
    """Gauge and bonding supplies of the array, none verified in a maker's own data."""
    g, material, bonding = layout.design.gauge, layout.design.material, layout.design.bonding
    metal = family(material.density) or material.alloy
    if metal == "steel":  # of 11 or 16e-6/K, as its grade is
        metal += f" {material.alloy}"
    longest = f", at most {bonding.terminal_length:g} mm long" if bonding else ""
    carrier = g.carrier_arm_side + g.carrier_body_side
    counts = {"elements": len(layout.elements)}
    return tuple(supplies("array", counts, g=g, metal=metal, carrier=carrier, longest=longest))


def electronic_supplies(layout: Layout) -> tuple[Supply, ...]:
    """Supplies for the three other arms of every bridge, the leads, the boards and their components."""
    d, r = layout.design, layout.design.readout
    n, count = len(layout.elements), len(boards(layout))
    kind, tolerance, drift = COMPLETIONS[r.completion], completion_tolerance(d), completion_drift(d)
    arm, scheme = completion_resistance(d), "{code}" in kind.mpn
    own = tolerance == kind.tolerance and drift == kind.drift and (not scheme or arm == nearest_e192(arm))
    mpn = kind.mpn.format(code=value_code(arm))
    completion = supplies(
        "completion",
        {"arms": 3 * n},
        kind=kind,
        order=replace(kind, mpn=mpn) if own else replace(kind, maker="", mpn="", verified=False),
        ohm=arm,
        percent=100 * tolerance,
        ppm=1e6 * drift,
        end=f" ({mpn}); or equal" if own and not scheme else "; any maker's",
    )
    part, outline, converter = MULTIPLEXERS[r.multiplexer], BOARD_OUTLINE, converter_of(d)
    free, small = channels_of(layout) * count - n, kind.package == "0805"
    links = 3 * free if small else free
    if leads(layout) == 2:
        links += n
    ohm = supply_ohm(layout) if converter else supply_resistance(d)
    on_card, on_converter = (0, count) if converter else (count, 0)
    on_boards = supplies(
        "boards",
        {
            "switches": 0 if converter else n,
            "filters": n if converter else 0,
            "boards": count,
            "card boards": on_card,
            "converters": on_converter,
            "supply pins": (ON_SUPPLIES + 1) * count,
            "reservoirs": 2 * on_card + 4 * on_converter,
            "regulators": on_card + 2 * on_converter,
            "card pairs": 2 * on_card,
            "diodes": 3 * on_card + 2 * on_converter,
            "lines": 4 * on_converter + (len(part.address) + 1) * on_card,
            "links": links,
            "wire links": 0 if small else 2 * free,
        },
        name=d.name,
        switch=SWITCHES[r.switch],
        amplifier=AMPLIFIERS[r.amplifier],
        multiplexer=part,
        converter_mpn=converter.mpn if converter else "",
        supply_ohm=ANALOGUE_OHM,
        supply_code=value_code(ANALOGUE_OHM),
        supplied="both supplies" if converter else "the bridges' supply",
        terminals="the controller" if converter else "the card's terminals",
        reader="the controller" if converter else "the converter's card",
        volts=bridge_supply(layout) if converter else r.excitation,
        ohm=ohm,
        code=value_code(ohm),
        to_leads=lead_pins(layout),
        to_card=card_pins(layout),
        length=outline.width,
        width=outline.height,
    )
    fitted = (line for line in on_boards if line.qty)
    gain = None if converter else gain_resistance(d)
    set_by = () if gain is None else supplies("gain", {"boards": count}, ohm=gain, code=value_code(gain))
    return (*completion, *lead_supplies(layout), *fitted, *set_by)


def wiring_supplies(layout: Layout) -> tuple[Supply, ...]:
    """Supplies of the wiring besides the leads: braid and wire as long as each board's."""
    d, count = layout.design, len(boards(layout))
    metres = ceil(10 * count * max(route.cut for route in lead_routes(layout)) * 1e-3) / 10
    outer = bundle(d, channels_of(layout) * leads(layout))
    counts = {"boards": count, "braid": metres, "array wire": metres}
    sizes = {"bore": ceil(outer - 2 * BRAID), "tube": ceil(1.5 * outer)}
    return tuple(supplies("wiring", counts, **sizes))


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
