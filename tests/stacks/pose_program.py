"""A rigid body that is to meet heights, as a linear program: the other way for what stands on four wheels."""

from __future__ import annotations

import numpy as np

from tactcad.mechanics.section import Array
from tactcad.stacks.mechanic import _blocks


def nearest_pose(points: Array, heights: Array, play: Array) -> Array:
    """Pose of a rigid body whose points are to meet given heights, each within its own play.

    Parameters
    ----------
    points
        (n, 2) places of the points, mm.
    heights
        (arrays, n) heights to meet, mm.
    play
        (arrays, n) by how much each may miss its height, either way, mm.

    Returns
    -------
    Array
        (arrays, 4): height at the origin, slopes along both axes, and by how much the worst point misses
        beyond its play; that is least, and 0 where all meet. Where the points leave a choice, it is level.
    """
    n = len(points)
    plane = np.column_stack([np.ones(n), points])
    miss, none = -np.ones((n, 1)), np.zeros((n, 2))
    slopes, off = np.eye(3)[1:], -np.eye(2)
    design = np.vstack(
        [
            np.hstack([plane, miss, none]),
            np.hstack([-plane, miss, none]),
            np.hstack([slopes, np.zeros((2, 1)), off]),
            np.hstack([-slopes, np.zeros((2, 1)), off]),
        ]
    )
    limits = np.hstack([heights + play, play - heights, np.zeros((len(heights), 4))])
    free, more = (None, None), (0.0, None)
    cost = [0.0, 0.0, 0.0, 1.0, LEVEL, LEVEL]
    return _blocks(design, limits, cost, [free, free, free, more, more, more])[:, :4]


# Weight of a slope off level, mm for each mm/mm: beside what misses it only decides between equals.
LEVEL = 1e-2
