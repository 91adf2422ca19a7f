"""Parts made with the kernel's own binding are what build123d makes of the same steps."""

from __future__ import annotations

import pytest

from tactcad.contour import circle
from tactcad.parts.language.description import Extrusion, Hole, Material, Part
from tactcad.solids.build import OUTSIDE, build
from tactcad.solids.step import to_bytes

pytestmark = pytest.mark.cad


def test_a_disc_with_a_hole_is_build123ds_byte_for_byte():
    from build123d import Face, Plane, Solid, Vector, Wire

    hole = Hole("hole", (3.0, 1.0, 2.0), (0.0, 0.0, -1.0), 1.5, 2.0, True)
    body = Extrusion(circle((0, 0), 12), 2.0)
    part = Part("DISC", "disc", "milled", Material("steel", 7850.0), body, (hole,))
    drill = Solid.make_cylinder(0.75, 2 + 2 * OUTSIDE, Plane((3, 1, 2 + OUTSIDE), z_dir=(0, 0, -1)))
    disc = Solid.extrude(Face(Wire.make_circle(6)), Vector(0, 0, 2)).cut(drill)
    assert to_bytes(build(part)) == to_bytes(disc.solid().wrapped)
