"""Contacts against other routes: planes through every three points, and a general minimiser."""

from itertools import combinations

import numpy as np
import pytest
from pose_program import nearest_pose
from scipy.optimize import minimize

from tactcad.stacks.mechanic import resting_plane

RNG = np.random.default_rng(7)
POINTS = np.array([[x, y] for x in (-9.0, 9.0) for y in (-8.0, -4.0, 0.0, 4.0, 8.0)])


def lowest_of_all_triples(points, heights):
    """The plane through three points that is nowhere below another, lowest at the origin."""
    best = None
    for three in combinations(range(len(points)), 3):
        a = np.column_stack([np.ones(3), points[list(three)]])
        if abs(np.linalg.det(a)) < 1e-9:
            continue
        plane = np.linalg.solve(a, heights[list(three)])
        if (plane[0] + points @ plane[1:] >= heights - 1e-12).all() and (best is None or plane[0] < best[0]):
            best = plane
    return best


def test_a_plate_rests_as_the_lowest_of_all_planes_through_three_points():
    heights = RNG.normal(0.0, 0.005, (40, len(POINTS)))
    planes = resting_plane(POINTS, heights)
    for plane, own in zip(planes, heights):
        other = lowest_of_all_triples(POINTS, own)
        assert plane[0] == pytest.approx(other[0], abs=1e-9)
        assert ((plane[0] + POINTS @ plane[1:]) >= own - 1e-9).all()


def test_a_plate_on_a_plane_lies_on_it():
    plane = np.array([[0.01, 2e-4, -3e-4]])
    assert resting_plane(POINTS, plane[:, :1] + plane[:, 1:] @ POINTS.T) == pytest.approx(plane, abs=1e-9)


def test_the_nearest_pose_misses_least():
    """Against a general minimiser, a smooth norm of high order in place of the largest miss."""
    heights = RNG.normal(0.0, 0.01, (12, len(POINTS)))
    play = RNG.uniform(0.002, 0.008, heights.shape)
    poses = nearest_pose(POINTS, heights, play)
    for pose, own, free in zip(poses, heights, play):
        off = np.abs(pose[0] + POINTS @ pose[1:3] - own) - free
        assert max(0.0, off.max()) == pytest.approx(pose[3], abs=1e-9)

        def miss(x, own=own, free=free):
            return (np.abs(x[0] + POINTS @ x[1:] - own) - free).max()

        tries = [
            minimize(miss, s, method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-10, "maxiter": 8000})
            for s in (np.zeros(3), pose[:3], RNG.normal(0, 1e-3, 3))
        ]
        assert pose[3] <= max(0.0, min(t.fun for t in tries)) + 1e-8


def test_within_their_play_all_meet():
    heights = RNG.uniform(-0.004, 0.004, (5, len(POINTS)))
    assert nearest_pose(POINTS, heights, np.full(heights.shape, 0.0041))[:, 3] == pytest.approx(0.0, abs=1e-9)


def test_many_arrays_give_what_each_gives_alone():
    heights = RNG.normal(0.0, 0.01, (450, len(POINTS)))
    together = resting_plane(POINTS, heights)[:, 0]
    assert together[[0, 201, 449]] == pytest.approx(
        [resting_plane(POINTS, heights[[i]])[0, 0] for i in (0, 201, 449)], abs=1e-9
    )
