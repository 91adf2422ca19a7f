"""The field of an axially magnetised disc magnet, and its reading by a three-axis Hall chip below.

Two discs of magnetic charge, +- Br/mu0 each, integrated by Gauss' rule over the radius and the trapezoid
rule over the angle: within 1e-6 of the largest field from half a radius off the magnet on (tests compare
with magpylib). Own code, since estimates load numpy alone. z points away from the chip; fields in mT,
lengths in mm.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import pi

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
RADII, ANGLES = 16, 48
MU0 = 4e-7 * pi  # T m/A
STEP = 1e-20  # of the complex-step derivative: no digits are lost


@dataclass(frozen=True)
class Magnet:
    """Radius and height, mm; remanence, T, of the pole that faces away from the chip."""

    radius: float
    height: float
    remanence: float


@lru_cache(maxsize=16)
def _charges(radius: float) -> tuple[Array, Array, Array]:
    """x, y and area of the points that represent a disc of charge, mm and mm2."""
    q, weight = np.polynomial.legendre.leggauss(RADII)
    r = radius * (q + 1.0) / 2.0
    area = (weight * radius / 2.0 * r)[:, None] * np.full(ANGLES, 2.0 * pi / ANGLES)
    phi = 2.0 * pi * np.arange(ANGLES) / ANGLES
    return np.multiply.outer(r, np.cos(phi)).ravel(), np.multiply.outer(r, np.sin(phi)).ravel(), area.ravel()


def field(magnet: Magnet, at: NDArray) -> NDArray:
    """Field (mT) of a magnet at points (..., 3); the origin is the middle of its lower face."""
    x, y, area = _charges(magnet.radius)
    total = np.zeros(at.shape, dtype=at.dtype)
    for z, sign in ((magnet.height, 1.0), (0.0, -1.0)):
        d = at[..., None, :] - np.stack([x, y, np.full_like(x, z)], axis=-1)
        distance = np.sqrt((d * d).sum(axis=-1))
        total += sign * np.einsum("...qi,q->...i", d / distance[..., None] ** 3, area)
    return 1e3 * magnet.remanence / (4.0 * pi) * total


@lru_cache(maxsize=256)
def pull(magnet: Magnet, away: tuple[float, float]) -> float:
    """Force, N, of an equal magnet beside this one: charges of one height repel each other, those a height
    apart attract."""
    x, y, area = _charges(magnet.radius)
    dx, dy = away[0] + np.subtract.outer(x, x), away[1] + np.subtract.outer(y, y)
    level = dx * dx + dy * dy
    across = level + magnet.height**2
    weight = np.multiply.outer(area, area)
    weight *= 1.0 / (level * np.sqrt(level)) - 1.0 / (across * np.sqrt(across))
    charge = 1e-6 * magnet.remanence**2 / (4.0 * pi * MU0)
    return 2.0 * charge * float(np.hypot((weight * dx).sum(), (weight * dy).sum()))


def felt(
    magnet: Magnet, gap: float, lever: float, motion: NDArray, beside: tuple[float, float] = (0.0, 0.0)
) -> NDArray:
    """Field at a chip `gap` below a magnet at rest, offset by `beside`, for island motions (..., 6): mm and
    rad.

    The magnet's lower face is `lever` below the island's middle. A turn moves it and tips it; to first
    order of the turn, the field is that of the upright magnet at the chip's place as the magnet sees it,
    turned back.
    """
    d, a = motion[..., :3], motion[..., 3:]
    arm = np.array([0.0, 0.0, -lever])
    origin = d + np.cross(a, arm)
    chip = np.array([*beside, -gap]) - origin
    seen = chip - np.cross(a, chip)
    b = field(magnet, seen)
    return b + np.cross(a, b)


@lru_cache(maxsize=256)
def sensitivity(
    magnet: Magnet, gap: float, lever: float, beside: tuple[float, float] = (0.0, 0.0)
) -> tuple[Array, Array]:
    """Field at rest (mT) and its derivatives by the island's six freedoms, (3, 6): mT/mm and mT/rad, by
    complex steps."""
    at_rest = felt(magnet, gap, lever, np.zeros(6), beside)
    slope = felt(magnet, gap, lever, 1j * STEP * np.eye(6), beside).imag / STEP
    return at_rest, slope.T
