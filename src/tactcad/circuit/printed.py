"""A board's print: designators next to their components, roles of the connectors' pins, its name."""

from __future__ import annotations

from collections.abc import Iterator

from tactcad.design.messages import CheckFailure

from .copper import VIA_DRILL, BoardCopper, Placed, Point
from .footprints import COURTYARD, FLUSH

INK = 0.15  # mm wide; board houses print from 0.12 to 0.15 on
HIGH = 0.8  # mm; board houses print letters from 0.8 on
AROUND = 0.07  # mm from pads and drills: the mask's opening is 0.05 larger
APART = INK  # mm between letters of two texts, at least; chosen: below, they read as one
CHANNEL_PINS = {"RED": "R", "PLUS": "W", "FOOT": "B"}
SHORT = {"ENABLE": "EN"}
MARKED = ("amplifier", "multiplexer", "converter", "decoder", "regulator", "supply", "diode", "sensor")
Box = tuple[float, float, float, float]


def printed(board: BoardCopper, name: str) -> Iterator[tuple[Point, Point]]:
    """Its lines."""
    taken = [_around(at, *placed.size(pad)) for placed, pad, at, _ in board.pads]
    taken += [_around(via.at, VIA_DRILL, VIA_DRILL) for via in board.vias]
    taken += [_around((x, y), d, d) for x, y, d in board.holes]
    for placed in board.placed:
        if placed.component.kind in MARKED:
            a, b = _mark(placed)
            taken.append((min(a[0], b[0]), min(a[1], b[1]), max(a[0], b[0]), max(a[1], b[1])))
            yield a, b
    for text, at, upright in (
        *_pins(board),
        (name, board.label or (board.width / 4, board.height - 8.0), False),
    ):
        taken.append(_box(text, at, upright, APART))
        yield from _lines(text, at, upright)
    for placed in board.placed:
        text = placed.component.designator
        free = (p for p in _beside(placed, text) if not _meets(_box(text, *p), taken))
        if (found := next(free, None)) is None:
            if placed.component.footprint == FLUSH:  # chips side by side: the first pin's mark stays
                continue
            raise CheckFailure(f"circuit board: no place to print {text}")
        at, upright = found
        taken.append(_box(text, at, upright, APART))
        yield from _lines(text, at, upright)


def _mark(placed: Placed) -> tuple[Point, Point]:
    """Next to a circuit's first pin, along it; beyond a diode's cathode, across it."""
    pad = placed.footprint.pads[0]
    if placed.component.kind == "diode":
        x = pad.x - pad.w / 2 - 0.3
        return placed.point(x, -pad.h / 2), placed.point(x, pad.h / 2)
    y = pad.y - pad.h / 2 - 0.3
    return placed.point(pad.x - pad.w / 2, y), placed.point(pad.x + pad.w / 2, y)


def _lines(text: str, at: Point, upright: bool) -> Iterator[tuple[Point, Point]]:
    for line in strokes(text, at, HIGH, upright):
        yield from zip(line, line[1:])


def _around(at: Point, w: float, h: float, more: float = AROUND) -> Box:
    w, h = w / 2 + more, h / 2 + more
    return at[0] - w, at[1] - h, at[0] + w, at[1] + h


def _box(text: str, at: Point, upright: bool, more: float = 0.0) -> Box:
    w, h = width(text, HIGH) + INK, HIGH + INK
    return _around(at, h, w, more) if upright else _around(at, w, h, more)


def _meets(box: Box, others: list[Box]) -> bool:
    return any(box[0] < o[2] and o[0] < box[2] and box[1] < o[3] and o[1] < box[3] for o in others)


def _beside(placed: Placed, text: str) -> Iterator[tuple[Point, bool]]:
    """Places for a designator, the best first."""
    (x, y), (a, b) = placed.at, (h - COURTYARD for h in placed.footprint.half)
    if placed.turn % 180:
        a, b = b, a
    long, half = ((size + INK) / 2 + AROUND + 1e-6 for size in (width(text, HIGH), HIGH))
    yield placed.at, False
    yield placed.at, True
    for further in (0.0, 0.4, 0.8, 1.2, 2.0):
        for sx in (0.0, -0.5, 0.5, -1.0, 1.0):
            yield (x + sx * a, y - b - half - further), False
            yield (x + sx * a, y + b + half + further), False
            yield (x - a - half - further, y + sx * b), True
            yield (x + a + half + further, y + sx * b), True
            yield (x - a - long - further, y + sx * b), False
            yield (x + a + long + further, y + sx * b), False


def _pins(board: BoardCopper) -> Iterator[tuple[str, Point, bool]]:
    places = {p.component.designator: p for p in board.placed}
    for name, side in (("J1", 1), ("J2", -1)):
        if (placed := places.get(name)) is None:
            continue
        for pad, pin in zip(placed.footprint.pads, placed.component.pins, strict=True):
            x, y = placed.pad_at(pad)
            said = pin.role.partition(" ")[2].removesuffix("_IN")
            channel, _, end = said.partition("_")
            if channel.startswith("CH"):
                yield CHANNEL_PINS[end], (x, y - 1.65), False
                if end == "PLUS":
                    yield channel, (x, y - 3.0), False
                continue
            text = SHORT.get(said, said)
            yield text, (x, y + side * (1.15 + width(text, HIGH) / 2)), True


# Stroke letters, so that the reader needs no font: lines of points on a grid 4 wide and 6 high, y up;
# "06 00 30" is (0, 6) to (0, 0) to (3, 0).
ADVANCE = 6  # of the grid, from letter to letter
STROKES = {
    "0": "00 40 46 06 00",
    "1": "15 26 20,10 30",
    "2": "06 46 43 03 00 40",
    "3": "06 46 40 00,13 43",
    "4": "06 03 43,46 40",
    "5": "46 06 03 43 40 00",
    "6": "46 06 00 40 43 03",
    "7": "06 46 20",
    "8": "00 40 46 06 00,03 43",
    "9": "43 03 06 46 40 00",
    "A": "00 04 26 44 40,02 42",
    "B": "00 06 36 44 33 03,33 42 40 00",
    "C": "46 06 00 40",
    "D": "00 06 26 44 42 20 00",
    "E": "46 06 00 40,03 33",
    "F": "46 06 00,03 33",
    "G": "46 06 00 40 43 23",
    "H": "00 06,40 46,03 43",
    "I": "10 30,16 36,20 26",
    "J": "46 40 10 02",
    "K": "00 06,46 03 40",
    "L": "06 00 40",
    "M": "00 06 23 46 40",
    "N": "00 06 40 46",
    "O": "00 40 46 06 00",
    "P": "00 06 46 43 03",
    "Q": "00 40 46 06 00,22 40",
    "R": "00 06 46 43 03,13 40",
    "S": "46 06 03 43 40 00",
    "T": "06 46,26 20",
    "U": "06 00 40 46",
    "V": "06 20 46",
    "W": "06 00 23 40 46",
    "X": "00 46,06 40",
    "Y": "06 23 46,23 20",
    "Z": "06 46 00 40",
    "-": "13 33",
    ".": "20 21",
    "/": "00 46",
    "+": "03 43,21 25",
    "_": "00 40",
    " ": "",
}


def width(text: str, height: float) -> float:
    return (len(text) * ADVANCE - 2) * height / 6


def strokes(text: str, at: Point, height: float, upright: bool = False) -> Iterator[tuple[Point, ...]]:
    """Lines of a text about its middle, y down as on the board; `upright` reads from below."""
    f, wide = height / 6, width(text, height)
    for i, letter in enumerate(text.upper()):
        for line in STROKES.get(letter, "").split(","):
            points = [
                (f * (ADVANCE * i + int(p[0])) - wide / 2, height / 2 - f * int(p[1])) for p in line.split()
            ]
            if upright:
                points = [(y, -x) for x, y in points]
            if points:
                yield tuple((round(at[0] + x, 3), round(at[1] + y, 3)) for x, y in points)
