"""Checks of circuit and signals: each on a bad design or netlist, and none on the shipped ones."""

from __future__ import annotations

from dataclasses import replace

import pytest
from bad_parts import BAD
from variants import variant

from tactcad.checks.facing_rows.circuit import check_bridges, check_circuit, check_inputs, check_signals
from tactcad.circuit.bridges import netlist
from tactcad.circuit.netlist import Netlist
from tactcad.design.load import names, read
from tactcad.parts.array.layout import Layout

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


@pytest.mark.parametrize("name", names())
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
    noise = (0.000513149**2 + (10 / 65536) ** 2 / 12) ** 0.5 / 10**0.5
    drifts = (67.5 * 2.1 * 1e-6, 67.5 * 3**0.5 * 1e-6, 100 * 1e-6, 67.5 * 1.1e-5)
    volts = (4 * noise**2 + sum(v**2 for v in drifts)) ** 0.5
    from tactcad.circuit.element_signals import element_signals

    for signal in element_signals(Layout(d)):
        assert signal.resolution * signal.per_force == pytest.approx(volts, rel=1e-5)


def test_two_wires_drift_more():
    """Their whole resistance lies in the gauge's arm, and warms with the room."""
    from tactcad.parts.array.bridge_figures import drift

    wires = {c: drift(Layout(variant({"readout.connection": c}))) for c in ("two-wire", "three-wire")}
    by_hand = 67.5 * 2 * 0.210 * 1.361 / 120 * 0.0039
    assert wires["two-wire"] > wires["three-wire"] + 0.9 * by_hand > 2 * wires["three-wire"]
