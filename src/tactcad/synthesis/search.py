"""The search: scipy's differential evolution over whole numbers, closed forms for many candidates at a time.

What is better: less violation of limits first, then the goal. Only a candidate that would be the best yet is
made a design and held against every rule; one that a rule refuses is as good as none.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import differential_evolution

from tactcad.checks.check import quick_failures, slow_failures
from tactcad.design.design_text import design_text
from tactcad.design.load import parse
from tactcad.design.messages import InputError
from tactcad.design.tree import Design
from tactcad.mechanics.section import Array
from tactcad.parts.rules import broken_rules

from .candidates import Candidates, Stand, realised

SEED = 20261122
POPULATION = 12  # candidates for each number
GENERATIONS = 400
WORTH = 1e-3  # relative; a gain below is not worth holding against the rules again
FAR = 1e3  # goal of a candidate that violates limits, and on

Goal = Callable[[Candidates], Array]
Refusals = Callable[[Design], set[str]]


@dataclass(frozen=True)
class Found:
    """The best candidate of a stand.

    candidate     one row
    goal          what was made least
    accepted      whether it keeps every limit and every rule
    evaluations   candidates that were looked at
    refused       by rule or field, how many candidates it refused that would have been the best yet
    """

    candidate: Candidates
    row: Array
    goal: float
    accepted: bool
    evaluations: int
    refused: dict[str, int]

    @property
    def half_width(self) -> float:
        return float(self.candidate.half_width[0])

    @cached_property
    def design(self) -> Design:
        return realised(self.candidate)


def refusals(design: Design) -> set[str]:
    """Rules that a design breaks, the field that its own file would be refused for, or quick checks that it
    fails."""
    try:
        parse(design_text(design), design.name)
    except InputError as error:
        return {error.where}
    broken = {f"rule {finding.check}" for finding in broken_rules(design)}
    return broken or {f"check {finding.check}" for finding in quick_failures(design)}


def all_refusals(design: Design) -> set[str]:
    """As `refusals`, with the checks that take a second."""
    return refusals(design) or {f"check {finding.check}" for finding in slow_failures(design)}


def search(
    stand: Stand,
    goal: Goal,
    *,
    rules: Refusals | None = refusals,
    start: Array | None = None,
    within: float = 1e-4,
    seed: int = SEED,
) -> Found:
    """The candidate of a stand with the least goal.

    Parameters
    ----------
    stand
        What is not searched.
    goal
        To be made least among candidates that keep every limit, (candidates,).
    rules
        Why a design is refused; None where the best are not held against rules and checks.
    start
        A candidate's numbers to start from.
    within
        Spread of the population's goals, relative, at which the search stops: further generations would
        change the answer by less.
    seed
        Of chance.
    """
    low, high = stand.limits
    high = np.maximum(low, high)
    best: dict = {"goal": np.inf, "row": None, "looked": 0, "refused": {}}
    tried: dict[bytes, bool] = {}

    def keeps_rules(row: Array, rules: Refusals) -> bool:
        key = np.rint(row).astype(int).tobytes()
        if key not in tried:
            why = rules(realised(stand.candidates(row[np.newaxis])))
            for name in why:
                best["refused"][name] = best["refused"].get(name, 0) + 1
            tried[key] = not why
        return tried[key]

    def value(numbers: Array) -> Array:
        rows = numbers.T if numbers.ndim == 2 else numbers[np.newaxis]
        best["looked"] += len(rows)
        c = stand.candidates(rows)
        with np.errstate(all="ignore"):
            bad, wanted = c.violation, goal(c)
            out = np.where(bad > 0.0, FAR * (1.0 + np.minimum(bad, 1e3)), wanted)
        out = np.where(np.isfinite(out), out, FAR * 1e4)
        for i in np.argsort(out):
            if out[i] >= FAR or out[i] >= best["goal"] * (1.0 - WORTH if best["row"] is not None else 1.0):
                break
            if rules and not keeps_rules(rows[i], rules):
                out[i] = FAR * 0.9
                continue
            best["goal"], best["row"] = float(out[i]), np.rint(rows[i])
            break
        return out

    got = differential_evolution(
        value,
        list(zip(low.astype(float), high.astype(float))),
        integrality=np.ones(len(low), bool),
        vectorized=True,
        updating="deferred",
        polish=False,
        popsize=POPULATION,
        maxiter=GENERATIONS,
        tol=within,
        # from nowhere "best1bin" was caught up to 24 % above the best of a small problem; from a design
        # that was best for nearly the same target it is quicker
        strategy="rand1bin" if start is None else "best1bin",
        mutation=(0.3, 0.7) if start is None else (0.4, 0.9),
        recombination=0.8,
        init="sobol",
        x0=None if start is None else np.clip(start, low, high),
        rng=np.random.default_rng(seed),
    )
    accepted = best["row"] is not None
    row = best["row"] if accepted else np.rint(got.x)
    return Found(
        stand.candidates(row[np.newaxis]), row, float(got.fun), accepted, best["looked"], best["refused"]
    )
