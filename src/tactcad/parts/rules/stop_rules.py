"""Rules on the ledge, the wire recess under it, and the overload stop."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import ceil, floor, hypot, pi, sqrt, tan
from operator import attrgetter

from tactcad.design.fields import spec_of, with_value
from tactcad.design.tree import Design, Stop, Tolerance

from ..array.clamp import STOP_PLATE_FLAT
from ..array.layout import ElementPlace, Layout
from ..array.stop_gap import land_room, seat, stop_gap, stop_limits
from ..array.stop_give import SHARE, shortest_pitch
from ..language.finding import SAME, Finding
from .rule import at_least, at_most, rule, wrong

# Least contact of stop plate and shortest ledge along the arm, mm; chosen: it carries the set screw's push
# without lifting, and a plate misplaced by 0.15 mm still has it.
LEAST_SEAT = 0.5
USUAL = {
    "stop.tolerance": Stop().tolerance,
    "tolerance.ledge": Tolerance().ledge,
    "tolerance.pad_height": Tolerance().pad_height,
}
TENTH = 1e-4  # mm: legal tolerances are stated to a tenth of a micrometre


@rule(after="override_names_element")
def ledge_below_rear(layout: Layout) -> Iterator[Finding]:
    e, gap = layout.design.element, layout.design.clamp.stop_plate_gap
    yield from at_least(
        "element.rear_height",
        "rear body not higher than the ledge",
        e.rear_height,
        layout.ledge + 2 * e.corner_radius,
    )
    least = e.corner_radius + gap + LEAST_SEAT
    yield from at_least(
        "element.seat_length",
        "too short for the stop plate's seat",
        e.seat_length,
        least,
        f"at least corner_radius + clamp.stop_plate_gap + {LEAST_SEAT:g} = {least:g} mm",
    )
    yield from at_least(
        "clamp.stop_plate_gap",
        "stop plate would sit on the ledge's root fillet",
        gap,
        e.corner_radius,
        f"at least element.corner_radius = {e.corner_radius:g} mm",
    )


@rule(after="override_names_element")
def recess_fits_rear(layout: Layout) -> Iterator[Finding]:
    e, web = layout.design.element, layout.design.holes.web
    low = max((layout.body_bottom(p.hinge) for p in layout.elements), default=0.0)
    yield from at_least(
        "element.recess_depth", "shallower than its own root fillet", e.recess_depth, low + e.corner_radius
    )
    last = e.rear_length - e.corner_radius
    yield from at_most(
        "element.recess_offset",
        "starts behind the rear end",
        e.recess_offset,
        last,
        f"less than rear_length - corner_radius = {last:g} mm",
    )
    over = max(layout.ledge - e.recess_depth, 0.0)
    # from the ledge's corner to the recess's, both without their fillets
    neck = hypot(e.recess_offset, over)
    if neck < web - SAME:
        yield wrong(
            "element.recess_offset",
            f"only {neck:g} mm between the recess and the ledge over it",
            e.recess_offset,
            f"at least {sqrt(web**2 - over**2):.4g} mm for holes.web = {web:g} mm",
        )
    yield from at_least(
        "clamp.spacer_bottom",
        "spacers close the wire recess",
        layout.design.clamp.spacer_bottom,
        e.recess_depth,
        f"at least element.recess_depth = {e.recess_depth:g} mm",
    )


@rule(after="override_names_element")
def gaps_name_an_arm(layout: Layout) -> Iterator[Finding]:
    arms = sorted({p.arm for p in layout.elements})
    for arm, gap in (layout.design.stop.gaps or {}).items():
        if arm not in arms:
            legal = f"a gap for arms of {', '.join(f'{a:g}' for a in arms)} mm"
            yield wrong(f"stop.gaps.{arm:g}", "no element has an arm of this length", gap, legal)


@rule(after="override_names_element")
def stop_land_above_arm(layout: Layout) -> Iterator[Finding]:
    d = layout.design
    for p in layout.elements:
        room = land_room(layout, p.hinge)
        what = f"leaves element {p.number} no stop land over the arm"
        given = d.stop.gaps.get(p.arm) if d.stop.gaps else None
        if given is not None and given > room + SAME:
            yield wrong(f"stop.gaps.{p.arm:g}", what, given, f"at most {room:.4g} mm")
        least = d.element.body_height + d.stop.tolerance - room
        yield from at_least(
            "element.body_height", what, d.element.body_height, least, f"at least {least:.4g} mm"
        )


@rule(after="stop_land_above_arm")
def stop_plate_stays(layout: Layout) -> Iterator[Finding]:
    """Under an arm pressed on it by the overload force the stop plate deflects by at most SHARE of the gap.

    The gap is taken for a rigid stop, so that the allowance does not depend on the plate.
    """
    d, give = layout.design, layout.stop_give
    for p, gap in zip(layout.elements, stop_limits(layout, give=0.0).gap.tolist()):
        force = d.rating.overload_force * p.load_arm / p.arm
        allowed = SHARE * gap / force
        if gap <= d.stop.tolerance or give <= allowed:
            continue  # if there is no gap, other rules say why
        what = (
            f"the stop plate gives way by {give * force:.3g} mm under element {p.number} and "
            f"{d.rating.overload_force:g} N, more than a tenth of its gap"
        )
        yield _what_helps(layout, what, allowed)
        return


def _what_helps(layout: Layout, what: str, allowed: float) -> Finding:
    """The field that brings the plate's compliance (mm/N) down to its limit: the pitch if it is given and
    suffices, else a thicker plate, else less force.
    """
    d, c = layout.design, layout.design.clamp
    if c.hold_down_pitch is not None:
        pitch = _largest_pitch(layout, allowed)
        if pitch is not None:
            return wrong("clamp.hold_down_pitch", what, c.hold_down_pitch, f"at most {pitch:g} mm")
    for tenths in range(ceil(10 * c.stop_plate_thickness), 201):
        thicker = replace(d, clamp=replace(c, stop_plate_thickness=tenths / 10))
        if Layout(thicker).stop_give <= allowed:  # limited by other set screws
            return wrong(
                "clamp.stop_plate_thickness", what, c.stop_plate_thickness, f"at least {tenths / 10:g} mm"
            )
    most = d.rating.overload_force * allowed / layout.stop_give
    return wrong("rating.overload_force", what, d.rating.overload_force, f"at most {most:.2g} N")


def _largest_pitch(layout: Layout, allowed: float) -> float | None:
    """Largest pitch (mm, by halves) of set screws that is allowed; None if none is."""
    pitch = floor(2 * layout.hold_down_pitch) / 2
    least = max(shortest_pitch(layout.design.clamp.screw), 2 * layout.beyond_screws)
    while pitch >= least:
        if layout.stop_plate_beams(pitch).one <= allowed:
            return pitch
        pitch -= 0.5
    return None


@rule(after="stop_plate_stays")
def stop_keeps_rated_deflection(layout: Layout) -> Iterator[Finding]:
    """A gap given in the design is not wider than the hinge bears; a derived one is so by construction."""
    stop = layout.design.stop
    for p, gap in zip(layout.elements, stop_limits(layout).gap.tolist()):
        given = stop.gaps.get(p.arm) if stop.gaps else None
        widest = gap - stop.tolerance - seat(layout)
        if given is not None:
            yield from at_most(
                f"stop.gaps.{p.arm:g}",
                f"lets the hinge of element {p.number} pass its rated deflection under "
                f"{layout.design.rating.overload_force:g} N",
                given,
                widest,
                f"at most {widest:.4g} mm" if widest > stop.tolerance else "leave it out, to have it derived",
            )


@rule(after="stop_plate_stays")
def stop_gap_above_tolerance(layout: Layout) -> Iterator[Finding]:
    """The arm moves before its stop closes; what leaves it no gap is the overload or a tolerance."""
    d = layout.design
    for p in layout.elements:
        if _opens(layout, p):
            continue
        gap, overload = stop_gap(layout, p), float(stop_limits(layout).overload[p.number - 1])
        what = f"the stop of element {p.number} may close before it moves: its gap is {gap:g} mm"
        if d.stop.gaps and p.arm in d.stop.gaps:
            yield wrong("stop.tolerance", what, d.stop.tolerance, f"less than {gap:g} mm")
            continue
        taken = _taken_by_tolerances(layout)
        legal = {path: _largest_tolerance(d, path) for path in taken}
        # if a usual tolerance would suffice, the overload is not the cause
        held = [path for path in taken if legal[path] >= USUAL[path]]
        if not held and 0 < overload < d.rating.overload_force:
            what = f"no stop keeps the hinge of element {p.number} within its rated deflection"
            yield wrong("rating.overload_force", what, d.rating.overload_force, f"at most {overload:.4g} N")
            continue
        path = next(iter(held), next((path for path in taken if legal[path]), taken[0]))
        most = f"at most {legal[path]:g} mm" if legal[path] else "less, or a softer hinge"
        yield wrong(path, what, attrgetter(path)(d), most)


def _opens(layout: Layout, place: ElementPlace) -> bool:
    return stop_gap(layout, place) > layout.design.stop.tolerance + SAME


def _taken_by_tolerances(layout: Layout) -> list[str]:
    """Fields that a derived gap makes room for, the one that takes most of it first."""
    d = layout.design
    stop, ledge = 2 * d.stop.tolerance, 2 * d.tolerance.ledge
    pads = seat(layout) - ledge - STOP_PLATE_FLAT
    taken = {"stop.tolerance": stop, "tolerance.ledge": ledge, "tolerance.pad_height": pads}
    return sorted(taken, key=lambda path: -taken[path])


def _largest_tolerance(design: Design, path: str) -> float:
    """Largest value of a tolerance (mm, a multiple of TENTH) that alone leaves every derived gap open; 0
    if none does."""
    section, name = path.split(".")
    least, now = spec_of(type(getattr(design, section)), name).low, attrgetter(path)(design)
    low, high = ceil(least / TENTH), ceil(now / TENTH)
    given = design.stop.gaps or {}

    def open_at(tenths: int) -> bool:
        layout = Layout(with_value(design, path, round(tenths * TENTH, 4)))
        return all(_opens(layout, p) for p in layout.elements if p.arm not in given)

    if low >= high or not open_at(low):
        return 0.0
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if open_at(middle) else (low, middle)
    return round(low * TENTH, 4)


@rule(after="stop_plate_stays")
def stop_land_fits_arm(layout: Layout) -> Iterator[Finding]:
    d = layout.design
    for p in layout.elements:
        ramp = layout.ledge_of(p.hinge) - stop_gap(layout, p) - p.hinge.h
        foot = d.element.corner_radius * tan(pi / 8)  # of the ramp at 45 degrees, along the arm
        most = p.arm - ramp - foot - p.hinge.l / 2
        yield from at_most(
            "stop.land_length",
            f"land and its ramp reach the slot of element {p.number}",
            d.stop.land_length,
            most,
            f"at most {most:.4g} mm",
        )
