"""Coupling of the pads through one continuous rubber sample.

The sample is an elastic layer bonded to a rigid base (or a half-space), each pad a rectangle of even
pressure. In the plane of wave numbers a normal load gives the surface 2 (1 - nu^2)/E phi(k h)/k, with
(bonded layer) phi = ((3 - 4 nu) sinh 2c - 2c)/((3 - 4 nu) cosh 2c + 2 c^2 + 5 - 12 nu + 8 nu^2), c = k h;
phi = 1 for the half-space. Source: Johnson, Contact Mechanics, and Gladwell, Contact Problems in the
Classical Theory of Elasticity.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactcad.mechanics import lumped

WAVES = 1200  # wave numbers, to LARGEST/pad size
ANGLES = 96
LARGEST = 60.0
FAR = 50.0  # mm


@dataclass(frozen=True)
class Coupling:
    """Elements on one continuous sample compared with the same elements each on an independent spring.

    stiffness: the array's stiffness over that on independent springs. ratio: R of each element over equation
    (2).
    """

    stiffness: float
    ratio: np.ndarray


def layer_factor(c: np.ndarray, poisson: float) -> np.ndarray:
    """phi of a bonded layer, c = k h; 1 if c is large."""
    m = 3 - 4 * poisson
    small = np.minimum(c, 40.0)
    top = m * np.sinh(2 * small) - 2 * small
    bottom = m * np.cosh(2 * small) + 2 * small**2 + 5 - 12 * poisson + 8 * poisson**2
    return np.where(c > 40.0, 1.0, top / bottom)


def _waves(
    k: np.ndarray, length: float, width: float, thickness: float, poisson: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Share of each wave in a pad's mean displacement under its own even pressure, [number, angle], and the
    waves' numbers along x and y, 1/mm."""
    angle = (np.arange(ANGLES) + 0.5) * (np.pi / 2) / ANGLES
    kx, ky = np.outer(k, np.cos(angle)), np.outer(k, np.sin(angle))
    phi = 1.0 if np.isinf(thickness) else layer_factor(k * thickness, poisson)[:, None]
    return phi * (np.sinc(kx * length / 2 / np.pi) * np.sinc(ky * width / 2 / np.pi)) ** 2, kx, ky


def influence(
    dx: np.ndarray, dy: np.ndarray, length: float, width: float, thickness: float, poisson: float
) -> np.ndarray:
    """Mean displacement of a pad under a force on another one, over that under the same force on itself.

    Parameters
    ----------
    dx, dy : ndarray, shape (n,)
        From the loaded pad to the other one, mm.
    length, width
        Of every pad along x and y, mm.
    thickness
        Of the sample, mm; inf for a half-space.
    poisson
        Of the sample.

    Returns
    -------
    ndarray, shape (n,)
        1 at distance 0.
    """
    k = (np.arange(WAVES) + 0.5) * LARGEST / (length * width) ** 0.5 / WAVES
    weight, kx, ky = _waves(k, length, width, thickness, poisson)
    own = weight.sum()

    def share(x: float, y: float) -> float:
        """Beyond FAR the sum over waves would alias: a layer transmits nothing there, a half-space as 1/r."""
        r = float(np.hypot(x, y))
        if r > FAR and np.isfinite(thickness):
            return 0.0
        near = FAR / max(r, FAR)
        return near * float((weight * np.cos(kx * x * near) * np.cos(ky * y * near)).sum() / own)

    return np.array([share(x, y) for x, y in zip(dx, dy)])


def shares_between(
    x: np.ndarray, y: np.ndarray, length: float, width: float, thickness: float, poisson: float
) -> np.ndarray:
    """`influence` of every pad on every other.

    Parameters
    ----------
    x, y : ndarray, shape (n,)
        Centres of the pads, mm.
    length, width, thickness, poisson
        As for `influence`.

    Returns
    -------
    ndarray, shape (n, n)
        1 on the diagonal.
    """
    dx, dy = np.abs(x[:, None] - x[None, :]), np.abs(y[:, None] - y[None, :])
    places, index = np.unique(
        np.round(np.column_stack([dx.ravel(), dy.ravel()]), 6), axis=0, return_inverse=True
    )
    return influence(places[:, 0], places[:, 1], length, width, thickness, poisson)[index].reshape(dx.shape)


def coupling(
    K: np.ndarray,
    x: np.ndarray,
    y: np.ndarray,
    object_stiffness: float,
    reference: int,
    length: float,
    width: float,
    thickness: float,
    poisson: float,
) -> Coupling:
    """Elements pressed together into one sample, compared with independent springs of the same stiffness.

    Parameters
    ----------
    K : ndarray, shape (n,)
        Stiffness of the elements, N/mm.
    x, y : ndarray, shape (n,)
        Centres of their pads, mm.
    object_stiffness
        Of the sample under one pad alone, N/mm.
    reference
        Index of the reference element.
    length, width, thickness, poisson
        As for `influence`.
    """
    A = shares_between(x, y, length, width, thickness, poisson) / object_stiffness
    force = np.linalg.solve(np.diag(1 / K) + A, np.ones(len(K)))
    alone = lumped.element_deflection(K, object_stiffness, 1.0)
    deflection = force / K
    ratio = (deflection / deflection[reference]) / (alone / alone[reference])
    return Coupling(float(force.sum() / (K * alone).sum()), ratio)


def pad_stiffness(modulus: float, length: float, width: float, thickness: float, poisson: float) -> float:
    """Force on one pad over its mean displacement on an elastic layer, N/mm: K_obj of a modulus.

    The pressure is even; a rigid pad of 2 x 3 mm is 8.8 % stiffer on a half-space, 10.3 % on a layer of
    10 mm, 11.4 % on 6 mm and 13.1 % on 3 mm (finer patches than contact.press, nu 0.49).

    Parameters
    ----------
    modulus
        E of the layer, MPa.
    length, width
        Of the pad, mm.
    thickness
        Of the layer, bonded to a rigid base, mm; inf for a half-space.
    poisson
        Of the layer.
    """
    k = (np.arange(WAVES) + 0.5) * LARGEST / (length * width) ** 0.5 / WAVES
    weight, _, _ = _waves(k, length, width, thickness, poisson)
    area = (k[1] - k[0]) * (np.pi / 2 / ANGLES)
    return float(np.pi**2 * modulus / (2 * (1 - poisson**2)) / (weight.sum() * area))
