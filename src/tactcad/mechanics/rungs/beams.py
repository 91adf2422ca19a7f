"""Rungs short, beam and section: tip compliance (mm/N) by beam theory alone."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ..register import Rung
from ..section import Array, HingeSection

SHEAR_FACTOR = 5.0 / 6.0  # of a rectangular section (Timoshenko)
NODES = 24  # Gauss points over a fillet: rounding error only, down to t = n r/5
CLOSED_FORM_ABOVE = 5.0  # n r/t from which the integrals' closed forms keep their digits better


def short_hinge(s: HingeSection) -> Array:
    """C = 12 l L^2/(E b t^3): all compliance in a short leaf under constant moment, mm/N."""
    t, l, L, E, b = s.hinge_thickness, s.hinge_length, s.load_arm, s.youngs_modulus, s.width
    return 12.0 * l * (L / t) ** 2 / (E * b * t)


def beam(s: HingeSection) -> Array:
    """Leaf of full slot length with shear and linear moment, arm and body as Timoshenko beams, mm/N."""
    t, l, L, E, b = s.hinge_thickness, s.hinge_length, s.load_arm, s.youngs_modulus, s.width
    return uniform_leaf(l, L, t, E, b) + shear(l, t, s.shear_modulus, b) + arm(s) + body(s)


def section_integral(s: HingeSection) -> Array:
    """Bending and shear compliance of each section integrated over the slot, fillets included, mm/N.

    Paros and Weisbord (1965), Lobontiu (2002): C = int M(x)^2/(E I(x)) + 1/(5/6 G A(x)) dx with
    M = L + x from the hinge's centre. Arm and body as in `beam`.
    """
    t, r, L = s.hinge_thickness, s.fillet_radius, s.load_arm
    E, b, G, lc = s.youngs_modulus, s.width, s.shear_modulus, s.straight_length
    i0, i1, i2, i_shear = fillet_integrals(s.notch_sides * r / t)
    # both fillets together: moments about their inner ends are L -+ lc/2 -+ x, odd powers of x add lc
    moments = 2.0 * r * ((L * L + lc * lc / 4.0) * i0 + lc * r * i1 + r * r * i2)
    bending = 12.0 / (E * b * t**3) * moments
    shearing = 2.0 * r * i_shear / (SHEAR_FACTOR * G * b * t)
    return bending + shearing + uniform_leaf(lc, L, t, E, b) + shear(lc, t, G, b) + arm(s) + body(s)


def uniform_leaf(l: Array, L: Array, t: Array, E: Array, b: Array) -> Array:
    """12/(E b t^3) int (L + x)^2 dx over -l/2..l/2 = 12 (l L^2 + l^3/12)/(E b t^3), mm/N.

    ((L + l/2)^3 - (L - l/2)^3)/3 written out: the difference of cubes loses all digits at small l/L.
    """
    return 12.0 * l * (L * L + l * l / 12.0) / (E * b * t * t * t)


def shear(length: Array, height: Array, G: Array, b: Array) -> Array:
    """length/(5/6 G b height), mm/N."""
    return length / (SHEAR_FACTOR * G * b * height)


def arm(s: HingeSection) -> Array:
    """The arm from slot to load line as a cantilever with shear, mm/N."""
    reach = s.load_arm - s.hinge_length / 2.0
    # 4 s^3/(E b h^3), s = L - l/2, mm/N.
    slender = (s.load_arm - s.hinge_length / 2.0) / s.arm_height
    return (4.0 * slender * slender * slender / (s.youngs_modulus * s.width)) + shear(
        reach, s.arm_height, s.shear_modulus, s.width
    )


def body(s: HingeSection) -> Array:
    """The body from clamp to slot under the load's moment and shear, mm/N."""
    # 4 [(p + Lb)^3 - p^3]/(E b Hb^3), p = L + l/2, written out so that a short body keeps digits; mm/N.
    Hb, Lb = s.body_height, s.body_length
    p = s.load_arm + s.hinge_length / 2.0
    cubes = Lb * (3.0 * p * (p + Lb) + Lb * Lb)
    return (4.0 * cubes / (s.youngs_modulus * s.width * Hb * Hb * Hb)) + shear(
        s.body_length, s.body_height, s.shear_modulus, s.width
    )


def fillet_integrals(depth: Array) -> tuple[Array, Array, Array, Array]:
    """Integrals over a quarter-circle fillet in units of r and t; depth = n r/t.

    With the section t w(phi), w = 1 + depth (1 - cos phi), at x = r sin phi::

        i_k = int_0^{pi/2} sin^k phi cos phi / w^3 dphi  (k = 0, 1, 2),   i_shear = int cos phi / w dphi
    """
    depth = np.asarray(depth, dtype=float)
    i1 = 0.5 / (1.0 + depth)  # with c = cos phi: int_0^1 c dc/(1 + depth - depth c)^3
    deep = depth > CLOSED_FORM_ABOVE
    i0, i2, i_shear = _by_quadrature(np.where(deep, CLOSED_FORM_ABOVE, depth))
    if np.any(deep):
        exact = _in_closed_form(np.where(deep, depth, 2.0 * CLOSED_FORM_ABOVE))
        i0, i2, i_shear = (np.where(deep, e, q) for e, q in zip(exact, (i0, i2, i_shear)))
    return i0, i1, i2, i_shear


@lru_cache(maxsize=1)
def _gauss() -> tuple[tuple[float, float, float], ...]:
    """Rows of weight x cos phi, sin^2 phi, and 1 - cos phi at the Gauss points of 0..pi/2."""
    x, w = np.polynomial.legendre.leggauss(NODES)
    phi = (x + 1.0) * np.pi / 4.0
    rows = (w * np.pi / 4.0 * np.cos(phi), np.sin(phi) ** 2, 2.0 * np.sin(phi / 2.0) ** 2)
    return tuple(zip(*(row.tolist() for row in rows)))


def _by_quadrature(depth: Array) -> tuple[Array, Array, Array]:
    i0, i2, i_shear = (np.zeros_like(depth) for _ in range(3))
    for weight, sin2, versine in _gauss():
        v = 1.0 / (1.0 + depth * versine)
        term = weight * v
        i_shear += term
        term = term * v * v
        i0 += term
        i2 += sin2 * term
    return i0, i2, i_shear


def _in_closed_form(depth: Array) -> tuple[Array, Array, Array]:
    """The same for thin notches, whose integrand peaks: with c = 1 + 1/depth.

    A1 = int dphi/(c - cos phi) = 2 psi/sqrt(c^2 - 1), tan psi = 1/kappa, kappa^2 = (c - 1)/(c + 1);
    A2 = -dA1/dc = (c A1 + 1/c)/(c^2 - 1). i0 by tan(phi/2) = kappa tan psi; i2 by parts.
    """
    gap = 1.0 / depth
    c = 1.0 + gap
    square = gap * (c + 1.0)  # c^2 - 1
    kappa2 = gap / (c + 1.0)
    kappa = np.sqrt(kappa2)
    psi = np.arctan2(1.0, kappa)
    a1 = 2.0 * psi / np.sqrt(square)
    a2 = (c * a1 + 1.0 / c) / square
    k4 = kappa2 * kappa2
    even = (1.0 - k4) * (3.0 * psi / 8.0 + np.sin(4.0 * psi) / 32.0) + (1.0 + k4) * np.sin(2.0 * psi) / 4.0
    i0 = 2.0 * kappa / gap**3 * even
    i2 = 0.5 * ((2.0 * c * c - 1.0) * a2 - 4.0 * c * a1 + np.pi)
    i_shear = c * a1 - np.pi / 2.0
    return i0 / depth**3, i2 / depth**3, i_shear / depth


SHORT = Rung("short", 1, "orders of magnitude, by hand", lambda s, _: short_hinge(s), constant_moment=True)
BEAM = Rung("beam", 2, "to see what beams alone explain", lambda s, _: beam(s))
SECTION = Rung("section", 3, "notches with r/t far above 1", lambda s, _: section_integral(s))
