"""How often intervals hold.

    python benchmarks/interval_tables.py benchmarks/results/intervals.md

Every row is hundreds of simulated labs with known truth, from a seed: the same bytes each time. A figure that
differs from the expected 95 % has a reason, chosen by the figure.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf
from pathlib import Path

import numpy as np
from example_readings import Noise, truth
from labs import CELL, OBJECTS, QUANTITIES, STEPS, Lab, Touch, intervals, known_widths, touched, true_values
from scipy.special import betaincinv
from tables import lines
from tables import renewed as with_tables

from tactcad.lab.load_cell import LoadCell
from tactcad.paper.grasp_figures import Truth

SEED = 20261122
LABS = 500  # of every row; twice as many for events of one in a hundred
THREE = (4, 3, 8)  # Table 1's softest element, a middle one and its stiffest
EXPECTED = (0.93, 0.97)
WIDE = 1.5  # median width over that of who knows the variances; more wants its reason
AWAY = (6.0, 8.0, 12.0)  # outliers planted, standard deviations of the reading's own noise
Tell = Callable[[str], None]


@dataclass(frozen=True)
class Study:
    """A kind of lab. `why`: what makes its intervals hold the truth more often than stated, or wider."""

    what: str
    lab: Lab
    why: str = ""
    apart: bool = False  # K and K_v share the load cell's error, which K_v/K knows nothing of

    @property
    def concerns(self) -> tuple[int, ...]:
        """Which of QUANTITIES `why` concerns."""
        return (0, 1) if self.apart else (0, 1, 2)


AT_END = "holds for every load cell within its limits"
GAP = "readings not surely in contact do not count"
STUDIES = (
    Study("runs alike", Lab()),
    *(Study(f"runs differ by {100 * s:g} %", Lab(noise=Noise(of_run=s))) for s in (0.003, 0.01, 0.03)),
    Study("five runs, differ by 1 %", Lab(5, Noise(of_run=0.01))),
    *(
        Study(f"one run, differs by {100 * s:g} %", Lab(1, Noise(of_run=s)), "1 % of scatter is assumed")
        for s in (0.0, 0.003, 0.01)
    ),
    Study("one run, differs by 3 %, said so", Lab(1, Noise(of_run=0.03), run_scatter=0.03)),
    Study("noise 3 % of the reading", Lab(noise=Noise(of_reading=0.03))),
    *(
        Study(
            f"load cell off by {100 * off:g} %, known to {100 * off:g} %",
            Lab(cell=LoadCell(CELL, off * CELL), cell_off=off),
            AT_END,
            apart=True,
        )
        for off in (0.02, 0.05)
    ),
    *(Study(f"contact after up to {1e3 * g:g} um", Lab(gap=g), GAP) for g in (0.005, 0.010, 0.040)),
)
BROKEN = (
    Study("one run, differs by 3 %, 1 % assumed", Lab(1, Noise(of_run=0.03))),
    Study(
        "load cell off by 5 %, 2 % assumed", Lab(cell=LoadCell(CELL, 0.02 * CELL), cell_off=0.05), apart=True
    ),
)
NOISES = {
    "even": Noise(),
    "1 % of the reading": Noise(of_reading=0.01),
    "3 % of the reading": Noise(of_reading=0.03),
}
TOUCHES = (
    Touch("three runs that differ by 1 %", Lab(noise=Noise(of_run=0.01))),
    Touch("one run that differs by 1 %", Lab(1, Noise(of_run=0.01))),
    Touch("one run that differs by 0.3 %, 1 % assumed", Lab(1, Noise(of_run=0.003))),
    *(
        Touch("three runs that differ by 1 %", Lab(noise=Noise(of_run=0.01)), pads, limit=1.0)
        for pads in ("apart", "5 %", "half-space")
    ),
)


def chosen(numbers: Sequence[int]) -> Truth:
    """Table 1's elements of these numbers."""
    all_ = truth()
    rows = [int(np.flatnonzero(all_.element == n)[0]) for n in numbers]
    return Truth(
        *(a[rows] for a in (all_.element, all_.stiffness, all_.signal_per_deflection, all_.zero_signal))
    )


def exact_limits(held: int, of: int) -> tuple[float, float]:
    """Clopper and Pearson's 95 % interval of a share."""
    low = float(betaincinv(held, of - held + 1, 0.025)) if held else 0.0
    high = float(betaincinv(held + 1, of - held, 0.975)) if held < of else 1.0
    return low, high


def share(held: int, of: int) -> str:
    """Per cent and its interval, as two cells of a table."""
    low, high = exact_limits(held, of)
    return f"{100 * held / of:.1f} | {100 * low:.1f} to {100 * high:.1f}"


def reason(cover: float, ratio: float, lab: Lab, why: str) -> str:
    """The remark on a row, by its figures."""
    said = [why] if why and (cover > EXPECTED[1] or ratio > WIDE) else []
    if ratio > WIDE and 1 < lab.runs < 5:
        said.append(f"t with {lab.runs - 1} degrees of freedom")
    if cover < EXPECTED[0]:
        said.append("**too seldom**")
    return "; ".join(said)


def calibrations(studies: Sequence[Study], labs: int, tell: Tell) -> str:
    """K, K_v and K_v/K of simulated calibrations."""
    array, rows = chosen(THREE), []
    value = true_values(array)
    for index, study in enumerate(studies):
        tell(study.what)
        found = _intervals(study.lab, array, labs, np.random.default_rng([SEED, 1, index]))
        held = (found[..., 0] <= value) & (value <= found[..., 1])
        ratio = (found[..., 1] - found[..., 0]) / known_widths(study.lab, array)
        for which, q in _counted(study):
            h, width = held[:, which, q], float(np.median(ratio[:, which, q]))
            number = "all three" if len(which) == 3 else str(array.element[which[0]])
            why = reason(float(h.mean()), width, study.lab, study.why if q in study.concerns else "")
            held_by = share(int(h.sum()), h.size)
            rows.append((study.what, number, QUANTITIES[q], labs, held_by, f"{width:.2f}", why))
    heads = "lab | element | quantity | labs | holds the truth, % | 95 % interval | width / known | why"
    return lines(heads, rows)


def _counted(study: Study) -> list[tuple[list[int], int]]:
    """Elements and quantity of every row; those that share the load cell's error count one by one."""
    if not study.apart:
        return [([0, 1, 2], q) for q in range(3)]
    return [([e], q) for e in (0, 2) for q in (0, 1)] + [([0, 1, 2], 2)]


def _intervals(lab: Lab, array: Truth, labs: int, rng: np.random.Generator) -> np.ndarray:
    """[lab, element, quantity, end]"""
    return np.array([[intervals(r) for r in lab.calibrated(lab.readings(array, rng))] for _ in range(labs)])


def outliers(labs: int, tell: Tell) -> str:
    """False alarms of files of nine elements, and how often a planted outlier is named."""
    array, rows = truth(), []
    for index, (what, noise) in enumerate(NOISES.items()):
        tell(f"outliers, {what}")
        rng, lab = np.random.default_rng([SEED, 2, index]), Lab(noise=noise)
        files = (lab.calibrated(lab.readings(array, rng)) for _ in range(2 * labs))
        alarms = sum(any(r.outliers for r in file) for file in files)
        named = sum(_named(lab, array, rng).astype(float) for _ in range(labs))
        cells = (f"{100 * n / labs:.0f}" for n in named)
        rows.append((what, 2 * labs, share(alarms, 2 * labs), *cells))
    planted = " | ".join(f"{a:g} sd named, %" for a in AWAY)
    return lines(f"noise | files | with a false alarm, % | 95 % interval | {planted}", rows)


def _named(lab: Lab, array: Truth, rng: np.random.Generator) -> np.ndarray:
    """Which outliers of AWAY are named, each planted in the force of an element of its own, of one file."""
    data = lab.readings(array, rng)
    planted = []
    for element, away in zip(rng.permutation(len(array.element)), AWAY):
        here = np.flatnonzero((data.element == array.element[element]) & (data.displacement > STEPS[1] / 2))
        i = int(rng.choice(here))
        k = array.stiffness[element] * CELL / (CELL + array.stiffness[element])
        n, force = lab.noise, k * data.displacement[i]
        sd = (n.force**2 + (k * n.displacement) ** 2 + (n.of_reading * force) ** 2) ** 0.5
        data.force[i] += away * sd * rng.choice([-1, 1])
        planted.append((int(element), int(data.line[i])))
    rows = lab.calibrated(data)
    return np.array(
        [line in [o.line for o in rows[e].outliers if o.quantity == "force"] for e, line in planted]
    )


def objects(labs: int, tell: Tell) -> str:
    """K_obj of simulated calibrations and grasps."""
    array, rows = chosen(OBJECTS), []
    for index, touch in enumerate(TOUCHES):
        tell(f"{touch.what}, pads {touch.pads}")
        many = labs if touch.limit else 2 * labs
        found = touched(touch, array, many, np.random.default_rng([SEED, 3, index]))
        for name, some in (("all elements", slice(1)), ("single pairs", slice(1, None))):
            held, ratio = found.held[:, some], found.ratio[:, some]
            finite = ratio[np.isfinite(ratio)]
            width = float(np.median(finite)) if len(finite) > ratio.size / 2 else inf
            told = name == "all elements" and not touch.limit  # coupled pads do disagree
            disagree = f"{100 * found.disagree.mean():.1f}" if told else ""
            why = reason(float(held.mean()), width, touch.lab, touch.why)
            held_by = share(int(held.sum()), held.size)
            rows.append((touch.what, touch.said, name, many, held_by, f"{width:.2f}", disagree, why))
    heads = (
        "calibration | pads | interval of | labs | holds the truth, % | 95 % interval | width / known | "
        'false "disagree", % | why'
    )
    return lines(heads, rows)


def renewed(text: str, labs: int, tell: Tell) -> str:
    """The document with its tables made anew."""
    tables = {
        "coverage of calibrations": lambda: calibrations(STUDIES, labs, tell),
        "coverage where an assumption is wrong": lambda: calibrations(BROKEN, labs, tell),
        "outliers": lambda: outliers(labs, tell),
        "coverage of objects": lambda: objects(labs, tell),
    }
    return with_tables(text, tables)


if __name__ == "__main__":
    document = Path(sys.argv[1])
    made = renewed(document.read_text("utf-8"), LABS, lambda what: print(what, flush=True))
    document.write_text(made, "utf-8")
