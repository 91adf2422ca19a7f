"""Compliance of the stop plate, held down by set screws, under an arm that presses it off its ledges.

Two beams in series, each on supports that let its ends turn. Across, from one row of set screws to the other,
a strip carries the arm; it is as wide as a slab contributes to a single load (2.4 a (1 - a/span), in the
middle 0.6 of the span; BS 8110-1, 3.5.2.2). Along, the whole plate spans from one pair of set screws to the
next. The set screw's compression is added. Ledges, further spans, and the screws' seating, which presses the
plate on its ledges, only make it stiffer.

The carrier is left out: held at its threads in the middle it opens no gap by a hundredth of a micrometre
(`seating.carrier_opens`; stiffness_table.py checks that, and states it for an array held by its end plates
alone).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, pi

from tactcad.mechanics.statics import Beam

from ..language.metric import METRIC

# 1.4301, EN 10088-1; A2 screws are of the same steel, the plate's 1.4034 is stiffer (215000). MPa
STEEL_MODULUS, STEEL_POISSON = 200000.0, 0.3
SLAB = 0.6
# Share of its gap by which the plate may give way under an arm. The gap is cut narrower by the value computed
# here. If the true value were a third larger, which finite elements do not find, the error would be 3 % of
# the gap; the rated deflection has a margin of 5 % (1.2 over 1.14).
SHARE = 0.1


@dataclass(frozen=True)
class StopPlate:
    """The plate's beams between set screws, and the compliance of one set screw (mm/N).

    The worst case is one arm under the whole overload force: the same force on several arms bends the plate
    less.
    """

    across: Beam
    along: Beam
    screw: float

    @property
    def one(self) -> float:
        """Compliance under a single arm at any place, mm/N."""
        return self.across.supported() + self.along.supported() + self.screw


def stop_plate_beams(
    rows: float, pitch: float, plate: tuple[float, float, float], screw: str, length: float
) -> StopPlate:
    """The beams of a plate under set screws.

    Parameters
    ----------
    rows, pitch
        Between the rows of set screws, and along the row between two pairs, mm.
    plate
        Its length across the rows, width along them, and thickness, mm.
    screw, length
        Thread of the set screws, and their length, mm.
    """
    across, width, t = plate
    m = METRIC[screw]
    core = pi / 4 * (m.d - 0.9382 * m.pitch) ** 2  # stress area, ISO 898-1
    return StopPlate(
        _steel(rows, min(SLAB * rows, width), t), _steel(pitch, across, t), length / (STEEL_MODULUS * core)
    )


def _steel(length: float, width: float, thickness: float) -> Beam:
    return Beam(length, width, thickness, STEEL_MODULUS, STEEL_POISSON)


def derived_pitch(across: float, thickness: float, screw: str, force: float, room: float) -> float:
    """Largest pitch of the set screws, whole mm, at which the plate's bending along the row under `force` (N)
    is within `room` (mm).
    """
    least = shortest_pitch(screw)
    for pitch in range(LONGEST_PITCH, ceil(least), -1):
        if _steel(pitch, across, thickness).supported() * force <= room:
            return float(pitch)
    return least


def shortest_pitch(screw: str) -> float:
    """Shortest pitch at which neighbouring set screws, half of it apart, leave metal between them, mm."""
    return max(5.0, 2 * METRIC[screw].d + 1)


LONGEST_PITCH = 200  # mm, the field's range
