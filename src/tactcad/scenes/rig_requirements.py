"""What must hold for the rigs: four wheels on a plane, the roller in its seat."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

from tactcad.design.present import present
from tactcad.parts.layout import Layout
from tactcad.parts.library.bearings import BORE, OUTSIDE
from tactcad.parts.library.dowels import LEAST_PLAY, dowel_limits
from tactcad.parts.library.fits import deviations
from tactcad.parts.rigs.cart_layout import LOOSE_WHEEL, cart_layout
from tactcad.parts.rigs.cart_plate import AXLES, AXLES_OVER
from tactcad.parts.rigs.roller_tip import SEAT, SEAT_RADIUS, seat_radius

from .requirement import Built, DimensionLimits, Requirement, summed, variable

if TYPE_CHECKING:
    from tactcad.mechanics.section import Array

AXLE_HEIGHT, WHEEL, BORES, SHANKS = (
    "axles: height over the cart's underside",
    "wheel: outside diameter",
    "wheel: bore",
    "axle: shank",
)
# Shank of an ISO 4762 screw of product grade A (ISO 4759-1:2000).
SHANK = "h13"
# mm that the roller may lie beside its seat's middle: the load's place along the arm is as uncertain. Where
# the seat is in the tip does not matter: the guide sets the roller by the pad's edge, after it is bonded.
ROLLER_PLACE = 0.02
# Wheels around the cart: the fourth stands off the plane of three by the alternating sum of their heights.
AROUND = (1.0, -1.0, 1.0, -1.0)


def wheels(layout: Layout, known: dict[str, DimensionLimits]) -> list[Requirement]:
    """Of the cart: no wheel is loose. Adds the variables that it depends on to `known`."""
    design = layout.design
    rig = present(cart_layout(design))
    plate = ((f"{design.name}-cart-plate", AXLES_OVER),)
    for name, (low, high), of in (
        (AXLE_HEIGHT, (-AXLES, AXLES), plate),
        (WHEEL, OUTSIDE, ()),
        (BORES, BORE, ()),
        (SHANKS, deviations(SHANK, rig.bearing.d), ()),
    ):
        known[name] = variable(name, low, high, len(AROUND), of)
    return [Requirement("wheels touch", "mm", -inf, LOOSE_WHEEL, loose_wheel)]


def loose_wheel(a: Built) -> Array:
    """How far a wheel stands off the plane of the other three, axles tightened while the cart is pressed on a
    surface plate: each wheel gives way by half its play on the shank. A shank that would not enter is
    polished until it does."""
    import numpy as np

    heights = a.made[AXLE_HEIGHT] - a.made[WHEEL] / 2
    play = np.maximum(a.made[BORES] - a.made[SHANKS], 0.0)
    off = np.abs(heights @ np.array(AROUND)) - play.sum(axis=1) / 2
    return np.maximum(off, 0.0)[:, np.newaxis]


def roller(layout: Layout, known: dict[str, DimensionLimits]) -> list[Requirement]:
    """Of the calibration's tip: the roller lies in its seat. Adds the variables to `known`."""
    design = layout.design
    size, of = present(design.calibration).roller, ((f"{design.name}-tip-roller", SEAT_RADIUS),)
    seat, pin = "roller tip: seat radius", "roller: diameter"
    low, high = (limit - float(size) for limit in dowel_limits(size))
    known[seat], known[pin] = variable(seat, -SEAT, SEAT, stated=of), variable(pin, low, high)
    play = 2 * seat_radius(size) - float(size)
    return [
        summed("roller enters its seat", LEAST_PLAY, inf, play, ((seat, 2.0), (pin, -1.0))),
        summed("roller in its seat's middle", -inf, ROLLER_PLACE, play / 2, ((seat, 1.0), (pin, -0.5))),
    ]
