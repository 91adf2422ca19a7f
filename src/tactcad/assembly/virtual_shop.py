"""The virtual shop: it makes every dimension of every part somewhere within its limits."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Literal

import numpy as np
from scipy.special import ndtr, ndtri

from tactcad.mechanics.section import Array
from tactcad.scenes.requirement import Deviations, DimensionLimits

Distribution = Literal["normal", "uniform", "corners"]
# Limits stand at two standard deviations, and what lies beyond them is sorted out.
SIGMAS = 2.0
# Share of a dimension's variance that one machine's offset gives all pieces of a batch alike; chosen: as much
# as each piece has of its own.
OFFSET_SHARE = 0.5


def made(
    variables: Mapping[str, DimensionLimits],
    count: int,
    distribution: Distribution,
    rng: np.random.Generator,
    only: Collection[str] | None = None,
    alike: bool = True,
) -> Deviations:
    """Deviations of the parts of `count` arrays.

    Parameters
    ----------
    variables
        Every dimension with its limits.
    count
        Arrays to make parts for.
    distribution
        `normal`, cut at its limits, which stand at SIGMAS standard deviations; `uniform` between them;
        `corners`: on one of them.
    rng
        Source of chance.
    only
        Names of variables that differ at all; the others are at the middle of their limits.
    alike
        Whether pieces of one array share their machine's offset.

    Returns
    -------
    dict of str to Array
        By variable, of shape (count, pieces). Pieces of one array share an offset: a Gaussian copula with a
        correlation of OFFSET_SHARE, so that each piece's own distribution is just the one asked for.
    """
    out = {}
    own_chance = rng.spawn(1)[0]  # which draws nothing from rng itself
    for name, v in variables.items():
        chance = own_chance if v.apart else rng
        middle, half = (v.upper + v.lower) / 2, (v.upper - v.lower) / 2
        if only is not None and name not in only:
            out[name] = np.broadcast_to(middle, (count, v.pieces))
            continue
        shared, own = chance.standard_normal((count, 1)), chance.standard_normal((count, v.pieces))
        z = np.sqrt(OFFSET_SHARE) * shared + np.sqrt(1.0 - OFFSET_SHARE) * own if alike else own
        out[name] = middle + half * within_limits(z, distribution)
    return out


def within_limits(z: Array, distribution: Distribution) -> Array:
    """Standard normal numbers as shares of the way from the middle (0) to the limits (-1, 1)."""
    if distribution == "corners":
        return np.where(z < 0.0, -1.0, 1.0)
    share = ndtr(z)
    if distribution == "uniform":
        return 2.0 * share - 1.0
    least = ndtr(-SIGMAS)
    return ndtri(least + share * (1.0 - 2.0 * least)) / SIGMAS
