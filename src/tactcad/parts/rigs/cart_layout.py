"""Where everything of the cart, its sample holder and the sample is, derived once from the design.

The rigs' frame: z = 0 on the base plate, x = y = 0 the middle of the cart at rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import cos, hypot, pi, sqrt

from tactcad.design.rigs import Cart, Holder, Sample
from tactcad.design.tree import Design
from tactcad.parts.library import orings

from ..library.bearings import BEARINGS, Bearing
from ..library.screws import CAP_SCREW_LENGTHS, METRIC, TAP_REACH, engagement

# mm that a wheel may stand off the plane of the other three; chosen: the thinnest feeler that is handled.
LOOSE_WHEEL = 0.02
EDGE = 4.0  # screws of lid and holder from their edge
GROOVE_WALL = 1.0  # least material beside plenum and groove


def cart_layout(design: Design) -> CartLayout | None:
    """The cart of a design; None where it lacks one of the tables cart, holder and sample."""
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
        """Shortest ISO 4762 screw whose plain shank carries the whole bearing: even for the thickest shims
        there is one.

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
        return round(self.sample.side + 2 * self.holder.margin, 9)

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
        rings = self.holder.rings
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
        return round(self.lid_top + self.sample.thickness, 9)

    @property
    def screw_circle(self) -> float:
        """Distance of the lid's screws from the middle."""
        return hypot(self.holder_screw, self.holder_screw)
