"""Stroke letters for a board's print: the reader needs no font.

Each letter is lines of points on a grid 4 wide and 6 high, y up: "06 00 30" is (0, 6) to (0, 0) to (3, 0).
"""

from __future__ import annotations

from collections.abc import Iterator

Point = tuple[float, float]
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
