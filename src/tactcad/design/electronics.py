"""Electronic parts known by name: amplifiers, switches, multiplexers, bridge completion, wire.

Rows of data/*.csv, which say where each figure is from; SI units but where a column's head says otherwise.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .data_table import data_rows


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

    gains: all that its pins set; empty where a resistor sets any from `least_gain` to `most_gain` as
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
    offset: float
    drift: float
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
    """A differential multiplexer and the decoder beside it; ohm of one switch, F at an output, s, V."""

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
class Wire:
    """Lead wire: conductor and insulation mm, ohm/m."""

    name: str
    diameter: float
    outer: float
    ohm_per_metre: float


def _rows(name: str) -> list[dict[str, str]]:
    return data_rows(Path(__file__).parent / "data" / f"{name}.csv")


def _bought(row: dict[str, str]) -> dict[str, Any]:
    verified = {"true": True, "false": False}[row["source_verified"]]
    return {"name": row["name"], "maker": row["maker"], "mpn": row["mpn"], "verified": verified}


def _numbers(row: dict[str, str], *names: str) -> dict[str, Any]:
    return {name: float(row[name]) for name in names}


def _pins(row: dict[str, str], *roles: str) -> dict[str, str]:
    return {role: row[f"pin_{role}"] for role in roles}


def _amplifier(row: dict[str, str]) -> Amplifier:
    low, dots, high = row["gains"].partition("..")
    gains = () if dots else tuple(map(float, row["gains"].split()))
    least, most = (float(low), float(high)) if dots else (min(gains), max(gains))
    same = ("gain_ohm", "bandwidth_100", "gain_bandwidth", "above_negative", "below_positive")
    return Amplifier(
        **_bought(row),
        gains=gains,
        least_gain=least,
        most_gain=most,
        **_numbers(row, *same, "least_supply", "most_supply", "settling"),
        noise_in=float(row["noise_in"]) * 1e-9,
        noise_out=float(row["noise_out"]) * 1e-9,
        offset=float(row["offset"]) * 1e-6,
        drift=float(row["drift"]) * 1e-6,
        input_capacitance=float(row["input_pF"]) * 1e-12,
        pins=_pins(row, "rg1", "minus", "plus", "negative", "ref", "out", "positive", "rg2"),
    )


def _multiplexer(row: dict[str, str]) -> Multiplexer:
    return Multiplexer(
        **_bought(row),
        channels=int(row["channels"]),
        **_numbers(row, "on_ohm", "settling", "least_supply", "most_supply"),
        output_capacitance=float(row["output_pF"]) * 1e-12,
        inputs_a=tuple(row["pins_a"].split()),
        inputs_b=tuple(row["pins_b"].split()),
        address=tuple(row["pins_address"].split()),
        pins=_pins(row, "out_a", "out_b", "enable", "positive", "negative", "ground"),
        decoder=row["decoder"],
    )


AMPLIFIERS = {row["name"]: _amplifier(row) for row in _rows("amplifiers")}
SWITCHES = {
    row["name"]: Switch(
        **_bought(row), **_numbers(row, "on_ohm", "most_volts"), pins=_pins(row, "gate", "source", "drain")
    )
    for row in _rows("switches")
}
MULTIPLEXERS = {row["name"]: _multiplexer(row) for row in _rows("multiplexers")}
COMPLETIONS = {
    row["name"]: Completion(
        **_bought(row),
        description=row["description"],
        package=row["package"],
        **_numbers(row, "tolerance", "drift", "watts"),
    )
    for row in _rows("completions")
}
WIRES = {
    row["name"]: Wire(row["name"], **_numbers(row, "diameter", "outer", "ohm_per_metre"))
    for row in _rows("wires")
}
