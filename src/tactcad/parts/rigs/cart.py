"""The wheeled cart, its vacuum holder and the sample: where everything is, derived once from the design, and
its parts.

The rigs' frame: z = 0 on the base plate, x = y = 0 the middle of the cart at rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import ceil, cos, floor, hypot, pi, sin, sqrt

from tactcad.contour import Contour, Corner, chain, circle, rectangle, rounded_polygon
from tactcad.design.fields import present
from tactcad.design.tree import Cart, Design, Holder, Sample

from ..bought import standard_parts
from ..bought.screws import CAP_SCREW_LENGTHS
from ..bought.standard_parts import BEARINGS, Bearing
from ..language.description import Extrusion, Feature, Hole, Part, Pocket, Purchase, Revolution
from ..language.limits import FACES, Characteristic, DatumFeature, Geometric, within
from ..language.metric import METRIC, SUNK, TAP_REACH, corners, engagement, sunk, tapped
from ..language.stock import BRASS, RUBBER, STAINLESS, plate

# mm, largest gap of a wheel to the plane of the other three; chosen: the thinnest practical feeler.
LOOSE_WHEEL = 0.02
EDGE = 4.0  # screws of lid and holder from their edge
GROOVE_WALL = 1.0  # least material around plenum and groove


def cart_layout(design: Design) -> CartLayout | None:
    """The cart of a design; None if it lacks one of the tables cart, holder and sample."""
    if design.cart is None or design.holder is None or design.sample is None:
        return None
    return CartLayout(design, design.cart, design.holder, design.sample)


@dataclass(frozen=True)
class CartLayout:
    """Derived dimensions of cart, holder and sample (mm)."""

    design: Design
    cart: Cart
    holder: Holder
    sample: Sample

    # --- cart ---

    @property
    def bearing(self) -> Bearing:
        return BEARINGS[self.cart.bearing]

    @property
    def axle_thread(self) -> str:
        return f"M{self.bearing.d:g}"

    @cached_property
    def axle_length(self) -> float:
        """Shortest ISO 4762 screw whose plain shank carries the whole bearing: there is one even for the
        thickest shims.

        The standard's threaded length is 2 d + 12; longer screws have a plain shank for the rest.
        """
        m = METRIC[self.axle_thread]
        need = self.cart.shim + self.bearing.B
        lengths = CAP_SCREW_LENGTHS[self.axle_thread]
        return next(n for n in lengths if n - (2 * m.d + 12) >= need)

    @property
    def axle_z(self) -> float:
        return self.bearing.D / 2

    @property
    def axle_in_plate(self) -> float:
        """Depth of the axle in the plate."""
        return round(self.axle_length - 2 * self.cart.shim - self.bearing.B, 9)

    @property
    def wheel_y(self) -> float:
        """y of the wheels' mid-planes."""
        return round(self.cart.width / 2 + self.cart.shim + self.bearing.B / 2, 9)

    @property
    def cart_half(self) -> float:
        """Half the cart's width over the axles' heads."""
        return self.wheel_y + self.bearing.B / 2 + self.cart.shim + METRIC[self.axle_thread].head_height

    @property
    def contacts(self) -> tuple[tuple[float, float], ...]:
        """The wheels' contacts with the base plate: the mid-planes, in order around the cart."""
        x, y = self.cart.wheel_base / 2, self.wheel_y
        return ((x, y), (-x, y), (-x, -y), (x, -y))

    @property
    def cart_top(self) -> float:
        return round(self.cart.clearance + self.cart.thickness, 9)

    # --- sample holder ---

    @property
    def holder_side(self) -> float:
        """Whole millimetres: what the shop cuts."""
        return float(ceil(self.sample.side + 2 * self.holder.margin - 1e-9))

    @property
    def holder_body(self) -> float:
        """Thickness of the holder's body."""
        return round(self.holder.plenum_depth + self.holder.floor, 9)

    @property
    def holder_screw(self) -> float:
        """x and y of the screws that hold lid and body on the cart."""
        return round(self.holder_side / 2 - EDGE, 9)

    @cached_property
    def holder_fixing(self) -> tuple[float, float] | None:
        """M3 screw through lid and body into the cart: length, and the lid under its sunk head; None if none
        fits."""
        most = round(self.holder.lid_thickness - METRIC["M3"].head_height - SUNK, 9)
        for length in CAP_SCREW_LENGTHS["M3"]:
            under = round(min(most, length - self.holder_body - engagement("M3")), 9)
            deepest = min(self.cart.thickness, TAP_REACH * METRIC["M3"].d)
            if under >= 2.0 and length - self.holder_body - under <= deepest + 1e-9:
                return length, under
        return None

    @property
    def plenum_corner(self) -> float:
        """Radius in the corners of the octagonal plenum: room for a mill half as deep."""
        return min(5.0, self.holder.vacuum_diameter / 5)

    @property
    def plenum_reach(self) -> float:
        """Largest distance of the plenum's wall from the middle."""
        half, r = self.holder.vacuum_diameter / 2, self.plenum_corner
        return (half - r) / cos(pi / 8) + r

    @cached_property
    def o_ring(self) -> str | None:
        """Size code of the smallest O-ring around the plenum."""
        return standard_parts.size_around(2 * (self.plenum_reach + GROOVE_WALL))

    @property
    def port_depth(self) -> float:
        """The port's axis below the body's upper face: just over the plenum's floor."""
        return round(self.holder.plenum_depth - METRIC["M5"].tap_drill / 2 - 0.9, 9)

    @cached_property
    def suction_holes(self) -> tuple[tuple[float, float], ...]:
        """Middles of the holes: hexagonal rings that fill the vacuum's circle, 1 + 3 n (n + 1) of them."""
        rings = self.holder.rings
        # to steps of a tenth along both, so that the sheet's sizes are the holes'
        pitch = (
            floor((self.holder.vacuum_diameter - 2 * self.holder.hole_diameter) / 2 / rings * 5 + 1e-6) / 5
        )
        row = round(pitch * sqrt(3) / 2, 1)
        spots = []
        for i in range(-rings, rings + 1):
            for j in range(-rings, rings + 1):
                if abs(i + j) <= rings:
                    spots.append((round(pitch * (i + j / 2), 6), round(row * j, 6)))
        return tuple(spots)

    @property
    def lid_top(self) -> float:
        return round(self.cart_top + self.holder_body + self.holder.lid_thickness, 9)

    @property
    def sample_top(self) -> float:
        return round(self.lid_top + self.sample.thickness, 9)

    @property
    def screw_circle(self) -> float:
        """Distance of the lid's screws from the middle."""
        return hypot(self.holder_screw, self.holder_screw)


def cart_plate(rig: CartLayout) -> Part:
    """Plate with the axles' threads in its sides and the holder's in its face; z = 0 is the underside.

      +-o---------o-+   axles: cap screws into the sides
      |  o       o  |   ^ y
      |             |   |     holder's four M3 threads
      |  o       o  |   +-> x
      +-o---------o-+

    The inner rings are clamped between shims, so the outer rings clear plate and head by a shim and cannot
    bind. The shanks' play in the bores (up to 0.14 mm) lets all four wheels be set on a flat plate before the
    axles are tightened.
    """
    c, t = rig.cart, rig.cart.thickness
    m = METRIC[rig.axle_thread]
    x, y = c.length / 2, c.width / 2
    entry = round(rig.axle_in_plate - 2 * m.d, 9)  # the last 2 d of the axle are engaged
    axles = tuple(
        Hole(
            "axle",
            (sx * c.wheel_base / 2, sy * y, rig.axle_z - c.clearance),
            (0, -sy, 0),
            m.tap_drill,
            round(rig.axle_in_plate + 1.0 + 2 * m.pitch, 9),
            False,
            counterbore=(m.clearance, entry),
            thread=rig.axle_thread,
            thread_depth=2 * m.d + 1.0,
            drill_point=True,
        )
        for sx in (-1.0, 1.0)
        for sy in (-1.0, 1.0)
    )
    h, (length, under) = rig.holder_screw, present(rig.holder_fixing)
    engaged = length - under - rig.holder_body
    holder = tuple(tapped("holder", "M3", (px, py, t), (0, 0, -1), t, engaged) for px, py in corners(h, h))
    return plate(
        rig.design,
        "cart-plate",
        "Cart plate",
        Extrusion(rectangle(-x, -y, x, y), t),
        axles + holder,
        notes=("break edges 0.2", "axle threads of one side in one setting"),
        characteristics=(within(AXLES_OVER, rig.axle_z - c.clearance, AXLES, between=(FACES[0], "axle")),),
    )


# mm, plus and minus; chosen: as the end plates' dowel holes. What four of them are off a plane, the
# shanks' play in the bores nearly always takes up (requirement "wheels touch").
AXLES = 0.015
AXLES_OVER = "axles over the underside"


# mm; chosen: a ring faced on both sides holds it, and it is small against the air that the shim gives
SHIM_TOLERANCE = 0.02


def axle_shim(rig: CartLayout) -> Part:
    """Ring next to an inner ring, narrower than the shield: the outer ring stays free.

    +---+
    | o |   o: bore for the axle
    +---+
    """
    b, t = rig.bearing, rig.cart.shim
    bore = round(b.d + 0.1, 6)
    outside = round(b.inner - 0.1, 6)
    return Part(
        part_no=f"SHIM-{bore:g}x{outside:g}x{t:g}-ring",
        name=f"Shim ring {bore:g}x{outside:g}x{t:g}",
        process="turned",
        material=STAINLESS,
        body=Extrusion(circle((0, 0), outside), t, (circle((0, 0), bore),)),
        colour="#5c6066",
        finish="burr-free",
        characteristics=(within("thickness", t, SHIM_TOLERANCE, between=FACES),),
        geometric=(Geometric("parallelism", "parallelism", 0.01, (FACES[1],), ("A",)),),
        datums=(DatumFeature("A", FACES[0]),),
        spares=2,
    )


def holder_body(rig: CartLayout) -> Part:
    r"""Octagonal plenum, whose flat walls let the port be drilled square, seal groove and port; z = 0 is the
    underside.

    +-----------------+
    | O    ____     O |
    |    /      \     |   plenum inside, the O-ring's groove around it,
    |   |        |    |   never under the sample
    |    \ ____ /     |
    | O     ||      O |
    +-------||--------+   port in the front wall
    """
    t, s, h = rig.holder_body, rig.holder_side / 2, rig.holder_screw
    inner, outer = standard_parts.groove(present(rig.o_ring))
    flat = rig.holder.vacuum_diameter / 2
    m5, depth = METRIC["M5"], standard_parts.GROOVE_DEPTH
    least, most = standard_parts.GROOVE_DEPTHS
    features: list[Feature] = [
        Pocket("plenum", (0, 0, t), (0, 0, -1), (1, 0, 0), plenum(rig), rig.holder.plenum_depth),
        Pocket(
            "seal",
            (0, 0, t),
            (0, 0, -1),
            (1, 0, 0),
            circle((0, 0), outer),
            standard_parts.GROOVE_DEPTH,
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
        Hole("screw", (px, py, t), (0, 0, -1), METRIC["M3"].clearance, t, True) for px, py in corners(h, h)
    ]
    return plate(
        rig.design,
        "holder-body",
        "Sample holder, body",
        Extrusion(rectangle(-s, -s, s, s), t),
        features,
        finish="Ra 1.6; groove floor and face around it Ra 0.8, not anodised",
        notes=("break edges 0.2, the groove's 0.1",),
        characteristics=(Characteristic(SEAL_DEPTH, depth, most, least, between=(FACES[1], "seal")),),
    )


SEAL_DEPTH = "seal depth"


def plenum(rig: CartLayout) -> Contour:
    """Octagon with rounded corners, its flats across the vacuum's diameter."""
    r = rig.holder.vacuum_diameter / 2 / cos(pi / 8)
    corners = [(r * cos(pi / 8 + k * pi / 4), r * sin(pi / 8 + k * pi / 4)) for k in range(8)]
    return rounded_polygon([Corner(at, rig.plenum_corner, "wall", "corner") for at in corners])


def holder_lid(rig: CartLayout) -> Part:
    """Plate under the sample with the suction holes; z = 0 is the underside.

    +-----------+
    | O       O |
    |    . .    |   . suction holes
    |   . . .   |
    |    . .    |
    | O       O |   O screws through body into the cart, sunk
    +-----------+
    """
    t, s, h = rig.holder.lid_thickness, rig.holder_side / 2, rig.holder_screw
    holes = [
        Hole("suction", (x, y, t), (0, 0, -1), rig.holder.hole_diameter, t, True)
        for x, y in rig.suction_holes
    ]
    under = present(rig.holder_fixing)[1]
    screws = [sunk("screw", "M3", (px, py, t), (0, 0, -1), t, under) for px, py in corners(h, h)]
    return plate(
        rig.design,
        "holder-lid",
        "Sample holder, lid",
        Extrusion(rectangle(-s, -s, s, s), t),
        holes + screws,
        colour="#aab2ba",
        finish="Ra 0.8 both faces",
        notes=("suction holes burr-free, not countersunk: rubber would be drawn in",),
        geometric=(Geometric("flatness", "flatness", LID_FLAT, FACES),),
    )


FITTING_RADIUS = 4.0  # the hose fitting's shoulder


LID_FLAT = 0.02  # mm; chosen: over 48 mm a quarter of 0.1 degree, by which array and sample may lean


def hose_fitting() -> Part:
    r"""Barbed fitting M5 for soft hose of 4 mm bore: axis z, thread below z = 0, shoulder at z = 0.

        /\
       |  |  barb
    +--+  +--+
    +--+  +--+  z = 0: shoulder
       |  |  M5
    """
    profile = chain(
        [
            (1.2, -4.0),
            (2.5, -4.0),
            (2.5, 0),
            (FITTING_RADIUS, 0),
            (FITTING_RADIUS, 5.0),
            (2.0, 5.0),
            (2.5, 9.0),
            (2.0, 13.0),
            (1.2, 13.0),
        ]
    )
    return Part(
        part_no="FITTING-M5-HOSE4-barb",
        name="Hose fitting M5, barb for 4 mm",
        process="bought",
        material=BRASS,
        body=Revolution(profile),
        colour="#c2b280",
        purchase=Purchase(
            "barbed hose fitting M5, hose bore 4 mm, with sealing washer",
            alternates="push-in fitting M5 for tube 4 mm",
        ),
    )


def sample(rig: CartLayout, dents: tuple[tuple[float, float], ...] = (), depth: float = 0.0) -> Part:
    """The rubber sample; with `dents` it is the reference shape under pads pressed `depth` into it.

    +--+ +--+ +--+   z = thickness
    |  +-+  +-+  |   dents
    +------------+   z = 0: on the lid
    """
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
    # one pad and the force gauge's tip make equal dents in different places: only the first is listed
    if pressed:
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
