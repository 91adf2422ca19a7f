"""The published array read by amplifier and card, and by converters: a table of docs/circuit.md.

    python benchmarks/read_outs.py docs/circuit.md    a second

Chips and parts are counted on the boards' netlists. Prices were not to be read (docs/circuit.md).
"""

from __future__ import annotations

from dataclasses import replace

from tables import lines, write_tables

from tactcad.circuit.bridges import netlist
from tactcad.circuit.digital_readout import digital_readout
from tactcad.circuit.element_signals import element_signals
from tactcad.design.load import read
from tactcad.design.tree import Design
from tactcad.parts.array.bridge_figures import drift, reading_scatter
from tactcad.parts.array.layout import Layout

CHIP = "AD7124-8"
READ_OUTS = (
    ("amplifier and card, 120 ohm", "card", "continuous", 120.0),
    (f"{CHIP}, 120 ohm", CHIP, "continuous", 120.0),
    (f"{CHIP}, 120 ohm, duty", CHIP, "duty", 120.0),
    (f"{CHIP}, 350 ohm", CHIP, "continuous", 350.0),
    (f"{CHIP}, 1000 ohm", CHIP, "continuous", 1000.0),
)
HEADS = (
    "macro-array | EXC, V | noise of a reading, uV at the bridge | drift, uV | smallest force, softest and "
    "stiffest, mN | chips, parts of both boards | parts a channel"
)


def read_by(design: Design, converter: str, power: str, ohm: float) -> Design:
    """The design read so."""
    own = replace(design.readout, converter=converter, power=power)
    return replace(design, gauge=replace(design.gauge, resistance=ohm), readout=own)


def row(said: str, design: Design) -> list[str]:
    layout = Layout(design)
    if design.readout.converter == "card":
        volts, gain = design.readout.excitation, design.readout.gain
        noise, moved = reading_scatter(layout) / gain, drift(layout) / gain
    else:
        found = digital_readout(layout, design.readout.converter)
        volts, noise, moved = found.excitation, found.noise, found.drift
    told = sorted(1e3 * signal.resolution for signal in element_signals(layout))
    fitted = [c for c in netlist(layout).components if c.footprint and c.fitted]
    chips = sum(c.designator.partition("-")[2].startswith("U") for c in fitted)
    return [
        said,
        f"{volts:g}",
        f"{1e6 * noise:#.2g}",
        f"{1e6 * moved:#.2g}",
        f"{told[0]:#.2g}, {told[-1]:#.2g}",
        f"{chips}, {len(fitted)}",
        f"{sum(c.element == 1 for c in fitted)}",
    ]


def read_outs() -> str:
    design = read("macro-array")
    return lines(HEADS, [row(said, read_by(design, *how)) for said, *how in READ_OUTS])


if __name__ == "__main__":
    raise SystemExit(write_tables(__doc__, {"read-outs": read_outs}))
