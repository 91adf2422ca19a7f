"""Times of things that are compared, measured in turns, so that other load on the machine affects all
alike.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass
from math import ceil
from statistics import median
from typing import TypeVar

LEAST_SAMPLE = 0.005  # s: shorter actions run several times a sample, to reduce the error of clock and loop
K = TypeVar("K", bound=Hashable)


@dataclass(frozen=True)
class Timed:
    """Seconds of one action: shortest and median of `runs` samples. The shortest counts: disturbances only
    add time.
    """

    seconds: float
    median: float
    runs: int


def interleaved(actions: Mapping[K, Callable[[], object]], repeats: int) -> dict[K, Timed]:
    """Each action once to warm up, then `repeats` rounds of all of them, every round beginning with the next
    one."""
    loops = {
        name: max(1, ceil(LEAST_SAMPLE / max(_seconds(action, 1), 1e-9))) for name, action in actions.items()
    }
    order = list(actions)
    samples: dict[K, list[float]] = {name: [] for name in actions}
    for turn in range(repeats):
        first = turn % len(order)
        for name in order[first:] + order[:first]:
            samples[name].append(_seconds(actions[name], loops[name]) / loops[name])
    return {name: of_samples(s) for name, s in samples.items()}


def of_samples(seconds: list[float]) -> Timed:
    """The same from times measured elsewhere, such as by another process's own clock."""
    return Timed(min(seconds), median(seconds), len(seconds))


def _seconds(action: Callable[[], object], loops: int) -> float:
    start = time.perf_counter()
    for _ in range(loops):
        action()
    return time.perf_counter() - start
