"""Typed keys of a part's variables: its coordinates and sizes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum


class Quantity(StrEnum):
    """What a variable measures, mm."""

    X = "x"
    Y = "y"
    Z = "z"
    DIAMETER = "d"
    DEPTH = "depth"
    WIDE = "wide"  # diameter of a counterbore
    DEEP = "deep"  # its depth
    THREAD = "thread"  # depth of full thread
    THICKNESS = "thickness"


PLACES = (Quantity.X, Quantity.Y, Quantity.Z)


@dataclass(frozen=True)
class Owner:
    """A contour or hole that variables belong to: which of its kind, and which island of a pocket."""

    kind: str
    number: int | None = None
    island: int | None = None

    def __str__(self) -> str:
        return self.kind + ".".join(str(n) for n in (self.number, self.island) if n is not None)

    def place(self, k: int) -> Variable:
        """Coordinate k (0, 1, 2) of a hole or a circle."""
        return Variable(self, PLACES[k])

    def size(self, quantity: Quantity) -> Variable:
        return Variable(self, quantity)


@dataclass(frozen=True)
class Spot:
    """A point of a contour: where a segment starts, or the centre of its arc."""

    contour: Owner
    segment: int
    centre: bool = False

    def place(self, k: int) -> Variable:
        """Coordinate k (0 or 1)."""
        return Variable(self, PLACES[k])


@dataclass(frozen=True)
class Variable:
    """One number that the part is described by."""

    of: Owner | Spot
    quantity: Quantity

    def __str__(self) -> str:
        """As in "outer.3.cx"; variables are sorted by this text."""
        if isinstance(self.of, Spot):
            return f"{self.of.contour}.{self.of.segment}.{'c' if self.of.centre else ''}{self.quantity}"
        return f"{self.of}.{self.quantity}".removeprefix(".")

    @property
    def contour(self) -> Owner:
        """What it belongs to in the end."""
        return self.of.contour if isinstance(self.of, Spot) else self.of


WHOLE, OUTER = Owner(""), Owner("outer")
THICKNESS = WHOLE.size(Quantity.THICKNESS)
Values = Mapping[Variable, float]
