"""The deck of a converter's boards, solved by ngspice, against closed forms blind to the netlist."""

from __future__ import annotations

from math import hypot

import numpy as np
import pytest
from ngspice import solved
from test_ngspice import bridge, read_all, source, strained, warming
from variants import variant

from tactcad.circuit.bridges import netlist
from tactcad.circuit.digital_readout import digital_readout
from tactcad.circuit.element_signals import element_signals
from tactcad.circuit.netlist import Netlist
from tactcad.circuit.netlist_files import deck, inputs_of
from tactcad.circuit.tracks import with_tracks
from tactcad.export.board_files import deck_file
from tactcad.mechanics import gauge_signal
from tactcad.parts.array.bridge_figures import power_of
from tactcad.parts.array.hinge_section import design_gauge, hinge_section
from tactcad.parts.array.layout import Layout
from tactcad.parts.bought.electronic_parts import completion_drift, completion_tolerance

CHIP = "AD7124-8"
ONE = {"readout.converter": CHIP, "array.row_arms": [[5.0]]}


def nodes(circuit: Netlist) -> tuple[str, str, str]:
    """What the first converter reads the first element between, and takes for its reference."""
    converter = circuit.on_board("converter", 1)
    return (*inputs_of(converter, 1), converter.net("REFIN1+"))


def test_the_written_deck_reads_every_element(tmp_path):
    """Tracks and all: what they unbalance a bridge by is less than a tenth of the gauges' 0.3 %."""
    design = variant({"readout.converter": CHIP, "array.row_arms": [[4, 7, 6], [5] * 9]})
    found = solved(deck_file(design, netlist(Layout(design))).decode(), tmp_path)
    assert set(found) == {f"{what}{n}" for what in ("bridge", "ratio") for n in range(1, 13)}
    assert all(abs(found[f"ratio{n}"]) < 0.1 * 0.003 / 4 for n in range(1, 13))


@pytest.mark.parametrize("connection", ["three-wire", "two-wire"])
@pytest.mark.parametrize("ohm", [120.0, 1000.0])
def test_bridges_agree_with_dividers(connection, ohm, tmp_path):
    """Each element's own strain; the ratio to the bridges' supply, and the slope that the figures take."""
    changes = {"readout.converter": CHIP, "readout.connection": connection, "gauge.resistance": ohm}
    layout = Layout(variant({**changes, "wiring.to_board": 1500.0}))
    circuit, found = netlist(layout), digital_readout(layout, CHIP)
    x = {n: 1e-3 * (n - 5) for n in range(1, 11)}
    read, flat = read_all(strained(circuit, x), tmp_path), read_all(circuit, tmp_path)
    for n in x:
        lead = circuit.of_element("lead", n).figure("mm") * 1.361e-3
        exact = bridge(found.excitation, ohm, x[n], lead, 0.0, connection == "three-wire")
        assert read[f"bridge{n}"] == pytest.approx(exact, abs=1e-9)
        assert read[f"ratio{n}"] * found.excitation == pytest.approx(exact, abs=1e-9)
        if n != 5:
            slope = (read[f"bridge{n}"] - flat[f"bridge{n}"]) / (x[n] / 2.1) * (1 + x[n] / 2)
            assert slope == pytest.approx(found.per_strain, rel=1e-3)


def test_the_tracks_take_nothing_of_the_signal(tmp_path):
    layout = Layout(variant({"readout.converter": CHIP}))
    circuit = with_tracks(layout, netlist(layout))
    ends = [read_all(strained(circuit, dict.fromkeys(range(1, 11), x)), tmp_path) for x in (-1e-4, 1e-4)]
    for n in range(1, 11):
        per_strain = (ends[1][f"bridge{n}"] - ends[0][f"bridge{n}"]) / 2e-4 * 2.1
        assert per_strain == pytest.approx(digital_readout(layout, CHIP).per_strain, rel=1e-3)


@pytest.mark.parametrize("ohm", [120.0, 1000.0])
def test_the_boards_noise_is_what_the_figures_take(ohm, tmp_path):
    """Johnson noise up to half the rate, by ngspice on tracks and all, and the converter's own 53 nV."""
    layout = Layout(variant({**ONE, "gauge.resistance": ohm}))
    circuit, found = with_tracks(layout, netlist(layout)), digital_readout(layout, CHIP)
    plus, minus, _ = nodes(circuit)
    run = [
        f"noise v({plus},{minus}) {source(circuit)} dec 20 {found.rate / 2e4} {found.rate / 2}",
        "print onoise_total",
    ]
    bridge = solved(deck(circuit, run), tmp_path)["onoise_total"]
    own = 23e-9 * (50 / 9.4) ** 0.5 * 128 / found.gain
    assert found.noise == pytest.approx(hypot(own, bridge), rel=2e-3) and bridge > 0.1 * own


@pytest.mark.parametrize("late", [0.0, 5e-3])
def test_a_bridge_is_warm_when_its_first_result_begins(late, tmp_path):
    """ON switches the current of the SET pin: the supply rises over 0.1 uF, the grid warms, tracks and all.
    What the ratio still moves from the first input's turn on, ON late by 5 ms or not, is not to be told from
    the noise."""
    layout = Layout(variant({**ONE, "readout.power": "duty"}))
    circuit, found = with_tracks(layout, netlist(layout)), digital_readout(layout, CHIP)
    a, b = (p.net for p in circuit.of_element("gauge", 1).pins)
    tau = gauge_signal.time_constant(design_gauge(layout.design), power_of(layout))
    regulator = circuit.on_board("regulator", 1)
    set_net, out = regulator.net("set"), regulator.net("out")
    more = {
        source(circuit): [
            f"ION 0 {set_net} PULSE(0 100u {1e-3 + late} 1n 1n 1 2)",
            f"EON {out} 0 {set_net} 0 1",
        ],
        "RB1": warming(a, b, layout),
    }
    plus, minus, reference = nodes(circuit)
    run = [
        f"save v({plus}) v({minus}) v({reference})",
        "tran 50u 0.13 0 50u",
        f"let out = v({plus}) - v({minus})",
    ]
    for name, t in (("first", 1e-3 + found.warm_up), ("last", 0.129), ("early", 1e-3 + late + tau)):
        run += [f"meas tran {name} FIND out AT={t}", f"meas tran {name}on FIND v({reference}) AT={t}"]
    text = deck(circuit, [*run, "print first last early firston laston earlyon"]).splitlines()
    lines = ["\n".join(more.get(line.partition(" ")[0], [line])) for line in text]
    lines[1:1] = [".options reltol=1e-5 abstol=1e-12 vntol=1e-9"]
    read = solved("\n".join(lines) + "\n", tmp_path)
    assert read["laston"] == pytest.approx(found.excitation, rel=1e-4)  # 26 mA through tracks and vias
    first, last, early = (
        read[name] / read[f"{name}on"] * found.excitation for name in ("first", "last", "early")
    )
    assert abs(first - last) < found.noise / 4 and abs(early - last) > 20 * found.noise


LENT = 1e-5  # strain by which a board's own slope is taken


@pytest.mark.by_day(1, "many runs of ngspice each")
@pytest.mark.parametrize("changes", [{"readout.completion": "film-1"}, {"readout.power": "duty"}])
def test_boards_within_their_tolerances_resolve_what_is_stated(changes, tmp_path):
    """400 boards of parts evenly spread over their tolerances, each read as it is, strained, and after its
    parts have drifted, every drift's half-width as two standard deviations; the supply drifts too, which the
    ratio does not feel. Twice the root mean square of drift and noise, by each board's own slope."""
    layout, rng, count = Layout(variant({**ONE, **changes})), np.random.default_rng(33), 400
    design, found = layout.design, digital_readout(layout, CHIP)
    circuit, span = with_tracks(layout, netlist(layout)), design.readout.temperature_span
    names = ("W11", "B1", "A1-R11", "A1-R12", "A1-R13")
    ohm = {c.designator: c.figure("ohm") for c in circuit.components if c.designator in names}
    tolerance = {n: completion_tolerance(design) for n in ohm} | {"B1": 0.003, "W11": 0.0}
    drifts = {n: completion_drift(design) * span for n in ohm} | {"B1": 2.1e-6 * span, "W11": 0.0039 * 0.5}
    plus, minus, reference = nodes(circuit)
    commands = [f"save v({plus}) v({minus}) v({reference})"]

    def read(name: str, values: dict[str, float], volts: float) -> list[str]:
        lines = [f"alter R{n.replace('-', '_')} = {v!r}" for n, v in values.items()]
        ratio = f"let {name} = (v({plus}) - v({minus}))/v({reference})"
        return [*lines, f"alter {source(circuit)} dc = {volts!r}", "op", ratio, f"print {name}"]

    for k in range(count):
        own = {n: v * (1 + rng.uniform(-tolerance[n], tolerance[n])) for n, v in ohm.items()}
        volts = found.excitation * (1 + rng.uniform(-0.01, 0.01))
        moved = {n: v * (1 + rng.normal(0, drifts[n] / 2)) for n, v in own.items()}
        commands += read(f"zero{k}", own, volts)
        commands += read(f"bent{k}", {"B1": own["B1"] * (1 + 2.1 * LENT)}, volts)
        commands += read(f"end{k}", moved, volts * (1 + rng.normal(0, 5e-4)))
    ratio = solved(deck(circuit, commands), tmp_path)
    zero, bent, end = (
        np.array([ratio[f"{name}{k}"] for k in range(count)]) for name in ("zero", "bent", "end")
    )
    section, gauge = hinge_section(layout, layout.elements), design_gauge(design)
    foil = float(gauge_signal.foil_strain_per_force(section, gauge)[0])
    per_force = (bent - zero) / LENT * foil * found.excitation
    moved_by = (end - zero) * found.excitation + rng.normal(0, 10e-9 * span / 2, count)
    told = 2 * hypot(np.mean((moved_by / per_force) ** 2) ** 0.5, found.noise / np.abs(per_force).mean())
    (signal,) = element_signals(layout)
    assert told == pytest.approx(signal.resolution, rel=0.1)
