"""Rung solid: the plane rung times a width factor to three dimensions.

    K3D = K2D [1 + nu^2/(1 - nu^2) psi]
    psi = (1 - wa - wb/2) [1 + c1 x + c2 y + c3 x^2 + c4 x y + c5 y^2 + c6 r/b + c7 y r/l + c8 nu x]

with x = l/b, y = t/b; wa and wb are the shares of the tip compliance that arm and body bring by
bending. psi is 0 for a narrow strip and 1 in plane strain: near the free sides of the leaf, over a
width that goes with l and t, it may curl; arm and body, narrow beams, curl almost freely.
"""

from __future__ import annotations

from . import plane
from .beams import arm_bending, body_bending
from .constants import by_sides
from .section import Array, HingeSection


def width_factor(s: HingeSection, plane_compliance: Array, k: plane.Constants | None = None) -> Array:
    """K3D/K2D; `plane_compliance` (mm/N) as `plane.compliance` gives it."""
    k = k or by_sides("width", s.two_sided)
    b, nu, r, l = s.width, s.poisson, s.fillet_radius, s.hinge_length
    x, y = l / b, s.hinge_thickness / b
    leaf = (
        1.0 + x * (k["c1"] + k["c3"] * x + k["c4"] * y + k["c8"] * nu)
        + y * (k["c2"] + k["c5"] * y + k["c7"] * (r / l)) + k["c6"] * (r / b)
    )
    curling = (arm_bending(s) + body_bending(s) / 2.0) / plane_compliance
    psi = (1.0 - curling) * leaf
    return 1.0 + nu * nu / (1.0 - nu * nu) * psi


def compliance(s: HingeSection) -> Array:
    """Tip compliance of the solid, mm/N."""
    flat = plane.compliance(s)
    return flat / width_factor(s, flat)
