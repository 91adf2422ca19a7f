"""The vacuum holder on the cart, and the rubber sample that it holds.

Air is drawn through the lid's holes into an octagonal plenum, whose flat walls let the port be drilled square.
The O-ring lies between lid and body, around the plenum and never under the sample.
"""

from __future__ import annotations

from math import cos, pi, sin

from tactcad.contour import Contour, Corner, circle, rectangle, rounded_polygon
from tactcad.parts.library import orings

from ..description import Extrusion, Hole, Material, Part, Pocket, Purchase
from ..library.screws import METRIC
from .cart import COLOUR, plate_alloy
from .holes import sunk
from .layout import RigLayout

RUBBER = Material("rubber", 1200)


def holder_body(rig: RigLayout) -> Part:
    """Plenum, seal groove, port in the front wall; z = 0 is the underside."""
    t, s, h = rig.holder_body, rig.holder_side / 2, rig.holder_screw
    inner, outer = orings.groove(rig.o_ring)
    flat = rig.holder.vacuum_diameter / 2
    m5 = METRIC["M5"]
    features = [
        Pocket("plenum", (0, 0, t), (0, 0, -1), (1, 0, 0), plenum(rig), rig.holder.plenum_depth),
        Pocket(
            "seal",
            (0, 0, t),
            (0, 0, -1),
            (1, 0, 0),
            circle((0, 0), outer),
            orings.GROOVE_DEPTH,
            (circle((0, 0), inner),),
        ),
        Hole(
            "port",
            (0, -s, t - rig.port_depth),
            (0, 1, 0),
            m5.tap_drill,
            round(s - flat, 9),
            True,
            thread="M5",
            thread_depth=min(6.0, round(s - flat, 9)),
        ),
    ]
    features += [
        Hole("screw", (sx * h, sy * h, t), (0, 0, -1), METRIC["M3"].clearance, t, True)
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    return Part(
        part_no=f"{rig.design.name}-holder-body",
        name="Sample holder, body",
        process="milled",
        material=plate_alloy(rig),
        body=Extrusion(rectangle(-s, -s, s, s), t),
        features=tuple(features),
        colour=COLOUR,
        finish="Ra 1.6; groove floor and face around it Ra 0.8, not anodised",
        notes=("break edges 0.2, the groove's 0.1",),
    )


def plenum(rig: RigLayout) -> Contour:
    """Octagon with rounded corners, its flats across the vacuum's diameter."""
    r = rig.holder.vacuum_diameter / 2 / cos(pi / 8)
    corners = [(r * cos(pi / 8 + k * pi / 4), r * sin(pi / 8 + k * pi / 4)) for k in range(8)]
    return rounded_polygon([Corner(at, rig.plenum_corner, "wall", "corner") for at in corners])


def holder_lid(rig: RigLayout) -> Part:
    """Plate under the sample with the suction holes; z = 0 is the underside."""
    t, s, h = rig.holder.lid_thickness, rig.holder_side / 2, rig.holder_screw
    holes = [
        Hole("suction", (x, y, t), (0, 0, -1), rig.holder.hole_diameter, t, True)
        for x, y in rig.suction_holes
    ]
    under = rig.holder_fixing[1]
    screws = [
        sunk("screw", "M3", (sx * h, sy * h, t), (0, 0, -1), t, under) for sx in (-1, 1) for sy in (-1, 1)
    ]
    return Part(
        part_no=f"{rig.design.name}-holder-lid",
        name="Sample holder, lid",
        process="milled",
        material=plate_alloy(rig),
        body=Extrusion(rectangle(-s, -s, s, s), t),
        features=tuple(holes + screws),
        colour="#aab2ba",
        finish="Ra 0.8 both faces, flat within 0.02",
        notes=("suction holes burr-free, not countersunk: rubber would be drawn in",),
    )


def sample(rig: RigLayout, dents: tuple[tuple[float, float], ...] = (), depth: float = 0.0) -> Part:
    """The rubber sample; with `dents` it is the reference shape under pads pressed `depth` into it."""
    d = rig.design
    half, t = d.sample.side / 2, d.sample.thickness
    a, b = d.element.pad_length / 2, d.sheet.thickness / 2
    pressed = bool(dents) and depth > 0
    pockets = tuple(
        Pocket("dent", (x, y, t), (0, 0, -1), (1, 0, 0), rectangle(-a, -b, a, b), depth)
        for x, y in dents
        if pressed
    )
    number = f"SAMPLE-{d.sample.side:g}x{d.sample.side:g}x{t:g}-rubber"
    return Part(
        part_no=f"{number}-pressed-{len(pockets)}x{depth:g}mm" if pressed else number,
        name=f"Rubber sample {d.sample.side:g} x {d.sample.side:g} x {t:g}",
        process="reference" if pressed else "bought",
        material=RUBBER,
        body=Extrusion(rectangle(-half, -half, half, half), t),
        features=pockets,
        colour="#b5523b",
        notes=("reference part: the object that is measured",),
        purchase=None
        if pressed
        else Purchase(
            f"rubber sheet {t:g} mm, cut to {d.sample.side:g} x {d.sample.side:g} mm",
            alternates="any rubber of 2 to 10 N/mm under one pad",
        ),
    )
