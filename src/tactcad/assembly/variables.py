"""Every dimension of an array that may differ from its drawing, with the limits that the parts state."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tactcad.design.present import present
from tactcad.parts.blank import blank
from tactcad.parts.description import Part
from tactcad.parts.element import element
from tactcad.parts.end_plate import end_plate
from tactcad.parts.fasteners import STACK
from tactcad.parts.layout import Layout
from tactcad.parts.library.dowels import dowel_limits
from tactcad.parts.spacer import spacer
from tactcad.parts.stop_plate import stop_plate

# The stack's length once its spacers are chosen to the measured sheet.
STACK_LENGTH = "stack: length, spacers to suit"
Array = NDArray[np.float64]
Deviations = dict[str, Array]  # by variable: (arrays built, pieces) deviations from nominal


@dataclass(frozen=True)
class DimensionLimits:
    """One dimension of all pieces of a kind.

    name          part and dimension, as stack and findings call it
    lower, upper  deviations from nominal, of shape (pieces,); mm unless the name says otherwise
    """

    name: str
    lower: Array
    upper: Array

    @property
    def pieces(self) -> int:
        return len(self.lower)


def variable(name: str, lower: float, upper: float, pieces: int = 1) -> DimensionLimits:
    """A variable with the same limits for all its pieces."""
    return DimensionLimits(name, np.full(pieces, lower), np.full(pieces, upper))


def array_variables(layout: Layout) -> dict[str, DimensionLimits]:
    """Variables of the array by name; what is cut from one sheet has one thickness, a single piece."""
    return {v.name: v for v in _array(layout)}


def _array(layout: Layout) -> Iterable[DimensionLimits]:
    d, places = layout.design, layout.elements
    kinds: dict[tuple, dict[str, tuple[float, float]]] = {}
    for p in places:  # a long row has few kinds of element
        if (p.arm, p.hinge) not in kinds:
            own_limits = element(layout, p).characteristics
            kinds[p.arm, p.hinge] = {c.name: (c.lower - c.nominal, c.upper - c.nominal) for c in own_limits}
    limits = [kinds[p.arm, p.hinge] for p in places]
    for name in dict.fromkeys(name for each in kinds.values() for name in each):
        own = [each.get(name, (0.0, 0.0)) for each in limits]
        if name == "sheet thickness":
            yield variable("sheet: thickness", *own[0])
        else:
            yield DimensionLimits(
                f"element: {name}", np.array([low for low, _ in own]), np.array([up for _, up in own])
            )
    yield variable("element: place in its dowel's play, share", -1.0, 1.0, len(places))
    modulus = present(d.tolerance.youngs_modulus)
    yield variable("sheet: Young's modulus, relative", -modulus, modulus)
    if layout.blanks():
        half = next(g.zone for g in blank(layout).geometric if g.name == "ledge") / 2
        yield variable("blank: ledge over the dowel hole", -half, half, len(layout.blanks()))
    yield _characteristic("spacer", spacer(layout), "thickness")
    yield variable(STACK_LENGTH, -STACK, STACK)
    pins = 2 * len(layout.dowel_x)
    low, high = dowel_limits(d.clamp.dowel)
    yield variable("dowel pin: diameter", low - float(d.clamp.dowel), high - float(d.clamp.dowel), pins)
    for which, head in (("tapped", False), ("head", True)):
        part, name = end_plate(layout, head), f"end plate, {which}"
        zones = {g.name: g.zone / 2 for g in part.geometric}
        if not head:  # the pair is made together: what it shares lies in one zone, its difference in another
            for axis in "xz":
                yield _zone(f"end plates: dowel holes along {axis}", zones["dowel holes"], pins)
                yield _zone(
                    f"{name}: dowel holes' squareness along {axis}", zones["dowel holes' squareness"], pins
                )
        for axis in "xz":
            yield _zone(
                f"{name}: dowel holes against the pair's along {axis}", zones["dowel holes of the pair"], pins
            )
        bore = next(c for c in part.characteristics if c.name == "dowel hole diameter")
        size = float(d.clamp.dowel)  # pin and hole are both counted from it
        yield variable(f"{name}: dowel hole diameter", bore.lower - size, bore.upper - size, pins)
    flat = {g.name: g.zone for g in stop_plate(layout).geometric}["flatness"]
    yield variable("stop plate: flatness", 0.0, flat, len(places))
    yield _characteristic("stop plate", stop_plate(layout), "thickness")


def _zone(name: str, half: float, pieces: int) -> DimensionLimits:
    return variable(name, -half, half, pieces)


def _characteristic(who: str, part: Part, name: str, pieces: int = 1) -> DimensionLimits:
    c = next(c for c in part.characteristics if c.name == name)
    return variable(f"{who}: {name}", c.lower - c.nominal, c.upper - c.nominal, pieces)
