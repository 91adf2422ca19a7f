"""Read-outs that keep every rule, drawn after the array that they read: bridges, amplifiers and times by
their own closed forms, each bound with a factor of 2 for what these leave out.
"""

from __future__ import annotations

from math import pi

from sound_designs import Draw

# As design/data has them: supplies (V), V inside the negative and the positive one, gains, uV of offset,
# Hz at a gain of 100. Offsets at the least gain.
AMPLIFIERS = {
    "AD621": (4.6, 36, 1.9, 1.2, (10.0, 100.0), 250, 2e5),
    "AD620": (4.6, 36, 1.9, 1.2, (1.0, 1000.0), 1625, 1.2e5),
    "AD8221": (4.6, 36, 1.9, 1.1, (1.0, 1000.0), 360, 1e5),
    "AD623": (2.7, 12, -0.15, 1.5, (1.0, 1000.0), 1200, 1e4),
    "INA128": (4.5, 36, 2.0, 2.0, (1.0, 10000.0), 1125, 2e5),
}
LEAST_CONDUCTIVITY = 6.7  # W/(m K) of the table's alloys: titanium's
COPPER = 0.0022  # ohm/mm of the thinnest wire


def draw_readout(d: Draw) -> None:
    """[readout] and [wiring], and of [gauge] what they depend on."""
    offset = abs(d.number("readout.bridge_offset", -0.05, 0.05))
    tolerance = d.number("gauge.resistance_tolerance", high=0.02)
    d.number("gauge.power_density", 1.0)
    d.number("gauge.rise", 1.0)
    d.rest("gauge")
    arm = 0.01
    if d.once_in(2):
        arm = d.number("readout.completion_tolerance", high=0.02)
        d.number("readout.completion_drift")
    d.put("readout.completion", d.choice("foil-0.01", "film-0.1", "film-1"))
    if d.once_in(4):
        d.put("readout.completion_resistance", d.table["gauge.resistance"])
    x = offset + tolerance + 3 * arm + _leads(d)
    _times(d)
    if _power(d) < 0.02:  # the least supply would be too much for so small a grid
        d.put("gauge.carrier_conductivity", 50.0)
        d.put("gauge.resistance", 10000.0)
        d.put("gauge.power_density", 1000.0)
        d.table.pop("readout.completion_resistance", None)
    volts = min(16.0, _power(d)) / 1.05
    d.put("readout.amplifier", d.choice(*AMPLIFIERS))
    least, most, above, below, gains, microvolts, _ = AMPLIFIERS[d.table["readout.amplifier"]]
    # room for the bridges' middle and the multiplexer's supply: 9 V at least
    span = d.between(max(9.5, least), min(most, 33.0) - 0.5)
    volts = d.number("readout.excitation", high=min(volts, span - 2 * (max(above, 0.0) + below) - 1))
    low, high = volts * (0.5 - x) - above, max(volts + below, 1.0)
    negative = d.number("readout.supply_negative", max(-30.0, high - span + 0.1 - 30.0), min(low, 0.0) - 0.05)
    negative = d.put(
        "readout.supply_negative", min(max(negative, high + 0.1 - span, -span + 1.0), 19.9 - span, 0.0)
    )
    positive = d.put("readout.supply_positive", round(span + negative, 3))
    # the range is what the bridges reach at the least gain, or more
    reach = 2 * gains[0] * (volts * x / 4 + microvolts * 1e-6) + 0.011
    room = min(positive, -negative)
    if reach > 0.9 * room:  # thinner bridges' supply
        volts = d.put("readout.excitation", max(0.01, round(volts * 0.4 * room / reach, 3)))
        reach = 2 * gains[0] * (volts * x / 4 + microvolts * 1e-6) + 0.011
    d.number("readout.headroom", high=0.5 * max(room - reach, 0.0))
    span = d.number("readout.adc_range", reach)
    full = min(room - d.table["readout.headroom"], span)
    largest = min(gains[1], full / (2 * (volts * x / 4 + microvolts * 1e-6) + 1e-3))
    exact = d.table["readout.amplifier"] == "AD621"
    fitting = [g for g in gains if g <= largest] or [gains[0]]
    d.put("readout.gain", d.choice(*fitting) if exact else d.between(gains[0], max(largest, gains[0])))
    d.put("readout.switch", d.choice("IRLML6244", "AO3400A"))
    d.put("readout.multiplexer", d.choice("ADG1407", "ADG1409"))
    for path in ("readout.noise", "readout.temperature_span", "readout.force_resolution"):
        if d.once_in(2):
            d.number(path)
    for path in ("adc_noise", "excitation_drift", "hum"):
        if d.once_in(2):
            d.number(f"readout.{path}")
    d.number("readout.reference_mismatch")


def _leads(d: Draw) -> float:
    """Wiring; returns the share of the gauge's resistance that its leads add on one side."""
    d.put("wiring.wire", d.choice("AWG38", "AWG36"))
    d.number("wiring.bonded", 2.6, d.recess - 1.1)
    # boards beside the widest carrier, 100 mm and more under the leads of the highest array
    way = d.number("wiring.gather") + d.number("wiring.to_board", 190.0) + 2 * d.longest_way
    share = 2 * COPPER * (way * (1 + d.number("wiring.slack")) + 5) / d.table["gauge.resistance"]
    thin = share < 0.05
    d.put("readout.connection", d.choice("two-wire", "three-wire") if thin else "three-wire")
    return share if d.table["readout.connection"] == "two-wire" else 0.0


def _times(d: Draw) -> None:
    """Readings long enough for the slowest amplifier at its largest gain, and the samples."""
    bits, samples = d.put("readout.adc_bits", d.choice(8, 12, 16, 24, 32)), d.choice(1, 10, 100, 1000)
    d.put("readout.samples", samples)
    slowest = 40e-6 + bits * (1 / (2 * pi * 100.0)) + bits * 1e-5  # 100 Hz: a gain of 10000 at 10 kHz
    on = d.number("readout.on_time", 2 * slowest, 50.0)
    d.number("readout.sample_rate", 2 * samples / on)
    d.number("readout.period", on)
    most = d.table["readout.sample_rate"] / samples / 1.01
    if d.once_in(2) and 2.3 / on < min(most, 1000.0) and most > 10.0:
        d.number("readout.mains", 2.3 / on, most)
    spread = (
        1 / d.table["readout.mains"]
        if "readout.mains" in d.table
        else samples / d.table["readout.sample_rate"]
    )
    late = d.number("readout.jitter", high=(on - slowest - spread) / 2) if d.once_in(2) else 1e-6
    if d.once_in(2) and slowest + late < on - spread - late:
        d.number("readout.instant", slowest + late, on - spread - late)


def _power(d: Draw) -> float:
    """V that the gauge bears continuously: (V/2)^2/R through its backing and half its leaf, and over its
    grid."""
    t = d.table
    thin = min(v for path, v in t.items() if path.endswith(".hinge_thickness"))
    long = max(v for path, v in t.items() if path.endswith(".hinge_length"))
    conducts = t.get("material.conductivity", LEAST_CONDUCTIVITY)
    leaf = long / 2 / (conducts * thin * t["sheet.thickness"]) * 1e3
    area = t["gauge.grid_length"] * t["gauge.grid_width"] * 1e-6
    through = t["gauge.grid_height"] * 1e-3 / (t["gauge.carrier_conductivity"] * area)
    watts = min(t["gauge.power_density"] * 1e3 * area, t["gauge.rise"] / (through + leaf))
    return 2 * (watts * t["gauge.resistance"]) ** 0.5
