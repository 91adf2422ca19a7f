"""Rules on pressed arms, and on the final contour, which the rules before these make possible."""

from __future__ import annotations

from collections.abc import Iterator
from math import asin, cos, sin

from tactcad.contour import LEAST_EDGE, is_sliver

from ..array.element import outline
from ..array.layout import ElementPlace, Layout
from ..array.stop_gap import seat, stop_gap
from ..language.finding import SAME, Finding
from ..rigs.stiffness import calibration_loads
from .calibration_rules import FITS as CALIBRATION_FITS
from .rule import misfit, rule, wrong


def turns(layout: Layout) -> list[float]:
    """Largest angle by which each arm turns, by number.

    Onto its stop, at the stop's gap, tolerance and compliance; in the calibration, which has no stop plate,
    by the deflection at the end of its travel.
    """
    design = layout.design
    gives = layout.stop_give * design.rating.overload_force
    wider = design.stop.tolerance + seat(layout)
    tips = [stop_gap(layout, p) + wider + gives * p.load_arm / p.arm for p in layout.elements]
    if design.calibration is not None and misfit(layout, CALIBRATION_FITS) is None:
        for n, load in enumerate(calibration_loads(design)):
            pad = design.calibration.travel if load.refused else load.deflection
            tips[n] = max(tips[n], pad * load.place.arm / load.place.load_arm)
    return [asin(min(1.0, tip / p.arm)) for tip, p in zip(tips, layout.elements)]


def hinge_centre(layout: Layout, place: ElementPlace) -> float:
    """z about which the arm turns: the middle of its hinge."""
    return place.hinge.h / 2 if layout.design.element.sides == "two" else place.hinge.t / 2


@rule(after="stop_land_above_arm")
def land_stands_over_arm(layout: Layout) -> Iterator[Finding]:
    """On the closed stop the arm's back stays a land's height, less its tolerance, under the stop plate."""
    taken = layout.design.tolerance.arm_height
    for p in layout.elements:
        high = layout.ledge_of(p.hinge) - stop_gap(layout, p) - p.hinge.h
        if high <= taken + SAME:
            yield wrong(
                "tolerance.arm_height",
                f"as large as the height of element {p.number}'s stop land over its arm",
                taken,
                f"less than {high:.4g} mm",
            )


@rule(after="land_stands_over_arm")
def slots_stay_open(layout: Layout) -> Iterator[Finding]:
    """The upper corner of the slot's arm wall, (-l/2, h - z) from the hinge's middle, turns towards the
    body's wall."""
    limit = layout.design.tolerance.hinge_length
    kinds = {(p.arm, p.hinge): (p, w) for p, w in zip(layout.elements, turns(layout))}
    for p, w in kinds.values():
        high = p.hinge.h - hinge_centre(layout, p)
        left = p.hinge.l / 2 * (1 + cos(w)) - high * sin(w)
        if left <= limit + SAME:
            least = (limit + high * sin(w)) * 2 / (1 + cos(w))
            yield wrong(
                "element.hinge_length",
                f"the slot of element {p.number} closes before its arm has reached its largest turn",
                p.hinge.l,
                f"more than {least:.4g} mm, or a narrower stop gap",
            )


@rule(after="slots_stay_open")
def pressed_arms_clear_opposite_row(layout: Layout) -> Iterator[Finding]:
    """A pad's inner corner, (-a, -(pad height + z)) from the hinge's middle, turns towards the facing
    pad's."""
    d = layout.design
    towards: dict[int, float] = {}
    for p, w in zip(layout.elements, turns(layout)):
        low = d.element.pad_height + hinge_centre(layout, p)
        towards[p.index] = towards.get(p.index, 0.0) + max(0.0, low * sin(w) - p.arm * (1 - cos(w)))
    if len(d.array.row_arms) < 2:
        return
    most = max(towards[i] for i in range(min(map(len, d.array.row_arms))))
    least = d.element.pad_length + most + 2 * d.tolerance.load_arm
    if d.array.row_pitch <= least + SAME:
        yield wrong(
            "array.row_pitch",
            "pressed arms may meet the opposite row's",
            d.array.row_pitch,
            f"more than pad_length + {most:.3g} of turning + 2 tolerance.load_arm = {least:.4g} mm",
        )


# The field that makes a piece of the contour short; pieces not named here lie between holes.web and the
# body's
# heights.
_FIELD = {
    "pad_face": "element.pad_length",
    "pad_side": "element.pad_height",
    "flat_face": "array.row_arms",
    "hinge_face": "element.hinge_length",
    "slot_floor": "element.hinge_length",
    "slot_arm_wall": "element.arm_height",
    "slot_body_wall": "element.body_height",
    "front_slot_arm_wall": "element.arm_height",
    "front_slot_body_wall": "element.body_height",
    "arm_back": "array.row_arms",
    "land_ramp": "element.body_height",
    "stop_land": "stop.land_length",
    "tip": "element.body_height",
    "ledge": "element.seat_length",
    "clamp_edge": "element.rear_height",
    "body_face": "element.seat_length",
    "recess_wall": "element.recess_depth",
    "recess_face": "element.recess_offset",
    "rear_end": "element.rear_height",
    "rear_top": "element.rear_length",
}


@rule(after="pressed_arms_clear_opposite_row")
def no_slivers(layout: Layout) -> Iterator[Finding]:
    """Every piece of every element's contour is at least LEAST_EDGE long: neither wire nor kernel can make a
    shorter one.
    """
    seen = set()
    for p in layout.elements:
        gap = stop_gap(layout, p)
        if (p.arm, p.hinge, gap) in seen:
            continue
        seen.add((p.arm, p.hinge, gap))
        for s in outline(layout, p.arm, p.hinge, gap):
            if is_sliver(s.length):
                yield wrong(
                    _FIELD.get(s.name, "element.corner_radius"),
                    f"leaves {s.length:.3g} mm of {s.name or 'edge'} on element {p.number}",
                    round(s.length, 9),
                    f"at least {LEAST_EDGE:g} mm of it, or none",
                )
