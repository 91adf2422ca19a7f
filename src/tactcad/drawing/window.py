"""What a detail's window shows of a view: curves clipped to it, with break lines where it cuts through the
material."""

from __future__ import annotations

from collections.abc import Sequence

from .boxes import Box, Chord, Point
from .ink import THIN, DrawnArc, Stroke


def windowed(curves: Sequence[Stroke | DrawnArc], window: Box) -> list[Stroke | DrawnArc]:
    """What of the curves lies in the window, and thin lines where it cuts through the material."""
    kept: list[Stroke | DrawnArc] = []
    ends: list[Point] = []
    for curve in curves:
        if isinstance(curve, DrawnArc) and all(_inside(p, window) for chord in curve.chords() for p in chord):
            kept.append(curve)
            continue
        chords = fine(curve) if isinstance(curve, DrawnArc) else curve.chords()
        for chord in chords:
            cut = clipped(chord, window)
            if cut:
                kept.append(Stroke(cut, curve.line, curve.role))
                ends += [p for p in cut if curve.role == "outline" and _on_edge(p, window)]
    return kept + _breaks(ends, window)


def fine(arc: DrawnArc) -> list[Chord]:
    """An arc as straight pieces to be clipped."""
    points = [arc.at(arc.start + arc.sweep * i / 64) for i in range(65)]
    return list(zip(points, points[1:]))


def _breaks(ends: Sequence[Point], window: Box) -> list[Stroke | DrawnArc]:
    """Break lines between pairs of cut edges on each side of the window, with a zigzag in the middle."""
    x0, y0, x1, y1 = window
    lines: list[Stroke | DrawnArc] = []
    for fixed, k in ((x0, 0), (x1, 0), (y0, 1), (y1, 1)):
        along = sorted({round(p[1 - k], 6) for p in ends if abs(p[k] - fixed) < 1e-9})
        for low, high in zip(along[::2], along[1::2]):
            m, z = (low + high) / 2, min((high - low) / 8, (x1 - x0) / 40)
            track = [(0, low), (0, m - z), (z, m - z / 2), (-z, m + z / 2), (0, m + z), (0, high)]
            points = tuple((fixed + u, v) if k == 0 else (v, fixed + u) for u, v in track)
            lines.append(Stroke(points, THIN, "leader"))
    return lines


def clipped(chord: Chord, window: Box) -> Chord | None:
    """What of a straight piece lies in a box (Liang and Barsky); None where nothing does."""
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


def _inside(p: Point, window: Box) -> bool:
    return window[0] <= p[0] <= window[2] and window[1] <= p[1] <= window[3]


def _on_edge(p: Point, window: Box) -> bool:
    return min(abs(p[k % 2] - window[k]) for k in range(4)) < 1e-9
