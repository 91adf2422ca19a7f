"""Requirements on parts that make a sensor, and the dimensions that they depend on.

numpy is loaded only for limits and values: listing a design's scenes does not need it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, Protocol

if TYPE_CHECKING:
    from tactcad.mechanics.section import Array

Deviations = dict[str, "Array"]  # by variable: (arrays built, pieces) deviations from nominal
Matters = Literal["pads", "plate", "neither", "joint"]
# Least interference of a pressed pin, mm; chosen: the least that a plug gauge shows.
LEAST_PRESS = 0.002
SHEET = "sheet: thickness"  # the variable of the one sheet that all elements are cut from


def of_element(limit: str) -> str:
    """The variable of an element's limit, by the limit's name."""
    return f"element: {limit}"


@dataclass(frozen=True)
class DimensionLimits:
    """One dimension of all pieces of a kind: a variable of virtual builds.

    name          part and dimension, as stack and findings call it
    lower, upper  deviations from nominal, of shape (pieces,); mm unless the name says otherwise
    stated        its part number and limit; empty for elements, or if general
    apart         of no array: drawn separately, so that an array is the same with and without it
    element       its limit on an element; empty for another part
    matters       to the pads on the surface plate and all that rests on them, to the stop plate on the
                  ledges, to neither, or to a screwed joint alone
    wire          its growth by the wire's offset on every face of its piece, mm a mm
    """

    name: str
    lower: Array
    upper: Array
    stated: tuple[tuple[str, str], ...] = ()
    apart: bool = False
    element: str = ""
    matters: Matters = "neither"
    wire: int = 0

    @property
    def pieces(self) -> int:
        return len(self.lower)


def variable(
    name: str,
    lower: float,
    upper: float,
    pieces: int = 1,
    stated: tuple[tuple[str, str], ...] = (),
    matters: Matters = "neither",
) -> DimensionLimits:
    """A variable with the same limits for all its pieces."""
    import numpy as np

    return DimensionLimits(name, np.full(pieces, lower), np.full(pieces, upper), stated, matters=matters)


class Built(Protocol):
    """Arrays whose parts were made."""

    @property
    def made(self) -> Deviations: ...


@dataclass(frozen=True)
class Requirement:
    """A requirement on every array.

    name          what must hold
    unit          of value and limits
    lower, upper  limits, -inf or inf if there is none
    value         (arrays, instances) of arrays that were put together
    linear        where the value is a sum of deviations: the nominal value, and each variable's coefficient;
                  such a value does not depend on the array's contacts
    fields        of the design, to look at where it is missed
    """

    name: str
    unit: str
    lower: float
    upper: float
    value: Callable[..., Array]
    linear: tuple[float, tuple[tuple[str, float], ...]] | None = None
    fields: tuple[str, ...] = ()

    def margin(self, value: Array) -> Array:
        """Distance of a value inside its limits, in its unit; negative outside."""
        import numpy as np

        return np.minimum(value - self.lower, self.upper - value)


def summed(
    name: str, lower: float, upper: float, nominal: float, terms: tuple[tuple[str, float], ...]
) -> Requirement:
    """A requirement on a sum of deviations of all pieces, mm."""

    def value(a: Built) -> Array:
        return nominal + sum(c * a.made[v].sum(axis=1, keepdims=True) for v, c in terms)

    return Requirement(name, "mm", lower, upper, value, (nominal, terms))
