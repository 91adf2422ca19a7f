"""Bill-of-materials lines without a solid, and how many spares are ordered by the losses expected in
building; part numbers and values of the electronic parts.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import ceil, floor, log10

from tactcad.design.sensing import (
    AMPLIFIERS,
    COMPLETIONS,
    CONVERTERS,
    FOILS,
    MULTIPLEXERS,
    SWITCHES,
    Bought,
    Converter,
)
from tactcad.design.tree import Design

# The bill's column `process` for bought items, which decides the supplier.
ELECTRONIC = "electronic"
BARE_BOARD = "circuit board"
MECHANICAL = "bought"


@dataclass(frozen=True)
class Supply:
    """A bill-of-materials line without a solid. Quantities count the array once; spares come on top."""

    part_no: str
    description: str
    qty: float
    unit: str
    designation: str
    alternates: str = ""
    spares: float = 0
    consumable: bool = True
    manufacturer: str = ""
    mpn: str = ""
    verified: bool = False
    process: str = ELECTRONIC


LOST_IN = 10  # the paper: of ten elements one, no. 5, did not work


def spare_elements(count: int) -> int:
    """Spare elements of a kind of which the array has `count`: one of every ten, and one of every kind, since
    none can replace another arm."""
    return ceil(count / LOST_IN)


def bonded_spares(n: float) -> int:
    """Spares of n that are bonded or soldered to elements: one in five, at least one; chosen: the paper lost
    one of ten, and a second trial is likely."""
    return max(1, ceil(n / 5))


def board_spares(n: float) -> int:
    """Spares of n that are soldered on boards: one in ten, at least one; chosen: usual practice."""
    return max(1, ceil(n / 10))


GAUGE, COMPLETION, TERMINAL = "STRAIN-GAUGE", "BRIDGE-RESISTOR", "TERMINAL"
GAIN_RESISTOR = "GAIN-RESISTOR"
BOARD = "CIRCUIT-BOARD"
# At every supply pin of every circuit, and at the bridges' supply of every board; chosen: usual practice.
DECOUPLING, RESERVOIR = "CAPACITOR-100N", "CAPACITOR-10U"
TO_LEADS, TO_CARD = "HEADER-LEADS", "HEADER-CARD"
REFERENCE, SET_RESISTOR = "LT3042EMSE#PBF", "SET-RESISTOR"
# LT3042, front page of its sheet, rev. B (digikey.fr, datasheet 46159): input up to 20 V, 200 mA, 100 uA out
# of its SET pin within 1 %. Above 12 V its limit folds back, to 130 mA at least at 20 V: pages 22 and 4.
REFERENCE_MOST_VOLTS, REFERENCE_AMPERE, SET_AMPERE = 20.0, 0.2, 100e-6
FOLDS_FROM, FOLDED_AMPERE = 12.0, 0.13
DROPOUT = 0.5  # V; chosen: 0.35 at 200 mA is typical, front page
CLAMP, LINK, WIRE_LINK = "1N5819HW-7-F", "LINK-0R", "LINK-WIRE"
SERIES, PULL_DOWN = "RESISTOR-1K", "RESISTOR-100K"
SUPPLY_RESISTOR, ACROSS_BRIDGE = "SUPPLY-RESISTOR", "CAPACITOR-10N"  # of a converter's board
FILTER_RESISTOR, ANTI_ALIAS = "RESISTOR-10R", "CAPACITOR-100P"
# In each input of the amplifier; chosen: with 100 pF between them, 8 MHz; their noise is 0.2 %.
FILTER_OHM = 10.0
ON_SUPPLIES = 5  # of decoupling capacitors: two at the amplifier, two at the multiplexer, one at the decoder
CARD_SIGNALS = 8  # pins to the card besides the address: supplies, ground twice, enable, output
CONTROLLER_SIGNALS = 9  # pins to a controller: EXC, ground twice, supply, four lines and one back


def lead_part(colour: str) -> str:
    """Lead wire of a colour (code of IEC 60757)."""
    return f"LEAD-WIRE-{colour}"


def converter_of(design: Design) -> Converter | None:
    """The sigma-delta converter that reads the bridges; None if amplifier and card do."""
    return CONVERTERS.get(design.readout.converter)


def parts_used(design: Design) -> dict[str, Bought]:
    """The electronic parts whose figures decide rules and checks, by kind."""
    r, converter = design.readout, converter_of(design)
    both: dict[str, Bought] = {"completion": COMPLETIONS[r.completion], "foil": FOILS[design.gauge.foil]}
    if converter:
        return {"converter": converter, **both}
    card = {
        "amplifier": AMPLIFIERS[r.amplifier],
        "multiplexer": MULTIPLEXERS[r.multiplexer],
        "switch": SWITCHES[r.switch],
    }
    return {**card, **both}


def unread(design: Design, kinds: Iterable[str]) -> str:
    """The remark for findings based on these kinds of parts: those whose figures were not all read in the
    maker's own sheet; "" if all were."""
    used = parts_used(design)
    names = [used[kind].name for kind in kinds if kind in used and not used[kind].verified]
    return f"; unread: {', '.join(names)}" if names else ""


def completion_resistance(design: Design) -> float:
    """Resistance of each of a bridge's three other arms, ohm."""
    own = design.readout.completion_resistance
    return design.gauge.resistance if own is None else own


def bridge_resistance(design: Design) -> float:
    """Resistance of a bridge, ohm: gauge and one arm in series, parallel to the two other arms."""
    gauge, arm = design.gauge.resistance, completion_resistance(design)
    return 1 / (1 / (gauge + arm) + 1 / (2 * arm))


def regulator_gives(volts: float) -> float:
    """A that a regulator gives at so many volts at its input."""
    return REFERENCE_AMPERE if volts <= FOLDS_FROM else FOLDED_AMPERE


def completion_tolerance(design: Design) -> float:
    """Tolerance of each completing resistance, relative."""
    own = design.readout.completion_tolerance
    return COMPLETIONS[design.readout.completion].tolerance if own is None else own


def completion_drift(design: Design) -> float:
    """Temperature coefficient of a completing resistance, 1/K."""
    own = design.readout.completion_drift
    return COMPLETIONS[design.readout.completion].drift if own is None else own


def gain_resistance(design: Design) -> float | None:
    """Between the amplifier's RG pins, ohm, of the series E192; None if pins set the gain or none is
    needed."""
    amplifier, gain = AMPLIFIERS[design.readout.amplifier], design.readout.gain
    return None if amplifier.gains or gain == 1 else nearest_e192(amplifier.gain_ohm / (gain - 1))


def nearest_e192(ohm: float) -> float:
    """The value of the series E192 (IEC 60063) that is nearest by ratio."""
    decade = 10.0 ** floor(log10(ohm))
    series = [round(100 * 10 ** (i / 192)) for i in range(193)]
    series[185] = 920  # IEC 60063 has 920, the formula gives 919
    return min((decade * s / 100 for s in series), key=lambda r: abs(log10(r / ohm)))


def value_code(ohm: float) -> str:
    """A resistance as makers' numbers have it, its letter for the point: 499R, 27K1."""
    for letter, unit in (("M", 1e6), ("K", 1e3), ("R", 1.0)):
        if ohm >= unit:
            break
    whole, _, rest = f"{ohm / unit:.4g}".partition(".")
    return f"{whole}{letter}{rest}"


def supply_resistance(design: Design) -> float:
    """Resistor that sets the bridges' supply, ohm, of the series E192."""
    return nearest_e192(design.readout.excitation / SET_AMPERE)


def set_gain(design: Design) -> float:
    """The gain that the parts give: the design's, or by the resistor's standard value."""
    ohm = gain_resistance(design)
    return design.readout.gain if ohm is None else 1 + AMPLIFIERS[design.readout.amplifier].gain_ohm / ohm
