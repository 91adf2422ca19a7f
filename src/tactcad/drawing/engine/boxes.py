"""Plane geometry on the paper or in a view, mm: points, lines, upright boxes, quadrangles, what meets; and
extents of parts and placed parts from their descriptions, without a kernel.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import product
from math import cos, dist, hypot, pi, sin

import numpy as np
from numpy.typing import NDArray

from tactcad.contour import Arc, Contour, Point
from tactcad.parts.language.description import Extrusion, ModelFile, Part, Pocket, Revolution, Vector, vector
from tactcad.scenes.scene import Placement

Polyline = tuple[Point, ...]
Chord = tuple[Point, Point]
Box = tuple[float, float, float, float]  # x_min, y_min, x_max, y_max
# Lines that meet nearer to their ends than this are meant to touch there (mm of paper).
END = 0.3
Quad = tuple[Point, Point, Point, Point]


def bounds(points: Iterable[Point]) -> Box:
    """The least box that holds the points."""
    xs, ys = zip(*points)
    return (min(xs), min(ys), max(xs), max(ys))


def bounds_of(lines: Iterable[Sequence[Point]]) -> Box:
    """The least box that holds the lines."""
    return bounds(p for line in lines for p in line)


def scaled(b: Box, f: float) -> Box:
    return (b[0] * f, b[1] * f, b[2] * f, b[3] * f)


def shifted(b: Box, by: Point) -> Box:
    return (b[0] + by[0], b[1] + by[1], b[2] + by[0], b[3] + by[1])


def grown(b: Box, margin: float) -> Box:
    """The box with `margin` mm more on every side."""
    return (b[0] - margin, b[1] - margin, b[2] + margin, b[3] + margin)


def corners(b: Box) -> tuple[Point, Point, Point, Point]:
    """Counter-clockwise from the lower left."""
    return ((b[0], b[1]), (b[2], b[1]), (b[2], b[3]), (b[0], b[3]))


def overlap(a: Box, b: Box) -> bool:
    """Whether two boxes share more than an edge."""
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


def length(line: Sequence[Point]) -> float:
    """Length of a line through points, mm."""
    return sum(dist(a, b) for a, b in zip(line, line[1:]))


def crossing(a: Chord, b: Chord, end: float = END) -> bool:
    """Whether two straight pieces cross away from their ends."""
    (px, py), (qx, qy) = a
    (rx, ry), (sx, sy) = b
    ux, uy, vx, vy = qx - px, qy - py, sx - rx, sy - ry
    det = ux * vy - uy * vx
    la, lb = hypot(ux, uy), hypot(vx, vy)
    if la == 0 or lb == 0 or abs(det) < 1e-9 * la * lb:
        return False
    t = ((rx - px) * vy - (ry - py) * vx) / det * la
    s = ((rx - px) * uy - (ry - py) * ux) / det * lb
    return end < t < la - end and -1e-9 <= s <= lb + 1e-9


def quads_meet(a: Quad, b: Quad) -> bool:
    """Whether two convex quadrangles share a point: no line parallel to a side separates them."""
    ax0, ay0, ax1, ay1 = bounds(a)
    bx0, by0, bx1, by1 = bounds(b)
    if ax1 < bx0 or bx1 < ax0 or ay1 < by0 or by1 < ay0:
        return False
    return not any(_separates(side, a, b) for side in _normals(a) + _normals(b))


def chord_meets(chord: Chord, quad: Quad) -> bool:
    """Whether a straight piece shares a point with a convex quadrangle."""
    (ax, ay), (bx, by) = chord
    across = (ay - by, bx - ax)
    return not any(_separates(side, chord, quad) for side in [*_normals(quad), across])


def _normals(quad: Quad) -> list[Point]:
    return [(b[1] - a[1], a[0] - b[0]) for a, b in zip(quad[:2], quad[1:3])]


def _separates(normal: Point, a: Sequence[Point], b: Sequence[Point]) -> bool:
    on_a = [p[0] * normal[0] + p[1] * normal[1] for p in a]
    on_b = [p[0] * normal[0] + p[1] * normal[1] for p in b]
    return max(on_a) < min(on_b) or max(on_b) < min(on_a)


def clipped(chord: Chord, window: Box) -> Chord | None:
    """The part of a straight piece in a box (Liang and Barsky); None if there is none."""
    (ax, ay), (bx, by) = chord
    dx, dy = bx - ax, by - ay
    t0, t1 = 0.0, 1.0
    for d, low, high in ((dx, window[0] - ax, window[2] - ax), (dy, window[1] - ay, window[3] - ay)):
        if abs(d) < 1e-12:
            if low > 0 or high < 0:
                return None
            continue
        enter, leave = sorted((low / d, high / d))
        t0, t1 = max(t0, enter), min(t1, leave)
    if t1 - t0 < 1e-9:
        return None
    return ((ax + t0 * dx, ay + t0 * dy), (ax + t1 * dx, ay + t1 * dy))


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


def box_of(p: Placement) -> Extent:
    """Box of a placed part, in the scene; exact if it is not turned by odd angles."""
    corners = np.array([placed(p, corner) for corner in box_corners(p.part.body.box)])
    return np.array([corners.min(axis=0), corners.max(axis=0)])
