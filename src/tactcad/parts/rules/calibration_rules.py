"""Rules on the calibration's stages and roller, and on what holds an array by its carrier."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import ceil, hypot

from tactcad.design.fields import present

from ..array.element import deflection_at_pad_edge
from ..array.layout import HOLE_WEB, Layout
from ..bought.standard_parts import STAGES, dowel_diameter
from ..language.finding import SAME, Finding
from ..language.metric import METRIC, counterbore_diameter
from ..rigs.force_gauge import LEAST_OVER_PAD, longest_roller
from ..rigs.frame import FOOT, LEAST_UNDER_HEAD, STAGE, STAGE_HOLE, carrier_screw_length, under_carrier_screw
from ..rigs.stand import (
    AIR,
    StandLayout,
    calibration_stage,
    far,
    faults_of,
    most_before_post,
    most_carrier,
    most_elements,
)
from ..rigs.stiffness import calibration_lines, calibration_loads
from .board_rules import leads_reach_from_stages
from .rule import at_least, at_most, fits, misfit, rule, too_much, wrong

ROLLER_OUT = 0.1  # mm between the roller's holder and the pads next to the pressed one; chosen


@rule(after="stop_land_above_arm")
def axis_reaches_contact(layout: Layout) -> Iterator[Finding]:
    d = layout.design
    if d.calibration is None:
        return
    rig, c = StandLayout(d), d.calibration
    down = max(c.travel, d.sample.travel if d.sample else 0.0)
    for touch in rig.touches:
        rest = rig.axis_middle(touch) - rig.stage_middle(touch)
        need = max(rest + c.retract, down - rest)
        what = f"vertical axis rests {rest:+.3g} mm off its middle"
        yield from at_least("calibration.axis_travel", what, c.axis_travel, need, f"at least {need:.4g} mm")
    free = STAGE / 2 - STAGE_HOLE + METRIC["M4"].head / 2 + AIR
    what = "its moving half, driven to an end, covers the heads of its screws"
    yield from at_least("calibration.axis_travel", what, c.axis_travel, free, f"at least {free:.4g} mm")


@rule(after="stop_land_above_arm")
def calibration_bends_elastically(layout: Layout) -> Iterator[Finding]:
    """No hinge yields at the end of the travel: in this set-up there is no stop plate."""
    c = layout.design.calibration
    if c is None or misfit(layout, FITS) is not None:
        return
    for load in calibration_loads(layout.design):
        if c.travel > load.travel_at_yield:  # not outside the estimator's range
            yield wrong(
                "calibration.travel",
                f"the hinge of element {load.place.number} yields before its end",
                c.travel,
                f"at most {load.travel_at_yield:.4g} mm",
            )


@rule(after="stop_land_above_arm")
def roller_stays_on_pad(layout: Layout) -> Iterator[Finding]:
    """High pads of short arms swing sideways: at the end of the travel the roller is still on every pad."""
    c = layout.design.calibration
    if c is None or misfit(layout, FITS) is not None:
        return
    roller = dowel_diameter(c.roller) / 2
    for load in calibration_loads(layout.design):
        most = deflection_at_pad_edge(layout, load.place, roller)
        deflection = c.travel if load.refused else load.deflection
        if deflection > most:
            yield wrong(
                "calibration.travel",
                f"the pad of element {load.place.number} swings out from under the roller",
                c.travel,
                f"at most {c.travel * most / deflection:.4g} mm",
            )


@fits
def stages_reach_pads(layout: Layout) -> Iterator[Finding]:
    travel = present(layout.design.calibration).stage_travel
    yield from at_most(
        "calibration.stage_travel", "no stage sold travels so far", travel, max(s.travel for s in STAGES)
    )
    if all(s.travel < far(layout) or most_before_post(s) < far(layout) for s in STAGES):
        yield wrong(
            "array.row_arms",
            f"no stage sold reaches a pad {far(layout):g} mm off the middle before the post is in its way",
            max(map(len, layout.design.array.row_arms)),
            f"at most {most_elements(layout)} elements a row at this pitch, or a smaller array.pitch",
        )


@fits
def mount_clears_carrier(layout: Layout) -> Iterator[Finding]:
    if not faults_of(calibration_stage(layout), layout):
        return
    reaching = [s for s in STAGES if far(layout) <= min(s.travel, most_before_post(s))]
    most = 2 * max(map(most_carrier, reaching or STAGES))
    over = layout.carrier_width - most
    if min(layout.carrier_size) <= most + SAME:
        return
    design = layout.design
    what = (
        f"the array's carrier, {layout.carrier_width:g} mm wide, covers the screws of the calibration mount "
        "on every stage that reaches its pads"
    )
    pattern = design.clamp.mount_pitch_y
    narrower = replace(design, clamp=replace(design.clamp, mount_pitch_y=pattern - over))
    if Layout(narrower).carrier_width <= layout.carrier_width - over + SAME:
        yield wrong("clamp.mount_pitch_y", what, pattern, f"at most {pattern - over:g} mm")
    else:
        longest = max(map(len, design.array.row_arms))
        fewer = longest - ceil(over / design.array.pitch - SAME)
        yield wrong("array.row_arms", what, longest, f"at most {fewer} elements a row, or a smaller pitch")


@fits
def carrier_screws_fit(layout: Layout) -> Iterator[Finding]:
    c = layout.design.clamp
    under = under_carrier_screw(layout.design)
    most = FOOT - METRIC[c.mount_thread].head_height  # heads sunk
    if not LEAST_UNDER_HEAD - SAME <= under <= most + SAME:
        length = carrier_screw_length(layout.design)
        low, high = (round(c.carrier_thickness + under - u, 9) for u in (most, LEAST_UNDER_HEAD))
        yield wrong(
            "clamp.carrier_thickness",
            f"{length:g} mm screws into the carrier leave {under:g} mm under their heads",
            c.carrier_thickness,
            f"from {low:g} to {high:g} mm",
        )
    least = counterbore_diameter(c.mount_thread) + HOLE_WEB
    what = "heads of the screws into the carrier run into each other"
    yield from at_least("clamp.mount_pitch_y", what, c.mount_pitch_y, least)
    offset = c.carrier_screw_offset
    if 2 * layout.mount_x < least - SAME:
        yield wrong(
            "clamp.carrier_screw_offset",
            "heads of the screws into the carrier run into the other row's",
            offset,
            f"at least {offset + 2 * least - 4 * layout.mount_x:g} mm",
        )


@fits
def mount_holes_apart(layout: Layout) -> Iterator[Finding]:
    hole = calibration_stage(layout).hole
    yield from carrier_threads_clear(layout, hole, hole, "the stage's screws in the array mount")


def carrier_threads_clear(layout: Layout, x: float, y: float, what: str) -> Iterator[Finding]:
    """The carrier's threads clear M4 screws at (x, y), with a web between their counterbores."""
    c = layout.design.clamp
    apart = hypot(layout.mount_x - x, c.mount_pitch_y / 2 - y)
    least = (counterbore_diameter("M4") + counterbore_diameter(c.mount_thread)) / 2 + HOLE_WEB
    if apart < least - SAME:
        yield wrong(
            "clamp.mount_pitch_y",
            f"screws into the carrier run into {what}: {apart:.3g} mm apart",
            c.mount_pitch_y,
            f"at least {least:g} mm apart",
        )


@fits
def roller_clears_neighbours(layout: Layout) -> Iterator[Finding]:
    d, size = layout.design, present(layout.design.calibration).roller
    least, most = d.sheet.thickness + LEAST_OVER_PAD, longest_roller(layout)
    if most < least - SAME:
        yield wrong(
            "array.pitch",
            f"no roller covers a pad and clears its neighbours: {least:g} mm long at least, {most:g} at most",
            d.array.pitch,
            f"at least {d.array.pitch + (least - most) / 2:g} mm",
        )
    out = dowel_diameter(size) / 2
    yield from at_most(
        "calibration.travel",
        "the roller's holder would come down on the neighbouring pads",
        present(d.calibration).travel,
        out - ROLLER_OUT,
        f"at most {out - ROLLER_OUT:g} mm, the roller's radius less {ROLLER_OUT:g}",
    )
    if out > d.array.row_pitch - d.element.pad_length / 2 - 0.1:
        yield wrong("calibration.roller", "roller touches the facing pad", size, "a thinner one")


@fits
def calibration_stays_straight(layout: Layout) -> Iterator[Finding]:
    yield from too_much(layout, calibration_lines)


# What the calibration asks of an array.
FITS = (
    stages_reach_pads,
    mount_clears_carrier,
    carrier_screws_fit,
    mount_holes_apart,
    roller_clears_neighbours,
    leads_reach_from_stages,
    calibration_stays_straight,
)
