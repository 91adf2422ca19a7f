"""Read-outs that cannot be: one line with field, value and what is legal, exit status 2, nothing written."""

from __future__ import annotations

import re

import pytest
from variants import BARE_TEXT, variant

from tactcad.cli.main import main
from tactcad.parts.layout import Layout
from tactcad.parts.rules import broken_rules

REFUSED = {
    "an unknown amplifier": ('amplifier = "AD622"', "readout.amplifier", "AD622", "'AD621'"),
    "a gain that it lacks": ("gain = 50", "readout.gain", "50", "10 or 100"),
    "more power than the backing bears": ("excitation = 6.0", "readout.excitation", "6", "at most 5.63 V"),
    "more channels than inputs": ("inputs = 1", "readout.inputs", "1", "at least 2"),
    "resistors out of the bridge's range": (
        "completion_tolerance = 0.05",
        "readout.completion_tolerance",
        "0.05",
        "within 0.016",
    ),
    "a bridge out of balance": ("bridge_offset = 0.05", "readout.bridge_offset", "0.05", "at most 0.04"),
    "a range that is too small for the gain": (
        "headroom = 4.8",
        "readout.gain",
        "100",
        "10, or less excitation",
    ),
    "a supply that no input bears at rest": ("excitation = 4.5", "readout.supply_positive", "5", "5.7 V"),
    "another resistance than the gauge's": (
        "completion_resistance = 350",
        "readout.completion_resistance",
        "350",
        "120 ohm",
    ),
}


def text(line: str) -> str:
    """The published array's text with a line of [readout] set."""
    name = line.split(" = ")[0]
    kept = [row for row in BARE_TEXT.splitlines() if not row.startswith(f"{name} = ")]
    at = kept.index("[readout]")
    return "\n".join([*kept[: at + 1], line, *kept[at + 1 :]]) + "\n"


@pytest.mark.parametrize("what", REFUSED)
def test_one_line_says_field_value_and_what_is_legal(what, tmp_path, capsys):
    line, field, value, legal = REFUSED[what]
    refused(text(line), field, value, legal, tmp_path, capsys)


def test_a_gauge_longer_than_the_leaf_allows(tmp_path, capsys):
    longer = BARE_TEXT.replace("carrier_arm_side = 1.2", "carrier_arm_side = 1.9")
    refused(longer, "gauge.carrier_arm_side", "1.9", "at most 1.7 mm", tmp_path, capsys)


def test_leads_of_two_wires_that_are_too_long(tmp_path, capsys):
    longer = text('connection = "two-wire"') + "\n[wiring]\nto_board = 5000\n"
    refused(longer, "wiring.to_board", "5000", "mm, or readout.connection", tmp_path, capsys)


@pytest.mark.parametrize(
    ("line", "field", "legal"),
    [
        ("grid = 5", "readout.grid", "did you mean gauge.grid_length?"),
        ("adc_bit = 5", "readout.adc_bit", "did you mean readout.adc_bits?"),
        ("zzz = 5", "readout.zzz", "see `tactcad schema`"),
        ('completion = "reference-gauge"', "readout.completion", "'foil-0.01'"),
    ],
)
def test_a_field_or_value_that_is_none(line, field, legal, tmp_path, capsys):
    refused(
        text(line),
        field,
        line.split(" = ")[1].strip('"') if "completion" in line else "",
        legal,
        tmp_path,
        capsys,
    )


def test_leads_bonded_over_their_terminals(tmp_path, capsys):
    """Terminals of 3 mm lie 0.5 mm behind the recess's wall: behind them is the room for the relief."""
    layout = Layout(variant())
    assert layout.design.bonding is not None
    room = layout.rear_end - layout.recess_start - 0.5 - 3.0
    assert broken_rules(variant({"wiring.bonded": room})) == []
    assert [f.part for f in broken_rules(variant({"wiring.bonded": room + 0.01}))] == ["wiring.bonded"]
    longer = BARE_TEXT + "\n[wiring]\nbonded = 18.0\n"
    refused(longer, "wiring.bonded", "18", "behind the terminals", tmp_path, capsys)


def test_a_wire_that_is_too_thick_for_the_length_that_is_bonded(tmp_path, capsys):
    """Ten diameters of 0.5 mm are 5 mm, of 0.4 mm they are the 4 mm that come: both ways out are taken."""
    thick = BARE_TEXT + '\n[wiring]\nwire = "AWG30"\n'
    legal = "AWG38, AWG36, AWG34, AWG32, or wiring.bonded from 5 mm"
    refused(thick, "wiring.wire", "AWG30", legal, tmp_path, capsys)
    for wire in ("AWG38", "AWG36", "AWG34", "AWG32"):
        assert broken_rules(variant({"wiring.wire": wire})) == []
    assert broken_rules(variant({"wiring.wire": "AWG30", "wiring.bonded": 5.0})) == []
    (found,) = broken_rules(variant({"wiring.wire": "AWG30", "wiring.bonded": 4.9}))
    assert found.part == "wiring.bonded"


@pytest.mark.parametrize(("arms", "helps"), [("[[5], [5]]", False), ("[[5, 5, 5, 5, 5, 5]]", True)])
def test_another_multiplexer_is_offered_where_it_saves_inputs(arms, helps, tmp_path, capsys):
    design = text("inputs = 1").replace("[[4, 7, 6, 8, 6], [8, 5, 4, 5, 7]]", arms)
    four = design.replace("[readout]\n", '[readout]\nmultiplexer = "ADG1409"\n')
    legal = "at least 2" + (", or a readout.multiplexer of 8 channels" if helps else "")
    refused(four, "readout.inputs", "1", legal, tmp_path, capsys)
    (tmp_path / "design.toml").write_text(four, encoding="utf-8")
    main(["export", str(tmp_path / "design.toml"), "--out", str(tmp_path / "out")])
    assert capsys.readouterr().err.strip().endswith(legal)


def refused(design: str, field: str, value: str, legal: str, tmp_path, capsys) -> None:
    file = tmp_path / "design.toml"
    file.write_text(design, encoding="utf-8")
    assert main(["export", str(file), "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err.strip()
    assert "\n" not in said and field in said and value in said and legal in said
    assert [p.name for p in tmp_path.iterdir()] == ["design.toml"]


@pytest.mark.parametrize(
    ("changes", "path"),
    [
        ({"readout.completion_tolerance": 0.05}, "readout.completion_tolerance"),
        (
            {"readout.completion_tolerance": 0.03, "readout.bridge_offset": 0.01},
            "readout.completion_tolerance",
        ),
        ({"readout.bridge_offset": 0.06}, "readout.bridge_offset"),
        ({"readout.bridge_offset": 0.0, "gauge.resistance_tolerance": 0.09}, "gauge.resistance_tolerance"),
        ({"readout.connection": "two-wire", "wiring.to_board": 4900.0}, "wiring.to_board"),
        ({"readout.on_time": 0.3}, "readout.excitation"),
        ({"readout.samples": 1000}, "readout.on_time"),
        ({"readout.samples": 10, "readout.on_time": 2e-5}, "readout.on_time"),
    ],
)
def test_what_is_said_to_be_legal_is_accepted(changes, path):
    """And is close to the bound: a twentieth beyond it is refused again."""
    (found,) = broken_rules(variant(changes))
    assert found.part == path
    bound = float(re.search(r"\d[\d.e-]*", found.limit)[0])
    assert broken_rules(variant({**changes, path: bound})) == []
    beyond = bound / 1.05 if "at least" in found.limit else bound * 1.05
    assert [f.part for f in broken_rules(variant({**changes, path: beyond}))] == [path]
