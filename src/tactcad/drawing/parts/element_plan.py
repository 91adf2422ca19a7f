"""The plan of a sensing element: the whole side view, the arm enlarged (X), the hinge enlarged (Z), and the
edge.

Heights count from the flat face and, for the clamp, from the dowel hole, which is also
the origin of lengths of the rear body; lengths of the arm count from its tip, as the arm length itself does.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

from tactcad.contour import Arc, Contour, Line
from tactcad.parts.array.element import LEDGE, PAD_HEIGHT
from tactcad.parts.language.description import Part

from ..engine.boxes import Point
from .callouts import Group, equal_radii, groups, hole_callout
from .measures import (
    OUTER,
    THICKNESS,
    Level,
    Round,
    Slope,
    Span,
    Spot,
    conventions,
    halfway,
    level,
    radius_of,
    rounds,
    size,
)
from .prism import FRONT, side_view
from .sheet_plan import Across, Callout, Dimension, Linear, SheetPlan, Side, View
from .sketch import ALIKE, Coordinate, Sketch, closed, view_of
from .tolerances import with_marks

HINGE_LEAST = 10.0  # the hinge is shown at 10:1 or larger
HINGE_ROOM = (110.0, 110.0)  # mm of paper for the hinge's detail
MOST_LEAF = 5.0  # mm of a tall element's hinge shown either way from its middle
WIDE_ROOM = (110.0, 100.0)
ARM_ROOM = (190.0, 75.0)


@dataclass(frozen=True)
class OutlineCorner:
    """A sharp corner of the outline: its levels and place."""

    x: Level
    y: Level
    at: Point


class Outline:
    """The outline's segments by name, and their levels."""

    def __init__(self, contour: Contour) -> None:
        self.contour = contour
        self.index = {s.name: i for i, s in enumerate(contour) if s.name}

    def __contains__(self, name: str) -> bool:
        return name in self.index

    def segment(self, name: str) -> Line | Arc:
        return self.contour.segments[self.index[name]]

    def x(self, name: str, end: bool = False) -> Level:
        return level(self.point(name, end).place(0))

    def y(self, name: str) -> Level:
        return level(self.point(name, False).place(1))

    def start(self, name: str) -> Point:
        return self.segment(name).start

    def end(self, name: str) -> Point:
        return self.segment(name).end

    def point(self, name: str, end: bool) -> Spot:
        """A segment's start or end."""
        return Spot(OUTER, (self.index[name] + end) % len(self.contour))

    def corner(self, before: str, after: str) -> OutlineCorner:
        """The corner between two edges, of which fillets may have used up one."""
        point = self.point(before, True) if before in self else self.point(after, False)
        at = self.end(before) if before in self else self.start(after)
        return OutlineCorner(level(point.place(0)), level(point.place(1)), at)


def _line(sketch: Sketch, name: str, a: Level, b: Level, side: Side, p: Point, q: Point) -> Linear:
    """A dimension line from one level to another, which has to determine something new."""
    return Linear(sketch.must(Dimension(name, (Span(a, b),))), side, p, q)


def element_plan(part: Part, notes: Sequence[str], tall: bool = False) -> SheetPlan:
    """The sheet of an element; of a `tall` one only the hinge is enlarged, and the heights at its sides are
    shown with the arm.

    Raises CheckFailure if a dimension is missing or given twice.
    """
    o = Outline(part.extrusion.outer)
    sketch = Sketch(part)
    for row in conventions(OUTER, o.contour):
        sketch.convention(row)
    called = groups(rounds(part), sketch.values, {2: FRONT[0]}, part)
    holes = [r for g in called for r in g.holes]
    dowel = next(r for r in holes if r.label == "dowel hole")
    for r in holes:
        if r is not dowel:
            sketch.convention(Span(level(dowel.owner.place(1)), level(r.owner.place(1))))
    hinge, left = _hinge_view(sketch, part, o, tall)
    arm = _arm_view(sketch, o, *left)
    front = _front_view(sketch, part, o, called, dowel)
    thickness = Dimension("sheet thickness", (size(THICKNESS),))
    edge = replace(side_view(sketch, part, front, thickness), hidden=False)
    views = with_marks(part, (front, edge, arm, hinge))
    closed(sketch, views)
    return SheetPlan(part, sketch.values, tuple(sketch.conventions), views, tuple(notes))


def _front_view(sketch: Sketch, part: Part, o: Outline, called: Sequence[Group], dowel: Round) -> View:
    view = view_of(part, "front", *FRONT)
    x, at = level(dowel.owner.place(0)), dowel.at[:2]
    linears = []
    for r in sorted((r for g in called for r in g.holes if r is not dowel), key=lambda r: r.at[0]):
        ends = (x, level(r.owner.place(0)))
        row = Span(*ends) if r.at[0] > at[0] else Span(*reversed(ends))
        origin, there = (Coordinate(s.label, s.owner.place(0), s.at) for s in (dowel, r))
        basic = sketch.locates(origin, there, 0)
        d = sketch.must(Dimension(f"{r.label} from dowel hole", (row,), basic=basic))
        linears.append(Linear(d, "top", at, r.at[:2]))
    face = "body_face" if "body_face" in o else "flat_face"
    step, foot, rear = o.corner(face, "recess_wall"), o.start("rear_end"), o.end("rear_end")
    tip, pad, y = o.start("tip"), o.start("pad_face"), level(dowel.owner.place(1))
    linears += [
        _line(sketch, "clamp edge from dowel hole", o.x("clamp_edge"), x, "top", at, o.start("clamp_edge")),
        _line(sketch, "rear end from dowel hole", x, o.x("rear_end"), "top", at, rear),
        _line(sketch, "tip from dowel hole", o.x("tip"), x, "top", at, tip),
        _line(sketch, "length of the recess", step.x, o.x("rear_end"), "bottom", step.at, foot),
        _line(sketch, "depth of the recess", o.y(face), o.y("recess_face"), "right", step.at, foot),
        _line(sketch, "height of the rear body", o.y(face), o.y("rear_top"), "right", step.at, rear),
        _line(sketch, PAD_HEIGHT, o.y("pad_face"), y, "left", pad, at),
    ]
    callouts = [hole_callout(sketch, view, g) for g in called]
    callouts += _radii(sketch, view, o, ("ledge_root", "recess_root"))
    return replace(
        view,
        linears=tuple(linears),
        callouts=tuple(callouts),
        centres=tuple((r.at[:2], r.hole.diameter) for g in called for r in g.holes),
    )


def _radii(sketch: Sketch, view: View, o: Outline, names: Sequence[str], states: str = "") -> list[Callout]:
    """Fillets by name, equal ones together, which state that characteristic of the part if there is one;
    none for a full round, whose width defines it.
    """
    named = ((n, o.index[n], o.segment(n)) for n in names if n in o)
    arcs = [(n.replace("_", " "), radius_of(OUTER, i), s) for n, i, s in named if isinstance(s, Arc)]
    return equal_radii(sketch, view, arcs, states)


def _slot(o: Outline) -> tuple[OutlineCorner, OutlineCorner]:
    """The slot's upper corners, arm side and body side."""
    return o.corner("slot_arm_wall", "arm_back"), o.corner("ledge", "slot_body_wall")


def _hinge_view(
    sketch: Sketch, part: Part, o: Outline, tall: bool
) -> tuple[View, tuple[list[Linear], list[Callout]]]:
    """The hinge: thickness, slot, fillets, and the heights at its sides.

    For a tall element the view shows the thickness alone; the other dimensions and callouts are returned, for
    the arm's view.
    """
    arm, body = _slot(o)
    (xa, back), (xb, ledge) = arm.at, body.at
    one = "body_face" not in o
    flat = o.start("flat_face")[1]
    face = flat if one else o.start("body_face")[1]
    near, low = (o.y("flat_face"), flat) if one else _floor(o, "hinge_face", "front_slot_")
    floor, floor_y = _floor(o, "slot_floor", "slot_")
    middle, side = (xa + xb) / 2, max(0.55 * (xb - xa), 0.35 * back)
    window = (xa - side, min(flat, face) - 0.25 * back, xb + side, max(ledge, back) + 0.2 * back)
    if tall:
        # the leaf, of a long one its middle
        over = min(max(2.0 * (floor_y - low), 1.0), 3.0)
        half = min((xb - xa) / 2 + over, MOST_LEAF)
        window = (middle - half, low - (0.5 * over if one else over), middle + half, floor_y + over)
    room = WIDE_ROOM if tall else HINGE_ROOM
    view = View("hinge", *FRONT, o.contour.box, label="Z", window=window, room=room, least=HINGE_LEAST)
    web = sketch.must(Dimension("hinge thickness", (Span(near, floor),)))
    across = Across(web, (middle, floor_y), (middle, low), low - max(min(flat, face), window[1]))
    along = _line(sketch, "slot length", arm.x, body.x, "top", (xa, back), (xb, ledge))
    heights = _heights(sketch, o, arm, body, near)
    beside = [replace(h, p=(window[0 if h.side == "left" else 2], h.p[1])) for h in heights]
    fillets = ("slot_arm_fillet", "slot_body_fillet", "front_slot_arm_fillet", "front_slot_body_fillet")
    called = _radii(sketch, view, o, fillets, "fillet radius")
    if "slot_floor" not in o:
        arc = _arc(o, fillets)
        ends = "full round" if one else "full round, both slots"
        called.append(Callout((ends,), ((arc.centre, arc.radius),), spans=((180.0, 360.0),)))
    callouts = [] if tall else [*called]
    if rough := re.search(r"Ra [\d.]+", part.finish):
        spot = (middle - 0.2 * min(xb - xa, MOST_LEAF), low)
        callouts.append(Callout((f"{rough[0]}, both hinge faces",), ((spot, 0.0),)))
    linears = () if tall else (along, *beside)
    view = replace(view, linears=linears, across=(across,), callouts=tuple(callouts))
    return view, ([*heights, along], called) if tall else ([], [])


def _arc(o: Outline, names: Sequence[str]) -> Arc:
    """The first of these that the outline has, a fillet."""
    segment = o.segment(next(n for n in names if n in o))
    assert isinstance(segment, Arc)
    return segment


def _heights(
    sketch: Sketch, o: Outline, arm: OutlineCorner, body: OutlineCorner, near: Level
) -> list[Linear]:
    """Heights at the slot's sides: arm and lower slot on the left, the body on the right."""
    flat = o.start("flat_face")
    height = _line(sketch, "arm height", o.y("flat_face"), arm.y, "left", flat, arm.at)
    one = "body_face" not in o
    foot = flat if one else o.corner("front_slot_body_wall", "body_face").at
    # the ledge is measured from the pad; this follows
    rows = (Span(o.y("flat_face") if one else o.y("body_face"), body.y),)
    high = Dimension("body height", rows, auxiliary=True)
    heights = [height, Linear(high, "right", foot, body.at)]
    if one:
        return heights
    sketch.convention(Span(o.corner("flat_face", "front_slot_arm_wall").x, arm.x))
    sketch.convention(Span(o.corner("front_slot_body_wall", "body_face").x, body.x))
    web = (arm.at[0], _floor(o, "hinge_face", "front_slot_")[1])
    heights.append(_line(sketch, "front slot", o.y("flat_face"), near, "left", flat, web))
    if abs(foot[1] - flat[1]) < ALIKE:
        sketch.convention(Span(o.y("flat_face"), o.y("body_face")))
    else:
        levels = (o.y("body_face"), o.y("flat_face"))
        heights.append(_line(sketch, "body below the arm", *levels, "left", flat, foot))
    return heights


def _floor(o: Outline, face: str, slot: str) -> tuple[Level, float]:
    """Level of a slot's floor; of a full round half the slot's width from its centre, on the hinge's side."""
    if face in o:
        return o.y(face), o.start(face)[1]
    s, up = _arc(o, (f"{slot}body_fillet", f"{slot}arm_fillet")), slot.startswith("front")
    half = 0.5 if (s.end[0] > s.start[0]) == up else -0.5
    ends = ((o.point(s.name, False).place(0), -half), (o.point(s.name, True).place(0), half))
    level_ = Level(((Spot(OUTER, o.index[s.name], centre=True).place(1), 1.0), *ends))
    return level_, s.centre[1] + (s.radius if up else -s.radius)


def _arm_view(sketch: Sketch, o: Outline, more: Sequence[Linear], called: Sequence[Callout]) -> View:
    """The arm: its length to the hinge's middle, pad, stop land, and the dimensions missing in the hinge's
    view."""
    slot, body = _slot(o)
    (xa, back), (xb, ledge) = slot.at, body.at
    tip, pad = o.start("tip"), o.start("pad_face")
    land, flat = o.segment("stop_land"), o.start("flat_face")[1]
    margin = 0.2 * back
    window = (tip[0] - margin, pad[1] - margin, xb + 0.5 * back, max(ledge, back) + margin)
    view = View("arm", *FRONT, o.contour.box, label="X", window=window, room=ARM_ROOM)
    tip_x, middle, pad_end, face = o.x("tip"), (xa + xb) / 2, o.end("pad_face"), o.y("pad_face")
    over = (middle, max(ledge, back) + margin / 2)
    linears = (
        _line(sketch, "stop land", tip_x, o.x("stop_land"), "top", land.end, land.start),
        _line(sketch, "arm length", tip_x, halfway(slot.x, body.x), "top", land.end, over),
        _line(sketch, "pad length", tip_x, o.x("pad_face", True), "bottom", pad, pad_end),
        _line(sketch, "pad height", face, o.y("flat_face"), "right", pad_end, (window[2], flat)),
        _line(sketch, "stop gap", o.y("stop_land"), body.y, "left", land.end, (xb, ledge)),
        _line(sketch, LEDGE, face, body.y, "right", pad_end, (xb, ledge)),
    )
    slope = Slope(o.point("land_ramp", True), o.point("land_ramp", False))
    ramp = sketch.must(Dimension("ramp of the stop land", (slope,), unit="°"))
    callouts = _radii(sketch, view, o, ("pad_root", "land_root"))
    spot = o.segment("land_ramp").at(0.5)
    angle = ramp.text(sketch.values).removeprefix("-")
    callouts.append(Callout((f"ramp {angle}",), ((spot, 0.0),), (ramp,)))
    centre_line = ((middle, flat - 0.1 * back), over)
    return replace(view, linears=(*linears, *more), callouts=(*callouts, *called), axes=(centre_line,))
