"""Contacts between rigid parts, solved as small linear programs, many arrays at a time."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.optimize import linprog

from tactcad.mechanics.section import Array

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
            A_ub=sparse.kron(sparse.eye_array(m), sparse.csr_array(design), format="csr"),
            b_ub=some.ravel(),
            bounds=bounds * m,
            method="highs",
        )
        if result.status != 0:
            raise RuntimeError(f"contacts of arrays {start} to {start + m}: {result.message}")
        solved.append(result.x.reshape(m, -1) * scale)
    return np.vstack(solved)
