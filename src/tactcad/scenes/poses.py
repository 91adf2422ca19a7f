"""Configurations of the scenes: those that are checked, and what an option asks for."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from tactcad.design.family import family_of
from tactcad.design.messages import InputError, one_of
from tactcad.design.text_values import as_number, as_whole
from tactcad.design.tree import CommonTables

from .rig import rig_of
from .scene import Pose

LEAST = 1e-3  # mm; less is more likely a typing error, and the CAD kernel drops edges that short


def poses(design: CommonTables, name: str) -> tuple[Pose, ...]:
    """Every pose of a scene that is checked, apart from its rest pose."""
    return tuple(rig_of(design, name).poses(design))


def pose_of(given: Sequence[str], design: CommonTables) -> Pose | None:
    """The pose that KEY=VALUE texts describe; None if there are none. Raises InputError if they
    describe none.
    """
    grasping, cart = (getattr(design, table, None) for table in ("grasping", "cart"))
    limits = {
        "element": (1, len(family_of(design).layout(design).elements)),
        "deflection": (0.0, 5.0),
        "weights": (0, grasping.weights if grasping else 0),
        "height": (0.0, max(grasping.lift if grasping else 0.0, 5.0)),
        "cart": (-cart.roll, cart.roll) if cart else (0.0, 0.0),
    }
    values: dict[str, Any] = {}
    for text in given:
        key, _, value = text.partition("=")
        if key not in limits:
            raise InputError("--pose", "unknown key", value=text, legal=one_of(key, limits))
        low, high = limits[key]
        legal = f"{key} from {low:g} to {high:g}"
        try:
            number = as_whole(value) if isinstance(low, int) else as_number(value)
        except ValueError:
            raise InputError("--pose", "not a number", value=text, legal=legal) from None
        if not low <= number <= high:
            raise InputError("--pose", "out of range", value=text, legal=legal)
        if 0 < abs(number) < LEAST:
            raise InputError("--pose", "below a micrometre", value=text, legal=f"0, or {LEAST:g} mm and more")
        values[key] = number
    return Pose(**values) if values else None
