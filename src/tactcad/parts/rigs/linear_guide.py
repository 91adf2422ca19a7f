"""The vertical guide of the grasping set-up: its place and the array's, derived once from the design; its
rail, carriage, and the riser between post and rail.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import ceil, floor

from tactcad.contour import chain, rectangle
from tactcad.design.tree import Design, Grasping

from ..array.clamp import pin_hole
from ..array.layout import Layout
from ..bought.standard_parts import dowel_diameter
from ..language.description import Extrusion, Feature, Hole, Part, Purchase
from ..language.limits import FACES, Geometric, deviations
from ..language.metric import corners, sunk, tapped_blind
from ..language.stock import CARBON_STEEL, FRAME, PLACE, plate
from .cart import CartLayout, cart_layout
from .frame import (
    BAR,
    BAR_FRONT,
    BAR_HEIGHT,
    CARRIAGE_LENGTH,
    CARRIAGE_ON_BAR,
    END_STOP_OUT,
    FOOT,
    PLATFORM,
    POST,
    POST_Y,
    RAIL_HEIGHT,
    RAISED_BAR,
    RISER_PITCH,
    ROW_PITCH,
    STAGE_HOLE,
    STANDARD_GRAVITY,
    UNDER_RAIL,
)

# y clearance of the array to the end stop's pin, which protrudes from the riser under the rail
BEFORE_END_STOP = BAR_FRONT + BAR + RAIL_HEIGHT - END_STOP_OUT - 0.5


def guide_layout(design: Design) -> GuideLayout | None:
    """The guide of a design; None if it has no grasping table or no cart under it."""
    cart = cart_layout(design)
    return (
        GuideLayout(design, design.grasping, cart)
        if design.grasping is not None and cart is not None
        else None
    )


@dataclass(frozen=True)
class GuideLayout:
    """Derived heights of guide, foot, bar and platform while the pads touch the sample (mm)."""

    design: Design
    grasping: Grasping
    cart: CartLayout

    @property
    def array(self) -> Layout:
        return Layout(self.design)

    @property
    def array_z(self) -> float:
        """z of the array's flat faces when its pads touch the sample."""
        return round(self.cart.sample_top + self.design.element.pad_height, 9)

    @property
    def foot_bottom(self) -> float:
        return round(self.array_z + self.array.carrier_bottom + self.design.clamp.carrier_thickness, 9)

    @property
    def bar_bottom(self) -> float:
        return self.foot_bottom + FOOT

    @property
    def raised(self) -> float:
        """Height of the guide over that for the published array: a longer one would hit the end stop, or its
        riser, when it is lifted."""
        if self.array.carrier_size[1] / 2 <= BEFORE_END_STOP:
            return 0.0
        # the riser's lower end, at the lowest row that it can have, over the lifted carrier
        least = CARRIAGE_LENGTH / 2 + 2.0 + ROW_PITCH + UNDER_RAIL + self.grasping.lift - FOOT + 0.5
        return ROW_PITCH * ceil((least - CARRIAGE_ON_BAR) / ROW_PITCH)

    @property
    def bar(self) -> float:
        """Thickness of the bar: a longer one is thicker."""
        return RAISED_BAR if self.raised else BAR

    @property
    def bar_middle(self) -> float:
        """y of the bar's middle."""
        return BAR_FRONT + self.bar / 2

    @property
    def carriage_on_bar(self) -> float:
        """Carriage's middle over the bar's lower end."""
        return CARRIAGE_ON_BAR + self.raised

    @property
    def bar_height(self) -> float:
        return BAR_HEIGHT + self.raised

    @property
    def carriage_middle(self) -> float:
        return self.bar_bottom + self.carriage_on_bar

    @property
    def platform_top(self) -> float:
        return self.bar_bottom + self.bar_height + PLATFORM

    @property
    def riser_middle(self) -> float:
        """z of the riser's and the rail's middle: the highest row of threads from which the carriage, with
        the pads on the sample, can still fall 2 mm."""
        rail = self.grasping.rail_length
        highest = self.carriage_middle - CARRIAGE_LENGTH / 2 + rail / 2 - 2.0
        return ROW_PITCH * floor((highest - 5.0) / ROW_PITCH) + 5.0

    @property
    def riser_depth(self) -> float:
        """Along y, so that carriage and bar meet."""
        return POST_Y - (BAR_FRONT + self.bar) - RAIL_HEIGHT

    @property
    def weight_mass(self) -> float:
        """Mass of one added weight, g; standard gravity."""
        return self.grasping.weight / STANDARD_GRAVITY * 1e3


def rail(length: float) -> Part:
    """Miniature guide rail, width 9: local z out of its mounting face, y along it, holes 20 apart.

    +---------------------------+
    |   O     O     O     O     |   y ->, z out of the mounting face
    +---------------------------+
    """
    half = length / 2
    holes = tuple(
        Hole("mount", (0, y, 6.5), (0, 0, -1), 3.5, 6.5, True, counterbore=(6.0, 3.5))
        for y in rail_holes(length)
    )
    return Part(
        part_no=f"RAIL-9x{length:g}-guide",
        name=f"Guide rail 9, {length:g} long",
        process="bought",
        material=CARBON_STEEL,
        body=Extrusion(rectangle(-4.5, -half, 4.5, half), 6.5),
        features=holes,
        colour="#6f7378",
        purchase=Purchase(
            f"miniature guide rail, width 9, length {length:g}, holes M3 at 20, the first 10 from its end",
            alternates="any rail of that section and those holes",
            source_verified=True,
        ),
    )


def rail_holes(length: float) -> tuple[float, ...]:
    """Along the rail from its middle, mm: 20 apart, half a pitch from the ends."""
    count = round(length / 20.0)
    return tuple(20.0 * (i - (count - 1) / 2) for i in range(count))


def carriage() -> Part:
    """The rail's carriage, ends without seals: section in (x, y) with y out of the rail's mounting face,
    extruded along the rail.

    +-------------------+   y = RAIL_HEIGHT: mounting face, four M3 threads
    |   +-----------+   |
    +---+   rail    +---+
    """
    section = chain(
        [
            (-10, 2.0),
            (-4.5, 2.0),
            (-4.5, 6.5),
            (4.5, 6.5),
            (4.5, 2.0),
            (10, 2.0),
            (10, RAIL_HEIGHT),
            (-10, RAIL_HEIGHT),
        ]
    )
    thread = Hole("mount", (0.0, 0.0, 0.0), (0, -1, 0), 2.5, 3.0, False, thread="M3", thread_depth=3.0)
    threads = tuple(
        replace(thread, at=(x, RAIL_HEIGHT, CARRIAGE_LENGTH / 2 + y)) for x, y in corners(7.5, 5.0)
    )
    return Part(
        part_no="CARRIAGE-9-UNSEALED",
        name="Guide carriage 9, without seals",
        process="bought",
        material=CARBON_STEEL,
        body=Extrusion(section, CARRIAGE_LENGTH),
        features=threads,
        colour="#50575f",
        notes=("seals taken off: they drag 0.1 to 0.5 N",),
        purchase=Purchase(
            "miniature guide carriage for rail width 9, no seals, very light preload (Z0), 4 x M3 at 15 x 10",
            alternates="any carriage of those dimensions",
            source_verified=True,
        ),
        mass_override=16.0,
    )


RAIL_FLAT = 0.01  # mm, of the face under the rail; chosen: makers of width 9 ask 0.01 to 0.02 of 100
RISER_SCREW, RISER_UNDER_HEAD = 16.0, 9.0  # M4 into the post: 7 mm engaged, head deep in the riser

# Pin below the rail's end that the carriage comes down on: it protrudes 8 mm, the carriage is solid from 6.5
# mm on, and the foot passes the pin.
STOP_PIN, STOP_LENGTH = "3", 16.0
STOP_DEPTH = STOP_LENGTH - END_STOP_OUT


def stop_below(rig: GuideLayout) -> float:
    """Distance of the end stop's pin below the rail's middle, mm: 0.5 clear of its end."""
    return rig.grasping.rail_length / 2 + 2.0


# The latch: a pin pushed by hand through a hole in the bar into a hole next to the rail, under the lifted
# carriage's side; it is stored in a hole next to the bar. D10 leaves it 0.012 of play at least. It protrudes
# from the bar's front by 4 mm or more for the fingers; the bar's hole is 1 mm wider all around.
LATCH, LATCH_KEPT, LATCH_FIT = 7.25, 16.0, "D10"
LATCH_LENGTH, LATCH_DEPTH, LATCH_AIR = 30.0, 6.0, 1.0


def latch_above(rig: GuideLayout) -> float:
    """Height of the latch's holes over the rail's middle, mm, for the carriage lifted all the way."""
    lowest = rig.carriage_middle + rig.grasping.lift - CARRIAGE_LENGTH / 2
    # to a tenth: the carriage comes down on it by less
    return floor(10 * (lowest - dowel_diameter(STOP_PIN) / 2 - rig.riser_middle)) / 10


def latch_on_bar(rig: GuideLayout) -> float:
    """Height of the latch, with the carriage on it, over the bar's lower end, mm."""
    lifted = rig.bar_bottom + rig.grasping.lift
    return round(rig.riser_middle + latch_above(rig) - latch_lies() - lifted, 9)


def latch_hole() -> float:
    """Diameter of the latch's holes, mm: the middle of their limits."""
    size = float(STOP_PIN)
    return round(size + sum(deviations(LATCH_FIT, size)) / 2, 6)


def latch_lies() -> float:
    """Distance of the latch's pin below its hole's axis, mm."""
    return (latch_hole() - dowel_diameter(STOP_PIN)) / 2


def riser(rig: GuideLayout) -> Part:
    """Block between post and guide rail. Front face (the rail's) at local z = 0, contour in (x, z) about its
    middle.

    +---------+
    | O     O |   screws into the post, heads deep inside
    |    o    |   ^ z
    |    o    |   |     the rail's M3 threads
    | O     O |   +-> x
    |    o oo |   end stop's pin, below the rail; latch, with a hole to keep its pin
    +---------+
    """
    length, depth = rig.grasping.rail_length, rig.riser_depth
    half = max(length / 2, RISER_PITCH + 8.0)
    low = max(half, length / 2 + UNDER_RAIL)  # material below the pin: its diameter from the middle, and 2 mm
    features: list[Feature] = [
        sunk("post", "M4", (x, y, 0.0), (0, 0, 1), depth, min(RISER_UNDER_HEAD, depth))
        for x, y in corners(STAGE_HOLE, RISER_PITCH)
    ]
    # through, so that air leaves and the reamer runs out; N7 holds every m6 pin
    pin = pin_hole("end_stop", (0.0, -stop_below(rig), 0.0), (0, 0, 1), STOP_PIN, depth)
    features += [
        Hole(
            "latch",
            (x, latch_above(rig), 0.0),
            (0, 0, 1),
            latch_hole(),
            LATCH_DEPTH,
            False,
            drill_point=True,
            tolerance=LATCH_FIT,
        )
        for x in (LATCH, LATCH_KEPT)
    ]
    features += [pin, *(tapped_blind("rail", "M3", (0.0, y, 0.0), (0, 0, 1)) for y in rail_holes(length))]
    return plate(
        rig.design,
        "riser",
        "Riser",
        Extrusion(rectangle(-POST[0] / 2, -low, POST[0] / 2, half), depth),
        features,
        finish="rail face Ra 0.8",
        geometric=(
            Geometric("flatness", "flatness", RAIL_FLAT, (FACES[0],)),
            *(Geometric(f"{n} hole", "position", PLACE, (n,), FRAME, True) for n in ("end_stop", "latch")),
            Geometric("parallelism", "parallelism", 0.01, (FACES[1],), ("A",)),
        ),
    )
