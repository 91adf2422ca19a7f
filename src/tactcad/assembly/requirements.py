"""What must hold for parts to make a sensor: requirements with limits, and the value of each in an array."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf

import numpy as np

from tactcad.parts.carrier import PLACE, carrier, carrier_clearance
from tactcad.parts.end_plate import HOLES, SCREWS
from tactcad.parts.layout import SUNK, Layout
from tactcad.parts.library.fits import deviations
from tactcad.parts.library.screws import METRIC
from tactcad.parts.stop_gap import stop_limit
from tactcad.scenes.scene import Scene

from .mechanic import Assembled
from .screwed_joints import LENGTH, ScrewedJoint, joints, thickness
from .variables import STACK_LENGTH, Array, DimensionLimits, array_variables, variable

# Least engaged thread at any limits, in diameters: the torques of data/screws.csv are half of what the screw
# bears, for which 1.5 d of aluminium are usual; bought parts have threads in steel.
LEAST_ENGAGED, LEAST_IN_STEEL = 1.0, 0.6
# Least diametral play of a sliding pin, and least interference of a pressed one, mm; chosen: what a plug
# gauge tells from none.
LEAST_PLAY = LEAST_PRESS = 0.002

# Least space between neighbours, mm; chosen: twice what cut faces may stand out by burr and roughness.
LEAST_BETWEEN = 0.02

Value = Callable[[Assembled], Array]


@dataclass(frozen=True)
class Requirement:
    """A requirement on every array.

    name          what must hold
    unit          of value and limits
    lower, upper  limits, -inf or inf where there is none
    value         (arrays, instances) of arrays that were put together
    linear        where the value is a sum of deviations: the nominal value, and each variable's coefficient;
                  such a value does not depend on the array's contacts
    """

    name: str
    unit: str
    lower: float
    upper: float
    value: Value
    linear: tuple[float, tuple[tuple[str, float], ...]] | None = None

    def margin(self, value: Array) -> Array:
        """How far inside its limits a value is, in its unit; negative outside."""
        return np.minimum(value - self.lower, self.upper - value)


def requirements(
    layout: Layout, scenes: Sequence[Scene]
) -> tuple[dict[str, DimensionLimits], list[Requirement]]:
    """Requirements on an array and on the screwed joints of its scenes, and the variables they depend on."""
    known = array_variables(layout)
    wanted = _array_requirements(layout, known)
    seen: dict[tuple, ScrewedJoint] = {}
    for scene in scenes:
        for joint in joints(layout.design.name, scene, known):
            seen.setdefault((joint.name, joint.engaged, joint.room, joint.terms), joint)
    names = Counter(joint.name for joint in seen.values())
    for joint in seen.values():
        which = f", {joint.engaged:g} mm engaged" if names[joint.name] > 1 else ""
        wanted += _joint_requirements(joint, f"{joint.name}{which}")
    return known, wanted


def _array_requirements(layout: Layout, known: dict[str, DimensionLimits]) -> list[Requirement]:
    t = layout.design.tolerance
    gap = 2 * layout.pad_inner
    limit = np.array([stop_limit(layout, p).gap for p in layout.elements])
    return [
        Requirement("pins hold in the tapped end plate", "mm", LEAST_PRESS, inf, lambda a: a.press),
        Requirement("pins enter the elements", "mm", LEAST_PLAY, inf, lambda a: a.play),
        Requirement("pins enter the head end plate", "mm", 0.0, inf, lambda a: a.head_misses),
        Requirement("pads coplanar", "mm", -inf, 2 * t.pad_height, lambda a: a.pads_apart),
        Requirement("pads square to the carrier", "degree", -t.tilt, t.tilt, lambda a: a.tilt),
        Requirement(
            "gap between rows", "mm", gap - 2 * t.load_arm, gap + 2 * t.load_arm, lambda a: a.row_gaps
        ),
        _sum(
            "neighbours free",
            LEAST_BETWEEN,
            inf,
            layout.spacer,
            (("spacer: thickness", 1.0), ("sheet: thickness", -1.0)),
        ),
        Requirement("stop closes within the rated deflection", "mm", 0.0, inf, lambda a: limit - a.gaps),
        _carrier_mounts(layout, known),
        _set_screws_sunk(layout, known),
    ]


def _sum(
    name: str, lower: float, upper: float, nominal: float, terms: tuple[tuple[str, float], ...]
) -> Requirement:
    """A requirement on a sum of deviations of all pieces, mm."""

    def value(a: Assembled) -> Array:
        return nominal + sum((c * a.made[v].sum(axis=1, keepdims=True) for v, c in terms), np.zeros((1, 1)))

    return Requirement(name, "mm", lower, upper, value, (nominal, terms))


def _carrier_mounts(layout: Layout, known: dict[str, DimensionLimits]) -> Requirement:
    """The carrier's holes take the distance that the stack gives the end plates: both ways."""
    d = layout.design.clamp
    room = carrier_clearance(layout) - METRIC[d.screw].d
    for name, zone in (
        ("end plates: carrier threads' places", SCREWS),
        ("carrier: screw holes' places", PLACE),
    ):
        known.setdefault(name, variable(name, -zone / 2, zone / 2, 2))
    terms = (
        (STACK_LENGTH, 1.0),
        ("end plates: carrier threads' places", 1.0),
        ("carrier: screw holes' places", 1.0),
    )
    return _sum("carrier's screws enter the end plates", -room, room, 0.0, terms)


def _set_screws_sunk(layout: Layout, known: dict[str, DimensionLimits]) -> Requirement:
    """The axis's plate lies flat on the carrier: set screws end below its top."""
    d, t = layout.design.clamp, layout.design.tolerance
    # the edge over the dowel holes, these over the pads, and the ledges over those
    edge = HOLES / 2 + t.pad_height + t.ledge
    known.setdefault(name := "end plates: upper edge over the ledge", variable(name, -edge, edge))
    length = layout.hold_down.length or 0.0
    screw = f"{d.screw}x{length:g} set screw: length"
    known.setdefault(screw, variable(screw, *deviations(LENGTH, length)))
    terms = (
        (thickness(carrier(layout), known), 1.0),
        (name, 1.0),
        (screw, -1.0),
        ("stop plate: thickness", -1.0),
    )
    return _sum("set screws end below the carrier's top", 0.0, inf, SUNK, terms)


def _joint_requirements(joint: ScrewedJoint, who: str) -> list[Requirement]:
    diameter = float(joint.thread[1:])
    least = LEAST_IN_STEEL if joint.bought else LEAST_ENGAGED
    wanted = [_sum(f"{who}: engages", least * diameter, inf, joint.engaged, joint.terms)]
    if joint.room is not None:
        inside = [(v, -c) for v, c in joint.terms]
        terms = tuple(inside) + (((joint.deeper, 1.0),) if joint.deeper else ())
        wanted.append(_sum(f"{who}: clamps before it bottoms", 0.0, inf, joint.room, terms))
    return wanted
