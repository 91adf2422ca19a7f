"""Separate springs: the paper's equations, late contact, closed stops."""

from __future__ import annotations

from math import inf

import numpy as np
import pytest

from tactcad.contact.springs import press
from tactcad.mechanics import lumped

K = np.array([2.0, 8.0, 40.0])
FREE = np.full(3, inf)


@pytest.mark.parametrize("x", [0.01, 2.34, 10.01, 1e6])
def test_level_elements_deflect_by_the_papers_equations(x):
    approach, force, sink = press(K, np.zeros(3), FREE, x, 1.5)
    assert force.sum() == pytest.approx(1.5) and force == pytest.approx(K * sink)
    assert sink == pytest.approx(lumped.element_deflection(K, x, approach))
    assert sink[0] / sink[2] == pytest.approx(lumped.deflection_ratio(K[2], K[0], x))


def test_a_face_that_lies_back_is_met_later():
    back = np.array([0.0, 0.1, 0.4])
    approach, force, _ = press(K, back, FREE, 4.0, 0.6)
    spring = K * 4.0 / (K + 4.0)
    assert force == pytest.approx(spring * np.maximum(approach - back, 0.0))
    assert force[2] == 0.0


def test_a_stop_leaves_the_objects_spring_alone():
    approach, force, sink = press(K, np.zeros(3), np.array([0.1, inf, inf]), 4.0, 3.0)
    assert sink[0] == 0.1 and force[0] == pytest.approx(4.0 * (approach - 0.1))
    assert force.sum() == pytest.approx(3.0)
