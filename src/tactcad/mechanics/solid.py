"""Rung solid: the plane rung times a width factor to three dimensions."""

from __future__ import annotations

from . import plane
from .constants import by_sides
from .section import Array, HingeSection


def width_factor(s: HingeSection) -> Array:
    """K3D/K2D = 1 + nu^2/(1 - nu^2) psi; psi goes from 0 (narrow strip) to 1 (plane strain)."""
    k = by_sides("width", s.two_sided)
    t, b, nu = s.hinge_thickness, s.width, s.poisson
    effective = s.straight_length + t * (
        plane.root_length(s, s.arm_height) + plane.root_length(s, s.body_height)
    )
    psi = 1.0 - (k["alpha"] * effective + k["beta"] * t) / b
    return 1.0 + nu * nu / (1.0 - nu * nu) * psi


def compliance(s: HingeSection) -> Array:
    """Tip compliance of the solid, mm/N."""
    return plane.compliance(s) / width_factor(s)
