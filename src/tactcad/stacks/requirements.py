"""Requirements on parts that make a sensor: limits, and each one's value in an array."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from math import inf

from tactcad.parts.array.clamp import HOLES, carrier, carrier_clearance
from tactcad.parts.array.layout import SUNK, Layout
from tactcad.parts.array.stop_gap import stop_limits
from tactcad.parts.bought.standard_parts import LEAST_PLAY
from tactcad.parts.language.limits import deviations, general
from tactcad.parts.language.metric import METRIC
from tactcad.parts.language.stock import PLACE
from tactcad.scenes.requirement import LEAST_PRESS, DimensionLimits, Requirement, summed, variable
from tactcad.scenes.rig import rig_of
from tactcad.scenes.scene import Scene

from .screwed_joints import LENGTH, ScrewedJoint, joints, patterns, screwed, thickness
from .variables import SHEET, SPACER, STACK_LENGTH, STOP_PLATE, array_variables

# Least engaged thread at any limits, in diameters: the torques of data/screws.csv are half of what the screw
# bears, for which 1.5 d of aluminium are usual; bought parts have threads in steel.
LEAST_ENGAGED, LEAST_IN_STEEL = 1.0, 0.6
# Least space between neighbours, mm; chosen: twice the burr and roughness of cut faces.
LEAST_BETWEEN = 0.02


def requirements(
    layout: Layout, scenes: Sequence[Scene]
) -> tuple[dict[str, DimensionLimits], list[Requirement]]:
    """Requirements on an array, on the screwed joints of its scenes and on its rigs, and the variables they
    depend on."""
    known, name = array_variables(layout), layout.design.name
    wanted = _array_requirements(layout, known)
    of_rigs, apart = _rig_requirements(layout, scenes, known)
    wanted += of_rigs
    entered: dict[tuple, Requirement] = {}
    seen: dict[tuple, ScrewedJoint] = {}
    for scene in scenes:
        screws = screwed(scene)
        for joint in joints(name, screws, known):
            seen.setdefault((joint.name, joint.engaged, joint.room, joint.terms), joint)
        for pattern in patterns(layout, screws, known):
            entered.setdefault((pattern.name, pattern.upper, pattern.linear), pattern)
    wanted += entered.values()
    names = Counter(joint.name for joint in seen.values())
    for joint in seen.values():
        which = f", {joint.engaged:g} mm engaged" if names[joint.name] > 1 else ""
        wanted += _joint_requirements(joint, f"{joint.name}{which}")
    known |= apart[0]
    return known, wanted + apart[1]


Of = tuple[dict[str, DimensionLimits], list[Requirement]]


def _rig_requirements(
    layout: Layout, scenes: Sequence[Scene], known: dict[str, DimensionLimits]
) -> tuple[list[Requirement], Of]:
    """Requirements of the rigs that these scenes show, each once; apart, with their variables, those of rigs
    that no array depends on. Backwards through the rigs: the order in which stack.csv has always been."""
    wanted: dict[str, Requirement] = {}
    apart: Of = ({}, [])
    for rig in reversed([rig_of(layout.design, scene.name) for scene in scenes]):
        own: dict[str, DimensionLimits] = {}
        of_rig = rig.requirements(layout, own)
        if own and all(v.apart for v in own.values()):
            apart[0].update(own)
            apart[1].extend(of_rig)
        else:
            wanted |= {r.name: r for r in of_rig}
            known |= own
    return list(wanted.values()), apart


def _array_requirements(layout: Layout, known: dict[str, DimensionLimits]) -> list[Requirement]:
    t = layout.design.tolerance
    rows = len(layout.design.array.row_arms)
    gap, apart = rows * layout.pad_inner, rows * t.load_arm
    limit = stop_limits(layout).gap
    return [
        Requirement("pins hold in the tapped end plate", "mm", LEAST_PRESS, inf, lambda a: a.press),
        Requirement("pins enter the elements", "mm", LEAST_PLAY, inf, lambda a: a.play),
        Requirement("pins enter the head end plate", "mm", 0.0, inf, lambda a: a.head_misses),
        Requirement("pads coplanar", "mm", -inf, 2 * t.pad_height, lambda a: a.pads_apart),
        Requirement("pads square to the carrier", "degree", -t.tilt, t.tilt, lambda a: a.tilt),
        Requirement(
            "gap between rows" if rows > 1 else "tips from the middle line",
            "mm",
            gap - apart,
            gap + apart,
            lambda a: a.row_gaps,
        ),
        summed("neighbours free", LEAST_BETWEEN, inf, layout.spacer, ((SPACER, 1.0), (SHEET, -1.0))),
        Requirement("stop closes within the rated deflection", "mm", 0.0, inf, lambda a: limit - a.gaps),
        Requirement("stop keeps the hinge from yielding, as made", "", -inf, 1.0, lambda a: a.yield_shares),
        _carrier_mounts(layout, known),
        _set_screws_sunk(layout, known),
    ]


def _carrier_mounts(layout: Layout, known: dict[str, DimensionLimits]) -> Requirement:
    """The carrier's holes take the distance that the stack gives the end plates: both ways."""
    d = layout.design.clamp
    hole = carrier_clearance(layout)
    room = round(hole - general(hole) - METRIC[d.screw].d, 9)
    threads, holes = "end plates: carrier threads' places", "carrier: screw holes' places"
    for name in (threads, holes):
        known.setdefault(name, variable(name, -PLACE / 2, PLACE / 2, 2))
    terms = ((STACK_LENGTH, 1.0), (threads, 1.0), (holes, 1.0))
    return summed("carrier's screws enter the end plates", -room, room, 0.0, terms)


def _set_screws_sunk(layout: Layout, known: dict[str, DimensionLimits]) -> Requirement:
    """The axis's plate lies flat on the carrier: set screws end below its top."""
    d, t = layout.design.clamp, layout.design.tolerance
    # the edge over the dowel holes, these over the pads, and the ledges over those
    edge = HOLES / 2 + t.pad_height + t.ledge
    known.setdefault(name := "end plates: upper edge over the ledge", variable(name, -edge, edge))
    length = layout.hold_down.length or 0.0
    screw = f"{d.screw}x{length:g} set screw: length"
    known.setdefault(screw, variable(screw, *deviations(LENGTH, length)))
    terms = ((thickness(carrier(layout), known), 1.0), (name, 1.0), (screw, -1.0), (STOP_PLATE, -1.0))
    return summed("set screws end below the carrier's top", 0.0, inf, SUNK, terms)


def _joint_requirements(joint: ScrewedJoint, who: str) -> list[Requirement]:
    diameter = float(joint.thread[1:])
    least = LEAST_IN_STEEL if joint.bought else LEAST_ENGAGED
    wanted = [summed(f"{who}: engages", least * diameter, inf, joint.engaged, joint.terms)]
    if joint.room is not None:
        inside = [(v, -c) for v, c in joint.terms]
        terms = tuple(inside) + (((joint.deeper, 1.0),) if joint.deeper else ())
        wanted.append(summed(f"{who}: clamps before it bottoms", 0.0, inf, joint.room, terms))
    return wanted
