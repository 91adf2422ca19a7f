"""Rules on where the read-out boards stand."""

from __future__ import annotations

from collections.abc import Iterator

from ..array.layout import Layout
from ..array.leads import least_to_board
from ..language.finding import Finding
from .rule import at_least, rule


@rule(after="stop_land_above_arm")
def boards_stand_clear(layout: Layout) -> Iterator[Finding]:
    """Their plates beside the array, with the leads' tie between."""
    what = "a board's plate would stand in the array"
    yield from at_least("wiring.to_board", what, layout.design.wiring.to_board, least_to_board(layout))
