"""The variance of a reading: one law for all elements of a file, since the same sensors read them.

variance = a + b slope^2 + c (slope travel)^2 with a, b, c >= 0: the read-out's own noise, the stage's (the
same error of displacement gives more force on a stiff element), and noise that grows with the reading (a
sensor's per cent of value). One element has too few readings to distinguish noise that grows from an outlier
at its largest reading.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

from tactcad.lab.regression import fit_lines

# Squared residuals are capped at so many variances (three standard deviations), so that a bad reading is not
# taken for noise that grows. For normal noise the cap lowers the mean square by 1 %.
STRANGE = 9.0
FITS = 2  # of the lines: with equal weights, then with the law's, so that noisy readings do not tilt them
ROUNDS = 6  # fits of the law, each weighted and capped by the one before; it stops changing after five
RANGE = 100.0  # largest over smallest variance allowed within one element
MEDIAN = 0.455  # of chi-squared with one degree of freedom, over its mean


@dataclass(frozen=True)
class Readings:
    """One element's readings of force or signal; arrays, [reading]."""

    x: np.ndarray  # displacement, mm
    travel: np.ndarray  # displacement from the element's smallest one, mm
    y: np.ndarray  # force, N, or signal, V
    run: np.ndarray


def weights(elements: Sequence[Readings]) -> list[np.ndarray]:
    """1/variance of every reading (1/N2 or 1/V2), one array for each element."""
    weight = [np.ones(len(e.x)) for e in elements]
    for _ in range(FITS):
        weight = _by_law(elements, weight)
    return weight


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
        least = variance.min()
        law = least * nnls(*_normal_form(terms * (least / variance)[:, None], held))[0]
        variance = np.concatenate([_in_range(v) for v in np.split(terms @ law, ends)])
    return np.split(1 / np.maximum(variance, smallest), ends)


def _normal_form(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Square r, and c, such that |r v - c|^2 and |a v - b|^2 differ by a constant: least squares of many
    readings as one of few.

    By the eigenvalues of a^T a, since columns can be equal: with one element those of a and b are.
    """
    eigenvalue, vector = np.linalg.eigh(a.T @ a)
    root = np.sqrt(np.maximum(eigenvalue, np.finfo(float).eps * eigenvalue[-1]))
    return root[:, None] * vector.T, vector.T @ (a.T @ b) / root


def _start(square: np.ndarray) -> float:
    """First guess of an element's variance, from the median of its squared residuals; their mean where the
    median is zero."""
    return float(np.median(square)) / MEDIAN or float(square.mean())


def _in_range(variance: np.ndarray) -> np.ndarray:
    return np.maximum(variance, variance.max() / RANGE)
