"""Readings with known truth: what a calibration and a grasp would give, noise included.

For coverage tests, for the example files and for Figure 6.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Truth:
    """What the simulated array is: by element, K (N/mm), K_v (V/mm), V_0 (V)."""

    element: np.ndarray
    stiffness: np.ndarray
    signal_per_deflection: np.ndarray
    zero_signal: np.ndarray


@dataclass(frozen=True)
class Noise:
    """Standard deviations: of single readings' force (N), displacement (mm) and signal (V); and relative, of
    the reading (force, and what the signal changes by) and of a run's slopes.
    """

    force: float = 0.003
    displacement: float = 0.0005
    signal: float = 0.0005
    of_reading: float = 0.0
    of_run: float = 0.0


def calibration_rows(
    truth: Truth,
    load_cell: float,
    displacement: np.ndarray,
    runs: int,
    noise: Noise,
    rng: np.random.Generator,
    gap: float = 0.0,
) -> np.ndarray:
    """Rows of element, run, displacement (mm), force (N), signal (V): the stage presses cell and element in
    series, in each run after a way of up to `gap` (mm) through air.
    """
    share = load_cell / (load_cell + truth.stiffness)
    shape = (len(truth.element), runs, len(displacement))
    more = rng.spawn(1)[0]  # whatever a lab has besides even noise leaves the other draws as they are
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
    """By what force or signal differ from a spring's, run by run and reading by reading."""
    of_run = 1 + noise.of_run * rng.standard_normal((*shape[:2], 1))
    return of_run * (1 + noise.of_reading * rng.standard_normal(shape))


def approach(
    load: np.ndarray, stiffness: np.ndarray, object_stiffness: float, pad_height: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Approach (mm) and deflections [element, load] (mm) of elements in parallel on one sample.

    Each element in contact deflects by (z + h) x/(K + x) after equation (1), x the object's stiffness under
    one pad and h the height by which its pad stands out; one that hangs back takes no load. The sum of the
    forces is the load.
    """
    h = np.zeros_like(stiffness) if pad_height is None else pad_height
    share = object_stiffness / (stiffness + object_stiffness)
    rate = stiffness * share
    order = np.argsort(-h, kind="stable")  # the pads touch in this order
    sorted_rate, sorted_h = rate[order], h[order]
    # approach with the first n pads touching, and the one at which the next would touch
    candidate = (load[:, None] - np.cumsum(sorted_rate * sorted_h)) / np.cumsum(sorted_rate)
    following = np.append(-sorted_h[1:], np.inf)
    z = candidate[np.arange(len(load)), np.argmax(candidate <= following, axis=1)]
    return z, share[:, None] * np.maximum(z[None, :] + h[:, None], 0.0)


def coupled_deflection(
    load: np.ndarray, stiffness: np.ndarray, object_stiffness: float, share: np.ndarray
) -> np.ndarray:
    """Deflections [element, load] (mm) where each pad also sinks by share[i, j] of what the force on pad j
    does there; 1 on the diagonal.
    """
    force = np.linalg.solve(np.diag(1 / stiffness) + share / object_stiffness, np.ones(len(stiffness)))
    return np.outer(force / stiffness, load / force.sum())


def grasp_signals(
    truth: Truth,
    load: np.ndarray,
    object_stiffness: float,
    noise: float,
    rng: np.random.Generator,
    pad_height: np.ndarray | None = None,
) -> np.ndarray:
    """Signals [element, load] (V) of a grasp; noise is that of the averaged reading, V."""
    _, deflection = approach(load, truth.stiffness, object_stiffness, pad_height)
    clean = truth.zero_signal[:, None] + truth.signal_per_deflection[:, None] * deflection
    return clean + noise * rng.standard_normal(clean.shape)
