"""The array's elements as the mechanics sees them."""

from __future__ import annotations

from collections.abc import Sequence

from tactcad.design.materials import ALLOYS, Alloy
from tactcad.design.tree import Design
from tactcad.mechanics.section import HingeSection

from .layout import ElementPlace, Layout


def hinge_section(layout: Layout, places: Sequence[ElementPlace]) -> HingeSection:
    """Section parameters of the elements at `places`, arrays of shape (len(places),); mm, MPa."""
    d = layout.design
    return HingeSection(
        hinge_thickness=[p.hinge.t for p in places],
        hinge_length=[p.hinge.l for p in places],
        fillet_radius=[p.hinge.r for p in places],
        load_arm=[p.load_arm for p in places],
        arm_height=[p.hinge.h for p in places],
        body_height=d.element.body_height,
        body_length=[p.body_length for p in places],
        poisson=d.material.poisson,
        youngs_modulus=d.material.youngs_modulus,
        width=d.sheet.thickness,
        two_sided=d.element.sides == "two",
        pad_height=d.element.pad_height,
        friction=d.rating.friction,
    )


def design_alloy(design: Design) -> Alloy:
    """The design's alloy with the values that the design file gives."""
    m, known = design.material, ALLOYS[design.material.alloy]
    return Alloy(
        m.alloy,
        m.youngs_modulus,
        m.poisson,
        m.density,
        m.yield_strength,
        m.fatigue_strength,
        known.source,
        known.tensile_strength,
    )
