"""The sigma-delta read-out: figures by hand, its registers read back bit by bit from both files, a C
compiler."""

from __future__ import annotations

import json
import re
import shutil
import subprocess

import pytest
from variants import variant

from tactcad.checks.facing_rows.circuit import check_signals
from tactcad.circuit.digital_readout import digital_readout, settings_header, settings_json
from tactcad.mechanics.gauge_signal import continuous
from tactcad.parts.array.bridge_figures import power_of
from tactcad.parts.array.hinge_section import design_gauge
from tactcad.parts.array.layout import Layout
from tactcad.parts.rules import broken_rules

CHIP = "AD7124-8"


@pytest.mark.parametrize("ohm, volts", [(120.0, 1.09), (350.0, 1.84), (1000.0, 3.12)])
def test_the_grid_bears_its_supply_all_the_time(ohm, volts):
    """7.8 kW/m2 on 0.5 x 0.65 mm, as `continuous` has it, the set current 1 % high: by hand 1.092, 1.865 and
    3.153 V, and the next smaller resistors of E192 at 100 uA."""
    layout = Layout(variant({"gauge.resistance": ohm}))
    found = digital_readout(layout, CHIP)
    assert found.excitation == pytest.approx(volts)
    hot = continuous(1.01 * found.excitation, design_gauge(layout.design), power_of(layout))
    assert 0.97 * 7.8 < hot.power_density <= 7.8


def test_the_supply_stays_below_the_converters_own():
    """A larger grid of 1000 ohm would bear 6.2 V; the reference may not exceed 3.32 V."""
    layout = Layout(variant({"gauge.resistance": 1000.0, "gauge.power_density": 31.0}))
    assert digital_readout(layout, CHIP).excitation == pytest.approx(3.28)


def test_a_converter_has_its_own_boards_and_rules():
    """17 elements in a row of 9 and one of 8: three converters; what only a card minds is no rule."""
    rows = {"array.row_arms": [[4.0] * 9, [4.0] * 8], "readout.converter": CHIP}
    assert [len(chip) for chip in digital_readout(Layout(variant(rows)), CHIP).chips] == [8, 1, 8]
    card = {"readout.gain": 50, "readout.inputs": 1, "readout.excitation": 4.5, "readout.on_time": 1e-5}
    assert broken_rules(variant(card)) and not broken_rules(variant({**card, "readout.converter": CHIP}))


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
    assert found.resolution == pytest.approx(told)
    assert [len(chip) for chip in found.chips] == [5, 5]


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
    assert values["CONFIG_0"] >> 3 & 3 == 0  # REFIN1: the bridges' own supply
    assert 614400 / (32 * (values["FILTER_0"] & 0x7FF)) == found.rate and values["FILTER_0"] >> 21 == 2
    assert values["ADC_CONTROL"] >> 6 & 3 == 2
    inputs = [(i["element"], i["AINP"], i["AINM"]) for i in data["chips"][1]["inputs"]]
    for k, (number, plus, minus) in enumerate(inputs):
        channel = values[f"CHANNEL_{k}"]
        assert (channel >> 5 & 31, channel & 31, channel >> 15) == (plus, minus, 1)
        assert number == found.chips[1][k].number


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

    from tactcad.export.manifest import KINDS
    from tactcad.export.products import circuit_files

    found = {}
    for converter in (CHIP, "card"):
        design = variant({"readout.converter": converter})
        plan = SimpleNamespace(design=design, revision="X", shapes=SimpleNamespace(made_by="here"))
        batches = list(circuit_files(plan))
        outputs = [output for batch in batches for output in batch.files]
        assert {output.kind for output in outputs} <= set(KINDS)
        found[converter] = {output.path for output in outputs}
    added = {f"circuit/macro-array-{CHIP}_X.{ending}" for ending in ("h", "json")}
    assert found[CHIP] - found["card"] == added
