"""How much a reading scatters: one law for all elements of a file, since the same sensors read them.

variance = a + b slope^2 + c (slope travel)^2, none of the three below zero: the read-out's own noise, the
stage's (the same error of displacement is more force on a stiff element), and what grows with the reading (a
sensor's per cent of value). An element alone has too few readings to tell a noise that grows from an outlier
at its largest reading.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

from tactcad.lab.regression import fit_lines

# A squared residual counts up to so many times its variance (three standard deviations), so that a bad
# reading is no noise that grows; of normal noise that takes away 1 % of the squares' mean.
STRANGE = 9.0
FITS = 2  # of the lines: by equal weights, then by those found, since noisy readings turn a line off the rest
ROUNDS = 6  # fits of the law, each weighted by and held against the one before; after five nothing moves
RANGE = 100.0  # of the variances of one element
MEDIAN = 0.455  # of chi-squared with one degree of freedom, over its mean


@dataclass(frozen=True)
class Readings:
    """One element's readings of force (N) or signal (V): displacement (mm), the same from where the element
    began (mm), what was read, number of the run.
    """

    x: np.ndarray
    travel: np.ndarray
    y: np.ndarray
    run: np.ndarray


def weights(elements: Sequence[Readings]) -> list[np.ndarray]:
    """1/variance of every reading, element by element."""
    found = [np.ones(len(e.x)) for e in elements]
    for _ in range(FITS):
        found = _by_law(elements, found)
    return found


def _by_law(elements: Sequence[Readings], weight: list[np.ndarray]) -> list[np.ndarray]:
    lines = [fit_lines(e.x, e.y[:, None], e.run, w) for e, w in zip(elements, weight)]
    square = [line.residual[:, 0] ** 2 / np.maximum(1 - line.leverage, 0.1) for line in lines]
    slope = np.concatenate([np.full(len(e.x), line.slope[0]) for e, line in zip(elements, lines)])
    grown = slope * np.concatenate([e.travel for e in elements])
    terms = np.column_stack([np.ones_like(slope), slope, grown]) ** 2
    terms /= np.maximum(terms.max(0), np.finfo(float).tiny)
    ends = np.cumsum([len(e.x) for e in elements])[:-1]
    measured = np.concatenate(square)
    smallest = np.finfo(float).tiny ** 0.5
    variance = np.concatenate([np.full(len(s), _start(s)) for s in square])
    for _ in range(ROUNDS):
        variance = np.maximum(variance, smallest)
        held = np.minimum(measured / variance, STRANGE)
        q, r = np.linalg.qr(terms / variance[:, None])
        law = nnls(r, q.T @ held)[0]
        variance = np.concatenate([_in_range(v) for v in np.split(terms @ law, ends)])
    return np.split(1 / np.maximum(variance, smallest), ends)


def _start(square: np.ndarray) -> float:
    """Variance of an element's readings by the median of their squares, the mean where that is nought."""
    return float(np.median(square)) / MEDIAN or float(square.mean())


def _in_range(variance: np.ndarray) -> np.ndarray:
    return np.maximum(variance, variance.max() / RANGE)
