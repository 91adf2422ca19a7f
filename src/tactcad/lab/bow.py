"""The bow of readings about their line, as hysteresis and friction leave it.

A run read on the way up only bows to one side: force lags behind, most in the middle of the travel. The bow
repeats in every run, so the scatter does not show it, and it shifts the slope: the first displacement is left
out, and over the rest the line is not the chord. The bow is estimated from all elements of a file, which
share stage and sensors, and from each element alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .regression import fit_lines, t_quantile


@dataclass(frozen=True)
class Bow:
    """Height of the bow in the middle of the travel over the change along the travel, with its standard error
    and degrees of freedom; below 0 for a hollow line, such as a force that rises late."""

    height: float
    standard_error: float
    dof: int

    def told(self, chance: float) -> bool:
        """Whether noise gives such a bow with less than that probability."""
        return abs(self.height) > t_quantile(1.0 - chance, self.dof) * self.standard_error

    @property
    def most(self) -> float:
        """Upper end of its 95 % interval, whatever its side."""
        return abs(self.height) + t_quantile(0.95, self.dof) * self.standard_error


def bow(x: np.ndarray, y: np.ndarray, run: np.ndarray, weight: np.ndarray) -> Bow | None:
    """The bow of one response.

    Parameters
    ----------
    x, y, run, weight : arrays, [reading]
        As for `regression.fit_lines`, with one response.

    Returns
    -------
    Bow or None
        y = intercept[run] + slope x + curvature x^2 by weighted least squares; the height over the full scale
        is then -curvature range/(4 slope). None if there are too few displacements to tell a parabola.
    """
    if len(np.unique(np.round(x, 9))) < 4:
        return None
    square = (x - x.mean()) ** 2
    both = fit_lines(x, np.column_stack([square, y]), run, weight)
    w, (q, left), travel = both.weight, both.residual.T, np.ptp(x)
    sqq, dof = float(w @ q**2), both.dof - 1
    if dof < 1 or both.slope[1] == 0.0 or sqq <= 1e-12 * travel**4:
        return None
    curvature = float(w @ (q * left)) / sqq
    noise = float(w @ (left - curvature * q) ** 2) / dof
    share = travel / (4.0 * both.slope[1])
    return Bow(-curvature * share, abs(share) * (noise / sqq) ** 0.5, dof)


def common(bows: Sequence[Bow | None]) -> Bow | None:
    """The mean of the elements' bows, weighted by their variances; None if none is known. Its variance is
    Meier's (Biometrics 9, 1953), which allows for estimated weights."""
    known = [b for b in bows if b and b.standard_error > 0.0]
    if not known:
        return None
    weight = np.array([b.standard_error**-2 for b in known])
    mean = float(weight @ [b.height for b in known] / weight.sum())
    share = weight / weight.sum()
    guessed = 1.0 + 4.0 * float((share * (1.0 - share) / [b.dof for b in known]).sum())
    return Bow(mean, (guessed / weight.sum()) ** 0.5, sum(b.dof for b in known))


def off_the_chord(height: float, x: np.ndarray, start: float) -> float:
    """Relative deviation, for a bow of that height, of the slope of readings at x (mm) from that of the chord
    from `start`, where contact began, to the largest x.

    The slope of a parabola is linear in x: over evenly spread readings the line has that of their middle, the
    chord that of its own.
    """
    return 4.0 * abs(height) * max(float(x.min()) - start, 0.0) / max(float(np.ptp(x)), 1e-12)
