"""How fast this machine is beside the one that costs were measured on: a calibration, kept in the cache."""

from __future__ import annotations

import json
import time
from contextlib import suppress

import numpy as np

from tactcad.export.cache import Cache, default_root
from tactcad.export.inputs import digest
from tactcad.mechanics import ladder
from tactcad.mechanics.section import REFERENCE

from .machine import processor

TABLE, ALONE = 10_000, 100  # designs in one call, which numpy spends on arrays, and one a call, on Python
REPEATS = 5  # the shortest counts: disturbances only add time; in all half a second
KEPT = 24 * 3600.0  # s; chosen: a machine that was slow for hours is measured again the next day


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
