"""Pads as three numbers against every patch solved, on layers and at angles where pads lift."""

from __future__ import annotations

from dataclasses import replace
from math import inf, radians, tan

import numpy as np
import pytest

from tactcad.contact import rigid_pads
from tactcad.contact.elastic_body import Body, influence
from tactcad.contact.press import PATCHES, Pads, PadsOnBody, complementary, pad_stiffness, patches
from tactcad.contact.rigid_pads import POWERS, ManyPresses, pad_law, press_many
from tactcad.lab import pressed
from tactcad.lab.pads import springs_of
from tactcad.parts.rules import load


def array():
    pads, _ = springs_of(load("macro-array"))
    pads = replace(pads, stop=np.full(len(pads.x), inf))
    K = 1 / pads.compliance[:, 0, 0]
    return pads, K, pads.compliance[:, :, 0] * K[:, None]


@pytest.mark.parametrize("thickness", [1.0, 6.0, inf])
def test_presses_are_those_of_single_patches(thickness):
    """Within 0.2 % of the largest sink, whole pads or edges; 10 pads, 3 to 10 N. Without what lifting changes
    between pads they are up to 0.3 % off."""
    pads, K, move = array()
    body = Body(1.0, 0.49, thickness)
    single = PadsOnBody(pads, body)
    many = ManyPresses(pads.x, pads.y, pads.length, pads.width, move, body)
    lifted = 0
    for E, angle, N in ((0.1, (0.0, 0.0), 3.0), (0.3, (0.5, 1.0), 3.0), (1.0, (-2.0, 5.0), 10.0)):
        exact = single.press(load=N, angle=angle, modulus=E)
        lifted += int((exact.contact < 1).sum())
        slope = np.array([[tan(radians(a)) for a in angle]])
        b = many.approached(np.array([exact.approach]), slope, pads.height[None])
        r, change = b, None
        for _ in range(3):
            r, g = many.rest(many.system(np.array([E]), K[None], change), b, r)[:2]
            change = many.lifted(r)
        g = g[0]
        sink = E * (g * many.move).sum(-1) / K
        assert np.abs(sink - exact.sink).max() < 2e-3 * exact.sink.max()
        assert E * g[:, 0].sum() == pytest.approx(N, rel=2e-3)
    assert lifted > 4


def test_pads_hold_the_face_under_each_other(monkeypatch):
    """On the patches of `press` whole pads are exact; with others half lifted they err by 2e-5 of the largest
    sink (15e-5 if pads press as if no other's pressure reached them)."""
    monkeypatch.setattr(rigid_pads, "COARSE", PATCHES)
    rigid_pads.between.cache_clear(), rigid_pads._mean_inverses.cache_clear()
    pads, K, move = array()
    single = PadsOnBody(pads, Body(1.0, 0.49, inf))
    many = ManyPresses(pads.x, pads.y, pads.length, pads.width, move, single.body)
    rigid_pads.between.cache_clear(), rigid_pads._mean_inverses.cache_clear()
    for angle, most in ((0.0, 2e-6), (5.0, 3e-5)):
        slope = np.tan(np.radians(angle)) * np.array([np.cos(1.0), np.sin(1.0)])
        exact = single.press(load=8.0, angle=tuple(np.degrees(np.arctan(slope))))
        b = many.approached(np.array([exact.approach]), slope[None], pads.height[None])
        r, change = b, None
        for _ in range(8):
            r, g = many.rest(many.system(np.array([1.0]), K[None], change), b, r)[:2]
            change = many.lifted(r)
        off = np.abs((g[0] * move).sum(-1) / K - exact.sink) / exact.sink.max()
        assert off[exact.contact == 1].max() < most


def test_a_pads_law_is_its_patches_and_its_derivative_a_difference():
    law, one = pad_law(0.49, 6.0, "bonded", 2.0, 3.0), patches(2.0, 3.0, False)
    M = influence(Body(1.0, 0.49, 6.0), tuple(one))
    level = law(np.array([1.0, 0.0, 0.0]))[0]
    assert level == pytest.approx([pad_stiffness(Body(1.0, 0.49, 6.0), 2.0, 3.0), 0, 0], rel=1e-6, abs=1e-9)
    rng = np.random.default_rng(1)
    for _ in range(20):
        r = np.array([1.0, *rng.normal(0, 0.6, 2)])
        f, _ = complementary(M, -(r[1] * one[0] + r[2] * one[1]), None, r[0], np.ones(len(M)))
        g, d = law(r)
        assert g == pytest.approx([f.sum(), f @ one[0], f @ one[1]], abs=5e-3 * f.sum())
        assert law(3 * r)[0] == pytest.approx(3 * g)
        numeric = np.array([(law(r + 1e-6 * e)[0] - law(r - 1e-6 * e)[0]) / 2e-6 for e in np.eye(3)]).T
        assert d == pytest.approx(numeric, rel=1e-5, abs=1e-5)


def test_an_endless_tilt_has_no_finite_force():
    """A fit that runs away tries such; it was an IndexError."""
    with np.errstate(all="ignore"):
        assert not np.isfinite(pad_law(0.49, 6.0, "bonded", 2.0, 3.0)(np.array([0.1, np.inf, 0.0]))[0]).any()


def test_whole_pads_change_nothing_between_each_other_and_moments_are_those_of_the_pressure():
    pads, _, move = array()
    many = ManyPresses(pads.x, pads.y, pads.length, pads.width, move, Body(1.0, 0.49, 6.0))
    whole = np.tile([1.0, 0.01, -0.01], (len(pads.x), 1))
    assert np.abs(many.lifted(whole[None])).max() < 1e-9 * np.abs(many.between).max()
    one = patches(2.0, 3.0, False)
    M = influence(Body(1.0, 0.49, 6.0), tuple(one))
    for r in ((1.0, 0.8, 0.0), (0.6, -0.9, 0.5), (0.2, 0.5, -0.6)):
        r = np.array(r)
        f, _ = complementary(M, -(r[1] * one[0] + r[2] * one[1]), None, r[0], np.ones(len(M)))
        for (a, b), found in zip(POWERS, many.law.moments(r)[0] @ many.law(r)[0], strict=True):
            moment = (one[0] ** a * one[1] ** b) @ f
            assert found == pytest.approx(moment, abs=0.02 * f.sum() * 1.5 ** (a + b))


def row_of(number: int, pitch: float, stop: float) -> Pads:
    """Two facing rows of pads on soft and stiff springs."""
    y = (np.arange(number) - (number - 1) / 2) * pitch
    x, y = np.repeat([2.0, -2.0], number), np.tile(y, 2)
    K = np.resize([3.0, 30.0], 2 * number)
    move = np.stack([np.ones(2 * number), -np.sign(x) / 5.0, 0.0 * x], 1)
    compliance = move[:, :, None] * move[:, None, :] / K[:, None, None]
    return Pads(x, y, 2.0, 3.0, compliance, np.zeros(2 * number), np.full(2 * number, stop))


@pytest.mark.by_day(3, "26 pads, seconds each")
@pytest.mark.parametrize(
    ("number", "pitch", "angle", "stop", "off"),
    [
        (3, 4.0, (1.0, 2.0), 0.1, 0.01),
        (3, 3.2, (0, 0), inf, 0.025),
        (26, 3.2, (8.0, 0.3), inf, pressed.MANY_PADS),
        (26, 3.2, (30.0, 0.0), inf, pressed.MANY_PADS),
        (26, 3.02, (30.0, 0.9), inf, pressed.NEAR_PADS),
    ],
)
def test_many_pads_are_pressed_as_few(number, pitch, angle, stop, off):
    """By the law of whole pads against single patches: forces within what is stated of their mean."""
    pads, body, load = row_of(number, pitch, stop), Body(0.7, 0.49, 6.0), 5.0 * number / 3
    exact = PadsOnBody(pads, body).press(load=load, angle=angle)
    many = press_many(pads, body, load, angle)
    mean = exact.force[exact.force > 0].mean()
    assert many.force == pytest.approx(exact.force, abs=off * mean)
    assert many.force.sum() == pytest.approx(load) and (many.stopped == exact.stopped).all()


def test_far_pads_bear_alike():
    """A hundred and twenty pads, pairs a hundred pads apart: each bears what it does among four."""
    body = Body(0.7, 0.49, 6.0)
    many = press_many(row_of(60, 300.0, inf), body, 60.0, (0.0, 0.0)).force
    four = press_many(row_of(2, 300.0, inf), body, 2.0, (0.0, 0.0)).force
    assert many.sum() == pytest.approx(60)
    assert many == pytest.approx(np.concatenate([np.tile(four[:2], 30), np.tile(four[2:], 30)]), rel=1e-6)
