"""Rules on the elements and their distances."""

from __future__ import annotations

from collections.abc import Iterator

from ..array.layout import LEAST_GAP, ElementPlace, Layout
from ..language.finding import SAME, Finding
from .rule import at_least, at_most, rule, wrong

# Of a hinge's thickness that its tolerance may take; chosen: its stiffness, which goes with t^3, is then
# still between 0.42 and 1.95 of the drawn one.
SHARE_OF_HINGE = 0.25


def at(place: ElementPlace, field: str, layout: Layout) -> str:
    """Path of a hinge field of one element: its override if it has one."""
    own = layout.design.element.override.get(place.number)
    if own is not None and getattr(own, field) is not None:
        return f"element.override.{place.number}.{field}"
    return f"element.{field}"


def arm_path(place: ElementPlace) -> str:
    """Path of one element's arm length."""
    return f"array.row_arms[{place.row - 1}][{place.index}]"


@rule()
def override_names_element(layout: Layout) -> Iterator[Finding]:
    count = sum(len(arms) for arms in layout.design.array.row_arms)
    for number in layout.design.element.override:
        if not 1 <= number <= count:
            yield wrong(f"element.override.{number}", "no element has this number", number, f"1 to {count}")


@rule(after="override_names_element")
def pitch_is_sheet_and_spacer(layout: Layout) -> Iterator[Finding]:
    d = layout.design
    if d.array.pitch - d.sheet.thickness < 0.05 - SAME or layout.spacer < 0.05 - SAME:
        least = d.sheet.thickness + max(layout.spacer, 0.05)
        and_spacer = "array.spacer" if layout.spacer >= 0.05 else "0.05"
        yield wrong(
            "array.pitch",
            "leaves no room for a spacer next to the sheet",
            d.array.pitch,
            f"at least sheet.thickness + {and_spacer} = {least:g} mm",
        )
    elif abs(d.sheet.thickness + layout.spacer - d.array.pitch) > SAME:
        yield wrong(
            "array.spacer",
            "sheet and spacer do not make up the pitch",
            layout.spacer,
            f"array.pitch - sheet.thickness = {d.array.pitch - d.sheet.thickness:g} mm",
        )


@rule(after="override_names_element")
def arms_clear_opposite_row(layout: Layout) -> Iterator[Finding]:
    d = layout.design
    least = d.element.pad_length + LEAST_GAP
    yield from at_least(
        "array.row_pitch",
        "arms reach the opposite row",
        d.array.row_pitch,
        least,
        f"at least element.pad_length + {LEAST_GAP:g} = {least:g} mm",
    )


@rule(after="override_names_element")
def hinge_thinner_than_arm(layout: Layout) -> Iterator[Finding]:
    sides = 1 if layout.design.element.sides == "one" else 2
    for p in layout.elements:
        room = p.hinge.h - p.hinge.t
        if room <= SAME:
            yield wrong(
                at(p, "hinge_thickness", layout),
                "hinge not thinner than the arm",
                p.hinge.t,
                f"less than arm_height = {p.hinge.h:g} mm",
            )
        yield from at_most(
            at(p, "fillet_radius", layout),
            "fillet larger than the slot is deep",
            p.hinge.r,
            room / sides,
            f"at most {room / sides:g} mm, (arm_height - hinge_thickness)" + ("/2" if sides == 2 else ""),
        )


@rule(after="hinge_thinner_than_arm")
def hinge_outlasts_its_tolerance(layout: Layout) -> Iterator[Finding]:
    """The thinnest hinge as made is still the hinge of the design."""
    thinnest = min(p.hinge.t for p in layout.elements)
    most = SHARE_OF_HINGE * thinnest
    yield from at_most(
        "tolerance.hinge_thickness",
        f"more than a quarter of the thinnest hinge, {thinnest:g} mm",
        layout.design.tolerance.hinge_thickness,
        most,
    )


@rule(after="override_names_element")
def fillets_fit_slot(layout: Layout) -> Iterator[Finding]:
    for p in layout.elements:
        most = p.hinge.l / 2
        yield from at_most(
            at(p, "fillet_radius", layout),
            "fillets do not fit the slot",
            p.hinge.r,
            most,
            f"at most hinge_length/2 = {most:g} mm",
        )


@rule(after="override_names_element")
def ledges_in_one_plane(layout: Layout) -> Iterator[Finding]:
    for p in layout.elements:
        if abs(layout.ledge_of(p.hinge) - layout.ledge) > SAME:
            yield wrong(
                at(p, "arm_height", layout),
                "two-sided elements of other arm height have their ledge in another plane",
                p.hinge.h,
                f"{layout.elements[0].hinge.h:g} mm, as element 1",
            )


@rule(after="override_names_element")
def slot_clears_pad(layout: Layout) -> Iterator[Finding]:
    e = layout.design.element
    for p in layout.elements:
        least = e.pad_length + e.pad_root_radius + p.hinge.l / 2
        legal = f"at least pad_length + pad_root_radius + hinge_length/2 = {least:g} mm"
        yield from at_least(arm_path(p), "slot reaches into the pad", p.arm, least, legal)


@rule(after="override_names_element")
def friction_leaves_the_arm_free(layout: Layout) -> Iterator[Finding]:
    """Friction mu F at the pad turns the arm back about its hinge with the lever H = pad_height + t/2; from
    mu H = L on it does so as strongly as the force F itself turns it with the load arm L."""
    d = layout.design
    for p in layout.elements:
        most = p.load_arm / (d.element.pad_height + p.hinge.t / 2)
        if d.rating.friction >= most - SAME:
            yield wrong(
                "rating.friction",
                f"locks the arm of element {p.number}: it does not give way",
                d.rating.friction,
                f"less than load arm/(pad_height + hinge_thickness/2) = {most:.4g}",
            )


@rule(after="override_names_element")
def pad_root_fits_pad(layout: Layout) -> Iterator[Finding]:
    e = layout.design.element
    yield from at_most(
        "element.pad_root_radius", "larger than the pad is high", e.pad_root_radius, e.pad_height
    )


@rule(after="override_names_element")
def pad_stands_out_of_body(layout: Layout) -> Iterator[Finding]:
    """A two-sided body may be thicker than its arm; the pad must still be what meets the object."""
    for p in layout.elements:
        yield from at_least(
            "element.pad_height",
            f"body of element {p.number} meets the object before its pad",
            layout.design.element.pad_height,
            LEAST_GAP - layout.body_bottom(p.hinge),
        )
