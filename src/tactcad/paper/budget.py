"""Uncertainty budget: every effect on K and on K_obj with its size for this array, largest first.

Sizes are half-widths. The pair is the reference element and the measuring element whose printed K_r/K_m
is nearest to the ratio that the paper proposes, on the sample of Figure 6; K_r is the stiffness that Table 2
supports.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactcad.paper.array_model import ArrayModel
from tactcad.paper.budget_effects import BudgetPair, Effect, effects
from tactcad.paper.published import Published
from tactcad.paper.reference_stiffness import Table2Study


@dataclass(frozen=True)
class Budget:
    reference: float  # K_r, N/mm
    measuring: float
    object_stiffness: float
    sensitivity_reference: float  # dlnK_obj/dlnK_r
    sensitivity_measuring: float
    sensitivity_ratio: float
    effects: tuple[Effect, ...]  # largest on K_obj first

    def total(self, remaining: bool = False) -> float:
        """Root of the sum of squares on K_obj."""
        return sum((e.remaining if remaining else e.on_object) ** 2 for e in self.effects) ** 0.5


def budget(data: Published, array: ArrayModel, study: Table2Study) -> Budget:
    """All effects for the design and Table 2's pair."""
    K_r = study.supported.value[0]
    k = study.measuring
    K_m = float(k[np.argmin(np.abs(np.log(study.reference_printed / k / data.figure["proposed_ratio"])))])
    short, long = (array.section.rows([int(i)]) for i in (np.argmin(array.arm), np.argmax(array.arm)))
    pair = BudgetPair(K_r, K_m, data.figure["figure_6_sample"], short, long)
    return Budget(
        K_r,
        K_m,
        pair.x,
        pair.by_reference,
        pair.by_measuring,
        -pair.by_ratio,
        tuple(sorted(effects(pair, study, data, array), key=lambda e: -e.on_object)),
    )
