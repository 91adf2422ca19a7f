"""Screwed joints of a scene as stacks: how far each screw engages, and what is left before it bottoms.

Read off the placements: a cap screw, the tapped hole it stands in, and every part between its head and that.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from tactcad.parts.description import Extrusion, Hole, Part
from tactcad.parts.library.fits import deviations, general
from tactcad.scenes.scene import Placement, Scene
from tactcad.scenes.threads import COAXIAL, engaged, thread_range

from .variables import STACK_LENGTH, DimensionLimits, variable

CAP_SCREW = re.compile(r"ISO4762-(M[\d.]+)x([\d.]+)-")
# What is stacked between the end plates: its length is held as a whole.
STACKED = ("element", "spacer", "blank")
# Product grade A: lengths of cap screws are js15 (ISO 4759-1:2000).
LENGTH = "js15"


@dataclass(frozen=True)
class ScrewedJoint:
    """Equal screws in equal holes through equal parts.

    name           the screw, the part under its head, the tapped one and its hole
    thread         such as "M3"
    engaged        nominal length of engaged full thread, mm
    room           from the screw's end to where it bottoms, or to the far face inside which it ends, mm; None
                   where it passes through
    terms          coefficient of each variable on how deep the screw goes
    deeper         variable that adds to the room, "" where none
    bought         whether the thread is in a bought part, of steel
    """

    name: str
    thread: str
    engaged: float
    room: float | None
    terms: tuple[tuple[str, float], ...]
    deeper: str
    bought: bool


def joints(design: str, scene: Scene, known: dict[str, DimensionLimits]) -> list[ScrewedJoint]:
    """Every kind of screwed joint of a scene.

    Parameters
    ----------
    design, scene
        The design's name, and a scene of it; its contacts name the threads.
    known
        Variables by name; those of the joints are added where they are not known yet.
    """
    by_name = {p.designator: p for p in scene.placements}
    kinds: dict[ScrewedJoint, None] = {}
    for contact in scene.contacts:
        if contact.kind != "thread":
            continue
        pair = (by_name[contact.first], by_name[contact.second])
        for screw, tapped in (pair, pair[::-1]):
            if CAP_SCREW.match(screw.part.part_no):
                kinds |= dict.fromkeys(_joint(design, scene, screw, tapped, known))
    return list(kinds)


def _joint(
    design: str, scene: Scene, screw: Placement, tapped: Placement, known: dict[str, DimensionLimits]
) -> Iterator[ScrewedJoint]:
    match = CAP_SCREW.match(screw.part.part_no)
    assert match
    thread, length = match[1], float(match[2])
    for hole, _, end in engaged(screw, tapped):
        start, stop = thread_range(hole)
        if end - length > start + COAXIAL or end < start:
            continue  # another hole of the part in the same axis
        length_name = _known(
            known, variable(f"{thread}x{length:g} screw: length", *deviations(LENGTH, length))
        )
        terms = {length_name: 1.0}
        through = ""
        for pierced, clearance in _pierced(scene, screw, tapped, length):
            if clearance.counterbore or not through:
                through = f"through {_short(design, pierced)} "
            if pierced.part.part_no.startswith(tuple(f"{design}-{w}" for w in STACKED)):
                terms[STACK_LENGTH] = -1.0
                continue
            thick = thickness(pierced.part, known)
            terms[thick] = terms.get(thick, 0.0) - 1.0
            if clearance.counterbore:
                deep = clearance.counterbore[1]
                sunk = _general(known, f"{pierced.part.part_no}: counterbore depth", deep)
                terms[sunk] = terms.get(sunk, 0.0) + 1.0
        room, deeper = None, ""
        if not hole.through:
            room, deeper = (
                stop - end,
                _general(known, f"{tapped.part.part_no}: thread depth", hole.thread_depth),
            )
        elif end <= hole.depth:
            room, deeper = hole.depth - end, thickness(tapped.part, known)
        yield ScrewedJoint(
            f"{thread}x{length:g} {through}into {_short(design, tapped)} ({hole.name.replace('_', ' ')})",
            thread,
            round(min(end, stop) - start, 6),
            None if room is None else round(room, 6),
            tuple(sorted(terms.items())),
            deeper,
            tapped.part.bought,
        )


def _short(design: str, p: Placement) -> str:
    """A part's number without its design's name, which all of them share."""
    return p.part.part_no.removeprefix(f"{design}-")


def _pierced(
    scene: Scene, screw: Placement, tapped: Placement, length: float
) -> Iterator[tuple[Placement, Hole]]:
    """Parts that a screw's shank passes through before its thread, with their holes."""
    axis, head = np.array(screw.rotation)[:, 2], np.array(screw.origin)
    for p in scene.placements:
        if p in (screw, tapped) or CAP_SCREW.match(p.part.part_no):
            continue
        for hole in _holes(p.part):
            turn = np.array(p.rotation)
            mouth, way = turn @ np.array(hole.at) + p.origin, turn @ np.array(hole.axis)
            beside = mouth - head
            beside = beside - (beside @ axis) * axis
            if abs(abs(way @ axis) - 1.0) > COAXIAL or np.linalg.norm(beside) > COAXIAL:
                continue
            ends = sorted(
                (float((mouth - head) @ axis), float((mouth - head) @ axis + hole.depth * (way @ axis)))
            )
            if ends[0] < length and ends[1] > 1e-6:
                yield p, hole


def _holes(part: Part) -> Iterator[Hole]:
    yield from (f for f in part.features if isinstance(f, Hole))
    if isinstance(part.body, Extrusion):
        for opening in part.body.openings:
            if circle := opening.as_circle():
                (x, y), r = circle
                yield Hole("", (x, y, 0.0), (0, 0, 1), 2 * r, part.body.thickness, True)


def _known(known: dict[str, DimensionLimits], v: DimensionLimits) -> str:
    known.setdefault(v.name, v)
    return v.name


def _general(known: dict[str, DimensionLimits], name: str, size: float) -> str:
    return _known(known, variable(name, -general(size), general(size)))


def thickness(part: Part, known: dict[str, DimensionLimits]) -> str:
    """The variable of a part's thickness along its contour's axis: its own limits, or the general ones."""
    own = next((c for c in part.characteristics if c.name == "thickness"), None)
    if own is None:
        nominal = part.extrusion.thickness if isinstance(part.body, Extrusion) else 1.0
        return _general(known, f"{part.part_no}: thickness", nominal)
    name = f"{part.part_no}: thickness"
    return _known(known, variable(name, own.lower - own.nominal, own.upper - own.nominal))
