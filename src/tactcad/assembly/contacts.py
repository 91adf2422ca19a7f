"""Contacts between rigid parts, solved as small linear programs, many arrays at a time."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.optimize import linprog

from .variables import Array

BLOCK = 2000  # rows of one program: below that a call's own cost, above it the solver's growth, tells


def resting_plane(points: Array, heights: Array) -> Array:
    """The plane that rests on points, pressed down in the middle of them.

    Parameters
    ----------
    points
        (n, 2) places of the points, mm; the pressing force goes through their origin.
    heights
        (arrays, n) heights of the points, mm.

    Returns
    -------
    Array
        (arrays, 3): height at the origin and slopes along both axes, so that the plane is nowhere below a
        point and as low at the origin as it can be; of planes that rock over two points, the one that is
        nowhere far above any.
    """
    n = len(points)
    plane = np.column_stack([np.ones(n), points])
    most = np.ones((n, 1))  # the largest distance over a point, which only decides between equals
    design = np.vstack([np.hstack([-plane, 0.0 * most]), np.hstack([plane, -most])])
    free = (None, None)
    limits = np.hstack([-heights, heights])
    return _blocks(design, limits, [1.0, 0.0, 0.0, ROCKING], [free, free, free, free])[:, :3]


ROCKING = 1e-3


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
        beyond its play; that is least, and 0 where all meet.
    """
    n = len(points)
    plane = np.column_stack([np.ones(n), points])
    miss = -np.ones((n, 1))
    design = np.vstack([np.hstack([plane, miss]), np.hstack([-plane, miss])])
    limits = np.hstack([heights + play, play - heights])
    free = (None, None)
    return _blocks(design, limits, [0.0, 0.0, 0.0, 1.0], [free, free, free, (0.0, None)])


def _blocks(design: Array, limits: Array, cost: list[float], bounds: list[tuple]) -> Array:
    """Solutions x of: least cost x with design x <= limits, for every row of `limits`."""
    at_once = max(1, BLOCK // len(design))
    solved = []
    scale = max(
        float(np.abs(limits).max()), 1e-9
    )  # solvers' own tolerances are 1e-7: micrometres become ones
    for start in range(0, len(limits), at_once):
        some = limits[start : start + at_once] / scale
        m = len(some)
        result = linprog(
            np.tile(cost, m),
            A_ub=sparse.block_diag([design] * m, format="csr"),
            b_ub=some.ravel(),
            bounds=bounds * m,
            method="highs",
        )
        if result.status != 0:
            raise RuntimeError(f"contacts of arrays {start} to {start + m}: {result.message}")
        solved.append(result.x.reshape(m, -1) * scale)
    return np.vstack(solved)
