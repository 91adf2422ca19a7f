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
    """Standard deviations of single readings: force (N), displacement (mm), signal (V)."""

    force: float = 0.003
    displacement: float = 0.0005
    signal: float = 0.0005


def calibration_rows(
    truth: Truth,
    load_cell: float,
    displacement: np.ndarray,
    runs: int,
    noise: Noise,
    rng: np.random.Generator,
) -> np.ndarray:
    """Rows of element, run, displacement (mm), force (N), signal (V): the stage presses cell and
    element in series.
    """
    share = load_cell / (load_cell + truth.stiffness)
    shape = (len(truth.element), runs, len(displacement))
    moved = displacement + noise.displacement * rng.standard_normal(shape)
    deflection = share[:, None, None] * moved
    force = truth.stiffness[:, None, None] * deflection + noise.force * rng.standard_normal(shape)
    signal = (
        truth.zero_signal[:, None, None]
        + truth.signal_per_deflection[:, None, None] * deflection
        + noise.signal * rng.standard_normal(shape)
    )
    element, run, step = np.broadcast_arrays(
        truth.element[:, None, None], np.arange(1, runs + 1)[None, :, None], displacement[None, None, :]
    )
    return np.column_stack([a.ravel() for a in (element, run, step, force, signal)])


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
