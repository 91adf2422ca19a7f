"""How surely a share is known from a sample: Clopper and Pearson's interval."""

from __future__ import annotations

from scipy.special import betaincinv


def of_share(successes: int, count: int, level: float = 0.95) -> tuple[float, float]:
    """Clopper and Pearson's interval of a share (Biometrika 26, 1934): never covers less than its level."""
    tail = (1.0 - level) / 2.0
    low = float(betaincinv(successes, count - successes + 1.0, tail)) if successes else 0.0
    high = float(betaincinv(successes + 1.0, count - successes, 1.0 - tail)) if successes < count else 1.0
    return low, high


def widest(count: int) -> float:
    """Half-width of `of_share` of so many at its largest, where half of them succeed."""
    low, high = of_share(count // 2, count)
    return (high - low) / 2.0
