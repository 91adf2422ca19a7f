"""Dimensions for information, in parentheses, whose values are given: those of assemblies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from .boxes import Box, Point
from .dimension_lines import stacked
from .ink import Item
from .keys import WHOLE, Spot
from .measures import size
from .sheet_plan import Dimension, Linear, Side


@dataclass(frozen=True)
class Given:
    """A value (mm) on a side of a view, between two points of the view (mm of the assembly)."""

    side: Side
    value: float
    p: Point
    q: Point


def for_information(given: Sequence[Given], box: Box, f: float) -> list[Item]:
    """Their lines and texts around a view of that box (mm of paper), at the scale f."""
    variables = [Spot(WHOLE, n).place(0) for n in range(len(given))]
    values = {variable: g.value for variable, g in zip(variables, given)}
    lines = [
        Linear(Dimension(f"given {n}", (size(variable),), auxiliary=True), g.side, g.p, g.q)
        for n, (variable, g) in enumerate(zip(variables, given))
    ]
    sides: tuple[Side, ...] = ("top", "bottom", "left", "right")
    return [item for side in sides for item in stacked(lines, side, box, f, values, 10.0)]
