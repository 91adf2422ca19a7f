"""The sigma-delta read-out: figures by hand, its registers read back bit by bit from both files, a C
compiler."""

from __future__ import annotations

import json
import math
import re
import shutil
import subprocess
from dataclasses import fields

import pytest
from variants import variant

from tactcad.checks.facing_rows.circuit import check_signals
from tactcad.circuit.bridges import netlist
from tactcad.circuit.digital_readout import digital_readout, registers, settings_header, settings_json
from tactcad.circuit.element_signals import element_signals
from tactcad.circuit.read_board import digital_netlist
from tactcad.design.fields import OneOf
from tactcad.mechanics.gauge_signal import continuous, thermal_resistance, time_constant
from tactcad.parts.array.bridge_figures import power_of
from tactcad.parts.array.hinge_section import design_gauge
from tactcad.parts.array.layout import Layout
from tactcad.parts.rules import broken_rules
from tactcad.parts.rules.readout_rules import OF_CARD

CHIP = "AD7124-8"
DUTY = {"readout.converter": CHIP, "readout.power": "duty"}


@pytest.mark.parametrize("ohm, volts", [(120.0, 1.09), (350.0, 1.84), (1000.0, 3.12)])
def test_the_grid_bears_its_supply_all_the_time(ohm, volts):
    """7.8 kW/m2 on 0.5 x 0.65 mm, as `continuous` has it, the set current 1 % high: by hand 1.092, 1.865 and
    3.153 V, and the next smaller resistors of E192 at 100 uA."""
    layout = Layout(variant({"gauge.resistance": ohm}))
    found = digital_readout(layout, CHIP)
    assert found.excitation == pytest.approx(volts)
    hot = continuous(1.01 * found.excitation, design_gauge(layout.design), power_of(layout))
    assert 0.97 * 7.8 < hot.power_density <= 7.8


@pytest.mark.parametrize("period, volts", [(1.0, 1.82), (0.5, 1.29), (5.0, 3.28)])
def test_a_duty_lets_the_grid_bear_more(period, volts):
    """On for 58 ms and five inputs of 60 ms: by hand 1.092 V over the root of that share of the period, up to
    what the converter's own supply allows. Counted in steps of 0.1 ms: heat in, and out by its resistance."""
    layout = Layout(variant({**DUTY, "readout.period": period}))
    found, gauge, power = digital_readout(layout, CHIP), design_gauge(layout.design), power_of(layout)
    tau = time_constant(gauge, power)
    assert found.on == pytest.approx(0.3 + 12 * tau) and found.warm_up == pytest.approx(12 * tau)
    assert found.excitation == pytest.approx(volts) and volts <= 1.092 / (found.on / period) ** 0.5
    step, rise, hottest, mean = 1e-4, 0.0, 0.0, 0.0
    watts = (1.01 * volts / 2) ** 2 / 120
    for k in range(round(period / step)):
        heat = watts if k * step < found.on else 0.0
        rise += step / tau * (heat * thermal_resistance(gauge, power) - rise)
        hottest, mean = max(hottest, rise + heat * power.leaf_resistance), mean + heat * step / period
    assert mean / (0.5e-3 * 0.65e-3) * 1e-3 <= 7.8 and hottest <= 20.0
    # what warms after the first input's turn, as dR/R of a quarter bridge: a fiftieth of the noise
    late = hottest * math.exp(-found.warm_up / tau) * 17e-6 * volts / 4
    assert late < found.noise / 50


def test_duty_is_in_both_files_and_in_the_rule():
    layout = Layout(variant(DUTY))
    data, header = json.loads(settings_json(layout, CHIP)), settings_header(layout, CHIP).decode()
    assert data["on"] == {
        "from_ON_to_first_input_s": pytest.approx(0.0581, rel=1e-2),
        "ON_s": pytest.approx(0.358, rel=1e-2),
        "period_s": 1.0,
    }
    assert "ON: every 1 s high; after 58.1 ms" in header
    control = next(r for r in data["chips"][0]["registers"] if r["name"] == "ADC_CONTROL")
    assert control["value"] >> 2 & 15 == 1 and "unread: it takes each channel once" in control["why"]
    always = json.loads(settings_json(Layout(variant()), CHIP))
    assert always["on"] == "always" and always["chips"][0]["registers"][-1]["value"] >> 2 & 15 == 0
    (found,) = broken_rules(variant({**DUTY, "readout.period": 0.35}))
    assert found.part == "readout.period" and "0.358 s for warm-up and one result" in found.message
    assert not broken_rules(variant({**DUTY, "readout.period": 0.36}))


def test_no_regulator_gives_more_than_it_can():
    """Eight bridges of 120 ohm, on for 0.53 s of 10: 3.28 V would be 219 mA. 200 mA are 3 V; at 20 V in it
    folds back to 130 mA."""
    full = {**DUTY, "readout.period": 10.0, "array.row_arms": [[4.0] * 8]}
    for volts_in, most in ((5.0, 3.0), (20.0, 1.95)):
        layout = Layout(variant({**full, "readout.supply_positive": volts_in}))
        assert 0.98 * most < digital_readout(layout, CHIP).excitation <= most


def test_the_supply_stays_below_the_converters_own():
    """A larger grid of 1000 ohm would bear 6.2 V; the reference may not exceed 3.32 V."""
    layout = Layout(variant({"gauge.resistance": 1000.0, "gauge.power_density": 31.0}))
    assert digital_readout(layout, CHIP).excitation == pytest.approx(3.28)


def test_a_converter_has_its_own_boards_and_rules():
    """17 elements in a row of 9 and one of 8: three converters; what only a card minds is one refusal."""
    rows = {"array.row_arms": [[4.0] * 9, [4.0] * 8], "readout.converter": CHIP}
    assert [len(chip) for chip in digital_readout(Layout(variant(rows)), CHIP).chips] == [8, 1, 8]
    card = {"readout.gain": 50, "readout.inputs": 1, "readout.excitation": 4.5, "readout.on_time": 1e-5}
    (said,) = broken_rules(variant({**card, "readout.converter": CHIP}))
    assert len(broken_rules(variant(card))) == 4
    assert said.message.endswith("no card: excitation, gain, on_time, inputs mean nothing")


def test_a_force_that_the_converter_cannot_tell_is_found():
    """1.7 mN at the stiffest: 1.5 mN is too much to ask for, 2 mN is not, which the card cannot tell."""
    for wish, failing in ((1.5, {"E1", "E8"}), (2.0, set())):
        design = variant({"readout.converter": CHIP, "readout.force_resolution": wish})
        found = [*check_signals(design)]
        assert {f.part for f in found} == failing
        assert all(f.check == "force-resolution" and "unread: AD7124-8" in f.message for f in found)


def test_its_resolution_by_hand():
    """23 nV at 9.4 Hz and a gain of 128, as the front page has it, is white: 53 nV at 50 Hz."""
    layout = Layout(variant())
    found = digital_readout(layout, CHIP)
    # +-8.6 mV takes 0.3 % of the gauge, three arms, and 5100 e-6 at overload: 3.9 mV
    assert found.gain == 128
    own = 23e-9 * (50 / 9.4) ** 0.5 * 128 / found.gain
    assert found.noise == pytest.approx((own**2 + 4 * 1.380649e-23 * 300.15 * 120 * 25) ** 0.5, rel=1e-3)
    x = ((2.1e-6) ** 2 + 3 * (1e-6) ** 2 + (0.205 * 1.361 / 120 * 0.0039 * 0.5) ** 2) ** 0.5
    drift = ((found.excitation / 4 * x) ** 2 + (10e-9) ** 2) ** 0.5
    assert found.drift == pytest.approx(drift, rel=1e-3)
    told = (4 * found.noise**2 + drift**2) ** 0.5 / abs(found.per_force)
    assert found.resolution == pytest.approx(told, rel=1e-3)
    assert [len(chip) for chip in found.chips] == [5, 5]


def test_the_first_notch_lies_on_the_mains_that_are_said():
    """At 60 Hz: FS is 320, an input takes three periods, and white noise grows by the root of 6/5."""
    at_50, at_60 = (digital_readout(Layout(variant({"readout.mains": hz})), CHIP) for hz in (50.0, 60.0))
    assert digital_readout(Layout(variant()), CHIP).rate == at_50.rate == 50
    values = {r.name: r.value for r in registers(at_60, 0)}
    assert values["FILTER_0"] & 0x7FF == 320 and at_60.settling == 3 / 60
    assert at_60.noise / at_50.noise == pytest.approx(1.2**0.5, rel=1e-9)


def test_a_field_that_changes_nothing_is_refused_and_no_other():
    """Each field of [readout] changed: a rule refuses it where settings, circuit, signals, findings and
    rules stay as they are."""

    def told(changes: dict) -> list:
        layout = Layout(variant({**DUTY, **changes}))
        rules = [f.check for f in broken_rules(layout.design) if f.check != "converter_takes_field"]
        findings = [f.part for f in check_signals(layout.design)]
        signals = [(s.per_force, s.resolution) for s in element_signals(layout)]
        return [settings_json(layout, CHIP), netlist(layout), signals, findings, rules]

    def other(field, value):
        if field.name in ("force_resolution", "completion_tolerance"):
            return 0.05  # by less, neither a finding nor the gain changes
        spec = field.metadata["spec"]
        if isinstance(spec, OneOf):
            return next(option for option in spec.options if option != value)
        return spec.low if value is None else type(value)(value / 2) if value else 0.001

    came, plain = variant(DUTY).readout, told({})
    dead = {
        f.name
        for f in fields(came)
        if f.name != "converter" and told({f"readout.{f.name}": other(f, getattr(came, f.name))}) == plain
    }
    assert dead == set(OF_CARD)


def test_the_registers_say_what_was_meant():
    """Both files alike; bits by the places that the sources have them at."""
    layout = Layout(variant())
    found, data = digital_readout(layout, CHIP), json.loads(settings_json(layout, CHIP))
    header = settings_header(layout, CHIP).decode()
    in_header = [
        (int(a, 16), int(n), int(v, 16)) for a, n, v in re.findall(r"\{(0x\w+), (\d), (0x\w+)\}", header)
    ]
    in_json = [(r["address"], r["bytes"], r["value"]) for chip in data["chips"] for r in chip["registers"]]
    assert in_header == in_json and all(r["why"] for chip in data["chips"] for r in chip["registers"])
    values = {r["name"]: r["value"] for r in data["chips"][1]["registers"]}
    assert 2 ** (values["CONFIG_0"] & 7) == found.gain and values["CONFIG_0"] >> 11 & 1 == 1
    # written last, as it starts the channels; a result says which one it is of
    assert [chip["registers"][-1]["name"] for chip in data["chips"]] == ["ADC_CONTROL"] * 2
    assert values["ADC_CONTROL"] >> 10 & 1 == 1
    assert data["result"].startswith("4 bytes: 3 of data, then STATUS") and data["result"] in header
    assert values["CONFIG_0"] >> 3 & 3 == 0  # REFIN1: the bridges' own supply
    assert 614400 / (32 * (values["FILTER_0"] & 0x7FF)) == found.rate and values["FILTER_0"] >> 21 == 2
    assert values["ADC_CONTROL"] >> 6 & 3 == 2
    inputs = [(i["element"], i["AINP"], i["AINM"]) for i in data["chips"][1]["inputs"]]
    for k, (number, plus, minus) in enumerate(inputs):
        channel = values[f"CHANNEL_{k}"]
        assert (channel >> 5 & 31, channel & 31, channel >> 15) == (plus, minus, 1)
        assert number == found.chips[1][k].number


@pytest.mark.parametrize("ohm, volts", [(120.0, 1.09), (1000.0, 3.12), (1500.0, 3.28)])
def test_no_reference_buffer_is_on_next_to_a_supply(ohm, volts):
    """A buffer is on only where its input lies 0.1 V within the converter's supplies, each 1 % off: REFIN1-
    is on AVSS itself, and of 1500 ohm REFIN1+ is 40 mV below AVDD."""
    layout = Layout(variant({"gauge.resistance": ohm}))
    found = digital_readout(layout, CHIP)
    (part,) = digital_netlist(layout, found.converter, 8).of_kind("converter")
    on = {"EXC": volts * 1.01, "GND": 0.0}
    config = next(r for r in registers(found, 0) if r.name == "CONFIG_0")
    assert found.excitation == pytest.approx(volts) and "unread" in config.why and "AVSS" in config.why
    for bit, pin in ((8, "REFIN1+"), (7, "REFIN1-")):
        inside = min(on[part.net(pin)] - on[part.net("AVSS")], 3.32 * 0.99 - on[part.net(pin)])
        assert config.value >> bit & 1 == (inside > 0.1), pin


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
def test_the_header_compiles(tmp_path):
    (tmp_path / "converter.h").write_bytes(settings_header(Layout(variant()), CHIP))
    used = ("registers_1[0].address", "registers_2[0].bytes", "elements_1[0]", "elements_2[0]")
    body = " + ".join(f"tactcad_{name}" for name in used)
    (tmp_path / "main.c").write_text(f'#include "converter.h"\nint main(void) {{ return {body}; }}\n')
    asked = ["cc", "-Wall", "-Werror", "-o", tmp_path / "a", tmp_path / "main.c"]
    assert subprocess.run(asked, check=False).returncode == 0


def test_an_export_takes_both_files_along():
    """Beside the netlist's, of a kind that manifest and packages know; none where a card reads."""
    from types import SimpleNamespace

    from tactcad.export.manifest import kinds
    from tactcad.export.products import circuit_files

    found = {}
    for converter in (CHIP, "card"):
        design = variant({"readout.converter": converter})
        plan = SimpleNamespace(design=design, revision="X", shapes=SimpleNamespace(made_by="here"))
        batches = list(circuit_files(plan))
        outputs = [output for batch in batches for output in batch.files]
        assert {output.kind for output in outputs} <= kinds()
        found[converter] = {output.path for output in outputs}
    added = {f"circuit/macro-array-{CHIP}_X.{ending}" for ending in ("h", "json")}
    assert found[CHIP] - found["card"] == added
