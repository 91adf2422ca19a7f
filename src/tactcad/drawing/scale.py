"""Preferred scales of ISO 5455:1979."""

from __future__ import annotations

Scale = tuple[int, int]

# paper : part, the largest first
SERIES = ((50, 1), (20, 1), (10, 1), (5, 1), (2, 1), (1, 1), (1, 2), (1, 5), (1, 10))
ASSEMBLIES = (*SERIES, (1, 20), (1, 50), (1, 100))


def shown(scale: Scale) -> str:
    return f"{scale[0]}:{scale[1]}"


def factor(scale: Scale) -> float:
    return scale[0] / scale[1]


def largest_fitting(width: float, height: float, room: tuple[float, float]) -> Scale | None:
    """The largest scale for an assembly at which width x height (mm of it) fits the room (mm of paper); None
    where none does."""
    return next(
        (s for s in ASSEMBLIES if width * factor(s) <= room[0] and height * factor(s) <= room[1]), None
    )
