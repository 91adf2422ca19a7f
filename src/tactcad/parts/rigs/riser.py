r"""Block between post and guide rail.

+---------+
| O     O |   screws into the post, heads deep inside
|    o    |   ^ z
|    o    |   |     the rail's M3 threads
| O     O |   +-> x
|    o oo |   end stop's pin, below the rail; latch, with a hole to keep its pin
+---------+
"""

from __future__ import annotations

from dataclasses import replace
from math import floor

from tactcad.contour import rectangle

from ..description import Extrusion, Feature, Hole, Part
from ..library.dowels import dowel_diameter
from ..library.fits import deviations
from ..limits import FACES, Geometric
from ..plate import plate
from ..screw_holes import sunk, tapped_blind
from .frame import CARRIAGE_LENGTH, END_STOP_OUT, POST, RISER_PITCH, STAGE_HOLE, UNDER_RAIL
from .guide_layout import GuideLayout
from .rail import rail_holes

RISER_SCREW, RISER_UNDER_HEAD = 16.0, 9.0  # M4 into the post: 7 mm engaged, head deep in the riser

# Pin below the rail's end that the carriage comes down on: it stands 8 mm out, where the carriage is solid
# from 6.5 on, and the foot passes it.
STOP_PIN, STOP_LENGTH = "3", 16.0
STOP_DEPTH = STOP_LENGTH - END_STOP_OUT


def stop_below(rig: GuideLayout) -> float:
    """How far the end stop's pin stands below the rail's middle, mm: 0.5 clear of its end."""
    return rig.grasping.rail_length / 2 + 2.0


# The latch: a pin as the end stop's, by hand in a hole beside the rail, under the carriage's side; out of use
# it stands beside the carriage. D10 leaves it 0.012 of play at least.
LATCH, LATCH_KEPT, LATCH_FIT = 7.25, 16.0, "D10"


def latch_above(rig: GuideLayout) -> float:
    """How far the latch's holes stand over the rail's middle, mm: with the carriage lifted all the way."""
    lowest = rig.carriage_middle + rig.grasping.lift - CARRIAGE_LENGTH / 2
    # to a tenth: the carriage comes down on it by less
    return floor(10 * (lowest - dowel_diameter(STOP_PIN) / 2 - rig.riser_middle)) / 10


def latch_hole() -> float:
    """Diameter of the latch's holes, mm: the middle of their limits."""
    size = float(STOP_PIN)
    return round(size + sum(deviations(LATCH_FIT, size)) / 2, 6)


def latch_lies() -> float:
    """How far under its hole's axis the latch's pin lies, mm."""
    return (latch_hole() - dowel_diameter(STOP_PIN)) / 2


def riser(rig: GuideLayout) -> Part:
    """Block between post and guide rail. Front face (the rail's) at local z = 0, contour in (x, z) about its
    middle."""
    length, depth = rig.grasping.rail_length, rig.riser_depth
    half = max(length / 2, RISER_PITCH + 8.0)
    low = max(half, length / 2 + UNDER_RAIL)  # material below the pin: its diameter from the middle, and 2 mm
    features: list[Feature] = [
        sunk(
            "post",
            "M4",
            (sx * STAGE_HOLE, sy * RISER_PITCH, 0.0),
            (0, 0, 1),
            depth,
            min(RISER_UNDER_HEAD, depth),
        )
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    pin = Hole(
        "end_stop",
        (0.0, -stop_below(rig), 0.0),
        (0, 0, 1),
        dowel_diameter(STOP_PIN),
        STOP_DEPTH,
        False,
        drill_point=True,
        tolerance="H7",
    )
    features += [
        replace(pin, name="latch", at=(x, latch_above(rig), 0.0), diameter=latch_hole(), tolerance=LATCH_FIT)
        for x in (LATCH, LATCH_KEPT)
    ]
    features += [pin, *(tapped_blind("rail", "M3", (0.0, y, 0.0), (0, 0, 1)) for y in rail_holes(length))]
    return plate(
        rig.design,
        "riser",
        "Riser",
        Extrusion(rectangle(-POST[0] / 2, -low, POST[0] / 2, half), depth),
        features,
        finish="rail face Ra 0.8",
        geometric=(Geometric("parallelism", "parallelism", 0.01, (FACES[1],), ("A",)),),
    )
