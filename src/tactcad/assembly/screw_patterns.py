"""Screws that have to enter their threads through holes that stand in several parts.

One screw always finds its thread; several fix each other. Along the line through two of them, four holes are
off by half their zone each, and the clearance holes leave a screw the room between it and the least of them
on either side: as a sum of deviations, room H - d against the zones of hole and thread (the formula of fixed
fasteners, ISO 2692 and ASME Y14.5, without the rooms of larger holes).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence

from tactcad.parts.description import Hole, Part
from tactcad.parts.end_plate import HOLES
from tactcad.parts.layout import Layout
from tactcad.parts.library.dowels import dowel_limits
from tactcad.parts.library.fits import general
from tactcad.parts.library.screws import METRIC
from tactcad.scenes.requirement import DimensionLimits, Requirement, summed, variable
from tactcad.scenes.scene import Placement

from .screwed_joints import STACKED, Screwed, is_stacked, short

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
        Variables by name; those of the holes' places are added where they are not known yet.
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
        if is_stacked(design, pierced):  # elements of all arms are alike here
            who = next(kind for kind in STACKED if who.startswith(kind))
        room = hole.diameter - general(hole.diameter) - METRIC[s.thread].d - _off_pins(layout, pierced.part)
        room = round(room, 9)
        terms = (
            (_places(who, pierced.part, hole, known), 1.0),
            (_places(into, s.tapped.part, s.hole, known), 1.0),
        )
        yield summed(f"{s.thread}x{s.length:g} through {who} into {into}: enter", -room, room, 0.0, terms)


def _off_pins(layout: Layout, part: Part) -> float:
    """How far a part that hangs on pins may be off the plate that holds them, both ways, mm: by its play on
    them and the places of the pins."""
    hole = next((c for c in part.characteristics if c.name == "dowel hole diameter"), None)
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
