"""How the rigs hold an array by its carrier: four screws into its threads for an axis."""

from __future__ import annotations

from tactcad.design.tree import Design

from ..finding import SAME
from ..layout import Layout
from ..library.screws import CAP_SCREW_LENGTHS
from ..screw_holes import corners

# Screws into the carrier's threads end this far inside its far face, where the end plates lie: more than the
# screws' length (js15) and the plates may add.
SHORT_OF_CARRIER = 0.8
LEAST_UNDER_HEAD = 2.0  # mm of plate; chosen: as the carrier's own screws


def carrier_screw_length(design: Design) -> float:
    """Of the screws into the carrier, mm: the shortest that leaves enough plate under its head."""
    engaged = design.clamp.carrier_thickness - SHORT_OF_CARRIER
    lengths = CAP_SCREW_LENGTHS[design.clamp.mount_thread]
    return next((n for n in lengths if n - engaged >= LEAST_UNDER_HEAD - SAME), lengths[-1])


def under_carrier_screw(design: Design) -> float:
    """Plate left under the head of the screw into the carrier's thread, mm."""
    engaged = design.clamp.carrier_thickness - SHORT_OF_CARRIER
    return round(carrier_screw_length(design) - engaged, 9)


def carrier_pattern(layout: Layout) -> tuple[tuple[float, float], ...]:
    """(x, y) of the carrier's threads for an axis."""
    x, y = layout.mount_x, layout.design.clamp.mount_pitch_y / 2
    return corners(x, y)
