"""The array: two facing rows of elements between end plates, with stop plate and carrier."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

from tactcad.design.present import present
from tactcad.design.tree import Design
from tactcad.parts import seating
from tactcad.parts.blank import blank
from tactcad.parts.carrier import carrier
from tactcad.parts.consumables import array_supplies
from tactcad.parts.description import Part
from tactcad.parts.element import element
from tactcad.parts.end_plate import end_plate
from tactcad.parts.fasteners import carrier_screw, clamping
from tactcad.parts.layout import Layout
from tactcad.parts.library import dowels, screws
from tactcad.parts.spacer import spacer
from tactcad.parts.stop_plate import stop_plate

from .builder import Builder
from .scene import AGAINST_Y, ALONG_Y, DOWN, UPRIGHT, Scene, Step

# Local contour plane (x, y) laid into the scene's (x, z) plane, thickness along y: row one's arms
# run along +x, row two is row one turned by half a turn about z.
ROW = {1: AGAINST_Y, 2: ALONG_Y}
# Steps of the assembly, as the guide names them.
GAUGES = "Gauges"
FIRST_PLATE = "End plate and dowels"
STACK = "Stack"
OTHER_PLATE = "Other end plate"
COPLANAR = "Coplanar pads"
STOP_PLATE = "Stop plate"
CARRIER = "Carrier"
HOLD_DOWN = "Hold the stop plate down"


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
    steps = [replace(step, designators=tuple(b.placed_in.get(step.title, ()))) for step in _steps(layout)]
    return replace(b.scene("array", cover=_cover(b)), steps=tuple(steps))


def without_gaps(design: Design) -> Scene:
    """The array's placements without steps, its elements without a stop gap: this needs no estimator."""
    layout = Layout(design)
    return _placed(layout, {p.number: element(layout, p, 0.0) for p in layout.elements}, True).scene("array")


def _placed(layout: Layout, instead: Mapping[int, Part], stops: bool) -> Builder:
    """Every part at its place, with its contacts and the step that puts it there."""
    b = Builder()
    b.supplies += array_supplies(layout)
    on_ledge = _stack(b, layout, instead)
    _clamping(b, layout)
    _carrier_screws(b, layout)
    if stops:
        _stop_plate(b, layout, on_ledge)
    b.placed_in[STACK].reverse()  # built up from the second end plate
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


def _steps(layout: Layout) -> tuple[Step, ...]:
    """Steps that put the array together and make its pads coplanar, in order, without the parts that they
    place.
    """
    d = layout.design
    gap, stack = 2 * layout.pad_inner, layout.stack
    width = stack + 2 * d.clamp.end_plate_thickness
    tolerance = d.tolerance.pad_height
    return (
        Step(
            GAUGES,
            (),
            (0, 0, 0),
            "Measure and record the hinge thickness of every element. Bond a gauge on each flat face, its "
            "grid centred on the hinge within 0.1 mm, carrier trimmed to "
            f"{d.gauge.carrier_arm_side + d.gauge.carrier_body_side:g} mm; cure, coat, solder three leads, "
            "and lay them in the wire recess towards the rear end.",
        ),
        Step(
            FIRST_PLATE,
            (),
            (0, 0.6 * width, 0),
            "Press the dowels square into the tapped end plate (H7, light press). Stand the plate on its "
            "outer face.",
        ),
        Step(
            STACK,
            (),
            (0, -1.5 * stack - 20.0, 0),
            "Slide spacer, element, spacer, ... on the dowels, each row in the order of its numbers. "
            "Nothing is tight yet.",
            fan=True,
        ),
        Step(
            OTHER_PLATE,
            (),
            (0, -1.5 * stack - 20.0 - width, 0),
            "Slide the counterbored end plate on the dowels.",
        ),
        Step(
            COPLANAR,
            (),
            (0, -1.5 * stack - 40.0 - 1.6 * width, 0),
            f"Set the stack pads down on a surface plate (grade 1 or better). Put a gauge block of {gap:g} "
            "mm between the rows' pads. Press the elements' rear bodies down with a bar of rubber so that "
            "every pad stands on the plate, then tighten the clamping screws crosswise, in three rounds: a "
            f"third, two thirds, the whole torque. Measure: no pad may let a {2 * tolerance * 1e3:g} um "
            "feeler pass. Then turn the array on its back and read each pad with a lever indicator against "
            f"the surface plate: all within {tolerance * 1e3:g} um; in the calibration set-up the heights at "
            "which the force gauge first reads 0.01 N show the same to a micrometre. Record them; loosen and "
            "repeat if one is off.",
        ),
        Step(
            STOP_PLATE,
            (),
            (0, 0, 0.8 * width),
            (
                "An array that is still to be calibrated goes to that set-up without stop plate and set "
                "screws, its carrier on: the stops would "
                "close before the end of the travel. Afterwards take the carrier off again. "
                if d.calibration
                else ""
            )
            + "Wipe ledges and plate. Lay the stop plate on the ledges, ground face down.",
        ),
        Step(
            CARRIER,
            (),
            (0, 0, 1.4 * width),
            "Screw the carrier on both end plates. On the surface plate again: the pads must not have moved.",
        ),
        Step(
            HOLD_DOWN,
            (),
            (0, 0, 2.1 * width),
            f"Turn the set screws in, crosswise, {seating.words(layout)}, locked with a "
            "drop of thread lacquer. Check each stop: push every pad with a "
            "plastic rod; it must give way and come to a stop, with "
            + ", ".join(
                sorted(
                    {f"{g:g} mm at arm {a:g}" for a, g in _gaps(layout)}, key=lambda s: float(s.split()[-1])
                )
            )
            + f" (within {d.stop.tolerance:g} mm) on the lever indicator at the tip.",
        ),
    )


def _gaps(layout: Layout) -> set[tuple[float, float]]:
    """Arm length and stop gap of every kind of element, mm."""
    from tactcad.parts.stop_gap import stop_gap  # numpy

    return {(p.arm, stop_gap(layout, p)) for p in layout.elements}
