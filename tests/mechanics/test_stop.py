"""The hinge on a closed stop, against a frame of beam elements solved here."""

from __future__ import annotations

import numpy as np
import pytest

from tactcad.mechanics import ladder, strain
from tactcad.mechanics.section import HingeSection
from tactcad.mechanics.stop import deflection_share, largest_closing_force, largest_overload, stress_share


def section(load_arm: float, arm_height: float = 2.6) -> HingeSection:
    return HingeSection(0.25, 0.88, 0.30, load_arm, arm_height, 3.0, 4.0, 0.33, 69000.0, 3.0, False)


def frame(
    s: HingeSection, arm: float, force: float, at: float, give: float = 0.0
) -> tuple[float, float, float]:
    """Moment (N mm) in the hinge `at` mm from its centre towards the body, the hinge's own stiffness in
    bending (N mm/rad), and its turn (rad).

    Euler-Bernoulli: the hinge clamped at the body, the arm, a force at the load line, the tip held.
    """
    E, b, l, t, h = 69000.0, 3.0, 0.88, 0.25, float(s.arm_height)
    L = float(s.load_arm)
    spans = [(l, t), (L - l / 2, h), (arm - L, h)]
    K = np.zeros((8, 8))
    for n, (length, height) in enumerate(spans):
        I = b * height**3 / 12
        k = (
            E
            * I
            / length**3
            * np.array(
                [
                    [12, 6 * length, -12, 6 * length],
                    [6 * length, 4 * length**2, -6 * length, 2 * length**2],
                    [-12, -6 * length, 12, -6 * length],
                    [6 * length, 2 * length**2, -6 * length, 4 * length**2],
                ]
            )
        )
        K[2 * n : 2 * n + 4, 2 * n : 2 * n + 4] += k
    load = np.zeros(8)
    load[4] = force
    free = [2, 3, 4, 5, 7]  # clamped at 0 and 1, held at 6
    if give:
        free, K[6, 6] = [2, 3, 4, 5, 6, 7], K[6, 6] + 1.0 / give
    u = np.zeros(8)
    u[free] = np.linalg.solve(K[np.ix_(free, free)], load[free])
    reactions = K @ u - load
    assert not give or give * 10 * force > u[6] > 0.0
    at_wall, shear = reactions[1], reactions[0]
    turn_stiffness = E * b * t**3 / 12 / l
    return abs(at_wall - shear * (l / 2 - at)), turn_stiffness, u[3]


@pytest.mark.parametrize(("L", "arm"), [(3.0, 4.0), (7.0, 8.0), (4.0, 6.0)])
@pytest.mark.parametrize("height", [2.6, 1.0])
@pytest.mark.parametrize("give", [0.0, 3.4e-5, 1e-3])
def test_extra_moment_on_a_closed_stop(L, arm, height, give):
    """Within an eighth, on the safe side: the formula leaves out that the hinge also gives way sideways."""
    s = section(L, height)
    w = float(strain.peak_position(s))
    exact, turning, _ = frame(s, arm, 10.0, w, give)
    # the frame's hinge is as stiff as its own beam: K L^2 of the formula is that beam's turning stiffness
    mine = 10.0 * float(stress_share(s, turning / L**2, arm, give)) * (L + w)
    assert exact <= mine <= 1.125 * exact


@pytest.mark.parametrize(("L", "arm"), [(3.0, 4.0), (7.0, 8.0), (4.0, 6.0)])
@pytest.mark.parametrize("height", [2.6, 1.0])
@pytest.mark.parametrize("give", [0.0, 3.4e-5, 1e-3])
def test_extra_turn_on_a_closed_stop(L, arm, height, give):
    """The formula's, less what a real hinge gives way sideways: the arm then turns back about the held tip by
    V l^3/(12 E I arm), a leaf between stiff ends. The formula leaves that out, on the safe side."""
    s = section(L, height)
    _, turning, exact = frame(s, arm, 10.0, 0.0, give)
    mine = 10.0 * float(deflection_share(s, turning / L**2, arm, give)) / (turning / L**2) / L
    sideways = 10.0 * (1.0 - L / arm) * 0.88**3 / 12.0 / (69000.0 * 3.0 * 0.25**3 / 12.0)
    assert exact <= mine
    assert exact == pytest.approx(mine - sideways / arm, abs=0.16 * max(mine, sideways / arm))


def test_no_lever_no_extra():
    s = section(4.0)
    assert float(stress_share(s, 10.0, 4.0, 0.0)) == 0.0
    assert float(deflection_share(s, 10.0, 4.0, 0.0)) == 0.0


@pytest.mark.parametrize("height", [2.6, 0.2])
def test_at_the_largest_closing_force_one_limit_is_just_reached(height):
    """With a stiff arm the fillet's stress, with a whippy one the hinge's turn."""
    s, arm, limit, give = section(3.0, height), 4.0, 3.5, 3.4e-5
    K = ladder.stiffness(section(3.0))
    closing = largest_closing_force(s, K, arm, give, 13.0, limit)
    stress = closing + stress_share(s, K, arm, give) * (13.0 - closing)
    deflection = closing + deflection_share(s, K, arm, give) * (13.0 - closing)
    assert max(stress, deflection) == pytest.approx(limit, rel=1e-12)
    assert bool(stress > deflection) is (height > 1.0)
    assert largest_overload(s, K, arm, give, closing, limit) == pytest.approx(13.0, rel=1e-12)


@pytest.mark.parametrize("overload", [1e-3, 1.0, 3.5])
def test_a_stop_closes_at_the_limit_where_the_overload_alone_is_less(overload):
    """Nothing has to be kept from the hinge then, but a stop that closes later protects it from nothing."""
    s = section(3.0)
    assert largest_closing_force(s, ladder.stiffness(s), 4.0, 3.4e-5, overload, 3.5) == 3.5


def test_a_stop_that_gives_more_than_the_hinge_keeps_nothing_from_it():
    """A give of 1 mm/N leaves the hinge all and the lever's turn besides: no gap at all, where the equation's
    own root would be a force beyond the overload, at which the stop is not even reached."""
    s, K = section(3.0), ladder.stiffness(section(3.0))
    whippy = section(3.0, 0.05)
    share = float(deflection_share(whippy, K, 4.0, 1.0))
    assert share > 1.0 and (3.5 - share * 13.0) / (1.0 - share) > 13.0
    assert largest_closing_force(whippy, K, 4.0, 1.0, 13.0, 3.5) == 0.0
    assert largest_closing_force(s, K, 4.0, 3.4e-5, 13.0, 3.5) > 0.0
