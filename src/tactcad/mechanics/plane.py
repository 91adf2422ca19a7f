"""Rung plane: the leaf between two elastic roots, arm and body, in plane stress.

With rho = r/t, q = t/height of the block, p = L + l/2 and n the number of slotted faces::

    C = 12/(E b t^3) [lc L^2 + lc^3/12 + t ga (L - lc/2 - ga t/2)^2 + t gb (L + lc/2 + gb t/2)^2]
        + [lc + s t (ga + gb) - s0 t]/(5/6 G b t) + C_arm + C_body
        + 12 e (L - l/2)/(E b h) - 12 c nu^2 p^2/(E b Hb^2)
    g = sqrt(A rho + p0 - p1/(1 + p2 rho)) - p3 q^2 - (p4 rho + p5) q^3 - p6 exp(-p7 l/t)
        [- p8 (t/Lb)^3 in gb]

g t is the hinge length that one filleted root adds. A = (3 pi/16)^2 2/n is the exact limit of a thin
notch; p6, p7 are what two roots close to each other take from one another, p8 what a clamp close
behind the body's root takes from it; e couples moment and shear in the arm's root; c is the clamp's
grip on the body's end, which may not narrow. All these letters but A are constants of the fit.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from .beams import SHEAR_FACTOR, arm, body
from .constants import by_sides
from .section import Array, HingeSection

THIN_NOTCH = (3.0 * np.pi / 16.0) ** 2 * 2.0  # over n: squared root length per r/t as r/t grows

Constants = Mapping[str, Array | float]


def root_lengths(s: HingeSection, k: Constants | None = None) -> tuple[Array, Array]:
    """g of the roots to arm and body, in units of the hinge thickness."""
    k = k or by_sides("root", s.two_sided)
    t = s.hinge_thickness
    rho = s.fillet_radius / t
    notch = np.sqrt(THIN_NOTCH / s.notch_sides * rho + k["p0"] - k["p1"] / (1.0 + k["p2"] * rho))
    alone = notch - k["p6"] * np.exp(-k["p7"] * s.hinge_length / t)
    cubic = k["p4"] * rho + k["p5"]

    def root(height: Array) -> Array:
        q = t / height
        return alone - q * q * (k["p3"] + cubic * q)

    near_clamp = t / s.body_length
    return root(s.arm_height), root(s.body_height) - k["p8"] * near_clamp * near_clamp * near_clamp


def compliance(s: HingeSection, k: Constants | None = None) -> Array:
    """Tip compliance in plane stress, mm/N; `k` are the root's constants, by default the shipped ones."""
    k = k or by_sides("root", s.two_sided)
    t, L, E, b = s.hinge_thickness, s.load_arm, s.youngs_modulus, s.width
    lc, G, nu, Hb = s.straight_length, s.shear_modulus, s.poisson, s.body_height
    ga, gb = root_lengths(s, k)
    to_arm, to_body = L - lc / 2.0 - ga * t / 2.0, L + lc / 2.0 + gb * t / 2.0
    bending = lc * (L * L + lc * lc / 12.0) + t * (ga * to_arm * to_arm + gb * to_body * to_body)
    shearing = lc + t * (k["s"] * (ga + gb) - k["s0"])
    coupling = k["e"] * (L - s.hinge_length / 2.0) / s.arm_height
    grip = k["c"] * (nu * (L + s.hinge_length / 2.0) / Hb) ** 2
    return (
        12.0 / (E * b) * (bending / (t * t * t) + coupling - grip)
        + shearing / (SHEAR_FACTOR * G * b * t)
        + arm(s)
        + body(s)
    )


def compliance_by(s: HingeSection, data: dict | None = None) -> Array:
    """Tip compliance in plane stress, mm/N, by the constants in `data` (as data/ladder.json), else the
    shipped ones."""
    return compliance(s, by_sides("root", s.two_sided, data))
