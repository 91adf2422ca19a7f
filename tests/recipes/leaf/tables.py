"""[leaf] of a design file, and where the leaf stands."""

from __future__ import annotations

from dataclasses import dataclass

from tactcad.design.fields import Number, given
from tactcad.design.tree import CommonTables, Rating, Sheet


@dataclass(frozen=True)
class Leaf:
    """[leaf]: the strip and the block under its end."""

    length: float = given(Number("mm", 1, 200, "free length, block's edge to the force"))
    width: float = given(Number("mm", 1, 50, "across"))
    held: float = given(Number("mm", 2, 50, "length on the block"), 10.0)


@dataclass(frozen=True)
class LeafDesign(CommonTables):
    """A whole design file of a leaf."""

    sheet: Sheet
    leaf: Leaf
    rating: Rating = Rating()


@dataclass(frozen=True)
class LeafPlace:
    """The one leaf, numbered as elements of arrays are."""

    arm: float
    number: int = 1
    row: int = 1
    designator: str = "E1"


@dataclass(frozen=True)
class LeafLayout:
    """x along the leaf from the block's edge, z up from the block."""

    design: LeafDesign

    @property
    def elements(self) -> tuple[LeafPlace, ...]:
        return (LeafPlace(self.design.leaf.length),)
