r"""The rubber sample; pressed, with a dent under each pad.

+--+ +--+ +--+   z = thickness
|  +-+  +-+  |   dents
+------------+   z = 0: on the lid
"""

from __future__ import annotations

from tactcad.contour import rectangle

from ..description import Extrusion, Part, Pocket, Purchase
from ..part_materials import RUBBER
from .cart_layout import CartLayout


def sample(rig: CartLayout, dents: tuple[tuple[float, float], ...] = (), depth: float = 0.0) -> Part:
    """The rubber sample; with `dents` it is the reference shape under pads pressed `depth` into it."""
    d = rig.design
    half, t = rig.sample.side / 2, rig.sample.thickness
    a, b = d.element.pad_length / 2, d.sheet.thickness / 2
    pressed = bool(dents) and depth > 0
    pockets = tuple(
        Pocket("dent", (x, y, t), (0, 0, -1), (1, 0, 0), rectangle(-a, -b, a, b), depth)
        for x, y in dents
        if pressed
    )
    number = f"SAMPLE-{rig.sample.side:g}x{rig.sample.side:g}x{t:g}-rubber"
    if (
        pressed
    ):  # one pad and the force gauge's tip make equal dents in different places: the first one stands for all
        x, y = dents[0]
        number += f"-pressed-{len(pockets)}x{depth:g}mm-at-{x + 0.0:g}x{y + 0.0:g}"
    return Part(
        part_no=number,
        name=f"Rubber sample {rig.sample.side:g} x {rig.sample.side:g} x {t:g}",
        process="reference" if pressed else "bought",
        material=RUBBER,
        body=Extrusion(rectangle(-half, -half, half, half), t),
        features=pockets,
        colour="#b5523b",
        notes=("reference part: the object that is measured",),
        purchase=None
        if pressed
        else Purchase(
            f"rubber sheet {t:g} mm, cut to {rig.sample.side:g} x {rig.sample.side:g} mm",
            alternates="any rubber of 2 to 10 N/mm under one pad",
        ),
    )
