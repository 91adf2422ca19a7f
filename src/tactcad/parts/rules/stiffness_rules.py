"""Rules on the rigs' parts that are taken as rigid, by the lines of `tactcad check` (checks/rigidity.py).

The array needs none: `stop_plate_stays` and `stop_gap_above_tolerance` refuse its deflections first.
"""

from __future__ import annotations

from collections.abc import Iterator

from ..finding import Finding
from ..layout import Layout
from ..stiffness_remedy import remedy
from ..stiffness_table import deflections
from .rule import fits, wrong


@fits("calibration")
def calibration_stays_straight(layout: Layout) -> Iterator[Finding]:
    yield from _too_much(layout, "calibration")


@fits("sample-stiffness")
def sample_stand_stays_straight(layout: Layout) -> Iterator[Finding]:
    yield from _too_much(layout, "sample-stiffness")


@fits("grasping")
def guide_stays_straight(layout: Layout) -> Iterator[Finding]:
    yield from _too_much(layout, "grasping")


@fits("bonding")
def tongue_stays_straight(layout: Layout) -> Iterator[Finding]:
    yield from _too_much(layout, "bonding")


def _too_much(layout: Layout, scene: str) -> Iterator[Finding]:
    """What is only flagged there refuses nothing."""
    for line in deflections(layout.design, [scene]):
        if line.too_much and line.severity == "fail":
            path, value, legal = remedy(layout.design, line)
            yield wrong(path, str(line), value, legal)
