"""Gauges, read-out and wiring: electronic parts known by name, and the tables of the design file that choose
them.

Parts are rows of data/*.csv, with each figure's source; SI units unless a column's head states another, and
lengths in mm.
"""

from __future__ import annotations

from dataclasses import dataclass

from .fields import Number, OneOf, Whole, given
from .text_values import data_records

# Jitter of a sample's instant by its trigger, s, plus and minus. Chosen: a line of the card that is clocked
# with its samples is some ns to a us late; USB hands a command on within a frame of 1 ms (USB 2.0, full
# speed).
JITTER = {"hardware": 1e-6, "software": 1e-3}
# V rms of one sample for each volt of the range: NI 6259, 140 uV at +-5 V, from memory of its table
# (unread). The paper's USB-6258 is in no list of the maker's that was found; 6255 and 6259 are.
ADC_NOISE = 28e-6
POWERS = ("continuous", "duty")  # of bridges that a converter reads


@dataclass(frozen=True)
class Bought:
    """An electronic part as ordered; `verified`: every figure was read in the maker's own sheet."""

    name: str
    maker: str
    mpn: str
    verified: bool


@dataclass(frozen=True)
class Amplifier(Bought):
    """An instrumentation amplifier; V, ohm, Hz, s, F, V/rtHz, V/K. `pins` by role.

    gains: all that its pins set; empty if a resistor sets any from `least_gain` to `most_gain` as
    1 + gain_ohm/R.
    """

    gains: tuple[float, ...]
    least_gain: float
    most_gain: float
    gain_ohm: float
    noise_in: float
    noise_out: float
    bandwidth_100: float
    gain_bandwidth: float
    offset_in: float
    offset_out: float
    drift_in: float
    drift_out: float
    above_negative: float
    below_positive: float
    least_supply: float
    most_supply: float
    settling: float
    input_capacitance: float
    pins: dict[str, str]

    @property
    def legal_gains(self) -> str:
        if self.gains:
            return " or ".join(f"{g:g}" for g in self.gains)
        return f"from {self.least_gain:g} to {self.most_gain:g}"

    def takes(self, gain: float) -> bool:
        return gain in self.gains if self.gains else self.least_gain <= gain <= self.most_gain

    def noise_density(self, gain: float) -> float:
        """White noise referred to the input, V/rtHz."""
        return (self.noise_in**2 + (self.noise_out / gain) ** 2) ** 0.5

    def offset(self, gain: float) -> float:
        """Largest, referred to the input, V."""
        return self.offset_in + self.offset_out / gain

    def drift(self, gain: float) -> float:
        """Largest of the offset, referred to the input, V/K."""
        return self.drift_in + self.drift_out / gain

    def bandwidth(self, gain: float) -> float:
        """-3 dB, Hz: that at a gain of 100 falls with larger gains, and rises to `gain_bandwidth`."""
        return min(self.bandwidth_100 * 100 / gain, self.gain_bandwidth)


@dataclass(frozen=True)
class Switch(Bought):
    """A MOSFET in the bridge's return; ohm, V. `pins` by role: gate, source, drain."""

    on_ohm: float
    most_volts: float
    pins: dict[str, str]


@dataclass(frozen=True)
class Multiplexer(Bought):
    """A differential multiplexer and its decoder; ohm of one switch, F at an output, s, V."""

    channels: int
    on_ohm: float
    output_capacitance: float
    settling: float
    least_supply: float
    most_supply: float
    inputs_a: tuple[str, ...]
    inputs_b: tuple[str, ...]
    address: tuple[str, ...]
    pins: dict[str, str]
    decoder: str


@dataclass(frozen=True)
class Completion(Bought):
    """A resistor for the three other arms of a bridge; tolerance relative, drift 1/K, watts at 70 C."""

    description: str
    tolerance: float
    drift: float
    package: str
    watts: float


@dataclass(frozen=True)
class Converter(Bought):
    """A sigma-delta converter; noise V rms at the input at a gain and a rate (Hz), drift V/K, clock Hz,
    least_reference V. pins by role: AIN0 and on, and the others'."""

    inputs: int
    bits: int
    gains: tuple[float, ...]
    noise: float
    noise_gain: float
    noise_rate: float
    clock: float
    drift: float
    least_reference: float
    ratiometric: bool
    pins: dict[str, str]
    package: str
    source: str


@dataclass(frozen=True)
class Foil(Bought):
    """A gauge's grid on its backing: largest strain, and the strain plus and minus at which it bears so many
    cycles."""

    strain: float
    fatigue: float
    cycles: float


@dataclass(frozen=True)
class Wire:
    """Lead wire: conductor and insulation mm, ohm/m."""

    name: str
    diameter: float
    outer: float
    ohm_per_metre: float


AMPLIFIERS = data_records(__file__, "amplifiers", Amplifier)
SWITCHES = data_records(__file__, "switches", Switch)
MULTIPLEXERS = data_records(__file__, "multiplexers", Multiplexer)
COMPLETIONS = data_records(__file__, "completions", Completion)
CONVERTERS = data_records(__file__, "converters", Converter)
FOILS = data_records(__file__, "foils", Foil)
WIRES = data_records(__file__, "wires", Wire)


@dataclass(frozen=True)
class StrainGauge:
    """[gauge]: the strain gauge at each hinge."""

    resistance: float = given(Number("ohm", 10, 10000, "gauge resistance"), 120.0)
    factor: float = given(Number("", 0.5, 200, "gauge factor"), 2.1)
    foil: str = given(
        OneOf(tuple(FOILS), "grid and backing, for their strain limits"), "constantan on polyimide"
    )
    grid_length: float = given(Number("mm", 0.01, 10, "active grid length, centred on the hinge"), 0.5)
    grid_width: float = given(Number("mm", 0.01, 20, "grid width"), 0.65)
    grid_height: float = given(Number("mm", 0, 0.5, "backing and adhesive: foil over the hinge's face"), 0.03)
    carrier_arm_side: float = given(Number("mm", 0.01, 50, "carrier from hinge centre towards the pad"), 1.2)
    carrier_body_side: float = given(
        Number("mm", 0.01, 50, "carrier from hinge centre towards the clamp"), 2.8
    )
    carrier_width: float = given(Number("mm", 0.01, 20, "carrier across the element"), 1.5)
    carrier_modulus: float = given(Number("MPa", 0, 2e5, "Young's modulus of backing and adhesive"), 3000.0)
    carrier_conductivity: float = given(Number("W/(m K)", 0.01, 50, "of backing and adhesive"), 0.2)
    foil_thickness: float = given(Number("mm", 0, 0.1, "grid foil"), 0.005)
    foil_modulus: float = given(Number("MPa", 0, 5e5, "Young's modulus of the foil"), 162000.0)
    foil_coverage: float = given(Number("", 0, 1, "share of the grid's area that is metal"), 0.5)
    resistance_per_kelvin: float = given(Number("1/K", -0.01, 0.01, "on a free gauge"), -17e-6)
    thermal_output: float = given(
        Number("1/K", 0, 1e-3, "apparent strain of the gauge bonded on this metal, plus and minus"), 1e-6
    )
    resistance_tolerance: float = given(
        Number("", 0, 0.1, "of the bonded gauge's resistance, relative, plus and minus"), 0.003
    )
    power_density: float = given(
        Number(
            "kW/m2",
            0.01,
            1000,
            "largest of the grid that the backing bears on this metal, mean over a period",
        ),
        7.8,
    )
    rise: float = given(
        Number("K", 0.1, 200, "largest of the grid over the body that the backing bears"), 20.0
    )


@dataclass(frozen=True)
class Readout:
    """[readout]: quarter bridge, amplifier and converter."""

    excitation: float = given(Number("V", 0.01, 20, "bridge supply while reading"), 2.7)
    gain: float = given(Number("", 1, 10000, "amplifier gain"), 100.0)
    supply_positive: float = given(Number("V", 1, 30, "amplifier supply"), 5.0)
    supply_negative: float = given(Number("V", -30, 0, "amplifier supply"), -5.0)
    headroom: float = given(Number("V", 0, 5, "output stays this far inside the supplies"), 1.5)
    bridge_offset: float = given(Number("", -0.1, 0.1, "dR/R of the unloaded bridge"), 0.0)
    noise: float | None = given(
        Number("V", 0, 1, "rms of one sample at the amplifier's output"),
        None,
        "from the amplifier's noise and bandwidth, and that of the resistors before it",
    )
    adc_bits: int = given(Whole(1, 32, "converter resolution"), 16)
    adc_range: float = given(Number("V", 0.01, 30, "converter's range, plus and minus"), 5.0)
    samples: int = given(Whole(1, 1_000_000, "samples averaged for a reading"), 10)
    on_time: float = given(Number("s", 1e-6, 100, "bridge powered for one reading"), 0.005)
    period: float = given(Number("s", 1e-5, 1e5, "time between readings"), 1.0)
    reference_mismatch: float = given(
        Number("", 0, 1, "share of self-heating that the bridge's other arms do not cancel"), 1.0
    )
    amplifier: str = given(OneOf(tuple(AMPLIFIERS), "instrumentation amplifier of a board"), "AD621")
    switch: str = given(OneOf(tuple(SWITCHES), "MOSFET in the return of each bridge"), "IRLML6244")
    multiplexer: str = given(OneOf(tuple(MULTIPLEXERS), "from a board's bridges to its amplifier"), "ADG1407")
    completion: str = given(
        OneOf(tuple(COMPLETIONS), "resistors of the three arms that complete each bridge"), "foil-0.01"
    )
    completion_resistance: float | None = given(
        Number("ohm", 10, 10000, "of each of these three"), None, "the gauge's"
    )
    completion_tolerance: float | None = given(
        Number("", 0, 0.1, "of this resistance, relative, plus and minus"), None, "the completion's"
    )
    completion_drift: float | None = given(
        Number("1/K", 0, 0.01, "temperature coefficient of this resistance"), None, "the completion's"
    )
    connection: str = given(OneOf(("three-wire", "two-wire"), "leads of each gauge"), "three-wire")
    temperature_span: float = given(
        Number("K", 0, 100, "change of temperature between zero and reading"), 1.0
    )
    force_resolution: float | None = given(
        Number("mN", 1e-4, 1e6, "smallest force that each element must resolve"), None, "none is asked for"
    )
    instant: float | None = given(
        Number("s", 0, 100, "time from ENABLE to the first sample"), None, "as late as readout.on_time allows"
    )
    timing: str = given(
        OneOf(tuple(JITTER), "what sets the instant: a clocked line of the card, or a program"), "hardware"
    )
    jitter: float | None = given(
        Number("s", 0, 1, "of the instant, plus and minus"), None, "1 us by hardware, 1 ms by software"
    )
    mains: float | None = given(
        Number("Hz", 10, 1000, "frequency of the mains: samples are spread over a whole period"),
        None,
        "not asked: samples follow each other at readout.sample_rate; 50 of a sigma-delta converter",
    )
    hum: float = given(Number("V", 0, 10, "rms of the mains at the amplifier's output"), 0.0)
    adc_noise: float | None = given(
        Number("V", 0, 10, "rms of one sample, by the converter itself"),
        None,
        "28 uV for each volt of readout.adc_range",
    )
    excitation_drift: float = given(
        Number("", 0, 0.1, "relative change of the bridges' supply between zero and reading"), 0.001
    )
    converter: str = given(
        OneOf(("card", *CONVERTERS), "a card behind amplifiers, or a sigma-delta converter a board"), "card"
    )
    power: str = given(
        OneOf(POWERS, "of a converter's bridges: always on, or on once a period to be read"), "continuous"
    )
    inputs: int | None = given(
        Whole(1, 4096, "differential inputs of the converter's card"), None, "one for each board"
    )
    sample_rate: float = given(Number("Hz", 1, 1e8, "samples of one input, at most"), 1e5)


@dataclass(frozen=True)
class Wiring:
    """[wiring]: leads from the gauges' terminals to the boards."""

    wire: str = given(OneOf(tuple(WIRES), "lead wire, by its gauge"), "AWG36")
    bonded: float = given(
        Number(
            "mm", 0, 50, "length of the leads bonded in the wire recess, up to its end: their strain relief"
        ),
        4.0,
    )
    gather: float = given(
        Number("mm", 1, 500, "distance from the rear ends to the tie around a row's leads"), 15.0
    )
    to_board: float = given(Number("mm", 1, 5000, "distance from that tie to the board's connector"), 150.0)
    slack: float = given(Number("", 0, 1, "added to each lead's length, relative"), 0.1)
