"""Compliance of the stop plate where an arm presses it off its ledges, held down by set screws.

Two beams in series, each on supports that let its ends turn. Across, from one row of set screws to the other,
a strip carries the arm; it is as wide as a slab contributes to a single load (2.4 a (1 - a/span), in the
middle 0.6 of the span; BS 8110-1, 3.5.2.2). Along, the whole plate spans from one pair of set screws to the
next. The set screw's compression is added. Ledges, further spans, and the screws' seating, which presses the
plate on its ledges, only make it stiffer.

The carrier is left out: held at its threads in the middle it opens no gap by a hundredth of a micrometre
(`carrier_opens`; stiffness_table.py checks that, and states it for an array held by its end plates alone).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, pi
from typing import TYPE_CHECKING

from tactcad.design.materials import ALLOYS
from tactcad.mechanics.bending import Beam

from .library.screws import METRIC

if TYPE_CHECKING:
    from .layout import Layout

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
        """Compliance under a single arm, wherever it stands, mm/N."""
        return self.across.supported() + self.along.supported() + self.screw


def stop_plate_beams(layout: Layout, pitch: float | None = None) -> StopPlate:
    """The design's plate; `pitch` (mm between set screws) replaces the design's."""
    d = layout.design
    t = d.clamp.stop_plate_thickness
    span = unheld(layout) if pitch is None else pitch
    across = 2 * layout.hold_down_x
    m = METRIC[d.clamp.screw]
    core = pi / 4 * (m.d - 0.9382 * m.pitch) ** 2  # stress area, ISO 898-1

    def steel(length: float, width: float) -> Beam:
        return Beam(length, width, t, STEEL_MODULUS, STEEL_POISSON)

    return StopPlate(
        steel(across, min(SLAB * across, layout.stop_plate_width)),
        steel(span, 2 * layout.stop_plate_half),
        (layout.hold_down.length or 0.0) / (STEEL_MODULUS * core),
    )


def carrier_beam(layout: Layout, length: float) -> Beam:
    """That length (mm) of the carrier along the row as a beam; its holes are neglected."""
    alloy = ALLOYS[layout.design.clamp.plate_alloy]
    width, t = layout.carrier_size[0], layout.design.clamp.carrier_thickness
    return Beam(length, width, t, alloy.youngs_modulus, alloy.poisson)


def carrier_opens(layout: Layout, y: float) -> float:
    """By how much the carrier, held in its middle, opens the gap of an arm at `y`: mm/N of stop force, < 0
    closes it.

    The stop pushes the carrier up at y, u of the half length h; the load, which is more, goes through the end
    plate to the carrier's end. The carrier rises at u by bending h^3 u^3/3EI, its end by h^3 u^2 (3 - u)/6EI,
    the ledges between the ends by (1 + u)/2 of that. Shear and twist (the stop x off the middle line) raise
    the carrier and its end by the same k h u, k = 1/(5/6 G A) + x^2/(G J). The difference is what opens:

        h u (1 - u) (k/2 - h^2 u (u + 3)/12EI)
    """
    h = layout.end_plate_y
    u, x = abs(y) / h, layout.pad_inner + layout.design.stop.land_length
    beam = carrier_beam(layout, h)
    k = 1.0 / beam.shear + x**2 / beam.torsion
    return h * u * (1.0 - u) * (k / 2.0 - h**2 * u * (u + 3.0) / (12.0 * beam.bending))


def unheld(layout: Layout) -> float:
    """Largest length along the row without set screws, mm: between two pairs, or twice what arms stand beyond
    the last."""
    screws = layout.hold_down_y
    return max([b - a for a, b in zip(screws, screws[1:])] + [2 * layout.beyond_screws])


def derived_pitch(layout: Layout) -> float:
    """Largest pitch of the set screws, whole mm, at which the plate's bending along the row is within SHARE
    of the gap's tolerance under the overload force: a gap always exceeds its tolerance.
    """
    d = layout.design
    width, t = 2 * layout.stop_plate_half, d.clamp.stop_plate_thickness
    for pitch in range(LONGEST_PITCH, ceil(shortest_pitch(layout)), -1):
        along = Beam(pitch, width, t, STEEL_MODULUS, STEEL_POISSON).supported()
        if along * d.rating.overload_force <= SHARE * d.stop.tolerance:
            return float(pitch)
    return shortest_pitch(layout)


def shortest_pitch(layout: Layout) -> float:
    """Shortest pitch at which neighbouring set screws, half of it apart, leave metal between them, mm."""
    return max(5.0, 2 * METRIC[layout.design.clamp.screw].d + 1)


LONGEST_PITCH = 200  # mm, the field's range
