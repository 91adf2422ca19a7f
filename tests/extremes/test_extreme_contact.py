"""Pads on a body at the ends of every range: limits by closed form, scale laws, sums, symmetry."""

from __future__ import annotations

from dataclasses import replace
from math import inf

import numpy as np
import pytest

from tactcad.contact.elastic_body import Body
from tactcad.contact.press import THINNEST, Pads, PadsOnBody, pad_stiffness
from tactcad.contact.rigid_pads import press_many
from tactcad.design.messages import CheckFailure, InputError

MODULI = [1e-3, 0.3, 100.0, 1e4]  # MPa: 1 kPa to 10 GPa
THICKNESSES = [0.7, 6.0, inf]  # mm; the thinnest that a pad of 2 x 3 mm takes, 0.61, to a half-space


def rows(number: int, pitch: float = 4.0, soft: float = 3.0, stiff: float = 30.0, size: float = 1.0) -> Pads:
    """Two facing rows of pads on soft and stiff springs (N/mm); one pad alone for number 0."""
    y = (np.arange(number) - (number - 1) / 2) * pitch * size
    x, y = (np.repeat([2.0, -2.0], number) * size, np.tile(y, 2)) if number else (np.zeros(1), np.zeros(1))
    K = np.resize([soft, stiff], len(x)) * size
    move = np.stack([np.ones(len(x)), -np.sign(x) / (5.0 * size), 0.0 * x], 1)
    compliance = move[:, :, None] * move[:, None, :] / K[:, None, None]
    free = np.zeros(len(x))
    return Pads(x, y, 2.0 * size, 3.0 * size, compliance, free, np.full(len(x), inf))


def both(pads: Pads, body: Body, load: float, angle=(0.0, 0.0)):
    """By single patches and by the law of whole pads."""
    return PadsOnBody(pads, body).press(load=load, angle=angle), press_many(pads, body, load, angle)


@pytest.mark.slow  # a long search for a rest
def test_where_no_rest_is_found_it_is_said():
    """Corners of four pads touch a face a thousand times stiffer than their springs: no number is given."""
    with pytest.raises(CheckFailure, match="finds no rest of 4 pads"):
        press_many(rows(2), Body(1e4, 0.49, 0.7), 2.0, (0.0, 3.0))


@pytest.mark.by_day(2, "half a second each")
@pytest.mark.parametrize("E", MODULI)
@pytest.mark.parametrize("thickness", THICKNESSES)
def test_forces_are_whole_and_finite(E, thickness):
    """At rest and inclined up to 30 degrees: what is asked for is borne, nothing pulls, elements' forces are
    their springs'."""
    pads, body = rows(3), Body(E, 0.49, thickness)
    for angle in ((0.0, 0.0), (0.0, 3.0), (30.0, 0.0), (-20.0, 30.0)):
        for pressed in both(pads, body, 2.0, angle):
            assert pressed.force.sum() == pytest.approx(2.0, rel=1e-6)
            assert (pressed.force >= -1e-9).all() and np.isfinite(pressed.approach)
            assert np.isfinite(pressed.sink).all() and (pressed.sink >= -1e-9).all()


@pytest.mark.parametrize("thickness", THICKNESSES)
def test_a_hard_body_is_a_plate_on_the_springs_and_a_soft_one_a_punch_on_rigid_pads(thickness):
    """K_i/sum K if the body gives nothing; equal shares of pads far apart if the springs give nothing."""
    pads = rows(2)
    K = 1 / pads.compliance[:, 0, 0]
    level = replace(pads, compliance=pads.compliance * np.array([[1, 0, 0], [0, 0, 0], [0, 0, 0]]))
    for pressed in both(level, Body(1e7, 0.49, thickness), 2.0):
        assert pressed.force == pytest.approx(2.0 * K / K.sum(), rel=2e-3)
    far = rows(2, pitch=3e5, soft=1e6, stiff=1e6)
    far = replace(far, x=far.x * 1e5)
    for pressed in both(far, Body(1e-3, 0.49, thickness), 2.0):
        assert pressed.force == pytest.approx(np.full(4, 0.5), rel=2e-3)


def test_deflections_fall_as_the_body_hardens():
    """K of the whole array rises with E, from the body's to the springs'."""
    found = [[p.approach for p in both(rows(2), Body(E, 0.49, 6.0), 2.0)] for E in MODULI]
    assert (np.diff(np.array(found), axis=0) < 0).all()


@pytest.mark.parametrize("size", [1e-3, 1e3])
def test_forces_go_with_size_and_modulus(size):
    """All lengths times `size`, springs' stiffness too: equal shares of a load times its square."""
    for angle in ((0.0, 0.0), (1.0, 2.0)):
        own = both(rows(2), Body(0.5, 0.49, 6.0), 2.0, angle)
        other = both(rows(2, size=size), Body(0.5, 0.49, 6.0 * size), 2.0 * size**2, angle)
        for a, b in zip(own, other):
            assert b.force == pytest.approx(a.force * size**2, rel=1e-6, abs=1e-9 * size**2)
            assert b.approach == pytest.approx(a.approach * size, rel=1e-6)


@pytest.mark.parametrize("E", MODULI)
def test_one_pad_is_a_spring_on_its_own_stiffness(E):
    body, pads = Body(E, 0.49, 6.0), rows(0)
    K = 1 / pads.compliance[0, 0, 0]
    for pressed in both(pads, body, 1.0):
        assert pressed.approach == pytest.approx(1 / K + 1 / pad_stiffness(body, 2.0, 3.0), rel=2e-3)


def test_pads_that_nearly_touch_and_turned_about():
    """At a pitch of 1.01 pads; the array turned by 180 degrees in an inclined plane is the plane turned."""
    pads, body = rows(3, pitch=3.03), Body(0.7, 0.49, 6.0)
    turned = replace(pads, x=-pads.x, y=-pads.y, compliance=pads.compliance * _turn())
    for a, b in zip(both(pads, body, 3.0, (1.0, 2.0)), both(turned, body, 3.0, (-1.0, -2.0))):
        assert b.force == pytest.approx(a.force, rel=1e-6, abs=1e-9)


def _turn() -> np.ndarray:
    sign = np.array([1.0, -1.0, -1.0])
    return sign[:, None] * sign


@pytest.mark.nightly
def test_a_thousand_pads_bear_as_their_neighbourhood_does():
    """2 x 500 pads: those in the middle as in 2 x 60."""
    body = Body(0.7, 0.49, 3.0)
    many, few = (press_many(rows(n), body, 1.0 * n, (0.0, 0.0)).force.reshape(2, n) for n in (500, 60))
    assert many.sum() == pytest.approx(500)
    assert many[:, 248:252] == pytest.approx(few[:, 28:32], rel=0.02)


def test_a_layer_too_thin_for_the_patches_is_said_by_its_legal_value():
    least = THINNEST * (2.0 * 3.0) ** 0.5
    with pytest.raises(InputError, match=f"{least:.3g}"[:4]):
        PadsOnBody(rows(1), Body(0.7, 0.49, 0.1))
