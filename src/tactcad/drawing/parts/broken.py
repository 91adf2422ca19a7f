"""Omitted parts of views, with break lines (ISO 128-3): a detail all around its window, a broken view of a
long part the stretches between its features.

Dimensions keep the whole part's values, and their lines run unbroken (ISO 129-1): only places on the paper
move.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

from tactcad.contour import Line
from tactcad.parts.language.description import Part, drill_point_height

from ..engine.boxes import Box, Chord, Point, bounds, clipped
from ..engine.ink import THIN, Curve, DrawnArc, Hatch, Stroke
from .measures import Owner, Round, contours, widest
from .sheet_plan import Breaks, SheetPlan, View

LEAST_LEFT_OUT = 1 / 3  # of a part's length: less is not worth a broken view
MARGIN = 1 / 2  # share of the part's width shown on either side of every feature
LEAST_MARGIN = 1 / 100  # of its length, for narrow parts
GAP = 1 / 40  # between two break lines, of the length that is shown: 2 to 5 mm of paper
FAR = 1e9  # mm: beyond any part


def breaks_of(part: Part, holes: Sequence[Round], regular: Collection[Owner]) -> Breaks | None:
    """Breaks in views of an extruded part along the longer side of its outline; None if they would leave out
    too little. Holes that are `regular` need not be shown, because they repeat others."""
    box = part.extrusion.outer.box
    sides = (box[2] - box[0], box[3] - box[1])
    axis = 0 if sides[0] > sides[1] else 1
    length, width = sides[axis], sides[1 - axis]
    margin = max(MARGIN * width, LEAST_MARGIN * length)
    end = box[axis]
    left_out = []
    for low, high in sorted(_features(part, holes, regular, axis)):
        if low - end - 2 * margin > margin:
            left_out.append((end + margin, low - margin))
        end = max(end, high)
    left = sum(high - low for low, high in left_out)
    if left < LEAST_LEFT_OUT * length:
        return None
    return Breaks(axis, tuple(left_out), GAP * (length - left))


def _features(
    part: Part, holes: Sequence[Round], regular: Collection[Owner], axis: int
) -> list[tuple[float, float]]:
    """Ranges along an axis with more than edges parallel to it."""
    extents = []
    for owner, contour in contours(part):
        if contour.as_circle() and any(hole.owner == owner for hole in holes):
            continue
        for s in contour:
            start, end = sorted((s.start[axis], s.end[axis]))
            if not isinstance(s, Line):
                extents.append((s.centre[axis] - s.radius, s.centre[axis] + s.radius))
            elif abs(s.start[1 - axis] - s.end[1 - axis]) < 1e-9:
                extents += [(start, start), (end, end)]
            else:
                extents.append((start, end))
    for r in holes:
        if r.owner in regular:
            continue
        half = 0.0 if r.axis[axis] else widest(r.hole) / 2
        deep = r.at[axis] + r.axis[axis] * (r.hole.depth + drill_point_height(r.hole.diameter))
        low, high = sorted((r.at[axis], deep if r.axis[axis] else r.at[axis]))
        extents.append((low - half, high + half))
    return extents


def broken(
    plan: SheetPlan, curves: Mapping[str, Sequence[Curve]]
) -> tuple[SheetPlan, Mapping[str, Sequence[Curve]]]:
    """The plan and the curves of its views, by name, without what the plan's breaks leave out."""
    if plan.breaks is None:
        return plan, curves
    views = tuple(_Squeezed(v, plan.breaks).view() for v in plan.views)
    squeezed = {v.name: _Squeezed(v, plan.breaks).curves(curves[v.name]) for v in plan.views}
    return replace(plan, views=views), squeezed


class _Squeezed:
    """One view, shortened by the breaks."""

    def __init__(self, whole: View, breaks: Breaks) -> None:
        self.whole, self.breaks = whole, breaks
        signs = (whole.right[breaks.axis], whole.up[breaks.axis])
        # the paper's axis along which the view is broken, None for a view along the part's long axis
        self.k = next((i for i, sign in enumerate(signs) if sign), None)
        self.sign = signs[self.k] if self.k is not None else 1.0

    def moved(self, p: Point) -> Point:
        if self.k is None:
            return p
        along = self.sign * self.breaks.squeezed(self.sign * p[self.k])
        return (along, p[1]) if self.k == 0 else (p[0], along)

    def shows(self, p: Point) -> bool:
        return self.k is None or self.breaks.shows(self.sign * p[self.k])

    def view(self) -> View:
        v, moved = self.whole, self.moved
        x0, y0, x1, y1 = v.box
        section = v.section
        if section:
            bores = tuple(
                replace(b, face=moved(b.face), end=moved(b.end), threaded=self._chord(b.threaded))
                for b in section.bores
                if self.shows(b.face)
            )
            at = self.breaks.squeezed(section.at) if section.axis == self.breaks.axis else section.at
            section = replace(section, at=at, bores=bores)
        callouts = []
        for c in v.callouts:
            shown = [n for n, (p, _) in enumerate(c.targets) if self.shows(p)]
            targets = tuple((moved(c.targets[n][0]), c.targets[n][1]) for n in shown)
            spans = tuple(c.spans[n] for n in shown) if c.spans else ()
            callouts.append(replace(c, targets=targets, spans=spans))
        pieces = [(d, clipped((d.start, d.end), band)) for d in v.datums for band in self._bands()]
        return replace(
            v,
            box=(*moved((x0, y0)), *moved((x1, y1))),
            linears=tuple(replace(d, p=moved(d.p), q=moved(d.q)) for d in v.linears),
            runnings=tuple(replace(r, stops=tuple((d, moved(p)) for d, p in r.stops)) for r in v.runnings),
            callouts=tuple(callouts),
            datums=tuple(replace(d, start=moved(p[0]), end=moved(p[1])) for d, p in pieces if p),
            centres=tuple((moved(p), d) for p, d in v.centres if self.shows(p)),
            threads=tuple((moved(p), d) for p, d in v.threads if self.shows(p)),
            axes=tuple(map(self._chord, v.axes)),
            section=section,
        )

    def _chord(self, chord: Chord) -> Chord:
        return self.moved(chord[0]), self.moved(chord[1])

    def _bands(self) -> list[Box]:
        """The shown parts of the view's plane."""
        if self.k is None:
            return [(-FAR, -FAR, FAR, FAR)]
        ends = [self.sign * end for gap in self.breaks.left_out for end in gap]
        stops = sorted([-FAR, *ends, FAR])
        shown = zip(stops[::2], stops[1::2])
        return [(a, -FAR, b, FAR) if self.k == 0 else (-FAR, a, FAR, b) for a, b in shown]

    def curves(self, whole: Sequence[Curve]) -> list[Curve]:
        """The view's curves between the breaks, and the break lines."""
        return [*(piece for c in whole for piece in self._pieces(c)), *self._break_lines(whole)]

    def _pieces(self, curve: Curve) -> list[Curve]:
        moved = self.moved
        if isinstance(curve, Hatch):
            loops = [_cut_off(loop, band) for band in self._bands() for loop in curve.loops]
            return [replace(curve, loops=tuple(tuple(map(moved, loop)) for loop in loops if loop))]
        if isinstance(curve, DrawnArc) and all(self.shows(p) for chord in curve.chords() for p in chord):
            return [replace(curve, centre=moved(curve.centre))] if self.shows(curve.centre) else []
        pieces = (clipped(chord, band) for band in self._bands() for chord in fine(curve))
        return [Stroke(self._chord(piece), curve.line, curve.role) for piece in filter(None, pieces)]

    def _break_lines(self, whole: Sequence[Curve]) -> list[Curve]:
        """Two lines with a zigzag at each gap, across all edges that it cuts."""
        if self.k is None:
            return []
        k, gap, lines = self.k, self.breaks.gap, []
        for end in (end for left_out in self.breaks.left_out for end in left_out):
            at, across = self.sign * end, []
            for a, b in (chord for c in whole if c.role == "outline" for chord in c.chords()):
                if (a[k] - at) * (b[k] - at) < 0:
                    across.append(a[1 - k] + (at - a[k]) / (b[k] - a[k]) * (b[1 - k] - a[1 - k]))
            if across:
                low, high = min(across), max(across)
                z = min(0.6 * gap, (high - low) / 4)
                place = self.sign * self.breaks.squeezed(end)
                lines.append(_zigzag(place, k, low, high, z, min(0.3 * gap, z), 0.5 * gap))
        return lines


def _zigzag(at: float, k: int, low: float, high: float, z: float, w: float, past: float = 0.0) -> Curve:
    """A break line at a place of the paper's axis k, z high and w wide in the middle, `past` its ends."""
    m = (low + high) / 2
    track = [
        (0.0, low - past),
        (0.0, m - z),
        (w, m - z / 2),
        (-w, m + z / 2),
        (0.0, m + z),
        (0.0, high + past),
    ]
    return Stroke(tuple((at + u, v) if k == 0 else (v, at + u) for u, v in track), THIN, "leader")


def _cut_off(loop: Sequence[Point], band: Box) -> tuple[Point, ...]:
    """The part of a closed polygon in a box (Sutherland and Hodgman); empty if there is none."""
    points = list(loop)
    for k, limit, way in ((0, band[0], 1), (0, band[2], -1), (1, band[1], 1), (1, band[3], -1)):
        kept: list[Point] = []
        for a, b in pairwise([*points, *points[:1]]):
            inside_a, inside_b = way * (a[k] - limit) >= 0, way * (b[k] - limit) >= 0
            if inside_a:
                kept.append(a)
            if inside_a != inside_b:
                share = (limit - a[k]) / (b[k] - a[k])
                crossing = a[1 - k] + share * (b[1 - k] - a[1 - k])
                kept.append((limit, crossing) if k == 0 else (crossing, limit))
        points = kept
    return tuple(points)


def windowed(curves: Sequence[Stroke | DrawnArc], window: Box) -> list[Curve]:
    """The part of the curves in the window, with break lines where it cuts through the material."""
    x0, y0, x1, y1 = window
    shown: list[Curve] = []
    ends: list[Point] = []  # of cut edges
    for curve in curves:
        points = [p for chord in curve.chords() for p in chord]
        u0, v0, u1, v1 = bounds(points)
        if u1 < x0 or u0 > x1 or v1 < y0 or v0 > y1:  # of 40 cells a detail shows one
            continue
        if isinstance(curve, DrawnArc) and all(x0 <= x <= x1 and y0 <= y <= y1 for x, y in points):
            shown.append(curve)
            continue
        cuts = [cut for chord in fine(curve) if (cut := clipped(chord, window))]
        shown += [Stroke(cut, curve.line, curve.role) for cut in cuts]
        ends += [p for cut in cuts for p in cut if curve.role == "outline"]
    for fixed, k in ((x0, 0), (x1, 0), (y0, 1), (y1, 1)):
        along = sorted({round(p[1 - k], 6) for p in ends if abs(p[k] - fixed) < 1e-9})
        for low, high in zip(along[::2], along[1::2]):
            z = min((high - low) / 8, (x1 - x0) / 40)
            shown.append(_zigzag(fixed, k, low, high, z, z))
    return shown


def fine(curve: Stroke | DrawnArc) -> Sequence[Chord]:
    """A curve as straight pieces to be clipped."""
    if isinstance(curve, Stroke):
        return curve.chords()
    points = [curve.at(curve.start + curve.sweep * i / 64) for i in range(65)]
    return list(zip(points, points[1:]))
