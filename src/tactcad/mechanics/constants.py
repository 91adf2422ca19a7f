"""The fitted constants, read from the file that `benchmarks/ladder_fit.py` writes; never typed in."""

from __future__ import annotations

import json
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .section import Array


@lru_cache(maxsize=1)
def ladder_data() -> dict:
    """data/ladder.json as written by the fit."""
    # not importlib.resources, which takes longer to import than all of this room
    return json.loads((Path(__file__).parent / "data" / "ladder.json").read_text("utf-8"))


@lru_cache(maxsize=1)
def strain_data() -> dict:
    """data/strain.json as written by the fit."""
    return json.loads((Path(__file__).parent / "data" / "strain.json").read_text("utf-8"))


def by_sides(
    group: str, two_sided: NDArray[np.bool_] | np.bool_, data: dict | None = None
) -> dict[str, Array | float]:
    """Constants of a group ("root", "width", ...) for each design's notch form.

    From `data` (as data/ladder.json), by default the shipped ones. Plain floats if all designs have one form,
    so that the common case needs no array.
    """
    table = (data or ladder_data())[group]
    if np.all(two_sided):
        return table["two"]
    if not np.any(two_sided):
        return table["one"]
    return {k: np.where(two_sided, table["two"][k], table["one"][k]) for k in table["two"]}
