"""Compliance of an elastic body's face under a normal load: half-space, bonded layer, layer that slips.

A force of 1 N moves the face, r away and without friction under the pads, by

    u(r) = (1 - nu^2)/(pi E) [1/r + G(r/h)/h],    G(q) = int_0^inf (phi(c) - 1) J0(c q) dc.

A pressure wave of number k moves the face by 2 (1 - nu^2)/E phi(k h)/k per pressure. Bonded to a rigid base:
phi = ((3 - 4 nu) sinh 2c - 2c)/((3 - 4 nu) cosh 2c + 2 c^2 + 5 - 12 nu + 8 nu^2); on a rigid base without
friction: phi = (cosh 2c - 1)/(sinh 2c + 2c); half-space: phi = 1. Source: Johnson, Contact Mechanics, chapter
5; Gladwell, Contact Problems in the Classical Theory of Elasticity.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import inf, isinf, pi

import numpy as np
from numpy.polynomial.legendre import leggauss
from scipy.interpolate import CubicSpline
from scipy.special import j0

from tactcad.design.messages import InputError, one_of

Rectangles = tuple[np.ndarray, ...]  # x, y, a, b: centres and sides, mm

DEEP = 40.0  # c from which on phi is 1 to the last digit
WAVES = 1200  # Gauss points up to DEEP: G to 1e-12 up to q = 20, where the face no longer feels the load
# layer thicknesses beyond which a layer's face does not move; it would by 1e-9 of the half-space's
FAR = 20.0
GRID = 2001  # of q in the table of G: 1e-9 against the integral


@dataclass(frozen=True)
class Body:
    """The object: Young's modulus (MPa), Poisson's ratio, thickness (mm; inf for a half-space), and whether
    its base is bonded or slips without friction.

    Raises
    ------
    InputError
        A value out of range.
    """

    modulus: float
    poisson: float
    thickness: float = inf
    base: str = "bonded"

    def __post_init__(self) -> None:
        if not 0 < self.modulus < inf:
            raise InputError("object E", "out of range", value=self.modulus, legal="above 0 MPa, finite")
        if not 0 <= self.poisson <= 0.5:
            raise InputError("object nu", "out of range", value=self.poisson, legal="from 0 to 0.5")
        if not self.thickness > 0:
            raise InputError(
                "object thickness", "out of range", value=self.thickness, legal="above 0 mm; inf: half-space"
            )
        if self.base not in BASES:
            raise InputError("object base", "unknown", value=self.base, legal=one_of(self.base, BASES))


def _bonded(c: np.ndarray, nu: float) -> np.ndarray:
    m = 3 - 4 * nu
    return (m * np.sinh(2 * c) - 2 * c) / (m * np.cosh(2 * c) + 2 * c**2 + 5 - 12 * nu + 8 * nu**2)


def _slippery(c: np.ndarray, nu: float) -> np.ndarray:
    return (np.cosh(2 * c) - 1) / (np.sinh(2 * c) + 2 * c)


BASES = {"bonded": _bonded, "frictionless": _slippery}


@lru_cache(maxsize=32)
def layer_correction(poisson: float, base: str) -> CubicSpline:
    """G of q = r/h, from 0 to FAR; -1/q beyond, where a layer's face does not move."""
    node, weight = leggauss(WAVES)
    c, weight = (node + 1) * DEEP / 2, weight * DEEP / 2
    q = FAR * np.linspace(0, 1, GRID) ** 2  # denser where G bends
    share = (BASES[base](c, poisson) - 1) * weight
    return CubicSpline(q, np.array([j0(c * at) @ share for at in q]))


def _fourfold(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """F with d^4F/dx^2 dy^2 = 1/r, but for terms that its second differences do not see."""
    x, y = np.abs(x), np.abs(y)
    with np.errstate(divide="ignore", invalid="ignore"):
        along = np.where(y > 0, x * y * y / 2 * np.arcsinh(x / y), 0.0)
        across = np.where(x > 0, x * x * y / 2 * np.arcsinh(y / x), 0.0)
    return along + across - np.hypot(x, y) ** 3 / 6


def mean_inverse(first: Rectangles, second: Rectangles) -> np.ndarray:
    """Mean of 1/r (1/mm) over the points of every two rectangles, [n, m], as of `influence`.

    Near ones by F at the sixteen differences of their edges; further off those differences lose digits, and
    1/r at the centres with its second moments is exact to 1e-5.
    """
    dx, dy, a, b = _apart(first, second)
    r = np.hypot(dx, dy)
    spread_x, spread_y = (a[0] ** 2 + a[1] ** 2) / 12, (b[0] ** 2 + b[1] ** 2) / 12
    with np.errstate(divide="ignore", invalid="ignore"):
        result = 1 / r + (spread_x * (2 * dx**2 - dy**2) + spread_y * (2 * dy**2 - dx**2)) / (2 * r**5)
    near = r < 10 * np.sqrt(np.maximum(spread_x, spread_y) * 6)
    x, y = dx[near], dy[near]
    (a0, a1), (b0, b1) = ([np.broadcast_to(s, near.shape)[near] for s in sides] for sides in (a, b))
    total = np.zeros(x.shape)
    for u in (-1, 1):
        for v in (-1, 1):
            right = x + (u * a0 - v * a1) / 2
            for s in (-1, 1):
                for t in (-1, 1):
                    total += u * v * s * t * _fourfold(right, y + (s * b0 - t * b1) / 2)
    result[near] = total / (a0 * a1 * b0 * b1)
    return result


def influence(
    body: Body, first: Rectangles, second: Rectangles | None = None, mean: np.ndarray | None = None
) -> np.ndarray:
    """Mean displacement of every rectangle of the face under 1 N spread evenly on every other one.

    Parameters
    ----------
    body
        What is pressed.
    first, second : four arrays (x, y, a, b) each, [n] and [m]
        Centres and sides of the rectangles, mm; second: those that are loaded, by default the first.
    mean
        Their `mean_inverse`, if it is known.

    Returns
    -------
    ndarray, [n, m]
        mm/N.
    """
    second = first if second is None else second
    mean = mean_inverse(first, second) if mean is None else mean
    if not isinf(body.thickness):
        mean = mean + _mean_correction(body, *_apart(first, second))
    return (1 - body.poisson**2) / (pi * body.modulus) * mean


def _apart(first: Rectangles, second: Rectangles) -> tuple[np.ndarray, np.ndarray, tuple, tuple]:
    """Distances of their centres along x and y, [n, m], and both's sides along x and along y."""
    (x, y, a, b), (x2, y2, a2, b2) = first, second
    return x[:, None] - x2, y[:, None] - y2, (a[:, None], a2), (b[:, None], b2)


def _mean_correction(body: Body, dx: np.ndarray, dy: np.ndarray, a: tuple, b: tuple) -> np.ndarray:
    """Mean of G(r/h)/h over two rectangles: at four points that keep the second moments of their distance."""
    h = body.thickness
    G = layer_correction(body.poisson, body.base)
    ox, oy = (np.sqrt((s[0] ** 2 + s[1] ** 2) / 12) for s in (a, b))
    total = np.zeros(np.broadcast_shapes(dx.shape, ox.shape))
    for s in (-1, 1):
        for t in (-1, 1):
            q = np.hypot(dx + s * ox, dy + t * oy) / h
            total += np.where(q < FAR, G(np.minimum(q, FAR)), -1 / np.maximum(q, FAR))
    return total / (4 * h)
