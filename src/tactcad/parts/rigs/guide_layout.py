"""Where the vertical guide of the grasping set-up, and the array on it, are, derived once from the design."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, floor

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
    END_STOP_OUT,
    FOOT,
    PLATFORM,
    POST_Y,
    RAIL_HEIGHT,
    RAISED_BAR,
    ROW_PITCH,
    STANDARD_GRAVITY,
    UNDER_RAIL,
)

# y that the array keeps before the end stop's pin, which stands out of the riser under the rail
BEFORE_END_STOP = BAR_FRONT + BAR + RAIL_HEIGHT - END_STOP_OUT - 0.5


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
    def raised(self) -> float:
        """By how much the guide stands higher than for the published array: a longer one would meet the end
        stop, or the riser that it stands in, when it is lifted."""
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
