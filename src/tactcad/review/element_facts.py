"""What the estimator and the virtual builds say of every element, and of the pairs that they form."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from math import sqrt
from typing import Any

from tactcad.assembly.stack import SEED, StackLine
from tactcad.assembly.virtual_build import Builds, Sensor, sensor
from tactcad.design.messages import CheckFailure
from tactcad.design.tree import Design
from tactcad.lab.array_estimate import ElementEstimate, estimate
from tactcad.mechanics.ladder import DEFAULT_RUNG
from tactcad.mechanics.lumped import condition_in_ratio
from tactcad.parts.layout import Layout
from tactcad.scenes.scene import Scene

BUILT = 1000  # arrays of each distribution, as `tactcad build` and the stack's page have


@dataclass(frozen=True)
class PairFact:
    """An element that measures with the reference, the stiffest of the array: stiffness in N/mm.

    ratio       K_r/K_m
    best_for    N/mm: the object whose stiffness the pair finds best, sqrt(K_r K_m)
    condition   there, the relative error of K_obj per relative error of the deflections' ratio
    """

    measuring: str
    reference: str
    K_m: float
    K_r: float
    ratio: float
    best_for: float
    condition: float


@dataclass(frozen=True)
class FitFacts:
    """Arrays built virtually: how many of each distribution, the share that meets every requirement, and by
    distribution the arrays that miss one."""

    count: int
    seed: int
    kept: dict[str, float]
    failures: dict[str, dict[str, int]]


@dataclass(frozen=True)
class ElementFacts:
    """All elements, by designator: the estimate's fields and those of the virtual builds; their pairs.

    `why_not` says why there is no estimate, "" where there is one.
    """

    rung: str
    elements: dict[str, dict[str, Any]]
    pairs: tuple[PairFact, ...]
    why_not: str
    fit: FitFacts


def element_facts(design: Design, scenes: tuple[Scene, ...]) -> tuple[ElementFacts, Sensor, list[StackLine]]:
    """The facts, and the sensor with its stack from which those of the parts are read."""
    made = sensor(design, scenes)
    return _facts(design, made.built(BUILT)), made, made.stack()


def estimate_facts(design: Design) -> ElementFacts:
    """The facts without virtual builds: of no array."""
    return _facts(design, Builds(0, SEED, {}, {}, ()))


def _facts(design: Design, builds: Builds) -> ElementFacts:
    layout, why_not = Layout(design), ""
    rows: list[ElementEstimate] = []
    gentle: list[ElementEstimate] = []
    try:
        rows = estimate(layout, DEFAULT_RUNG)
        # no strain is given above yield: what all elements are rated for is below it
        gentle = estimate(layout, DEFAULT_RUNG, min(row.rated_force for row in rows))
    except CheckFailure as error:
        why_not = str(error)
    built = {e.number: e for e in builds.elements}
    elements = {}
    for n, place in enumerate(layout.elements):
        row, low = (rows[n], gentle[n]) if gentle else (None, None)
        elements[place.designator] = {
            "row": place.row,
            "estimate": asdict(row) if row else None,
            "gauge_per_newton": _per_newton(low.gauge_strain, low) if low else None,
            "fillet_per_newton": _per_newton(low.peak_strain, low) if low else None,
            "built": built[place.number].known() if place.number in built else None,
        }
    return ElementFacts(DEFAULT_RUNG, elements, tuple(_pairs(rows)), why_not, _fit(builds))


def _per_newton(strain: float | None, row: ElementEstimate) -> float | None:
    return None if strain is None else strain / row.force


def _pairs(rows: list[ElementEstimate]) -> list[PairFact]:
    """Each element that is softer than the stiffest, with it: one as stiff finds no object."""
    if not rows:
        return []
    reference = max(rows, key=lambda r: (r.stiffness, -r.number))
    return [_pair(row, reference) for row in rows if row.stiffness < reference.stiffness]


def _pair(m: ElementEstimate, r: ElementEstimate) -> PairFact:
    best = sqrt(r.stiffness * m.stiffness)
    condition = abs(float(condition_in_ratio(r.stiffness, m.stiffness, best)))
    return PairFact(
        f"E{m.number}", f"E{r.number}", m.stiffness, r.stiffness, r.stiffness / m.stiffness, best, condition
    )


def _fit(builds: Builds) -> FitFacts:
    return FitFacts(builds.count, builds.seed, builds.kept, builds.failures)
