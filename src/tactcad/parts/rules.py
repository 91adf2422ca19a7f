"""Rules between fields of a design: each named, each with the field to look at and what is legal.

A field's own range is tried when the file is read; these are tried after, all of them, in this order.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import combinations, product
from math import cos, hypot, pi, sqrt

from tactcad.design.messages import InputError
from tactcad.design.tree import Design

from .broken import Broken
from .fasteners import LEAST_GRIP, carrier_screw, clamping, thinnest_carrier
from .layout import (
    BESIDE_SET_SCREW,
    CARRIER_EDGE,
    END_PLATE_WEB,
    HOLE_WEB,
    LEAST_GAP,
    SUNK,
    ElementPlace,
    Layout,
)
from .library.dowels import largest_dowel
from .library.screws import (
    DRILL_REACH,
    METRIC,
    SET_SCREW_LENGTHS,
    SOCKET_WALL,
    TAP_REACH,
    counterbore_diameter,
    engagement,
)
from .rigs.rules import RIG_RULES
from .room_rules import (
    arms_clear_neighbours,
    gauge_fits_width,
    land_stands_over_arm,
    leads_have_room,
    pressed_arms_clear_opposite_row,
    slots_stay_open,
)
from .slivers import no_slivers
from .stop_gap import land_room, stop_gap, stop_limit
from .stop_rules import gaps_name_an_arm, stop_plate_stays

# Below this, two lengths written in decimals are the same length (mm).
SAME = 1e-9
# Tie rod and ground rod are sold in bars of up to 3 m (DIN 976-1: 1, 2 and 3 m).
LONGEST_ROD = 3000.0


Finding = tuple[str, str, object, str]
Rule = Callable[[Layout], Iterator[Finding]]


def broken_rules(design: Design) -> list[Broken]:
    """Every rule that the design breaks, the first finding of each, in the order of RULES, then the rigs' own."""
    layout = Layout(design)
    found = []
    for name, rule in (RULES | RIG_RULES).items():
        if name in ASK_THE_GAP and any(b.rule in NO_GAP for b in found):
            continue
        if name in ASK_THE_CONTOUR and found:
            continue  # there may be none
        for path, what, value, legal in rule(layout):
            found.append(Broken(name, path, what, value, legal))
            break
        if found and name in STOP_AFTER:
            break  # what follows would only repeat it, or could not be computed
    return found


def refuse_broken(design: Design) -> None:
    """Raise InputError for the first rule that the design breaks, naming the others."""
    found = broken_rules(design)
    if found:
        first = found[0]
        others = f" (and {', '.join(b.rule for b in found[1:])})" if found[1:] else ""
        raise InputError(
            first.path, f"rule {first.rule}{others}: {first.what}", value=first.value, legal=first.legal
        )


def _at(place: ElementPlace, field: str, layout: Layout) -> str:
    """Path of a hinge field of one element: its override where it has one."""
    own = layout.design.element.override.get(place.number)
    if own is not None and getattr(own, field) is not None:
        return f"element.override.{place.number}.{field}"
    return f"element.{field}"


def _arm_path(place: ElementPlace) -> str:
    return f"array.row_arms[{place.row - 1}][{place.index}]"


def override_names_element(layout: Layout) -> Iterator[Finding]:
    count = sum(len(arms) for arms in layout.design.array.row_arms)
    for number in layout.design.element.override:
        if not 1 <= number <= count:
            yield (f"element.override.{number}", "no element has this number", number, f"1 to {count}")


def pitch_is_sheet_and_spacer(layout: Layout) -> Iterator[Finding]:
    d = layout.design
    if layout.spacer < 0.05 - SAME:
        yield (
            "array.pitch",
            "leaves no room for a spacer beside the sheet",
            d.array.pitch,
            f"at least sheet.thickness + 0.05 = {d.sheet.thickness + 0.05:g} mm",
        )
    elif abs(d.sheet.thickness + layout.spacer - d.array.pitch) > SAME:
        yield (
            "array.spacer",
            "sheet and spacer do not make up the pitch",
            layout.spacer,
            f"array.pitch - sheet.thickness = {d.array.pitch - d.sheet.thickness:g} mm",
        )


def arms_clear_opposite_row(layout: Layout) -> Iterator[Finding]:
    d = layout.design
    least = d.element.pad_length + LEAST_GAP
    if d.array.row_pitch < least - SAME:
        yield (
            "array.row_pitch",
            "arms reach the opposite row",
            d.array.row_pitch,
            f"at least element.pad_length + {LEAST_GAP:g} = {least:g} mm",
        )


def hinge_thinner_than_arm(layout: Layout) -> Iterator[Finding]:
    sides = 1 if layout.design.element.sides == "one" else 2
    for p in layout.elements:
        room = p.hinge.h - p.hinge.t
        if room <= SAME:
            yield (
                _at(p, "hinge_thickness", layout),
                "hinge not thinner than the arm",
                p.hinge.t,
                f"less than arm_height = {p.hinge.h:g} mm",
            )
        elif room / sides < p.hinge.r - SAME:
            yield (
                _at(p, "fillet_radius", layout),
                "fillet larger than the slot is deep",
                p.hinge.r,
                f"at most {room / sides:g} mm, (arm_height - hinge_thickness)" + ("/2" if sides == 2 else ""),
            )


def fillets_fit_slot(layout: Layout) -> Iterator[Finding]:
    for p in layout.elements:
        if 2 * p.hinge.r > p.hinge.l + SAME:
            yield (
                _at(p, "fillet_radius", layout),
                "fillets do not fit the slot",
                p.hinge.r,
                f"at most hinge_length/2 = {p.hinge.l / 2:g} mm",
            )


def ledges_in_one_plane(layout: Layout) -> Iterator[Finding]:
    for p in layout.elements:
        if abs(layout.ledge_of(p.hinge) - layout.ledge) > SAME:
            yield (
                _at(p, "arm_height", layout),
                "two-sided elements of other arm height have their ledge in another plane",
                p.hinge.h,
                f"{layout.elements[0].hinge.h:g} mm, as element 1",
            )


def slot_clears_pad(layout: Layout) -> Iterator[Finding]:
    d = layout.design
    for p in layout.elements:
        need = d.element.pad_length + d.element.pad_root_radius + p.hinge.l / 2
        if p.arm < need - SAME:
            yield (
                _arm_path(p),
                "slot reaches into the pad",
                p.arm,
                f"at least pad_length + pad_root_radius + hinge_length/2 = {need:g} mm",
            )


def pad_root_fits_pad(layout: Layout) -> Iterator[Finding]:
    e = layout.design.element
    if e.pad_root_radius > e.pad_height + SAME:
        yield (
            "element.pad_root_radius",
            "larger than the pad is high",
            e.pad_root_radius,
            f"at most {e.pad_height:g} mm",
        )


def pad_stands_out_of_body(layout: Layout) -> Iterator[Finding]:
    """A two-sided body may be thicker than its arm; the pad must still be what meets the object."""
    e = layout.design.element
    for p in layout.elements:
        least = LEAST_GAP - layout.body_bottom(p.hinge)
        if e.pad_height < least - SAME:
            yield (
                "element.pad_height",
                f"body of element {p.number} meets the object before its pad",
                e.pad_height,
                f"at least {least:g} mm",
            )


def gauge_fits_face(layout: Layout) -> Iterator[Finding]:
    d = layout.design
    if d.element.sides == "two":
        for p in layout.elements:
            if d.gauge.grid_length > p.hinge.l + SAME:
                yield (
                    "gauge.grid_length",
                    "longer than the slot it is bonded in",
                    d.gauge.grid_length,
                    f"at most {p.hinge.l:g} mm",
                )
        return
    for p in layout.elements:
        flat = p.arm - d.element.pad_length - d.element.pad_root_radius
        if d.gauge.carrier_arm_side > flat + SAME:
            yield (
                "gauge.carrier_arm_side",
                f"carrier reaches the pad of element {p.number}",
                d.gauge.carrier_arm_side,
                f"at most {flat:g} mm there",
            )
        behind = layout.recess_start - p.hinge_x
        if d.gauge.carrier_body_side > behind + SAME:
            yield (
                "gauge.carrier_body_side",
                f"carrier reaches the wire recess behind element {p.number}",
                d.gauge.carrier_body_side,
                f"at most {behind:g} mm there",
            )


def stop_land_above_arm(layout: Layout) -> Iterator[Finding]:
    d = layout.design
    for p in layout.elements:
        room = land_room(layout, p.hinge)
        given = d.stop.gaps.get(p.arm) if d.stop.gaps else None
        if given is not None and given > room + SAME:
            yield (
                f"stop.gaps.{p.arm:g}",
                f"leaves element {p.number} no stop land over the arm",
                given,
                f"at most {room:.4g} mm",
            )
        elif room < d.stop.tolerance - SAME:
            yield (
                "element.body_height",
                f"leaves element {p.number} no stop land over the arm",
                d.element.body_height,
                f"at least {d.element.body_height + d.stop.tolerance - room:.4g} mm",
            )


def stop_keeps_rated_deflection(layout: Layout) -> Iterator[Finding]:
    """A gap that the design gives is no wider than the hinge bears; a derived one is made so."""
    stop = layout.design.stop
    for p in layout.elements:
        given = stop.gaps.get(p.arm) if stop.gaps else None
        widest = stop_limit(layout, p).gap - stop.tolerance
        if given is not None and given > widest + SAME:
            yield (
                f"stop.gaps.{p.arm:g}",
                f"lets the hinge of element {p.number} pass its rated deflection under "
                f"{layout.design.rating.overload_force:g} N",
                given,
                f"at most {widest:.4g} mm" if widest > stop.tolerance else "leave it out, to have it derived",
            )


def stop_gap_above_tolerance(layout: Layout) -> Iterator[Finding]:
    """The arm moves before its stop closes; what leaves it no gap is the overload or the tolerance."""
    d = layout.design
    for p in layout.elements:
        gap, limit = stop_gap(layout, p), stop_limit(layout, p)
        if gap > d.stop.tolerance + SAME:
            continue
        if not (d.stop.gaps and p.arm in d.stop.gaps) and 0 < limit.overload < d.rating.overload_force:
            yield (
                "rating.overload_force",
                f"no stop keeps the hinge of element {p.number} within its rated deflection",
                d.rating.overload_force,
                f"at most {limit.overload:.4g} N",
            )
        else:
            yield (
                "stop.tolerance",
                f"the stop of element {p.number} may close before it moves: its gap is {gap:g} mm",
                d.stop.tolerance,
                f"less than {gap:g} mm" if gap > 0 else "less, or a softer hinge",
            )


def stop_land_fits_arm(layout: Layout) -> Iterator[Finding]:
    d = layout.design
    for p in layout.elements:
        ramp = layout.ledge_of(p.hinge) - stop_gap(layout, p) - p.hinge.h
        foot = d.element.corner_radius * 0.4142135623730951
        need = d.stop.land_length + ramp + foot + p.hinge.l / 2
        if p.arm < need - SAME:
            yield (
                "stop.land_length",
                f"land and its ramp reach the slot of element {p.number}",
                d.stop.land_length,
                f"at most {d.stop.land_length - (need - p.arm):.4g} mm",
            )


def ledge_below_rear(layout: Layout) -> Iterator[Finding]:
    d = layout.design
    need = layout.ledge + 2 * d.element.corner_radius
    if d.element.rear_height < need - SAME:
        yield (
            "element.rear_height",
            "rear body not higher than the ledge",
            d.element.rear_height,
            f"at least {need:g} mm",
        )
    seat = d.element.seat_length
    least = d.element.corner_radius + d.clamp.stop_plate_gap + LEAST_SEAT
    if seat < least - SAME:
        yield (
            "element.seat_length",
            "too short for the stop plate's seat",
            seat,
            f"at least corner_radius + clamp.stop_plate_gap + {LEAST_SEAT:g} = {least:g} mm",
        )
    if d.clamp.stop_plate_gap < d.element.corner_radius - SAME:
        yield (
            "clamp.stop_plate_gap",
            "stop plate would sit on the ledge's root fillet",
            d.clamp.stop_plate_gap,
            f"at least element.corner_radius = {d.element.corner_radius:g} mm",
        )


# Least contact of stop plate and shortest ledge along the arm, mm; chosen: it carries the set screw's
# push without lifting, and is the least that a 0.15 mm misplaced plate still finds.
LEAST_SEAT = 0.5


def recess_fits_rear(layout: Layout) -> Iterator[Finding]:
    d = layout.design
    low = max((layout.body_bottom(p.hinge) for p in layout.elements), default=0.0)
    if d.element.recess_depth < low + d.element.corner_radius - SAME:
        yield (
            "element.recess_depth",
            "shallower than its own root fillet",
            d.element.recess_depth,
            f"at least {low + d.element.corner_radius:g} mm",
        )
    if d.element.recess_offset + d.element.corner_radius > d.element.rear_length - SAME:
        yield (
            "element.recess_offset",
            "starts behind the rear end",
            d.element.recess_offset,
            f"less than rear_length - corner_radius = {d.element.rear_length - d.element.corner_radius:g} mm",
        )
    over = max(layout.ledge - d.element.recess_depth, 0.0)
    neck = hypot(
        d.element.recess_offset, over
    )  # from the ledge's corner to the recess's, both without their fillets
    if neck < d.holes.web - SAME:
        yield (
            "element.recess_offset",
            f"only {neck:g} mm between the recess and the ledge over it",
            d.element.recess_offset,
            f"at least {sqrt(d.holes.web**2 - over**2):.4g} mm for holes.web = {d.holes.web:g} mm",
        )
    if layout.design.clamp.spacer_bottom < d.element.recess_depth - SAME:
        yield (
            "clamp.spacer_bottom",
            "spacers close the wire recess",
            d.clamp.spacer_bottom,
            f"at least element.recess_depth = {d.element.recess_depth:g} mm",
        )


def holes_inside_body(layout: Layout) -> Iterator[Finding]:
    """Around every hole at least holes.web of element, spacer and end plate."""
    d, h = layout.design, layout.design.holes
    screw, dowel = METRIC[d.clamp.screw].clearance, h.dowel_hole + h.dowel_hole_upper
    low = max(d.element.recess_depth, layout.spacer_z[0])
    high = min(d.element.rear_height, layout.spacer_z[1])
    widest = max(screw, dowel)
    if low + 2 * h.web + widest > high + SAME:
        yield (
            "element.rear_height",
            "rear body too low for its holes",
            d.element.rear_height,
            f"at least {d.element.rear_height + low + 2 * h.web + widest - high:g} mm",
        )
    elif not low + h.web + widest / 2 - SAME <= h.height <= high - h.web - widest / 2 + SAME:
        yield (
            "holes.height",
            "holes too near the edge of the rear body or its spacer",
            h.height,
            f"from {low + h.web + widest / 2:g} to {high - h.web - widest / 2:g} mm",
        )
    pin = largest_dowel(d.clamp.dowel)
    if h.dowel_hole < pin - SAME:
        yield ("holes.dowel_hole", "smaller than the dowel may be (m6)", h.dowel_hole, f"at least {pin:g} mm")
    elif h.dowel_hole > float(d.clamp.dowel) + 0.1:
        yield (
            "holes.dowel_hole",
            "does not locate on the dowel",
            h.dowel_hole,
            f"at most {float(d.clamp.dowel) + 0.1:g} mm",
        )
    holes = [("holes.screw_offsets", x, screw) for x in h.screw_offsets]
    holes += [("holes.dowel_offsets", x, dowel) for x in h.dowel_offsets]
    for path, x, diameter in holes:
        low, high = h.web + diameter / 2, d.element.rear_length - h.web - diameter / 2
        if not low - SAME <= x <= high + SAME:
            yield (
                path,
                "hole outside the rear body",
                x,
                f"from {low:g} to {high:g} mm behind the clamp edge",
            )
    for (path, x0, d0), (_, x1, d1) in combinations(holes, 2):
        if abs(x1 - x0) < (d0 + d1) / 2 + h.web - SAME:
            yield (
                path,
                f"holes at {x0:g} and {x1:g} mm leave too thin a web",
                abs(x1 - x0),
                f"at least {(d0 + d1) / 2 + h.web:g} mm apart",
            )


def end_plate_takes_holes(layout: Layout) -> Iterator[Finding]:
    d, c = layout.design, layout.design.clamp
    z0, z1 = layout.end_plate_z
    m = METRIC[c.screw]
    rod = clamping(layout).rod
    # a counterbore needs material around it; a nut only has to lie on the plate
    around = (m.nut / cos(pi / 6) if rod else counterbore_diameter(c.screw)) / 2
    web = LEAST_GAP if rod else END_PLATE_WEB
    below = max(around + web, float(c.dowel) / 2 + END_PLATE_WEB)
    if d.holes.height - below - z0 < -SAME:
        yield (
            "clamp.end_plate_bottom",
            "end plate ends in screw heads or dowels",
            z0,
            f"at most {d.holes.height - below:g} mm",
        )
    top = max(layout.lowest_carrier, layout.stop_plate_top + LEAST_GAP)
    if z1 < top - SAME and layout.hold_down.length is not None:
        yield (
            "clamp.end_plate_height",
            "carrier too low over rear bodies and clamping screws",
            z1 - z0,
            f"at least {top - z0:g} mm",
        )
    rear = layout.rear_end - max(layout.screw_x)
    if rear + c.end_plate_margin < around + web - SAME:
        yield (
            "clamp.end_plate_margin",
            "end plate ends in the screw heads",
            c.end_plate_margin,
            f"at least {around + web - rear:g} mm",
        )
    spots = [(x, around, True) for x in layout.screw_x] + [
        (x, float(c.dowel) / 2, False) for x in layout.dowel_x
    ]
    beside = SOCKET_WALL if rod else 0.0  # a socket goes over a nut beside the next one; dowels end flush
    between = LEAST_GAP if rod else HOLE_WEB
    for (x0, r0, turned), (x1, r1, other) in combinations(spots, 2):
        least = r0 + r1 + between + (beside if turned and other else 0.0)
        if abs(x0 - x1) < least - SAME:
            yield (
                "holes.screw_offsets",
                "screw heads or nuts too near each other or a dowel",
                abs(x0 - x1),
                f"at least {least:g} mm apart",
            )
    first, least = min(x - r for x, r, _ in spots), LEAST_GAP + beside / 2
    if first < least - SAME:
        yield (
            "holes.screw_offsets",
            "heads of both rows meet",
            first,
            f"at least {least:g} mm from the middle line",
        )
    reach = DRILL_REACH * min(m.clearance if rod else m.tap_drill, float(c.dowel))
    if c.end_plate_thickness > reach + SAME:
        yield (
            "clamp.end_plate_thickness",
            "too thick for the drills of its holes",
            c.end_plate_thickness,
            f"at most {reach:g} mm",
        )
    if c.end_plate_thickness / 2 - m.tap_drill / 2 < END_PLATE_WEB:
        yield (
            "clamp.end_plate_thickness",
            "too thin for the carrier's threads",
            c.end_plate_thickness,
            f"at least {2 * END_PLATE_WEB + m.tap_drill:g} mm",
        )


def stack_can_be_clamped(layout: Layout) -> Iterator[Finding]:
    d = layout.design
    c = clamping(layout)
    if max(c.screw, c.dowel) > LONGEST_ROD:
        yield (
            "array.row_arms",
            "stack longer than any tie rod",
            layout.stack,
            f"at most about {LONGEST_ROD:g} mm",
        )
    if c.dowel < layout.stack + 2 * LEAST_GRIP - SAME:
        yield (
            "clamp.end_plate_thickness",
            "no dowel grips both end plates",
            d.clamp.end_plate_thickness,
            f"at least {LEAST_GRIP:g} mm",
        )


def carrier_can_be_screwed(layout: Layout) -> Iterator[Finding]:
    c = layout.design.clamp
    if carrier_screw(layout) is None:
        yield (
            "clamp.carrier_thickness",
            f"no standard {c.screw} screw sinks its head and engages the end plate",
            c.carrier_thickness,
            f"at least {thinnest_carrier(c.screw):g} mm",
        )
    least = engagement(c.mount_thread)
    if c.carrier_thickness < least - SAME:
        yield (
            "clamp.carrier_thickness",
            f"too thin for the axis's {c.mount_thread} threads",
            c.carrier_thickness,
            f"at least {least:g} mm",
        )
    most = TAP_REACH * METRIC[c.screw].d
    if c.carrier_thickness > most + SAME:
        yield (
            "clamp.carrier_thickness",
            f"too thick to be tapped through for {c.screw} set screws",
            c.carrier_thickness,
            f"at most {most:g} mm",
        )


def stop_plate_can_be_held(layout: Layout) -> Iterator[Finding]:
    d, c = layout.design, layout.design.clamp
    hold = layout.hold_down
    gap = layout.carrier_bottom - layout.stop_plate_top
    if hold.length is None:
        short = hold.reach - (SET_SCREW_LENGTHS[c.screw][-1] - c.carrier_thickness + SUNK)
        yield (
            "clamp.stop_plate_thickness",
            f"no standard {c.screw} set screw reaches from the carrier to the stop plate",
            c.stop_plate_thickness,
            f"at least {c.stop_plate_thickness + short:.4g} mm, or a larger screw",
        )
    elif c.carrier_thickness - SUNK < engagement(c.screw) - SAME:
        yield (
            "clamp.carrier_thickness",
            f"too thin for the threads of {c.screw} set screws",
            c.carrier_thickness,
            f"at least {engagement(c.screw) + SUNK:g} mm",
        )
    elif not engagement(c.screw) - SAME <= hold.length - gap <= c.carrier_thickness + SAME:
        yield (
            "clamp.end_plate_height",
            f"the {hold.length:g} mm set screw does not engage the carrier as it should",
            c.end_plate_height,
            "leave it out, to have it derived",
        )
    widest = min(
        BESIDE_SET_SCREW + (METRIC[c.screw].d - METRIC[c.screw].set_point) / 2,
        layout.spacer + d.sheet.thickness / 2,
    )
    if c.stop_plate_gap > widest + SAME:
        yield (
            "clamp.stop_plate_gap",
            "stop plate ends before the set screws, or before the outermost ledge",
            c.stop_plate_gap,
            f"at most {widest:g} mm",
        )
    if layout.stack < METRIC[c.screw].d + 2 * BESIDE_SET_SCREW - SAME:
        yield (
            "clamp.screw",
            f"no room for an {c.screw} set screw between the end plates",
            layout.stack,
            f"a stack of at least {METRIC[c.screw].d + 2 * BESIDE_SET_SCREW:g} mm",
        )
    needed = layout.clamp_edge - layout.hold_down_x
    if d.element.seat_length < needed - SAME:
        yield (
            "element.seat_length",
            "the set screws press beside the ledge of the longest arm",
            d.element.seat_length,
            f"at least {needed:g} mm",
        )
    if layout.stop_plate_width < 1.0:
        yield (
            "clamp.stop_plate_gap",
            "leaves no stop plate between the end plates",
            c.stop_plate_gap,
            f"less than {(layout.stack - 1) / 2:g} mm",
        )


def carrier_holes_apart(layout: Layout) -> Iterator[Finding]:
    """Screw heads, axis threads and set screws in the carrier leave HOLE_WEB between them, CARRIER_EDGE around."""
    c, seat = layout.design.clamp, layout.design.element.seat_length
    spots = [
        (
            "clamp.carrier_screw_offset",
            c.carrier_screw_offset,
            layout.carrier_screw_x,
            layout.end_plate_y,
            counterbore_diameter(c.screw) / 2,
        ),
        (
            "clamp.mount_pitch_y",
            c.mount_pitch_y,
            layout.mount_x,
            c.mount_pitch_y / 2,
            METRIC[c.mount_thread].d / 2,
        ),
    ]
    spots += [
        ("element.seat_length", seat, layout.hold_down_x, y, METRIC[c.screw].d / 2)
        for y in layout.hold_down_y
    ]
    # one quadrant against all four: rows and ends are each other's mirror images
    for (i, a), (j, b), sx, sy in product(enumerate(spots), enumerate(spots), (1, -1), (1, -1)):
        if j < i or (a[2], a[3]) == (sx * b[2], sy * b[3]):
            continue
        apart, least = hypot(a[2] - sx * b[2], a[3] - sy * b[3]), a[4] + b[4] + HOLE_WEB
        if apart < least - SAME:
            path, value = (a if b[0] == "element.seat_length" else b)[:2]
            yield (
                path,
                f"holes of the carrier {apart:.3g} mm apart",
                value,
                f"at least {least:.3g} mm apart",
            )
    half = layout.carrier_size[0] / 2
    for path, value, x, _, r in spots:
        if x + r + CARRIER_EDGE > half + SAME:
            yield (
                path,
                f"hole at the carrier's edge, {x:g} mm from the middle",
                value,
                f"at most {half - r - CARRIER_EDGE:g} mm from the middle",
            )
    if layout.carrier_screw_x + METRIC[c.screw].tap_drill / 2 + END_PLATE_WEB > layout.end_plate_half:
        yield (
            "clamp.carrier_screw_offset",
            "carrier screw outside the end plate",
            c.carrier_screw_offset,
            f"at most {layout.end_plate_half - layout.clamp_edge - METRIC[c.screw].tap_drill / 2 - END_PLATE_WEB:g} mm",
        )


RULES: dict[str, Rule] = {
    rule.__name__: rule
    for rule in (
        override_names_element,
        gaps_name_an_arm,
        pitch_is_sheet_and_spacer,
        arms_clear_opposite_row,
        hinge_thinner_than_arm,
        fillets_fit_slot,
        ledges_in_one_plane,
        slot_clears_pad,
        pad_root_fits_pad,
        pad_stands_out_of_body,
        gauge_fits_face,
        gauge_fits_width,
        arms_clear_neighbours,
        leads_have_room,
        ledge_below_rear,
        recess_fits_rear,
        stop_land_above_arm,
        stop_plate_stays,
        stop_keeps_rated_deflection,
        stop_gap_above_tolerance,
        stop_land_fits_arm,
        holes_inside_body,
        stack_can_be_clamped,
        end_plate_takes_holes,
        carrier_can_be_screwed,
        stop_plate_can_be_held,
        carrier_holes_apart,
        land_stands_over_arm,
        slots_stay_open,
        pressed_arms_clear_opposite_row,
        no_slivers,
    )
}
# Rules whose breach would make later ones fail for the same reason.
STOP_AFTER = frozenset({"override_names_element", "stop_land_above_arm", "stop_plate_stays"})
# Rules that need the stop gap or the stiffness, and those without which there is none: what is no hinge has no stiffness.
ASK_THE_GAP = frozenset(
    {
        "stop_plate_stays",
        "stop_keeps_rated_deflection",
        "stop_gap_above_tolerance",
        "stop_land_fits_arm",
        "land_stands_over_arm",
        "calibration_bends_elastically",
        "roller_stays_on_pad",
    }
)
NO_GAP = frozenset({"hinge_thinner_than_arm", "fillets_fit_slot", "slot_clears_pad"})
# Rules on contours as drawn and turned, which only a design that keeps the rules before them is sure to have.
ASK_THE_CONTOUR = frozenset({"slots_stay_open", "pressed_arms_clear_opposite_row", "no_slivers"})
