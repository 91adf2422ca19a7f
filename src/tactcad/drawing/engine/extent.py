"""Extents of parts and placed parts from their descriptions, without a kernel."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import product
from math import cos, pi, sin

import numpy as np
from numpy.typing import NDArray

from tactcad.contour import Arc, Contour, Point
from tactcad.parts.language.description import Extrusion, ModelFile, Part, Pocket, Revolution, Vector, vector
from tactcad.scenes.scene import Placement

from .boxes import Box, bounds

_STEPS = 96  # points on a full turn: within 0.6 permille of the radius
Extent = np.ndarray  # least and largest corner, (2, 3), mm


def projected_box(placements: Iterable[Placement], right: Vector, eye: Vector) -> Box:
    """x_min, y_min, x_max, y_max (mm) of the placed parts as seen from `eye`, with `right` to the right.

    A model file counts with its box, which may be seen larger than the model.
    """
    (ex, ey, ez), (rx, ry, rz) = eye, right
    up = (ey * rz - ez * ry, ez * rx - ex * rz, ex * ry - ey * rx)
    size = _dot(up, up) ** 0.5
    up = (up[0] / size, up[1] / size, up[2] / size)
    axes = np.array([right, up])
    points: dict[str, NDArray[np.float64]] = {}
    spans: dict[tuple, Box] = {}  # equal parts with equal rotation differ by their place only
    corners = []
    for p in placements:
        key = (p.part.part_no, p.rotation)
        if key not in spans:
            if p.part.part_no not in points:
                points[p.part.part_no] = np.array(list(_surface_points(p.part)))
            seen = points[p.part.part_no] @ (axes @ np.array(p.rotation)).T
            spans[key] = (*seen.min(axis=0).tolist(), *seen.max(axis=0).tolist())
        x, y = _dot(p.origin, right), _dot(p.origin, up)
        x0, y0, x1, y1 = spans[key]
        corners += [(x + x0, y + y0), (x + x1, y + y1)]
    return bounds(corners)


def placed(p: Placement, point: Vector) -> Vector:
    """A point of the part's own frame, in the scene (mm)."""
    return vector(_dot(row, point) + o for row, o in zip(p.rotation, p.origin))


def moved_by(p: Placement, way: Sequence[float], digits: int = 9) -> Placement:
    """The placement elsewhere (mm), its place rounded."""
    return replace(p, origin=vector(round(o + float(w), digits) for o, w in zip(p.origin, way)))


def _surface_points(part: Part) -> Iterator[Vector]:
    body = part.body
    if isinstance(body, Extrusion):
        # a pocket may take the whole section off the foot (z = 0) but for its islands: a land or a shaft
        pockets = [f for f in part.features if isinstance(f, Pocket) and f.at == (0, 0, 0)]
        foot = next((f for f in pockets if f.contour == body.outer), None)
        for x, y in _curve_points(body.outer):
            yield (x, y, foot.depth if foot else 0.0)
            yield (x, y, body.thickness)
        for island in foot.island if foot else ():
            yield from ((x, y, 0.0) for x, y in _curve_points(island))
    elif isinstance(body, ModelFile):
        yield from box_corners(body.box)
    elif isinstance(body, Revolution):
        for r, z in _curve_points(body.profile):
            for k in range(_STEPS):
                yield (r * cos(2 * pi * k / _STEPS), r * sin(2 * pi * k / _STEPS), z)


def _curve_points(contour: Contour) -> Iterator[Point]:
    for s in contour:
        steps = max(1, round(abs(s.sweep) / (2 * pi) * _STEPS)) if isinstance(s, Arc) else 1
        for k in range(steps):
            yield s.at(k / steps)


def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def box_corners(box: tuple[Vector, Vector]) -> Iterator[Vector]:
    """The eight corners of a box between its least and its largest."""
    (x0, y0, z0), (x1, y1, z1) = box
    return product((x0, x1), (y0, y1), (z0, z1))


def part_box(part: Part) -> tuple[Vector, Vector]:
    """Least and largest corner of a part in its own frame, mm, exact."""
    return part.body.box


def box_of(p: Placement) -> Extent:
    """Box of a placed part, in the scene; exact if it is not turned by odd angles."""
    corners = np.array([placed(p, corner) for corner in box_corners(part_box(p.part))])
    return np.array([corners.min(axis=0), corners.max(axis=0)])
