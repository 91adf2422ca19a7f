"""Preferred scales of ISO 5455:1979."""

from __future__ import annotations

from tactcad.design.messages import CheckFailure

# paper : part, the largest first
SERIES = ((50, 1), (20, 1), (10, 1), (5, 1), (2, 1), (1, 1), (1, 2), (1, 5), (1, 10))


def shown(scale: tuple[int, int]) -> str:
    return f"{scale[0]}:{scale[1]}"


def factor(scale: tuple[int, int]) -> float:
    return scale[0] / scale[1]


def largest_fitting(width: float, height: float, room: tuple[float, float], what: str, least: tuple[int, int] = (1, 10)) -> tuple[int, int]:
    """The largest preferred scale at which width x height (mm of the part) fits the room (mm of paper).

    Raises CheckFailure where even `least` is too large.
    """
    for scale in SERIES:
        f = factor(scale)
        if width * f <= room[0] and height * f <= room[1]:
            return scale
        if scale == least:
            break
    raise CheckFailure(
        f"drawings: {what} is {width:g} x {height:g} mm; at {shown(least)}, the smallest scale used, it does not fit "
        f"the {room[0]:g} x {room[1]:g} mm that the sheet leaves it; no drawing was written"
    )
