"""Any stretch of scipy's scrambled Sobol sequence, without drawing what stands before it.

A point is linear over GF(2) in the bits of its place: with x_i its coordinates as whole numbers of 2^-30,

    x_i = x_0 ^ XOR of (x_(2^k) ^ x_0) over the bits k that are set in i

so the points at 0 and at powers of two, drawn once by scipy, hold all others. scipy itself goes to a place
step by step: for every chunk a sequence would be drawn from its beginning, and every process would load
scipy.stats, which takes as long as a million closed forms.
"""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import NDArray

BITS = 30  # scipy's own: a place is below 2^30
Points = NDArray[np.uint32]


def points_at_powers(fields: int, count: int, seed: int) -> Points:
    """scipy's points at 0, 1, 2, 4, ... below `count`, one row each, a column a field, in units of 2^-30."""
    from scipy.stats import qmc

    sampler = qmc.Sobol(fields, bits=BITS, rng=seed)
    rows = []
    with warnings.catch_warnings():  # it wants powers of two; a study of any size is spread well enough
        warnings.simplefilter("ignore", UserWarning)
        for place in (0, *(1 << k for k in range((count - 1).bit_length()))):
            if ahead := place - sampler.num_generated:
                sampler.fast_forward(ahead)
            rows.append(sampler.random(1)[0])
    return (np.array(rows) * (1 << BITS)).astype(np.uint32)


def stretch(at_powers: Points, start: int, stop: int) -> NDArray[np.float64]:
    """Points of the unit cube at places `start` to `stop` (exclusive)."""
    first, directions = at_powers[0], at_powers[1:] ^ at_powers[0]
    bits = (stop - start - 1).bit_length()
    low = np.zeros((1, len(first)), np.uint32)
    for direction in directions[:bits]:
        low = np.concatenate([low, low ^ direction])
    blocks = []
    for block in range(start >> bits, ((stop - 1) >> bits) + 1):
        high = [d for k, d in enumerate(directions[bits:]) if block >> k & 1]
        blocks.append(low ^ np.bitwise_xor.reduce([first, *high]))
    skipped = start & ((1 << bits) - 1)
    return np.concatenate(blocks)[skipped : skipped + stop - start] * 2.0**-BITS
