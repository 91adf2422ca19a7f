"""The object as a separate spring under every pad: the paper's equations (1) to (3), with pads that touch
late and stops that close."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq


def press(
    K: np.ndarray, back: np.ndarray, stop: np.ndarray, object_stiffness: float, load: float
) -> tuple[float, np.ndarray, np.ndarray]:
    """Elements pressed by a total load, each on a spring of its own.

    Parameters
    ----------
    K : ndarray, [element]
        N/mm.
    back : ndarray, [element]
        How far the face lies back from each pad, mm.
    stop : ndarray, [element]
        Sink at which each element is stopped, mm; inf without.
    object_stiffness
        Of each spring, N/mm: that of the object under one pad.
    load
        N.

    Returns
    -------
    approach, force, sink
        mm; N and mm, [element].
    """

    def sinks(approach: float) -> np.ndarray:
        free = np.maximum(approach - back, 0.0) * object_stiffness / (K + object_stiffness)
        return np.minimum(free, stop)

    def forces(approach: float) -> np.ndarray:
        return object_stiffness * np.maximum(approach - back - sinks(approach), 0.0)

    first = float(back.min())
    # one element bears all of it at the most: on its own spring, free to sink
    furthest = first + load * (1 / object_stiffness + 1 / float(K.min()))
    approach = float(brentq(lambda at: forces(at).sum() - load, first, furthest, xtol=1e-15, rtol=1e-14))
    return approach, forces(approach), sinks(approach)
