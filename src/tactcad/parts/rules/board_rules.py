"""Rules on the places of the read-out boards."""

from __future__ import annotations

from collections.abc import Iterator

from ..array.layout import Layout
from ..array.leads import least_to_board
from ..language.finding import Finding
from .rule import at_least, rule


@rule(after="stop_land_above_arm")
def boards_stand_clear(layout: Layout) -> Iterator[Finding]:
    """Their plates clear the array, with the leads' tie between."""
    what = "a board's plate would overlap the array"
    yield from at_least("wiring.to_board", what, layout.design.wiring.to_board, least_to_board(layout))
