"""The setting fixture: a floor for the pads and two steps for the end plates' lower edges, in one contour.

While the clamping screws are tightened it sets the pads' height, the plates' level and, by a pin at the left
edge of each plate, the plates' alignment. For a row with blanks, a strip on the floor carries their fronts.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import hypot

from tactcad.contour import Corner, rectangle, rounded_polygon
from tactcad.design.tree import Design

from ..array.clamp import pin_hole, pressed
from ..array.layout import LEVER, Layout
from ..bought.standard_parts import dowel_diameter, dowel_lengths, dowel_limits
from ..language.description import Extrusion, Part
from ..language.limits import Characteristic, DatumFeature, Geometric, within
from ..language.stock import BREAK_EDGES, MAGNETIC_STAINLESS, RIG_COLOUR

# mm: under the floor; chosen: stiff under a hand, and deeper than the pins are pressed in
BASE = 12.0
# mm that the foot reaches beyond the plates, the steps stay short of their outer faces, and the channel is
# longer than the stack at each end; chosen: a finger, room for a nut's socket, the stack's own limits twice
BEYOND, SHORT, AIR = 3.0, 1.0, 0.5
# mm, plus and minus, of the steps over the floor, and the zones of faces level with it; chosen: wire, one
# contour, four passes
STEP, LEVEL = 0.003, 0.003
FLOOR = "step over the floor"
PIN_OUT = 5.0  # mm, height of a pin over the step: about half the plate's height
ROOT = 0.2  # mm: what the wire leaves in a corner
EDGE = 5.0  # mm of fixture beyond the pins


@dataclass(frozen=True)
class SettingLayout:
    """Derived sizes, mm; the frame is the array's."""

    design: Design

    @cached_property
    def array(self) -> Layout:
        return Layout(self.design)

    @property
    def floor(self) -> float:
        """z of the floor: the pads' plane."""
        return -self.design.element.pad_height

    @property
    def play(self) -> float:
        """Mean diametral play of an element on its pin, mm: pressed down, its hole lies half of it below the
        pin."""
        d = self.design
        hole = d.holes.dowel_hole + d.holes.dowel_hole_upper / 2
        return max(0.0, hole - sum(dowel_limits(d.clamp.dowel)) / 2)

    @property
    def step(self) -> float:
        """Height of the steps over the floor as drawn, mm."""
        return round(self.design.clamp.end_plate_bottom - self.floor, 9)

    @property
    def step_length(self) -> float:
        """Length of each step along y, mm."""
        return round(self.design.clamp.end_plate_thickness - SHORT - AIR, 9)

    def over_floor(self, name: str, step: str) -> Characteristic:
        """Limits of a step's height: higher by half the play, so that elements in the middle of their limits,
        pressed down on their pins, are square; to a micrometre."""
        raised = round(self.play / 2, 3)
        low, high = (round(self.step + raised + side * STEP, 6) for side in (-1, 1))
        return Characteristic(f"{FLOOR}, {name}", self.step, high, low, True, ("floor", step))

    @property
    def half(self) -> float:
        """Half the fixture's length along x."""
        return round(self.array.end_plate_half + float(self.design.clamp.dowel) + EDGE, 6)

    @property
    def pin_x(self) -> float:
        return round(self.array.end_plate_half + dowel_diameter(self.design.clamp.dowel) / 2, 9)

    @property
    def pin_y(self) -> float:
        """The middle of a step."""
        return round(self.array.stack / 2 + AIR + self.step_length / 2, 6)

    @property
    def pins_square(self) -> bool:
        """Whether the pins are far enough apart to keep the plates from turning about z; a short stack of
        long bodies is turned by hand, which is harmless: the dowels align its plates."""
        long, wide = self.array.end_plate_half, self.array.stack / 2 + self.design.clamp.end_plate_thickness
        return self.pin_y >= LEVER * hypot(long, wide)

    @property
    def pin_length(self) -> float:
        lengths = dowel_lengths(self.design.clamp.dowel)
        return next((n for n in lengths if n >= PIN_OUT + 2.5 * float(self.design.clamp.dowel)), lengths[-1])

    @property
    def strip(self) -> tuple[float, float]:
        """Distances from the middle line between which the strip lies under the blanks' fronts."""
        end = self.array.recess_start
        return round(end - self.design.element.seat_length - self.design.element.recess_offset, 6), end

    @property
    def blanks_y(self) -> tuple[float, float]:
        """Start and end of the blanks along y."""
        ys = [self.array.position_y(index) for _, index in self.array.blanks()]
        half = self.design.sheet.thickness / 2
        return min(ys) - half, max(ys) + half


def setting_fixture(rig: SettingLayout) -> Part:
    """Contour in (y, height over its foot), extruded along x.

        ___ step           step ___
     __|   |____ floor ________|   |__     a pin at the left edge of each end plate
    |                                 |
    +---------------------------------+
    """
    layout, d = rig.array, rig.design
    inner = round(layout.stack / 2 + AIR, 6)
    outer = round(layout.stack / 2 + d.clamp.end_plate_thickness + BEYOND, 6)
    edge = round(layout.stack / 2 + d.clamp.end_plate_thickness - SHORT, 6)
    top = round(BASE + rig.step, 6)
    contour = rounded_polygon(
        [
            Corner((-outer, 0.0), edge="foot"),
            Corner((outer, 0.0), edge="back"),
            Corner((outer, BASE), edge="ledge_back"),
            Corner((edge, BASE), ROOT, "end_back", "root"),
            Corner((edge, top), edge="step_back"),
            Corner((inner, top), edge="wall_back"),
            Corner((inner, BASE), ROOT, "floor", "root"),
            Corner((-inner, BASE), ROOT, "wall_front", "root"),
            Corner((-inner, top), edge="step_front"),
            Corner((-edge, top), edge="end_front"),
            Corner((-edge, BASE), ROOT, "ledge_front", "root"),
            Corner((-outer, BASE), edge="front"),
        ]
    )
    size = d.clamp.dowel
    pins = tuple(
        pin_hole(
            "dowel_hole",
            (side * rig.pin_y, top, round(rig.half - side * rig.pin_x, 9)),
            (0, -1, 0),
            size,
            top,
        )
        for side in (1, -1)
    )
    return Part(
        part_no=f"{d.name}-setting-fixture",
        name="Setting fixture",
        process="wire-cut",
        material=MAGNETIC_STAINLESS,
        body=Extrusion(contour, 2 * rig.half),
        features=pins,
        colour=RIG_COLOUR,
        finish="Ra 0.4 on floor and steps",
        notes=(
            BREAK_EDGES + ", but not the floor's",
            # chosen: harder than what is set in it; the steel reaches a little more
            "hardened to 50 HRC or more, then floor and steps wire-cut in one contour",
            f"pins {size} m6 are pressed in from above, {rig.pin_length - PIN_OUT:g} deep: {PIN_OUT:g} out",
        ),
        characteristics=(
            rig.over_floor("front", "step_front"),
            rig.over_floor("back", "step_back"),
            pressed(float(size)),
        ),
        geometric=(
            Geometric("floor", "flatness", LEVEL, ("floor",)),
            Geometric("steps", "parallelism", LEVEL, ("step_front", "step_back"), ("A",)),
            Geometric("dowel holes", "position", 0.02, ("dowel_hole",), ("A", "B", "C"), True),
        ),
        datums=(DatumFeature("A", "floor"), DatumFeature("B", "wall_front"), DatumFeature("C", "face z=0")),
    )


def setting_strip(rig: SettingLayout) -> Part:
    """Strip under the fronts of a row's blanks, as high as their flat faces are over the floor.

    +-----------------+   ^ y
    +-----------------+   +-> x
    """
    near, far = rig.strip
    layout = rig.array
    high = round(layout.body_bottom(layout.elements[0].hinge) - rig.floor, 9)
    length = round(rig.blanks_y[1] - rig.blanks_y[0], 6)
    return Part(
        part_no=f"{rig.design.name}-setting-strip",
        name="Setting fixture, strip under blanks",
        process="ground",
        material=MAGNETIC_STAINLESS,
        body=Extrusion(rectangle(near, -length / 2, far, length / 2), high),
        colour=RIG_COLOUR,
        finish="both faces ground, Ra 0.4",
        notes=(BREAK_EDGES,),
        characteristics=(within("thickness", high, STEP, between=("face z=0", "face z=thickness")),),
    )
