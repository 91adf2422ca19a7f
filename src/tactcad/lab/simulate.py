"""Simulated readings of a calibration and a grasp, with noise, for an array of known true values.

For coverage tests, for the example files and for Figure 6.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Truth:
    """The simulated array's true values; arrays, [element]."""

    element: np.ndarray  # numbers
    stiffness: np.ndarray  # K, N/mm
    signal_per_deflection: np.ndarray  # K_v, V/mm
    zero_signal: np.ndarray  # V_0, V


@dataclass(frozen=True)
class Noise:
    """Standard deviations."""

    force: float = 0.003  # N, of a reading
    displacement: float = 0.0005  # mm, of a reading
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


def approach(
    load: np.ndarray, stiffness: np.ndarray, object_stiffness: float, pad_height: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Approach and deflections of elements in parallel on one sample.

    By equation (1) an element in contact deflects by (z + h) x/(K + x), with z the approach and x the
    object's stiffness under one pad; one that is not yet in contact carries no load. The forces add up to
    the load.

    Parameters
    ----------
    load : array, [load]
        N.
    stiffness : array, [element]
        K, N/mm.
    object_stiffness : float
        x, N/mm.
    pad_height : array, [element], optional
        h: height of each pad over the plane, mm; by default all are level.

    Returns
    -------
    z : array, [load]
        mm.
    deflection : array, [element, load]
        mm.
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
    """Signals (V) of a grasp, [element, load]: those of `approach`'s deflections, with a standard deviation
    of `noise` (V, of the averaged reading)."""
    _, deflection = approach(load, truth.stiffness, object_stiffness, pad_height)
    clean = truth.zero_signal[:, None] + truth.signal_per_deflection[:, None] * deflection
    return clean + noise * rng.standard_normal(clean.shape)
