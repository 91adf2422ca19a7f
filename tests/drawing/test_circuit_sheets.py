"""The circuit's sheets, read back from their PDF: all of the netlist stands there, nothing over another."""

from __future__ import annotations

import csv
import io
import re

import pytest
from variants import FACING_ROWS, variant

from tactcad.circuit.bridges import netlist
from tactcad.design.load import read
from tactcad.design.messages import CheckFailure
from tactcad.drawing.circuit_sheets import sheets
from tactcad.drawing.circuit_sheets.sheets import circuit_written
from tactcad.drawing.engine.layout_check import layout_faults
from tactcad.drawing.engine.sheet_files import pdf_runs
from tactcad.export.board_files import table_file, wiring_file
from tactcad.parts.array.bridge_figures import settling_time
from tactcad.parts.array.layout import Layout

OTHERS = {
    "two wires": {"readout.connection": "two-wire"},
    "a gain resistor, four channels": {"readout.amplifier": "AD8221", "readout.multiplexer": "ADG1409"},
    "one element": {"array.row_arms": [[4.0]]},
    "rows of 3 and 20": {"array.row_arms": [[4, 8, 4], [5] * 20]},
    "a resistance of eleven letters": {"gauge.resistance": 8515.59},
    "a converter": {"readout.converter": "AD7124-8"},
    "converters, two wires, rows of 9 and 1": {
        "readout.converter": "AD7124-8",
        "readout.connection": "two-wire",
        "array.row_arms": [[4] * 9, [5]],
    },
    "a hundred elements": {"array.row_arms": [[4, 7, 6, 8, 6] * 10, [8, 5, 4, 5, 7] * 10]},
}


READ_BY = ("multiplexer", "converter")


def everything_stands_there(design) -> None:
    pages = pdf_runs(circuit_written(design).pdf)
    first, said = pages[0], [run for page in pages for run in page]
    revision, circuit = design.design.revision, netlist(Layout(design))
    for n, page in enumerate(pages, start=1):
        assert revision in page and f"{n}/{len(pages)}" in page
    nets = list(csv.DictReader(io.StringIO(table_file(design, circuit).decode())))
    # of board 1 and element 1 every component is drawn
    own = [row["designator"] for row in nets if row["board"] == "1" and row["element"] in ("", "1")]
    channels = re.compile(r"(R[1-8]\d|Q[2-8]|C[2-8]1)$")  # of others, which read no element
    drawn = {name.removeprefix("A1-") for name in own}
    drawn = {name for name in drawn if not channels.match(name)} | {"R11", "R12", "R13", "R14"}
    words = set(re.findall(r"\w+", " ".join([*first, *pages[1]])))
    assert drawn <= words | {"X1"} and "X1.1" in first and "X1.2" in first
    # every gauge in the matrix, with the channel's pins as the netlist has them
    for gauge in {row["designator"] for row in nets if row["kind"] == "gauge"}:
        n = gauge[1:]
        mux = [r for r in nets if r["net"] == f"E{n}_PLUS" and r["kind"] in READ_BY]
        minus = [r for r in nets if r["net"] == f"E{n}_MINUS" and r["kind"] in READ_BY]
        assert gauge in said
        name = mux[0]["designator"].partition("-")[2]
        if mux[0]["kind"] == "converter":
            assert {f"{name}.{row['pin']} {row['role']}" for row in (mux[0], minus[0])} <= set(said)
        else:
            assert f"{name}.{mux[0]['pin']} +, .{minus[0]['pin']} −" in said
    # every lead of the wiring list, in its order of columns
    text = " ".join(said)
    for row in csv.DictReader(io.StringIO(wiring_file(design, circuit).decode())):
        cells = (row["lead"], f"E{row['element']}", row["from"], row["to"], row["colour"], row["wire"])
        assert " ".join(cells) in text


def test_each_pin_of_the_decoder_and_what_sets_the_gain_as_in_the_netlist():
    """Beside every stub of the decoder stands its own net; the gain's pins are drawn, and its resistor."""
    for changes in ({}, {"readout.amplifier": "AD8221"}):
        design = variant(changes)
        first = pdf_runs(circuit_written(design).pdf)[0]
        circuit = netlist(Layout(design))
        decoder, amplifier = circuit.on_board("decoder", 1), circuit.on_board("amplifier", 1)
        assert decoder.net("E3") == "A1_ENABLE" and "ENABLE" in first
        assert [run for run in first if run.endswith("ENABLE1")] == ["9  ENABLE1"]
        assert any(run.startswith("A0, also U2.") for run in first)
        numbers = {pin.number for pin in amplifier.pins if pin.role in ("rg1", "rg2")}
        assert numbers <= set(first)
        assert ("R1" in first and "499 ohm" in first) == bool(changes)


@pytest.mark.parametrize(("changes", "outputs", "inputs"), [({}, 5, 2), (OTHERS["one element"], 4, 1)])
def test_the_card_has_what_the_boards_ask_of_it(changes, outputs, inputs):
    """As many as there are such nets on the boards' connectors: A0 to A2, ENABLE and OUT of each."""
    design = variant(changes)
    parts = netlist(Layout(design)).of_kind("connector")
    nets = {pin.net for part in parts for pin in part.pins}
    digital = {net for net in nets if re.fullmatch(r"A\d|ENABLE\d+", net)}
    assert len(digital) == outputs and len([net for net in nets if net.startswith("OUT")]) == inputs
    text = " ".join(pdf_runs(circuit_written(design).pdf)[0])
    assert f"The card needs {outputs} digital outputs, A0 to A2" in text
    assert re.search(rf"and {inputs} differential inputs?, OUT and GND of a board", text)


@pytest.mark.parametrize(
    ("power", "said"), [("continuous", "ON: always high"), ("duty", "ON: every 1 s high")]
)
def test_a_converters_sheet_says_what_the_controller_is_asked_for(power, said):
    """As many lines as its boards' connectors have, the supply that the resistor sets, and every pin of the
    converter that is not another channel's input."""
    design = variant({"readout.converter": "AD7124-8", "readout.power": power})
    circuit = netlist(Layout(design))
    first, around = pdf_runs(circuit_written(design).pdf)[:2]
    text = " ".join(first)
    nets = {p.net for c in circuit.of_kind("connector") for p in c.pins if c.designator.endswith("J1")}
    assert {"SCLK", "DIN", "ON", "CS1", "CS2"} <= nets and "CS1 to CS2" in text
    (set_by,) = (c for c in circuit.components if c.designator == "A1-R2")
    assert said in text and f"EXC, is {1e-4 * set_by.figure('ohm'):.4g} V over GND" in text
    assert "12 REFIN1+ on EXC1" in first and "22 REFOUT, 25 PSW, 31 CLK open" in first
    for pin in circuit.on_board("converter", 1).pins:
        named = {f"{pin.number} {pin.role}", f"{pin.role} {pin.number}"}
        other = pin.role.startswith("AIN") and pin.role not in ("AIN0", "AIN1")
        assert other or any(name in run for name in named for run in first), pin
    assert "3  enable: ON" in around and "3  enable: VPOS" in around


def test_no_general_tolerance_on_a_sheet_without_dimensions():
    pages = pdf_runs(circuit_written(read("macro-array")).pdf)
    assert not any("2768" in run or "8015" in run for page in pages for run in page)


def test_no_sample_before_the_output_has_settled():
    design = read("macro-array")  # 12.4 us
    text = " ".join(pdf_runs(circuit_written(design).pdf)[0])
    said = float(re.search(r"settled after ([\d.]+) us", text)[1])
    settled = settling_time(design) * 1e6
    assert settled <= said < settled + 1
    first, last = map(
        float, re.search(r"10 samples a reading, ([\d.]+) to ([\d.]+) ms after ENABLE", text).groups()
    )
    assert settled < 1e3 * first and first == pytest.approx(5 - 0.1) and last == pytest.approx(first + 0.09)
    assert "within 1 us, by a clocked line" in text


def test_the_plan_names_short_arms_of_two_digits_too():
    design = variant({"array.row_arms": [[4] * 12, [4] * 12]})
    plan = pdf_runs(circuit_written(design).pdf)[3]
    assert "Wiring plan" in plan and {f"E{n}" for n in range(1, 25)} <= set(plan)


@pytest.mark.parametrize("name", FACING_ROWS)
def test_the_shipped_designs(name):
    everything_stands_there(read(name))


@pytest.mark.by_day(4, "a sheet each")
@pytest.mark.parametrize("what", OTHERS)
def test_other_circuits(what):
    everything_stands_there(variant(OTHERS[what]))


def test_a_draft_says_so():
    assert all("PRELIMINARY" in [t.text for t in s.texts] for s in sheets.circuit_sheets(variant(), True))


def test_a_text_over_a_line_is_refused(monkeypatch):
    kept = sheets.plan_page
    monkeypatch.setattr(sheets, "plan_page", lambda layout, says: kept(layout, says * 20))
    with pytest.raises(CheckFailure, match="Wiring plan"):
        sheets.circuit_sheets(variant())


def test_the_plan_is_to_scale():
    """The tie's distance from the rear ends, on paper over in mm: the scale that the sheet states."""
    design = read("macro-array")
    (plan,) = [s for s in sheets.circuit_sheets(design) if s.title.startswith("Wiring plan")]
    assert layout_faults(plan) == []
    ties = [i for i in plan.items if getattr(i, "radius", 0) == 1.2]
    apart = abs(ties[0].centre[0] - ties[1].centre[0])
    real = 2 * (Layout(design).rear_end + design.wiring.gather)
    assert apart / real == pytest.approx(2.0) and "2:1" in [t.text for t in plan.texts]
