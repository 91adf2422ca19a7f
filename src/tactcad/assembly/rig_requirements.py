"""What must hold for the rigs: four wheels on a plane, the roller in its seat."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

import numpy as np

from tactcad.design.present import present
from tactcad.design.tree import Design
from tactcad.parts.library.bearings import BORE, OUTSIDE
from tactcad.parts.library.dowels import LEAST_PLAY, dowel_limits
from tactcad.parts.library.fits import deviations
from tactcad.parts.rigs.cart_layout import LOOSE_WHEEL, cart_layout
from tactcad.parts.rigs.cart_plate import AXLES, AXLES_OVER
from tactcad.parts.rigs.roller_tip import SEAT, SEAT_RADIUS, seat_radius
from tactcad.scenes.scene import Scene

from .mechanic import Assembled
from .requirement import Requirement, summed
from .variables import Array, DimensionLimits, variable

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
AROUND = np.array([1.0, -1.0, 1.0, -1.0])


def rig_requirements(
    design: Design, scenes: Sequence[Scene], known: dict[str, DimensionLimits]
) -> list[Requirement]:
    """Requirements on the rigs that these scenes show; adds the variables they depend on to `known`."""
    shown = {scene.name for scene in scenes}
    wanted = []
    if shown & {"sample-stiffness", "grasping"}:
        wanted.append(_wheels(design, known))
    if "calibration" in shown:
        wanted += _roller(design, known)
    return wanted


def _wheels(design: Design, known: dict[str, DimensionLimits]) -> Requirement:
    rig = present(cart_layout(design))
    plate = ((f"{design.name}-cart-plate", AXLES_OVER),)
    for name, (low, high), of in (
        (AXLE_HEIGHT, (-AXLES, AXLES), plate),
        (WHEEL, OUTSIDE, ()),
        (BORES, BORE, ()),
        (SHANKS, deviations(SHANK, rig.bearing.d), ()),
    ):
        known[name] = variable(name, low, high, len(AROUND), of)
    return Requirement("wheels touch", "mm", -inf, LOOSE_WHEEL, loose_wheel)


def loose_wheel(a: Assembled) -> Array:
    """How far a wheel stands off the plane of the other three, axles tightened while the cart is pressed on a
    surface plate: each wheel gives way by half its play on the shank. A shank that would not enter is
    polished until it does."""
    heights = a.made[AXLE_HEIGHT] - a.made[WHEEL] / 2
    play = np.maximum(a.made[BORES] - a.made[SHANKS], 0.0)
    off = np.abs(heights @ AROUND) - play.sum(axis=1) / 2
    return np.maximum(off, 0.0)[:, np.newaxis]


def _roller(design: Design, known: dict[str, DimensionLimits]) -> list[Requirement]:
    size, of = present(design.calibration).roller, ((f"{design.name}-tip-roller", SEAT_RADIUS),)
    seat, pin = "roller tip: seat radius", "roller: diameter"
    low, high = (limit - float(size) for limit in dowel_limits(size))
    known[seat], known[pin] = variable(seat, -SEAT, SEAT, stated=of), variable(pin, low, high)
    play = 2 * seat_radius(size) - float(size)
    return [
        summed("roller enters its seat", LEAST_PLAY, inf, play, ((seat, 2.0), (pin, -1.0))),
        summed("roller in its seat's middle", -inf, ROLLER_PLACE, play / 2, ((seat, 1.0), (pin, -0.5))),
    ]
