r"""Clamp of the bonding fixture: a bar whose weight presses the gauge, and the rubber under its nose.

+--o---o-------o---o--+
|                     |   slides down on the nest's pins
+------+       +------+
       |_______|          nose: as long as the gauge's carrier
        =======           rubber
"""

from __future__ import annotations

from tactcad.contour import Corner, rectangle, rounded_polygon

from ..description import Extrusion, Hole, Part, Purchase
from ..limits import FACES, DatumFeature, Geometric, within
from ..part_materials import RUBBER
from ..plate import BREAK_EDGES, PLACE, RIG_COLOUR, THICKNESS
from .bonding_layout import PAD, ROOT, BondingLayout, kind_suffix

NOSE = 0.05  # mm, nose's length, plus and minus; chosen: it is no longer than what it presses
WEIGHT = 0.05  # of its mass, plus and minus: half of the pressure's own digit


def bonding_clamp(rig: BondingLayout) -> Part:
    """Bar that presses by its weight: contour in (x, height over the nose's end), extruded across."""
    (left, right), (before, behind) = rig.bar_x, rig.pad_x
    under = round(rig.bar_bottom - rig.nose, 9)
    top = round(under + rig.bar_height, 9)
    outer = rounded_polygon(
        [
            Corner((before, 0.0), edge="nose"),
            Corner((behind, 0.0), edge="nose_back"),
            Corner((behind, under), ROOT, "under_back", "nose_root"),
            Corner((right, under), edge="right"),
            Corner((right, top), edge="top"),
            Corner((left, top), edge="left"),
            Corner((left, under), edge="under_front"),
            Corner((before, under), ROOT, "nose_front", "nose_root"),
        ]
    )
    return Part(
        part_no=f"{rig.design.name}-bonding-clamp{kind_suffix(rig)}",
        name="Bonding fixture, clamp bar",
        process="wire-cut",
        material=rig.bar_material,
        body=Extrusion(outer, rig.width),
        features=tuple(
            Hole("pin_hole", (x, top, rig.width / 2 + y), (0, -1, 0), rig.bar_hole, rig.bar_height, True)
            for x, y in rig.bar_holes
        ),
        colour=RIG_COLOUR,
        finish="Ra 1.6",
        notes=(BREAK_EDGES, f"its weight presses: {rig.bar_mass:.3g} g within {WEIGHT:.0%}, weighed"),
        characteristics=(
            within("nose length", behind - before, NOSE, between=("nose_front", "nose_back")),
            within("thickness", rig.width, THICKNESS, between=FACES),
        ),
        geometric=(Geometric("pin holes", "position", PLACE, ("pin_hole",), ("A", "B", "C"), True),),
        datums=(DatumFeature("A", "top"), DatumFeature("B", FACES[0]), DatumFeature("C", "right")),
    )


def bonding_pad(rig: BondingLayout) -> Part:
    """Rubber under the nose, as large as the gauge's carrier."""
    before, behind = rig.pad_x
    half = rig.pad_width / 2
    size = f"{behind - before:g} x {2 * half:g}"
    return Part(
        part_no=f"PAD-{behind - before:g}x{2 * half:g}x{PAD:g}-rubber",
        name=f"Rubber pad {size} x {PAD:g}",
        process="bought",
        material=RUBBER,
        body=Extrusion(rectangle(before, -half, behind, half), PAD),
        colour="#b5523b",
        purchase=Purchase(
            f"silicone rubber sheet {PAD:g} mm, 50 Shore A, cut to {size} mm",
            alternates="the rubber pads that gauge makers sell",
        ),
        spares=2,
    )
