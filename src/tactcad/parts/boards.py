"""Which element is read by which board: a multiplexer and an amplifier stand on each, and the elements of one
row only, so that a row's leads stay together.
"""

from __future__ import annotations

from dataclasses import dataclass

from tactcad.design.electronics import MULTIPLEXERS

from .layout import ElementPlace, Layout


@dataclass(frozen=True)
class ReadBoard:
    """A board by its number from 1, and its elements in the order of the multiplexer's channels."""

    number: int
    places: tuple[ElementPlace, ...]


def boards(layout: Layout) -> tuple[ReadBoard, ...]:
    """Every board of the array."""
    channels = MULTIPLEXERS[layout.design.readout.multiplexer].channels
    taken = []
    for row in (1, 2):
        own = [p for p in layout.elements if p.row == row]
        taken += [tuple(own[i : i + channels]) for i in range(0, len(own), channels)]
    return tuple(ReadBoard(number, places) for number, places in enumerate(taken, start=1))
