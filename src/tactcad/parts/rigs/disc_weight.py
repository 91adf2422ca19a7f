r"""One added weight, bought: a steel disc with a bore for the platform's pin; its height follows from its
mass.

+------+ +------+
|      | |      |   z up
+------+ +------+
"""

from __future__ import annotations

from tactcad.contour import circle

from ..description import Extrusion, Part, Purchase
from ..part_materials import CARBON_STEEL
from .frame import PIN
from .guide_layout import GuideLayout


def disc_weight(rig: GuideLayout) -> Part:
    """One added weight: a steel disc on the platform's pin; its height follows from its mass."""
    diameter = rig.grasping.weight_diameter
    outer, bore = circle((0, 0), diameter), circle((0, 0), PIN + 0.5)
    height = round(rig.weight_mass / ((outer.area - bore.area) * CARBON_STEEL.density * 1e-6), 3)
    return Part(
        part_no=f"WEIGHT-{rig.weight_mass:.4g}g-{diameter:g}-disc",
        name=f"Disc weight {rig.weight_mass:.4g} g",
        process="bought",
        material=CARBON_STEEL,
        body=Extrusion(outer, height, (bore,)),
        colour="#c9a227",
        purchase=Purchase(
            f"disc weight {rig.weight_mass:.4g} g, bore {PIN + 0.5:g}, diameter {diameter:g}, checked on "
            "a balance to 0.1 g",
            alternates="slotted weights of the same mass",
        ),
        mass_override=rig.weight_mass,
    )
