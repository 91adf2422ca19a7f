"""Where a part looks the same from one place to the next: along a rod, a plate's edge, a bar.

If everything of part A near part B stays the same while B moves along one of A's axes, all these places
have one verdict: a long array then needs as few verdicts of the kernel as a short one. Read from the
descriptions.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Sequence

import numpy as np

from tactcad.contour import Contour, Line
from tactcad.parts.description import Extrusion, Feature, Hole, Part, Revolution, drill_point_height

# What lies within this distance (mm) of the other part counts as near it: far more than what counts as
# touching.
NEAR_MM = 0.1

Zones = tuple[tuple[float, float], ...]


def zones(part: Part) -> tuple[Zones, Zones, Zones] | None:
    """Along x, y and z of the part's own frame: the intervals (mm) in which its shape changes; merged and
    sorted.

    None where the shape is not known from a description.
    """
    body = part.body
    if isinstance(body, Extrusion):
        contours = (body.outer, *body.openings)
        along = [_along(contours, 0), _along(contours, 1), [(0.0, 0.0), (body.thickness, body.thickness)]]
    elif isinstance(body, Revolution):
        radius = body.profile.box[2]
        along = [[(-radius, radius)], [(-radius, radius)], _along((body.profile,), 1)]
    else:
        return None
    for feature in part.features:
        low, high = feature_box(feature)
        for k in range(3):
            along[k].append((float(low[k]), float(high[k])))
    x, y, z = (_merged(intervals) for intervals in along)
    return x, y, z


def _along(contours: Iterable[Contour], axis: int) -> list[tuple[float, float]]:
    """A line along the axis changes at its ends only; every other segment over its whole extent."""
    intervals = []
    for s in (s for c in contours for s in c):
        if isinstance(s, Line) and s.start[1 - axis] == s.end[1 - axis]:
            intervals += [(s.start[axis], s.start[axis]), (s.end[axis], s.end[axis])]
        elif isinstance(s, Line):
            low, high = sorted((s.start[axis], s.end[axis]))
            intervals.append((low, high))
        else:  # the whole circle: more than the arc, and simple
            intervals.append((s.centre[axis] - s.radius, s.centre[axis] + s.radius))
    return intervals


def feature_box(feature: Feature) -> tuple[np.ndarray, np.ndarray]:
    """Least and largest corner (mm) of a box around what a feature takes off."""
    at, axis = np.array(feature.at, float), np.array(feature.axis, float)
    if isinstance(feature, Hole):
        depth = feature.depth + (drill_point_height(feature.diameter) if feature.drill_point else 0.0)
        radius = max(feature.diameter, feature.counterbore[0] if feature.counterbore else 0.0) / 2
        ends = np.array([at, at + depth * axis])
        across = radius * np.sqrt(np.maximum(0.0, 1.0 - axis**2))  # a disc's reach along each axis
        return ends.min(axis=0) - across, ends.max(axis=0) + across
    x_axis = np.array(feature.x_axis, float)
    y_axis = np.cross(axis, x_axis)
    x0, y0, x1, y1 = feature.contour.box
    corners = np.array(
        [
            at + x * x_axis + y * y_axis + d * axis
            for x in (x0, x1)
            for y in (y0, y1)
            for d in (0.0, feature.depth)
        ]
    )
    return corners.min(axis=0), corners.max(axis=0)


def _merged(intervals: Sequence[tuple[float, float]]) -> Zones:
    merged: list[tuple[float, float]] = []
    for low, high in sorted(intervals):
        if merged and low <= merged[-1][1]:
            merged[-1] = (merged[-1][0], max(merged[-1][1], high))
        else:
            merged.append((low, high))
    return tuple(merged)


def stretch(along: Zones, low: float, high: float) -> int | None:
    """Which stretch between zones holds low to high with NEAR_MM around it (mm); None where a zone is
    near."""
    n = bisect_left(along, (low - NEAR_MM, -np.inf))
    before = along[n - 1][1] < low - NEAR_MM if n else True
    after = along[n][0] > high + NEAR_MM if n < len(along) else True
    return n if before and after else None
