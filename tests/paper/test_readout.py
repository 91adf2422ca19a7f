"""Gauge, bridge and self-heating against nodal analysis, numerical integration and statistics."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from variants import variant

from tactcad.mechanics import gauge_signal, ladder, readout, strain
from tactcad.mechanics.gauge_signal import Gauge, Power
from tactcad.mechanics.readout import ReadOut
from tactcad.mechanics.section import REFERENCE

GAUGE = Gauge(
    factor=2.1,
    grid_length=0.5,
    grid_width=0.65,
    grid_height=0.03,
    carrier_width=1.5,
    carrier_modulus=3000.0,
    foil_thickness=0.005,
    foil_modulus=162000.0,
    foil_coverage=0.5,
)
READOUT = ReadOut(
    excitation=2.7,
    gain=100.0,
    supply_positive=5.0,
    supply_negative=-5.0,
    headroom=1.5,
    bridge_offset=0.0,
    noise=5e-4,
    adc_bits=16,
    adc_range=5.0,
    samples=10,
)
POWER = Power(
    resistance=120.0,
    conductivity=0.2,
    resistance_per_kelvin=-17e-6,
    reference_mismatch=0.2,
    on_time=0.005,
    period=1.0,
)


def solved_bridge(x):
    """Output over supply by Kirchhoff's laws: nodes a and b between 120 ohm resistors, the upper left
    one active.
    """
    R = 120.0
    conductance = np.array([[1 / (R * (1 + x)) + 1 / R, 0], [0, 2 / R]])
    a, b = np.linalg.solve(conductance, np.array([1 / R, 1 / R]))  # the active gauge from node a to ground
    return a - b


@pytest.mark.parametrize("x", [-0.05, -1e-3, 1e-9, 1e-3, 0.0133, 0.1])
def test_quarter_bridge_is_exact(x):
    assert float(readout.bridge_output(x)) == pytest.approx(solved_bridge(x), rel=1e-6, abs=1e-16)
    assert float(readout.bridge_nonlinearity(x)) == pytest.approx(
        solved_bridge(x) / (x / 4) - 1, rel=1e-4, abs=1e-7
    )
    v = float(readout.bridge_output(x))
    assert 4 * v / (1 - 2 * v) == pytest.approx(x, rel=1e-12)


def test_volts_give_the_strain_back_with_an_offset():
    r = replace(READOUT, bridge_offset=-0.03)
    eps = np.linspace(-5e-3, 5e-3, 7)
    v = readout.unlimited_output(eps, 2.1, r) / (r.excitation * r.gain)
    assert (4 * v / (1 - 2 * v) + 0.03) / 2.1 == pytest.approx(eps, abs=1e-14)
    step = 1e-7
    slope = (
        readout.unlimited_output(2e-3 + step, 2.1, r) - readout.unlimited_output(2e-3 - step, 2.1, r)
    ) / (2 * step)
    assert float(readout.volts_per_strain(2.1, r, 2e-3)) == pytest.approx(float(slope), rel=1e-6)


def test_three_per_cent_of_offset_gives_the_paper_s_largest_zero_signal():
    """V0 = -2.14 V: U G x/(4 + 2x) = -2.14 at x = -3 %."""
    assert 270.0 * float(readout.bridge_output(-0.0312)) == pytest.approx(-2.14, abs=0.015)


def test_output_is_held_at_supply_and_converter():
    assert float(readout.output(0.2, 2.1, READOUT)) == 3.5
    assert float(readout.output(-0.2, 2.1, READOUT)) == -3.5
    assert float(readout.output(0.2, 2.1, replace(READOUT, adc_range=1.0))) == 1.0


def test_averaged_noise_against_simulated_samples():
    rng = np.random.default_rng(0)
    r = replace(READOUT, noise=2e-4, adc_bits=14)
    step = 10.0 / 2**14
    level = rng.uniform(0, step, (20000, 1))
    samples = np.round((level + r.noise * rng.standard_normal((20000, r.samples))) / step) * step
    assert (samples.mean(1) - level[:, 0]).std() == pytest.approx(r.averaged_noise, rel=0.05)


def test_composite_section_against_fine_layers():
    """Moment and neutral axis by summing 200 000 thin layers."""
    t, b, E = 0.25, 3.0, 69000.0
    layers = [
        (0.0, t, E * b),
        (t, GAUGE.grid_height, GAUGE.carrier_modulus * GAUGE.carrier_width),
        (
            t + GAUGE.grid_height,
            GAUGE.foil_thickness,
            GAUGE.foil_modulus * GAUGE.foil_coverage * GAUGE.grid_width,
        ),
    ]
    n = 20000
    y = np.concatenate([a + (np.arange(n) + 0.5) * h / n for a, h, _ in layers])
    w = np.concatenate([np.full(n, e * h / n) for _, h, e in layers])
    axis = (w * y).sum() / w.sum()
    bending = (w * (y - axis) ** 2).sum()
    found = gauge_signal.composite(REFERENCE, GAUGE)
    assert float(found.stiffening) == pytest.approx(bending / (E * b * t**3 / 12), rel=1e-6)
    foil = t + GAUGE.grid_height + GAUGE.foil_thickness / 2
    assert float(found.reading) == pytest.approx((foil - axis) / bending * (E * b * t**2 / 6), rel=1e-6)


def test_without_a_gauge_nothing_changes():
    none = replace(GAUGE, grid_height=0.0, foil_thickness=0.0, carrier_modulus=0.0)
    assert float(gauge_signal.composite(REFERENCE, none).stiffening) == pytest.approx(1.0, rel=1e-12)
    assert float(gauge_signal.composite(REFERENCE, none).reading) == pytest.approx(1.0, rel=1e-12)
    assert float(gauge_signal.stiffness(REFERENCE, none)) == pytest.approx(
        float(ladder.stiffness(REFERENCE)), rel=1e-12
    )
    assert float(gauge_signal.foil_strain_per_force(REFERENCE, none)) == pytest.approx(
        float(strain.gauge(REFERENCE, 1.0, 0.5)), rel=1e-12
    )


def test_a_stiff_backing_far_from_the_face_reads_at_most_one_plus_two_h_over_t():
    """Fabrication notes: 1 + 2h/t is the upper bound, since the gauge also stiffens the leaf."""
    found = gauge_signal.composite(REFERENCE, GAUGE)
    assert 1.0 < float(found.reading) < 1 + 2 * (GAUGE.grid_height + GAUGE.foil_thickness) / 0.25


def test_leaf_share_is_the_leaf_s_part_of_the_compliance():
    """A short-hinge model is all leaf; a model with arm and roots has less."""
    assert float(gauge_signal.leaf_share(REFERENCE, "short")) == pytest.approx(1.0, abs=1e-6)
    assert 0.7 < float(gauge_signal.leaf_share(REFERENCE)) < 1.0


def test_short_hinge_strain_per_deflection_is_geometric():
    """6 F L/(E b t^2) over F/K with K = E b t^3/(12 l L^2) is t/(2 l L)."""
    none = replace(GAUGE, grid_height=0.0, foil_thickness=0.0, carrier_modulus=0.0)
    ratio = strain.nominal(REFERENCE, 1.0) * gauge_signal.stiffness(REFERENCE, none, "short")
    assert float(ratio) == pytest.approx(0.25 / (2 * 0.75 * 6.0), rel=1e-9)


def test_self_heating_against_integration_of_the_cycle():
    """C dT/dt = P(t) - T/R through many periods, by small steps."""
    power = replace(POWER, on_time=0.004, period=0.02)
    tau, resistance = gauge_signal.time_constant(GAUGE, power), gauge_signal.thermal_resistance(GAUGE, power)
    watts = (2.7 / 2) ** 2 / 120
    dt, temperature, warmest = 2e-6, 0.0, 0.0
    for i in range(round(10 * power.period / dt)):
        on = (i * dt) % power.period < power.on_time
        temperature += dt / tau * ((watts if on else 0.0) * resistance - temperature)
        warmest = max(warmest, temperature) if i * dt > 8 * power.period else 0.0
    assert gauge_signal.switched(2.7, GAUGE, power).rise == pytest.approx(warmest, rel=2e-3)


def test_power_always_on_is_the_limit_of_switching():
    always = gauge_signal.continuous(2.7, GAUGE, POWER)
    assert always.power == pytest.approx(2.7**2 / 4 / 120)
    assert always.rise == pytest.approx(always.power * 0.03e-3 / (0.2 * 0.5e-3 * 0.65e-3))
    assert gauge_signal.switched(2.7, GAUGE, replace(POWER, on_time=0.999999)).rise == pytest.approx(
        always.rise, rel=1e-3
    )
    assert gauge_signal.switched(2.7, GAUGE, replace(POWER, on_time=1e-4)).rise < 0.05 * always.rise


def test_a_leaf_that_conducts_badly_warms_the_grid():
    """Against the conduction equation solved by finite differences along the leaf, heat under its middle."""
    length, t, b = 0.88, 0.25, 3.0
    for conductivity in (130.0, 6.7):
        n = 401  # nodes from the arm's end, which is insulated, to the body's, which is at 0
        dx = length * 1e-3 / (n - 1)
        matrix = np.diag(np.full(n, -2.0)) + np.diag(np.ones(n - 1), 1) + np.diag(np.ones(n - 1), -1)
        matrix[0, :2], matrix[-1] = (-1.0, 1.0), 0.0
        matrix[-1, -1] = 1.0
        heat = np.zeros(n)
        heat[n // 2] = -dx / (conductivity * t * b * 1e-6)  # one watt
        middle = np.linalg.solve(matrix, heat)[n // 2]
        leaf = gauge_signal.leaf_resistance(length, t, b, conductivity)
        assert leaf == pytest.approx(middle, rel=1e-9)
        warm = gauge_signal.continuous(2.7, GAUGE, replace(POWER, leaf_resistance=leaf))
        bare = gauge_signal.continuous(2.7, GAUGE, POWER)
        assert warm.rise - bare.rise == pytest.approx(leaf * bare.power)
        on = gauge_signal.switched(2.7, GAUGE, replace(POWER, leaf_resistance=leaf)).rise
        assert gauge_signal.switched(2.7, GAUGE, POWER).rise < on < warm.rise


def test_the_design_s_own_sheet_conducts_the_heat():
    from tactcad.design.materials import ALLOYS
    from tactcad.paper.array_model import from_design

    shares = {}
    for alloy in ("7075-T6", "Ti-6Al-4V-annealed"):
        row = ALLOYS[alloy]
        names = ("youngs_modulus", "poisson", "density", "yield_strength", "fatigue_strength")
        changes = {f"material.{name}": getattr(row, name) for name in names}
        power = from_design(variant({"material.alloy": alloy, **changes})).power
        shares[alloy] = power.leaf_resistance
        assert power.leaf_resistance == pytest.approx(0.44 / (row.conductivity * 0.25 * 3.0) * 1e3)
    assert shares["Ti-6Al-4V-annealed"] > 15 * shares["7075-T6"]
