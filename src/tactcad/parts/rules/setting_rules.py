"""Rules on the stack in its setting fixture: pins in their steps, blanks on their strip."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations
from math import hypot, sqrt

from ..array.layout import END_PLATE_WEB, LEVER, Layout
from ..language.finding import Finding
from ..rigs.setting_fixture import SettingLayout
from .rule import at_least, rule

FIRM = 1.02 * LEVER  # chosen: the check of steps, on the solids, gives up to 1 % less
TENTH = 0.1  # mm, in which a legal place is stated


@rule(after="end_plate_takes_holes")
def setting_fixture_holds_its_pins(layout: Layout) -> Iterator[Finding]:
    """Its steps are as long as the end plates are thick, less a channel: the pins that the plates are turned
    against have END_PLATE_WEB around them, as in the plates; small pins a third of their diameter, since the
    foot under the step holds them."""
    c, step = layout.design.clamp, SettingLayout(layout.design).step_length
    web = min(END_PLATE_WEB, float(c.dowel) / 3)
    yield from at_least(
        "clamp.end_plate_thickness",
        f"leaves a step of {step:g} mm in the setting fixture, too short for its pins",
        c.end_plate_thickness,
        round(c.end_plate_thickness - step + float(c.dowel) + 2 * web, 2),
    )


@rule(after="setting_fixture_holds_its_pins")
def blanks_lie_firmly(layout: Layout) -> Iterator[Finding]:
    """A blank's front on the strip and its hole on a dowel are so far apart that it does not rock."""
    if not layout.blanks() or _firm(layout, layout.dowel_x):
        return
    offsets, e = layout.design.holes.dowel_offsets, layout.design.element
    *others, last = sorted(layout.dowel_x)
    further = (TENTH * n for n in range(int(e.rear_length / TENTH)))
    least = next((round(max(offsets) + by, 3) for by in further if _firm(layout, (*others, last + by))), None)
    shorter = "a shorter element.rear_length, or elements instead of blanks"
    yield from at_least(
        "holes.dowel_offsets",
        "a dowel so near the clamp edge lets a blank rock on the setting fixture's strip",
        max(offsets),
        e.rear_length if least is None else least,
        shorter if least is None else f"at least {least:g} mm, {shorter}",
    )


def _firm(layout: Layout, dowel_x: Sequence[float]) -> bool:
    """Firmness by the levers of height and turn, as in the check of steps: springs of one stiffness, half of
    one at each end of the strip, which supports upward only, and two at a dowel, which supports both ways."""
    front, end = SettingLayout(layout.design).strip
    middle = (front + layout.rear_end) / 2
    low, high = layout.body_bottom(layout.elements[0].hinge), layout.design.element.rear_height
    across = hypot(layout.rear_end - middle, (high - low) / 2)
    springs = [(0.5, front - middle), (0.5, end - middle), *((2.0, x - middle) for x in dowel_x)]
    apart = sum(k * q * (x - y) ** 2 for (k, x), (q, y) in combinations(springs, 2))
    turn = sqrt(apart / sum(k for k, _ in springs)) / across
    height = sqrt(apart / sum(k * x * x for k, x in springs))
    return min(turn, height) >= FIRM
