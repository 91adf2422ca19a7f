"""Uncertainty budget: every effect on K and on K_obj with its size for this array, largest first.

Sizes are half-widths. The pair is the reference element and the measuring element whose printed K_r/K_m
is nearest to the ratio that the paper proposes, on the sample of Figure 6; K_r is the stiffness that Table 2
supports.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log, nan

import numpy as np

from tactcad.mechanics import lumped
from tactcad.paper.array_model import ArrayModel
from tactcad.paper.budget_effect import BudgetPair, Effect
from tactcad.paper.budget_element import element
from tactcad.paper.budget_rig import rig, stage_error
from tactcad.paper.budget_signal import signal
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
    effects = [
        _reference(pair, study, data, array),
        *element(pair, array),
        *rig(pair, data, array),
        *signal(pair, data, array),
    ]
    return Budget(
        K_r,
        K_m,
        pair.x,
        pair.by_reference,
        pair.by_measuring,
        -pair.by_ratio,
        tuple(sorted(effects, key=lambda e: -e.on_object)),
    )


def _reference(pair: BudgetPair, study: Table2Study, data: Published, array: ArrayModel) -> Effect:
    size = abs(log(study.reference_printed / pair.K_r))
    R = float(lumped.deflection_ratio(pair.K_r, pair.K_m, pair.x))
    off = abs(float(lumped.object_stiffness(study.reference_printed, pair.K_m, R)) / pair.x - 1)
    half = log(study.supported.high[0] / pair.K_r)
    stage = stage_error(data, array)
    return Effect(
        "reference stiffness, printed against supported",
        f"equation (3) with either; the supported one's own interval is ±{half:.0%} of K_r",
        size,
        nan,
        off,
        "calibrate the reference element again",
        abs(pair.by_reference) * stage,
    )
