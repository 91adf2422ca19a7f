"""Statics of the rigs: how much the beams and round plates bend that are taken as rigid elsewhere, whether
the cart tips, whether the vacuum holds.

Straight beams with shear after Timoshenko (Strength of Materials, part I; shear factor 5/6 of a rectangle),
round plates after Roark's Formulas for Stress and Strain, table 11.2. mm, N, MPa.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot, inf, pi


@dataclass(frozen=True)
class Beam:
    """A rectangular bar of `width` and `height` (mm, along the load) between supports or from a wall,
    `length` mm long."""

    length: float
    width: float
    height: float
    youngs_modulus: float
    poisson: float

    @property
    def bending(self) -> float:
        """E I, N mm2"""
        return self.youngs_modulus * self.width * self.height**3 / 12.0

    @property
    def shear(self) -> float:
        """5/6 G A, N"""
        return 5.0 / 6.0 * self.youngs_modulus / (2.0 * (1.0 + self.poisson)) * self.width * self.height

    def supported(self) -> float:
        """Deflection in the middle (mm/N) on supports that let the ends turn: an upper bound for real
        supports.
        """
        return self.length**3 / (48.0 * self.bending) + self.length / (4.0 * self.shear)

    def clamped(self) -> float:
        """Deflection in the middle (mm/N) between supports that prevent rotation: a lower bound for real
        supports.
        """
        return self.length**3 / (192.0 * self.bending) + self.length / (4.0 * self.shear)

    def supported_beside(self, at: float) -> float:
        """Deflection in the middle (mm/N) under a force `at` mm from one of two supports that let the ends
        turn.
        """
        a = min(at, self.length - at)
        return a * (3.0 * self.length**2 - 4.0 * a**2) / (48.0 * self.bending) + a / (2.0 * self.shear)

    def supported_evenly(self) -> float:
        """Deflection in the middle (mm/N) under a load spread over the length; the supports let the ends
        turn.
        """
        return 5.0 * self.length**3 / (384.0 * self.bending) + self.length / (8.0 * self.shear)

    def cantilever(self) -> float:
        """Deflection of the free end under a force there, mm/N."""
        return self.length**3 / (3.0 * self.bending) + self.length / self.shear

    def cantilever_tilt(self) -> float:
        """Rotation of the free end under a force there, rad/N; of the bending alone."""
        return self.length**2 / (2.0 * self.bending)

    def turned_by_moment(self) -> float:
        """Rotation of the free end under a moment there, rad/(N mm)."""
        return self.length / self.bending

    @property
    def torsion(self) -> float:
        """G J, N mm2; Roark, table 10.7, within 0.5 %."""
        a, b = max(self.width, self.height), min(self.width, self.height)
        J = a * b**3 * (1.0 / 3.0 - 0.21 * b / a * (1.0 - b**4 / (12.0 * a**4)))
        return self.youngs_modulus / (2.0 * (1.0 + self.poisson)) * J


def rod(length: float, diameter: float, youngs_modulus: float, poisson: float) -> Beam:
    """A round bar as a rectangular one of the same height and the same second moment of area, pi d^4/64.

    The rectangle is a third softer in shear than the round bar.

    Parameters
    ----------
    length, diameter
        mm.
    youngs_modulus, poisson
        MPa; Poisson's ratio.
    """
    return Beam(length, 3.0 * pi / 16.0 * diameter, diameter, youngs_modulus, poisson)


def round_plate(
    radius: float, thickness: float, youngs_modulus: float, poisson: float
) -> tuple[float, float]:
    """Deflection of the middle of a round plate supported on its rim.

    Parameters
    ----------
    radius, thickness
        mm.
    youngs_modulus, poisson
        MPa; Poisson's ratio.

    Returns
    -------
    tuple of float
        Under a force in the middle, mm/N, and under pressure on the face, mm/MPa.
    """
    D = youngs_modulus * thickness**3 / (12.0 * (1.0 - poisson**2))
    nu = poisson
    force = (3.0 + nu) / (1.0 + nu) * radius**2 / (16.0 * pi * D)
    pressure = (5.0 + nu) / (1.0 + nu) * radius**4 / (64.0 * D)
    return force, pressure


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
    """Least distance inside the wheels' contacts of a vertical load on the square |x|, |y| <= half, mm.

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
    """Horizontal force that would lift a wheel, N; inf if `height` is 0.

    Parameters
    ----------
    contacts
        Contact points of the wheels, mm: a convex polygon, counter-clockwise.
    height
        Of the horizontal force over the contacts, mm.
    weight
        The cart's own, in its middle, N.
    load, at
        Vertical load, N, and its point of action, mm.
    """
    if height == 0:
        return inf
    arms = zip(_inside_sides(contacts, at), _inside_sides(contacts, (0.0, 0.0)))
    return min(load * of_load + weight * of_weight for of_load, of_weight in arms) / height


def holding_force(vacuum: float, area: float) -> float:
    """Force (N) with which a vacuum (kPa below air) holds on an area (mm2): F = p A."""
    return vacuum * 1e-3 * area
