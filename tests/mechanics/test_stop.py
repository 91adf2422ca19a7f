"""The hinge on a closed stop, against a frame of beam elements solved here."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from tactcad.mechanics import ladder, strain
from tactcad.mechanics.section import REFERENCE, HingeSection
from tactcad.mechanics.strength import (
    back_share,
    deflection_share,
    largest_closing_force,
    largest_overload,
    stop_share,
    stress_share,
    tip_compliance,
)


def section(load_arm: float, arm_height: float = 2.6, body_length: float = 4.0) -> HingeSection:
    return REFERENCE.with_(
        hinge_length=0.88,
        fillet_radius=0.3,
        load_arm=load_arm,
        arm_height=arm_height,
        body_height=3.0,
        body_length=body_length,
        two_sided=False,
    )


@dataclass(frozen=True)
class Frame:
    """1 N at the load line of body, leaf and arm, clamped at the body's far end, in Euler-Bernoulli's beams.

    stiffness  N/mm, of the free arm at the load line
    tip        mm, of the free arm there
    reaction   N, of a stop at the tip that gives way by `give` mm/N
    moment     N mm, in the leaf's middle on that stop
    """

    stiffness: float
    tip: float
    reaction: float
    moment: float


def frame(s: HingeSection, arm: float, give: float = 0.0) -> Frame:
    E, b, L = 69000.0, 3.0, float(s.load_arm)
    half = float(s.hinge_length) / 2
    spans = [
        (float(s.body_length), float(s.body_height)),
        (half, float(s.hinge_thickness)),
        (half, float(s.hinge_thickness)),
        (L - half, float(s.arm_height)),
        (arm - L, float(s.arm_height)),
    ]
    K = np.zeros((12, 12))
    for n, (length, height) in enumerate(spans):
        I = b * height**3 / 12
        k = [
            [12, 6 * length, -12, 6 * length],
            [6 * length, 4 * length**2, -6 * length, 2 * length**2],
            [-12, -6 * length, 12, -6 * length],
            [6 * length, 2 * length**2, -6 * length, 4 * length**2],
        ]
        K[2 * n : 2 * n + 4, 2 * n : 2 * n + 4] += E * I / length**3 * np.array(k)
    load = np.zeros(12)
    load[8] = 1.0
    free = np.linalg.solve(K[2:, 2:], load[2:])
    held = [2, 3, 4, 5, 6, 7, 8, 9, 11]  # the tip, 10, as the stop has it
    if give:
        held, K[10, 10] = list(range(2, 12)), K[10, 10] + 1.0 / give
    u = np.zeros(12)
    u[held] = np.linalg.solve(K[np.ix_(held, held)], load[held])
    reaction = u[10] / give if give else -(K @ u - load)[10]
    return Frame(1.0 / free[6], free[8], reaction, L - reaction * arm)


ARMS = pytest.mark.parametrize(("L", "arm"), [(3.0, 4.0), (7.0, 8.0), (4.0, 6.0)])
HEIGHTS = pytest.mark.parametrize("height", [2.6, 1.0, 0.2])
BODIES = pytest.mark.parametrize("body", [0.5, 4.0, 97.0])


@ARMS
@HEIGHTS
@BODIES
def test_way_of_the_free_tip(L, arm, height, body):
    s = section(L, height, body)
    exact = frame(s, arm)
    assert float(tip_compliance(s, exact.stiffness, arm)) == pytest.approx(exact.tip, rel=1e-9)


@ARMS
@HEIGHTS
@BODIES
@pytest.mark.parametrize("give", [0.0, 3.4e-5, 1e-3])
def test_what_a_closed_stop_leaves_the_hinge(L, arm, height, body, give):
    """The moment in the hinge's middle, and at the peak on either side of it what shear adds."""
    s = section(L, height, body)
    exact = frame(s, arm, give)
    assert float(stop_share(s, exact.stiffness, arm, give)) == pytest.approx(exact.reaction, rel=1e-9)
    turn = float(deflection_share(s, exact.stiffness, arm, give))
    assert turn * L == pytest.approx(max(exact.moment, 0.0), rel=1e-6, abs=1e-9)
    w, shear = float(strain.peak_position(s)), 1.0 - exact.reaction
    at_body, at_arm = max(exact.moment, 0.0) + shear * w, exact.moment - shear * w
    assert float(stress_share(s, exact.stiffness, arm, give)) * (L + w) == pytest.approx(at_body, rel=1e-6)
    back = max(-at_arm / (L + w), -exact.moment / L)
    assert float(back_share(s, exact.stiffness, arm, give)) == pytest.approx(back, rel=1e-6)


def test_a_soft_body_bends_the_hinge_back():
    """97 mm of body: the tip goes hardly further than the load line, whatever the lever, and each newton more
    on the closed stop turns the hinge the other way round, by more than one on a free arm does."""
    s = section(1.5, body_length=97.0)
    exact = frame(s, 4.0)
    assert exact.tip * exact.stiffness < 1.1 < 4.0 / 1.5
    assert exact.moment < -1.5
    assert float(back_share(s, exact.stiffness, 4.0, 0.0)) > 1.0
    assert largest_closing_force(s, exact.stiffness, 4.0, 0.0, 13.0, 3.5) == 0.0
    assert largest_closing_force(section(1.5), frame(section(1.5), 4.0).stiffness, 4.0, 0.0, 13.0, 3.5) > 0.0


def test_no_lever_no_extra():
    s = section(4.0)
    assert float(stress_share(s, 10.0, 4.0, 0.0)) == 0.0
    assert float(deflection_share(s, 10.0, 4.0, 0.0)) == 0.0


@pytest.mark.parametrize("give", [0.0, 3.4e-5, 1e-3])
def test_at_the_largest_closing_force_the_limit_is_just_reached(give):
    s, arm, limit = section(3.0), 4.0, 3.5
    K = frame(s, arm).stiffness
    closing = largest_closing_force(s, K, arm, give, 13.0, limit)
    assert closing + stress_share(s, K, arm, give) * (13.0 - closing) == pytest.approx(limit, rel=1e-12)
    assert closing + deflection_share(s, K, arm, give) * (13.0 - closing) < limit
    assert largest_overload(s, K, arm, give, closing, limit) == pytest.approx(13.0, rel=1e-12)


def test_the_largest_overload_bends_no_hinge_back_too_far():
    s, arm, limit = section(3.0, body_length=97.0), 6.0, 3.5
    K = frame(s, arm).stiffness
    most = float(largest_overload(s, K, arm, 0.0, 3.0, limit))
    assert most * float(back_share(s, K, arm, 0.0)) == pytest.approx(limit)
    assert largest_closing_force(s, K, arm, 0.0, 0.999 * most, limit) > 0.0
    assert largest_closing_force(s, K, arm, 0.0, 1.001 * most, limit) == 0.0


@pytest.mark.parametrize("overload", [1e-3, 1.0, 3.5])
def test_a_stop_closes_at_the_limit_where_the_overload_alone_is_less(overload):
    """Nothing has to be kept from the hinge then, but a stop that closes later protects it from nothing."""
    s = section(3.0)
    assert largest_closing_force(s, ladder.stiffness(s), 4.0, 3.4e-5, overload, 3.5) == 3.5
