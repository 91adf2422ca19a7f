"""What elasticity says of every hinge, over the whole range that is accepted: the fitted forms keep it.

Seeds are fixed; the designs stand in corners, on edges and inside of the range.
"""

from __future__ import annotations

import numpy as np
import pytest
from samples import draw_corners, draw_range, joined, section

from tactcad.mechanics import ladder, validity
from tactcad.mechanics.section import HingeSection

ROUNDING = 1e-13
IN_PLANE = (
    "hinge_thickness",
    "hinge_length",
    "fillet_radius",
    "load_arm",
    "arm_height",
    "body_height",
    "body_length",
)


@pytest.fixture(scope="module")
def designs() -> HingeSection:
    s = section(joined([draw_corners(1200, 7), draw_range(400, 8)]))
    assert np.all(validity.reasons(s, "solid") == "")
    return s


def in_range(s, rung):
    return ladder.evaluate(s, rung).stiffness


# Material that is added while the load's line and face stay where they are, and the clamped face too or
# grows: the slot's floor rises, its fillets grow, it is filled from either end, the body grows higher.
def thicker(s, by):
    return s.with_(hinge_thickness=s.hinge_thickness * (1 + by))


def rounder(s, by):
    return s.with_(fillet_radius=np.minimum(s.fillet_radius * (1 + by), s.hinge_length / 2))


def filled_at_the_arm(s, by):
    cut = by / (1 + by) * s.hinge_length
    return s.with_(hinge_length=s.hinge_length - cut, load_arm=s.load_arm + cut / 2)


def filled_at_the_body(s, by):
    cut = by / (1 + by) * s.hinge_length
    return s.with_(
        hinge_length=s.hinge_length - cut, load_arm=s.load_arm - cut / 2, body_length=s.body_length + cut
    )


def higher_body(s, by):
    return s.with_(body_height=s.body_height * (1 + by))


@pytest.mark.parametrize("rung", ladder.FITTED)
@pytest.mark.parametrize(
    "grow", [thicker, rounder, filled_at_the_arm, filled_at_the_body, higher_body], ids=lambda f: f.__name__
)
def test_no_stiffness_falls_where_material_is_added(designs, rung, grow):
    """Rayleigh: of two bodies under one load and one support the one that holds the other is the stiffer."""
    before, compared = in_range(designs, rung), 0
    for by in (1e-6, 1e-3, 0.03, 0.3, 2.0):
        after = in_range(grow(designs, by), rung)
        both = np.isfinite(after)
        compared += both.sum()
        assert np.all(after[both] >= before[both] * (1 - ROUNDING)), (by, (after / before)[both].min())
    assert compared > 1500


@pytest.mark.parametrize("rung", ladder.FITTED)
def test_no_stiffness_per_width_falls_with_the_width(designs, rung):
    """A wide sheet cut along its length into strips that carry their shares is no stiffer than before."""
    before = in_range(designs, rung) / designs.width
    for by in (1e-6, 1e-3, 0.03, 0.3, 2.0):
        wider = designs.with_(width=designs.width * (1 + by))
        after = in_range(wider, rung) / wider.width
        both = np.isfinite(after)
        assert both.sum() > 200 and np.all(after[both] >= before[both] * (1 - ROUNDING))


def test_plane_stress_is_never_stiffer_than_the_solid_nor_plane_strain_softer(designs):
    """Complementary energy of the plane field in the solid; and strains across the sheet held at zero."""
    plane, solid = in_range(designs, "plane"), in_range(designs, "solid")
    assert np.all(plane <= solid)
    assert np.all(solid <= plane / (1 - designs.poisson**2))


@pytest.mark.parametrize("rung", ladder.FITTED)
def test_stiffness_goes_with_every_scale(designs, rung):
    K = in_range(designs, rung)
    stiffer = designs.with_(youngs_modulus=designs.youngs_modulus * 69000.0)
    np.testing.assert_allclose(in_range(stiffer, rung), 69000.0 * K, rtol=1e-13)
    for scale in (0.04, 1.7, 25.0):
        in_plane = {name: getattr(designs, name) * scale for name in IN_PLANE}
        larger = designs.with_(**in_plane, width=designs.width * scale)
        np.testing.assert_allclose(ladder.stiffness(larger, rung), scale * K, rtol=1e-11)
        if rung == "plane":
            np.testing.assert_allclose(ladder.stiffness(designs.with_(**in_plane), rung), K, rtol=1e-11)
    if rung == "plane":
        wider = designs.with_(width=designs.width * 3.0)
        np.testing.assert_allclose(ladder.stiffness(wider, rung), 3.0 * K, rtol=1e-13)
