"""Rung plane: the leaf between two elastic roots, arm and body, in plane stress."""

from __future__ import annotations

import numpy as np

from .beams import SHEAR_FACTOR, arm, body
from .constants import by_sides
from .section import Array, HingeSection


def root_length(s: HingeSection, height: Array) -> Array:
    """Extra hinge length g, in units of t, that one filleted root to a block of that height adds."""
    k = by_sides("root", s.two_sided)
    rho = s.fillet_radius / s.hinge_thickness
    q = s.hinge_thickness / height
    q3 = q * q * q
    thin_notch = k["A"] * rho + k["p0"] - k["p1"] / (1.0 + k["p2"] * rho)
    return np.sqrt(thin_notch) - k["p3"] * q * q - (k["p4"] * rho + k["p5"]) * q3


def compliance(s: HingeSection) -> Array:
    """Tip compliance in plane stress, mm/N."""
    t, L, E, b = s.hinge_thickness, s.load_arm, s.youngs_modulus, s.width
    lc, G = s.straight_length, s.shear_modulus
    k = by_sides("root", s.two_sided)
    ga, gb = root_length(s, s.arm_height) * t, root_length(s, s.body_height) * t
    to_arm, to_body = L - lc / 2.0 - ga / 2.0, L + lc / 2.0 + gb / 2.0
    bending = lc * (L * L + lc * lc / 12.0) + ga * to_arm * to_arm + gb * to_body * to_body
    shearing = lc + k["s"] * (ga + gb)
    return 12.0 / (E * b * t * t * t) * bending + shearing / (SHEAR_FACTOR * G * b * t) + arm(s) + body(s)
