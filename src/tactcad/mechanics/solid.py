"""Rung solid: the plane rung times a width factor to three dimensions.

    K3D = K2D [1 + nu^2/(1 - nu^2) psi]
    psi = (1 - wa - wb) leaf + wa/(1 + ca h/b) + wb/(1 + cb Hb/b)
    leaf = 1 + c1 x + c2 y + c3 x^2 + c4 x y + c5 y^2 + c6 r/b + c7 y r/l + c8 nu x + c9 y t/l + c10 t/Hb

with x = l/b, y = t/b; wa and wb are the shares of the tip compliance that arm and body bring by
bending. psi is 0 for a narrow strip and 1 in plane strain: near the free sides of the leaf, over a
width that goes with l and t, it may curl; arm and body are beams of their own height.
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
    h, Hb, t = s.arm_height, s.body_height, s.hinge_thickness
    x, y = l / b, t / b
    leaf = (
        1.0
        + x * (k["c1"] + k["c3"] * x + k["c4"] * y + k["c8"] * nu)
        + y * (k["c2"] + k["c5"] * y + k["c7"] * (r / l) + k["c9"] * (t / l))
        + k["c6"] * (r / b)
        + k["c10"] * (t / Hb)
    )
    wa, wb = arm_bending(s) / plane_compliance, body_bending(s) / plane_compliance
    psi = (1.0 - wa - wb) * leaf + wa / (1.0 + k["ca"] * (h / b)) + wb / (1.0 + k["cb"] * (Hb / b))
    return 1.0 + nu * nu / (1.0 - nu * nu) * psi


def compliance(s: HingeSection) -> Array:
    """Tip compliance of the solid, mm/N."""
    return compliance_by(s)


def compliance_by(s: HingeSection, data: dict | None = None) -> Array:
    """The same by the constants in `data` (as data/ladder.json), else the shipped ones."""
    flat = plane.compliance_by(s, data)
    return flat / width_factor(s, flat, by_sides("width", s.two_sided, data))
