"""Statics of the rigs: does the cart tip, does the vacuum hold."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot, inf

Point = tuple[float, float]


def inside_by(polygon: Sequence[Point], point: Point) -> float:
    """Distance (mm) of a point from the nearest side of a convex counter-clockwise polygon; negative
    outside."""
    return min(_inside_sides(polygon, point))


def _inside_sides(polygon: Sequence[Point], point: Point) -> list[float]:
    """Distance (mm) of a point from each side; negative outside of it."""
    return [
        ((x1 - x0) * (point[1] - y0) - (y1 - y0) * (point[0] - x0)) / hypot(x1 - x0, y1 - y0)
        for (x0, y0), (x1, y1) in zip(polygon, [*polygon[1:], polygon[0]])
    ]


def tipping_margin(contacts: Sequence[Point], half: float) -> float:
    """How far a vertical load anywhere on the square |x|, |y| <= half stays inside the wheels' contacts, mm.

    A vertical load inside their polygon leaves every wheel pressed, however large it is; the cart's own
    weight only helps. The square's corners are the critical places.

    Parameters
    ----------
    contacts
        Contact points of the wheels, mm: a convex polygon, counter-clockwise.
    half
        Half the square's side, mm.
    """
    return min(inside_by(contacts, (sx * half, sy * half)) for sx in (-1, 1) for sy in (-1, 1))


def tipping_pull(contacts: Sequence[Point], height: float, weight: float, load: float, at: Point) -> float:
    """Horizontal force that would lift a wheel, N; inf where `height` is 0.

    Parameters
    ----------
    contacts
        Contact points of the wheels, mm: a convex polygon, counter-clockwise.
    height
        Of the horizontal force over the contacts, mm.
    weight
        The cart's own, in its middle, N.
    load, at
        Vertical load, N, and the point where it acts, mm.
    """
    if height == 0:
        return inf
    arms = zip(_inside_sides(contacts, at), _inside_sides(contacts, (0.0, 0.0)))
    return min(load * of_load + weight * of_weight for of_load, of_weight in arms) / height


def holding_force(vacuum: float, area: float) -> float:
    """Force (N) with which a vacuum (kPa below air) holds on an area (mm2): F = p A."""
    return vacuum * 1e-3 * area
