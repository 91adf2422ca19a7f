"""Where base plate, post and the force gauge's vertical axis are, derived once from the design."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import ceil

from tactcad.design.tree import Design

from ..layout import Layout
from ..library.stages import Stage
from .cart_layout import CartLayout, cart_layout
from .frame import BASE, PLATE, POST, POST_Y, RISER_PITCH, ROW_PITCH, STAGE, STAGE_HOLE, TIP, TIP_GAP
from .guide_layout import guide_layout
from .stage_choice import calibration_stage


@dataclass(frozen=True)
class StandLayout:
    """Derived dimensions (mm) of the stand, which is sized for the set-ups that the design has."""

    design: Design

    @cached_property
    def array(self) -> Layout:
        return Layout(self.design)

    @cached_property
    def cart(self) -> CartLayout | None:
        return cart_layout(self.design)

    @cached_property
    def stage(self) -> Stage:
        """The horizontal stages of the calibration."""
        return calibration_stage(self.array)

    @property
    def base_front(self) -> float:
        """y of the base plate's front edge."""
        reach = [STAGE / 2 + 45.0]  # micrometer of the lower stage
        if self.design.calibration is not None:
            reach.append(self.stage.size / 2 + 45.0)
        if self.cart is not None:
            reach.append(self.cart.cart_half + 20.0)
        return -float(ceil(max(reach)))

    @property
    def base_back(self) -> float:
        return POST_Y + POST[1] + 15.0

    @property
    def base_length(self) -> float:
        """Along x: the cart's whole roll on it."""
        cart = self.cart.cart if self.cart is not None else None
        roll = 2 * (cart.length / 2 + cart.roll + 10.0) if cart is not None else 0.0
        return max(BASE[0], float(ceil(roll)))

    @property
    def pads_up(self) -> float:
        """z of the pads in the calibration set-up: two stages of two plates, mount, and the array on its
        back."""
        a = self.array
        carrier_top = a.carrier_bottom + self.design.clamp.carrier_thickness
        return round(2 * self.stage.height + PLATE + carrier_top + self.design.element.pad_height, 9)

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
            if self.cart is not None:
                heights.append(self.cart.sample_top)
        return tuple(heights)

    @cached_property
    def post_rows(self) -> tuple[float, ...]:
        """Heights of the post's rows of threads."""
        needed = [self.stage_middle(t) + s * STAGE_HOLE for t in self.touches for s in (-1, 1)]
        guide = guide_layout(self.design)
        if guide is not None:
            needed += [guide.riser_middle - RISER_PITCH, guide.riser_middle + RISER_PITCH]
        low, high = min(needed), max(needed)
        return tuple(low + ROW_PITCH * i for i in range(round((high - low) / ROW_PITCH) + 1))

    @property
    def post_height(self) -> float:
        return self.post_rows[-1] + 15.0
