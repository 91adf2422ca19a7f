"""A requirement: what must hold for an array's parts to make a sensor, and its value in an array."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .mechanic import Assembled
from .variables import Array

# Least interference of a pressed pin, mm; chosen: what a plug gauge tells from none.
LEAST_PRESS = 0.002

Value = Callable[[Assembled], Array]


@dataclass(frozen=True)
class Requirement:
    """A requirement on every array.

    name          what must hold
    unit          of value and limits
    lower, upper  limits, -inf or inf where there is none
    value         (arrays, instances) of arrays that were put together
    linear        where the value is a sum of deviations: the nominal value, and each variable's coefficient;
                  such a value does not depend on the array's contacts
    fields        of the design, to look at where it is missed
    """

    name: str
    unit: str
    lower: float
    upper: float
    value: Value
    linear: tuple[float, tuple[tuple[str, float], ...]] | None = None
    fields: tuple[str, ...] = ()

    def margin(self, value: Array) -> Array:
        """How far inside its limits a value is, in its unit; negative outside."""
        return np.minimum(value - self.lower, self.upper - value)


def summed(
    name: str, lower: float, upper: float, nominal: float, terms: tuple[tuple[str, float], ...]
) -> Requirement:
    """A requirement on a sum of deviations of all pieces, mm."""

    def value(a: Assembled) -> Array:
        return nominal + sum((c * a.made[v].sum(axis=1, keepdims=True) for v, c in terms), np.zeros((1, 1)))

    return Requirement(name, "mm", lower, upper, value, (nominal, terms))
