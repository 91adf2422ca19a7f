"""Checks of circuit and signals: each on a bad design or netlist, and none on the shipped ones."""

from __future__ import annotations

from dataclasses import replace

import pytest
from bad_parts import BAD
from traced_parts import asked_parts, unnamed
from variants import FACING_ROWS, variant

from tactcad.checks.facing_rows.circuit import (
    check_bridges,
    check_circuit,
    check_gauges,
    check_inputs,
    check_signals,
)
from tactcad.circuit.bridges import netlist
from tactcad.circuit.netlist import Netlist
from tactcad.design.load import read
from tactcad.parts.array.layout import Layout
from tactcad.parts.bought.electronic_parts import parts_used

OURS = [name for name, bad in BAD.items() if bad.run in ("circuit", "signals")]
SHIPPED = netlist(Layout(read("macro-array")))


def moved(designator: str, role: str, net: str) -> Netlist:
    """The shipped circuit with one pin on another net."""
    changed = tuple(
        replace(c, pins=tuple(replace(p, net=net) if p.role == role else p for p in c.pins))
        if c.designator == designator
        else c
        for c in SHIPPED.components
    )
    return replace(SHIPPED, components=changed)


@pytest.mark.parametrize("name", FACING_ROWS)
def test_the_shipped_designs_pass(name):
    assert [*check_circuit(read(name)), *check_signals(read(name))] == []


@pytest.mark.parametrize("name", OURS)
def test_each_check_finds_its_bad_design(name):
    found = {f.check for f in BAD[name].find()}
    assert name in found and {f.severity for f in BAD[name].find()} == {"fail"}


@pytest.mark.parametrize(
    ("designator", "role", "net", "gauges"),
    [
        ("W31", "2", "E2_RED", {"B2", "B3"}),  # two gauges hang on one arm
        ("A1-R31", "2", "GND", {"B3"}),  # an arm that the supply does not feed
        ("A1-R33", "1", "E4_FOOT", {"B3", "B4"}),  # an arm in the next bridge
        ("A2-Q2", "drain", "E8_FOOT", {"B7", "B8"}),  # a bridge that nothing switches, one switched twice
        ("A1-U2", "S2A", "E1_PLUS", {"B2"}),  # a bridge that no channel reads
        ("A1-U2", "S2B", "E3_MINUS", {"B2"}),  # a channel across two bridges
    ],
)
def test_a_gauge_must_be_in_one_bridge_that_is_read(designator, role, net, gauges):
    assert {f.part for f in check_bridges(moved(designator, role, net))} == gauges


@pytest.mark.parametrize(
    ("designator", "role", "net", "when"),
    [("A2-U2", "enable", "ENABLE2", "ENABLE2 is low"), ("A1-U2", "S7A", "SPARE", "S7A is addressed")],
)
def test_an_amplifier_whose_inputs_float_is_found(designator, role, net, when):
    assert list(check_inputs(SHIPPED)) == []
    (found,) = check_inputs(moved(designator, role, net))
    assert found.part == designator and when in found.message


def test_the_resolution_by_hand():
    """Two standard deviations of ten averaged samples; drift of gauge, three arms, amplifier and leads, V."""
    d = read("macro-array")
    noise = (0.000513149**2 + (140e-6) ** 2 + (10 / 65536) ** 2 / 12) ** 0.5 / 10**0.5
    leads = 0.205 * 1.361 / 120 * 0.0039 * 0.5  # the longest is cut to 205 mm
    supply = 0.001 * 0.235028  # of the largest imbalance: 0.3 % of the gauge, three arms of 0.01 %, 125 uV
    drifts = (67.5 * 2.1 * 1e-6, 67.5 * 3**0.5 * 1e-6, 100 * 1e-6, supply, 67.5 * leads)
    volts = (4 * noise**2 + sum(v**2 for v in drifts)) ** 0.5
    from tactcad.circuit.element_signals import element_signals

    for signal in element_signals(Layout(d)):
        assert signal.resolution * signal.per_force == pytest.approx(volts, rel=1e-5)


def test_no_unread_figure_decides_a_check_without_a_word(monkeypatch):
    """Every part that checks ask for figures is named while one of them is unread, and no other."""
    from tactcad.design import sensing

    design = read("macro-array")
    tables = {k: v for k, v in vars(sensing).items() if isinstance(v, dict) and k.isupper()}
    bought = {k: v for k, v in tables.items() if all(isinstance(p, sensing.Bought) for p in v.values())}
    assert set(bought) == {"AMPLIFIERS", "SWITCHES", "MULTIPLEXERS", "COMPLETIONS", "FOILS", "CONVERTERS"}
    digital = [*parts_used(variant({"readout.converter": "AD7124-8"})).values()]
    (told,) = (
        f for f in check_gauges(variant({"readout.converter": "AD7124-8"})) if f.check == "unread-figures"
    )
    assert [p.name for p in digital][0] == "AD7124-8" and all(p.name in told.message for p in digital)
    del bought["CONVERTERS"]  # those of a card
    (told,) = (f for f in check_gauges(design) if f.check == "unread-figures")
    chosen = [p for p in parts_used(design).values()]
    assert len(chosen) == len(bought) and all(p.name in told.message for p in chosen)
    for table in bought.values():  # as if each had been read
        for name, part in table.items():
            monkeypatch.setitem(table, name, replace(part, verified=True))
    assert not [f for f in check_gauges(design) if f.check == "unread-figures" or "unread" in f.message]


@pytest.mark.parametrize("changes", [{}, {"readout.converter": "AD7124-8"}])
def test_a_check_of_signals_names_the_unread_parts_that_it_asks(changes):
    wish = variant({**changes, "readout.force_resolution": 0.01, "readout.adc_range": 0.5})
    with asked_parts() as asked:
        found = [*check_signals(wish)]
    assert found and not any(unnamed(wish, asked, f.message) for f in found)


def test_the_gauges_own_limits_are_flagged():
    """By hand: 2419 e-6 at 2 N on the 4 mm arm, above the 1500 e-6 at which makers try their gauges."""
    found = {f.check: f for f in check_gauges(read("macro-array"))}
    assert set(found) == {"gauge-fatigue", "unread-figures"}
    assert found["gauge-fatigue"].value > 2419e-6 > found["gauge-fatigue"].limit == 0.0015
    assert "10 of 10" in found["gauge-fatigue"].message and "unread" in found["gauge-fatigue"].message
    assert "gauge-strain" in {f.check for f in BAD["gauge-strain"].find()}


def test_two_wires_drift_more():
    """Their whole resistance lies in the gauge's arm, and warms with the room."""
    from tactcad.parts.array.bridge_figures import drift

    wires = {c: drift(Layout(variant({"readout.connection": c}))) for c in ("two-wire", "three-wire")}
    by_hand = 67.5 * 2 * 0.210 * 1.361 / 120 * 0.0039
    assert wires["two-wire"] > wires["three-wire"] + 0.9 * by_hand > 2 * wires["three-wire"]
