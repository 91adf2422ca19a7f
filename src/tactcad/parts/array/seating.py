"""The set screws' force on the stop plate; they bend stack and carrier apart between the end plates.

A stop plate that only lies on its ledges, touched by its set screws, is also fixed: seating takes up their
play.
"""

from __future__ import annotations

from math import floor, log10

from tactcad.design.fields import present
from tactcad.design.materials import ALLOYS
from tactcad.mechanics.statics import Beam

from ..bought.screws import seating_force, seating_torque
from .layout import Layout

# Share of the pads' tolerance by which the stack may bow: in root sum of squares it makes the pads' error an
# eighth larger.
BOW = 0.5
# mm: flatness of the rigs' plates and the lid (`finish`); the carrier on one may bow by as much.
FLAT = 0.02
# N m; chosen: the smallest torque drivers for screws begin there.
LEAST_TORQUE = 0.02


def stack_beam(layout: Layout) -> Beam:
    """Both rows' rear bodies and spacers, as high as the spacers, between the end plates."""
    z0, z1 = layout.spacer_z
    m, width = layout.design.material, 2 * layout.design.element.rear_length
    height = max(z1 - z0, 1e-3)  # `remedy` may try a height that rules refuse
    return Beam(layout.stack, width, height, present(m.youngs_modulus), present(m.poisson))


def carrier_beam(layout: Layout, length: float) -> Beam:
    """A length (mm) of the carrier along the row as a beam; its holes are neglected."""
    alloy = ALLOYS[layout.design.clamp.plate_alloy]
    width, t = layout.carrier_size[0], layout.design.clamp.carrier_thickness
    return Beam(length, width, t, alloy.youngs_modulus, alloy.poisson)


def carrier_opens(layout: Layout, y: float) -> float:
    """Opening of the gap of an arm at `y` by the carrier, held in its middle: mm/N of stop force, < 0 closes
    it.

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


def stack_bow(layout: Layout) -> float:
    """Deflection of the stack for each newton on every set screw, mm/N."""
    return _bow(layout, stack_beam(layout))


def carrier_bow(layout: Layout) -> float:
    """Deflection of the carrier for each newton on every set screw, mm/N."""
    return _bow(layout, carrier_beam(layout, 2 * layout.end_plate_y))


def _bow(layout: Layout, beam: Beam) -> float:
    return sum(2 * beam.supported_beside(beam.length / 2 - abs(y)) for y in layout.hold_down_y)


def torque(layout: Layout) -> float:
    """Torque of the set screws, N m, rounded to one digit.

    The thread's seating torque, or less, so that stack and carrier bow no more than they may. 0 if that is
    too little to be set: the screws then only touch the plate.
    """
    thread = layout.design.clamp.screw
    full, force = seating_torque(thread), seating_force(thread)
    bows = force * stack_bow(layout) / (BOW * layout.design.tolerance.pad_height)
    share = max(1.0, bows, force * carrier_bow(layout) / FLAT)
    if share <= 1.0:
        return full
    digit = 10.0 ** floor(log10(full / share))
    down = round(floor(full / share / digit) * digit, 6)
    return down if down >= LEAST_TORQUE else 0.0


def words(layout: Layout) -> str:
    """The set screws' turn, in words for guides."""
    tight = torque(layout)
    return f"to {tight:g} N m" if tight else "until they touch the stop plate and no further"


def force(layout: Layout) -> float:
    """N of each set screw at that torque."""
    thread = layout.design.clamp.screw
    return seating_force(thread) * torque(layout) / seating_torque(thread)
