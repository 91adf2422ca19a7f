"""The array read by sigma-delta converters, one a board: no amplifier, no multiplexer of ours, no card.

EXC --+-----------+--- REFIN+     The bridges are in parallel: EXC is what the grids' backing bears
      |           |               (converter_figures.py), all the time or once a period. It is the
  bridge n    converter           converter's reference too, so its drift cancels. The converter takes
      | AIN 2n, 2n+1              one input after the other; its filter of third order needs three
GND --+-----------+--- REFIN-     periods of its rate after each change.
"""

from __future__ import annotations

import json
from dataclasses import dataclass

import numpy as np

from tactcad.design.sensing import CONVERTERS, Converter
from tactcad.mechanics import gauge_signal
from tactcad.mechanics.readout import transmission
from tactcad.parts.array.bridge_figures import COPPER, zero_drift
from tactcad.parts.array.converter_figures import (
    bridge_supply,
    converter_noise,
    converter_supply,
    on_time,
    rate,
    settling,
    warm_up,
)
from tactcad.parts.array.hinge_section import design_gauge, hinge_section
from tactcad.parts.array.layout import ElementPlace, Layout
from tactcad.parts.array.leads import boards, leads, longest_lead_resistance
from tactcad.parts.array.stop_gap import overloads
from tactcad.parts.bought.electronic_parts import (
    completion_drift,
    completion_resistance,
    completion_tolerance,
)

from .read_board import digital_netlist


@dataclass(frozen=True)
class DigitalReadout:
    """Figures of the array read so.

    excitation  V, all the time or for `on` in each period
    gain, rate  of the converter's input; Hz
    settling    s, from one input to the next
    warm_up, on s, from ON to the first input's turn, and to the last result; 0 if always on
    noise       V rms of one result, at the bridge
    drift       V, half-width, at the bridge, between zero and reading
    per_strain  V at the bridge for a strain of 1
    per_force   V/N at the bridge, by element
    resolution  N, by element, as that of the other read-out
    largest     V at each bridge under overload, tolerances at their worst
    chips       each with its elements, in the order of its inputs
    """

    converter: Converter
    excitation: float
    gain: float
    rate: float
    settling: float
    warm_up: float
    on: float
    noise: float
    drift: float
    per_strain: float
    per_force: np.ndarray
    resolution: np.ndarray
    largest: tuple[float, ...]
    chips: tuple[tuple[ElementPlace, ...], ...]


def digital_readout(layout: Layout, name: str) -> DigitalReadout:
    """The design read by the converter of that name. Raises CheckFailure out of the estimator's range."""
    d, part, gauge = layout.design, CONVERTERS[name], design_gauge(layout.design)
    volts, span = bridge_supply(layout), d.readout.temperature_span
    lead, three = longest_lead_resistance(layout), leads(layout) == 3
    left = transmission(d.gauge.resistance, completion_resistance(d), lead, 0.0, three)
    per_strain = volts * left * gauge.factor / 4
    section, shape = hinge_section(layout, layout.elements), (len(layout.elements),)
    per_force = per_strain * np.broadcast_to(gauge_signal.foil_strain_per_force(section, gauge), shape)
    bent = np.broadcast_to(gauge_signal.foil_strain_per_deflection(section, gauge), shape)
    overload = [float(b) * state.deflection for b, state in zip(bent, overloads(layout), strict=True)]
    two_leads = 0.0 if three else 2 * lead / d.gauge.resistance
    off = d.gauge.resistance_tolerance + 3 * completion_tolerance(d) + abs(d.readout.bridge_offset)
    unloaded = volts * (off + two_leads) / 4
    largest = tuple(unloaded + abs(per_strain) * strain for strain in overload)
    gain = max((g for g in part.gains if volts / g >= max(largest)), default=min(part.gains))
    noise = converter_noise(layout, part, gain)
    drift = (
        (per_strain * d.gauge.thermal_output * span) ** 2
        + (volts / 4 * 3**0.5 * completion_drift(d) * span) ** 2
        + (part.drift * span) ** 2
        + (volts / 4 * (zero_drift(layout) + two_leads * COPPER * span)) ** 2
    ) ** 0.5
    chips = tuple(board.places for board in boards(layout))
    resolution = np.hypot(2 * noise, drift) / np.abs(per_force)
    times = (warm_up(layout), on_time(layout)) if d.readout.power == "duty" else (0.0, 0.0)
    return DigitalReadout(
        part, volts, gain, rate(layout), settling(layout), *times,
        noise, drift, per_strain, per_force, resolution, largest, chips,
    )  # fmt: skip


@dataclass(frozen=True)
class Register:
    """A register's address, bytes and value, and the source of each of its bits."""

    name: str
    address: int
    size: int
    value: int
    why: str


LINUX = "Linux, drivers/iio/adc/ad7124.c"
MODES = "Linux, include/linux/iio/adc/ad_sigma_delta.h"
HEADER = "the maker's ad7124.h"
DRIVER = "the maker's ad7124.c"
# V that a reference input with its buffer on must stay within the supplies: from memory of the sheet, unread.
BUFFER_ROOM = 0.1
RESULT = (
    "4 bytes: 3 of data, then STATUS, its low four bits the channel "
    f"({DRIVER}: with DATA_STATUS set, need to read 4, not 3 bytes; {HEADER}: CH_ACTIVE(x) is x & 0xF)"
)


def registers(found: DigitalReadout, chip: int) -> list[Register]:
    """Settings of one AD7124-8 in their order; for each value the source of its bits, or `unread`."""
    clock, places = found.converter.clock, found.chips[chip]
    fs = round(clock / (32 * found.rate))
    pga = found.converter.gains.index(found.gain)
    mode, said = (1, "; unread: it takes each channel once") if found.on else (0, "")
    control = Register(
        "ADC_CONTROL",
        0x01,
        2,
        1 << 10 | 2 << 6 | mode << 2,
        f"{LINUX}: status after data bit 10; power mode in bits 7 to 6, full power is 2; mode in bits "
        f"5 to 2; {MODES}: 0 is continuous, 1 single{said}",
    )
    # supplies at their worst, 1 %; REFIN1- lies at AVSS
    above = 1.01 * found.excitation + BUFFER_ROOM < 0.99 * converter_supply()
    config = Register(
        "CONFIG_0",
        0x19,
        2,
        1 << 11 | above << 8 | 0 << 7 | 3 << 5 | 0 << 3 | pga,
        f"{LINUX}: bipolar bit 11, input buffers bits 6 to 5, reference bits 4 to 3 (0: REFIN1), "
        "gain 2^n in bits 2 to 0; "
        f"{HEADER}: reference buffers bits 8 (positive) and 7 (negative); unread: a buffered input must stay "
        f"{BUFFER_ROOM:g} V within the supplies, REFIN1- lies at AVSS",
    )
    filter_ = Register(
        "FILTER_0",
        0x21,
        3,
        2 << 21 | fs,
        f"{LINUX}: filter in bits 23 to 21, 2 is sinc3; FS in bits 10 to 0, clock/(32 rate), "
        f"clock {clock:g} Hz at full power",
    )
    channels = [
        Register(
            f"CHANNEL_{i}",
            0x09 + i,
            2,
            1 << 15 | 0 << 12 | 2 * i << 5 | 2 * i + 1,
            f"{LINUX}: enable bit 15, setup bits 14 to 12, AINP bits 9 to 5, AINM bits 4 to 0; "
            f"element {place.number}",
        )
        for i, place in enumerate(places)
    ]
    return [config, filter_, *channels, control]


def when_on(layout: Layout, found: DigitalReadout) -> str:
    """The function of the line ON."""
    if not found.on:
        return "always high"
    return (
        f"every {layout.design.readout.period:g} s high; after {found.warm_up * 1e3:.3g} ms write "
        f"ADC_CONTROL, which starts the channels; low after the last one's result, at {found.on * 1e3:.3g} ms"
    )


PINS_FROM = "unread: the sheet's pin table; three layouts of others' that agree"


def pin_map(layout: Layout, converter: Converter) -> list[tuple[str, str, str]]:
    """For every board's converter: pin, its role, and the board's net on it; "" if it stays open."""
    board = digital_netlist(layout, converter, converter.inputs)
    (part,) = board.of_kind("converter")
    return [(p.number, p.role, p.net) for p in sorted(part.pins, key=lambda p: int(p.number))]


def settings_json(layout: Layout, name: str) -> bytes:
    """Registers, inputs by element, pins and figures, as JSON."""
    d, found = layout.design, digital_readout(layout, name)
    chips = [
        {
            "inputs": [
                {
                    "element": p.number,
                    "AINP": 2 * i,
                    "AINM": 2 * i + 1,
                    "resolution_mN": round(float(found.resolution[layout.elements.index(p)]) * 1e3, 4),
                }
                for i, p in enumerate(places)
            ],
            "registers": [
                {"name": r.name, "address": r.address, "bytes": r.size, "value": r.value, "why": r.why}
                for r in registers(found, chip)
            ],
        }
        for chip, places in enumerate(found.chips)
    ]
    data = {
        "schema": "tactcad-converter-1",
        "converter": found.converter.name,
        "source": found.converter.source,
        "excitation_V": round(found.excitation, 6),
        "gain": found.gain,
        "rate_Hz": found.rate,
        "from_input_to_input_s": found.settling,
        "on": {"from_ON_to_first_input_s": found.warm_up, "ON_s": found.on, "period_s": d.readout.period}
        if found.on
        else "always",
        "result": RESULT,
        "noise_nV": round(found.noise * 1e9, 3),
        "drift_nV": round(found.drift * 1e9, 3),
        "pins_from": PINS_FROM,
        "pins": [{"pin": n, "role": r, "net": net} for n, r, net in pin_map(layout, found.converter)],
        "chips": chips,
    }
    return (json.dumps(data, indent=1) + "\n").encode()


def settings_header(layout: Layout, name: str) -> bytes:
    """The same registers as a C header: values to write in their order, each with its reason; no code."""
    found = digital_readout(layout, name)
    lines = [
        f"/* {layout.design.name}: {found.converter.name}, gain {found.gain:g}, "
        f"{found.rate:g} results a second; EXC {found.excitation:.4g} V. Written by tactcad. */",
        f"/* ON: {when_on(layout, found)}. */",
        f"/* A result: {RESULT}. */",
        "#ifndef TACTCAD_CONVERTER_H",
        "#define TACTCAD_CONVERTER_H",
        "#include <stdint.h>",
        "struct tactcad_register { uint8_t address; uint8_t bytes; uint32_t value; };",
    ]
    lines.append(f"/* Pins ({PINS_FROM}):")
    lines += [f"   {n:>2} {role:8} {net or 'open'}" for n, role, net in pin_map(layout, found.converter)]
    lines[-1] += " */"
    for chip, places in enumerate(found.chips, start=1):
        numbers = ", ".join(str(p.number) for p in places)
        lines.append(f"static const uint8_t tactcad_elements_{chip}[] = {{{numbers}}}; /* by channel */")
        lines.append(f"static const struct tactcad_register tactcad_registers_{chip}[] = {{")
        for r in registers(found, chip - 1):
            value = f"0x{r.value:0{2 * r.size}X}"
            lines.append(f"    {{0x{r.address:02X}, {r.size}, {value}}}, /* {r.name}. {r.why} */")
        lines.append("};")
    return ("\n".join([*lines, "#endif"]) + "\n").encode()
