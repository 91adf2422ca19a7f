"""Rules on the stack's holes and plates, and on the screws and pins that hold them."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations, product
from math import ceil, cos, degrees, hypot, pi, sqrt

from ..array.clamp import HOLES, LEAST_GRIP, carrier_screw, clamping, thinnest_carrier
from ..array.layout import (
    BESIDE_SET_SCREW,
    CARRIER_EDGE,
    END_PLATE_WEB,
    HOLE_WEB,
    LEAST_GAP,
    LEVER,
    SUNK,
    Layout,
)
from ..bought.screws import SET_SCREW_LENGTHS
from ..bought.standard_parts import LEAST_PLAY, dowel_diameter, dowel_limits
from ..language.finding import SAME, Finding
from ..language.metric import DRILL_REACH, METRIC, SOCKET_WALL, TAP_REACH, counterbore_diameter, engagement
from .rule import at_least, at_most, rule, wrong

# Tie rod and ground rod are sold in bars of up to 3 m (DIN 976-1: 1, 2 and 3 m).
LONGEST_ROD = 3000.0


@rule(after="stop_land_above_arm")
def holes_inside_body(layout: Layout) -> Iterator[Finding]:
    """Around every hole at least holes.web of element, spacer and end plate."""
    d, h = layout.design, layout.design.holes
    screw, dowel = METRIC[d.clamp.screw].clearance, h.dowel_hole + h.dowel_hole_upper
    low = max(d.element.recess_depth, layout.spacer_z[0])
    high = min(d.element.rear_height, layout.spacer_z[1])
    widest = max(screw, dowel)
    if low + 2 * h.web + widest > high + SAME:
        yield wrong(
            "element.rear_height",
            "rear body too low for its holes",
            d.element.rear_height,
            f"at least {d.element.rear_height + low + 2 * h.web + widest - high:g} mm",
        )
    elif not low + h.web + widest / 2 - SAME <= h.height <= high - h.web - widest / 2 + SAME:
        yield wrong(
            "holes.height",
            "holes too near the edge of the rear body or its spacer",
            h.height,
            f"from {low + h.web + widest / 2:g} to {high - h.web - widest / 2:g} mm",
        )
    least, loosest = round(dowel_limits(d.clamp.dowel)[1] + LEAST_PLAY, 6), float(d.clamp.dowel) + 0.1
    what = f"leaves the largest dowel (m6) less than {LEAST_PLAY:g} mm of play"
    yield from at_least("holes.dowel_hole", what, h.dowel_hole, least)
    if h.dowel_hole > loosest:
        yield wrong(
            "holes.dowel_hole", "does not locate on the dowel", h.dowel_hole, f"at most {loosest:g} mm"
        )
    holes = [("holes.screw_offsets", x, screw) for x in h.screw_offsets]
    holes += [("holes.dowel_offsets", x, dowel) for x in h.dowel_offsets]
    for path, x, diameter in holes:
        first, last = h.web + diameter / 2, d.element.rear_length - h.web - diameter / 2
        if not first - SAME <= x <= last + SAME:
            yield wrong(
                path, "hole outside the rear body", x, f"from {first:g} to {last:g} mm behind the clamp edge"
            )
    for (path, x0, d0), (_, x1, d1) in combinations(holes, 2):
        least = (d0 + d1) / 2 + h.web
        what = f"holes at {x0:g} and {x1:g} mm leave too thin a web"
        yield from at_least(path, what, abs(x1 - x0), least, f"at least {least:g} mm apart")


@rule(after="stop_land_above_arm")
def stack_can_be_clamped(layout: Layout) -> Iterator[Finding]:
    c = clamping(layout)
    if max(c.screw, c.dowel) > LONGEST_ROD:
        yield wrong(
            "array.row_arms",
            "stack longer than any tie rod",
            layout.stack,
            f"at most about {LONGEST_ROD:g} mm",
        )
    if c.dowel < layout.stack + 2 * LEAST_GRIP - SAME:
        yield wrong(
            "clamp.end_plate_thickness",
            "no dowel grips both end plates",
            layout.design.clamp.end_plate_thickness,
            f"at least {LEAST_GRIP:g} mm",
        )


@rule(after="stop_land_above_arm")
def end_plate_takes_holes(layout: Layout) -> Iterator[Finding]:
    d, c = layout.design, layout.design.clamp
    z0, z1 = layout.end_plate_z
    m = METRIC[c.screw]
    rod = clamping(layout).rod
    # a counterbore needs material around it; a nut only has to lie on the plate
    around = (m.nut / cos(pi / 6) if rod else counterbore_diameter(c.screw)) / 2
    web = LEAST_GAP if rod else END_PLATE_WEB
    lowest = d.holes.height - max(around + web, float(c.dowel) / 2 + END_PLATE_WEB)
    yield from at_most("clamp.end_plate_bottom", "end plate ends in screw heads or dowels", z0, lowest)
    top = max(layout.lowest_carrier, layout.stop_plate_top + LEAST_GAP)
    if layout.hold_down.length is not None:
        yield from at_least(
            "clamp.end_plate_height",
            "carrier too low over rear bodies and clamping screws",
            z1 - z0,
            top - z0,
        )
    yield from at_least(
        "clamp.end_plate_margin",
        "end plate ends in the screw heads",
        c.end_plate_margin,
        around + web - (layout.rear_end - max(layout.screw_x)),
    )
    yield from _heads_apart(layout, around, rod)
    yield from at_most(
        "clamp.end_plate_thickness",
        "too thick for the drills of its holes",
        c.end_plate_thickness,
        DRILL_REACH * min(m.clearance if rod else m.tap_drill, float(c.dowel)),
    )
    if c.end_plate_thickness / 2 - m.tap_drill / 2 < END_PLATE_WEB:
        yield wrong(
            "clamp.end_plate_thickness",
            "too thin for the carrier's threads",
            c.end_plate_thickness,
            f"at least {2 * END_PLATE_WEB + m.tap_drill:g} mm",
        )


def _heads_apart(layout: Layout, around: float, rod: bool) -> Iterator[Finding]:
    """Screw heads or nuts of radius `around` (mm) clear each other, the dowels, and the other row's."""
    dowel = float(layout.design.clamp.dowel) / 2
    spots = [(x, around, True) for x in layout.screw_x] + [(x, dowel, False) for x in layout.dowel_x]
    beside = SOCKET_WALL if rod else 0.0  # a socket wrench fits over a nut next to another; dowels end flush
    between = LEAST_GAP if rod else HOLE_WEB
    for (x0, r0, turned), (x1, r1, other) in combinations(spots, 2):
        least = r0 + r1 + between + (beside if turned and other else 0.0)
        what = "screw heads or nuts too near each other or a dowel"
        yield from at_least("holes.screw_offsets", what, abs(x0 - x1), least, f"at least {least:g} mm apart")
    first, least = min(x - r for x, r, _ in spots), LEAST_GAP + beside / 2
    legal = f"at least {least:g} mm from the middle line"
    yield from at_least("holes.screw_offsets", "heads of both rows meet", first, least, legal)


@rule(after="stop_land_above_arm")
def carrier_can_be_screwed(layout: Layout) -> Iterator[Finding]:
    c = layout.design.clamp
    path, thickness = "clamp.carrier_thickness", c.carrier_thickness
    if carrier_screw(layout) is None:
        yield wrong(
            path,
            f"no standard {c.screw} screw sinks its head and engages the end plate",
            thickness,
            f"at least {thinnest_carrier(c.screw):g} mm",
        )
    what = f"too thin for the axis's {c.mount_thread} threads"
    yield from at_least(path, what, thickness, engagement(c.mount_thread))
    what = f"too thick to be tapped through for {c.screw} set screws"
    yield from at_most(path, what, thickness, TAP_REACH * METRIC[c.screw].d)


@rule(after="stop_land_above_arm")
def stop_plate_can_be_held(layout: Layout) -> Iterator[Finding]:
    d, c = layout.design, layout.design.clamp
    m = METRIC[c.screw]
    yield from _set_screw_holds(layout)
    widest = min(BESIDE_SET_SCREW + (m.d - m.set_point) / 2, layout.spacer + d.sheet.thickness / 2)
    yield from at_most(
        "clamp.stop_plate_gap",
        "stop plate ends before the set screws, or before the outermost ledge",
        c.stop_plate_gap,
        widest,
    )
    shortest = m.d + 2 * BESIDE_SET_SCREW
    yield from at_least(
        "clamp.screw",
        f"no room for an {c.screw} set screw between the end plates",
        layout.stack,
        shortest,
        f"a stack of at least {shortest:g} mm",
    )
    yield from at_least(
        "element.seat_length",
        "the set screws miss the ledge of the longest arm",
        d.element.seat_length,
        layout.clamp_edge - layout.hold_down_x,
    )
    if layout.stop_plate_width < 1.0:
        yield wrong(
            "clamp.stop_plate_gap",
            "leaves no stop plate between the end plates",
            c.stop_plate_gap,
            f"less than {(layout.stack - 1) / 2:g} mm",
        )
    yield from _stop_plate_lies(layout)


def _stop_plate_lies(layout: Layout) -> Iterator[Finding]:
    """On ledges so far apart along the row that it does not rock: edges of n sheets a row at one pitch, from
    the plate's middle, by the root of their squares' sum, as the check of steps has it."""
    d, wide, thick = layout.design, layout.stop_plate_width, layout.design.clamp.stop_plate_thickness
    apart = d.array.pitch**2 * (layout.positions**2 - 1) / 3
    least = sqrt(max((LEVER * hypot(wide, thick)) ** 2 / (2 * layout.positions) - apart, 0.0))
    yield from at_least(
        "sheet.thickness",
        f"stop plate of {wide:g} x {thick:g} mm rocks on its ledges",
        d.sheet.thickness,
        least,
        f"at least {ceil(1e3 * least - SAME) / 1e3:g} mm, or a smaller array.pitch",
    )


def _set_screw_holds(layout: Layout) -> Iterator[Finding]:
    """A standard set screw reaches the stop plate and engages the carrier's thread sufficiently."""
    c, hold = layout.design.clamp, layout.hold_down
    if hold.length is None:
        short = hold.reach - (SET_SCREW_LENGTHS[c.screw][-1] - c.carrier_thickness + SUNK)
        yield wrong(
            "clamp.stop_plate_thickness",
            f"no standard {c.screw} set screw reaches from the carrier to the stop plate",
            c.stop_plate_thickness,
            f"at least {c.stop_plate_thickness + short:.4g} mm, or a larger screw",
        )
        return
    yield from at_least(
        "clamp.carrier_thickness",
        f"too thin for the threads of {c.screw} set screws",
        c.carrier_thickness,
        engagement(c.screw) + SUNK,
    )
    engaged = hold.length - (layout.carrier_bottom - layout.stop_plate_top)
    if not engagement(c.screw) - SAME <= engaged <= c.carrier_thickness + SAME:
        yield wrong(
            "clamp.end_plate_height",
            f"the {hold.length:g} mm set screw does not engage the carrier sufficiently",
            c.end_plate_height,
            "leave it out, to have it derived",
        )


@rule(after="stop_land_above_arm")
def carrier_holes_apart(layout: Layout) -> Iterator[Finding]:
    """Screw heads, axis threads and set screws in the carrier leave HOLE_WEB between them, CARRIER_EDGE
    around."""
    c, seat = layout.design.clamp, "element.seat_length"
    head, mount, m = counterbore_diameter(c.screw), METRIC[c.mount_thread].d, METRIC[c.screw]
    offset = c.carrier_screw_offset
    # path of the field that moves it, that field's value, its place, its radius
    spots = [
        ("clamp.carrier_screw_offset", offset, layout.carrier_screw_x, layout.end_plate_y, head / 2),
        ("clamp.mount_pitch_y", c.mount_pitch_y, layout.mount_x, c.mount_pitch_y / 2, mount / 2),
    ]
    for y in layout.hold_down_y:
        spots.append((seat, layout.design.element.seat_length, layout.hold_down_x, y, m.d / 2))
    # one quadrant against all four: rows and ends are each other's mirror images
    for (i, a), (j, b), sx, sy in product(enumerate(spots), enumerate(spots), (1, -1), (1, -1)):
        if j < i or (a[2], a[3]) == (sx * b[2], sy * b[3]):
            continue
        apart, least = hypot(a[2] - sx * b[2], a[3] - sy * b[3]), a[4] + b[4] + HOLE_WEB
        if apart < least - SAME:
            path, value = (a if b[0] == seat else b)[:2]
            yield wrong(
                path, f"holes of the carrier {apart:.3g} mm apart", value, f"at least {least:.3g} mm apart"
            )
    half = layout.carrier_size[0] / 2
    for path, value, x, _, r in spots:
        if x + r + CARRIER_EDGE > half + SAME:
            what = f"hole at the carrier's edge, {x:g} mm from the middle"
            over = x + r + CARRIER_EDGE - half
            own = f"at most {value - over:.4g} mm, or " if path == "clamp.carrier_screw_offset" else ""
            yield wrong(
                path, what, value, f"{own}clamp.carrier_margin at least {c.carrier_margin + over:.4g} mm"
            )
    most = layout.end_plate_half - layout.clamp_edge - m.tap_drill / 2 - END_PLATE_WEB
    if layout.carrier_screw_x + m.tap_drill / 2 + END_PLATE_WEB > layout.end_plate_half:
        yield wrong(
            "clamp.carrier_screw_offset",
            "carrier screw outside the end plate",
            offset,
            f"at most {most:g} mm",
        )


@rule(after="stack_can_be_clamped")
def tilt_covers_pads_and_dowels(layout: Layout) -> Iterator[Finding]:
    """The carrier is as square to the pads as pads and dowel holes leave it, rows apart as they are."""
    d = layout.design
    play = d.holes.dowel_hole + d.holes.dowel_hole_upper / 2 - dowel_diameter(d.clamp.dowel)
    high = max(0.0, d.tolerance.pad_height - play / 2)
    spans = [2 * min(layout.dowel_x)] if len(d.array.row_arms) > 1 else []
    spans += [(layout.positions - 1) * d.array.pitch] if layout.positions > 1 else []
    off = [high / span for span in spans]
    least = ceil(1e3 * degrees(hypot(HOLES / 2 / min(layout.dowel_x), max(off, default=0.0)))) / 1e3
    yield from at_least(
        "tolerance.tilt",
        "less than dowel holes and pads leave over the distance of the rows",
        d.tolerance.tilt,
        least,
        f"at least {least:g} degrees",
    )
