"""Boards of a converter: read by KiCad, followed from gauge to register, counted by the bill."""

from __future__ import annotations

import csv
import io
import json
import re
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from ngspice import solved
from test_boards import checked, needs_kicad
from variants import variant

from tactcad.checks.facing_rows.circuit import check_bridges, check_circuit, check_inputs
from tactcad.circuit import board_layout as boards
from tactcad.circuit.bridges import netlist
from tactcad.circuit.digital_readout import digital_readout, settings_header, settings_json
from tactcad.circuit.element_signals import element_signals, reading_noise
from tactcad.circuit.kicad_board import board_bytes
from tactcad.circuit.netlist_files import DIODE, harness_csv, lines_of, wiring
from tactcad.export.board_files import BILL, bill_csv, nets_in_board
from tactcad.lab.pads import springs_of
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.measurements import gauge_checks, volts
from tactcad.parts.array.supplies import electronic_supplies, wiring_supplies
from tactcad.parts.rigs.bonding_fixture import bonding_rigs
from tactcad.review.effect import signals
from tactcad.scenes.rigs import bonding

CHIP = "AD7124-8"


def layout_of(changes: dict | None = None) -> Layout:
    return Layout(variant({"readout.converter": CHIP, **(changes or {})}))


def test_kicad_finds_nothing(tmp_path):
    needs_kicad()
    (board,) = boards.laid_out(layout_of())
    checked(board, tmp_path)


@pytest.mark.slow  # starts KiCad
@pytest.mark.parametrize(
    ("completion", "connection"), [("foil-0.01", "two-wire"), ("film-0.1", "three-wire")]
)
def test_kicad_finds_nothing_on_any_board(completion, connection, tmp_path):
    """Rows of 1 and 8 elements; those between differ by what is fitted."""
    needs_kicad()
    changes = {"readout.completion": completion, "readout.connection": connection}
    for used in (1, 8):
        (board,) = boards.laid_out(layout_of({**changes, "array.row_arms": [[4.0] * used]}))
        checked(board, tmp_path)


@pytest.mark.parametrize("connection", ["two-wire", "three-wire"])
def test_an_elements_leads_end_at_the_inputs_that_its_registers_name(connection):
    """From the terminals by lead, connector and board's net to the input that CHANNEL_n selects."""
    layout = layout_of({"readout.connection": connection})
    circuit, told = netlist(layout), json.loads(settings_json(layout, CHIP))
    ends = {lead.designator: circuit.pin_at(lead.end) for lead in wiring(layout, circuit)}
    for number, chip in enumerate(told["chips"], start=1):
        converter = next(c for c in circuit.of_kind("converter") if c.board == number)
        for channel, entry in enumerate(chip["inputs"]):
            n, value = (
                entry["element"],
                next(r["value"] for r in chip["registers"] if r["name"] == f"CHANNEL_{channel}"),
            )
            plus, minus = (converter.net(f"AIN{value >> shift & 31}") for shift in (5, 0))
            last = f"W{n}{3 if connection == 'three-wire' else 2}"
            assert ends[f"W{n}1"].net == f"E{n}_RED" and ends[last].net == "GND"
            assert ends[last].role.endswith(f"CH{channel + 1}_FOOT")
            if connection == "three-wire":
                assert ends[f"W{n}2"].net == plus
            arms = {frozenset(p.net for p in c.pins) for c in circuit.of_kind("resistor") if c.element == n}
            supply = f"EXC{number}"
            halves = {frozenset(s) for s in ((f"E{n}_RED", supply), (minus, supply), (minus, "GND"))}
            link = {frozenset((f"E{n}_RED", plus))} if connection == "two-wire" else set()
            assert arms == halves | link


def test_the_pin_map_is_the_boards():
    """In both files, as the pads of KiCad's file have it; every pad of the package is in it once."""
    layout = layout_of()
    (board,) = boards.laid_out(layout)
    on_pads = {
        pin: net
        for net, pins in nets_in_board(board_bytes(board, "N", "t", "2026-01-01", "A")).items()
        for name, pin in pins
        if name == "U1"
    }
    told = json.loads(settings_json(layout, CHIP))["pins"]
    assert [int(p["pin"]) for p in told] == list(range(1, 34))
    assert {p["pin"]: p["net"] for p in told if p["net"]} == on_pads
    text = settings_header(layout, CHIP).decode()
    assert {
        n: net for n, net in re.findall(r"^ +(\d+) [A-Z0-9+-]+ +(\w+)", text, re.M) if net != "open"
    } == on_pads


def test_on_switches_the_bridges_supply_and_nothing_else():
    """From the card's connector by 1 kohm to the enable pin, 100 kohm to ground; VPOS is beside it."""
    circuit = boards.netlist_of_board(layout_of({"readout.power": "duty"}), 5)
    (regulator,), (supply,) = circuit.of_kind("regulator"), circuit.of_kind("supply")
    assert (regulator.net("enable"), supply.net("enable")) == ("ON", "VPOS")
    around = [c for c, _ in circuit.nets["ON"] if c.kind == "resistor"]
    on = {(c.kind, c.value, frozenset(p.net for p in c.pins)) for c in around}
    assert on == {
        ("resistor", "1 kohm", frozenset(("ON_IN", "ON"))),
        ("resistor", "100 kohm", frozenset(("ON", "GND"))),
    }
    card = [p.net for c in circuit.of_kind("connector") if c.designator == "J1" for p in c.pins]
    assert card[2:4] == ["VPOS", "ON_IN"]
    always = boards.netlist_of_board(layout_of(), 5)
    differs = [a.designator for a, b in zip(circuit.components, always.components) if a != b]
    assert differs == ["U4", "R2"]  # by the volts that it is set to


def test_each_gauge_is_in_one_bridge_and_no_input_floats():
    layout = layout_of()
    circuit = netlist(layout)
    assert [*check_circuit(layout.design)] == []

    def moved(name: str, role: str, net: str):
        return replace(
            circuit,
            components=tuple(
                replace(c, pins=tuple(replace(p, net=net) if p.role == role else p for p in c.pins))
                if c.designator == name
                else c
                for c in circuit.components
            ),
        )

    for name, role, net, gauges in (
        ("A1-R21", "2", "GND", {"B2"}),  # an arm that the supply does not feed
        ("A1-R33", "2", "E4_MINUS", {"B3", "B4"}),  # an arm in the next bridge
        ("A1-U1", "AIN2", "E1_PLUS", {"B2"}),  # an input across two bridges
    ):
        assert {f.part for f in check_bridges(moved(name, role, net))} >= gauges, name
    (found,) = check_inputs(moved("A2-U1", "AIN15", "SPARE"))
    assert found.part == "A2-U1" and "SPARE" in found.message


@pytest.mark.parametrize("changes", [{}, {"readout.completion": "film-1", "readout.connection": "two-wire"}])
def test_the_bill_has_what_stands_on_the_boards(changes):
    """Counted from the netlists of both boards; and every line of a board's own bill is one to order by."""
    layout = layout_of(changes)
    circuit = netlist(layout)
    placed = Counter(c.part_no for c in circuit.components if c.board and c.footprint and c.fitted)
    supplies = electronic_supplies(layout)
    ordered = {s.part_no: s.qty for s in supplies}
    assert {part: ordered.get(part) for part in placed} == dict(placed)
    assert not {"ADG1407BRUZ", "AD621ARZ", "IRLML6244TRPBF", "74HCT238"} & set(ordered)
    (board,) = boards.laid_out(layout)
    rows = [*csv.DictReader(io.StringIO(bill_csv(board, supplies).decode()), BILL)][1:]
    read = {row["source_verified"] for row in rows}
    assert {row["part_no"] for row in rows if row["part_no"] not in ordered} == set() and read == {"unread"}
    assert "1.09 V" in next(s.description for s in supplies if s.part_no == "SET-RESISTOR")


INPUT_LIMIT = 0.010  # A in a pin beyond its supplies: the AD7124-8's sheet, from memory (unread)


@pytest.mark.parametrize("falls", ["V33", "controller first"])
def test_supplies_in_any_order_harm_no_input(falls, tmp_path):
    """The converter's pins as diodes to its rails: V33 falls in 1 ms while EXC is charged to 3.12 V, gauges
    of 1000 ohm; or a controller drives 3.3 V into a board that has no supply."""
    layout = layout_of({"gauge.resistance": 1000.0})
    circuit = boards.netlist_of_board(layout, 8)
    (part,) = circuit.of_kind("converter")
    kinds = ("resistor", "capacitor", "diode")
    lines = ["* supplies", DIODE, ".model esd D(IS=1e-14 RS=1)", "RV VPOS 0 100"]
    lines += [line for c in circuit.components if c.kind in kinds for line in lines_of(c)]
    for c in range(1, 9):
        lines += [f"RL{c} CH{c}_RED CH{c}_PLUS 1", f"RG{c} CH{c}_PLUS 0 1000"]
    if falls == "V33":
        lines += ["V33 V33 0 PWL(0 3.32 1m 3.32 2m 0)", ".ic v(EXC)=3.12"]
    else:
        lines += ["R33 V33 0 100", *(f"V{n} {n}_IN 0 3.3" for n in ("ON", "SCLK", "DIN", "CS"))]
    seen = [p for p in part.pins if p.role.startswith("AIN") or p.role in ("SCLK", "DIN", "CS", "REFIN1+")]
    for p in seen:
        lines += [f"VM{p.number} {p.net} P{p.number} 0", f"DU{p.number} P{p.number} V33 esd"]
        lines.append(f"DL{p.number} 0 P{p.number} esd")
    lines += [".control", "tran 10u 20m"]
    for p in seen:
        lines += [f"let m{p.number} = vecmax(abs(i(VM{p.number})))", f"print m{p.number}"]
    found = solved("\n".join([*lines, "quit 0", ".endc", ".end", ""]), tmp_path)
    inputs = {p.number: found[f"m{p.number}"] for p in seen if p.role != "REFIN1+"}
    assert len(inputs) == 19 and max(inputs.values()) < INPUT_LIMIT / 2, inputs


def test_the_harness_carries_all_bridges():
    """Ten bridges of 120 ohm at 1.09 V from VPOS, half of each one's current in its leads."""
    layout = layout_of()
    circuit = netlist(layout)
    rows = [*csv.DictReader(io.StringIO(harness_csv(circuit, wiring(layout, circuit)).decode()))]
    assert float(next(r for r in rows if r["from"] == "supply VPOS")["current_mA"]) == pytest.approx(
        2 * 7.0 + 10 * 1090 / 120, rel=1e-2
    )
    lead = next(r for r in rows if r["signal"] == "E1_RED")
    assert float(lead["current_mA"]) == pytest.approx(1090 / 240, rel=1e-2)
    order = {s.part_no: s for s in wiring_supplies(layout)}
    for signal, part, of in (("SHIELD", "BRAID", "braid"), ("ARRAY", "ARRAY-WIRE", "AWG 26")):
        metres = [float(r["length_mm"]) / 1e3 for r in rows if r["signal"] == signal and of in r["wire"]]
        assert len(metres) == 2 and 0 <= order[part].qty - sum(metres) < 0.1
    assert "AWG 26" in order["ARRAY-WIRE"].designation and "silver" in order["SILVER-ADHESIVE"].designation
    assert {"silver" in r["wire"] for r in rows if r["signal"] == "ARRAY"} == {True}
    assert [r["to"] for r in rows if r["signal"] == "ON"] == 2 * [
        "digital output ON, or a jumper to VPOS beside it: high, the bridges are on"
    ]
    assert {r["to"] for r in rows if r["signal"] in ("CS1", "CS2")} == {
        "digital output CS1",
        "digital output CS2",
    }


def test_noise_in_a_grasp_is_the_converters():
    """What estimates, robots' taxels and the search take of a reading: in newtons as the converter's own."""
    layout = layout_of()
    found = digital_readout(layout, CHIP)
    for signal, per_force in zip(element_signals(layout), found.per_force):
        for alike in (False, True):
            told = reading_noise(layout, alike) / signal.per_force
            assert told == pytest.approx(found.noise / abs(per_force))


def test_every_signal_of_a_converters_design_is_its_bridges():
    """V/N of reviews, V/mm of pads, mV of the bonding guide: 1.09 V x 2.1/4 a strain, less the leads' 0.23 %.
    A gauge's zero stays within the input at the highest gain, 4/128 of dR/R less the rated signal."""
    layout = layout_of()
    found = digital_readout(layout, CHIP)
    assert signals(layout.design) == pytest.approx([*found.per_force])
    per_mm = springs_of(layout.design)[1] / springs_of(variant())[1]
    assert per_mm == pytest.approx(np.full(10, 1.09 / 270), rel=1e-3)
    assert volts(layout, 1e-3) == pytest.approx(1.09e-3 / 4, rel=1e-3)
    checks = gauge_checks(layout)
    largest = max(found.per_force) * layout.design.rating.force / (1.09 / 4)
    assert checks.zero == pytest.approx(4 / 128 - largest, rel=0.01)
    assert re.search(r"permille \(0\.\d+ mV\) at arm 4", bonding.zero(bonding_rigs(layout.design)[0]))


def test_the_check_and_the_search_see_the_same_resolution():
    """`smallest_output` over an amplifier's slope is what the converter's own figures give."""
    layout = layout_of()
    found = digital_readout(layout, CHIP)
    assert [s.resolution for s in element_signals(layout)] == pytest.approx([*abs(found.resolution)])
