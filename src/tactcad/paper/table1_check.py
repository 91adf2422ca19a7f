"""Table 1 against itself: its products, its ratios, and the load cell in series.

K d should be the force and |K_v| d the signal, apart from the intercepts of the lines, which are not printed;
K_v/K is printed beside its two terms. Stage travel = d + F/K_c for every element, so d against F is one
line whose slope is the compliance that was really in series and whose intercept is the travel.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactcad.lab.regression import fit_lines, t_quantile
from tactcad.paper.published import Column, Published


@dataclass(frozen=True)
class ColumnProduct:
    """A printed value and the same value computed from other columns; relative difference, and what
    rounding allows.
    """

    printed: np.ndarray
    computed: np.ndarray
    difference: np.ndarray
    rounding: np.ndarray

    @property
    def beyond_rounding(self) -> np.ndarray:
        return np.abs(self.difference) > self.rounding


@dataclass(frozen=True)
class SeriesSpring:
    """The compliance in series: travel (um) from the printed deflections and forces, stiffness (N/mm) with 95
    % interval.
    """

    travel: np.ndarray  # by element, d + F/K_c
    nearest_step: np.ndarray  # um
    line_stiffness: float
    line_low: float
    line_high: float
    line_travel: float
    line_travel_half: float
    stiffness_at_full_travel: np.ndarray  # K_c that makes each element's travel the stated one


@dataclass(frozen=True)
class Table1Check:
    element: np.ndarray
    force: ColumnProduct  # N
    signal: ColumnProduct  # V
    ratio: ColumnProduct  # V/N
    series: SeriesSpring


def check(data: Published) -> Table1Check:
    """All of Table 1's internal relations."""
    t = data.table1
    d, slope = t.deflection, t.signal_per_deflection
    mm = 1e-3

    def relative(c: Column) -> np.ndarray:
        return c.half_step / np.abs(c.value)

    force = _product(t.force, t.stiffness.value * d.value * mm, relative(t.stiffness) + relative(d))
    signal = _product(t.signal, np.abs(slope.value) * d.value * mm, relative(slope) + relative(d))
    ratio = _product(
        t.signal_per_force, slope.value / t.stiffness.value, relative(slope) + relative(t.stiffness)
    )
    return Table1Check(t.element, force, signal, ratio, _series(data))


def _product(printed: Column, computed: np.ndarray, rounding: np.ndarray) -> ColumnProduct:
    return ColumnProduct(
        printed.value,
        computed,
        computed / printed.value - 1,
        rounding + printed.half_step / np.abs(printed.value),
    )


def _series(data: Published) -> SeriesSpring:
    t, figure = data.table1, data.figure
    d, force = t.deflection.value, t.force.value
    cell, travel, step = (
        figure["load_cell_stiffness"],
        figure["calibration_travel"],
        figure["calibration_step"],
    )
    reached = d + force / cell * 1e3
    line = fit_lines(force, d[:, None], np.zeros(len(d), int))
    half = t_quantile(0.95, line.dof) * line.covariance[0, 0] ** 0.5
    low, high = -line.slope[0] - half, -line.slope[0] + half  # compliance, um/N
    sxx = ((force - force.mean()) ** 2).sum()
    travel_se = (line.covariance[0, 0] * (sxx / len(d) + force.mean() ** 2)) ** 0.5
    with np.errstate(divide="ignore"):
        full = np.where(d < travel, force / np.maximum(travel - d, 1e-9) * 1e3, np.inf)
    return SeriesSpring(
        reached,
        np.round(reached / step) * step,
        1e3 / -line.slope[0] if line.slope[0] < 0 else np.inf,
        1e3 / high if high > 0 else np.inf,
        1e3 / low if low > 0 else np.inf,
        float(line.intercept[0]),
        float(t_quantile(0.95, line.dof) * travel_se),
        full,
    )
