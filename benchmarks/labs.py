"""Labs with known truth, which calibrate an array and press it on an object of known stiffness: their
readings, the results, and the interval's width if every variance were known.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from example_readings import READING_NOISE, SAMPLES, Noise, calibration_rows

from tactcad.design.load import DEFAULT_DESIGN
from tactcad.lab import pads
from tactcad.lab.calibration import ElementCalibration, calibrate
from tactcad.lab.calibration_file import Sensitivity
from tactcad.lab.combine import DISAGREE, Interval, Slopes, combine_each
from tactcad.lab.grasp import common_slopes, evaluate
from tactcad.lab.load_cell import LoadCell, series_removed
from tactcad.lab.readings import CalibrationReadings, GraspReadings
from tactcad.lab.regression import KNOWN, t_quantile
from tactcad.paper.grasp_figures import Truth

LEVEL = 0.95
CELL = 57.04  # N/mm, the paper's
STEPS = 0.025 * np.arange(7)  # mm, the paper's
QUANTITIES = ("K", "K_v", "K_v/K")
GAPS = (np.arange(40) + 0.5) / 40  # of the largest gap, evenly


@dataclass(frozen=True)
class Lab:
    """A lab's calibration, and its own statements (cell, run_scatter)."""

    runs: int = 3
    noise: Noise = Noise()
    gap: float = 0.0  # mm, the largest before contact
    cell_off: float = 0.0  # of the true load cell from the stated one, relative, either way
    cell: LoadCell = LoadCell(CELL)
    run_scatter: float | None = None

    def readings(self, truth: Truth, rng: np.random.Generator) -> CalibrationReadings:
        cell = self.cell.stiffness * (1 + self.cell_off * rng.choice([-1, 1]))
        rows = calibration_rows(truth, cell, STEPS, self.runs, self.noise, rng, self.gap)
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


# --- objects ---

OBJECTS = (8, 3, 4)  # of Table 1: its stiffest, the reference, a middle one and its softest
STIFFNESS = SAMPLES[0]  # of the object under one pad, N/mm
LOAD = 3.235 + 0.980665 * np.arange(8)  # N, the paper's
EVEN = 0.05


@dataclass(frozen=True)
class Touch:
    """How the array was calibrated, how its pads feel each other through the object ("apart", "5 %",
    "half-space"), and the limit of that which the lab states (`--coupling`).
    """

    what: str
    lab: Lab
    pads: str = "apart"
    limit: float = 0.0

    @property
    def said(self) -> str:
        return (
            f"{self.pads}, anything up to a half-space allowed for" if self.limit else f"{self.pads}, known"
        )

    @property
    def why(self) -> str:
        of_runs = "1 % of scatter is assumed" if self.lab.runs == 1 else ""
        return "even pads, all read: holds for every coupling up to a half-space" if self.limit else of_runs

    def share(self, array: Truth) -> np.ndarray:
        """Displacement of a pad by the force on another over that by the same force on itself."""
        n = len(array.element)
        if self.pads == "half-space":
            found = pads.coupling(DEFAULT_DESIGN, _readings(array, np.zeros((n, len(LOAD)))), 1.0)
            assert found is not None
            return found
        off = {"apart": 0.0, "5 %": EVEN}[self.pads]
        return off + (1 - off) * np.eye(n)


def coupled_deflection(
    load: np.ndarray, stiffness: np.ndarray, object_stiffness: float, share: np.ndarray
) -> np.ndarray:
    """Deflections (mm), [element, load], of elements whose pads are coupled through the sample.

    Parameters
    ----------
    load : array, [load]
        N.
    stiffness : array, [element]
        N/mm.
    object_stiffness : float
        Under one pad, N/mm.
    share : array, [element, element]
        Displacement of pad i by the force on pad j, over that by the same force on i; 1 on the diagonal.
    """
    force = np.linalg.solve(np.diag(1 / stiffness) + share / object_stiffness, np.ones(len(stiffness)))
    return np.outer(force / stiffness, load / force.sum())


@dataclass(frozen=True)
class Touched:
    """By lab: whether the intervals of all elements together and of every pair held the truth, their widths
    over those with known variances and coupling, [lab, interval]; whether "disagree" was reported.
    """

    held: np.ndarray
    ratio: np.ndarray
    disagree: np.ndarray


def touched(touch: Touch, array: Truth, labs: int, rng: np.random.Generator) -> Touched:
    """`labs` calibrations, each with a grasp."""
    share = touch.share(array)
    clean = array.signal_per_deflection[:, None] * coupled_deflection(LOAD, array.stiffness, STIFFNESS, share)
    oracle = np.array([_width(i) for i in _known(touch, array, clean, share)])
    coupling = pads.coupling(DEFAULT_DESIGN, _readings(array, clean), touch.limit)
    held, ratio, disagree = [], [], []
    for _ in range(labs):
        rows = touch.lab.calibrated(touch.lab.readings(array, rng))
        signal = clean + READING_NOISE * rng.standard_normal(clean.shape)
        found = evaluate(
            _readings(array, signal),
            measured(rows, touch.lab.cell),
            reference=OBJECTS[0],
            level=LEVEL,
            coupling=coupling,
        )
        by_element = {p.measuring: p.object for p in found.pairs}
        all_ = [found.combined, *(by_element[n] for n in OBJECTS[1:])]
        held.append([not i.empty and i.low <= STIFFNESS <= i.high for i in all_])
        ratio.append([_width(i) for i in all_] / oracle)
        disagree.append(found.disagreement_p < DISAGREE)
    return Touched(np.array(held), np.array(ratio), np.array(disagree))


def _known(touch: Touch, array: Truth, clean: np.ndarray, share: np.ndarray) -> list[Interval]:
    """Intervals of all elements and of every pair by the true variances and the true coupling."""
    slopes, _ = common_slopes(array.element, clean, known(touch.lab, array))
    a, b = 1 / array.signal_per_deflection, array.stiffness / array.signal_per_deflection
    noise = np.moveaxis(np.array([[b * b, a * b], [a * b, a * a]]), 2, 0) * READING_NOISE**2
    sure: Slopes = replace(slopes, from_signal=noise, signal_dof=int(KNOWN)).coupled(share)
    pairs = [[i, 0] for i in range(1, len(array.element))]
    return [combine_each([(sure, members)], LEVEL)[0][0] for members in (None, *pairs)]


def _readings(array: Truth, signal: np.ndarray) -> GraspReadings:
    return GraspReadings(1, array.element, LOAD, np.zeros(len(LOAD), int), signal)


def _width(i: Interval) -> float:
    return i.high - i.low
