"""Gauge, bridge, amplifier, self-heating, stop and rigs at their ends: 50 digits, a limit, or a refusal by
name."""

from __future__ import annotations

import warnings
from dataclasses import replace
from math import exp, inf, isfinite

import mpmath as mp
import numpy as np
import pytest
from hinges import scaled
from variants import variant

from tactcad.design.messages import CheckFailure, InputError
from tactcad.mechanics import gauge_signal, ladder, readout, statics, strain, strength
from tactcad.mechanics.section import REFERENCE
from tactcad.paper.array_model import from_design

EPS = np.finfo(float).eps
ARRAY = from_design(variant())
GAUGE, READOUT, POWER = ARRAY.gauge, ARRAY.readout, ARRAY.power


@pytest.fixture(autouse=True)
def loud():
    with (
        warnings.catch_warnings(),
        np.errstate(over="raise", divide="raise", invalid="raise"),
        mp.workdps(50),
    ):
        warnings.simplefilter("error")
        yield


@pytest.mark.parametrize("x", [-1 + 1e-12, -0.5, -1e-6, -1e-15, 0.0, 1e-15, 1e-6, 0.02, 1.0, 1e6, 1e12])
def test_bridge_is_exact_from_a_broken_to_a_shorted_gauge(x):
    given = mp.mpf(x)
    assert float(readout.bridge_output(x)) == pytest.approx(float(given / (4 + 2 * given)), rel=4 * EPS)
    assert float(readout.bridge_nonlinearity(x)) == pytest.approx(float(-given / (2 + given)), rel=4 * EPS)


@pytest.mark.parametrize("strain_", [0.0, 1e-15, 1e-9, 1e-3, 0.5, -0.4])
def test_output_and_back_wherever_the_amplifier_is_linear(strain_):
    volts = mp.mpf(float(readout.unlimited_output(strain_, GAUGE.factor, READOUT)))
    v = volts / (mp.mpf(READOUT.excitation) * READOUT.gain)
    x = 4 * v / (1 - 2 * v)
    assert float((x - READOUT.bridge_offset) / GAUGE.factor) == pytest.approx(strain_, rel=1e-14, abs=1e-17)
    held = float(readout.output(strain_, GAUGE.factor, READOUT))
    assert READOUT.lowest <= held <= READOUT.highest


@pytest.mark.parametrize(
    "change",
    [
        dict(grid_height=0.0),
        dict(foil_thickness=0.0),
        dict(carrier_modulus=0.0, foil_modulus=0.0),
        dict(carrier_modulus=2e5, grid_height=0.5),
        dict(carrier_width=1e-2),
        dict(carrier_width=20.0),
        dict(foil_coverage=0.0),
    ],
    ids=str,
)
@pytest.mark.parametrize("size", [1.0, 1 / 25], ids=["whole", "jaw"])
def test_gauge_is_a_composite_beam_whatever_its_layers(change, size):
    s, gauge = REFERENCE.with_(two_sided=False, **scaled(size)), replace(GAUGE, **change)
    found = gauge_signal.composite(s, gauge)
    layers, y = [], mp.mpf(float(s.hinge_thickness)) / -2
    for E, b, h in (
        (s.youngs_modulus, s.width, s.hinge_thickness),
        (gauge.carrier_modulus, min(gauge.carrier_width, float(s.width)), gauge.grid_height),
        (gauge.foil_modulus * gauge.foil_coverage, gauge.grid_width, gauge.foil_thickness),
    ):
        E, b, h = mp.mpf(float(E)), mp.mpf(float(b)), mp.mpf(float(h))
        layers.append((E * b, y, y + h))
        y += h
    first = sum(w * (top**2 - low**2) / 2 for w, low, top in layers)
    axis = first / sum(w * (top - low) for w, low, top in layers)
    bending = sum(w * ((top - axis) ** 3 - (low - axis) ** 3) / 3 for w, low, top in layers)
    alone = layers[0][0] * (layers[0][2] - layers[0][1]) ** 3 / 12
    assert float(found.stiffening) == pytest.approx(float(bending / alone), rel=1e-13)
    foil = (layers[2][1] + layers[2][2]) / 2 - axis
    assert float(found.reading) == pytest.approx(
        float(foil / (mp.mpf(float(s.hinge_thickness)) / 2) * alone / bending), rel=1e-12
    )
    K = float(ladder.stiffness(s))
    assert K <= float(gauge_signal.stiffness(s, gauge)) * (1 + 1e-12) < inf


@pytest.mark.parametrize(
    "change,on,period",
    [
        ({}, 1e-6, 1e5),
        ({}, 100.0, 100.0),
        ({}, 1e-6, 1e-5),
        ({}, 100.0, 1e5),
        (dict(grid_height=0.0), 0.005, 1.0),
        (dict(grid_height=0.5), 0.005, 1.0),
        (dict(foil_thickness=0.0, grid_height=0.0), 1e-6, 1e-5),
    ],
    ids=str,
)
def test_switched_gauge_warms_by_its_settled_cycle(change, on, period):
    """The settled cycle by letting it settle, against the code's closed form. The leaf has no heat of its
    own: it is as warm as with power on all the time."""
    gauge, power = replace(GAUGE, **change), replace(POWER, on_time=on, period=period)
    found, steady = gauge_signal.switched(2.7, gauge, power), gauge_signal.continuous(2.7, gauge, power)
    assert all(isfinite(v) for v in (found.power, found.power_density, found.rise, found.drift))
    assert 0.0 <= found.rise <= steady.rise * (1 + 1e-12)
    tau = gauge_signal.time_constant(gauge, power)
    leaf = steady.power * power.leaf_resistance
    if tau == 0.0:
        assert found.rise == leaf
        return
    over_leaf, rise = steady.rise - leaf, 0.0
    for _ in range(200_000 if period < tau else 60):
        rise = rise * exp(-(period - on) / tau)
        before, rise = rise, over_leaf + (rise - over_leaf) * exp(-on / tau)
        if rise == before:
            break
    assert found.rise == pytest.approx(leaf + rise, rel=1e-6)


def test_a_reading_longer_than_its_period_is_refused():
    with pytest.raises(InputError, match="readout.on_time.*legal"):
        gauge_signal.switched(2.7, GAUGE, replace(POWER, on_time=2.0, period=1.0))


@pytest.mark.parametrize("factor", [1e-6, 1e-3, 1.0, 1e3])
def test_signal_is_proportional_until_a_supply_holds_it(factor):
    found = readout.predict(REFERENCE.with_(two_sided=False), GAUGE, READOUT, 0.01 * factor)
    assert np.isfinite(
        [found.per_deflection, found.per_force, found.strain, found.volts, found.resolution]
    ).all()
    assert bool(found.limited) == (factor >= 1e3)
    if not found.limited:
        linear = float(found.per_deflection) * 0.01 * factor
        assert float(found.volts) == pytest.approx(linear * (1 + float(found.nonlinearity)), rel=1e-9)


@pytest.mark.parametrize("size", [1e-3, 1 / 25, 1.0, 1e3])
def test_stop_keeps_its_closing_force_over_size_squared(size):
    s, arm = REFERENCE.with_(**scaled(size)), 7.0 * size
    K = float(ladder.stiffness(s))
    base = float(
        strength.largest_closing_force(REFERENCE, float(ladder.stiffness(REFERENCE)), 7.0, 1e-4, 13.0, 8.0)
    )
    assert float(
        strength.largest_closing_force(s, K, arm, 1e-4 / size, 13.0 * size**2, 8.0 * size**2)
    ) == pytest.approx(base * size**2, rel=1e-12)


def test_stop_at_the_load_line_carries_all_that_is_beyond():
    """arm = L: nothing of the rest reaches the hinge, and the stop may close at the hinge's own limit."""
    K = float(ladder.stiffness(REFERENCE))
    assert float(strength.stress_share(REFERENCE, K, REFERENCE.load_arm, 0.0)) == 0.0
    assert float(strength.deflection_share(REFERENCE, K, REFERENCE.load_arm, 0.0)) == 0.0
    assert float(
        strength.largest_closing_force(REFERENCE, K, REFERENCE.load_arm, 0.0, 1e6, 8.0)
    ) == pytest.approx(8.0, rel=1e-12)


def test_grid_longer_than_a_two_sided_hinge_is_refused_and_a_point_is_its_own_limit():
    two = REFERENCE
    with pytest.raises(CheckFailure, match="grid is longer"):
        strain.gauge(two, 1.0, 5.0)
    points = [float(strain.gauge(two, 1.0, g)) for g in (0.0, 1e-12, 1e-6, 1e-3)]
    assert points == pytest.approx([points[0]] * 4, rel=1e-4)
    one = two.with_(two_sided=False)
    assert (
        0.0
        < float(strain.gauge(one, 1.0, 1e3))
        < float(strain.gauge(one, 1.0, 1e2))
        < float(strain.gauge(one, 1.0, 0.5))
    )


SQUARE = ((25.0, 25.0), (-25.0, 25.0), (-25.0, -25.0), (25.0, -25.0))


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_rig_statics_go_with_size(size):
    contacts = tuple((x * size, y * size) for x, y in SQUARE)
    assert statics.tipping_margin(contacts, 10 * size) == pytest.approx(15 * size, rel=1e-12)
    assert statics.tipping_pull(contacts, 30 * size, 2.0, 3.0, (0, 0)) == pytest.approx(
        5.0 * 25 / 30, rel=1e-12
    )


def test_rig_without_height_load_or_vacuum():
    assert (
        statics.tipping_pull(SQUARE, 0.0, 2.0, 3.0, (0, 0)) == inf
    )  # a pull at the wheels' own height tips nothing
    assert statics.tipping_pull(SQUARE, 30.0, 0.0, 0.0, (0, 0)) == 0.0
    assert statics.holding_force(0.0, 100.0) == 0.0
    assert statics.tipping_margin(SQUARE, 25.0) == pytest.approx(0.0, abs=1e-12)
    assert statics.tipping_margin(SQUARE, 1e6) < 0.0
