"""The circuit's deck, solved by ngspice, against closed forms that know nothing of the netlist."""

from __future__ import annotations

from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest
from ngspice import solved
from variants import variant

from tactcad.circuit.bridges import netlist
from tactcad.circuit.element_signals import element_signals
from tactcad.circuit.netlist import Netlist
from tactcad.circuit.netlist_files import DIODE, closed, deck, deck_bytes, lines_of, reading
from tactcad.circuit.read_board import board_netlist
from tactcad.circuit.tracks import with_tracks
from tactcad.design.load import read
from tactcad.design.sensing import AMPLIFIERS
from tactcad.mechanics import gauge_signal, readout
from tactcad.parts.array.bridge_figures import instant_error, instants, power_of, settling_time, warm_output
from tactcad.parts.array.hinge_section import design_gauge, design_readout, hinge_section
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.leads import lead_routes
from tactcad.parts.bought.electronic_parts import completion_drift, completion_tolerance

SWITCHES = {"IRLML6244": 0.021, "BSS138": 6.0, "2N7002": 7.5}


def source(circuit: Netlist) -> str:
    """In the deck: the bridges' supply of the first board."""
    return f"V{circuit.on_board('regulator', 1).net('out')}"


FULL_SCALE = 0.035  # V at a bridge: the converter's 3.5 V over a gain of 100


def strained(circuit: Netlist, x: dict[int, float]) -> Netlist:
    """The circuit with relative changes of gauges' resistances, by element."""
    changed = tuple(
        replace(c, figures=(("ohm", c.figure("ohm") * (1 + x.get(c.element, 0.0))),))
        if c.kind == "gauge"
        else c
        for c in circuit.components
    )
    return replace(circuit, components=changed)


def warming(a: str, b: str, layout: Layout) -> list[str]:
    """Lines of a deck: a gauge of 120 ohm between two nodes whose resistance follows its grid's temperature,
    and its heat, W, in the capacities of grid and element as a circuit (1 V a kelvin)."""
    gauge, power = design_gauge(layout.design), power_of(layout)
    ohm_k, tau = gauge_signal.thermal_resistance(gauge, power), gauge_signal.time_constant(gauge, power)
    heat = f"V({a},{b})*V({a},{b})/120"
    return [
        f"BG {a} {b} I = V({a},{b})/(120*(1 - 17e-6*V(hot)))",
        f"BP 0 grid I = {heat}",
        f"RT grid 0 {ohm_k}",
        f"CT grid 0 {tau / ohm_k}",
        f"BH hot 0 V = V(grid) + {power.leaf_resistance}*{heat}",
        "RH hot 0 1",
    ]


def read_all(circuit: Netlist, tmp_path) -> dict[str, float]:
    return solved(deck(circuit, list(reading(circuit))), tmp_path)


def bridge(volts: float, R: float, x: float, lead: float, on: float, three: bool) -> float:
    """A quarter bridge by voltage dividers: supply, switch below, both halves beside each other."""
    active = R * (1 + x) + (lead if three else 2 * lead)
    upper = R + (lead if three else 0.0)
    halves = 1 / (1 / (active + upper) + 1 / (2 * R))
    across = volts * halves / (halves + on)
    return across * (active / (active + upper) - 0.5)


@pytest.mark.parametrize("ohm", [120.0, 350.0, 1000.0])
@pytest.mark.parametrize("switch", SWITCHES)
@pytest.mark.parametrize("connection", ["three-wire", "two-wire"])
def test_bridges_agree_with_dividers(ohm, switch, connection, tmp_path):
    """Within a millionth of full scale, over strains, self-heating's drift, leads of 0.04 to 7 ohm."""
    for to_board in (150.0, 4900.0):
        design = variant(
            {
                "gauge.resistance": ohm,
                "readout.switch": switch,
                "readout.connection": connection,
                "wiring.to_board": to_board,
                "wiring.wire": "AWG36" if to_board > 1000 else "AWG30",
            }
        )
        # strains of the hinge, and the drift of a warm gauge: 4.5 K at 17 ppm/K
        x = {1: 0.0, 2: 1e-4, 3: -1e-4, 4: 4.5 * -17e-6, 5: 1e-2, 6: -1e-2, 7: 2e-2, 8: -2e-2}
        circuit = netlist(Layout(design))
        found = read_all(strained(circuit, x), tmp_path)
        for n in range(1, 11):
            cut = circuit.of_element("lead", n).figure("mm")
            lead = cut * 1e-3 * {"AWG36": 1.361, "AWG30": 0.3387}[design.wiring.wire]
            exact = bridge(2.7, ohm, x.get(n, 0.0), lead, SWITCHES[switch], connection == "three-wire")
            assert found[f"bridge{n}"] == pytest.approx(exact, abs=1e-6 * FULL_SCALE)
            assert found[f"output{n}"] == pytest.approx(100 * exact, abs=1e-4 * FULL_SCALE)


def test_three_wires_are_the_better_connection(tmp_path):
    """Of two wires the leads' resistance unbalances the bridge, of three not, and takes twice as much of the
    signal."""
    found = {}
    for connection in ("two-wire", "three-wire"):
        circuit = netlist(Layout(variant({"readout.connection": connection})))
        still, loaded = (read_all(strained(circuit, {1: x}), tmp_path)["output1"] for x in (0.0, 1e-3))
        found[connection] = (still, loaded - still)
    lead = lead_routes(Layout(variant()))[0].cut * 1.361e-3  # AWG 36: ohm/m
    assert abs(found["three-wire"][0]) < 1e-6
    assert found["two-wire"][0] == pytest.approx(67.5 * 2 * lead / 120, rel=0.01)
    lost = {c: 1 - signal / (67.5e-3 / (1 + 0.5e-3)) for c, (_, signal) in found.items()}
    assert lost["three-wire"] == pytest.approx(lead / 120, rel=0.1)
    assert lost["two-wire"] == pytest.approx(2 * lead / 120, rel=0.1)


def test_the_papers_gain(tmp_path):
    """2.7 V x 100 x 2.1/4 = 142 V per strain; leads and switch take 0.25 % of it, as mechanics has it."""
    design = read("macro-array")
    alone = replace(design_readout(design), transmission=1.0)
    assert float(readout.volts_per_strain(2.1, alone)) == pytest.approx(2.7 * 100 * 2.1 / 4)
    circuit = netlist(Layout(design))
    strain = 1e-6
    found = read_all(strained(circuit, dict.fromkeys(range(1, 11), 2.1 * strain)), tmp_path)
    for n in range(1, 11):
        assert found[f"output{n}"] / strain == pytest.approx(141.4, rel=1e-3)


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"readout.connection": "two-wire"},
        {"readout.switch": "2N7002"},
        {"wiring.to_board": 4900.0, "wiring.wire": "AWG30"},
        {"gauge.resistance": 1000.0, "readout.connection": "two-wire", "readout.switch": "BSS138"},
        {"readout.completion_resistance": 121.0},
    ],
)
def test_mechanics_slope_is_the_netlists(changes, tmp_path):
    """Every element's within 0.05 %: their leads differ by a step of 5 mm, of 0.2 m."""
    design = variant(changes)
    circuit = netlist(Layout(design))
    slope = float(readout.volts_per_strain(2.1, design_readout(design)))
    ends = [
        read_all(strained(circuit, dict.fromkeys(range(1, 11), 2.1 * s)), tmp_path) for s in (-1e-5, 1e-5)
    ]
    for n in range(1, 11):
        per_strain = (ends[1][f"output{n}"] - ends[0][f"output{n}"]) / 2e-5
        assert per_strain == pytest.approx(slope, rel=5e-4)


@pytest.mark.parametrize(
    "changes", [{}, {"readout.connection": "two-wire"}, {"readout.completion": "film-0.1"}]
)
def test_the_boards_tracks_take_nothing_of_the_signal(changes, tmp_path):
    """Gain of the board as it is made, its tracks in the deck: within 0.1 % of the closed form; the zero that
    they make is less than a tenth of what 0.3 % of the gauges' own tolerance makes."""
    design = variant(changes)
    layout = Layout(design)
    circuit = with_tracks(layout, netlist(layout))
    slope = float(readout.volts_per_strain(2.1, design_readout(design)))
    ends = [
        read_all(strained(circuit, dict.fromkeys(range(1, 11), 2.1 * s)), tmp_path) for s in (-1e-5, 1e-5)
    ]
    bare = read_all(netlist(layout), tmp_path)
    for n in range(1, 11):
        per_strain = (ends[1][f"output{n}"] - ends[0][f"output{n}"]) / 2e-5
        assert per_strain == pytest.approx(slope, rel=1e-3)
        zero = (ends[1][f"output{n}"] + ends[0][f"output{n}"]) / 2 - bare[f"output{n}"]
        assert 0 < abs(zero) < 0.1 * 67.5 * 0.003


def amperes(lines: list[str], folder) -> dict[str, float]:
    return solved("\n".join(["* supplies", *lines, ".end", ""]), folder)


MUX_LIMIT = 0.030  # A in a pin of the ADG1407 beyond its supplies: its sheet, absolute maximum ratings


@pytest.mark.parametrize("first", ["address", "negative", "falling"])
def test_supplies_in_any_order_harm_no_pin(first, tmp_path):
    """The multiplexer's pins as diodes to its rails, an unpowered rail as 100 ohm to ground: what flows while
    the address comes before the supplies, VNEG before VPOS, or VPOS falls from 5 V in 1 ms, EXC charged."""
    design = read("macro-array")
    circuit = board_netlist(design, 5, 3)
    part = circuit.on_board("multiplexer", 0)
    rails = {"VPOS": "R1 VPOS 0 100", "VNEG": "R2 VNEG 0 100", "V5": "R3 V5 0 100"}
    sources, run = [], "tran 10u 20m"
    if first == "address":
        sources = [f"VD{i} {net} 0 5" for i, net in enumerate(("A0_IN", "A1_IN", "A2_IN", "ENABLE_IN"))]
    elif first == "negative":
        rails["VNEG"] = "V2 VNEG 0 -5"
    else:
        rails = {"VPOS": "V1 VPOS 0 PWL(0 5 1m 5 2m 0)", "VNEG": "V2 VNEG 0 -5", "V5": "V3 V5 0 5"}
        sources = [".ic v(EXC)=2.7"]
        run += " uic"
    lines = [DIODE, ".model esd D(IS=1e-14 RS=1)", *rails.values(), *sources]
    kinds = ("resistor", "capacitor", "diode")
    lines += [line for c in circuit.components if c.kind in kinds for line in lines_of(c)]
    seen = []
    for pin in part.pins:
        if pin.role[0] in "SA" or pin.role.startswith("out"):
            lines += [f"V{pin.role} {pin.net} P{pin.role} 0"]
            lines += [f"DU{pin.role} P{pin.role} VPOS esd", f"DL{pin.role} VNEG P{pin.role} esd"]
            seen.append(pin.role)
    lines += [".control", run]
    for role in seen:
        lines += [f"let m{role.lower()} = vecmax(abs(i(V{role})))", f"print m{role.lower()}"]
    found = amperes([*lines, "quit 0", ".endc"], tmp_path)
    assert len(found) == len(seen) > 15
    assert max(found.values()) < MUX_LIMIT / 5


@pytest.mark.parametrize("element", [1, 7])
def test_inputs_rest_at_the_bridges_supply_while_no_switch_is_closed(element, tmp_path):
    """The multiplexer alone is on: both inputs at 2.7 V within a millionth: the amplifier reads nothing."""
    circuit = netlist(Layout(read("macro-array")))
    board = circuit.of_element("gauge", element).board
    commands = [line for line in closed(circuit, element) if not line.startswith("alter RQ")]
    said = [f"let rest{s} = v(a{board}_in_{s})" for s in ("plus", "minus")]
    found = solved(
        deck(circuit, [*commands, "op", *said, f"let out = v(out{board})", "print restplus restminus out"]),
        tmp_path,
    )
    assert found["restplus"] == pytest.approx(2.7, rel=1e-6) == found["restminus"]
    assert abs(found["out"]) < 1e-6


def test_a_switch_of_each_bridge_takes_its_share_of_the_signal(tmp_path):
    """A 2N7002 of 7.5 ohm in one bridge's return takes 5.9 % of 120 ohm. The paper's MOSFET serves the whole
    array: this says nothing of why Table 1 fits 134 V per strain."""
    circuit = netlist(Layout(variant({"readout.switch": "2N7002"})))
    found = read_all(strained(circuit, {1: 2.1e-6}), tmp_path)
    assert found["output1"] / 1e-6 == pytest.approx(141.4 * 120 / 127.5, rel=1e-3)


@pytest.mark.parametrize("instant", [13e-6, 1e-3, None])
def test_the_grids_warmth_at_the_stated_instant(instant, tmp_path):
    """The gauge's resistance follows its temperature, heat in two capacities as a circuit: ngspice steps
    through a hundred periods of the settled cycle and reads the amplifier at the stated instant."""
    d = variant({} if instant is None else {"readout.instant": instant})
    layout, gauge, power = Layout(d), design_gauge(d), power_of(Layout(d))
    steady = gauge_signal.continuous(2.7, gauge, power)
    at = instants(d)
    heated = "\n".join(warming("exc", "plus", layout))
    deck = f"""* one bridge and its grid's heat
VON on 0 PULSE(0 1 0 1n 1n 5m 50m)
BEXC exc 0 V = 2.7*V(on)
{heated}
RA plus foot 120
RB exc minus 120
RC minus foot 120
RS foot 0 0.021
BO out 0 V = 100*(V(plus) - V(minus))
.options reltol=1e-6 abstol=1e-15
.tran 2u 0.105 0 10u
.control
run
meas tran first FIND v(out) AT={0.1 + at[0] + 2e-8}
meas tran last FIND v(out) AT={0.1 + at[-1]}
print first last
.endc
.end
"""
    found = solved(deck, tmp_path)
    ends = warm_output(Layout(replace(d, readout=replace(d.readout, period=0.05))), at[[0, -1]])
    for value, ours in zip((found["first"], found["last"]), ends):
        assert abs(value) == pytest.approx(abs(float(ours)), rel=0.01, abs=2e-6)
    assert steady.rise > 0 and instant_error(layout) < (6e-6 if instant else 1e-6)


@pytest.mark.parametrize(
    ("changes", "tracks"),
    [
        ({}, False),
        ({}, True),
        ({"readout.gain": 10}, False),
        ({"gauge.resistance": 1000.0}, False),
        ({"readout.amplifier": "AD8221", "readout.multiplexer": "ADG1409"}, False),
        ({"readout.amplifier": "AD620", "readout.gain": 20.0}, False),
        ({"readout.amplifier": "AD623", "readout.gain": 300.0}, False),
    ],
)
def test_the_netlists_noise_is_that_of_mechanics(changes, tracks, tmp_path):
    """ngspice adds up Johnson noise of every resistor and the amplifier's, up to 100 MHz, within 1 %; the
    boards' tracks add nothing to it."""
    design = variant(changes)
    circuit = netlist(Layout(design))
    if tracks:
        circuit = with_tracks(Layout(design), circuit)
    commands = [*closed(circuit, 1), f"noise v(out1) {source(circuit)} dec 100 1 1e8", "print onoise_total"]
    found = solved(deck(circuit, commands), tmp_path)["onoise_total"]
    assert found == pytest.approx(design_readout(design).noise, rel=0.01)


def test_the_noise_of_the_shipped_array_by_hand():
    """AD621: 9 nV/rtHz, 200 kHz at a gain of 100; 120 ohm of bridge and 2 x 25 ohm of multiplexer."""
    density = sqrt(9e-9**2 + 4 * 1.380649e-23 * 300.15 * 170)
    by_hand = 100 * density * sqrt(pi / 2 * 200e3)
    assert design_readout(read("macro-array")).noise == pytest.approx(by_hand, rel=1e-6)
    assert by_hand == pytest.approx(0.513e-3, rel=1e-3)


def test_the_written_deck_reads_every_element(tmp_path):
    found = solved(deck_bytes(netlist(Layout(read("soft-tissue")))).decode(), tmp_path)
    assert set(found) == {f"{what}{n}" for what in ("bridge", "output") for n in range(1, 9)}
    assert all(abs(v) < 1e-7 for v in found.values())


def switched(circuit: Netlist, pulse: str, more: dict[str, list[str]], commands: list[str]) -> str:
    """The deck with the first element's channel addressed and its switch closed while `pulse` is at 1 V;
    `more` lines take the place of the components of these names."""
    switch = circuit.of_element("switch", 1)
    text = deck(circuit, [*(c for c in closed(circuit, 1) if "RQ1" not in c), *commands])
    ohm = switch.figure("ohm")
    more = {"RQ1": [f"SQ1 {switch.net('drain')} {switch.net('source')} on 0 enabled"], **more}
    more["RQ1"] += [f"VON on 0 {pulse}", f".model enabled SW(RON={ohm} ROFF=1e9 VT=0.5 VH=0.1)"]
    lines = ["\n".join(more.get(line.partition(" ")[0], [line])) for line in text.splitlines()]
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("strain", [1e-2, -1e-2])
def test_a_board_has_settled_when_the_first_sample_may_be_taken(strain, tmp_path):
    """Tracks, the multiplexer's and the amplifier's capacitances, from both inputs at EXC: at the stated time
    less what the multiplexer itself takes, the output is within half a step of the converter."""
    design = variant({"array.row_arms": [[5.0]]})
    circuit = strained(with_tracks(Layout(design), netlist(Layout(design))), {1: 2.1 * strain})
    amplifier, lines = circuit.on_board("amplifier", 1), []
    for side in ("plus", "minus"):
        lines.append(f"CIN{side} {amplifier.net(side)} 0 {150e-12 + 2e-12}")
    at = settling_time(design) - 350e-9
    run = ["save v(out1)", "tran 20n 60u", f"meas tran then FIND v(out1) AT={at + 1e-6}"]
    run += ["meas tran end FIND v(out1) AT=59u", "print then end"]
    gauge = next(line for line in deck(circuit, []).splitlines() if line.startswith("RB1 "))
    found = solved(switched(circuit, "PULSE(0 1 1u 1n 1n 1 2)", {"RB1": [gauge, *lines]}, run), tmp_path)
    assert abs(found["end"]) == pytest.approx(1.414, rel=0.02)
    assert abs(found["then"] - found["end"]) < 10 / 2**16 / 2
    assert at < 15e-6


def test_the_boards_warmth_at_the_stated_instants(tmp_path):
    """As above, but of the whole board with its tracks: its output at the first and the last sample."""
    d = variant({"array.row_arms": [[5.0]], "readout.period": 0.05})
    layout = Layout(d)
    circuit, at = with_tracks(layout, netlist(layout)), instants(d)
    grid = circuit.of_element("gauge", 1)
    a, b = grid.net("1"), grid.net("2")
    lines = warming(a, b, layout)
    run = ["save v(out1)", "tran 20u 0.055 0 20u"]
    run += [f"meas tran at{i} FIND v(out1) AT={0.05 + at[i] + 2e-8}" for i in (0, 9)]
    found = solved(
        switched(circuit, "PULSE(0 1 0 1n 1n 5m 50m)", {"RB1": lines}, [*run, "print at0 at9"]), tmp_path
    )
    cold = solved(
        deck(circuit, ["save v(out1)", *closed(circuit, 1), "op", "let cold = v(out1)", "print cold"]),
        tmp_path,
    )
    ends = warm_output(layout, at[[0, -1]])
    for i, ours in zip((0, 9), ends):
        assert found[f"at{i}"] - cold["cold"] == pytest.approx(float(ours), rel=0.01)


LENT = 1e-5  # strain by which a board's own slope is taken
WORST = {"B1": 1, "A1-R11": -1, "A1-R12": 1, "A1-R13": -1}  # which way each arm unbalances the bridge


def resolved(design, count: int, worst: bool, tmp_path) -> float:
    """The smallest force, N, that so many boards tell from none, tracks and all. Their parts are evenly
    spread over their tolerances, or at their ends where they unbalance the bridge most. Each board is read by
    ngspice as it is, with its gauge strained, and after its parts have drifted, every drift's half-width as
    two standard deviations. Twice the root mean square of what they drift and of a reading's noise, by each
    board's own slope."""
    layout, rng = Layout(design), np.random.default_rng(33)
    circuit, r, gauge = with_tracks(layout, netlist(layout)), design.readout, design_gauge(design)
    ohm = {c.designator: c.figure("ohm") for c in circuit.components if c.designator in {*WORST, "W11"}}
    tolerances = dict.fromkeys(WORST, completion_tolerance(design)) | {
        "B1": design.gauge.resistance_tolerance
    }
    middle, late = float(instants(design).mean()), {"hardware": 1e-6, "software": 1e-3}[r.timing]
    commands = ["save v(out1)", *closed(circuit, 1)]

    def even(half: float) -> float:
        return 1 + rng.uniform(-half, half)

    def drifted(*halves: float) -> float:
        return 1 + rng.normal(0, np.hypot.reduce(halves) / 2)

    def warmer(shift: float) -> float:
        """By how much the grid's warmth changes its resistance, samples so many s late."""
        rises = (gauge_signal.warmth(2.7, gauge, power_of(layout), middle + s) for s in (shift, 0.0))
        return 17e-6 * (next(rises) - next(rises))

    def read(name: str, values: dict[str, float], volts: float) -> list[str]:
        lines = [f"alter R{n.replace('-', '_')} = {v!r}" for n, v in values.items()]
        return [
            *lines,
            f"alter {source(circuit)} dc = {volts!r}",
            "op",
            f"let {name} = v(out1)",
            f"print {name}",
        ]

    offsets = []
    for k in range(count):
        sign, span = int(rng.choice([-1, 1])), r.temperature_span
        own = {"W11": ohm["W11"]} | {
            n: ohm[n] * (1 + sign * WORST[n] * t if worst else even(t)) for n, t in tolerances.items()
        }
        volts, gain = r.excitation * even(0.01), circuit.on_board("amplifier", 1).figure("gain") * even(0.01)
        moved = {n: v * drifted(completion_drift(design) * span) for n, v in own.items()}
        moved["B1"] = own["B1"] * drifted(2.1 * design.gauge.thermal_output * span)
        moved["B1"] -= own["B1"] * warmer(rng.normal(0, late / 2))
        moved["W11"] = own["W11"] * drifted(0.0039 * 0.5)
        commands += [f"alter EA1_U1 gain = {gain!r}", *read(f"zero{k}", own, volts)]
        commands += read(f"bent{k}", {"B1": own["B1"] * (1 + 2.1 * LENT)}, volts)
        commands += read(f"end{k}", moved, volts * drifted(r.excitation_drift))
        offsets.append(gain * (drifted(AMPLIFIERS[r.amplifier].drift(r.gain) * span) - 1))
    found = solved(deck(circuit, commands), tmp_path)
    zero, bent, end = (
        np.array([found[f"{name}{k}"] for k in range(count)]) for name in ("zero", "bent", "end")
    )
    foil = float(gauge_signal.foil_strain_per_force(hinge_section(layout, layout.elements), gauge)[0])
    per_force = (bent - zero) / LENT * foil
    commands = [*closed(circuit, 1), f"noise v(out1) {source(circuit)} dec 20 1 1e8", "print onoise_total"]
    sample = np.hypot(solved(deck(circuit, commands), tmp_path)["onoise_total"], 28e-6 * 5)
    parts = (end - zero + offsets) / per_force, sample / 10**0.5 / per_force
    return 2 * float(np.hypot(*(np.mean(part**2) ** 0.5 for part in parts)))


@pytest.mark.slow  # hundreds of boards in ngspice
@pytest.mark.parametrize(
    ("changes", "worst"),
    [
        ({"readout.completion": "film-1", "readout.amplifier": "AD620"}, False),
        ({}, True),
        ({"readout.timing": "software"}, True),
    ],
)
def test_boards_of_parts_within_their_tolerances_resolve_what_is_stated(changes, worst, tmp_path):
    """Boards of 1 % parts, whose arms' drift outweighs all else; and the shipped board at its worst: its
    supply's drift over its bridges' imbalance counts."""
    design = variant({"array.row_arms": [[5.0]], **changes})
    (signal,) = element_signals(Layout(design))
    told = resolved(design, 400, worst, tmp_path)
    assert told == pytest.approx(signal.resolution, rel=0.1)
