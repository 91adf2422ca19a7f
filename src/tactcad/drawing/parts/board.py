"""A sheet in composition: its items, and the search for free places for texts and leaders."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import cos, hypot, radians, sin

import numpy as np

from ..engine.boxes import (
    Box,
    Chord,
    Point,
    Quad,
    bounds,
    bounds_of,
    chord_meets,
    corners,
    grown,
    overlap,
    quads_meet,
    shifted,
)
from ..engine.ink import (
    LETTERS,
    THIN,
    DrawnArc,
    Fill,
    Item,
    Text,
    arrow,
    bounds_of_items,
    polar,
    segment,
    width,
)
from ..engine.layout_check import BESIDE_LINE
from .dimension_lines import ARROW, PAD
from .sheet_plan import ENVELOPE, Callout, Datum
from .tolerances import FRAME, block, datum, frame_width

STEP = 1.7 * LETTERS  # between lines of a callout
SHELF = 3.0  # of the leader at the text
BELOW_LINE = 1.5  # from the last line's baseline to a frame
# Lengths of leaders tried, mm.
REACHES = (7.0, 9.0, 11.0, 14.0, 17.0, 20.0, 24.0, 28.0, 33.0, 38.0, 44.0, 50.0, 58.0, 66.0, 75.0, 85.0, 95.0)
MOST_TARGETS = 12  # of equal features tried for the leader
# Cost of a leader's crossings: low for extension and centre lines, high for the part, highest for dimension
# lines.
CROSSING = {
    "outline": 12.0,
    "hidden": 4.0,
    "dimension": 80.0,
    "leader": 80.0,
    "symbol": 80.0,
    "cutting": 80.0,
    "extension": 6.0,
    "table": 500.0,
}
ALONG = 40.0  # cost of a leader that runs along another line and may be mistaken for it
AT_END = 12.0  # cost of a leader at the very end of an arc
NEAR, PARALLEL = 0.7, 0.03  # mm between such lines, and the sine of the angle between them
FORBIDDEN = 80.0  # of the costs above: lines that a datum's stem never crosses
AROUND_LETTER = 3.2  # mm kept free from the middle of a datum's letter, each way
RING, RINGED, RING_GAP = 1.75, 1.8, 0.9  # radius around a letter, its height, and white around the ring, mm
ROUNDING = 1e-6  # mm: more than sums of places on paper are off
AROUND = 0.9  # white kept around a callout's texts beyond what the check asks, mm


class Board:
    """Items on paper, forbidden areas, and the search for free places."""

    def __init__(self, area: Box) -> None:
        self.area = area
        self.items: list[Item] = []
        self.kept: list[Box] = []  # no callout goes there
        self.taken: list[Box] = []  # no view goes there
        self._chords: list[tuple[float, float, float, float]] = []
        self._roles: list[str] = []
        self._boxes: list[Quad] = []  # around texts and letters in frames, and what bounds each
        self._bounds: list[Box] = []
        self._array: np.ndarray | None = None
        self._bounds_array: np.ndarray | None = None

    def add(self, items: Iterable[Item]) -> None:
        for item in items:
            self.items.append(item)
            if isinstance(item, Text):
                if item.text.strip():
                    self._keep_clear(item.corners(BESIDE_LINE + 0.2))
                continue
            for (ax, ay), (bx, by) in item.chords():
                self._chords.append((ax, ay, bx, by))
                self._roles.append(item.role if not isinstance(item, Fill) else "arrow")
        self._array = None

    def _keep_clear(self, quad: Quad) -> None:
        self._boxes.append(quad)
        self._bounds.append(bounds(quad))
        self._bounds_array = None

    def _texts_meeting(self, box: Box) -> list[Quad]:
        """Texts and framed letters whose bounds meet the box."""
        if self._bounds_array is None:
            self._bounds_array = np.array(self._bounds).reshape(-1, 4)
        b, (x0, y0, x1, y1) = self._bounds_array, box
        return [
            self._boxes[i]
            for i in np.flatnonzero((b[:, 2] >= x0) & (b[:, 0] <= x1) & (b[:, 3] >= y0) & (b[:, 1] <= y1))
        ]

    def callout(self, c: Callout, scale: float, origin: Point) -> bool:
        """Place a callout of a view at the cheapest free place, its leader to any of its targets.

        Returns False if there is no free place.
        """
        best: tuple[float, list[Item]] | None = None
        ways = [way for n in range(min(len(c.targets), MOST_TARGETS)) for way in _ways(c, n, scale, origin)]
        extent = {t: grown(bounds_of(_quads(*_block(c, (0.0, 0.0), t))), -ROUNDING) for t in (1.0, -1.0)}
        for reach in REACHES:
            if best and reach >= best[0]:
                break
            for tip, angle, extra in ways:
                if best and reach + extra >= best[0]:
                    continue
                items, cost = self._tried(c, tip, angle, reach, extent)
                cost += extra
                if items and (best is None or cost < best[0] - 1e-9):
                    best = (cost, items)
        if best is None:
            return False
        self.add(best[1])
        return True

    def datum(self, d: Datum, scale: float, origin: Point) -> bool:
        """Place a datum's triangle on its edge, the letter outside, where both are free."""
        ux, uy = d.away
        for reach in (6.5, 8.0, 9.5, 11.0, 12.5, 14.0, 16.0, 18.0, 20.0, 22.0, 25.0, 28.0, 32.0, 36.0, 40.0):
            for share in (0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8, 0.1, 0.9, 0.05, 0.95):
                on = d.at(share)
                x, y = origin[0] + scale * on[0], origin[1] + scale * on[1]
                items = datum((x, y), d.away, reach, d.letter)
                outside = (x + 0.6 * ux, y + 0.6 * uy)
                middle = (x + reach * ux, y + reach * uy)
                around = grown((*middle, *middle), AROUND_LETTER)
                square = corners(around)
                west, east, far, near = (
                    (x + across * uy + out * ux, y - across * ux + out * uy)
                    for across, out in ((-1.9, 0.6), (1.9, 0.6), (1.9, 3.4), (-1.9, 3.4))
                )
                foot = (west, east, far, near)
                blocked = any(overlap(around, kept) for kept in self.kept)
                passed = self.passed((outside, middle))
                legs_free = passed is not None and passed < FORBIDDEN
                if not blocked and legs_free and not self.hit([square, foot], bounds([*square, *foot])):
                    self.add(items)
                    self._keep_clear(square)
                    return True
        return False

    def _tried(
        self, c: Callout, tip: Point, angle: float, reach: float, extent: Mapping[float, Box]
    ) -> tuple[list[Item], float]:
        """The callout's items with a leader of this direction and length, and their cost; or none. `extent`:
        of its texts about the shelf's end, by the shelf's direction."""
        elbow = polar(tip, reach, angle)
        towards = 1.0 if cos(radians(angle)) >= -1e-9 else -1.0
        start = (elbow[0] + towards * SHELF, elbow[1])
        if not self._inside(shifted(extent[towards], start)):
            return [], 0.0
        texts, extras = _block(c, start, towards)
        if not self.free(_quads(texts, extras)):
            return [], 0.0
        tried = [self.passed(leg) for leg in ((tip, elbow), (elbow, start))]
        passed = [cost for cost in tried if cost is not None]
        if len(passed) < len(tried):
            return [], 0.0
        cost = reach + sum(passed) + (4.0 if abs(sin(radians(angle))) > 0.97 else 0.0)
        lines = [segment(tip, elbow, THIN, "leader"), segment(elbow, start, THIN, "leader")]
        return [*lines, arrow(tip, elbow, ARROW, "leader"), *texts, *extras], cost

    def free(self, quads: Sequence[Quad]) -> bool:
        """Whether texts fit there: inside the area, outside every view, over nothing."""
        box = bounds_of(quads)
        return self._inside(box) and not self.hit(quads, box)

    def _inside(self, box: Box) -> bool:
        """Whether it is inside the area and outside every view."""
        (x0, y0, x1, y1), (ax0, ay0, ax1, ay1) = box, self.area
        if x0 < ax0 + 2 or y0 < ay0 + 2 or x1 > ax1 - 2 or y1 > ay1 - 2:
            return False
        return not any(overlap(box, kept) for kept in self.kept)

    def passed(self, leg: Chord) -> float | None:
        """Cost of a line's crossings; None if it would run through a text."""
        through = any(chord_meets(leg, quad) for quad in self._texts_meeting(bounds(leg)))
        return None if through else self._crossings(leg)

    def hit(self, quads: Sequence[Quad], box: Box) -> bool:
        """Whether a text or frame would lie over anything that is there."""
        if any(quads_meet(q, b) for b in self._texts_meeting(box) for q in quads):
            return True
        a, (x0, y0, x1, y1), m = self._lines(), box, BESIDE_LINE + 0.5
        near = np.flatnonzero(
            (np.maximum(a[:, 0], a[:, 2]) > x0 - m)
            & (np.minimum(a[:, 0], a[:, 2]) < x1 + m)
            & (np.maximum(a[:, 1], a[:, 3]) > y0 - m)
            & (np.minimum(a[:, 1], a[:, 3]) < y1 + m)
        )
        return any(chord_meets(((a[i, 0], a[i, 1]), (a[i, 2], a[i, 3])), q) for i in near for q in quads)

    def _lines(self) -> np.ndarray:
        """Both ends of every straight piece, (n, 4)."""
        if self._array is None:
            self._array = np.array(self._chords).reshape(-1, 4)
        return self._array

    def _crossings(self, leg: Chord) -> float:
        lines = self._lines()
        (px, py), (qx, qy) = leg
        ux, uy = qx - px, qy - py
        length = hypot(ux, uy)
        if length < 1e-9 or not len(lines):
            return 0.0
        rx, ry, sx, sy = lines.T
        vx, vy = sx - rx, sy - ry
        det = ux * vy - uy * vx
        safe = np.where(np.abs(det) < 1e-12, 1.0, det)
        t = ((rx - px) * vy - (ry - py) * vx) / safe
        s = ((rx - px) * uy - (ry - py) * ux) / safe
        met = (np.abs(det) > 1e-12) & (t * length > 0.4) & (t < 1 - 1e-9) & (s > -1e-9) & (s < 1 + 1e-9)
        crossed = sum(
            CROSSING.get(self._roles[i], 20.0 if self._roles[i] == "arrow" else 2.0)
            for i in np.flatnonzero(met)
        )
        along_r, along_s = (((x - px) * ux + (y - py) * uy) / length for x, y in ((rx, ry), (sx, sy)))
        off = np.abs((rx - px) * uy - (ry - py) * ux) / length
        shared = np.minimum(np.maximum(along_r, along_s), length) - np.maximum(
            np.minimum(along_r, along_s), 0.0
        )
        beside = (np.abs(det) < PARALLEL * length * np.hypot(vx, vy)) & (off < NEAR) & (shared > 1.0)
        return crossed + ALONG * bool(beside.any())


def _ways(c: Callout, n: int, scale: float, origin: Point) -> list[tuple[Point, float, float]]:
    """Possible ends of a leader on the n-th target, its directions there (degrees), and their costs."""
    (x, y), radius = c.targets[n]
    centre = (origin[0] + x * scale, origin[1] + y * scale)
    if not c.spans:
        return [(polar(centre, radius * scale, 15.0 * i), 15.0 * i, 0.0) for i in range(24)]
    start, end = c.spans[n]
    sweep = (end - start) % 360.0 or 360.0
    # in line with the arc's centre, from within or from outside; near its ends it reads as the edge that
    # joins it
    normals = [
        (start + sweep * share, AT_END * abs(2 * share - 1))
        for share in (0.5, 0.35, 0.65, 0.2, 0.8, 0.1, 0.9, 0.04, 0.96)
    ]
    return [
        (polar(centre, radius * scale, a), a + turn, cost) for a, cost in normals for turn in (180.0, 0.0)
    ]


def _quads(texts: Sequence[Text], extras: Sequence[Item]) -> list[Quad]:
    """What a callout keeps clear."""
    framed = [corners(grown(bounds_of_items(extras), PAD / 2))] if extras else []
    return [*(text.corners(AROUND) for text in texts), *framed]


def _block(c: Callout, start: Point, towards: float) -> tuple[list[Text], list[Item]]:
    """Texts at the shelf's end, the first line level with it; below them tolerance frames and a datum's
    symbol, level with it if there is no text."""
    x, y = start
    wide = max([FRAME, *map(_line_width, c.lines), *map(frame_width, c.frames)])
    aside = 1.0 if c.lines else 0.0
    left = x + aside if towards > 0 else x - aside - wide
    base = y - LETTERS / 2
    texts: list[Text] = []
    circles: list[Item] = []
    for i, line in enumerate(c.lines):
        some, around = _line((left, base - STEP * i), line)
        texts += some
        circles += around
    if not c.frames and not c.datum:
        return texts, circles
    top = texts[-1].at[1] - BELOW_LINE if texts else y + (FRAME / 2 if c.frames else 0.0)
    return texts, [*circles, *block(c.frames, c.datum, (left, top), wide)]


def _line_width(line: str) -> float:
    before, mark, after = line.partition(ENVELOPE)
    return width(before, LETTERS) + bool(mark) * 2 * (RING + RING_GAP) + width(after, LETTERS)


def _line(at: Point, line: str) -> tuple[list[Text], list[Item]]:
    """The texts of a line, and the ring around the E of an envelope requirement, for which no font has a
    letter."""
    before, mark, after = line.partition(ENVELOPE)
    texts = [Text(at, before, LETTERS)]
    if not mark:
        return texts, []
    x, y = at[0] + width(before, LETTERS) + RING_GAP + RING, at[1] + LETTERS / 2
    texts.append(Text((x, y - RINGED / 2), "E", RINGED, "middle"))
    if after.strip():
        texts.append(Text((x + RING + RING_GAP, at[1]), after.strip(), LETTERS))
    return texts, [DrawnArc((x, y), RING, line=THIN, role="leader")]
