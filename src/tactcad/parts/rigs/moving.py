"""What moves with the array in the grasping set-up: every part with its number, and what it weighs.

The scene places the same parts; here they are only counted, so that the ballast and the rule on it need no
placements. What was placed is weighed again by the checks.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import floor

from tactcad.parts import plates
from tactcad.parts.library import dowels, screws

from ..description import Part
from ..element import element
from ..fasteners import carrier_screw, clamping
from ..layout import Layout
from . import bought, carried
from .layout import STANDARD_GRAVITY, RigLayout


def moving_mass(rig: RigLayout, under: float = 0.0, gap: float | None = None) -> float:
    """Mass in g of all that moves, without ballast and weights; the pin is made for `under` mm of ballast.

    Elements have the design's stop gaps, or `gap` (mm) if given, which needs no estimator.
    """
    return sum(count * part.mass for part, count in (*_array(rig.array, gap), *_carried(rig, under)))


def wanted_mass(rig: RigLayout) -> float:
    """Mass (g) that grasping.moving_weight asks for."""
    return rig.design.grasping.moving_weight / STANDARD_GRAVITY * 1e3


def trim(rig: RigLayout) -> tuple[float, float]:
    """The ballast's thickness (mm) that the pin is made for, and its mass (g); zeros where what moves is too heavy.

    A pin that is longer for the ballast's sake weighs a little more itself.
    """
    mass = wanted_mass(rig) - moving_mass(rig)
    under = carried.ballast_thickness(rig, max(mass, 0.0))
    return under, max(wanted_mass(rig) - moving_mass(rig, under), 0.0)


def ballast_range(rig: RigLayout) -> tuple[float, float]:
    """Least and largest moving weight (N) that a ballast under the weights trims to.

    Without the estimator: elements are taken without a stop gap, and all that a gap could take off them is
    allowed for.
    """
    layout, d = rig.array, rig.design
    heavy = moving_mass(rig, gap=0.0)
    over = max(layout.ledge_of(p.hinge) - p.hinge.h for p in layout.elements)
    land = over * (d.stop.land_length + over) * d.sheet.thickness * d.material.density * 1e-6
    light = heavy - land * len(layout.elements)
    grams = 1.0 / carried.ballast_thickness(rig, 1.0)  # of a millimetre of disc
    stack = round(d.grasping.weights) * bought.disc_weight(rig).body.thickness
    longest = carried.pin(rig, LONGEST_PIN - 1.0 - stack).mass
    most = light + (LONGEST_PIN - 1.0 - stack) * grams
    newton = STANDARD_GRAVITY * 1e-3
    return (heavy + longest + LEAST_BALLAST * grams) * newton, most * newton


# A thinner disc is not turned flat (chosen); a longer pin, in steps of 5 mm, bends under the tool: 12 diameters.
LEAST_BALLAST = 0.5
LONGEST_PIN = 5.0 * floor(12 * bought.PIN / 5.0)


def _array(layout: Layout, gap: float | None) -> Iterator[tuple[Part, int]]:
    d, c, fixing = layout.design, clamping(layout), carrier_screw(layout)
    for place in layout.elements:
        yield element(layout, place, gap), 1
    yield plates.blank(layout), len(layout.blanks())
    yield plates.spacer(layout), 2 * (layout.positions + 1)
    for part in (
        plates.end_plate(layout, True),
        plates.end_plate(layout, False),
        plates.stop_plate(layout),
        plates.carrier(layout),
    ):
        yield part, 1
    thread, through = d.clamp.screw, 2 * len(layout.screw_x)
    if c.rod:
        yield screws.threaded_rod(thread, c.screw), through
        yield screws.nut(thread), 2 * through
    else:
        yield screws.cap_screw(thread, c.screw), through
    yield dowels.dowel(d.clamp.dowel, c.dowel), 2 * len(layout.dowel_x)
    yield screws.cap_screw(thread, fixing.length), 4
    yield screws.set_screw(thread, layout.hold_down.length), 2 * len(layout.hold_down_y)


def _carried(rig: RigLayout, under: float) -> Iterator[tuple[Part, int]]:
    yield bought.carriage(), 1
    for part in (carried.foot(rig), carried.bar(rig), carried.platform(rig), carried.pin(rig, under)):
        yield part, 1
    yield screws.cap_screw(rig.design.clamp.mount_thread, carried.CARRIER_SCREW), 4
    yield screws.cap_screw("M4", 10.0), 5  # foot and platform on the bar, two each, and the pin
    yield screws.cap_screw("M3", 8.0), 4  # bar on the carriage
