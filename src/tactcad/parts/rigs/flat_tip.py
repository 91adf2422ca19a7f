r"""Tip for the sample: a land of one pad's size under a round body.

+-------+   z = TIP: M6 from the top
|       |
|       |
+-+   +-+
  +---+     z = 0: land
"""

from __future__ import annotations

from math import ceil, hypot

from tactcad.contour import circle, rectangle

from ..description import Characteristic, Extrusion, Hole, Part, Pocket
from ..part_materials import STAINLESS
from .frame import TIP, TIP_LAND
from .stand_layout import StandLayout


def flat_tip(rig: StandLayout) -> Part:
    """Tip for the sample: a land of one pad's size under a round body. z = 0 is the land, the thread from
    the top."""
    d = rig.design
    a, b = d.element.pad_length / 2, d.sheet.thickness / 2
    body = max(10.0, float(ceil(2 * hypot(a, b) + 1.0)))  # 0.5 mm around the land's corners
    around = circle((0, 0), body)
    return Part(
        part_no=f"{d.name}-tip-flat",
        name=f"Tip, flat {d.element.pad_length:g} x {d.sheet.thickness:g}",
        process="milled",
        material=STAINLESS,
        body=Extrusion(around, TIP),
        features=(
            Pocket(
                "around_land", (0, 0, 0), (0, 0, 1), (1, 0, 0), around, TIP_LAND, (rectangle(-a, -b, a, b),)
            ),
            shaft_thread(),
        ),
        colour="#565d66",
        finish="land Ra 0.4, edges sharp, burr-free",
        characteristics=(
            Characteristic("land along x", 2 * a, 2 * a + 0.01, 2 * a - 0.01),
            Characteristic("land along y", 2 * b, 2 * b + 0.01, 2 * b - 0.01),
        ),
    )


def shaft_thread(
    at: tuple[float, float, float] = (0.0, 0.0, TIP), axis: tuple[float, float, float] = (0, 0, -1)
) -> Hole:
    """M6 for the gauge's shaft: 6 of its 10 mm engaged, a jam nut on the rest."""
    return Hole("shaft", at, axis, 5.0, 12.0, False, thread="M6", thread_depth=10.0, drill_point=True)
