"""The rungs of the object's ladder: what error of the pads' forces each states, and how deep it reaches.

An error is the largest difference of a pad's force over the mean force of the pads that touch.
`data/errors.json`, written by `benchmarks/object_ladder.py`, holds what was found, with a margin.
"""

from __future__ import annotations

import json
from functools import lru_cache
from math import pi
from pathlib import Path

import numpy as np

from .elastic_body import Body
from .press import Pads, Pressed, pad_stiffness

CHOSEN_FROM = ("springs", "layer", "large")  # in the order of their work
RUNGS = ("springs", "layer", "fem-object", "large")
DEFAULT_RUNG = "layer"
# Of the lesser of a pad's radius and the thickness: past it, a linear rung's error is not measured.
LINEAR_REACH = 0.3
MOST_TILT = 1.5  # fall from a pad's middle to its edge over its depth, that was measured
REACH = 0.5  # of rung large: deeper, elements fold at the punch's edge


@lru_cache(maxsize=1)
def errors() -> dict:
    """data/errors.json."""
    return json.loads((Path(__file__).parent / "data" / "errors.json").read_text("utf-8"))


def pad_radius(pads: Pads) -> float:
    """Radius of a disc of the pads' area, mm."""
    return (pads.length * pads.width * (0.25 if pads.disc else 1 / pi)) ** 0.5


def depth_share(pads: Pads, body: Body, force: np.ndarray) -> float:
    """Depth of the deepest pad in a linear body under its own force, over the lesser of its radius and the
    thickness."""
    alone = pad_stiffness(body, pads.length, pads.width, pads.disc)
    return float(force.max() / alone / min(pad_radius(pads), body.thickness))


def strain_error(pads: Pads, body: Body, depth: float | np.ndarray) -> float | np.ndarray:
    """Largest error of a linear body's force on a pad, relative, where the deepest is `depth_share` deep."""
    data = errors()
    return np.interp(depth, data["depth"], data["strain"][_zone(pads, body)])


def stated_error(rung: str, pads: Pads, body: Body, force: np.ndarray) -> float:
    """Largest stated error of a rung for pads that bear these forces."""
    data, depth = errors(), depth_share(pads, body, force)
    # what neighbours change at large strain, which rung large does not know either
    deep = float(np.interp(depth, data["deep"], data["neighbours"][_zone(pads, body)]))
    if rung == "large":
        return data["layer"] + deep
    deep += float(strain_error(pads, body, depth))
    if rung == "springs":
        K = float((1 / pads.compliance[:, 0, 0]).max())
        hardness = K / (K + pad_stiffness(body, pads.length, pads.width, pads.disc))
        zone = int(np.searchsorted(data["hardness"], hardness))
        return data["springs"][min(zone, len(data["springs"]) - 1)] + deep
    return data[rung] + deep


def tilt_error(pads: Pads, body: Body, pressed: Pressed, angle: tuple[float, float]) -> float:
    """What a pad's tilt adds to the error of any rung whose body is exact for level pads or linear: at most
    a coefficient times depth times the square of the fall from middle to edge over the depth, as found under
    a long strip (benchmarks/tilted_strip.py). `angle` of the object's face, degrees."""
    alone = pad_stiffness(body, pads.length, pads.width, pads.disc)
    touch = pressed.force > 0
    depth = pressed.force[touch] / alone
    fall = np.abs(np.tan(np.radians(angle)) + pressed.slope[touch]) @ (pads.length, pads.width) / 2
    tilt = np.minimum(fall / depth, MOST_TILT)
    least = min(pad_radius(pads), body.thickness)
    return float((errors()["tilt"][_zone(pads, body)] * tilt**2 * depth / least).max())


def _zone(pads: Pads, body: Body) -> int:
    return int(np.searchsorted(errors()["thickness"], body.thickness / pad_radius(pads), side="right"))
