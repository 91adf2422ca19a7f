"""Requirements on parts that make a sensor: limits, and each one's value in an array; of screwed joints, each
screw's engagement and its distance from bottoming.

Joints are read off the placements: a cap screw, its tapped hole, and every part between. One screw always
fits its thread; several constrain each other. Along the line through two of them, four holes are off by half
their zone each, and the clearance holes leave a screw its least clearance on either side: as a sum of
deviations, room H - d against the zones of hole and thread (the formula of fixed fasteners, ISO 2692 and
ASME Y14.5, without the rooms of larger holes).
"""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import inf

import numpy as np

from tactcad.mechanics.section import Array
from tactcad.parts.array.clamp import HOLES, carrier, carrier_clearance
from tactcad.parts.array.element import DOWEL_HOLE
from tactcad.parts.array.layout import SUNK, Layout
from tactcad.parts.array.stop_gap import stop_limits
from tactcad.parts.bought.standard_parts import LEAST_PLAY, dowel_limits
from tactcad.parts.language.description import Extrusion, Hole, Part
from tactcad.parts.language.limits import deviations, general
from tactcad.parts.language.metric import METRIC
from tactcad.parts.language.stock import PLACE
from tactcad.scenes.requirement import LEAST_PRESS, DimensionLimits, Requirement, summed, variable
from tactcad.scenes.rig import rig_of
from tactcad.scenes.scene import COAXIAL, Placement, Scene, engaged, thread_range

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


CAP_SCREW = re.compile(r"ISO4762-(M[\d.]+)x([\d.]+)-")
# The stack between the end plates, toleranced in its total length.
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
                   if it passes through
    terms          coefficient of each variable on how deep the screw goes
    deeper         variable that adds to the room, "" if none
    bought         whether the thread is in a bought part, of steel
    """

    name: str
    thread: str
    engaged: float
    room: float | None
    terms: tuple[tuple[str, float], ...]
    deeper: str
    bought: bool


@dataclass(frozen=True)
class Screwed:
    """A cap screw in a tapped hole.

    thread, length  of the screw, mm
    tapped, hole    the part with the thread
    end             of the screw along the hole, from its mouth, mm
    pierced         parts between its head and the tapped one, with the holes that it passes
    """

    thread: str
    length: float
    tapped: Placement
    hole: Hole
    end: float
    pierced: tuple[tuple[Placement, Hole], ...]


def screwed(scene: Scene) -> list[Screwed]:
    """Every cap screw of a scene in its thread; its contacts name the threads."""
    by_name = {p.designator: p for p in scene.placements}
    bored = _bored([p for p in scene.placements if not CAP_SCREW.match(p.part.part_no)])
    found: list[Screwed] = []
    for contact in scene.contacts:
        if contact.kind != "thread":
            continue
        pair = (by_name[contact.first], by_name[contact.second])
        for screw, tapped in (pair, pair[::-1]):
            if match := CAP_SCREW.match(screw.part.part_no):
                found += _screwed(screw, tapped, match[1], float(match[2]), bored)
    return found


def joints(design: str, screws: Sequence[Screwed], known: dict[str, DimensionLimits]) -> list[ScrewedJoint]:
    """Every kind of screwed joint of a scene.

    Parameters
    ----------
    design, screws
        The design's name, and the screws of a scene of it.
    known
        Variables by name; those of the joints are added if missing.
    """
    return list(dict.fromkeys(_joint(design, s, known) for s in screws))


def _joint(design: str, s: Screwed, known: dict[str, DimensionLimits]) -> ScrewedJoint:
    start, stop = thread_range(s.hole)
    length_name = _known(
        known, variable(f"{s.thread}x{s.length:g} screw: length", *deviations(LENGTH, s.length))
    )
    terms = {length_name: 1.0}
    through = ""
    for pierced, clearance in s.pierced:
        if clearance.counterbore or not through:
            through = f"through {short(design, pierced)} "
        if is_stacked(design, pierced):
            terms[STACK_LENGTH] = -1.0
            continue
        thick = thickness(pierced.part, known)
        terms[thick] = terms.get(thick, 0.0) - 1.0
        if clearance.counterbore:
            deep = clearance.counterbore[1]
            sunk = _general(known, f"{pierced.part.part_no}: counterbore depth", deep)
            terms[sunk] = terms.get(sunk, 0.0) + 1.0
    room, deeper = None, ""
    if not s.hole.through:
        room = stop - s.end
        deeper = _general(known, f"{s.tapped.part.part_no}: thread depth", s.hole.thread_depth)
    elif s.end <= s.hole.depth:
        room, deeper = s.hole.depth - s.end, thickness(s.tapped.part, known)
    into = f"{short(design, s.tapped)} ({s.hole.name.replace('_', ' ')})"
    return ScrewedJoint(
        f"{s.thread}x{s.length:g} {through}into {into}",
        s.thread,
        round(min(s.end, stop) - start, 6),
        None if room is None else round(room, 6),
        tuple(sorted(terms.items())),
        deeper,
        s.tapped.part.bought,
    )


def short(design: str, p: Placement) -> str:
    """A part's number without its design's name, which all of them share."""
    return p.part.part_no.removeprefix(f"{design}-")


def is_stacked(design: str, p: Placement) -> bool:
    """Whether a part is between the end plates."""
    return p.part.part_no.startswith(tuple(f"{design}-{w}" for w in STACKED))


def _screwed(
    screw: Placement, tapped: Placement, thread: str, length: float, bored: _Bored
) -> Iterator[Screwed]:
    axis, head = np.array(screw.rotation)[:, 2], np.array(screw.origin)
    for hole, _, end in engaged(screw, tapped):
        start, _ = thread_range(hole)
        if end - length > start + COAXIAL or end < start:
            continue  # another hole of the part in the same axis
        mouth = length - end  # from the head
        passed = tuple((p, other) for p, other in bored.along(axis, head, mouth) if p is not tapped)
        yield Screwed(thread, length, tapped, hole, end, passed)


@dataclass(frozen=True)
class _Bored:
    """Holes of placed parts, each with its part; their starts and directions in the scene, (n, 3) mm."""

    holes: tuple[tuple[Placement, Hole], ...]
    mouths: Array
    ways: Array
    depths: Array

    def along(self, axis: Array, head: Array, mouth: float) -> Iterator[tuple[Placement, Hole]]:
        """Holes in a screw's axis that begin or end between its head and the thread's mouth."""
        from_head = self.mouths - head
        height, turn = from_head @ axis, self.ways @ axis
        beside = np.linalg.norm(from_head - np.outer(height, axis), axis=1)
        far = height + self.depths * turn
        passed = np.minimum(height, far) < mouth - COAXIAL
        passed &= (np.maximum(height, far) > COAXIAL) & (beside <= COAXIAL)
        passed &= np.abs(np.abs(turn) - 1.0) <= COAXIAL
        yield from (self.holes[i] for i in np.flatnonzero(passed).tolist())


def _bored(parts: Sequence[Placement]) -> _Bored:
    holes: list[tuple[Placement, Hole]] = []
    mouths, ways = [np.zeros((0, 3))], [np.zeros((0, 3))]
    for p in parts:
        own, turn = tuple(_holes(p.part)), np.array(p.rotation, float)
        holes += [(p, hole) for hole in own]
        mouths.append(np.array([h.at for h in own], float).reshape(-1, 3) @ turn.T + np.array(p.origin))
        ways.append(np.array([h.axis for h in own], float).reshape(-1, 3) @ turn.T)
    depths = np.array([hole.depth for _, hole in holes], float)
    return _Bored(tuple(holes), np.vstack(mouths), np.vstack(ways), depths)


def _holes(part: Part) -> Iterator[Hole]:
    yield from (f for f in part.features if isinstance(f, Hole))
    if isinstance(part.body, Extrusion):
        for opening in part.body.openings:
            if circle := opening.as_circle():
                (x, y), r = circle
                name = opening.segments[0].name
                yield Hole(name, (x, y, 0.0), (0, 0, 1), 2 * r, part.body.thickness, True)


def _known(known: dict[str, DimensionLimits], v: DimensionLimits) -> str:
    known.setdefault(v.name, replace(v, matters="joint"))
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
    of = ((part.part_no, own.name),) if not part.bought else ()
    return _known(known, variable(name, own.lower - own.nominal, own.upper - own.nominal, stated=of))


# Zone of the holes of bought parts, mm; chosen: their makers' drawings were not read, which is to be done
# before ordering (docs/rigs.md).
BOUGHT = 0.2


def patterns(
    layout: Layout, screws: Sequence[Screwed], known: dict[str, DimensionLimits]
) -> Iterator[Requirement]:
    """For each part that several screws pass on their way into another one: that they enter.

    Parameters
    ----------
    layout, screws
        The array, and the screws of a scene.
    known
        Variables by name; those of the holes' places are added if they are not known yet.
    """
    design = layout.design.name
    pairs: dict[tuple[str, str, str], list[tuple[Screwed, Placement, Hole]]] = defaultdict(list)
    for s in screws:
        for p, hole in s.pierced:
            pairs[s.thread, p.designator, s.tapped.designator].append((s, p, hole))
    for some in pairs.values():
        if len(some) < 2:
            continue
        s, pierced, hole = min(some, key=lambda one: one[2].diameter)
        who, into = short(design, pierced), short(design, s.tapped)
        if is_stacked(design, pierced):  # elements of all arms are equal here
            who = next(kind for kind in STACKED if who.startswith(kind))
        room = hole.diameter - general(hole.diameter) - METRIC[s.thread].d - _off_pins(layout, pierced.part)
        room = round(room, 9)
        terms = (
            (_places(who, pierced.part, hole, known), 1.0),
            (_places(into, s.tapped.part, s.hole, known), 1.0),
        )
        yield summed(f"{s.thread}x{s.length:g} through {who} into {into}: enter", -room, room, 0.0, terms)


def _off_pins(layout: Layout, part: Part) -> float:
    """Largest offset of a part on pins from the pins' plate, both ways, mm: by its play and the places of the
    pins."""
    hole = next((c for c in part.characteristics if c.name == DOWEL_HOLE), None)
    return hole.upper - dowel_limits(layout.design.clamp.dowel)[0] + HOLES if hole else 0.0


def _places(who: str, part: Part, hole: Hole, known: dict[str, DimensionLimits]) -> str:
    """The variable of how far two holes of a pattern are off."""
    placed = (g for g in part.geometric if g.symbol == "position" and hole.name in g.features)
    g = next(placed, None)
    if g is None and not part.bought:
        raise ValueError(f"{part.part_no}: screws pass {hole.name}, which has no position tolerance")
    zone = g.zone if g else BOUGHT
    name = f"{who}: places of {g.name if g else 'holes'}"
    of = ((part.part_no, g.name),) if g and not name.startswith("element") else ()
    known.setdefault(name, variable(name, -zone / 2, zone / 2, 2, of, "joint"))
    return name
