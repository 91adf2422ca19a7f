"""Which readings are surely in contact: where within a step the pad began to touch nobody knows.

The slopes are taken from the second displacement on. A gap of a few micrometres at the start is within one
step, biases a slope by per cents when its reading is kept, and a test that would find it misses it just where
it is about as large as the noise: intervals then hold too seldom. A gap beyond the first step is large, and a
test finds it.
"""

from __future__ import annotations

from math import ceil

import numpy as np
from scipy.special import stdtr

from tactcad.lab.regression import fit_lines, spare_steps, steps

BEFORE = 0.001  # chance of leaving out a further step that was in contact
IN_CONTACT = 0.6  # share of the steps, the largest ones, that are taken to be in contact
FEWEST = 4  # displacements from which on the first can be spared


# Of a ramp that was read at more displacements, neighbours count as one step: each step tried costs a fit of
# all readings and has its chance of a false alarm, together IN_CONTACT leaves 16 of them, 1.6 %.
MOST = 40


def first_in_contact(x: np.ndarray, force: np.ndarray, run: np.ndarray) -> tuple[float, int]:
    """The smallest displacement from which on the readings lie on one line.

    Parameters
    ----------
    x, force, run : arrays, [reading]
        Displacement of the stage (mm), force (N), number of the run.

    Returns
    -------
    first : float
        mm: the second displacement, or a further one. Before contact the force is above the line, carried on
        to there: from the largest displacements down, a step is left out, with all before it, where its
        readings lie above the line of those beyond it in any run (one-sided t test). At least three steps,
        and 60 % of them, stay; of three displacements none is left out.
    left_out : int
        How many steps lie before it.
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
    """Whether the readings `at` one step lie on, or below, the line through those `beyond` it, in every
    run; runs are numbered from 0."""
    here, known = (np.bincount(run[rows], minlength=run.max() + 1) for rows in (at, beyond))
    both = (here > 0) & (known > 0)
    if not both.any() or spare_steps(x[beyond], run[beyond]) < 1:
        return True
    lines = fit_lines(x[beyond], force[beyond, None], run[beyond])
    noise = float((lines.residual[:, 0] ** 2).sum()) / lines.dof  # variance of one reading about the lines

    def apart(v: np.ndarray) -> np.ndarray:
        """Mean at the step less that beyond it, by run."""
        means = [np.bincount(run[rows], v[rows], len(both))[both] for rows in (at, beyond)]
        return means[0] / here[both] - means[1] / known[both]

    away = apart(x)
    excess = apart(force) - lines.slope[0] * away
    spread = (noise * (1 / here[both] + 1 / known[both]) + lines.covariance[0, 0] * away**2) ** 0.5
    above = excess > 1e-12 * np.abs(force).max()  # readings without noise lie on the line to rounding
    chance = stdtr(lines.dof, -excess / np.maximum(spread, 1e-300))
    return not (above & (chance < BEFORE / both.sum())).any()
