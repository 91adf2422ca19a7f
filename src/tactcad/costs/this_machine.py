"""What work costs on this machine: published costs times this machine's calibration, kept in the cache.

`data/costs.json` is written by benchmarks/costs.py, in processor seconds of the machine that it names, with
that machine's calibration.
"""

from __future__ import annotations

import json
import platform
import re
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tactcad.export.cache import Cache, default_root
from tactcad.export.inputs import digest
from tactcad.mechanics import ladder
from tactcad.mechanics.section import REFERENCE

DATA = Path(__file__).parent / "data" / "costs.json"
TABLE, ALONE = 10_000, 100  # designs in one call, which numpy spends on arrays, and one a call, on Python
REPEATS = 5  # the shortest counts: disturbances only add time; in all half a second
KEPT = 24 * 3600.0  # s; chosen: a machine that was slow for hours is measured again the next day


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


def calibration() -> float:
    """Processor seconds that a fixed piece of work takes here: rung solid over a table, and alone."""
    many = REFERENCE.with_(load_arm=np.linspace(5.0, 7.0, TABLE))

    def once() -> float:
        start = time.process_time()
        ladder.stiffness(many, ladder.DEFAULT_RUNG)
        for _ in range(ALONE):
            ladder.stiffness(REFERENCE, ladder.DEFAULT_RUNG)
        return time.process_time() - start

    return min(once() for _ in range(REPEATS))


def calibrated() -> float:
    """`calibration`, from the cache where it was measured here within a day."""
    cache = Cache(default_root())
    key = f"calibration {digest([processor(), np.__version__, TABLE, ALONE])}"
    with suppress(TypeError, ValueError):  # none there, or another's
        seconds, at = json.loads(cache.get(key) or b"")
        if 0.0 <= time.time() - at <= KEPT and seconds > 0.0:
            return float(seconds)
    seconds = calibration()
    cache.put(key, json.dumps([seconds, time.time()]).encode())
    return seconds


def processor() -> str:
    """Its model."""
    info = Path("/proc/cpuinfo")
    match = re.search(r"model name\s*:\s*(.+)", info.read_text()) if info.is_file() else None
    return match[1].strip() if match else platform.processor() or platform.machine()
