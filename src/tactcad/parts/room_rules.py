"""Rules on the room that pressed arms, gauges and their leads have."""

from __future__ import annotations

from collections.abc import Iterator
from math import asin, cos, floor, sin

from .layout import LEAST_GAP, ElementPlace, Layout
from .plates import SPACER_TOLERANCE
from .rigs.calibration_loads import calibration_loads
from .rigs.rules import misfit
from .stop_gap import stop_gap

Finding = tuple[str, str, object, str]
SAME = 1e-9

# A lead is AWG 36 (0.127 mm, ASTM B258) with 0.06 mm of insulation around it: 0.25 mm; chosen: three a gauge, so that
# the leads' own resistance cancels in the bridge.
LEAD, LEADS = 0.25, 3


def turns(layout: Layout) -> list[float]:
    """Angle by which each arm turns at most, by number: onto its stop at its gap and tolerance, and with
    the stop plate as far as that gives way; in the calibration, which has none, by what its travel gives."""
    design = layout.design
    calibrated = design.calibration is not None and misfit(layout, "calibration") is None
    loads = calibration_loads(design) if calibrated else ()
    force, give = design.rating.overload_force, layout.stop_give
    tips = [
        stop_gap(layout, p) + design.stop.tolerance + give * force * p.load_arm / p.arm
        for p in layout.elements
    ]
    for n, load in enumerate(loads):
        pad = design.calibration.travel if load.refused else load.deflection
        tips[n] = max(tips[n], pad * load.place.arm / load.place.load_arm)
    return [asin(min(1.0, tip / p.arm)) for tip, p in zip(tips, layout.elements)]


def hinge_centre(layout: Layout, place: ElementPlace) -> float:
    """z about which the arm turns: the middle of its hinge."""
    return place.hinge.h / 2 if layout.design.element.sides == "two" else place.hinge.t / 2


def neighbours_take(layout: Layout) -> float:
    """By how much tolerances bring an arm nearer to what stands a spacer beside it (mm): half of both sheets', and the
    spacer's own."""
    return layout.design.tolerance.sheet_thickness + SPACER_TOLERANCE


def arms_clear_neighbours(layout: Layout) -> Iterator[Finding]:
    least = max(LEAST_ARM_GAP, neighbours_take(layout) + LEAST_BESIDE)
    if layout.spacer < least - SAME:
        yield (
            "array.spacer",
            "arms too near their neighbours and the end plates to move freely",
            layout.spacer,
            f"at least {LEAST_ARM_GAP:g} mm, and tolerance.sheet_thickness + {SPACER_TOLERANCE + LEAST_BESIDE:g} = "
            f"{neighbours_take(layout) + LEAST_BESIDE:g} mm",
        )


# Neighbouring arms, and arm and end plate, stand a spacer apart; chosen: a thin gauge wire must not jam. Air that stays
# where all tolerances add up, mm; chosen: burrs of the wire are smaller.
LEAST_ARM_GAP = 0.1
LEAST_BESIDE = 0.02


def land_stands_over_arm(layout: Layout) -> Iterator[Finding]:
    """On the closed stop the arm's back is a land's height under the stop plate, which its tolerance may take."""
    d = layout.design
    for p in layout.elements:
        high = layout.ledge_of(p.hinge) - stop_gap(layout, p) - p.hinge.h
        if high <= d.tolerance.arm_height + SAME:
            yield (
                "tolerance.arm_height",
                f"as much as the stop land of element {p.number} stands over its arm",
                d.tolerance.arm_height,
                f"less than {high:.4g} mm",
            )


def slots_stay_open(layout: Layout) -> Iterator[Finding]:
    """The upper corner of the slot's arm wall, (-l/2, h - z) from the hinge's middle, turns towards the body's wall."""
    limit = layout.design.tolerance.hinge_length
    for p, w in _kinds(layout).values():
        high = p.hinge.h - hinge_centre(layout, p)
        left = p.hinge.l / 2 * (1 + cos(w)) - high * sin(w)
        if left <= limit + SAME:
            least = (limit + high * sin(w)) * 2 / (1 + cos(w))
            yield (
                "element.hinge_length",
                f"the slot of element {p.number} closes before its arm has turned as far as it may",
                p.hinge.l,
                f"more than {least:.4g} mm, or a narrower stop gap",
            )


def pressed_arms_clear_opposite_row(layout: Layout) -> Iterator[Finding]:
    """A pad's inner corner, (-a, -(pad height + z)) from the hinge's middle, turns towards the facing pad's."""
    d = layout.design
    towards: dict[int, float] = {}
    for p, w in zip(layout.elements, turns(layout)):
        low = d.element.pad_height + hinge_centre(layout, p)
        towards[p.index] = towards.get(p.index, 0.0) + max(0.0, low * sin(w) - p.arm * (1 - cos(w)))
    facing = (
        [towards[i] for i in range(min(map(len, d.array.row_arms)))] if len(d.array.row_arms) == 2 else [0.0]
    )
    least = d.element.pad_length + max(facing) + 2 * d.tolerance.load_arm
    if len(d.array.row_arms) == 2 and d.array.row_pitch <= least + SAME:
        yield (
            "array.row_pitch",
            "pressed arms may meet the opposite row's",
            d.array.row_pitch,
            f"more than pad_length + {max(facing):.3g} of turning + 2 tolerance.load_arm = {least:.4g} mm",
        )


def leads_have_room(layout: Layout) -> Iterator[Finding]:
    """Leads run in the wire recess, as wide as element and spacer; before it under the face, beside the gauge."""
    d, e = layout.design, layout.design.element
    if leads_that_fit(layout) < LEADS:
        yield (
            "element.recess_depth",
            f"{LEADS} leads of {LEAD:g} mm do not fit into the wire recess of {d.array.pitch:g} mm width",
            e.recess_depth,
            f"at least {LEAD * -(-LEADS // max(1, floor(d.array.pitch / LEAD + SAME))):g} mm, and a pitch of {LEAD:g} mm or more",
        )
    out, room = gauge_stands_out(layout), gauge_room(layout)
    if LEAST_GAP - SAME <= room < out - SAME:  # still less is another rule's
        yield (
            "element.pad_height",
            "the object would touch gauge and leads before the pad",
            e.pad_height,
            f"at least {e.pad_height + out - room:g} mm",
        )


def leads_that_fit(layout: Layout) -> int:
    """How many leads lie in the recess of one element."""
    return floor(layout.design.array.pitch / LEAD + SAME) * floor(
        layout.design.element.recess_depth / LEAD + SAME
    )


def gauge_stands_out(layout: Layout) -> float:
    """How far gauge and leads stand out of the faces that they lie on, mm."""
    gauge = layout.design.gauge
    return LEAD + gauge.grid_height if layout.design.element.sides == "one" else LEAD


def gauge_room(layout: Layout) -> float:
    """From these faces to the pads' plane, mm: a two-sided body's lower face is nearer to it."""
    return layout.design.element.pad_height + min(layout.body_bottom(p.hinge) for p in layout.elements)


def gauge_fits_width(layout: Layout) -> Iterator[Finding]:
    g, sheet = layout.design.gauge, layout.design.sheet.thickness
    if g.carrier_width > sheet + SAME:
        yield (
            "gauge.carrier_width",
            "wider than the element",
            g.carrier_width,
            f"at most sheet.thickness = {sheet:g} mm",
        )
    if g.grid_width > g.carrier_width + SAME:
        yield ("gauge.grid_width", "wider than its carrier", g.grid_width, f"at most {g.carrier_width:g} mm")
    side = min(g.carrier_arm_side, g.carrier_body_side)
    if g.grid_length / 2 > side + SAME and layout.design.element.sides == "one":
        yield ("gauge.grid_length", "longer than its carrier", g.grid_length, f"at most {2 * side:g} mm")


def _kinds(layout: Layout) -> dict[tuple, tuple[ElementPlace, float]]:
    """One element of each kind, and how far it turns."""
    return {(p.arm, p.hinge): (p, w) for p, w in zip(layout.elements, turns(layout))}
