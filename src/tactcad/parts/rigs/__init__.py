"""Parts of the rigs around the array: calibration, sample stiffness, grasping and bonding; one file a part.

In: where things stand, derived once from the design (`stand_layout`, `cart_layout`, `guide_layout`,
`bonding_layout`; the second and third are None where the design has no such tables). Out: parts for the
scenes, which see them here by name.
"""

from __future__ import annotations

from .array_mount import array_mount
from .axis_plate import axis_plate
from .axle_shim import axle_shim
from .ballast import ballast
from .bar import bar
from .base_plate import base_plate
from .bonding_clamp import bonding_clamp, bonding_pad
from .bonding_nest import bonding_nest
from .carriage import carriage
from .cart_plate import cart_plate
from .disc_weight import disc_weight
from .flat_tip import flat_tip
from .foot import foot
from .force_gauge import force_gauge
from .gauge_plate import gauge_plate
from .holder_body import holder_body
from .holder_lid import holder_lid
from .hose_fitting import hose_fitting
from .micrometer import micrometer
from .pin import pin
from .platform import platform
from .post import post
from .rail import rail
from .riser import riser
from .roller_tip import roller_tip
from .sample import sample
from .stage_fixed import stage_fixed
from .stage_moving import stage_moving

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
    "stage_fixed",
    "stage_moving",
]
