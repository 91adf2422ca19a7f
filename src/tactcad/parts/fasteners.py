"""Which screws and dowels clamp the stack: standard lengths, or tie rods and ground rod beyond them."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

from .layout import Layout
from .library.dowels import dowel_lengths
from .library.fits import deviations
from .library.screws import CAP_SCREW_LENGTHS, METRIC, TAP_REACH, engagement

# Least plate under a screw's head, and least grip of a dowel in each end plate, in mm: chosen, one
# diameter of the usual M3 and of its dowel less the pin's chamfer.
LEAST_UNDER_HEAD = 2.5
LEAST_GRIP = 3.0
LEAST_UNDER_CARRIER_HEAD = 2.0
# mm that heads stay below the carrier's face, on which foot and array mount lie: chosen, twice what
# ISO 2768-m leaves a counterbore 3 to 6 mm deep.
SUNK = 0.2


# mm, plus and minus: spacers are as thick as the pitch leaves beside the measured sheet, so that the stack is
# as long as drawn within STACK. Chosen: 0.01 by picking from rolled sheet or by grinding; 0.2 is what the
# carrier's holes take, where six such spacers and five sheets measured to 0.01 are 0.11 off.
SPACER_TOLERANCE, STACK = 0.01, 0.2


@dataclass(frozen=True)
class Clamping:
    """Lengths in mm.

    screw           ISO 4762 length through the stack, or the tie rod's where rod is true
    head_plate_web  head plate's material under the screw's head; None for tie rods
    dowel           dowel length, a standard one or ground rod cut to length
    """

    rod: bool
    screw: float
    head_plate_web: float | None
    dowel: float


def clamping(layout: Layout) -> Clamping:
    """The stack's fasteners.

    A cap screw must leave LEAST_UNDER_HEAD under its head and engage 1.5 d in the tapped plate
    without passing through it; the counterbore takes up the difference to the standard length, and sinks the
    head, or there is none.
    """
    d = layout.design.clamp
    plate, stack = d.end_plate_thickness, layout.stack
    dowel = _dowel(layout)
    for length in CAP_SCREW_LENGTHS[d.screw]:
        # as deep in the tapped plate as 2/3 of it, which leaves the screw's end inside, and no deeper than
        # its thread
        engaged = max(engagement(d.screw), min(round(2 / 3 * plate, 1), TAP_REACH * METRIC[d.screw].d))
        web = round(length - stack - engaged, 9)
        if plate > web > plate - METRIC[d.screw].head_height:  # a counterbore sinks the whole head
            web = round(plate - METRIC[d.screw].head_height, 9)
            engaged = round(length - stack - web, 9)
        # at its longest, in the shortest stack, it still ends inside the plate
        free = deviations("js15", length)[1] + STACK
        reach = min(plate - free, TAP_REACH * METRIC[d.screw].d)
        if LEAST_UNDER_HEAD <= web <= plate and engaged <= reach:
            return Clamping(False, length, web, dowel)
    m = METRIC[d.screw]
    ends = m.nut_height + 2 * m.pitch
    return Clamping(True, float(ceil(stack + 2 * plate + 2 * ends)), None, dowel)


def _dowel(layout: Layout) -> float:
    plate, stack = layout.design.clamp.end_plate_thickness, layout.stack
    fitting = [
        n
        for n in dowel_lengths(layout.design.clamp.dowel)
        if stack + 2 * LEAST_GRIP <= n <= stack + 2 * plate
    ]
    if fitting:
        return fitting[-1]
    return (
        float(ceil(stack + 2 * LEAST_GRIP))
        if ceil(stack + 2 * LEAST_GRIP) <= stack + 2 * plate
        else stack + 2 * plate
    )


def dowel_depth(layout: Layout) -> float:
    """How deep a dowel stands in each end plate, from the inner face, mm."""
    return round((clamping(layout).dowel - layout.stack) / 2, 9)


@dataclass(frozen=True)
class CarrierScrew:
    """Length, and the carrier's material under its sunk head, mm."""

    length: float
    under_head: float


def carrier_screw(layout: Layout) -> CarrierScrew | None:
    """The cap screw that fixes the carrier to an end plate's blind thread; None where no length fits.

    It engages 1.5 d and 0.8 mm of the 1.5 d + 1.5 mm of thread; its head is sunk.
    """
    d = layout.design.clamp
    fits = thinnest_carrier(d.screw) <= d.carrier_thickness + 1e-9  # mm: written in decimals, kept in binary
    return _shortest_carrier_screw(d.screw) if fits else None


def thinnest_carrier(thread: str) -> float:
    """Least carrier thickness that sinks the head of its screws, mm."""
    return round(_shortest_carrier_screw(thread).under_head + METRIC[thread].head_height + SUNK, 9)


def _shortest_carrier_screw(thread: str) -> CarrierScrew:
    under = ((length, round(length - engagement(thread) - 0.8, 9)) for length in CAP_SCREW_LENGTHS[thread])
    return next(CarrierScrew(*pair) for pair in under if pair[1] >= LEAST_UNDER_CARRIER_HEAD)
