"""Where everything of the rigs stands, derived once from the design.

Frame (mm): x along the arms, y along the rows, z = 0 on the base plate, + up. The force sensor's axis,
the sample's middle and the array's middle are x = y = 0; the post stands behind, at + y.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import ceil, cos, floor, hypot, pi, sqrt

from tactcad.design.tree import Cart, Design, Holder
from tactcad.parts.library import orings

from ..layout import Layout
from ..library.bearings import BEARINGS, Bearing
from ..library.screws import CAP_SCREW_LENGTHS, METRIC, TAP_REACH, engagement

# Micro-stages: two plates of this size and thickness that slide on each other, threads at +-STAGE_HOLE.
STAGE, STAGE_PLATE, STAGE_HOLE = 60.0, 10.0, 25.0
PLATE = 10.0  # plates between stage, sensor and array: one thickness, so that one screw length fits all
PLATE_SCREW = ("M4", 12.0, 5.6)  # thread, length, plate under its sunk head: 6.4 mm engaged, 1.6 d
GAUGE_SIZE = (66.0, 36.0, 230.0)  # force gauge along x, y, z
GAUGE_SHAFT = 10.0  # free length of its M6 shaft
TIP = 18.0  # tip on that shaft, to where it touches
TIP_LAND = 2.0  # how far the flat tip's land stands out of its body
TIP_GAP = 1.0  # tip to the gauge's housing
BASE = (200.0, 12.0)  # base plate along x, thickness
POST = (60.0, 20.0)  # post along x, y
ROW_PITCH = 10.0  # rows of threads in the post
FOOT, BAR, BAR_WIDTH, BAR_HEIGHT, PLATFORM = 8.0, 8.0, 23.0, 60.0, 8.0  # what the guide's carriage carries
RAIL_HEIGHT = 10.0  # guide: mounting face of the carriage over the rail's
RISER_PITCH = 40.0  # riser's screws over and under its middle
CARRIAGE_ON_BAR = 30.0  # carriage's middle over the bar's lower end
BAR_FRONT = 16.0  # y of the bar's front: behind the carrier's threads
BEHIND_BAR = 1.5  # foot and platform behind the bar's back: material beside its screws
EDGE = 4.0  # screws of lid and holder from their edge
GROOVE_WALL = 1.0  # least material beside plenum and groove


def pad_middles(layout: Layout) -> tuple[tuple[float, float], ...]:
    """Middles (x, y) of all pads, mm."""
    middle = (layout.pad_inner + layout.pad_outer) / 2
    return tuple((middle if place.row == 1 else -middle, place.y) for place in layout.elements)


@dataclass(frozen=True)
class RigLayout:
    """The rigs' derived dimensions (mm). What needs a table that the design lacks raises AttributeError."""

    design: Design

    @cached_property
    def array(self) -> Layout:
        return Layout(self.design)

    @property
    def cart(self) -> Cart:
        return self.design.cart

    @property
    def holder(self) -> Holder:
        return self.design.holder

    # --- cart ---

    @property
    def bearing(self) -> Bearing:
        return BEARINGS[self.cart.bearing]

    @property
    def axle_thread(self) -> str:
        return f"M{self.bearing.d:g}"

    @cached_property
    def axle_length(self) -> float | None:
        """Shortest ISO 4762 screw whose plain shank carries the whole bearing; None where there is none.

        The standard's threaded length is 2 d + 12; longer screws have a plain shank for the rest.
        """
        m = METRIC[self.axle_thread]
        need = self.cart.shim + self.bearing.B
        lengths = CAP_SCREW_LENGTHS[self.axle_thread]
        return next((n for n in lengths if n - (2 * m.d + 12) >= need), None)

    @property
    def axle_z(self) -> float:
        return self.bearing.D / 2

    @property
    def axle_in_plate(self) -> float:
        """How deep the axle reaches into the plate."""
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
        """Where the wheels touch the base plate: the mid-planes, in order around the cart."""
        x, y = self.cart.wheel_base / 2, self.wheel_y
        return ((x, y), (-x, y), (-x, -y), (x, -y))

    @property
    def cart_top(self) -> float:
        return round(self.cart.clearance + self.cart.thickness, 9)

    # --- sample holder ---

    @property
    def holder_side(self) -> float:
        return round(self.design.sample.side + 2 * self.holder.margin, 9)

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
        """M3 screw through lid and body into the cart: length, and the lid under its sunk head; None if none fits."""
        most = self.holder.lid_thickness - METRIC["M3"].head_height
        for length in CAP_SCREW_LENGTHS["M3"]:
            engaged = round(length - self.holder_body - most, 9)
            deepest = min(self.cart.thickness, TAP_REACH * METRIC["M3"].d)
            if engagement("M3") <= engaged <= deepest and most >= 2.0:
                return length, round(most, 9)
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
        return orings.size_around(2 * (self.plenum_reach + GROOVE_WALL))

    @property
    def port_depth(self) -> float:
        """The port's axis below the body's upper face: just over the plenum's floor."""
        return round(self.holder.plenum_depth - METRIC["M5"].tap_drill / 2 - 0.9, 9)

    @cached_property
    def suction_holes(self) -> tuple[tuple[float, float], ...]:
        """Middles of the holes: hexagonal rings that fill the vacuum's circle, 1 + 3 n (n + 1) of them."""
        rings = round(self.holder.rings)
        pitch = (self.holder.vacuum_diameter - 2 * self.holder.hole_diameter) / 2 / rings
        spots = []
        for i in range(-rings, rings + 1):
            for j in range(-rings, rings + 1):
                if abs(i + j) <= rings:
                    spots.append((round(pitch * (i + j / 2), 6), round(pitch * j * sqrt(3) / 2, 6)))
        return tuple(spots)

    @property
    def lid_top(self) -> float:
        return round(self.cart_top + self.holder_body + self.holder.lid_thickness, 9)

    @property
    def sample_top(self) -> float:
        return round(self.lid_top + self.design.sample.thickness, 9)

    # --- stand: base plate, post, and what hangs on it ---

    @property
    def post_y(self) -> float:
        """Front of the post: force gauge, its two plates and the stage stand before it."""
        return GAUGE_SIZE[1] / 2 + 2 * PLATE + 2 * STAGE_PLATE

    @property
    def has_cart(self) -> bool:
        d = self.design
        return None not in (d.cart, d.holder, d.sample)

    @property
    def base_front(self) -> float:
        """y of the base plate's front edge."""
        reach = [STAGE / 2 + 45.0]  # micrometer of the lower stage
        if self.has_cart:
            reach.append(self.cart_half + 20.0)
        return -float(ceil(max(reach)))

    @property
    def base_back(self) -> float:
        return self.post_y + POST[1] + 15.0

    @property
    def base_length(self) -> float:
        """Along x: the cart's whole roll on it."""
        roll = 2 * (self.cart.length / 2 + self.cart.roll + 10.0) if self.has_cart else 0.0
        return max(BASE[0], float(ceil(roll)))

    @property
    def pads_up(self) -> float:
        """z of the pads in the calibration set-up: two stages of two plates, mount, and the array on its back."""
        a = self.array
        carrier_top = a.carrier_bottom + self.design.clamp.carrier_thickness
        return round(4 * STAGE_PLATE + PLATE + carrier_top + self.design.element.pad_height, 9)

    def gauge_bottom(self, touch: float) -> float:
        """z of the gauge's housing when its tip touches at z = touch."""
        return round(touch + TIP + TIP_GAP, 9)

    def axis_middle(self, touch: float) -> float:
        """z of the vertical stage's moving plate, and of the plates on it."""
        return round(self.gauge_bottom(touch) + 45.0, 9)

    def stage_middle(self, touch: float) -> float:
        """z of the vertical stage's fixed plate: the row of threads nearest to where it is needed."""
        return ROW_PITCH * round(self.axis_middle(touch) / ROW_PITCH)

    @property
    def touches(self) -> tuple[float, ...]:
        """Heights at which force sensors touch, over the scenes that this design has."""
        heights = []
        if self.design.calibration is not None:
            heights.append(self.pads_up)
            if self.has_cart:
                heights.append(self.sample_top)
        return tuple(heights)

    @cached_property
    def post_rows(self) -> tuple[float, ...]:
        """Heights of the post's rows of threads."""
        needed = [self.stage_middle(t) + s * STAGE_HOLE for t in self.touches for s in (-1, 1)]
        if self.design.grasping is not None and self.has_cart:
            needed += [self.riser_middle - RISER_PITCH, self.riser_middle + RISER_PITCH]
        low, high = min(needed), max(needed)
        return tuple(low + ROW_PITCH * i for i in range(round((high - low) / ROW_PITCH) + 1))

    @property
    def post_height(self) -> float:
        return self.post_rows[-1] + 15.0

    # --- grasping: array on a vertical guide over the cart ---

    @property
    def array_z(self) -> float:
        """z of the array's flat faces when its pads touch the sample."""
        return round(self.sample_top + self.design.element.pad_height, 9)

    @property
    def foot_bottom(self) -> float:
        return round(self.array_z + self.array.carrier_bottom + self.design.clamp.carrier_thickness, 9)

    @property
    def bar_bottom(self) -> float:
        return self.foot_bottom + FOOT

    @property
    def carriage_middle(self) -> float:
        return self.bar_bottom + CARRIAGE_ON_BAR

    @property
    def platform_top(self) -> float:
        return self.bar_bottom + BAR_HEIGHT + PLATFORM

    @property
    def riser_middle(self) -> float:
        """z of the riser's and the rail's middle: the highest row of threads from which the carriage, with the
        pads on the sample, can still fall 2 mm."""
        rail = self.design.grasping.rail_length
        highest = self.carriage_middle - CARRIAGE_LENGTH / 2 + rail / 2 - 2.0
        return ROW_PITCH * floor((highest - 5.0) / ROW_PITCH) + 5.0

    @property
    def riser_depth(self) -> float:
        """Along y, so that carriage and bar meet."""
        return self.post_y - (BAR_FRONT + BAR) - RAIL_HEIGHT

    @property
    def weight_mass(self) -> float:
        """Mass of one added weight, g; standard gravity."""
        return self.design.grasping.weight / STANDARD_GRAVITY * 1e3

    def inside_tipping(self) -> float:
        """Distance of the sample's corners from the line between neighbouring contacts, mm."""
        half = self.design.sample.side / 2
        return min(self.cart.wheel_base / 2, self.wheel_y) - half

    @property
    def screw_circle(self) -> float:
        """Distance of the lid's screws from the middle."""
        return hypot(self.holder_screw, self.holder_screw)


CARRIAGE_LENGTH = 28.9
STANDARD_GRAVITY = 9.80665  # m/s2, by definition (CGPM 1901)
