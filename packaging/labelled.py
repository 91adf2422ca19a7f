"""The labelled drawings of docs/images: an element and the array, with every word of the design file on them.

`python packaging/labelled.py docs/images` writes labelled-element.svg and labelled-array.svg from
hardware/macro-array.toml, by the drawing room's own lines and letters. A test reads every field back.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import copysign
from pathlib import Path
from typing import Literal

from tactcad.contour import Arc, Contour
from tactcad.design.load import read
from tactcad.design.tree import Design
from tactcad.drawing.engine.boxes import Box, Point, clipped
from tactcad.drawing.engine.ink import (
    CENTRE,
    HIDDEN,
    THIN,
    VISIBLE,
    DrawnArc,
    DrawnSheet,
    Item,
    LineType,
    Stroke,
    Text,
    arrow,
    ink_box,
    segment,
    width,
)
from tactcad.drawing.engine.sheet_files import svg_bytes
from tactcad.parts.array.element import mounting_holes, outline
from tactcad.parts.array.layout import ElementPlace, Layout
from tactcad.parts.array.stop_gap import stop_gap

ROOT = Path(__file__).parents[1]
LETTERS = 3.0  # height of capitals, mm: some 9 px where the page shows the drawing 900 px wide
OVERSHOOT, GAP, TAIL, ARROW = 1.5, 0.8, 5.0, 2.2
# Of each view: where its part's (0, 0) lies on the paper, mm, and how much it is enlarged.
SIDE, HINGE, BOTH = ((44.0, 38.0), 5.6), ((-100.0, 145.0), 19.0), ((62.0, 145.0), 19.0)
PLAN, SECTION = ((118.0, 170.0), 2.7), ((118.0, 22.0), 2.7)
Where = Literal["middle", "before", "after"]


@dataclass
class View:
    """Part of a drawing: `origin` on the paper is its (0, 0), enlarged by `scale`; `flip` turns v over."""

    origin: Point
    scale: float
    flip: bool = False
    items: list[Item] = field(default_factory=list)

    def at(self, u: float, v: float) -> Point:
        """From mm of the part to mm of paper."""
        return (self.origin[0] + u * self.scale, self.origin[1] + v * self.scale * (-1 if self.flip else 1))

    def line(self, points: Sequence[Point], line: LineType = VISIBLE, closed: bool = False) -> None:
        role = "outline" if line == VISIBLE else "hidden" if line == HIDDEN else "centre"
        self.items.append(Stroke(tuple(self.at(*p) for p in points), line, role, closed))

    def box(self, u0: float, v0: float, u1: float, v1: float, line: LineType = VISIBLE) -> None:
        self.line(((u0, v0), (u1, v0), (u1, v1), (u0, v1)), line, closed=True)

    def contour(self, contour: Contour, window: Box | None = None, mirror: bool = False) -> None:
        """A contour's lines and arcs, or what of it lies in a window."""
        for s in contour:
            points = [s.at(i / 24) for i in range(25)] if isinstance(s, Arc) else [s.start, s.end]
            if mirror:
                points = [(-x, y) for x, y in points]
            for chord in zip(points, points[1:]):
                if seen := clipped(chord, window) if window else chord:
                    self.line(seen)

    def along(
        self, name: str, u: tuple[float, float], feet: tuple[float, float], y: float, where: Where = "middle"
    ) -> None:
        """A length along u, its line at height y of the paper, its extension lines from v = `feet`."""
        (xa, fa), (xb, fb) = (self.at(*end) for end in zip(u, feet))
        self._dimension(name, (xa, xb), (fa, fb), y, where, turned=False)

    def across(
        self, name: str, v: tuple[float, float], feet: tuple[float, float], x: float, where: Where = "middle"
    ) -> None:
        """A length along v, its line at x of the paper, its extension lines from u = `feet`."""
        (fa, ya), (fb, yb) = (self.at(*reversed(end)) for end in zip(v, feet))
        self._dimension(name, (ya, yb), (fa, fb), x, where, turned=True)

    def _dimension(self, name: str, ends: Point, feet: Point, at: float, where: Where, turned: bool) -> None:
        def p(s: float, o: float) -> Point:
            return (o, s) if turned else (s, o)

        (a, fa), (b, fb) = sorted(zip(ends, feet))
        for s, foot in ((a, fa), (b, fb)):
            away = copysign(1.0, at - foot)
            if abs(at - foot) > GAP:
                self.items.append(
                    segment(p(s, foot + away * GAP), p(s, at + away * OVERSHOOT), THIN, "extension")
                )
        inside, size = b - a > 2 * ARROW + 1.0, width(name, LETTERS)
        low, high = (a, b) if inside else (a - TAIL, b + TAIL)
        low, high = (low - size if where == "before" else low), (high + size if where == "after" else high)
        if where != "middle" and inside:
            low, high = (low - 2.0, high) if where == "before" else (low, high + 2.0)
        start = {"middle": (a + b - size) / 2, "before": low, "after": high - size}[where]
        self.items.append(segment(p(low, at), p(high, at)))
        for s, other in ((a, b), (b, a)):
            self.items.append(arrow(p(s, at), p(other if inside else 2 * s - other, at), ARROW))
        below = -ink_box(name, LETTERS)[1]
        lift = max(1.0, below + 0.7) * (-1.0 if turned else 1.0)
        self.items.append(
            Text(p(start, at + lift), name, LETTERS, angle=90.0 if turned else 0.0, role="note")
        )

    def called(self, name: str, u: float, v: float, to: Point, dot: bool = False) -> None:
        """A leader from a point of the part to a text at `to` on the paper; on an area it ends in a dot."""
        tip, right = self.at(u, v), to[0] >= self.at(u, v)[0]
        self.items.append(segment(tip, to, THIN, "leader"))
        if dot:
            self.items.append(DrawnArc(tip, 0.35, line=VISIBLE, role="leader"))
        else:
            self.items.append(arrow(tip, to, ARROW, "leader"))
        end = (to[0] + (1.5 if right else -1.5), to[1])
        self.items.append(segment(to, end, THIN, "leader"))
        place = (end[0] + (0.7 if right else -0.7), end[1] - LETTERS / 2)
        self.items.append(Text(place, name, LETTERS, "start" if right else "end"))

    def word(self, text: str, u: float, v: float, height: float = LETTERS) -> None:
        """A word that names the area it lies in."""
        x, y = self.at(u, v)
        self.items.append(Text((x, y - height / 2), text, height, "middle"))


def element_sheet(design: Design) -> DrawnSheet:
    """The element with the longest arm: side, edge, hinge enlarged; and a hinge of two sides."""
    layout, e = Layout(design), design.element
    place = max(layout.elements, key=lambda p: p.arm)
    size = (290.0, 227.0)
    view = View(*SIDE)
    _side(view, layout, place)
    # the same element's edge
    x0 = layout.rear_end + 9.0
    view.box(x0, -e.pad_height, x0 + design.sheet.thickness, e.rear_height)
    for z in (0.0, e.recess_depth):
        view.line(((x0, z), (x0 + design.sheet.thickness, z)))
    top = view.at(0, e.rear_height)[1]
    view.along(
        "sheet.thickness b", (x0, x0 + design.sheet.thickness), (e.rear_height,) * 2, top + 6.0, "before"
    )
    one = View(*HINGE)
    _hinge(one, layout, place)
    two = View(*BOTH)
    _two_sided(two, layout, place)
    heads = [
        Text((12.0, 217.0), 'The hinge enlarged (sides = "one")', 3.2),
        Text((180.0, 217.0), 'sides = "two": a slot from both faces', 3.2),
        Text((12.0, 121.0), "Side view of the element with the longest arm, and its edge", 3.2),
    ]
    return DrawnSheet(
        "element",
        "the words of [element], [holes] and [stop]",
        size,
        (*view.items, *one.items, *two.items, *heads),
    )


def _side(view: View, layout: Layout, place: ElementPlace) -> None:
    design, e = layout.design, layout.design.element
    gap = stop_gap(layout, place)
    contour = outline(layout, place.arm, place.hinge, gap)
    view.contour(contour)
    slot, clamp, rear, top = (
        place.hinge_x + place.hinge.l / 2,
        layout.clamp_edge,
        layout.rear_end,
        e.rear_height,
    )
    for hole in mounting_holes(layout):
        x0, z0, x1, z1 = hole.box
        view.items.append(DrawnArc(view.at((x0 + x1) / 2, (z0 + z1) / 2), (x1 - x0) / 2 * view.scale))
    z = design.holes.height
    for x in (*layout.screw_x, *layout.dowel_x):
        view.line(((x, z - 2.1), (x, z + 2.1)), CENTRE)
        view.line(((x - 2.1, z), (x + 2.1, z)), CENTRE)
    tip, hinge = layout.pad_inner, place.hinge_x
    middle = (layout.pad_inner + layout.pad_outer) / 2
    view.line(((hinge, -0.3), (hinge, 3.4)), CENTRE)
    view.line(((middle, -e.pad_height - 0.7), (middle, 3.4)), CENTRE)
    y = view.at(0, 0)[1]
    over = view.at(0, top)[1]
    # above
    land = layout.ledge - gap
    view.along("load arm L", (middle, hinge), (3.4, 3.4), y + 23)
    view.along("row_arms (arm a)", (tip, hinge), (land, 3.4), y + 30)
    view.along("stop.land_length", (tip, tip + design.stop.land_length), (land, 3.4), y + 23, "before")
    view.along("seat_length", (slot, clamp), (layout.ledge, top), over + 8, "before")
    view.along("holes.dowel_offsets", (clamp, layout.dowel_x[0]), (top, z + 2.1), over + 8)
    view.along("holes.screw_offsets", (clamp, layout.screw_x[-1]), (top, z + 2.1), over + 16)
    view.along("rear_length", (clamp, rear), (top, top), over + 24)
    # below
    view.along("pad_length", (tip, layout.pad_outer), (-e.pad_height,) * 2, y - 22, "after")
    view.along("recess_offset", (clamp, layout.recess_start), (0.0, 0.0), y - 14, "after")
    # beside
    left, right = view.at(tip, 0)[0], view.at(rear, 0)[0]
    view.across("pad_height", (-e.pad_height, 0.0), (tip, layout.pad_outer), left - 5, "before")
    view.across("stop.gaps", (layout.ledge - gap, layout.ledge), (tip, slot), left - 11, "before")
    view.across("recess_depth", (0.0, e.recess_depth), (layout.recess_start, rear), right + 7, "before")
    view.across("holes.height", (0.0, z), (layout.recess_start, layout.screw_x[-1] + 2.1), right + 14)
    view.across("rear_height", (0.0, top), (layout.recess_start, rear), right + 21)
    # named
    roots = {s.name: s for s in contour if isinstance(s, Arc)}
    for name, arc, to in (
        ("pad_root_radius", "pad_root", (5.0, -4.5)),
        ("corner_radius", "recess_root", (9.0, -9.5)),
    ):
        u, v = roots[arc].at(0.5)
        x, yy = view.at(u, v)
        view.called(name, u, v, (x + to[0], yy + to[1]))
    dowel = layout.dowel_x[0]
    r = design.holes.dowel_hole / 2
    view.called("holes.dowel_hole", dowel + r * 0.6, z - r * 0.8, (view.at(dowel, 0)[0] + 9, y + 9))
    view.called("pad", middle + 0.5, -1.0, (view.at(layout.pad_outer, 0)[0] + 6, y - 11), dot=True)
    view.word("arm", (layout.pad_outer + hinge) / 2, e.arm_height / 2)
    view.word("body", (slot + clamp) / 2 + 0.2, 1.6)
    view.word("rear body", (layout.dowel_x[0] + layout.screw_x[-1]) / 2, 7.1)
    view.word("wire recess", layout.recess_start + 8.0, 0.38)
    view.called("clamp edge", clamp, top - 0.5, (view.at(clamp, 0)[0] - 13, over - 1))


def _hinge(view: View, layout: Layout, place: ElementPlace) -> None:
    h = place.hinge
    contour = outline(layout, place.arm, h, stop_gap(layout, place))
    xa, xb = place.hinge_x - h.l / 2, place.hinge_x + h.l / 2
    window = (xa - 1.3, -0.6, xb + 1.65, 3.2)
    view.contour(contour, window)
    left, right = view.at(window[0], 0)[0], view.at(window[2], 0)[0]
    view.along("hinge_length l", (xa, xb), (h.h, layout.ledge), view.at(0, layout.ledge)[1] + 5, "before")
    view.across("arm_height h", (0.0, h.h), (window[0], window[0]), left - 4)
    view.across("body_height Hb", (0.0, layout.ledge), (window[2], window[2]), right + 6)
    view.across("hinge_thickness t", (0.0, h.t), (place.hinge_x,) * 2, view.at(place.hinge_x, 0)[0], "after")
    fillet = next(s for s in contour if s.name == "slot_body_fillet")
    u, v = fillet.at(0.5)
    x, y = view.at(u, v)
    view.called("fillet_radius r", u, v, (x + 4.5, y + 8))
    view.word("arm", xa - 0.75, 1.4)
    view.word("body", xb + 0.9, 2.0)
    view.called("ledge", xb + 1.0, layout.ledge, (right + 6, view.at(0, layout.ledge)[1] + 5))
    view.word("slot", place.hinge_x + 0.225, 2.2, 2.5)
    view.called("hinge", xa + 0.2, 0.1, (left - 8, view.at(0, -0.3)[1]), dot=True)
    view.called("flat face (the gauge's)", xb + 0.4, 0.0, (view.at(xb, 0)[0] + 14, view.at(0, -0.35)[1]))


def _two_sided(view: View, layout: Layout, place: ElementPlace) -> None:
    e, h = layout.design.element, place.hinge
    own = Layout(replace(layout.design, element=replace(e, sides="two", body_height=2 * layout.ledge - h.h)))
    xa, xb = place.hinge_x - h.l / 2, place.hinge_x + h.l / 2
    view.contour(outline(own, place.arm, h, stop_gap(layout, place)), (xa - 1.3, -0.6, xb + 1.3, 3.2))
    middle = (h.h + h.t) / 2
    view.called(
        "hinge", place.hinge_x, middle - h.t / 2, (view.at(xb, 0)[0] + 6, view.at(0, middle)[1] - 8), dot=True
    )
    view.word("arm", xa - 0.75, 1.4)
    view.word("body", xb + 0.9, 2.0)


def array_sheet(design: Design) -> DrawnSheet:
    """The array as the object sees it, and two facing elements in their clamp from the side."""
    layout = Layout(design)
    plan, side = View(*PLAN, flip=True), View(*SECTION)
    _plan(plan, layout)
    _section(side, layout)
    heads = [
        Text((12.0, 246.0), "The array as the object sees it, carrier and stop plate not shown", 3.2),
        Text((12.0, 94.0), "Two facing elements from the side, with the parts that hold them", 3.2),
    ]
    return DrawnSheet("array", "the words of [array]", (236.0, 254.0), (*plan.items, *side.items, *heads))


def _plan(view: View, layout: Layout) -> None:
    design, thick = layout.design, layout.design.sheet.thickness
    rear, clamp, out = layout.rear_end, layout.clamp_edge, layout.stack / 2
    for p in layout.elements:
        turn = 1 if p.row == 1 else -1
        low, high = p.y - thick / 2, p.y + thick / 2
        view.box(turn * layout.pad_inner, low, turn * rear, high)
        view.line(((turn * layout.pad_outer, low), (turn * layout.pad_outer, high)))
        view.line(((turn * layout.recess_start, low), (turn * layout.recess_start, high)))
        for end in (-1, 1):
            x = turn * (p.hinge_x + end * p.hinge.l / 2)
            view.line(((x, low), (x, high)), HIDDEN)
        view.word(p.designator, turn * (rear - 3.0), p.y)
    for index in range(layout.positions + 1):
        y = layout.position_y(0) + (index - 0.5) * design.array.pitch
        for turn in (-1, 1):
            view.box(turn * clamp, y - layout.spacer / 2, turn * rear, y + layout.spacer / 2)
    for turn in (-1, 1):
        y = turn * (out + design.clamp.end_plate_thickness)
        view.box(-layout.end_plate_half, min(turn * out, y), layout.end_plate_half, max(turn * out, y))
    first, second = layout.elements[0], layout.elements[1]
    right, left = view.at(layout.end_plate_half, 0)[0], view.at(-layout.end_plate_half, 0)[0]
    view.across("pitch", (first.y, second.y), (rear, rear), right + 6, "before")
    edge = layout.elements[2].y + thick / 2
    view.across("spacer", (edge, edge + layout.spacer), (-rear, -rear), left - 6, "after")
    last = layout.elements[layout.positions - 1].y
    view.across("sheet.thickness b", (last - thick / 2, last + thick / 2), (rear, rear), right + 13, "after")
    view.across(
        "clamp.end_plate_thickness",
        (out, out + design.clamp.end_plate_thickness),
        (-layout.end_plate_half,) * 2,
        left - 13,
        "after",
    )
    top = view.at(0, -out - design.clamp.end_plate_thickness)[1]
    half = design.array.row_pitch / 2
    view.along("row_pitch", (-half, half), (first.y - thick / 2,) * 2, top + 5, "before")
    for x in (-half, half):
        view.line(((x, first.y - thick / 2), (x, first.y + thick / 2)), CENTRE)
    view.along(
        "row_arms (arm a of E1)",
        (layout.pad_inner, first.hinge_x),
        (first.y - thick / 2,) * 2,
        top + 12,
        "after",
    )
    x, y = view.at(0, out + design.clamp.end_plate_thickness)
    view.called("pad", layout.pad_inner + 1.0, last, (x + 14, y - 4), dot=True)
    gauge = layout.elements[layout.positions - 2]
    view.called("hinge, with the gauge", gauge.hinge_x, gauge.y, (x + 34, y - 8), dot=True)
    row = layout.elements[-1]
    view.called("arm", -(layout.pad_outer + row.hinge_x) / 2, row.y, (x - 18, y - 4), dot=True)
    view.called("spacer", -clamp - 4, row.y + design.array.pitch / 2, (x - 44, y - 8), dot=True)
    view.word("end plate", 20.0, out + design.clamp.end_plate_thickness / 2)
    view.word("row one", (clamp + rear) / 2 - 2, -out - 3.2)
    view.word("row two", -(clamp + rear) / 2 + 2, -out - 3.2)
    for name, u, v in (("+x", 5.0, 0.0), ("+y", 0.0, 5.0)):
        tip = (-layout.end_plate_half + u, -out - design.clamp.end_plate_thickness - 6.5 + v)
        start = (-layout.end_plate_half, -out - design.clamp.end_plate_thickness - 6.5)
        view.items += [segment(view.at(*start), view.at(*tip)), arrow(view.at(*tip), view.at(*start), ARROW)]
        x, y = view.at(*tip)
        view.items.append(Text((x + 1.0, y - LETTERS / 2 if u else y), name, LETTERS))


def _section(view: View, layout: Layout) -> None:
    e, c = layout.design.element, layout.design.clamp
    for place, mirror in ((layout.elements[3], False), (layout.elements[5], True)):
        view.contour(outline(layout, place.arm, place.hinge, stop_gap(layout, place)), mirror=mirror)
    view.box(-layout.stop_plate_half, layout.ledge, layout.stop_plate_half, layout.stop_plate_top)
    low, high = layout.carrier_bottom, layout.carrier_bottom + c.carrier_thickness
    half = layout.carrier_length / 2
    view.box(-half, low, half, high)
    for turn in (-1, 1):
        view.line(
            ((turn * layout.end_plate_half, c.end_plate_bottom), (turn * layout.end_plate_half, low)), HIDDEN
        )
    view.line(
        ((-layout.end_plate_half, c.end_plate_bottom), (layout.end_plate_half, c.end_plate_bottom)), HIDDEN
    )
    view.line(((-half, -e.pad_height), (half, -e.pad_height)), CENTRE)
    view.word("carrier", 0.0, (low + high) / 2)
    view.word("stop plate", 0.0, (layout.ledge + layout.stop_plate_top) / 2)
    x, y = view.at(0, -e.pad_height)
    view.called("object", half - 3, -e.pad_height, (view.at(half, 0)[0] + 3, y - 6))


if __name__ == "__main__":
    out = Path(sys.argv[1])
    design = read(ROOT / "hardware" / "macro-array.toml")
    for sheet in (element_sheet(design), array_sheet(design)):
        (out / f"labelled-{sheet.number}.svg").write_bytes(svg_bytes(sheet))
