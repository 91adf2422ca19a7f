"""Simulated readings of a calibration, for tests of the intervals and for the files of hardware/examples:
`python benchmarks/example_readings.py hardware/examples` writes them.

Truth of the examples: Table 1's stiffnesses and sensitivities. Two samples, one soft and one far stiffer than
every element.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tactcad.contact import springs
from tactcad.paper import published
from tactcad.paper.grasp_figures import Truth, grasp_signals
from tactcad.synthesis.target import Known

SEED = 20260102
READING_NOISE = 0.0002  # V, of ten averaged samples
SAMPLES = (3.85, 3000.0)  # N/mm
PAD_HEIGHT = 0.005  # mm, standard deviation
LOADS = 8  # weights added to the moving weight
LOG_RATE, LOG_STEP, LOG_CHANGE = 10.0, 4.0, 0.8  # Hz; s of a step, and of it while the load changes
LOG_DRIFT, LOG_NOISE = 0.0004, 0.0005  # V: of a channel over the log, and of one sample


@dataclass(frozen=True)
class Noise:
    """Standard deviations."""

    force: float = Known.force_noise  # N, of a reading
    displacement: float = Known.displacement_noise  # mm, of a reading
    signal: float = 0.0005  # V, of a reading
    of_reading: float = 0.0  # relative: of a reading's force, and of its signal's change
    of_run: float = 0.0  # relative: of a run's slopes


def calibration_rows(
    truth: Truth,
    load_cell: float,
    displacement: np.ndarray,
    runs: int,
    noise: Noise,
    rng: np.random.Generator,
    gap: float = 0.0,
) -> np.ndarray:
    """Readings of a calibration: in every run the stage presses load cell and element in series.

    Parameters
    ----------
    truth : Truth
    load_cell : float
        Stiffness of the load cell, N/mm.
    displacement : array, [step]
        Of the stage, mm.
    runs : int
    noise : Noise
    rng : numpy.random.Generator
    gap : float
        Largest way through air before contact, mm; each run's is drawn from 0 to this.

    Returns
    -------
    array, [reading, 5]
        Element, run, displacement (mm), force (N), signal (V).
    """
    share = load_cell / (load_cell + truth.stiffness)
    shape = (len(truth.element), runs, len(displacement))
    more = rng.spawn(1)[0]  # a generator of its own, so that a gap or relative noise leaves the other draws
    pressed = np.maximum(displacement - gap * more.random((*shape[:2], 1)), 0.0)
    deflection = share[:, None, None] * (pressed + noise.displacement * rng.standard_normal(shape))
    true_force = truth.stiffness[:, None, None] * deflection * _factors(noise, shape, more)
    force = true_force + noise.force * rng.standard_normal(shape)
    change = truth.signal_per_deflection[:, None, None] * deflection * _factors(noise, shape, more)
    signal = truth.zero_signal[:, None, None] + change + noise.signal * rng.standard_normal(shape)
    element, run, step = np.broadcast_arrays(
        truth.element[:, None, None], np.arange(1, runs + 1)[None, :, None], displacement[None, None, :]
    )
    return np.column_stack([a.ravel() for a in (element, run, step, force, signal)])


def _factors(noise: Noise, shape: tuple[int, int, int], rng: np.random.Generator) -> np.ndarray:
    """Factors on the true force or signal, one part drawn for each run, one for each reading."""
    of_run = 1 + noise.of_run * rng.standard_normal((*shape[:2], 1))
    return of_run * (1 + noise.of_reading * rng.standard_normal(shape))


NOISE = Noise()


def truth() -> Truth:
    """Table 1's elements."""
    t = published.load().table1
    return Truth(t.element, t.stiffness.value, t.signal_per_deflection.value, t.zero_signal.value)


def calibration_csv(rng: np.random.Generator) -> str:
    """Three runs an element, in the paper's steps."""
    figure = published.load().figure
    step, travel, cell = (
        figure["calibration_step"] * 1e-3,
        figure["calibration_travel"] * 1e-3,
        figure["load_cell_stiffness"],
    )
    displacement = step * np.arange(round(travel / step) + 1)
    rows = calibration_rows(truth(), cell, displacement, int(figure["calibration_runs"]), NOISE, rng)
    lines = [
        "# SIMULATED readings, not measured ones (benchmarks/example_readings.py).",
        f"# Truth: the paper's Table 1; load cell {cell:g} N/mm in series; noise {NOISE.force * 1e3:g} "
        f"mN, {NOISE.displacement * 1e3:g} um, {NOISE.signal * 1e3:g} mV.",
        "element,run,displacement_um,force_N,signal_V",
    ]
    lines += [f"{e:.0f},{r:.0f},{x * 1e3:.0f},{f:.4f},{v:.5f}" for e, r, x, f, v in rows]
    return "\n".join(lines) + "\n"


def grasp_csv(rng: np.random.Generator) -> str:
    """Two samples at no load, the moving weight and each added weight; pads not quite in one plane."""
    figure = published.load().figure
    weight = figure["added_mass"] * 9.80665e-3
    load = np.concatenate([[0.0], figure["moving_weight"] + weight * np.arange(LOADS + 1)])
    array = truth()
    height = PAD_HEIGHT * rng.standard_normal(len(array.element))
    lines = [
        "# SIMULATED readings, not measured ones (benchmarks/example_readings.py).",
        f"# Truth: the paper's Table 1; sample 1 is {SAMPLES[0]:g} N/mm, sample 2 {SAMPLES[1]:g} N/mm "
        f"under one pad; pad heights +-{PAD_HEIGHT * 1e3:g} um, noise {READING_NOISE * 1e3:g} mV.",
        "sample,load_N,element,signal_V",
    ]
    for number, x in enumerate(SAMPLES, 1):
        signal = grasp_signals(array, load, x, READING_NOISE, rng, height)
        signal[:, 0] = array.zero_signal + READING_NOISE * rng.standard_normal(len(height))  # no contact yet
        for j, force in enumerate(load):
            lines += [f"{number},{force:.4f},{e},{signal[i, j]:.5f}" for i, e in enumerate(array.element)]
    return "\n".join(lines) + "\n"


def grasp_log(rng: np.random.Generator) -> str:
    """The log of a grasp of the first sample, as a lab's card writes it: the loads up and down, no load
    before and after; channels that drift, and the fifth dead, as in the paper."""
    figure, array = published.load().figure, truth()
    up = figure["moving_weight"] + figure["added_mass"] * 9.80665e-3 * np.arange(LOADS + 1)
    held = np.concatenate([[0.0], up, up[-2::-1], [0.0]])
    rows = round(LOG_RATE * LOG_STEP)
    change = round(LOG_RATE * LOG_CHANGE)
    place = np.arange(rows * len(held)) / rows
    whole = np.minimum(place.astype(int), len(held) - 1)
    way = np.clip((place - whole) * rows / change, 0.0, 1.0)  # the load changes at the beginning of a step
    load = held[np.maximum(whole - 1, 0)] * (1 - way) + held[whole] * way
    time = np.arange(len(load)) / LOG_RATE
    deflection = springs.press(array.stiffness, SAMPLES[0], load)[2]
    clean = array.zero_signal[:, None] + array.signal_per_deflection[:, None] * deflection
    drift = LOG_DRIFT * rng.standard_normal((len(clean), 1)) * time / time[-1]
    signal = clean + drift + LOG_NOISE * rng.standard_normal(clean.shape)
    force = load + 0.002 * rng.standard_normal(len(load))
    by_number = dict(zip(array.element.tolist(), signal))
    dead = np.zeros(len(time))
    columns = [by_number.get(n, dead) for n in range(1, 11)]
    lines = [
        "# SIMULATED log, not a measured one (benchmarks/example_readings.py).",
        f"# Truth: the paper's Table 1 on {SAMPLES[0]:g} N/mm under one pad; drift +-{LOG_DRIFT * 1e3:g} mV, "
        f"noise {LOG_NOISE * 1e3:g} mV a sample.",
        "Time (s);Fz (N);" + ";".join(f"Dev1/ai{i}" for i in range(len(columns))),
    ]
    for row in zip(time, force, *columns):
        lines.append(
            ";".join([f"{row[0]:.2f}", f"{row[1]:.3f}", *(f"{v:.4f}" for v in row[2:])]).replace(".", ",")
        )
    return "\n".join(lines) + "\n"


def write(folder: Path) -> None:
    """calibration.csv, grasp.csv and grasp-log.csv."""
    rng = np.random.default_rng(SEED)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "calibration.csv").write_text(calibration_csv(rng), "utf-8")
    (folder / "grasp.csv").write_text(grasp_csv(rng), "utf-8")
    (folder / "grasp-log.csv").write_text(grasp_log(rng), "utf-8")


if __name__ == "__main__":
    write(Path(sys.argv[1]))
