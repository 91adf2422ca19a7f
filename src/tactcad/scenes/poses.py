"""Configurations of the scenes that are checked besides their rest pose."""

from __future__ import annotations

from collections.abc import Sequence
from math import floor
from typing import Any

from tactcad.design.messages import InputError, one_of
from tactcad.design.plain_numbers import as_number, as_whole
from tactcad.design.present import present
from tactcad.design.tree import Design
from tactcad.parts.rigs.calibration_loads import calibration_loads

from .scene import Pose

LEAST = 1e-3  # mm; less is more likely a typing error, and the CAD kernel drops edges that short


def poses(design: Design, name: str) -> tuple[Pose, ...]:
    """Every pose of a scene that is checked, apart from its rest pose.

    Calibration: every element under the sensor, deflected by its stage's whole travel. Sample stiffness: the
    tip half and all the way into the sample. Grasping: the array lifted, without weights, and pressed in.
    """
    if name == "calibration":
        # to a micrometre, which a check can resolve; an element that the estimator refuses, as if it had no
        # stiffness
        free = [
            present(design.calibration).travel if load.refused else load.deflection
            for load in calibration_loads(design)
        ]
        deflections = [floor(d * 1e3 + 1e-6) / 1e3 for d in free]
        return tuple(Pose(element=n, deflection=d) for n, d in enumerate(deflections, start=1))
    if name == "sample-stiffness":
        travel = present(design.sample).travel
        return (
            Pose(deflection=travel / 2),
            Pose(deflection=travel),
            Pose(cart=present(design.cart).roll / 2, height=1.0),
        )
    if name == "grasping":
        return (
            Pose(weights=0),
            Pose(height=present(design.grasping).lift, weights=0, cart=present(design.cart).roll),
            *_pressed_in(design),
        )
    return ()


def under_sensor(design: Design, name: str) -> tuple[Pose, ...]:
    """Each element under the force sensor and touched, by number; none of a scene without a sensor that goes
    from one to the next."""
    count = sum(len(row) for row in design.array.row_arms) if name == "calibration" else 0
    return tuple(Pose(element=n) for n in range(1, count + 1))


def _pressed_in(design: Design) -> tuple[Pose, ...]:
    """The pads in the sample: by its travel, but no deeper than they stand out of the arms' root fillets."""
    e = design.element
    deep = floor(min(present(design.sample).travel, e.pad_height - e.pad_root_radius) * 1e3 + 1e-6) / 1e3
    return (Pose(deflection=deep),) if deep > 0 else ()


def pose_of(given: Sequence[str], design: Design) -> Pose | None:
    """The pose that KEY=VALUE texts describe; None where there are none. Raises InputError where they
    describe none.
    """
    limits = {
        "element": (1, sum(len(row) for row in design.array.row_arms)),
        "deflection": (0.0, 5.0),
        "weights": (0, design.grasping.weights if design.grasping else 0),
        "height": (0.0, max(design.grasping.lift if design.grasping else 0.0, 5.0)),
        "cart": (-design.cart.roll, design.cart.roll) if design.cart else (0.0, 0.0),
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
