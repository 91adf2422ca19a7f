"""Which horizontal stages the calibration of an array takes: the smallest sold that do."""

from __future__ import annotations

from math import floor

from tactcad.design.present import present

from ..layout import Layout
from ..library.screws import counterbore_diameter
from ..library.stages import STAGES, Stage
from .frame import POST_Y, pad_middles

AIR = 0.5  # mm between things that pass each other; chosen, as under the cart


def calibration_stage(layout: Layout) -> Stage:
    """The smallest stage that reaches every pad, clears the post, and is not covered by the carrier; the
    smallest of all where none does, which a rule then says."""
    return next((s for s in STAGES if not faults_of(s, layout)), STAGES[0])


def faults_of(stage: Stage, layout: Layout) -> list[str]:
    """What is wrong with a stage for that array, in words."""
    wanted = present(layout.design.calibration).stage_travel
    wrong = []
    if stage.travel < wanted:
        wrong.append(f"travels {stage.travel:g} mm each way")
    if stage.travel < far(layout):
        wrong.append(f"reaches {stage.travel:g} mm each way")
    if far(layout) > most_before_post(stage):
        wrong.append(f"meets the post beyond {most_before_post(stage):g} mm")
    if min(layout.carrier_size) / 2 > most_carrier(stage):
        wrong.append("has its screws under the carrier")
    return wrong


def far(layout: Layout) -> float:
    """How far from the middle of the array a pad lies, along or across, mm."""
    return max(max(abs(x), abs(y)) for x, y in pad_middles(layout))


def most_before_post(stage: Stage) -> float:
    """How far the stage may move towards the post, mm."""
    return POST_Y - AIR - stage.size / 2


def most_carrier(stage: Stage) -> float:
    """Half width, along or across, of the largest carrier that leaves the mount's screws free, mm."""
    return stage.hole - counterbore_diameter("M4") / 2 - AIR


def most_elements(layout: Layout) -> int:
    """The longest row that a stage sold takes at this pitch, by reach and post."""
    reach = max(min(s.travel, most_before_post(s)) for s in STAGES)
    return floor(2 * reach / layout.design.array.pitch + 1e-9) + 1
