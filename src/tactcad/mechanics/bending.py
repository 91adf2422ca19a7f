"""Beams and round plates that are taken as rigid elsewhere: by how much they bend.

Straight beams with shear after Timoshenko (Strength of Materials, part I; shear factor 5/6 of a rectangle),
round plates after Roark's Formulas for Stress and Strain, table 11.2. mm, N, MPa.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi


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
        """mm for each newton in the middle of two supports that let it turn: no supports that hold it leave
        it softer."""
        return self.length**3 / (48.0 * self.bending) + self.length / (4.0 * self.shear)

    def clamped(self) -> float:
        """mm for each newton in the middle of two supports that let nothing turn: none leave it stiffer."""
        return self.length**3 / (192.0 * self.bending) + self.length / (4.0 * self.shear)

    def supported_beside(self, at: float) -> float:
        """mm in the middle for each newton that presses `at` mm from one of two supports that let it turn."""
        a = min(at, self.length - at)
        return a * (3.0 * self.length**2 - 4.0 * a**2) / (48.0 * self.bending) + a / (2.0 * self.shear)

    def supported_evenly(self) -> float:
        """mm in the middle for each newton of a load spread over the length, between supports that let it
        turn."""
        return 5.0 * self.length**3 / (384.0 * self.bending) + self.length / (8.0 * self.shear)

    def cantilever(self) -> float:
        """mm at the free end for each newton there."""
        return self.length**3 / (3.0 * self.bending) + self.length / self.shear

    def cantilever_tilt(self) -> float:
        """rad at the free end for each newton there, the other end clamped; of the bending alone."""
        return self.length**2 / (2.0 * self.bending)

    def turned_by_moment(self) -> float:
        """rad at the free end for each N mm there, the other end clamped."""
        return self.length / self.bending

    @property
    def torsion(self) -> float:
        """G J, N mm2; Roark, table 10.7, within 0.5 %."""
        a, b = max(self.width, self.height), min(self.width, self.height)
        J = a * b**3 * (1.0 / 3.0 - 0.21 * b / a * (1.0 - b**4 / (12.0 * a**4)))
        return self.youngs_modulus / (2.0 * (1.0 + self.poisson)) * J


def rod(length: float, diameter: float, youngs_modulus: float, poisson: float) -> Beam:
    """A round bar, as the rectangle of its height and its pi d^4/64; a third softer than it in shear."""
    return Beam(length, 3.0 * pi / 16.0 * diameter, diameter, youngs_modulus, poisson)


def round_plate(
    radius: float, thickness: float, youngs_modulus: float, poisson: float
) -> tuple[float, float]:
    """A round plate on its rim: mm in its middle for each newton there, and for each MPa on its face."""
    D = youngs_modulus * thickness**3 / (12.0 * (1.0 - poisson**2))
    nu = poisson
    force = (3.0 + nu) / (1.0 + nu) * radius**2 / (16.0 * pi * D)
    pressure = (5.0 + nu) / (1.0 + nu) * radius**4 / (64.0 * D)
    return force, pressure
