"""Beams and plates by another way: a chain of finite beam elements with shear, and limits that are known."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from scipy.integrate import solve_bvp

from tactcad.mechanics.statics import Beam, rod, round_plate

E, NU = 69000.0, 0.33
BEAMS = [Beam(60.0, 23.0, 8.0, E, NU), Beam(20.0, 30.0, 12.0, E, NU), Beam(200.0, 3.0, 2.0, E, NU)]
PIECES = 40


def stiffness(beam: Beam) -> np.ndarray:
    """Of a chain of equal Timoshenko elements (two-node, exact): rise and turn at each node."""
    h, EI = beam.length / PIECES, E * beam.width * beam.height**3 / 12
    phi = 12 * EI / (h**2 * (5 / 6) * E / (2 + 2 * NU) * beam.width * beam.height)
    k = np.array(
        [
            [12, 6 * h, -12, 6 * h],
            [6 * h, (4 + phi) * h**2, -6 * h, (2 - phi) * h**2],
            [-12, -6 * h, 12, -6 * h],
            [6 * h, (2 - phi) * h**2, -6 * h, (4 + phi) * h**2],
        ]
    )
    K = np.zeros((2 * PIECES + 2,) * 2)
    for i in range(PIECES):
        K[2 * i : 2 * i + 4, 2 * i : 2 * i + 4] += EI / (h**3 * (1 + phi)) * k
    return K


def moved(beam: Beam, held: list[int], loads: dict[int, float]) -> np.ndarray:
    K, f = stiffness(beam), np.zeros(2 * PIECES + 2)
    f[list(loads)] = list(loads.values())
    free = np.setdiff1d(np.arange(len(f)), held)
    u = np.zeros(len(f))
    u[free] = np.linalg.solve(K[np.ix_(free, free)], f[free])
    return u


END, MIDDLE = 2 * PIECES, PIECES
PINNED, CLAMPED, WALL = [0, END], [0, 1, END, END + 1], [0, 1]


@pytest.mark.parametrize("beam", BEAMS)
def test_beams_move_as_a_chain_of_elements(beam):
    close = lambda value: pytest.approx(value, rel=1e-6)  # noqa: E731
    assert beam.supported() == close(moved(beam, PINNED, {MIDDLE: 1.0})[MIDDLE])
    assert beam.clamped() == close(moved(beam, CLAMPED, {MIDDLE: 1.0})[MIDDLE])
    assert beam.cantilever() == close(moved(beam, WALL, {END: 1.0})[END])
    assert beam.cantilever_tilt() == close(moved(beam, WALL, {END: 1.0})[END + 1])
    assert beam.turned_by_moment() == close(moved(beam, WALL, {END + 1: 1.0})[END + 1])
    for node in (4, 14, 20, 30):
        at = beam.length * node / PIECES
        assert beam.supported_beside(at) == close(moved(beam, PINNED, {2 * node: 1.0})[MIDDLE])


@pytest.mark.parametrize("beam", BEAMS)
def test_a_load_spread_over_a_beam_is_many_small_ones(beam):
    n = 4000
    spots = (np.arange(n) + 0.5) / n * beam.length
    assert beam.supported_evenly() == pytest.approx(
        np.mean([beam.supported_beside(a) for a in spots]), rel=1e-6
    )


def test_a_rod_bends_with_its_own_moment_of_area():
    assert rod(60.0, 8.0, E, NU).bending == pytest.approx(E * pi / 64 * 8.0**4)


@pytest.mark.parametrize("width, height", [(64.0, 6.0), (6.0, 64.0), (10.0, 10.0), (12.0, 8.0)])
def test_torsion_is_saint_venant_s(width, height):
    """Of his series."""
    a, b = max(width, height), min(width, height)
    n = np.arange(1, 200, 2)
    J = a * b**3 / 3 * (1 - 192 * b / (pi**5 * a) * np.sum(np.tanh(n * pi * a / (2 * b)) / n**5))
    ratio = Beam(1.0, width, height, E, NU).torsion / (E / (2 + 2 * NU) * J)
    assert ratio == pytest.approx(1.0, abs=0.005)


def test_a_round_plate_obeys_its_differential_equation():
    """D (w'' + w'/r)' + ... = shear: integrated numerically, rim free to turn, for the force and for the
    pressure."""
    R, t = 14.0, 6.0
    D = E * t**3 / (12 * (1 - NU**2))
    near = 1e-4 * R

    def middle(shear):
        """y = w, w', curvature sum; (w'' + w'/r)' = Q/D."""
        r = np.geomspace(near, R, 400)
        rhs = lambda r, y: np.array([y[1], y[2] - y[1] / r, shear(r) / D])  # noqa: E731
        ends = lambda a, b: np.array([a[1], b[0], b[2] - (1 - NU) * b[1] / R])  # noqa: E731
        found = solve_bvp(rhs, ends, r, np.zeros((3, r.size)), tol=1e-8, max_nodes=100000)
        assert found.success
        return abs(found.y[0][0])

    force, pressure = round_plate(R, t, E, NU)
    assert force == pytest.approx(middle(lambda r: 1 / (2 * pi * r)), rel=1e-4)
    assert pressure == pytest.approx(middle(lambda r: r / 2), rel=1e-4)
