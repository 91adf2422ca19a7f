"""Labs that calibrate an array and press it on an object of known stiffness."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from labs import LEVEL, Lab, known, measured

from tactcad.design.load import DEFAULT_DESIGN
from tactcad.lab import pads
from tactcad.lab.combine import DISAGREE, Interval, Slopes, combine
from tactcad.lab.grasp import common_slopes, evaluate
from tactcad.lab.readings import GraspReadings
from tactcad.lab.regression import KNOWN
from tactcad.lab.simulate import Truth
from tactcad.paper.examples import READING_NOISE, SAMPLES

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
        return "holds for every coupling up to a half-space" if self.limit else of_runs

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
    over those of somebody who knows every variance and the coupling, [lab, interval]; whether "disagree" was
    said.
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
    return [combine(sure, LEVEL, members)[0] for members in (None, *pairs)]


def _readings(array: Truth, signal: np.ndarray) -> GraspReadings:
    return GraspReadings(1, array.element, LOAD, np.zeros(len(LOAD), int), signal)


def _width(i: Interval) -> float:
    return i.high - i.low
