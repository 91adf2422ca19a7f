"""How cost grows with size: cost = a size^p, by least squares of the logarithms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import log, sqrt

import numpy as np
from scipy.special import stdtrit


@dataclass(frozen=True)
class Exponent:
    """p with its 95 % interval (infinite with two points), and p between the two largest sizes alone."""

    value: float
    low: float
    high: float
    last: float


def fit(sizes: Sequence[float], costs: Sequence[float]) -> Exponent:
    """Slope of log cost over log size, with Student's interval. Raises ValueError below two sizes.

    A fixed cost hides growth at small sizes: `last` is the slope between the two largest ones.
    """
    x, y = np.log(np.asarray(sizes, dtype=float)), np.log(np.asarray(costs, dtype=float))
    if len(np.unique(x)) < 2:
        raise ValueError("an exponent needs two sizes")
    dx = x - x.mean()
    slope = float(dx @ y / (dx @ dx))
    free = len(x) - 2
    half = np.inf
    if free > 0:
        residual = y - y.mean() - slope * dx
        half = float(stdtrit(free, 0.975) * sqrt(residual @ residual / free / (dx @ dx)))
    order = np.argsort(x)[-2:]
    last = float(y[order[1]] - y[order[0]]) / log(sizes[order[1]] / sizes[order[0]])
    return Exponent(slope, slope - half, slope + half, last)
