"""The object as a separate spring under every pad: the paper's equations (1) to (3), with pads that touch
late and stops that close."""

from __future__ import annotations

from math import inf

import numpy as np


def press(
    K: np.ndarray,
    object_stiffness: float,
    load: np.ndarray,
    back: np.ndarray | float = 0.0,
    stop: np.ndarray | float = inf,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Elements pressed by a total load, each on a spring of its own.

    By equation (1) an element in contact sinks by z x/(K + x) under an approach of z past its touch, x the
    object's stiffness; stopped, it leaves the object's spring alone. The forces' sum is piecewise linear.

    Parameters
    ----------
    K : ndarray, [element]
        N/mm.
    object_stiffness
        x, of each spring, N/mm: that of the object under one pad.
    load : ndarray, [load]
        N.
    back : ndarray, [element]
        How far the face lies back from each pad, mm; by default all are level.
    stop : ndarray, [element]
        Sink at which each element is stopped, mm; inf without.

    Returns
    -------
    approach, force, sink
        mm, [load]; N and mm, [element, load].
    """
    x, share = object_stiffness, object_stiffness / (K + object_stiffness)
    back, stop = (np.broadcast_to(v, K.shape) for v in (back, stop))
    at = np.concatenate([back, back + stop / share])  # where each touches, and where each is stopped
    order = np.argsort(at, kind="stable")[: np.isfinite(at).sum()]
    at, slope = at[order], np.cumsum(np.concatenate([K * share, x - K * share])[order])
    total = np.concatenate([[0.0], np.cumsum(slope[:-1] * np.diff(at))])
    piece = np.maximum(np.searchsorted(total, load, side="right") - 1, 0)
    approach = at[piece] + (load - total[piece]) / slope[piece]
    depth = np.maximum(approach - back[:, None], 0.0)
    sink = np.minimum(share[:, None] * depth, stop[:, None])
    return approach, K[:, None] * sink + x * np.maximum(depth - (stop / share)[:, None], 0.0), sink
