"""The array: two facing rows of elements between end plates, with stop plate and carrier."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

from tactcad.design.present import present
from tactcad.design.tree import Design
from tactcad.parts.blank import blank
from tactcad.parts.carrier import carrier
from tactcad.parts.consumables import array_supplies
from tactcad.parts.description import Part
from tactcad.parts.electronic_supplies import electronic_supplies
from tactcad.parts.element import element
from tactcad.parts.end_plate import end_plate
from tactcad.parts.fasteners import carrier_screw, clamping
from tactcad.parts.layout import Layout
from tactcad.parts.library import dowels, screws
from tactcad.parts.spacer import spacer
from tactcad.parts.stiffness_table import array_lines
from tactcad.parts.stop_plate import stop_plate

from ..array_steps import (
    CARRIER,
    COPLANAR,
    FIRST_PLATE,
    HOLD_DOWN,
    OTHER_PLATE,
    STACK,
    STOP_PLATE,
    array_steps,
    first_on_first,
)
from ..builder import Builder
from ..rig import ARRAY, Rig, none
from ..scene import AGAINST_Y, ALONG_Y, DOWN, UPRIGHT, Scene

# Local contour plane (x, y) laid into the scene's (x, z) plane, thickness along y: row one's arms
# run along +x, row two is row one turned by half a turn about z.
ROW = {1: AGAINST_Y, 2: ALONG_Y}


def array(design: Design, instead: Mapping[int, Part] = MappingProxyType({}), stops: bool = True) -> Scene:
    """Scene `array` of a design; elements are E1, E2, ... by number.

    Parameters
    ----------
    design
        Must keep every rule.
    instead
        Other parts by element number, such as one that a rig has pressed.
    stops
        Whether the stop plate and its set screws are in place; they are not in the calibration.
    """
    layout = Layout(design)
    b = _placed(layout, instead, stops)
    at = {p.designator: p for p in b.placements}
    placed = {title: [at[name] for name in names] for title, names in b.placed_in.items()}
    placed[STACK] = first_on_first(placed[STACK])
    return replace(b.scene("array", cover=_cover(b)), steps=array_steps(layout, placed))


def without_gaps(design: Design) -> Scene:
    """The array's placements without steps, its elements without a stop gap: this needs no estimator."""
    layout = Layout(design)
    return _placed(layout, {p.number: element(layout, p, 0.0) for p in layout.elements}, True).scene("array")


def _placed(layout: Layout, instead: Mapping[int, Part], stops: bool) -> Builder:
    """Every part at its place, with its contacts and the step that puts it there."""
    b = Builder()
    b.supplies += (*array_supplies(layout), *electronic_supplies(layout))
    on_ledge = _stack(b, layout, instead)
    _clamping(b, layout)
    _carrier_screws(b, layout)
    if stops:
        _stop_plate(b, layout, on_ledge)
    return b


def _cover(b: Builder) -> set[str]:
    """Designators of what is taken off to look inside: screws and pins among them."""
    return {"ST1", "CA1", "EP1"} | {p.designator for p in b.placements if p.part.bought}


def _stack(b: Builder, layout: Layout, instead: Mapping[int, Part]) -> list[str]:
    """Elements and blanks, a spacer before, between and after them, row by row; end plates and carrier
    around them.

    Returns the designators of elements and blanks.
    """
    d = layout.design
    half_sheet, half_spacer = d.sheet.thickness / 2, layout.spacer / 2
    between, empty = spacer(layout), blank(layout)
    standing = {(p.row, p.index): instead.get(p.number) or element(layout, p) for p in layout.elements}
    ends, on_ledge = [], []
    for row in (1, 2):
        out = 1.0 if row == 1 else -1.0  # local thickness runs along -y in row one, +y in row two
        before = None
        for i in range(layout.positions + 1):
            y = -layout.stack / 2 + i * d.array.pitch + half_spacer
            beside = b.place("SP", between, (0, y + out * half_spacer, 0), ROW[row], STACK)
            if before:
                b.meet(before, beside)
            else:
                ends.append(("EP1", beside))
            if i < layout.positions:
                at = (0, layout.position_y(i) + out * half_sheet, 0)
                part = standing.get((row, i))
                before = b.place("E" if part else "BL", part or empty, at, ROW[row], STACK)
                b.meet(beside, before)
                on_ledge.append(before)
        ends.append(("EP2", beside))
    outer = layout.stack / 2 + d.clamp.end_plate_thickness
    z0 = layout.end_plate_z[0]
    b.place("EP", end_plate(layout, head=True), (0, -outer, z0), ALONG_Y, OTHER_PLATE)
    b.place("EP", end_plate(layout, head=False), (0, outer, z0), AGAINST_Y, FIRST_PLATE)
    for plate, spacer_name in ends:
        b.meet(plate, spacer_name)
    b.place("CA", carrier(layout), (0, 0, layout.carrier_bottom), UPRIGHT, CARRIER)
    b.meet("EP1", "CA1")
    b.meet("EP2", "CA1")
    return on_ledge


def _clamping(b: Builder, layout: Layout) -> None:
    """Screws (or tie rods) and dowels along y through both rows."""
    d, c = layout.design, clamping(layout)
    z, face = d.holes.height, layout.stack / 2
    for x in (side * x for side in (1, -1) for x in layout.screw_x):
        if c.head_plate_web is None:
            _tie_rod(b, layout, x, c.screw)
            continue
        screw = screws.cap_screw(d.clamp.screw, c.screw)
        name = b.place("SC", screw, (x, -(face + c.head_plate_web), z), ALONG_Y, COPLANAR)
        b.meet(name, "EP1")
        b.meet(name, "EP2", "thread")
    pin = dowels.dowel(d.clamp.dowel, c.dowel)
    for x in (side * x for side in (1, -1) for x in layout.dowel_x):
        name = b.place("DW", pin, (x, -c.dowel / 2, z), ALONG_Y, FIRST_PLATE)
        b.meet(name, "EP2", "press")


def _tie_rod(b: Builder, layout: Layout, x: float, length: float) -> None:
    clamp, z = layout.design.clamp, layout.design.holes.height
    outer = layout.stack / 2 + clamp.end_plate_thickness
    rod = b.place("TR", screws.threaded_rod(clamp.screw, length), (x, -length / 2, z), ALONG_Y, COPLANAR)
    for y, outwards, plate in ((-outer, AGAINST_Y, "EP1"), (outer, ALONG_Y, "EP2")):
        nut = b.place("NU", screws.nut(clamp.screw), (x, y, z), outwards, COPLANAR)
        b.meet(plate, nut)
        b.meet(rod, nut, "thread")


def _carrier_screws(b: Builder, layout: Layout) -> None:
    """Carrier screws into the end"""
    fixing = present(carrier_screw(layout))
    screw = screws.cap_screw(layout.design.clamp.screw, fixing.length)
    z = layout.carrier_bottom + fixing.under_head
    for sx, sy in ((1, -1), (-1, -1), (1, 1), (-1, 1)):
        at = (sx * layout.carrier_screw_x, sy * layout.end_plate_y, z)
        name = b.place("SC", screw, at, DOWN, CARRIER)
        b.meet(name, "CA1")
        b.meet(name, "EP1" if sy < 0 else "EP2", "thread")


def _stop_plate(b: Builder, layout: Layout, on_ledge: list[str]) -> None:
    """The stop plate, and set screws in the carrier that press it on the ledges."""
    plate = b.place("ST", stop_plate(layout), (0, 0, layout.ledge), UPRIGHT, STOP_PLATE)
    for designator in on_ledge:
        b.meet(designator, plate)
    length = present(layout.hold_down.length)
    screw = screws.set_screw(layout.design.clamp.screw, length)
    for x, y in ((side * layout.hold_down_x, y) for side in (1, -1) for y in layout.hold_down_y):
        name = b.place("SS", screw, (x, y, layout.stop_plate_top + length), DOWN, HOLD_DOWN)
        b.meet(name, plate)
        b.meet(name, "CA1", "thread")


RIG = Rig(
    name=ARRAY,
    tables=(),
    make=lambda design, _pose: array(design),
    poses=none,
    under_sensor=none,
    rules=(),
    deflections=array_lines,
    requirements=lambda _layout, _known: [],  # the sensor's own: assembly/requirements.py
    checks=(),
)
