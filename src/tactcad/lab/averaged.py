"""What the paper reads off an element's runs once they are averaged: slopes, extremes, linearity.

Its regression over d = X - F/K_c puts the force's noise on both axes; the estimate is given beside the one
of `calibration`.
"""

from __future__ import annotations

from math import inf

import numpy as np

from tactcad.lab.regression import fit_lines, steps, t_quantile
from tactcad.lab.series_spring import Estimate


def over_runs(x: np.ndarray, y: np.ndarray, run: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean over the runs at each displacement (equal within 1e-9 mm) that every run has; all readings as they
    are where fewer than three displacements are shared."""
    step, index = np.unique(steps(x), return_inverse=True)
    count = np.bincount(index)
    shared = count == len(np.unique(run))
    if shared.sum() < 3:
        return x, y
    mean = np.column_stack([np.bincount(index, column) / count for column in y.T])
    return step[shared], mean[shared]


def as_paper(
    x: np.ndarray, y: np.ndarray, load_cell: float, level: float, notes: list[str]
) -> tuple[Estimate, Estimate]:
    """K and K_v as the paper took them: slopes of the averaged force and signal over d = X - F/K_c, each with
    its t interval."""
    d = x - y[:, 0] / load_cell
    lines = fit_lines(d, y, np.zeros(len(d), int))
    t = t_quantile(level, lines.dof)
    se = np.sqrt(np.diag(lines.covariance))
    if len(x) == len(np.unique(x)) and lines.dof < 3:
        notes.append(f"as the paper did it leaves {lines.dof} degrees of freedom")
    first, second = (
        Estimate(float(b), float(b - t * s), float(b + t * s), float(s)) for b, s in zip(lines.slope, se)
    )
    return first, second


def extremes(x: np.ndarray, y: np.ndarray, load_cell: float) -> tuple[float, float, float]:
    """Largest deflection (mm), force (N) and change of signal (V) of the averaged readings."""
    deflection = x - y[:, 0] / load_cell
    return float(deflection.max()), float(y[:, 0].max()), float(np.ptp(y[:, 1]))


def linearity(x: np.ndarray, y: np.ndarray) -> tuple[float, float]:
    """Largest deviation from the least-squares line over the full scale of the averaged readings."""
    lines = fit_lines(x, y, np.zeros(len(x), int))
    scale = np.ptp(y, axis=0)
    force, signal = np.where(scale > 0, np.abs(lines.residual).max(0) / np.where(scale > 0, scale, 1), inf)
    return float(force), float(signal)
