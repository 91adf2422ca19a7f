"""The hinge on a closed stop, against a frame of beam elements solved here."""

from __future__ import annotations

import numpy as np
import pytest

from tactcad.mechanics import ladder, strain
from tactcad.mechanics.section import HingeSection
from tactcad.mechanics.stop import equivalent_force, largest_closing_force


def section(load_arm: float, arm_height: float = 2.6) -> HingeSection:
    return HingeSection(0.25, 0.88, 0.30, load_arm, arm_height, 3.0, 4.0, 0.33, 69000.0, 3.0, False)


def frame_moment(s: HingeSection, arm: float, force: float, at: float) -> tuple[float, float]:
    """Moment (N mm) in the hinge `at` mm from its centre towards the body, and the hinge's own stiffness in bending.

    Euler-Bernoulli: the hinge clamped at the body, the arm, a force at the load line, the tip held.
    """
    E, b, l, t, h = 69000.0, 3.0, 0.88, 0.25, float(s.arm_height)
    L = float(s.load_arm)
    spans = [(l, t), (L - l / 2, h), (arm - L, h)]
    K = np.zeros((8, 8))
    for n, (length, height) in enumerate(spans):
        I = b * height**3 / 12
        k = E * I / length**3 * np.array([
            [12, 6 * length, -12, 6 * length],
            [6 * length, 4 * length**2, -6 * length, 2 * length**2],
            [-12, -6 * length, 12, -6 * length],
            [6 * length, 2 * length**2, -6 * length, 4 * length**2],
        ])  # fmt: skip
        K[2 * n : 2 * n + 4, 2 * n : 2 * n + 4] += k
    load = np.zeros(8)
    load[4] = force
    free = [2, 3, 4, 5, 7]  # clamped at 0 and 1, held at 6
    u = np.zeros(8)
    u[free] = np.linalg.solve(K[np.ix_(free, free)], load[free])
    reactions = K @ u - load
    at_wall, shear = reactions[1], reactions[0]
    turn_stiffness = E * b * t**3 / 12 / l
    return abs(at_wall - shear * (l / 2 - at)), turn_stiffness


@pytest.mark.parametrize(("L", "arm"), [(3.0, 4.0), (7.0, 8.0), (4.0, 6.0)])
@pytest.mark.parametrize("height", [2.6, 1.0])
def test_extra_moment_on_a_closed_stop(L, arm, height):
    """Within an eighth, on the safe side: the formula leaves out that the hinge also gives way sideways."""
    s = section(L, height)
    w = float(strain.peak_position(s))
    exact, turning = frame_moment(s, arm, 10.0, w)
    # the frame's hinge is as stiff as its own beam: K L^2 of the formula is that beam's turning stiffness
    mine = float(equivalent_force(s, turning / L**2, arm, 10.0)) * (L + w)
    assert exact <= mine <= 1.125 * exact


def test_no_lever_no_extra():
    s = section(4.0)
    assert float(equivalent_force(s, 10.0, 4.0, 5.0)) == 0.0
    assert float(equivalent_force(s, 10.0, 5.0, 0.0)) == 0.0


def test_at_the_largest_closing_force_the_fillet_just_yields():
    s, arm = section(3.0), 4.0
    K = ladder.stiffness(s)
    closing = largest_closing_force(s, K, arm, 13.0, 505.0)
    stress = strain.peak_stress(s, closing + equivalent_force(s, K, arm, 13.0 - closing))
    assert stress == pytest.approx(505.0, rel=1e-12)
