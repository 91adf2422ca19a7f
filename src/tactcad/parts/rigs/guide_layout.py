"""Where the vertical guide of the grasping set-up, and the array on it, are, derived once from the design."""

from __future__ import annotations

from dataclasses import dataclass
from math import floor

from tactcad.design.rigs import Grasping
from tactcad.design.tree import Design

from ..layout import Layout
from .cart_layout import CartLayout, cart_layout
from .frame import (
    BAR,
    BAR_FRONT,
    BAR_HEIGHT,
    CARRIAGE_LENGTH,
    CARRIAGE_ON_BAR,
    FOOT,
    PLATFORM,
    POST_Y,
    RAIL_HEIGHT,
    ROW_PITCH,
    STANDARD_GRAVITY,
)


def guide_layout(design: Design) -> GuideLayout | None:
    """The guide of a design; None where it has no grasping table or no cart under it."""
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
    def carriage_middle(self) -> float:
        return self.bar_bottom + CARRIAGE_ON_BAR

    @property
    def platform_top(self) -> float:
        return self.bar_bottom + BAR_HEIGHT + PLATFORM

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
        return POST_Y - (BAR_FRONT + BAR) - RAIL_HEIGHT

    @property
    def weight_mass(self) -> float:
        """Mass of one added weight, g; standard gravity."""
        return self.grasping.weight / STANDARD_GRAVITY * 1e3
