"""Rules on the places of the read-out boards, and on leads that reach them."""

from __future__ import annotations

from collections.abc import Iterator

from ..array.layout import Layout
from ..array.leads import Bench, least_to_board
from ..language.finding import Finding
from ..rigs.stand import calibration_bench, grasping_bench
from .rule import at_least, fits, rule


@rule(after="stop_land_above_arm")
def boards_stand_clear(layout: Layout) -> Iterator[Finding]:
    """Their plates clear the array, with the leads' tie between."""
    what = "a board's plate would overlap the array"
    yield from at_least("wiring.to_board", what, layout.design.wiring.to_board, least_to_board(layout))


@fits
def leads_reach_from_stages(layout: Layout) -> Iterator[Finding]:
    yield from _reach(layout, calibration_bench(layout))


@fits
def leads_reach_from_guide(layout: Layout) -> Iterator[Finding]:
    yield from _reach(layout, grasping_bench(layout))


def _reach(layout: Layout, bench: Bench) -> Iterator[Finding]:
    what = "leads do not reach a board beside the base plate, however high it lies"
    yield from at_least("wiring.to_board", what, layout.design.wiring.to_board, bench.least)
