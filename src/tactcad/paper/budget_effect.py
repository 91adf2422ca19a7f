"""One effect of the uncertainty budget, and how errors of stiffness and signal reach K_obj through a pair."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tactcad.mechanics import ladder, lumped
from tactcad.mechanics.section import HingeSection

Stiffness = Callable[[HingeSection], np.ndarray]


@dataclass(frozen=True)
class Effect:
    """One effect. Sizes are relative half-widths; NaN where it does not act on K. A `common` one is the same
    in all elements.
    """

    name: str
    how: str
    short_arm: float  # on K of the shortest arm
    long_arm: float
    on_object: float  # on K_obj of the pair
    remedy: str
    remaining: float  # on K_obj with the remedy


@dataclass(frozen=True)
class BudgetPair:
    """The pair and how errors reach K_obj through it."""

    K_r: float
    K_m: float
    x: float
    short: HingeSection  # the reference arm's section
    long: HingeSection  # the measuring arm's

    @property
    def by_reference(self) -> float:
        return float(lumped.condition_in_reference(self.K_r, self.K_m, self.x))

    @property
    def by_measuring(self) -> float:
        return float(lumped.condition_in_measuring(self.K_r, self.K_m, self.x))

    @property
    def by_ratio(self) -> float:
        return abs(float(lumped.condition_in_ratio(self.K_r, self.K_m, self.x)))

    def apart(self, short: float, long: float) -> float:
        """Half-width of K_obj for half-widths of K that are independent in the two elements."""
        return ((self.by_reference * short) ** 2 + (self.by_measuring * long) ** 2) ** 0.5

    def together(self, short: float, long: float) -> float:
        """Half-width of K_obj for half-widths of K that both elements share."""
        return abs(self.by_reference * short + self.by_measuring * long)

    def log_change(self, new: Stiffness, old: Stiffness) -> tuple[float, float]:
        """ln of new over old stiffness, of both arms."""
        short, long = (float(np.log(new(s) / old(s)).item()) for s in (self.short, self.long))
        return short, long

    def change(self, name: str, half: float) -> tuple[float, float]:
        """Half-width of ln K of both arms for a half-width (mm) of one dimension."""
        changes = []
        for s in (self.short, self.long):
            own = getattr(s, name)
            both = [ladder.stiffness(s.with_(**{name: own + sign * half})) for sign in (-1, 1)]
            changes.append(float(abs(np.log(both[0] / both[1])).item()) / 2)
        return changes[0], changes[1]
