"""Effects of bridge, leads, gauge and amplifier, at the first load of a grasp."""

from __future__ import annotations

from math import log10, nan

import numpy as np

from tactcad.lab.simulate import approach
from tactcad.mechanics import gauge_signal, readout, self_heating
from tactcad.paper.array_model import ArrayModel
from tactcad.paper.budget_effect import BudgetPair, Effect
from tactcad.paper.budget_rig import GRASP_TIME, SAMPLE_TEST_TIME
from tactcad.paper.grasp_figures import elements_in_parallel
from tactcad.paper.published import Published


def signal(pair: BudgetPair, data: Published, array: ArrayModel) -> list[Effect]:
    """Bridge, noise, and the gauge's own warmth, at the first load of a grasp."""
    truth, reference = elements_in_parallel(data, array)
    K = truth.stiffness.copy()
    K[reference] = pair.K_r
    _, deflection = approach(np.array([array.rig.moving_weight]), K, pair.x)
    d = np.array([deflection[reference, 0], deflection[int(np.argmin(np.abs(K - pair.K_m))), 0]])
    q = np.array(
        [gauge_signal.foil_strain_per_deflection(s, array.gauge).item() for s in (pair.short, pair.long)]
    )
    factor = array.gauge.factor
    bend = np.abs(readout.bridge_nonlinearity(factor * q * d))
    per_mm = readout.volts_per_strain(factor, array.readout) * q
    noise = float(((array.readout.averaged_noise / (per_mm * d)) ** 2).sum() ** 0.5)
    drift = abs(self_heating.continuous(array.readout.excitation, array.gauge, array.power).drift)
    warm = float((drift / (factor * q * d)).max())
    lead = array.tolerance.zero_drift / (factor * q * d)
    leads = pair.by_ratio * float((lead**2).sum() ** 0.5)
    slope = array.rig.moving_weight / (array.rig.weight * max(array.rig.weights, 1))
    creep = pair.by_ratio * 2**0.5 * array.tolerance.creep
    at = f"at the first load, {array.rig.moving_weight:g} N"
    return [
        Effect(
            "bridge non-linearity",
            f"quarter bridge {at}",
            nan,
            nan,
            pair.by_ratio * float(abs(bend[1] - bend[0])),
            "invert the bridge exactly",
            0.0,
        ),
        Effect(
            "noise of the averaged reading",
            f"{array.readout.averaged_noise * 1e3:.2g} mV {at}, two standard deviations",
            nan,
            nan,
            pair.by_ratio * 2 * noise,
            "slope over all weights",
            pair.by_ratio * 2 * noise * array.rig.moving_weight / max(_span(array), 1e-9),
        ),
        Effect(
            "zero drift of the leads",
            f"{array.tolerance.zero_drift:.2g} of dR/R {at}, each bridge for itself, R of totals",
            nan,
            nan,
            leads,
            "slopes over all weights: what drifts meanwhile",
            leads * min(slope, 1.0),
        ),
        Effect(
            "gauges creep",
            f"{array.tolerance.creep:.1%} of the signal a decade, {SAMPLE_TEST_TIME:g} s to "
            f"{GRASP_TIME:g} s, each for itself",
            nan,
            nan,
            creep * log10(GRASP_TIME / SAMPLE_TEST_TIME),
            "the same wait before each reading, within a factor of two",
            creep * log10(2),
        ),
        Effect(
            "gauge warms itself",
            f"power on all the time; drift against the signal {at}, R of totals",
            nan,
            nan,
            pair.by_ratio * warm,
            "power on only while reading; slopes, since what is left is the same in each reading",
            0.0,
        ),
    ]


def _span(array: ArrayModel) -> float:
    """Root sum of squares of the loads about their mean, N, by which a slope's noise is divided."""
    n = array.rig.weights + 1
    return array.rig.weight * ((n**2 - 1) * n / 12) ** 0.5
