"""How much there is to do for a target, counted before anything is searched: at most so much."""

from __future__ import annotations

from math import ceil, log2

from . import relax
from .candidates import Stand
from .search import GENERATIONS, POPULATION
from .synthesise import NEAR_SEEDS, RATIOS, tries
from .target import Target

ALTERNATIVES = 9  # searches for the report's front, about


def work_ahead(target: Target, report: bool) -> dict[str, float]:
    """Counts of what `design` does at most.

    Parameters
    ----------
    target
        What is asked for.
    report
        With what the report tells beside the design: limits, alternatives, ratios.

    Returns
    -------
    dict
        candidate: looked at by the search; near: searches beside the answer; yield: how often arrays are
        made; element: of the largest array.
    """
    some = tries(target)
    asked_too = 2 if target.target.half_width is None else 1  # what arrays keep, then how many keep it
    near = len(list(relax.eased(target))) + ALTERNATIVES + len(RATIOS)
    return {
        "candidate": sum(_candidates(stand) for _, stands in some for stand in stands),
        "near": float(near * len(NEAR_SEEDS) * report),
        "yield": float(asked_too * len(some)),
        "element": float(target.room.elements[1]),
    }


def _candidates(stand: Stand) -> float:
    """scipy's population by Sobol is the next power of two; all generations of it, and its first."""
    numbers = len(stand.limits[0])
    return float(2 ** ceil(log2(POPULATION * numbers)) * (GENERATIONS + 1))
