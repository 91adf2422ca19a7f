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
    start = len(step) - max(ceil(IN_CONTACT * len(step)), 3)
    for i in range(start - 1, 0, -1):
        beyond = index > i
        if not _on_line(x, force, run, beyond, index == i):
            return float(step[i + 1]), i + 1
    return (float(step[1]), 1) if len(step) >= FEWEST else (float(step[0]), 0)


def _on_line(x: np.ndarray, force: np.ndarray, run: np.ndarray, beyond: np.ndarray, at: np.ndarray) -> bool:
    """Whether the readings `at` one step lie on, or below, the line through those `beyond` it, in every
    run."""
    runs = [r for r in np.unique(run[at]) if (run[beyond] == r).any()]
    if not runs or spare_steps(x[beyond], run[beyond]) < 1:
        return True
    lines = fit_lines(x[beyond], force[beyond, None], run[beyond])
    noise = float((lines.residual[:, 0] ** 2).sum()) / lines.dof  # variance of one reading about the lines
    slope_variance = float(lines.covariance[0, 0])
    smallest = 1e-12 * float(np.abs(force).max())  # readings without noise lie on the line to rounding
    for r in runs:
        known, here = beyond & (run == r), at & (run == r)
        away = float(x[here].mean() - x[known].mean())
        excess = float(force[here].mean() - force[known].mean()) - float(lines.slope[0]) * away
        spread = (noise * (1 / here.sum() + 1 / known.sum()) + slope_variance * away**2) ** 0.5
        if excess > smallest and (
            spread <= 0 or float(stdtr(lines.dof, -excess / spread)) < BEFORE / len(runs)
        ):
            return False
    return True
