"""The fixture for bonding gauges: its surfaces, derived once from the design; nest and clamp.

The element lies on its back, gauge face up, its slot over a tongue. The tongue locates the hinge, which is
invisible from the face that takes the gauge, and backs the leaf. At both sides of the element the tongue can
be seen.

          pad  gauge                 pins
          ___  =====          |  |            |  |
     ____|  |________________ |__|____________|__|__   z = 0: gauge face
    |_______  __   __  rear body                    |
            | |##|  |________                       |
              |##|     |     |______________________|
    __________|  |_____|     . DROP
    |                  |________________________________
    |                nest                               |

Frame (mm): x = 0 at the hinge's middle, + towards the clamped rear body, z = 0 on the element's flat face,
+ away from it, y = 0 in the middle of the sheet.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import ceil, floor, pi

from tactcad.contour import Contour, Corner, rectangle, rounded_polygon
from tactcad.design.fields import present
from tactcad.design.tree import Bonding, Design

from ..array.clamp import pin_hole, pressed
from ..array.element import shortest
from ..array.layout import LEAST_GAP, HingeShape, Layout
from ..bought.standard_parts import LEAST_PLAY, dowel_lengths, dowel_limits
from ..language.description import Extrusion, Hole, Material, Part, Purchase
from ..language.limits import FACES, DatumFeature, Geometric, general, within
from ..language.stock import (
    BREAK_EDGES,
    PLACE,
    RIG_COLOUR,
    RUBBER,
    STAINLESS_PLATE,
    THICKNESS,
    plate_material,
)
from .frame import STANDARD_GRAVITY

# The tongue's width and the height of its tip over the rest, plus and minus mm; chosen: three passes of the
# wire hold 0.01, four 0.005.
TONGUE, TIP = 0.005, 0.02
TONGUE_PLACE = 0.05  # mm, from the pins' datum, plus and minus; chosen: pins only keep elements upright
# Element over the nest's floor in front, mm; chosen: crumbs of adhesive do not lift it.
FLOOR_GAP = 0.5
# Gap of the rear body over its rest with the leaf on the tongue, besides general tolerances; chosen: so that
# the tongue bears, and never the rest alone.
DROP = 0.05
TONGUE_EDGE = 0.025  # radius of the tongue's edges, plus and minus mm; chosen: one pass of the wire
BASE = 10.0  # nest under the rest, mm; chosen: the pins' holes, and for a vice to hold it
SILL = 0.3  # the nest's step before the rear body, mm; chosen: the shortest clamp edge stays free of it
ROOT = 0.3  # inside corners of what the wire cuts, mm; chosen: twice the wire's least
EDGE = 2.0  # material around the pins' holes, mm; chosen: half a diameter of the usual M3's pin and more
BESIDE = 0.05  # air between element and pins at all limits, mm; chosen: it slides in by its own weight
BACK = 2.0  # nest beyond arms and rear ends, mm; chosen: for fingers
PIN_DEPTH = 2.0  # least depth of a pressed pin in its hole, in its diameters
PAD = 1.0  # rubber under the clamp, mm; chosen: silicone sheet as sold
OVER = 1.0  # clamp over the element's contact pad, mm; chosen
GUIDED = 6.0  # least height of the clamp bar, and as much of it runs on the pins, mm; chosen: two diameters
PLAY = 0.4  # the clamp bar's holes over its pins, mm; chosen: it slides down by its own weight
LEAST_TONGUE = 0.5  # mm: free-standing wall (vendors' pages, see checks/data/shop.toml)


@dataclass(frozen=True)
class BondingLayout:
    """Derived dimensions (mm) of the fixture for elements with one kind of hinge.

    Parameters
    ----------
    design
        With its [bonding] table.
    hinge
        The kind of hinge; elements with other hinges want another nest.
    """

    design: Design
    hinge: HingeShape

    @property
    def table(self) -> Bonding:
        return present(self.design.bonding)

    @cached_property
    def array(self) -> Layout:
        return Layout(self.design)

    # --- what the elements offer ---

    @cached_property
    def arms(self) -> tuple[float, ...]:
        """Arm lengths of the elements with this hinge."""
        return tuple(sorted({p.arm for p in self.array.elements if p.hinge == self.hinge}))

    @cached_property
    def _hinges(self) -> tuple[float, ...]:
        """x of their hinges in the array."""
        return tuple(self.array.pad_inner + arm for arm in self.arms)

    @property
    def clamp_edge(self) -> float:
        """x of the nearest clamp edge: from here on some rear body is lower than the ledge."""
        return round(self.array.clamp_edge - max(self._hinges), 9)

    @property
    def rear_ends(self) -> tuple[float, float]:
        """x of the nearest and of the farthest rear end."""
        ends = [round(self.array.rear_end - x, 9) for x in self._hinges]
        return min(ends), max(ends)

    @property
    def floor(self) -> float:
        """Slot's floor under the gauge face: the leaf's back."""
        h = self.hinge
        return h.t if self.design.element.sides == "one" else round((h.h + h.t) / 2, 9)

    @property
    def gauge_face(self) -> float:
        """z of the face that the gauge is bonded to: 0, or the floor of a two-sided hinge's front slot."""
        h = self.hinge
        return 0.0 if self.design.element.sides == "one" else -round((h.h - h.t) / 2, 9)

    # --- nest ---

    @property
    def tongue(self) -> float:
        """Width, to a hundredth: it enters the shortest slot at any limits."""
        most = self.hinge.l - self.design.tolerance.hinge_length - TONGUE - LEAST_PLAY
        return floor(100 * most + 1e-6) / 100

    @property
    def tongue_radius(self) -> float:
        """Radius of the tongue's edges: they stay clear of the slot's fillets at any limits, its tip lies on
        the floor. A tip with hardly a flat is one round."""
        wanted = self.hinge.r + self.design.tolerance.fillet_radius + TONGUE_EDGE
        half = self.tongue / 2
        return round(wanted if wanted + TONGUE_EDGE <= half else half, 6)

    @property
    def play(self) -> float:
        """Play of the nominal slot over the tongue, in total."""
        return round(self.hinge.l - self.tongue, 9)

    @property
    def front_floor(self) -> float:
        """Depth of the nest's floor next to the tongue, below the gauge face: the rest's depth if that is
        hardly lower."""
        floor = round(self.array.ledge_of(self.hinge) + FLOOR_GAP, 9)
        return floor if self.rest - floor >= 2 * ROOT else self.rest

    @property
    def rest(self) -> float:
        """Depth of the rear rest below the gauge face."""
        return round(self.design.element.rear_height + self.drop, 9)

    @property
    def drop(self) -> float:
        """Rear body's top over its rest, the leaf on the tongue."""
        return round(general(self.design.element.rear_height) + TIP + DROP, 9)

    @property
    def sill(self) -> float:
        """x of the step from the floor next to the tongue down to the rest."""
        return round(self.clamp_edge - SILL, 9)

    @property
    def nest_x(self) -> tuple[float, float]:
        return -(ceil(max(self.arms)) + BACK), ceil(self.rear_ends[1]) + BACK

    @property
    def nest_height(self) -> float:
        """From its foot to the tongue's tip."""
        return round(BASE + self.rest - self.floor, 9)

    @property
    def width(self) -> float:
        """Nest and clamp along y: over the pins."""
        return ceil(2 * (self.pin_y + self.pin_d / 2 + EDGE))

    # --- pins ---

    @property
    def pin_d(self) -> float:
        return float(self.design.clamp.dowel)

    @property
    def pin_y(self) -> float:
        """y of the pins at the element's sides; the element enters at any limits."""
        thick = self.design.sheet.thickness + present(self.design.tolerance.sheet_thickness)
        pins = dowel_limits(self.design.clamp.dowel)[1]
        return round(ceil(100 * ((thick + pins + PLACE) / 2 + BESIDE)) / 100, 6)

    @property
    def pin_x(self) -> tuple[float, float]:
        """x of the pairs of pins: behind step and clamp's nose, and before the nearest rear end."""
        beside_nose = self.pad_x[1] + ROOT + PLAY / 2 + LEAST_GAP
        first = max(self.sill + EDGE, beside_nose) + self.pin_d / 2
        return round(ceil(10 * first) / 10, 6), round(self.rear_ends[0] - self.pin_d / 2, 6)

    @property
    def pin_length(self) -> float:
        """Shortest standard pin that is pressed in far enough and guides the clamp; ground rod beyond."""
        out = self.rest + self.bar_bottom + GUIDED
        least = out + PIN_DEPTH * self.pin_d
        most = out + BASE
        lengths = dowel_lengths(self.design.clamp.dowel)
        return next((n for n in lengths if least <= n <= most), float(ceil(least)))

    @property
    def pin_depth(self) -> float:
        """Depth to which the pins are pressed in."""
        return round(self.pin_length - (self.rest + self.bar_bottom + GUIDED), 9)

    # --- clamp ---

    @property
    def pad_x(self) -> tuple[float, float]:
        """x of the rubber's ends: the gauge's carrier, but clear of the shortest arm's contact pad."""
        d = self.design
        free = min(self.arms) - d.element.pad_length - d.element.pad_root_radius - LEAST_GAP
        arm_side, body_side = d.gauge.carrier_arm_side, d.gauge.carrier_body_side
        if d.element.sides == "one":
            return -round(min(arm_side, free), 9), body_side
        flat = round(self.hinge.l / 2 - self.hinge.r, 9)
        return -min(arm_side, flat), min(body_side, flat)

    @property
    def pad_middle(self) -> float:
        return round(sum(self.pad_x) / 2, 9)

    @property
    def pad_area(self) -> float:
        """mm2 of rubber on the gauge: the carrier's area on the element."""
        before, behind = self.pad_x
        return (behind - before) * self.pad_width

    @property
    def pad_width(self) -> float:
        return min(self.design.gauge.carrier_width, self.design.sheet.thickness)

    @property
    def bar_bottom(self) -> float:
        """z of the clamp bar's underside: over the element's contact pad, and of its nose over the rubber."""
        front = -self.array.body_bottom(self.hinge)
        return round(max(self.design.element.pad_height, self.gauge_face + PAD, front) + OVER, 9)

    @property
    def nose(self) -> float:
        """z of the nose's end, on the rubber."""
        return round(self.gauge_face + PAD, 9)

    @property
    def bar_x(self) -> tuple[float, float]:
        """x of the bar's ends: over both pairs of pins, its middle over the rubber's."""
        half = self.pin_x[1] + self.pin_d / 2 + EDGE - self.pad_middle
        return round(self.pad_middle - half, 6), round(self.pad_middle + half, 6)

    @property
    def bar_holes(self) -> tuple[tuple[float, float], ...]:
        """(x, y) of its holes: over the pins, and mirrored, so that it balances over the gauge."""
        xs = [*self.pin_x, *(round(2 * self.pad_middle - x, 9) for x in self.pin_x)]
        return tuple((x, side * self.pin_y) for x in sorted(xs) for side in (-1, 1))

    @property
    def bar_hole(self) -> float:
        """Diameter of its holes over the pins."""
        return self.pin_d + PLAY

    @cached_property
    def bar_material(self) -> Material:
        """Steel, or the plates' alloy if a steel bar would be too thin to guide on its pins."""
        return STAINLESS_PLATE if self._height_of(STAINLESS_PLATE) >= GUIDED else plate_material(self.design)

    @property
    def bar_height(self) -> float:
        """So that its weight presses as wished, to a tenth; not less than it needs on its pins."""
        return max(GUIDED, round(self._height_of(self.bar_material), 1))

    def _height_of(self, material: Material) -> float:
        wished = self.table.pressure * self.pad_area / STANDARD_GRAVITY / (material.density * 1e-9)
        return (wished - self._nose_volume) / self._bar_section

    @property
    def _bar_section(self) -> float:
        """mm2 in plan, its holes taken off."""
        before, behind = self.bar_x
        return (behind - before) * self.width - len(self.bar_holes) * pi / 4 * self.bar_hole**2

    @property
    def _nose_volume(self) -> float:
        before, behind = self.pad_x
        return (behind - before) * (self.bar_bottom - self.nose) * self.width

    @property
    def bar_mass(self) -> float:
        """g"""
        volume = self._nose_volume + self._bar_section * self.bar_height
        return volume * self.bar_material.density * 1e-6

    @property
    def bar_force(self) -> float:
        """N, its weight."""
        return self.bar_mass * 1e-3 * STANDARD_GRAVITY

    @property
    def bar_pressure(self) -> float:
        """MPa on the gauge, as made."""
        return self.bar_force / self.pad_area

    # --- terminals ---

    @property
    def terminal_width(self) -> float:
        own = self.table.terminal_width
        return min(2.0, self.design.sheet.thickness) if own is None else own


def bonding_rigs(design: Design) -> tuple[BondingLayout, ...]:
    """A fixture for each kind of hinge, in the order of the elements; none without [bonding]."""
    if design.bonding is None:
        return ()
    kinds = dict.fromkeys(p.hinge for p in Layout(design).elements)
    return tuple(BondingLayout(design, hinge) for hinge in kinds)


def kind_suffix(rig: BondingLayout) -> str:
    """Ends part numbers of what fits one kind of hinge; empty for the common one."""
    usual = rig.array.common_hinge
    differing = [k for k in "tlrh" if getattr(rig.hinge, k) != getattr(usual, k)]
    return "".join(f"-{k}{shortest(getattr(rig.hinge, k))}mm" for k in differing)


TONGUE_WIDTH, TIP_OVER_REST, EDGE_RADIUS = "tongue width", "tongue's tip over the rest", "tongue's edges"


def bonding_nest(rig: BondingLayout) -> Part:
    """Nest for elements with one kind of hinge: contour in (x, height over its foot), extruded across.

               ||        pins      ||          tongue's tip: on the leaf
     __________||__   o        o
    |              |__________________         rest
    |                                 |
    +---------------------------------+        v up, foot v = 0; u = 0 in the tongue's middle
    """
    outer = _outline(rig)
    names = {s.name for s in outer}
    tip = "tongue_tip" if "tongue_tip" in names else "tongue_back_edge"
    width = rig.tongue
    limits = [
        within(TONGUE_WIDTH, width, TONGUE, True, ("tongue_front", "tongue_back")),
        within(TIP_OVER_REST, round(rig.rest - rig.floor, 9), TIP, between=("rest", tip)),
        pressed(rig.pin_d),
        within(
            "tongue_back", round(rig.nest_x[1] - width / 2, 9), TONGUE_PLACE, between=("back", "tongue_back")
        ),
    ]
    if tip == "tongue_tip":  # a full round's width defines it
        r = rig.tongue_radius
        edges = ("tongue_back_edge", "tongue_front_edge")
        limits.append(within(EDGE_RADIUS, r, TONGUE_EDGE, between=edges))
    return Part(
        part_no=f"{rig.design.name}-bonding-nest{kind_suffix(rig)}",
        name="Bonding fixture, nest",
        process="wire-cut",
        material=STAINLESS_PLATE,
        body=Extrusion(outer, rig.width),
        features=tuple(
            pin_hole("dowel_hole", (x, BASE, y), (0, -1, 0), rig.design.clamp.dowel, BASE)
            for x in rig.pin_x
            for y in (rig.width / 2 - rig.pin_y, rig.width / 2 + rig.pin_y)
        ),
        colour=RIG_COLOUR,
        finish="Ra 0.8 on tongue and rest",
        notes=(
            BREAK_EDGES + ", but not the tongue's: its ends are what the gauge is set by",
            "tongue and rest wire-cut in one contour",
            f"pins {rig.design.clamp.dowel} m6 are pressed in from above, {rig.pin_depth:g} deep",
            f"clamp: {rig.bar_force:.2g} N on {rig.pad_area:g} mm2 of gauge, {rig.bar_pressure:.2g} MPa",
        ),
        characteristics=tuple(limits),
        geometric=(Geometric("dowel holes", "position", PLACE, ("dowel_hole",), ("A", "B", "C"), True),),
        datums=(DatumFeature("A", "rest"), DatumFeature("B", FACES[0]), DatumFeature("C", "back")),
    )


def _outline(rig: BondingLayout) -> Contour:
    front, back = rig.nest_x
    half, r = rig.tongue / 2, rig.tongue_radius
    floor, top = round(BASE + rig.rest - rig.front_floor, 9), rig.nest_height
    step = (
        [Corner((rig.sill, BASE), ROOT, "step", "step_root"), Corner((rig.sill, floor), edge="floor_back")]
        if floor > BASE
        else []
    )
    return rounded_polygon(
        [
            Corner((front, 0.0), edge="foot"),
            Corner((back, 0.0), edge="back"),
            Corner((back, BASE), edge="rest"),
            *step,
            Corner((half, floor), ROOT, "tongue_back", "tongue_root"),
            Corner((half, top), r, "tongue_tip", "tongue_back_edge"),
            Corner((-half, top), r, "tongue_front", "tongue_front_edge"),
            Corner((-half, floor), ROOT, "floor_front", "tongue_root"),
            Corner((front, floor), edge="front"),
        ]
    )


NOSE = 0.05  # mm, nose's length, plus and minus; chosen: it is no longer than what it presses
WEIGHT = 0.05  # of its mass, plus and minus: half of the pressure's own digit


def bonding_clamp(rig: BondingLayout) -> Part:
    """Bar that presses by its weight: contour in (x, height over the nose's end), extruded across.

    +--o---o-------o---o--+
    |                     |   slides down on the nest's pins
    +------+       +------+
           |_______|          nose: as long as the gauge's carrier
            =======           rubber
    """
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
