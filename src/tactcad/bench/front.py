"""Efficient choices: no other one is both as quick and as accurate."""

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


def dominators(points: Sequence[tuple[float, float]]) -> dict[int, int]:
    """For every index that is not on the front the most accurate one that costs no more: the better
    choice.
    """
    front = efficient(points)
    beaten = [i for i in range(len(points)) if i not in front]
    return {
        i: min((j for j in front if points[j][0] <= points[i][0]), key=lambda j: points[j][1]) for i in beaten
    }


def told(names: Sequence[str], points: Sequence[tuple[float, float]]) -> str:
    """One sentence: what is on the front, and what is dominated by what."""
    front = ", ".join(names[i] for i in efficient(points))
    beaten = "; ".join(f"{names[i]} by {names[j]}" for i, j in dominators(points).items())
    return f"On the efficient front, quickest first: {front}." + (f" Dominated: {beaten}." if beaten else "")
