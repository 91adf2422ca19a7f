r"""Disc under the weights that brings what moves to the weight that the design asks for.

+------+ +------+
+------+ +------+   thickness from the missing mass
"""

from __future__ import annotations

from tactcad.contour import Contour, circle

from ..description import Extrusion, Part
from ..part_materials import PLAIN_STEEL
from .frame import PIN
from .guide_layout import GuideLayout


def ballast(rig: GuideLayout, mass: float) -> Part:
    """Disc under the weights that brings the moving mass to the design's; `mass` in g, thickness to 0.01
    mm.
    """
    outer, bore = _disc(rig)
    thickness = round(ballast_thickness(rig, mass), 2)
    return Part(
        part_no=f"{rig.design.name}-ballast",
        name=f"Trim ballast, disc {rig.grasping.weight_diameter:g} x {thickness:g} mm",
        process="turned",
        material=PLAIN_STEEL,
        body=Extrusion(outer, thickness, (bore,)),
        colour="#50575f",
        finish="as turned; weighed with all that moves, and thinned until that is right",
        notes=("break edges 0.5",),
    )


def ballast_thickness(rig: GuideLayout, mass: float) -> float:
    """Thickness (mm) of a ballast of that mass (g)."""
    outer, bore = _disc(rig)
    return mass / ((outer.area - bore.area) * PLAIN_STEEL.density * 1e-6)


def _disc(rig: GuideLayout) -> tuple[Contour, Contour]:
    """Outline and bore of the ballast: the weights'."""
    return circle((0, 0), rig.grasping.weight_diameter), circle((0, 0), PIN + 0.5)
