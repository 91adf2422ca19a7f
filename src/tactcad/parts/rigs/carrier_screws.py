"""How the rigs hold an array by its carrier: four screws into its threads for an axis."""

from __future__ import annotations

from tactcad.design.tree import Design

from ..layout import Layout
from ..screw_holes import corners

# Screws into the carrier's threads end this far inside its far face, where the end plates lie: more than the
# screws' length (js15) and the plates may add.
SHORT_OF_CARRIER = 0.8
CARRIER_SCREW = 10.0


def under_carrier_screw(design: Design) -> float:
    """Plate left under the head of the 10 mm screw into the carrier's thread, mm."""
    return round(CARRIER_SCREW - (design.clamp.carrier_thickness - SHORT_OF_CARRIER), 9)


def carrier_pattern(layout: Layout) -> tuple[tuple[float, float], ...]:
    """(x, y) of the carrier's threads for an axis."""
    x, y = layout.mount_x, layout.design.clamp.mount_pitch_y / 2
    return corners(x, y)
