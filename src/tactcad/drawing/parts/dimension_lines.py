"""Dimension, extension and leader lines after ISO 129-1:2018, on one view at its scale.

A view's (0, 0) lies at the paper's (0, 0); the composer moves what comes out. Along a side of the view
everything is laid out in (s, o): s along the side, o outwards from the view's box.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from ..engine.boxes import Box, Point
from ..engine.ink import (
    CENTRE,
    LETTERS,
    THIN,
    Anchor,
    DrawnArc,
    Fill,
    Item,
    Stroke,
    Text,
    arrow,
    ink_box,
    polar,
    segment,
    width,
)
from .measures import Values
from .sheet_plan import Across, Linear, Running, Side

ARROW = 2.5  # length of an arrow head: 10 line widths
GAP = 1.0  # between a feature and its extension line
OVERSHOOT = 2.0  # of the extension line beyond the dimension line: 8 line widths
FIRST, PITCH, PITCH_BOXED = 10.0, 8.0, 10.0  # dimension lines from the outline and from each other
TAIL = 6.0  # of a dimension line with arrows pointing inwards
BEYOND = 12.0  # from the part to the text of a dimension across a web
ABOVE = 1.0  # from the dimension line to the text
CLEAR_OF_ARROW = 0.65  # from the dimension line to a text's ink: half an arrow head, and white along a line
PAD = 1.1  # around the text of a key characteristic
BASIC = 0.8  # around that of a theoretically exact dimension
LABELS = 4.4  # least distance of running dimensions' texts, without their frames


def placer(side: Side, box: Box) -> Callable[[float, float], Point]:
    """From (s, o) on a side of the box to the paper."""
    x0, y0, x1, y1 = box
    return {
        "top": lambda s, o: (s, y1 + o),
        "bottom": lambda s, o: (s, y0 - o),
        "left": lambda s, o: (x0 - o, s),
        "right": lambda s, o: (x1 + o, s),
    }[side]


def local(side: Side, box: Box, p: Point) -> Point:
    """From the paper to (s, o) on a side of the box."""
    x0, y0, x1, y1 = box
    return {
        "top": (p[0], p[1] - y1),
        "bottom": (p[0], y0 - p[1]),
        "left": (p[1], x0 - p[0]),
        "right": (p[1], p[0] - x1),
    }[side]


def boxed(text: Text, key: int) -> list[Item]:
    """A key characteristic: its number and its text in a frame of two cells."""
    start = text.origin
    mark = Text(polar(start, PAD, text.angle), f"K{key}", text.height, angle=text.angle)
    shift = mark.width + 2 * PAD
    shown = Text(polar(start, shift + PAD, text.angle), text.text, text.height, angle=text.angle)
    outline = _outline(start, text, shift + text.width + 2 * PAD, PAD)
    low, high = (polar(p, shift, text.angle) for p in (outline.points[0], outline.points[3]))
    return [mark, shown, outline, segment(low, high, THIN, "symbol")]


def _outline(start: Point, text: Text, length: float, pad: float) -> Stroke:
    """A frame from `start` on along the text's line of writing, `pad` mm higher and lower than it."""

    def at(u: float, v: float) -> Point:
        return polar(polar(start, u, text.angle), v, text.angle + 90)

    low, high = -pad, text.height + pad
    return Stroke((at(0, low), at(length, low), at(length, high), at(0, high)), THIN, "symbol", closed=True)


def stacked(
    linears: Sequence[Linear], side: Side, box: Box, scale: float, values: Values, start: float
) -> list[Item]:
    """The dimensions on one side of a view, the short ones nearest to it, from `start` outwards."""
    on_paper, upright = placer(side, box), side in ("left", "right")
    spots = []
    for line in (line for line in linears if line.side == side):
        ends = [local(side, box, (p[0] * scale, p[1] * scale)) for p in (line.p, line.q)]
        (a, oa), (b, ob) = sorted(ends)
        spots.append((b - a, a, b, oa, ob, line.dimension))
    spots.sort(key=lambda spot: (round(spot[0], 6), spot[1]))
    tracks: list[_Track] = []
    items: list[Item] = []
    for n, (_, a, b, oa, ob, d) in enumerate(spots):
        text, key, basic = d.text(values), d.key, d.basic
        length = width(text, LETTERS) + (width(f"K{key}", LETTERS) + 4 * PAD if key else 0.0)
        length += 2 * BASIC if basic else 0.0
        # extension lines that pass this dimension on their way out: its own, and those of outer dimensions
        feet = [s for spot in spots[n:] for s in spot[1:3]]
        sides = (box[1], box[3]) if upright else (box[0], box[2])
        number, (t0, inside) = _first_free(tracks, a, b, _text_places(a, b, length, feet, sides), length)
        if number == len(tracks):
            further = tracks[-1].offset + (PITCH_BOXED if key or basic else PITCH) if tracks else 0.0
            tracks.append(_Track(further or max(start, FIRST), []))
        tracks[number].taken.append(_interval(a, b, t0, length, inside))
        o = tracks[number].offset
        for s, foot in ((a, oa), (b, ob)):
            near, far = on_paper(s, min(foot + GAP, o - 1.0)), on_paper(s, o + OVERSHOOT)
            items.append(segment(near, far, THIN, "extension"))
        for s, towards in ((a, b if inside else a - 1), (b, a if inside else b + 1)):
            items.append(arrow(on_paper(s, o), on_paper(towards, o), ARROW))
        tail = 0.0 if inside else TAIL
        items.append(segment(on_paper(min(a - tail, t0), o), on_paper(max(b + tail, t0 + length), o)))
        # the text above its line, read from below or from the right; parentheses reach below the line of
        # writing, down to the arrow heads
        below = -ink_box(text, LETTERS)[1]
        lift = max(ABOVE + (PAD - 0.2 if key or basic else 0.0), below + CLEAR_OF_ARROW)
        x, y = on_paper(t0, o)
        at = (x - lift, y) if upright else (x, y + lift)
        shown = Text(at, text, LETTERS, angle=90.0 if upright else 0.0)
        if basic:
            shown = replace(shown, at=polar(at, BASIC, shown.angle))
            items += [shown, _outline(at, shown, shown.width + 2 * BASIC, BASIC)]
        else:
            items += boxed(shown, key) if key else [shown]
    return items


@dataclass(frozen=True)
class _Track:
    """A line of dimensions next to each other, and its occupied parts."""

    offset: float
    taken: list[tuple[float, float]]


def _interval(a: float, b: float, t0: float, length: float, inside: bool) -> tuple[float, float]:
    """The stretch that a dimension takes along its line; two that end at one extension line may share it."""
    low, high = (a, b) if inside else (a - TAIL, b + TAIL)
    return (min(low, t0 - 1.5) if t0 < a else low, max(high, t0 + length + 1.5) if t0 + length > b else high)


def _first_free(
    tracks: list[_Track], a: float, b: float, choices: list[tuple[float, bool]], length: float
) -> tuple[int, tuple[float, bool]]:
    """The innermost track with a free place for the text; a new one if there is none."""
    # a dimension is outside every one that it spans
    least = max(
        (n + 1 for n, t in enumerate(tracks) if any(a - 0.5 < (lo + hi) / 2 < b + 0.5 for lo, hi in t.taken)),
        default=0,
    )
    for n in range(least, len(tracks)):
        for t0, inside in choices:
            low, high = _interval(a, b, t0, length, inside)
            if all(high < lo + 0.01 or low > hi - 0.01 for lo, hi in tracks[n].taken):
                return n, (t0, inside)
    return len(tracks), choices[0]


def _text_places(
    a: float, b: float, length: float, feet: Sequence[float], ends: tuple[float, float]
) -> list[tuple[float, bool]]:
    """Possible starts of the text, and whether the arrows are inside; the best first: between the extension
    lines, then outside them within the `ends` of the view, where no other side's dimensions are, then
    anywhere."""
    room = b - a
    inside = room >= 2 * ARROW + 1.5
    tail = 2.0 if inside else TAIL + 1.0
    places = []
    if room >= length + 1.6:
        slack = (room - length) / 2 - 0.8
        places += [(a + 0.8 + slack * share, inside) for share in (1.0, 0.6, 1.4, 0.2, 1.8)]
    beside = [b + tail, a - tail - length, *(f + 1.2 for f in sorted(feet) if f > b + tail)]
    beside.sort(key=lambda t0: not ends[0] <= t0 <= t0 + length <= ends[1])
    places += [(t0, inside) for t0 in beside]

    def crossed(t0: float) -> bool:
        return any(t0 - 0.7 < s < t0 + length + 0.7 for s in feet)

    clear = [place for place in places if not crossed(place[0])]
    return clear or [(max([*feet, b + TAIL]) + 2.0, inside)]


def running(r: Running, box: Box, scale: float, values: Values, o: float = FIRST - 2.0) -> list[Item]:
    """Dimensions from one origin on one line, `o` from the box; texts in line with the extension lines."""
    on_paper = placer(r.side, box)
    stops = [(*local(r.side, box, (p[0] * scale, p[1] * scale)), d) for d, p in r.stops]
    stops.sort(key=lambda stop: stop[0])
    origin = next(s for s, _, d in stops if d is None)
    framed = any(d and d.basic for _, _, d in stops)
    places = _spread([s for s, _, _ in stops], LABELS + (BASIC if framed else 0.0))
    items: list[Item] = [segment(on_paper(stops[0][0], o), on_paper(stops[-1][0], o))]
    for n, ((s, foot, d), label) in enumerate(zip(stops, places)):
        aside = abs(label - s) > 1e-6
        bend = o + (2.0 if aside else 3.0)
        end = on_paper(label if aside else s, bend + 4.0)
        items.append(segment(on_paper(s, foot + GAP), on_paper(s, bend), THIN, "extension"))
        items.append(segment(on_paper(s, bend), end, THIN, "extension"))
        on_line = on_paper(s, o)
        if abs(s - origin) < 1e-9:
            items.append(DrawnArc(on_line, 1.0, line=THIN, role="symbol"))
        elif abs(s - (inner := stops[n - 1 if s > origin else n + 1][0])) < ARROW + 1.2:
            # a dot if the neighbour leaves no room for an arrow
            items.append(Fill(tuple(polar(on_line, 0.6, a) for a in range(0, 360, 30))))
        else:
            items.append(arrow(on_line, on_paper(inner, o), ARROW))
        basic = d is not None and d.basic
        x, y = on_paper(label, o + 8.0 + BASIC if basic else o + 8.0)
        upright = r.side in ("top", "bottom")
        at = (x + LETTERS / 2, y) if upright else (x, y - LETTERS / 2)
        anchor: Anchor = "start" if r.side in ("top", "right") else "end"
        shown = Text(at, d.text(values) if d else "0", LETTERS, anchor, 90.0 if upright else 0.0)
        items.append(shown)
        if basic:
            start = polar(shown.origin, -BASIC, shown.angle)
            items.append(_outline(start, shown, shown.width + 2 * BASIC, BASIC))
    return items


def _spread(wanted: Sequence[float], least: float) -> list[float]:
    """Places nearest to the wanted ones (ascending), at least so far apart; touching ones move together."""
    groups: list[list[float]] = []  # sum of (wanted - own offset), count
    for n, s in enumerate(wanted):
        groups.append([s - n * least, 1.0])
        while len(groups) > 1 and groups[-2][0] / groups[-2][1] > groups[-1][0] / groups[-1][1]:
            total, count = groups.pop()
            groups[-1][0] += total
            groups[-1][1] += count
    places: list[float] = []
    for total, count in groups:
        places += [total / count + (len(places) + i) * least for i in range(int(count))]
    return [s if abs(p - s) < 1e-6 else p for s, p in zip(wanted, places)]


def across(a: Across, scale: float, values: Values) -> list[Item]:
    """A dimension line through a web: arrows point at it from both sides, the text is beyond q."""
    p, q = ((x * scale, y * scale) for x, y in (a.p, a.q))
    size = ((q[0] - p[0]) ** 2 + (q[1] - p[1]) ** 2) ** 0.5
    ux, uy = (q[0] - p[0]) / size, (q[1] - p[1]) / size
    reach = a.past * scale + BEYOND
    before, end = (p[0] - ux * TAIL, p[1] - uy * TAIL), (q[0] + ux * reach, q[1] + uy * reach)
    text, key = a.dimension.text(values), a.dimension.key
    items: list[Item] = [segment(before, p), segment(q, end), arrow(p, before, ARROW), arrow(q, end, ARROW)]
    shelf = 3.0
    items.append(segment(end, (end[0] + shelf, end[1])))
    at = (end[0] + shelf + (0.0 if key else 1.0), end[1] - LETTERS / 2)
    shown = Text(at, text, LETTERS)
    return [*items, *(boxed(shown, key) if key else [shown])]


def centre_lines(centre: Point, diameter: float, scale: float) -> list[Item]:
    """A cross that extends 2 mm beyond its circle; continuous if too small for dashes."""
    x, y = centre[0] * scale, centre[1] * scale
    r = diameter / 2 * scale + min(2.0, 0.8 + diameter * scale / 4)
    line = CENTRE if r > 5.0 else THIN
    return [segment((x - r, y), (x + r, y), line, "centre"), segment((x, y - r), (x, y + r), line, "centre")]
