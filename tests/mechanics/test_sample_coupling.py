"""Pads on one sample: limits of the elastic layer, reciprocity, independent springs."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_bvp

from tactcad.mechanics import lumped as sc


def test_far_pads_on_a_half_space_feel_a_point_load():
    """u = (1 - nu^2) F/(pi E r); a square's own mean displacement under even pressure is 0.473 times
    2 (1 - nu^2) F/(E a) (Love 1929), so far away the share is a/(2 pi 0.473 r)."""
    shares = sc.influence(np.array([8.0]), np.array([0.0]), 1.0, 1.0, np.inf, 0.49)
    assert shares[0] == pytest.approx(1 / (2 * np.pi * 0.473 * 8.0), rel=0.03)


def test_own_share_is_one_and_far_shares_fade():
    d = np.array([0.0, 4.0, 8.0, 12.0])
    shares = sc.influence(d, 0 * d, 2.0, 3.0, 6.0, 0.49)
    assert shares[0] == 1.0 and np.abs(shares[1:]).max() < 0.2 and abs(shares[3]) < 0.02


def test_a_thick_layer_is_a_half_space_and_a_thin_one_a_row_of_springs():
    d = np.array([0.0, 4.0])
    thick = sc.influence(d, 0 * d, 2.0, 3.0, 500.0, 0.49)
    half = sc.influence(d, 0 * d, 2.0, 3.0, np.inf, 0.49)
    assert thick[1] == pytest.approx(half[1], abs=0.01)
    assert abs(sc.influence(d, 0 * d, 2.0, 3.0, 0.5, 0.3)[1]) < 5e-3


def test_layer_factor_against_its_limits():
    """Compressible thin layer: phi -> c (1 - 2 nu)/(2 (1 - nu)^2), so that the surface sinks as a
    bonded film, sigma h (1 + nu)(1 - 2 nu)/(E (1 - nu)); incompressible: phi -> (2c)^3/12.
    """
    c = 1e-3
    assert float(sc.layer_factor(np.array([c]), 0.3)[0]) == pytest.approx(c * 0.4 / (2 * 0.7**2), rel=1e-4)
    c = 1e-2
    assert float(sc.layer_factor(np.array([c]), 0.5)[0]) == pytest.approx((2 * c) ** 3 / 12, rel=1e-3)
    assert float(sc.layer_factor(np.array([1000.0]), 0.4)[0]) == 1.0


def test_shares_run_on_smoothly_where_the_sum_ends():
    for thickness in (6.0, np.inf):
        near, far = sc.influence(np.array([49.9, 50.1]), np.zeros(2), 2.0, 3.0, thickness, 0.49)
        assert near == pytest.approx(far, abs=1e-3)


def test_far_shares_of_long_rows_fade_as_one_over_distance():
    """Distances of which some, scaled back to where the sum ends, are an ulp beyond that: rows of pads 4.5, 5
    and 2.5 mm apart, two rows 4 mm apart. Along a line from the loaded pad a share goes as 1/r."""
    for pitch, count in ((4.5, 50), (5.0, 45), (2.5, 89)):
        along = pitch * np.arange(count - 2, count + 3)
        for across in (0.0, 4.0):
            far = sc.influence(np.full(len(along), across), along, 2.0, 3.0, np.inf, 0.5)
            farther = sc.influence(np.full(len(along), 2 * across), 2 * along, 2.0, 3.0, np.inf, 0.5)
            assert farther == pytest.approx(far / 2.0, rel=1e-9) and (far > 0.0).all()


@pytest.mark.parametrize("c, poisson", [(0.3, 0.2), (1.0, 0.3), (1.5, 0.49), (3.0, 0.4)])
def test_layer_factor_against_the_equations_of_elasticity(c, poisson):
    """One wave of normal load on a layer of height 1, u = U(z) sin cx, w = W(z) cos cx, solved as a
    boundary-value problem: W(1) = 2 (1 - nu^2)/E phi/c."""
    mu, lam = 1 / (2 * (1 + poisson)), poisson / ((1 + poisson) * (1 - 2 * poisson))  # E = 1

    def slope(z, y):
        U, dU, W, dW = y
        ddU = c * c * U + (lam + mu) / mu * c * (c * U + dW)
        ddW = (mu * c * c * W - (lam + mu) * c * dU) / (lam + 2 * mu)
        return np.array([dU, ddU, dW, ddW])

    def ends(low, top):
        shear = top[1] - c * top[2]
        normal = lam * (c * top[0] + top[3]) + 2 * mu * top[3] - 1
        return np.array([low[0], low[2], shear, normal])

    found = solve_bvp(slope, ends, np.linspace(0, 1, 60), np.zeros((4, 60)), tol=1e-8, max_nodes=20000)
    assert found.success
    W = found.y[2, -1]
    assert float(sc.layer_factor(np.array([c]), poisson)[0]) == pytest.approx(
        W * c / (2 * (1 - poisson**2)), rel=1e-6
    )


def test_elements_far_apart_are_independent_springs():
    K, x = np.array([80.0, 10.0, 6.0]), np.array([0.0, 45.0, 3000.0])
    found = sc.coupling(K, x, 0 * x, 5.0, 0, 2.0, 3.0, 6.0, 0.49)
    assert found.stiffness == pytest.approx(1.0, abs=1e-3)
    assert found.ratio == pytest.approx(np.ones(3), abs=1e-3)


def test_a_neighbour_softens_an_array_on_a_half_space():
    """Two equal pads side by side: each sinks by its own and its neighbour's share, 1/(1/K + (1 + s)/x)
    each.
    """
    s = float(sc.influence(np.array([4.0]), np.array([0.0]), 2.0, 3.0, np.inf, 0.49)[0])
    found = sc.coupling(
        np.array([20.0, 20.0]), np.array([0.0, 4.0]), np.zeros(2), 5.0, 0, 2.0, 3.0, np.inf, 0.49
    )
    assert found.stiffness == pytest.approx((1 / 20 + 1 / 5) / (1 / 20 + (1 + s) / 5), rel=1e-9)
