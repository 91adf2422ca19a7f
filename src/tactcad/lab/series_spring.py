"""From the slopes of force and signal over the stage's displacement to an element's own stiffness and signal.

The stage's displacement X is shared by two springs, element K and load cell K_c, so F = k X + c with k = K
K_c/(K + K_c). With v the signal's slope: K = k K_c/(K_c - k), K_v = v/(1 - k/K_c), K_v/K = v/k. The load
cell's stiffness is known within limits: an interval holds for every value within them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

import numpy as np

from tactcad.design.messages import InputError
from tactcad.lab.load_cell import LoadCell, series_removed
from tactcad.lab.regression import rounding
from tactcad.mechanics.fieller import ratio_interval


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
    """Raise InputError where the force (y[:, 0], N) cannot be that of a spring and a load cell in series, or
    the signal (y[:, 1], V) that of a gauge on the spring.

    `slope` is of force and signal over displacement (N/mm, V/mm), `half_width` that of the force's slope,
    `far` the file's lines whose force is an outlier.
    """
    constant = np.abs(slope) * np.ptp(x) <= rounding(y)
    for name, unit, unchanged in zip(("force", "signal"), "NV", constant):
        if unchanged:
            raise InputError(
                where,
                f"the {name} does not change with displacement",
                legal=f"{name} in {unit} that {'rises' if unit == 'N' else 'changes'} with displacement",
            )
    k = float(slope[0])
    if k + half_width < 0:
        raise InputError(
            where,
            f"the force falls with displacement, by {-k:.4g} N/mm: the sign of one column is reversed",
            legal="force and displacement both grow as the element is pressed",
        )
    if k - half_width >= load_cell.ends[1]:
        raise InputError(
            where,
            f"the force rises by {k:.4g} N/mm, which the load cell of {load_cell.stiffness:g} N/mm cannot: "
            "another unit of displacement or force, or another load cell",
            legal="displacement in mm (displacement_um for micrometres), force in N, --load-cell",
        )
    if far and not 0 < k < load_cell.ends[1]:  # without outliers noise alone can bring k there: no refusal
        does = "falls with displacement" if k <= 0 else "rises by more than the load cell can"
        raise InputError(
            where,
            f"the force {does}, because of what lies far from the other readings: line {', '.join(far)}",
            value=f"{k:.4g} +-{half_width:.4g} N/mm",
            legal="force in N that rises with displacement; --drop-outliers leaves those lines out",
        )


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
