"""What is worth choosing: nothing else is both as quick and as accurate."""

from __future__ import annotations

from collections.abc import Sequence


def efficient(points: Sequence[tuple[float, float]]) -> list[int]:
    """Indices of the (cost, error) pairs that no other one dominates, by growing cost.

    One dominates another where it is no worse in both and better in one. Of equal pairs all stay.
    """
    order = sorted(range(len(points)), key=lambda i: points[i])
    kept: list[int] = []
    for i in order:
        if not kept or points[i][1] < points[kept[-1]][1] or points[i] == points[kept[-1]]:
            kept.append(i)
    return kept
