"""Labs with known truth: what they read, what `calibrate` makes of it, and how wide the interval of somebody
would be who knows every variance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactcad.lab import simulate
from tactcad.lab.calibration import ElementCalibration, calibrate
from tactcad.lab.load_cell import LoadCell, series_removed
from tactcad.lab.readings import CalibrationReadings
from tactcad.lab.regression import KNOWN, t_quantile
from tactcad.lab.sensitivity import Sensitivity
from tactcad.lab.simulate import Noise, Truth

LEVEL = 0.95
CELL = 57.04  # N/mm, the paper's
STEPS = 0.025 * np.arange(7)  # mm, the paper's
QUANTITIES = ("K", "K_v", "K_v/K")
GAPS = (np.arange(40) + 0.5) / 40  # of the largest gap, evenly


@dataclass(frozen=True)
class Lab:
    """What a lab's calibration is like, and what it says of itself (cell, run_scatter)."""

    runs: int = 3
    noise: Noise = Noise()
    gap: float = 0.0  # mm, the largest before contact
    cell_off: float = 0.0  # of the true load cell from the stated one, relative, either way
    cell: LoadCell = LoadCell(CELL)
    run_scatter: float | None = None

    def readings(self, truth: Truth, rng: np.random.Generator) -> CalibrationReadings:
        cell = self.cell.stiffness * (1 + self.cell_off * rng.choice([-1, 1]))
        rows = simulate.calibration_rows(truth, cell, STEPS, self.runs, self.noise, rng, self.gap)
        number = rows[:, :2].astype(int).T
        return CalibrationReadings(*number, *rows[:, 2:].T, np.arange(len(rows)))

    def calibrated(self, readings: CalibrationReadings) -> list[ElementCalibration]:
        return calibrate(readings, self.cell, level=LEVEL, run_scatter=self.run_scatter)


def intervals(row: ElementCalibration) -> np.ndarray:
    """Ends of the intervals of QUANTITIES, [quantity, end]."""
    found = (row.stiffness, row.signal_per_deflection, row.signal_per_force)
    return np.array([(e.low, e.high) for e in found])


def true_values(truth: Truth) -> np.ndarray:
    """QUANTITIES by element, [element, quantity]."""
    k, v = truth.stiffness, truth.signal_per_deflection
    return np.column_stack([k, v, v / k])


def known_widths(lab: Lab, truth: Truth) -> np.ndarray:
    """Widths of intervals by the true variances and the normal quantile, for all load cells within the stated
    limits, [element, quantity].
    """
    z = t_quantile(LEVEL, KNOWN)
    soft, stiff = lab.cell.ends
    k, v = _slopes(truth)
    c = slope_covariance(lab, truth)
    half = z * np.sqrt(c[:, 0, 0])
    ends = zip(k, half)
    of_stiffness = [series_removed(a + h, soft) - series_removed(a - h, stiff) for a, h in ends]
    se = np.sqrt(_of_both(lab, truth)[:, 1, 1])
    of_signal = 2 * z * se + np.abs(v / (1 - k / soft) - v / (1 - k / stiff))
    relative = c[:, 0, 0] / k**2 - 2 * c[:, 0, 1] / (k * v) + c[:, 1, 1] / v**2
    return np.column_stack([of_stiffness, of_signal, 2 * z * np.abs(v / k) * np.sqrt(relative)])


def known(lab: Lab, truth: Truth) -> Sensitivity:
    """The true calibration with its true covariance."""
    c = _of_both(lab, truth)
    se = np.sqrt(np.diagonal(c, axis1=1, axis2=2)).T
    one = np.ones(len(truth.element))
    return Sensitivity(
        truth.element,
        truth.stiffness,
        se[0],
        truth.signal_per_deflection,
        se[1],
        c[:, 0, 1] / se[0] / se[1],
        KNOWN * one,
        CELL * one,
        0 * one,
    )


def measured(rows: list[ElementCalibration], cell: LoadCell) -> Sensitivity:
    """A calibration as `stiffness` takes it."""
    columns = [
        (
            r.element,
            r.stiffness.value,
            r.stiffness.standard_error,
            r.signal_per_deflection.value,
            r.signal_per_deflection.standard_error,
            r.correlation,
            r.dof,
            cell.stiffness,
            cell.half_width,
        )
        for r in rows
    ]
    number, *rest = np.array(columns).T
    return Sensitivity(number.astype(int), *rest)


def slope_covariance(lab: Lab, truth: Truth) -> np.ndarray:
    """Of the slopes of force and signal over displacement, by all readings in contact, [element, 2, 2]."""
    n = lab.noise
    k, v = _slopes(truth)
    information = np.zeros((len(k), 2, 2))
    for gap in lab.gap * GAPS:
        x = STEPS[STEPS >= gap]
        force = n.force**2 + np.outer(k, n.displacement + 0 * x) ** 2 + (n.of_reading * np.outer(k, x)) ** 2
        signal = n.signal**2 + np.outer(v, n.displacement + 0 * x) ** 2 + (n.of_reading * np.outer(v, x)) ** 2
        both = np.outer(k * v, n.displacement**2 + 0 * x)
        w = 1 / force
        away = x - (w @ x / w.sum(1))[:, None]
        pull = w * away / (w * away**2).sum(1)[:, None]
        c = np.einsum("en,ijen->eij", pull**2, np.array([[force, both], [both, signal]]))
        information += np.linalg.inv(c) * lab.runs / len(GAPS)
    of_runs = np.zeros_like(information)
    of_runs[:, 0, 0], of_runs[:, 1, 1] = n.of_run**2 * k**2 / lab.runs, n.of_run**2 * v**2 / lab.runs
    return np.linalg.inv(information) + of_runs


def _of_both(lab: Lab, truth: Truth) -> np.ndarray:
    """Covariance of K and K_v, by their derivatives."""
    k, v = _slopes(truth)
    share, zero = 1 - k / CELL, np.zeros_like(k)
    jacobian = np.moveaxis(np.array([[1 / share**2, zero], [v / CELL / share**2, 1 / share]]), 2, 0)
    return jacobian @ slope_covariance(lab, truth) @ np.swapaxes(jacobian, 1, 2)


def _slopes(truth: Truth) -> tuple[np.ndarray, np.ndarray]:
    """Of force (N/mm) and signal (V/mm) over the stage's displacement."""
    share = CELL / (CELL + truth.stiffness)
    return truth.stiffness * share, truth.signal_per_deflection * share
