"""Common to all rigs: their frame, sizes that no design changes, and the pads' places.

Frame (mm): x along the arms, y along the rows, z = 0 on the base plate, + up. The force sensor's axis,
the sample's middle and the array's middle are x = y = 0; the post is behind, at + y.
"""

from __future__ import annotations

from tactcad.design.tree import Design

from ..array.layout import Layout
from ..bought.screws import CAP_SCREW_LENGTHS
from ..language.finding import SAME
from ..language.metric import corners

# Micro-stages: two plates of this size and thickness that slide on each other, threads at +-STAGE_HOLE.
STAGE, STAGE_PLATE, STAGE_HOLE = 60.0, 10.0, 25.0
PLATE = 10.0  # plates between stage, sensor and array: one thickness, so that one screw length fits all
PLATE_SCREW = ("M4", 12.0, 5.6)  # thread, length, plate under its sunk head: 6.4 mm engaged, 1.6 d
GAUGE_SIZE = (66.0, 36.0, 230.0)  # force gauge along x, y, z
GAUGE_SHAFT = 10.0  # free length of its M6 shaft
TIP = 18.0  # tip on that shaft, to its contact
TIP_LAND = 2.0  # height of the flat tip's land over its body
TIP_GAP = 4.0  # tip to the gauge's housing: a jam nut on the shaft, and 0.8 mm of air
BASE = (200.0, 12.0)  # base plate along x, thickness
POST = (60.0, 20.0)  # post along x, y
ROW_PITCH = 10.0  # rows of threads in the post
FOOT, BAR, BAR_WIDTH, BAR_HEIGHT, PLATFORM = 8.0, 8.0, 23.0, 60.0, 8.0  # what the guide's carriage carries
RAIL_HEIGHT = 10.0  # guide: mounting face of the carriage over the rail's
RISER_PITCH = 40.0  # riser's screws over and under its middle
RAISED_BAR = 10.0  # its thickness under a raised guide: the next plate sold
CARRIAGE_ON_BAR = 30.0  # carriage's middle over the bar's lower end
BAR_FRONT = 16.0  # y of the bar's front: behind the carrier's threads
BEHIND_BAR = 1.5  # foot and platform behind the bar's back: material around its screws
CARRIAGE_LENGTH = 28.9
END_STOP_OUT = 8.0  # protrusion of the end stop's pin from the riser, below the rail
UNDER_RAIL = 8.0  # riser below the rail's end: the pin, and material under it
# Front of the post: force gauge, its two plates and the stage are in front of it.
POST_Y = GAUGE_SIZE[1] / 2 + 2 * PLATE + 2 * STAGE_PLATE
PIN = 8.0  # of the weight platform, diameter
STANDARD_GRAVITY = 9.80665  # m/s2, by definition (CGPM 1901)


def pad_middles(layout: Layout) -> tuple[tuple[float, float], ...]:
    """Middles (x, y) of all pads, mm."""
    middle = (layout.pad_inner + layout.pad_outer) / 2
    return tuple((middle if place.row == 1 else -middle, place.y) for place in layout.elements)


# Screws into the carrier's threads end this far inside its far face, where the end plates lie: more than the
# screws' length (js15) and the plates may add.
SHORT_OF_CARRIER = 0.8
LEAST_UNDER_HEAD = 2.0  # mm of plate; chosen: as the carrier's own screws


def carrier_screw_length(design: Design) -> float:
    """Length of the screws into the carrier, mm: the shortest that leaves enough plate under its head."""
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
