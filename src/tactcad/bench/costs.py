"""What work costs on this machine: published costs times this machine's calibration.

`data/costs.json` is written by benchmarks/costs.py, in processor seconds of the machine that it names, with
that machine's calibration.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .this_machine import calibrated

DATA = Path(__file__).parent / "data" / "costs.json"


@cache
def published() -> dict[str, Any]:
    """data/costs.json: s, and dimensionless exponents."""
    return json.loads(DATA.read_text("utf-8"))


@cache
def slowness() -> float:
    """This machine's seconds over the published machine's."""
    return calibrated() / published()["calibration_s"]


def here(seconds: float) -> float:
    """Published seconds as this machine's, to three digits."""
    return float(f"{slowness() * seconds:.3g}")


def power_law(fitted: Sequence[float], *sizes: NDArray[np.float64]) -> NDArray[np.float64]:
    """a x^p y^q ... from [a, p, q, ...]."""
    return fitted[0] * np.prod([x**p for x, p in zip(sizes, fitted[1:], strict=True)], axis=0)


def linear(fitted: Mapping[str, float], counts: Mapping[str, float]) -> float:
    """Sum of each count times its cost; `start` counts once."""
    return sum(each * counts.get(name, 1.0 if name == "start" else 0.0) for name, each in fitted.items())
