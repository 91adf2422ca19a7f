"""Which readings are surely in contact.

Where within the first step the pad began to touch is not known. A gap of a few micrometres biases a slope by
per cents if that step's reading is kept, and a statistical test misses gaps about as large as the noise, so
that intervals would hold less often than their level says. Hence the first displacement is always left out.
A gap beyond the first step is large, and a test detects it.
"""

from __future__ import annotations

from math import ceil

import numpy as np
from scipy.special import stdtr

from tactcad.lab.regression import fit_lines, spare_steps, steps

BEFORE = 0.001  # probability that a test leaves out a step that was in contact
IN_CONTACT = 0.6  # share of the steps, the largest ones, that are assumed to be in contact
FEWEST = 4  # displacements at which the first can be left out
# A ramp read at more displacements is grouped into so many steps: each step tested costs a fit of all
# readings and can raise a false alarm. With IN_CONTACT, 16 of 40 are tested: 1.6 % in all.
MOST = 40


def first_in_contact(x: np.ndarray, force: np.ndarray, run: np.ndarray) -> tuple[float, int]:
    """The smallest displacement at which the readings are surely in contact.

    Before contact the force lies above the line of the later readings, extended to smaller displacements.
    Going down from the largest displacements, the first step whose readings lie above that line in any run
    (one-sided t test) is left out with all before it. At least three steps and 60 % of them are kept; of
    three displacements none is left out.

    Parameters
    ----------
    x, force, run : arrays, [reading]
        Displacement of the stage (mm), force (N), number of the run.

    Returns
    -------
    first : float
        mm; the second displacement unless the test leaves out more.
    left_out : int
        Number of steps before it.
    """
    step, index = np.unique(steps(x), return_inverse=True)
    if len(step) > MOST:
        group = np.arange(len(step)) * MOST // len(step)
        step, index = step[np.searchsorted(group, np.arange(MOST))], group[index]
    run = np.unique(run, return_inverse=True)[1]
    start = len(step) - max(ceil(IN_CONTACT * len(step)), 3)
    for i in range(start - 1, 0, -1):
        beyond = index > i
        if not _on_line(x, force, run, beyond, index == i):
            return float(step[i + 1]), i + 1
    return (float(step[1]), 1) if len(step) >= FEWEST else (float(step[0]), 0)


def _on_line(x: np.ndarray, force: np.ndarray, run: np.ndarray, beyond: np.ndarray, at: np.ndarray) -> bool:
    """Whether the readings `at` one step lie on or below the line through those `beyond` it in every run.

    `at` and `beyond` mark readings (True or False each); runs are numbered from 0.
    """
    at_step, later = (np.bincount(run[rows], minlength=run.max() + 1) for rows in (at, beyond))
    both = (at_step > 0) & (later > 0)
    if not both.any() or spare_steps(x[beyond], run[beyond]) < 1:
        return True
    lines = fit_lines(x[beyond], force[beyond, None], run[beyond])
    noise = float((lines.residual[:, 0] ** 2).sum()) / lines.dof  # variance of one reading about the lines

    def apart(v: np.ndarray) -> np.ndarray:
        """Mean at the step less that beyond it, by run."""
        sums = [np.bincount(run[rows], v[rows], len(both))[both] for rows in (at, beyond)]
        return sums[0] / at_step[both] - sums[1] / later[both]

    away = apart(x)
    excess = apart(force) - lines.slope[0] * away
    spread = (noise * (1 / at_step[both] + 1 / later[both]) + lines.covariance[0, 0] * away**2) ** 0.5
    above = excess > 1e-12 * np.abs(force).max()  # readings without noise differ from the line by rounding
    chance = stdtr(lines.dof, -excess / np.maximum(spread, 1e-300))
    return not (above & (chance < BEFORE / both.sum())).any()
