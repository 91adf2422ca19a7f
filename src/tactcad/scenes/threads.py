"""Allowed overlap of a screw with its tapped part: the thread's ring over the engaged length."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi

import numpy as np

from tactcad.parts.language.description import Extrusion, Hole, Part, Revolution
from tactcad.scenes.scene import Placement

# Largest deviation of a screw from its hole's axis (mm and radians).
COAXIAL = 1e-6


def thread_overlap(first: Placement, second: Placement) -> float:
    """Largest overlap (mm3) that a thread between the two explains: pi/4 (D^2 - d^2) e, with D the thread's
    major diameter, d the tapped hole's as drilled, e the length of full thread that the screw reaches into.

    The screw's axis is its part's z. 0 if neither is in a tapped hole of the other.
    """
    return max((_ring(hole, *ends) for hole, *ends in engaged(first, second)), default=0.0)


def _ring(hole: Hole, start: float, end: float) -> float:
    from_, to = thread_range(hole)
    return pi / 4 * (hole.thread_diameter**2 - hole.diameter**2) * max(0.0, min(end, to) - max(start, from_))


def thread_range(hole: Hole) -> tuple[float, float]:
    """Range along its axis in which a hole has full thread, mm; it begins under a counterbore."""
    start = hole.counterbore[1] if hole.counterbore else 0.0
    return start, start + hole.thread_depth


def engaged(first: Placement, second: Placement) -> Iterator[tuple[Hole, float, float]]:
    """Tapped holes of either part with the other one in their axis, and the range along that axis."""
    for tapped, screw in ((first, second), (second, first)):
        turn, low_high = np.array(tapped.rotation), _along_z(screw.part)
        axis = np.array(screw.rotation)[:, 2]
        for hole in tapped.part.features:
            if not (isinstance(hole, Hole) and hole.thread) or low_high is None:
                continue
            along, mouth = turn @ np.array(hole.axis, float), turn @ np.array(hole.at, float) + tapped.origin
            way = np.array(screw.origin) - mouth
            beside = way - (way @ along) * along
            if abs(abs(axis @ along) - 1.0) > COAXIAL or np.linalg.norm(beside) > COAXIAL:
                continue
            ends = sorted(float(way @ along + z * (axis @ along)) for z in low_high)
            yield hole, ends[0], ends[1]


def _along_z(part: Part) -> tuple[float, float] | None:
    """The part's extent along its own z, mm."""
    if isinstance(part.body, Extrusion):
        return 0.0, part.body.thickness
    return (part.body.profile.box[1], part.body.profile.box[3]) if isinstance(part.body, Revolution) else None
