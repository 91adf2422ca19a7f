"""The array: two facing rows of elements between end plates, with stop plate and carrier; its steps, in the
mechanic's words, read off the placements."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import floor
from types import MappingProxyType
from typing import Any

from tactcad.design.fields import present
from tactcad.design.tree import Design
from tactcad.parts.array import seating
from tactcad.parts.array.clamp import (
    SPACER_TOLERANCE,
    Clamping,
    carrier,
    carrier_screw,
    clamping,
    dowel_depth,
    end_plate,
    head_bore,
    stop_plate,
)
from tactcad.parts.array.clamp import STACK as STACK_TOLERANCE
from tactcad.parts.array.element import blank, element, spacer
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.stiffness_table import array_lines
from tactcad.parts.array.supplies import array_supplies, electronic_supplies
from tactcad.parts.bought import screws, standard_parts
from tactcad.parts.bought.standard_parts import dowel_limits
from tactcad.parts.language.description import Part
from tactcad.parts.language.metric import METRIC
from tactcad.parts.rules.bonding_rules import FITS as BONDING_FITS
from tactcad.parts.rules.calibration_rules import FITS as CALIBRATION_FITS
from tactcad.parts.rules.rule import misfit

from ..builder import Builder, telling
from ..moves import FINGERTIP, PRESS, TWEEZED
from ..rig import ARRAY, Rig, none
from ..scene import AGAINST_Y, ALONG_Y, DOWN, UPRIGHT, Held, Placement, Scene, Step

said = telling(__file__)

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
    # Carrier screws into the end
    fixing = present(carrier_screw(layout))
    screw = screws.cap_screw(layout.design.clamp.screw, fixing.length)
    z = layout.carrier_bottom + fixing.under_head
    for sx, sy in ((1, -1), (-1, -1), (1, 1), (-1, 1)):
        at = (sx * layout.carrier_screw_x, sy * layout.end_plate_y, z)
        name = b.place("SC", screw, at, DOWN, CARRIER, "CA1")
        b.meet(name, "EP1" if sy < 0 else "EP2", "thread")
    if stops:
        _stop_plate(b, layout, on_ledge)
    return b


def _cover(b: Builder) -> set[str]:
    """Designators of the parts taken off to look inside, with screws and pins."""
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
        name = b.place("SC", screw, (x, -(face + c.head_plate_web), z), ALONG_Y, COPLANAR, "EP1")
        b.meet(name, "EP2", "thread")
    pin = standard_parts.dowel(d.clamp.dowel, c.dowel)
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


def _stop_plate(b: Builder, layout: Layout, on_ledge: list[str]) -> None:
    """The stop plate, and set screws in the carrier that press it on the ledges."""
    plate = b.place("ST", stop_plate(layout), (0, 0, layout.ledge), UPRIGHT, STOP_PLATE)
    for designator in on_ledge:
        b.meet(designator, plate)
    length = present(layout.hold_down.length)
    screw = screws.set_screw(layout.design.clamp.screw, length)
    for x, y in ((side * layout.hold_down_x, y) for side in (1, -1) for y in layout.hold_down_y):
        name = b.place("SS", screw, (x, y, layout.stop_plate_top + length), DOWN, HOLD_DOWN, plate)
        b.meet(name, "CA1", "thread")


GAUGES = "Gauges"
FIRST_PLATE = "End plate and dowels"
STACK = "Stack"
OTHER_PLATE = "Other end plate"
COPLANAR = "Coplanar pads"
STOP_PLATE = "Stop plate"
CARRIER = "Carrier"
HOLD_DOWN = "Hold the stop plate down"

STACKED = (FIRST_PLATE, STACK, OTHER_PLATE)  # steps that make the loose stack
LEANING = 1 / 3  # of the head plate's play; chosen: the pins' own lean and places have the rest
ABREAST = 2  # rows that are stacked side by side


def first_on_first(stacked: Sequence[Placement]) -> list[Placement]:
    """Elements, blanks and spacers in the order in which they go on the dowels in the end plate at +y: two
    abreast, row one's part first."""
    return sorted(stacked, key=lambda p: (-round(_middle_y(p), 6), -p.rotation[0][0]))


def _middle_y(p: Placement) -> float:
    return p.origin[1] + p.rotation[1][2] * p.part.extrusion.thickness / 2


def array_steps(layout: Layout, placed: Mapping[str, Sequence[Placement]]) -> tuple[Step, ...]:
    """Steps that put the array together and make its pads coplanar, in order.

    Parameters
    ----------
    layout
        The array.
    placed
        What each step puts in place, by the step's title and in its order.
    """
    d, c = layout.design, clamping(layout)
    width = layout.stack + 2 * d.clamp.end_plate_thickness
    # so far apart that each part of the stack shows: a pitch of air before each
    way = 2 * (2 * layout.positions + 1) * d.array.pitch

    def step(
        title: str,
        explode: tuple[float, float, float],
        text: str,
        tools: tuple[str, ...] = (),
        fan: int = 0,
        elements: bool = False,
        limit: str = "",
        **more: Any,
    ) -> Step:
        names = tuple(p.designator for p in placed.get(title, ()))
        return Step(title, names, explode, text, fan=fan, tools=tools, elements=elements, limit=limit, **more)

    pins = " ".join(p.designator for p in placed[FIRST_PLATE] if p.part.bought)
    other = placed[OTHER_PLATE][0].designator
    on_ledge = [p.designator for p in placed[STACK] if p.part.part_no != spacer(layout).part_no]
    ledges = tuple(sorted(on_ledge, key=lambda name: (len(name), name)))

    def level(title: str, by: tuple[str, ...]) -> tuple[Held, ...]:
        names = tuple((p.designator,) for p in placed.get(title, ()) if not p.part.bought)
        return (Held(names, by, ("z", "rx", "ry")),)

    return (
        step(
            GAUGES, (0, 0, 0), _gauges(layout), ("micrometer or measuring microscope, 1 um",), elements=True
        ),
        step(
            FIRST_PLATE,
            (0, 0.6 * width, 0),
            _first_plate(layout, c, placed[FIRST_PLATE][0]),
            (PRESS, f"a sleeve {round(c.dowel - dowel_depth(layout), 9):g} mm long as stop"),
            view="on end",
        ),
        step(
            STACK,
            (0, -way, 0),
            _stacking(layout, placed[STACK]),
            fan=ABREAST,
            elements=True,
            view="on end",
            sets=(f"all on {pins}: along x and z, to the play of their holes", "each on the last: along y"),
            leaves=("each: turn about its dowel, along y away from the last",),
        ),
        step(
            OTHER_PLATE,
            (0, -way - width, 0),
            _other_plate(c, placed[OTHER_PLATE][0]),
            view="on end",
            sets=(f"{other} on {pins}: along x and z, turn about y", f"{other} on the stack: along y"),
            leaves=(f"{other}: along y, away from the stack",),
        ),
        step(
            COPLANAR,
            (0, -way - 20.0 - 1.6 * width, 0),
            f"In the setting fixture (scene setting). {setting_words(layout)}",
            (*flatness_tools(layout), "setting fixture"),
            elements=True,
            limit=f"All pads in one plane within {2 * d.tolerance.pad_height:g} mm",
        ),
        step(
            STOP_PLATE,
            (0, 0, 0.8 * width),
            _laying_stop_plate(layout),
            (TWEEZED,) if narrow(layout) else (),
            by=TWEEZED if narrow(layout) else "",
            held=level(STOP_PLATE, ledges),
        ),
        step(
            CARRIER,
            (0, 0, 1.4 * width),
            "Screw the carrier on both end plates, crosswise. Measure the pads' heights on the surface plate "
            "again: they must not have moved.",
            held=level(CARRIER, ("EP1", "EP2")),
        ),
        step(
            HOLD_DOWN,
            (0, 0, 2.1 * width),
            _hold_down(layout),
            ("plastic rod", "thread lacquer"),
            elements=True,
        ),
    )


def _gauges(layout: Layout) -> str:
    d = layout.design
    thinnest = min(place.hinge.t for place in layout.elements)
    face = "each flat face" if d.element.sides == "one" else "the floor of each slot on the pads' side"
    bonded = d.bonding is not None and misfit(layout, BONDING_FITS) is None
    how = (
        f"Bond a gauge on {face} in the bonding fixture and check it, both by the guide of scene bonding. "
        "Its leads lie in the wire recess and are bonded at the rear end."
        if bonded
        else said(
            "gauges without fixture",
            face=face,
            carrier=d.gauge.carrier_arm_side + d.gauge.carrier_body_side,
            laying_leads=laying_leads(layout),
        )
    )
    return said("gauges", thinnest=thinnest, how=how)


def laying_leads(layout: Layout) -> str:
    """How an element's leads are cut, and laid in its wire recess with their strain relief."""
    return said("laying leads", layout=layout)


def _first_plate(layout: Layout, c: Clamping, plate: Placement) -> str:
    deep = dowel_depth(layout)
    out = round(c.dowel - deep, 9)
    return said("first plate", plate=plate, name=plate.part.name.lower(), deep=deep, out=out)


def _stacking(layout: Layout, stacked: Sequence[Placement]) -> str:
    arms = {place.designator: f" (arm {place.arm:g})" for place in layout.elements}
    rows = []
    for row, sign in ((1, 1.0), (2, -1.0)):
        own = [p for p in stacked if p.rotation[0][0] * sign > 0]
        side = "right (+x)" if sign > 0 else "left (-x)"
        order = ", ".join(p.designator + arms.get(p.designator, "") for p in own)
        rows.append(f"Row {row}, on the {side}: {order}.")
    return said(
        "stacking",
        rows=" ".join(rows),
        layout=layout,
        stack_tolerance=STACK_TOLERANCE,
        alike=rows_alike(layout),
        spacer_tolerance=SPACER_TOLERANCE,
    )


def rows_alike(layout: Layout) -> float:
    """Largest difference in length of the two rows' stacks, mm, whole hundredths.

    The head plate lies on both and leans by the difference over their distance; over its thickness that takes
    a share of the least play of its holes.
    """
    d = layout.design
    play = head_bore(layout).lower - dowel_limits(d.clamp.dowel)[1]
    most = LEANING * play * 2 * min(layout.dowel_x) / d.clamp.end_plate_thickness
    return floor(100 * most) / 100


def _other_plate(c: Clamping, plate: Placement) -> str:
    sunk = "" if c.head_plate_web is None else "counterbores up, "
    return (
        f"Slide {plate.designator} ({plate.part.name.lower()}) onto the dowels, {sunk}the edge with the "
        "carrier's threads above that of the other plate."
    )


def wedge(layout: Layout) -> str:
    """Remaining turn of an element about its one dowel, its pad on the fixture's floor."""
    h, low = layout.design.holes, dowel_limits(layout.design.clamp.dowel)[0]
    play = h.dowel_hole + h.dowel_hole_upper - low
    lever = min(layout.dowel_x) - layout.pad_outer
    return f"{1e3 * play / lever:.2g} mrad at most, {1e3 * play:.0f} um of play on {lever:.1f} mm"


def setting_words(layout: Layout) -> str:
    """Instructions for tightening the stack in the setting fixture, and measuring it."""
    d, c = layout.design, clamping(layout)
    tolerance = d.tolerance.pad_height
    tight = "Tighten the clamping screws"
    if c.rod:
        tight = (
            "Push the tie rods through, as far out at one end as at the other, a nut at each end. Tighten "
            "the nuts, the one at the other end held,"
        )
    gap = (
        f"Check the gap between the rows with feelers, {2 * layout.pad_inner:g} mm nominal: the dowels set "
        "it, so force nothing between the pads. "
        if len(d.array.row_arms) == ABREAST
        else ""
    )
    same = (
        "; in the calibration set-up the heights at which the force gauge first reads 0.01 N show the same "
        "to a micrometre"
        if is_calibrated(layout)
        else ""
    )
    strip = " and every blank on the strip" if layout.blanks() else ""
    return said(
        "setting",
        strip=strip,
        tight=tight,
        wedge=wedge(layout),
        gap=gap,
        feeler=2 * tolerance * 1e3,
        same=same,
    )


def flatness_tools(layout: Layout) -> tuple[str, ...]:
    """Tools for making the pads coplanar, and for measuring them."""
    tolerance = layout.design.tolerance.pad_height
    feelers = f"feelers, {2 * tolerance * 1e3:g} um"
    if len(layout.design.array.row_arms) == ABREAST:
        feelers += f" and {2 * layout.pad_inner:g} mm"
    return (
        "surface plate, grade 1 or better",
        "bar of rubber for each row",
        feelers,
        "lever indicator, 1 um, on a stand",
    )


def carrier_tools(design: Design) -> tuple[str, ...]:
    """Tools for the carrier's screws."""
    return (f"hex key {METRIC[design.clamp.screw].key:g} mm: the carrier's screws",)


def is_calibrated(layout: Layout) -> bool:
    """Whether the calibration's rig takes the array."""
    return layout.design.calibration is not None and misfit(layout, CALIBRATION_FITS) is None


def narrow(layout: Layout) -> bool:
    """Whether no fingertip enters between the end plates."""
    return layout.stack < min(FINGERTIP)


def _laying_stop_plate(layout: Layout) -> str:
    calibrated = said("laying stop plate")
    return (
        (calibrated if is_calibrated(layout) else "")
        + "Wipe ledges and plate. Lay the stop plate on the ledges"
        + (", with tweezers between the end plates" if narrow(layout) else "")
        + "; both faces are ground, so either may "
        "face down."
    )


def _hold_down(layout: Layout) -> str:
    # Arm length and stop gap of every kind of element, mm.
    from tactcad.parts.array.stop_gap import seat, stop_gap

    gaps = sorted({(p.arm, stop_gap(layout, p)) for p in layout.elements}, key=lambda pair: pair[0])
    tolerance = layout.design.stop.tolerance
    wider = floor(1e3 * (tolerance + seat(layout)) + 1e-6) / 1e3  # a micrometre is what the indicator shows
    return said(
        "hold down",
        tight=seating.words(layout),
        gaps=", ".join(f"{gap:g} mm at arm {arm:g}" for arm, gap in gaps),
        tolerance=tolerance,
        wider=wider,
    )


RIG = Rig(
    name=ARRAY,
    tables=(),
    make=lambda design, _pose: array(design),
    poses=none,
    under_sensor=none,
    rules=(),
    deflections=array_lines,
    requirements=lambda _layout, _known: [],  # the sensor's own: stacks/requirements.py
    checks=(),
)
