"""Rules on the vertical guide that the array comes down on, and its weights."""

from __future__ import annotations

from collections.abc import Iterator

from ..array.layout import Layout
from ..language.finding import SAME, Finding
from ..language.metric import counterbore_diameter
from ..rigs.frame import BAR, BAR_FRONT, BAR_WIDTH, CARRIAGE_LENGTH, RAIL_HEIGHT
from ..rigs.linear_guide import guide_layout
from ..rigs.moving_weight import BAR_SCREW_X
from ..rigs.stiffness import grasping_lines, sample_lines
from .board_rules import leads_reach_from_guide
from .calibration_rules import carrier_screws_fit, carrier_threads_clear
from .cart_rules import LEAST_AIR, pads_on_sample
from .rule import at_most, fits, rule, too_much, wrong


@rule(after="stop_land_above_arm")
def weights_clear_guide(layout: Layout) -> Iterator[Finding]:
    g = layout.design.grasping
    if g is None:
        return
    most = 2 * (BAR_FRONT + BAR + RAIL_HEIGHT - 6.5 - LEAST_AIR)
    yield from at_most("grasping.weight_diameter", "weights rub on the guide", g.weight_diameter, most)


@fits
def bar_clears_screws(layout: Layout) -> Iterator[Finding]:
    clamp = layout.design.clamp
    head = counterbore_diameter(clamp.mount_thread) / 2
    beside = layout.mount_x - head - BAR_WIDTH / 2
    before = BAR_FRONT - clamp.mount_pitch_y / 2 - head
    if max(beside, before) < 0.2 - SAME:
        most = 2 * (BAR_FRONT - head - 0.2)
        what = "the bar overlaps the carrier's screws"
        yield wrong("clamp.mount_pitch_y", what, clamp.mount_pitch_y, f"at most {most:g} mm")


@fits
def foot_holes_apart(layout: Layout) -> Iterator[Finding]:
    rig = guide_layout(layout.design)
    if rig is not None:
        what = "the bar's screws in the foot"
        yield from carrier_threads_clear(layout, BAR_SCREW_X, rig.bar_middle, what)


@fits
def rail_is_long_enough(layout: Layout) -> Iterator[Finding]:
    rig = guide_layout(layout.design)
    if rig is None:
        return
    g = rig.grasping
    path, length = "grasping.rail_length", g.rail_length
    if abs(length / 20 - round(length / 20)) > SAME:
        yield wrong(path, "not a multiple of the rail's hole pitch", length, "a multiple of 20 mm")
        return
    half = CARRIAGE_LENGTH / 2
    top = rig.riser_middle + length / 2 - rig.carriage_middle - half
    bottom = rig.carriage_middle - half - (rig.riser_middle - length / 2)
    if top < g.lift - SAME or bottom < 1.0:
        what = f"carriage can rise {top:.3g} mm and fall {bottom:.3g} mm"
        yield wrong(path, what, length, f"rise at least {g.lift:g}, fall at least 1 mm")


@fits
def platform_clears_latch(layout: Layout) -> Iterator[Finding]:
    """The platform comes down beside the latch, which stands at the height of the lifted carriage."""
    rig = guide_layout(layout.design)
    if rig is not None:
        most = round(rig.bar_height - rig.carriage_on_bar + CARRIAGE_LENGTH / 2 - LEAST_AIR, 9)
        what = "the platform comes down on the latch"
        yield from at_most("grasping.lift", what, rig.grasping.lift, most)


@fits
def guide_stays_straight(layout: Layout) -> Iterator[Finding]:
    yield from too_much(layout, grasping_lines)


@fits
def sample_stand_stays_straight(layout: Layout) -> Iterator[Finding]:
    yield from too_much(layout, sample_lines)


# Requirements of the vertical guide on an array, and of the stand for the sample's stiffness.
FITS = (
    pads_on_sample,
    carrier_screws_fit,
    bar_clears_screws,
    foot_holes_apart,
    rail_is_long_enough,
    platform_clears_latch,
    leads_reach_from_guide,
    guide_stays_straight,
)
SAMPLE_FITS = (sample_stand_stays_straight,)
