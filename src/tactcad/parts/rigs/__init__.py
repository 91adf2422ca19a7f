"""Parts of the rigs around the array: calibration, sample stiffness, grasping and bonding.

In: the rigs' layouts, derived once from the design (`StandLayout`, `cart_layout`, `guide_layout`,
`bonding_rigs`; the second and third are None if the design has no such tables). Out: parts for the scenes,
which import them from here.
"""

from __future__ import annotations

from .bonding_fixture import bonding_clamp, bonding_nest, bonding_pad
from .cart import axle_shim, cart_plate, holder_body, holder_lid, hose_fitting, sample
from .force_gauge import axis_plate, flat_tip, force_gauge, gauge_plate, roller_tip
from .linear_guide import carriage, rail, riser
from .moving_weight import ballast, bar, disc_weight, foot, pin, platform
from .setting_fixture import setting_fixture, setting_strip
from .stand import array_mount, base_plate, micrometer, post, stage_fixed, stage_moving

__all__ = [
    "array_mount",
    "axis_plate",
    "axle_shim",
    "ballast",
    "bar",
    "base_plate",
    "bonding_clamp",
    "bonding_nest",
    "bonding_pad",
    "carriage",
    "cart_plate",
    "disc_weight",
    "flat_tip",
    "foot",
    "force_gauge",
    "gauge_plate",
    "holder_body",
    "holder_lid",
    "hose_fitting",
    "micrometer",
    "pin",
    "platform",
    "post",
    "rail",
    "riser",
    "roller_tip",
    "sample",
    "setting_fixture",
    "setting_strip",
    "stage_fixed",
    "stage_moving",
]
