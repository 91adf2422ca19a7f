"""A disc magnet's field and what a chip feels, against closed forms, the dipole and differences."""

from __future__ import annotations

import numpy as np
import pytest

from tactcad.families.planar.field import MU0, Magnet, felt, field, pull, sensitivity

DISC = Magnet(0.75, 1.0, 1.2)


def on_axis(magnet: Magnet, z: float) -> float:
    """Closed form, z below the lower face, mT: Br/2 ((z + m)/sqrt((z + m)^2 + R^2) - z/sqrt(z^2 + R^2))."""
    far, R = z + magnet.height, magnet.radius
    return 500.0 * magnet.remanence * (far / np.hypot(far, R) - z / np.hypot(z, R))


@pytest.mark.parametrize("z", [0.4, 1.5, 5.0])
def test_on_its_axis_it_is_the_closed_form(z):
    assert field(DISC, np.array([0.0, 0.0, -z])) == pytest.approx(
        [0, 0, on_axis(DISC, z)], rel=1e-6, abs=1e-9
    )


def test_far_away_it_is_a_dipole():
    """B = mu0/(4 pi) (3 n (n m) - m)/r^3, m = Br V/mu0."""
    at = np.array([30.0, 10.0, -40.0])
    r = np.linalg.norm(at - [0, 0, 0.5])
    n = (at - [0, 0, 0.5]) / r
    m = 1e3 * 1.2 * np.pi * 0.75**2 * 1.0 / (4 * np.pi)
    assert field(DISC, at) == pytest.approx((3 * n * n[2] - [0, 0, 1]) * m / r**3, rel=2e-3)


def test_it_has_neither_sources_nor_curl_beside_the_magnet():
    at, h = np.array([0.9, -0.4, -1.3]), 1e-4
    gradient = np.array([(field(DISC, at + h * e) - field(DISC, at - h * e)) / (2 * h) for e in np.eye(3)])
    size = np.abs(gradient).max()
    assert abs(np.trace(gradient)) < 1e-6 * size
    assert np.abs(gradient - gradient.T).max() < 1e-6 * size


def test_the_matrix_is_the_field_s_own_differences():
    at_rest, slope = sensitivity(DISC, 1.5, 1.04)
    h = 1e-5
    for i, e in enumerate(np.eye(6)):
        twice = felt(DISC, 1.5, 1.04, h * e) - felt(DISC, 1.5, 1.04, -h * e)
        assert slope[:, i] == pytest.approx(twice / (2 * h), rel=1e-5, abs=1e-6 * np.abs(slope).max())
    assert at_rest[2] == pytest.approx(on_axis(DISC, 1.5))
    assert slope[2, 2] == pytest.approx((on_axis(DISC, 1.5 + h) - on_axis(DISC, 1.5 - h)) / (2 * h), rel=1e-6)


def test_a_turn_of_magnet_and_chip_together_turns_the_field():
    """By hand: a turn about the chip leaves the magnet over it, and its field turns with it."""
    a = 1e-6
    b = felt(DISC, 1.5, 1.04, np.array([0, -(2.54) * a, 0, a, 0, 0]))
    assert b[1] / a == pytest.approx(-on_axis(DISC, 1.5), rel=1e-4)


def test_magnets_pull_each_other():
    """Far ones as dipoles, 3 mu0 m^2/(4 pi d^4); near ones as the flux of Maxwell's stress through the plane
    between them, of both fields, pulls: equal ones side by side repel, and their mirror plane carries B along
    itself only, so that F is the integral of B^2/(2 mu0)."""
    moment = 1.2 / MU0 * np.pi * 0.75**2 * 1e-9
    for d in (30.0, 60.0):
        assert pull(DISC, (d, 0.0)) == pytest.approx(3e-7 * moment**2 / (1e-3 * d) ** 4, rel=5e-3)
    assert pull(DISC, (4.0, 3.0)) == pytest.approx(pull(DISC, (0.0, 5.0)), rel=1e-6)
    side = np.sinh(np.linspace(-4.0, 4.0, 81))  # of the plane x = d/2, mm
    y, z = np.meshgrid(side, side + 0.5, indexing="ij")
    weight = np.gradient(side)
    one = field(DISC, np.stack([np.full_like(y, 1.5), y, z], axis=-1))
    other = field(DISC, np.stack([np.full_like(y, -1.5), y, z], axis=-1))
    b = 1e-3 * (one + other)
    stress = (b[..., 1] ** 2 + b[..., 2] ** 2 - b[..., 0] ** 2) / (2.0 * MU0)
    assert pull(DISC, (3.0, 0.0)) == pytest.approx(1e-6 * weight @ stress @ weight, rel=5e-3)
