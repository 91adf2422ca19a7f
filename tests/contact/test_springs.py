"""Separate springs: the paper's equations, late contact, closed stops."""

from __future__ import annotations

from math import inf

import numpy as np
import pytest
from scipy.optimize import brentq

from tactcad.contact.springs import press
from tactcad.mechanics import lumped

K = np.array([2.0, 8.0, 40.0])


def pressed(x: float, load: float, **freedom: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    approach, force, sink = press(K, x, np.array([load]), **freedom)
    return float(approach[0]), force[:, 0], sink[:, 0]


@pytest.mark.parametrize("x", [0.01, 2.34, 10.01, 1e6])
def test_level_elements_deflect_by_the_papers_equations(x):
    approach, force, sink = pressed(x, 1.5)
    assert force.sum() == pytest.approx(1.5) and force == pytest.approx(K * sink)
    assert sink == pytest.approx(lumped.element_deflection(K, x, approach))
    assert sink[0] / sink[2] == pytest.approx(lumped.deflection_ratio(K[2], K[0], x))


def test_a_face_that_lies_back_is_met_later():
    back = np.array([0.0, 0.1, 0.4])
    approach, force, _ = pressed(4.0, 0.6, back=back)
    spring = K * 4.0 / (K + 4.0)
    assert force == pytest.approx(spring * np.maximum(approach - back, 0.0))
    assert force[2] == 0.0


def test_a_stop_leaves_the_objects_spring_alone():
    approach, force, sink = pressed(4.0, 3.0, stop=np.array([0.1, inf, inf]))
    assert sink[0] == 0.1 and force[0] == pytest.approx(4.0 * (approach - 0.1))
    assert force.sum() == pytest.approx(3.0)


def test_any_loads_on_any_springs_are_borne_as_a_root_finder_says():
    """Stops and late touches by chance: the approach is the root of the forces' sum."""
    rng = np.random.default_rng(3)
    for _ in range(50):
        k, x = rng.lognormal(1, 2, 8), float(rng.lognormal(1, 2))
        back, stop = rng.exponential(0.2, 8), np.where(rng.random(8) < 0.5, rng.exponential(0.2, 8), inf)

        def forces(approach: float) -> np.ndarray:
            depth = np.maximum(approach - back, 0.0)
            return np.maximum(depth * k * x / (k + x), x * (depth - stop))

        load = np.sort(rng.exponential(2.0, 5))
        approach, force, sink = press(k, x, load, back, stop)
        for i, n in enumerate(load):
            furthest = back.max() + n * (1 / x + 1 / k.min())
            assert approach[i] == pytest.approx(
                brentq(lambda z: forces(z).sum() - n, 0.0, furthest), rel=1e-9
            )
            assert force[:, i] == pytest.approx(forces(approach[i]), rel=1e-9, abs=1e-12)
            assert (sink[:, i] <= stop).all()
