"""Read-outs that cannot be: one line with field, value and what is legal, exit status 2, nothing written."""

from __future__ import annotations

import re
from math import ceil

import pytest
from variants import BARE_TEXT, variant

from tactcad.cli.main import main
from tactcad.design.messages import InputError
from tactcad.parts.array.bridge_figures import instants
from tactcad.parts.array.layout import Layout
from tactcad.parts.rules import broken_rules, refuse_broken

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
    "a range that is too small": ("headroom = 4.8", "readout.headroom", "4.8", "at most 4.76 V"),
    "no range": ("headroom = 5", "readout.headroom", "5", "at most 4.76 V"),
    "a supply that no input bears at rest": ("excitation = 4.5", "readout.excitation", "4.5", "3.8 V"),
    "more than the board's regulator bears": (
        "supply_positive = 24",
        "readout.supply_positive",
        "24",
        "from 3.2 to 20 V",
    ),
    "a supply on one side only": ("supply_negative = 0", "readout.supply_negative", "0", "to -4 V"),
    "more samples than a reading takes": ("samples = 100000", "readout.samples", "100000", "at most 498"),
    "samples that take too long": ("sample_rate = 10", "readout.sample_rate", "10", "at least 2010 Hz"),
    "a period shorter than a reading": ("period = 0.001", "readout.period", "0.001", "at least 0.005 s"),
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


@pytest.mark.by_day(12, "searches for what is legal")
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
        ({"readout.on_time": 0.3}, "readout.on_time"),
        ({"readout.on_time": 2.0}, "readout.on_time"),
        ({"readout.period": 0.001}, "readout.period"),
        ({"readout.period": 0.001, "readout.excitation": 0.1}, "readout.period"),
        ({"readout.samples": 1000}, "readout.samples"),
        ({"readout.samples": 1_000_000}, "readout.samples"),
        ({"readout.samples": 1000, "readout.sample_rate": 5000.0}, "readout.samples"),
        ({"readout.sample_rate": 10.0}, "readout.sample_rate"),
        ({"readout.samples": 10, "readout.on_time": 2e-5}, "readout.on_time"),
        ({"readout.samples": 1000, "readout.on_time": 2e-5}, "readout.on_time"),
        ({"readout.jitter": 0.0025, "readout.on_time": 0.005}, "readout.on_time"),
        ({"readout.timing": "software", "readout.instant": 4.9e-3}, "readout.instant"),
        (
            {"readout.timing": "software", "readout.on_time": 1.5e-3, "readout.instant": 1.015e-3},
            "readout.on_time",
        ),
        ({"readout.timing": "software", "readout.mains": 50.0, "readout.on_time": 0.0201}, "readout.on_time"),
        ({"readout.jitter": 2e-3, "readout.samples": 200}, "readout.samples"),
        ({"readout.jitter": 2e-3, "readout.sample_rate": 5000.0}, "readout.sample_rate"),
        ({"readout.excitation": 18.0}, "readout.excitation"),
        ({"readout.headroom": 5.0}, "readout.headroom"),
        ({"readout.adc_range": 0.1}, "readout.adc_range"),
        ({"readout.supply_negative": 0.0}, "readout.supply_negative"),
        ({"readout.supply_negative": 0.0, "readout.supply_positive": 9.0}, "readout.supply_negative"),
        ({"readout.supply_negative": -30.0}, "readout.supply_negative"),
        ({"readout.supply_positive": 1.0}, "readout.supply_positive"),
        ({"readout.supply_positive": 1.0, "readout.supply_negative": -0.5}, "readout.supply_positive"),
    ],
)
def test_what_is_said_to_be_legal_is_accepted(changes, path):
    """By its rule, and no more: a twentieth beyond it is refused again. Who does what is said has
    a design after at most three refusals."""
    said = refusal(changes)
    assert said.where == path and said.value == changes[path]
    bound = nearest(said)
    beyond = bound + abs(bound) / (-20 if bound > said.value else 20)
    again = refusal({**changes, path: ceil(beyond) if path == "readout.samples" else beyond})
    assert again.where == path and rule_of(again) == rule_of(said)
    for _ in range(2):
        changes = {**changes, said.where: nearest(said)}
        if not (left := broken_rules(variant(changes))):
            break
        assert rule_of(said) not in {f.check for f in left}
        said = refusal(changes)
    assert broken_rules(variant({**changes, said.where: nearest(said)})) == []


@pytest.mark.parametrize("late", [0.0, 1e-6, 1e-3, 2.4e-3])
def test_no_sample_falls_after_the_switch_opens(late):
    """Unless told, the last is so late that its jitter reaches the end of 5 ms, or its spacing."""
    last = instants(variant({"readout.jitter": late}))[-1]
    assert last == pytest.approx(5e-3 - max(late, 1e-5))


def rule_of(said: InputError) -> str:
    return re.match(r"rule (\w+)", said.what)[1]


def nearest(said: InputError) -> float:
    """Of the values that are legal."""
    ends = [float(v) for v in re.findall(r"-?\d[\d.e-]*", said.legal.partition(" with ")[0])]
    return min(ends, key=lambda end: abs(end - said.value))


def test_of_two_faults_each_is_named_in_turn():
    faults = {"readout.excitation": 6.0, "readout.samples": 100_000}
    first = refusal(faults)
    assert (first.where, first.legal) == ("readout.excitation", "at most 5.63 V, or shorter readings")
    second = refusal({**faults, "readout.excitation": 3.8})
    assert (second.where, second.legal) == ("readout.samples", "at most 498")


def test_the_field_that_is_set_is_named():
    """1.42 of 2.55 ms heats the gauges to 26 of the 7.8 kW/m2 that they bear, in proportion to the time."""
    said = refusal({"readout.on_time": 0.00142, "readout.period": 0.00255})
    assert said.where == "readout.on_time"
    assert float(said.legal.split()[2]) == pytest.approx(1.42e-3 * 7.8 / 26.0, rel=0.01)


def test_a_fault_elsewhere_leaves_the_rules_own_words():
    """No supply and no headroom makes up for such resistors: what is said can be met all the same."""
    said = refusal({"readout.completion_tolerance": 0.05, "readout.headroom": 5.0})
    assert (said.where, said.legal) == ("readout.headroom", "both supplies further than this from 0 V")


def refusal(changes) -> InputError:
    with pytest.raises(InputError) as caught:
        refuse_broken(variant(changes))
    return caught.value
