"""Rigid pads on layers and half-spaces: published punches, an integral equation, laws of scale."""

from __future__ import annotations

from math import inf, pi, radians, tan

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss
from scipy.optimize import nnls

from tactcad.contact.elastic_body import BASES, Body, influence
from tactcad.contact.press import Pads, PadsOnBody, pad_stiffness, patches
from tactcad.design.messages import InputError


def hayes(a_over_h: float, nu: float, nodes: int = 80) -> float:
    """P/(2 a E* delta) of a flat circular punch on a bonded layer, by the Fredholm equation of its dual
    integral equations (Hayes and others 1972): w(t) - (1/pi) int K(t, s) w(s) ds = 1 on [-1, 1], K(t, s) =
    (a/h) int (1 - phi(c)) cos(c a t/h) cos(c a s/h) dc; the punch's force is the integral of w."""
    t, weight = leggauss(nodes)
    t, weight = (t + 1) / 2, weight / 2
    c, wc = leggauss(400)
    c, wc = (c + 1) * 20, wc * 20
    kernel = np.cos(np.outer(t, c * a_over_h)) * ((1 - BASES["bonded"](c, nu)) * wc)
    K = 2 / pi * a_over_h * kernel @ np.cos(np.outer(c * a_over_h, t))
    w = np.linalg.solve(np.eye(nodes) - K * weight, np.ones(nodes))
    return float(w @ weight)


# Printed in the issue of this room from Hayes' equation, 80 Gauss points: P/(2 a E* delta) by nu and a/h.
PRINTED = {
    0.3: (1.2066, 1.4726, 2.4835, 4.3532),
    0.4: (1.2323, 1.5422, 2.7938, 5.2985),
    0.45: (1.2523, 1.5993, 3.0914, 6.4206),
    0.5: (1.2806, 1.6837, 3.6187, 9.1495),
}


@pytest.mark.parametrize("nu", PRINTED)
def test_a_round_punch_on_a_bonded_layer_is_hayes(nu):
    for a_over_h, printed in zip((0.2, 0.4, 1.0, 2.0), PRINTED[nu]):
        exact = hayes(a_over_h, nu)
        assert exact == pytest.approx(printed, rel=2e-4)
        K = pad_stiffness(Body(1.0, nu, 1 / a_over_h), 2.0, 2.0, disc=True)
        assert K * (1 - nu**2) / 2 == pytest.approx(exact, rel=3e-3)


@pytest.mark.parametrize("aspect, factor", [(1, 1.1523), (2, 1.181), (3, 1.226)])
def test_a_rigid_rectangle_on_a_half_space(aspect, factor):
    """P = factor E* w sqrt(A); the square's by the capacitance of a square plate, 0.36679 of its side."""
    K = pad_stiffness(Body(1.0, 0.3), 1.0, float(aspect)) * (1 - 0.3**2)
    assert K == pytest.approx(factor * aspect**0.5, rel=4e-3)


def test_influence_of_far_and_near_rectangles_is_the_integral():
    """Against quadrature of the point force over the loaded rectangle, and over both."""
    body = Body(2.0, 0.4)
    for dx, dy in ((0.9, 0.3), (5.0, 2.0), (30.0, 4.0)):
        one, other = ([np.array([v]) for v in r] for r in ((0, 0, 0.6, 0.4), (dx, dy, 0.3, 0.5)))
        node, weight = leggauss(24)
        px, py = node * 0.3, node * 0.2
        qx, qy = dx + node * 0.15, dy + node * 0.25
        X = px[:, None, None, None] - qx[None, None, :, None]
        Y = py[None, :, None, None] - qy[None, None, None, :]
        w4 = np.einsum("i,j,k,l->ijkl", *[weight / 2] * 4)
        expected = (1 - 0.16) / (pi * 2.0) * float((w4 / np.hypot(X, Y)).sum())
        assert influence(body, one, other)[0, 0] == pytest.approx(expected, rel=2e-5)


@pytest.mark.parametrize("base", BASES)
def test_an_even_pressure_over_a_wide_patch_strains_a_layer_evenly(base):
    """Far from its edges a bonded layer is strained along one axis: p h (1 + nu)(1 - 2 nu)/(E (1 - nu)); one
    that slips strains in the plane of a long wave."""
    nu = 0.3
    limit = {"bonded": (1 - 2 * nu) / (1 - nu) ** 2 / 2, "frictionless": 0.5}[base]  # phi(c)/c for c to 0
    assert BASES[base](np.array([1e-4]), nu)[0] / 1e-4 == pytest.approx(limit, rel=1e-3)
    if base == "bonded":
        x, y = (a.ravel() for a in np.meshgrid(*[np.arange(-9.75, 10, 0.5)] * 2))
        wide = (x, y, np.full(x.shape, 0.5), np.full(x.shape, 0.5))
        middle = tuple(np.array([v]) for v in (0.0, 0.0, 0.5, 0.5))
        moved = influence(Body(1.0, nu, 1.0), middle, wide).sum() * 0.25
        assert moved == pytest.approx((1 + nu) * (1 - 2 * nu) / (1 - nu), rel=1e-4)


def array(K, x, y, lever=inf, height=0.0, stop=inf, **shape) -> Pads:
    K, x, y = np.broadcast_arrays(np.asarray(K, float), x, y)
    v = np.stack([np.ones(len(K)), np.full(len(K), -1 / lever), np.zeros(len(K))], 1)
    D = v[:, :, None] * v[:, None, :] / K[:, None, None]
    each = [np.broadcast_to(np.asarray(a, float), K.shape) for a in (height, stop)]
    return Pads(x, y, shape.get("length", 2.0), shape.get("width", 3.0), D, *each, disc=False)


ROW = array([2.0, 8.0, 4.0], [0.0, 4.0, 8.0], [0.0, 0.0, 1.0], lever=6.0)


def dense(contact: PadsOnBody) -> np.ndarray:
    """Compliance of the face, [patch, patch]."""
    unit = np.eye(contact.at[0].size).reshape(-1, *contact.at.shape[1:])
    return contact.face.moved(unit).reshape(len(unit), -1).T


def test_reciprocity_superposition_and_scale():
    contact = PadsOnBody(ROW, Body(0.5, 0.49, 6.0))
    whole = influence(contact.body, tuple(contact.at.reshape(4, -1)))  # each pair of patches by itself
    assert dense(contact) == pytest.approx(whole, rel=1e-6)  # sixteen differences lose digits
    one, two = contact.press(load=1.0), contact.press(load=2.0)
    assert two.sink == pytest.approx(2 * one.sink, rel=1e-9)  # no pad lifts: linear
    by_way = contact.press(approach=one.approach)
    assert by_way.force.sum() == pytest.approx(1.0, rel=1e-9)
    # all lengths times s, forces times s^2, stiffness times s: the same strains
    s = 2.5
    large = array(
        np.array([2.0, 8.0, 4.0]) * s, ROW.x * s, ROW.y * s, lever=6.0 * s, length=2 * s, width=3 * s
    )
    scaled = PadsOnBody(large, Body(0.5, 0.49, 6.0 * s)).press(load=s**2)
    assert scaled.force == pytest.approx(s**2 * one.force, rel=1e-9)
    assert scaled.approach == pytest.approx(s * one.approach, rel=1e-9)
    # everything stiffer alike gives way less alike
    harder = PadsOnBody(array(np.array([2.0, 8.0, 4.0]) * 3, ROW.x, ROW.y, lever=6.0), Body(1.5, 0.49, 6.0))
    assert harder.press(load=3.0).sink == pytest.approx(one.sink, rel=1e-9)
    assert contact.press(load=3.0, modulus=1.5).force.sum() == pytest.approx(3.0)


def test_a_pad_far_from_others_is_a_spring_on_a_spring():
    """Pads 400 mm apart on a layer do not feel each other: K d = x (approach - d), the lever at infinity."""
    K = np.array([2.0, 8.0])
    body = Body(0.5, 0.49, 6.0)
    pressed = PadsOnBody(array(K, [0.0, 400.0], 0.0), body).press(approach=0.1)
    x = pad_stiffness(body, 2.0, 3.0)
    assert pressed.sink == pytest.approx(x * 0.1 / (x + K), rel=1e-6)


@pytest.mark.parametrize("angle", [(2.0, 0.0), (0.0, 4.0), (10.0, -20.0)])
def test_what_touches_presses_and_what_presses_touches(angle):
    """The conditions of contact by their own words, and the solution by another algorithm."""
    contact = PadsOnBody(ROW, Body(0.8, 0.45, 8.0))
    pressed = contact.press(load=0.7, angle=angle)
    x, y, a, b, f = pressed.patches.reshape(5, -1)
    surface = dense(contact) @ f
    local = pressed.patches[:2] - np.array([ROW.x, ROW.y])[:, :, None]
    pad = (
        pressed.sink[:, None] + (pressed.slope[:, 0, None] * local[0]) + pressed.slope[:, 1, None] * local[1]
    )
    gap = surface + pad.ravel() + x * tan(radians(angle[0])) + y * tan(radians(angle[1])) - pressed.approach
    assert (f >= 0).all() and f.sum() == pytest.approx(0.7)
    assert (gap > -1e-12).all() and np.abs(gap[f > 0]).max() < 1e-12
    assert pressed.force == pytest.approx(f.reshape(3, -1).sum(1))
    # non-negative least squares of the same energy
    B = np.zeros((len(f), 9))
    for i in range(3):
        rows = slice(i * len(f) // 3, (i + 1) * len(f) // 3)
        B[rows, 3 * i : 3 * i + 3] = contact.modes.T
    D = np.zeros((9, 9))
    for i in range(3):
        D[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] = ROW.compliance[i]
    upper = np.linalg.cholesky(dense(contact) + B @ D @ B.T).T
    back = x * tan(radians(angle[0])) + y * tan(radians(angle[1]))
    other = nnls(upper, np.linalg.solve(upper.T, pressed.approach - back))[0]
    assert other == pytest.approx(f, abs=1e-9)


def test_a_pad_on_its_stop_sinks_no_further_and_bears_more():
    stopped = array([2.0, 8.0, 4.0], ROW.x, ROW.y, lever=6.0, stop=[0.05, inf, inf])
    body = Body(0.8, 0.45, 8.0)
    soft, hard = (PadsOnBody(p, body).press(load=1.5) for p in (ROW, stopped))
    assert soft.sink[0] > 0.05 and hard.sink[0] == pytest.approx(0.05)
    assert hard.stopped.tolist() == [True, False, False]
    assert hard.force[0] > soft.force[0] and hard.force.sum() == pytest.approx(1.5)
    below = PadsOnBody(stopped, body).press(load=0.1)
    assert not below.stopped.any()


def test_a_low_pad_touches_last():
    low = array([4.0, 4.0], [0.0, 4.0], 0.0, height=[0.0, 0.5])
    contact = PadsOnBody(low, Body(0.5, 0.49, 6.0))
    assert contact.press(load=0.2).contact.tolist() == [1.0, 0.0]
    assert (contact.press(load=8.0).contact > 0).all()


def test_patches_fill_the_pad():
    for disc, area in ((False, 6.0), (True, 6.0 * pi / 4)):
        x, y, a, b = patches(2.0, 3.0, disc)
        assert (a * b).sum() == pytest.approx(area)
        assert (x * a * b).sum() == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize(
    "given, words",
    [
        (dict(modulus=0.0, poisson=0.4), "object E"),
        (dict(modulus=1.0, poisson=0.6), "object nu"),
        (dict(modulus=1.0, poisson=0.4, thickness=-1.0), "object thickness"),
        (dict(modulus=1.0, poisson=0.4, base="glued"), "object base"),
    ],
)
def test_an_impossible_body_is_refused(given, words):
    with pytest.raises(InputError, match=words):
        Body(**given)


def test_no_load_is_refused():
    with pytest.raises(InputError, match="load"):
        PadsOnBody(ROW, Body(1.0, 0.4)).press(load=0.0)
