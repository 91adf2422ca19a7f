"""The force sensor, a spring in series with the element: its stiffness with limits, and its removal from the
slopes.

The stage's displacement X is shared by two springs, element K and load cell K_c, so F = k X + c with k = K
K_c/(K + K_c). With v the signal's slope: K = k K_c/(K_c - k), K_v = v/(1 - k/K_c), K_v/K = v/k. The load
cell's stiffness is known within limits: an interval holds for every value within them.

The paper averages an element's runs and regresses over d = X - F/K_c, which puts the force's noise on both
axes; its estimates are given for comparison.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isinf

import numpy as np

from tactcad.design.messages import InputError
from tactcad.design.text_values import with_limits
from tactcad.design.tree import Design
from tactcad.mechanics.lumped import ratio_interval

from .regression import fit_lines, rounding, steps, t_quantile

# Relative half-width assumed of a load cell's stiffness that is given without limits. Chosen: what one
# measurement with weights and a micrometer reaches.
CELL_ACCURACY = 0.02
RIGID = 1e9  # N/mm: the value of a rigid load cell in a calibration's file


@dataclass(frozen=True)
class LoadCell:
    """The force sensor's own stiffness, known to lie within stiffness +- half_width; both N/mm.

    Raises
    ------
    InputError
        A stiffness not positive, or finite and above RIGID; limits that reach zero, or of a rigid one.
    """

    stiffness: float
    half_width: float = 0.0

    def __post_init__(self) -> None:
        if not 0 < self.stiffness <= RIGID and (self.stiffness, self.half_width) != (inf, 0):
            legal = f"above 0 N/mm up to {RIGID:g} N/mm, or inf without limits"
            raise InputError("load cell", "not a stiffness", value=self.stiffness, legal=legal)
        if not 0 <= self.half_width < self.stiffness:
            legal = f"from 0 to below {self.stiffness:g} N/mm"
            raise InputError(
                "load cell", "its limits must leave it a stiffness", value=self.half_width, legal=legal
            )

    @classmethod
    def parse(cls, text: str) -> LoadCell:
        """From "57.04", "57.04+-1", "57.04+-2%" or "inf"; without limits `CELL_ACCURACY` is assumed.

        Raises
        ------
        InputError
            The text has none of these forms.
        """
        try:
            stiffness, half = with_limits(text)
        except ValueError:
            legal = "a stiffness in N/mm with its limits, as in 57.04+-1 or 57.04+-2%, or inf"
            raise InputError("load cell", "not a stiffness", value=text, legal=legal) from None
        if half is None:
            half = 0.0 if isinf(stiffness) else CELL_ACCURACY * stiffness
        return cls(stiffness, half)

    @property
    def ends(self) -> tuple[float, float]:
        """Softest and stiffest, N/mm."""
        if isinf(self.stiffness):
            return self.stiffness, self.stiffness
        return self.stiffness - self.half_width, self.stiffness + self.half_width


def series_removed(slope: float, load_cell: float) -> float:
    """Stiffness of the element alone, k K_c/(K_c - k), from that of element and load cell in series.

    Parameters
    ----------
    slope : float
        k: force over the stage's displacement, N/mm.
    load_cell : float
        K_c, N/mm; inf for a rigid one.

    Returns
    -------
    float
        N/mm; inf if k is no less than K_c.
    """
    if isinf(load_cell):
        return slope
    return slope * load_cell / (load_cell - slope) if slope < load_cell else inf


def of_design(design: Design) -> LoadCell | None:
    """The load cell of a design of facing rows; None if it has no [calibration]."""
    rig = design.calibration
    if rig is None:
        return None
    return LoadCell(rig.load_cell_stiffness, rig.load_cell_accuracy * rig.load_cell_stiffness)


@dataclass(frozen=True)
class Estimate:
    """A value with its interval; standard error as used for the interval. Same unit throughout."""

    value: float
    low: float
    high: float
    standard_error: float


def require_spring(
    where: str,
    x: np.ndarray,
    y: np.ndarray,
    slope: np.ndarray,
    half_width: float,
    load_cell: LoadCell,
    far: Sequence[str],
) -> None:
    """Raise InputError if the force (y[:, 0], N) cannot be that of a spring and a load cell in series, or
    the signal (y[:, 1], V) that of a gauge on the spring.

    `slope` is of force and signal over displacement (N/mm, V/mm), `half_width` that of the force's slope,
    `far` the file's lines whose force is an outlier.
    """
    constant = np.abs(slope) * np.ptp(x) <= rounding(y)
    for name, unit, unchanged in zip(("force", "signal"), "NV", constant):
        if unchanged:
            legal = f"{name} in {unit} that {'rises' if unit == 'N' else 'changes'} with displacement"
            raise InputError(where, f"the {name} does not change with displacement", legal=legal)
    k = float(slope[0])
    if k + half_width < 0:
        what = f"the force falls with displacement, by {-k:.4g} N/mm: the sign of one column is reversed"
        raise InputError(where, what, legal="force and displacement both grow as the element is pressed")
    if k - half_width >= load_cell.ends[1]:
        raise InputError(
            where,
            f"the force rises by {k:.4g} N/mm, which the load cell of {load_cell.stiffness:g} N/mm cannot: "
            "another unit of displacement or force, or another load cell",
            legal="displacement in mm (displacement_um for micrometres), force in N, --load-cell",
        )
    if far and not 0 < k < load_cell.ends[1]:  # without outliers noise alone can bring k there: no refusal
        does = "falls with displacement" if k <= 0 else "rises by more than the load cell can"
        what = f"the force {does}, because of what lies far from the other readings: line {', '.join(far)}"
        legal = "force in N that rises with displacement; --drop-outliers leaves those lines out"
        raise InputError(where, what, value=f"{k:.4g} +-{half_width:.4g} N/mm", legal=legal)


def element_stiffness(k: float, se: float, load_cell: LoadCell, t: float, notes: list[str]) -> Estimate:
    """K = k K_c/(K_c - k), N/mm. It rises with k and falls with K_c, so each end of the interval comes from
    that end of k and the load cell at the limit that widens it."""
    low, high = k - t * se, k + t * se
    softest, stiffest = load_cell.ends
    if low <= 0:
        notes.append(
            "the force does not rise with displacement beyond noise: the data do not tell the stiffness "
            "from zero"
        )
    if high >= softest:
        notes.append("as stiff as the load cell within noise: the data bound the stiffness from below only")
    cell = load_cell.stiffness
    slope = (1 - k / cell) ** -2 if k < cell else inf
    return Estimate(
        series_removed(k, cell),
        max(series_removed(low, stiffest), 0.0),
        series_removed(high, softest),
        se * slope,
    )


def sensitivities(
    k: float, v: float, covariance: np.ndarray, load_cell: LoadCell, t: float
) -> tuple[Estimate, Estimate]:
    """K_v = v/(1 - k/K_c) for every load cell within its limits, and K_v/K = v/k: ratios of two estimates,
    with Fieller's interval."""
    to_force = np.array([[0.0, 1.0], [1.0, 0.0]])

    def ratio(matrix: np.ndarray, bottom: float) -> Estimate:
        c = matrix @ covariance @ matrix.T
        value = v / bottom
        se = np.sqrt(max(c[0, 0] - 2 * value * c[0, 1] + value * value * c[1, 1], 0.0)) / abs(bottom)
        fieller = ratio_interval(v, bottom, c[0, 0], c[1, 1], c[0, 1], quantile=t)
        low, high = (fieller.lower, fieller.upper) if fieller.bounded else (-inf, inf)
        return Estimate(value, float(low), float(high), float(se))

    def per_deflection(cell: float) -> Estimate:
        return ratio(np.array([[0.0, 1.0], [-1 / cell, 0.0]]), 1 - k / cell)  # (k, v) -> (v, 1 - k/K_c)

    best, *ends = (per_deflection(cell) for cell in (load_cell.stiffness, *load_cell.ends))
    low, high = (min(e.low for e in ends), max(e.high for e in ends))
    return Estimate(best.value, low, high, best.standard_error), ratio(to_force, k)


def correlation(k: float, v: float, covariance: np.ndarray, load_cell: float) -> float:
    """Correlation of K and K_v, linearised in k and v."""
    share = 1 - k / load_cell
    jacobian = np.array([[1 / share**2, 0.0], [v / load_cell / share**2, 1 / share]])
    c = jacobian @ covariance @ jacobian.T
    scale = (c[0, 0] * c[1, 1]) ** 0.5
    return float(np.clip(c[0, 1] / scale, -1, 1)) if scale > 0 else 0.0


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
