"""Hidden-line pictures of many shapes, window by window, so that time does not grow with their square.

The kernel compares every edge with every face that may hide it, and its time grows faster than the number of
shapes. In a strip of the picture only shapes that reach into it matter: each strip is drawn with those, and
its lines are cut off at its borders. (A plate as long as the picture reaches into every strip with all its
holes; that part of the time still grows with the square, and the exponent is 1.2 in all.)
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import ceil

import numpy as np
from numpy.typing import NDArray

from tactcad.account import under_way

from .boxes import Chord, Point, Polyline

Lines = tuple[list[Polyline], list[Polyline]]  # sharp, smooth

PER_WINDOW = 300  # shapes whose middle lies in one strip
OFF_GRID = 5e-4  # mm: points are given to a micrometre, borders lie half-way between


def draw_in_windows(boxes: NDArray[np.float64], draw: Callable[[NDArray[np.intp]], Lines]) -> Lines:
    """Lines of all shapes. boxes (n, 2, 2) are their least and largest corners in the picture (mm), `draw`
    gives the visible lines of some of them. The strips cross the picture's longer side."""
    size = boxes[:, 1].max(axis=0) - boxes[:, 0].min(axis=0)
    axis = int(np.argmax(size))
    low, high = boxes[:, 0, axis], boxes[:, 1, axis]
    middles = np.sort((low + high) / 2)
    count = ceil(len(boxes) / PER_WINDOW)
    borders = [np.floor(middles[len(boxes) * k // count] * 1e3) / 1e3 + OFF_GRID for k in range(1, count)]
    sharp: list[Polyline] = []
    smooth: list[Polyline] = []
    for n, (left, right) in enumerate(zip([-np.inf, *borders], [*borders, np.inf]), start=1):
        if left == right:
            continue
        under_way(f"strip {n} of {count}")
        for lines, kept in zip(draw(np.flatnonzero((low <= right) & (high >= left))), (sharp, smooth)):
            kept += [piece for line in lines for piece in clipped(line, axis, left, right)]
    return sharp, smooth


def clipped(line: Polyline, axis: int, left: float, right: float) -> Iterator[Polyline]:
    """The pieces of a line between two borders, to a micrometre; none that is a point."""
    piece: list[Point] = []
    for a, b in zip(line, line[1:]):
        inside = _within(a, b, axis, left, right)
        if inside is None:
            continue
        start, end = inside
        if piece and piece[-1] != start:
            yield tuple(piece)
            piece = []
        piece = piece or [start]
        if end != piece[-1]:
            piece.append(end)
    if len(piece) > 1:
        yield tuple(piece)


def _within(a: Point, b: Point, axis: int, left: float, right: float) -> Chord | None:
    """Both ends of what lies between the borders of the segment from a to b, None where nothing does."""
    p, q = a[axis], b[axis]
    if max(p, q) < left or min(p, q) > right:
        return None

    def moved(c: float) -> Point:
        limit = min(max(c, left), right)
        if limit == c:
            return a if c == p else b
        share = (limit - p) / (q - p)
        x, y = (round(u + share * (v - u), 3) + 0.0 for u, v in zip(a, b))
        return (x, y)

    return moved(p), (b if p == q else moved(q))
