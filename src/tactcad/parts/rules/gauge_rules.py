"""Rules on the room that gauges, their leads and the arms beside each other have."""

from __future__ import annotations

from collections.abc import Iterator
from math import floor

from tactcad.design.sensing import WIRES

from ..array.clamp import SPACER_TOLERANCE
from ..array.layout import LEAST_GAP, Layout
from ..array.leads import leads
from ..language.finding import SAME, Finding
from .rule import at_least, at_most, rule, wrong

# Neighbouring arms, and arm and end plate, are a spacer apart; chosen: a thin gauge wire must not jam. Least
# air when all tolerances add up, mm; chosen: burrs of the wire are smaller.
LEAST_ARM_GAP = 0.1
LEAST_BESIDE = 0.02


@rule(after="override_names_element")
def gauge_fits_face(layout: Layout) -> Iterator[Finding]:
    d = layout.design
    if d.element.sides == "two":
        for p in layout.elements:
            yield from at_most(
                "gauge.grid_length", "longer than the slot it is bonded in", d.gauge.grid_length, p.hinge.l
            )
        return
    for p in layout.elements:
        flat = p.arm - d.element.pad_length - d.element.pad_root_radius
        yield from at_most(
            "gauge.carrier_arm_side",
            f"carrier reaches the pad of element {p.number}",
            d.gauge.carrier_arm_side,
            flat,
            f"at most {flat:g} mm there" if flat > 0.0 else "a longer arm, or a shorter pad",
        )
        behind = layout.recess_start - p.hinge_x
        yield from at_most(
            "gauge.carrier_body_side",
            f"carrier reaches the wire recess behind element {p.number}",
            d.gauge.carrier_body_side,
            behind,
            f"at most {behind:g} mm there",
        )


@rule(after="override_names_element")
def gauge_fits_width(layout: Layout) -> Iterator[Finding]:
    g, sheet = layout.design.gauge, layout.design.sheet.thickness
    legal = f"at most sheet.thickness = {sheet:g} mm"
    yield from at_most("gauge.carrier_width", "wider than the element", g.carrier_width, sheet, legal)
    yield from at_most("gauge.grid_width", "wider than its carrier", g.grid_width, g.carrier_width)
    if layout.design.element.sides == "one":
        longest = 2 * min(g.carrier_arm_side, g.carrier_body_side)
        yield from at_most("gauge.grid_length", "longer than its carrier", g.grid_length, longest)


def neighbours_take(layout: Layout) -> float:
    """Approach of an arm to its neighbour by tolerances, a spacer away, mm: half of both sheets' and the
    spacer's own.
    """
    return layout.design.tolerance.sheet_thickness + SPACER_TOLERANCE


@rule(after="override_names_element")
def arms_clear_neighbours(layout: Layout) -> Iterator[Finding]:
    with_tolerances = neighbours_take(layout) + LEAST_BESIDE
    yield from at_least(
        "array.spacer",
        "arms too near their neighbours and the end plates to move freely",
        layout.spacer,
        max(LEAST_ARM_GAP, with_tolerances),
        f"at least {LEAST_ARM_GAP:g} mm, and tolerance.sheet_thickness + {SPACER_TOLERANCE + LEAST_BESIDE:g} "
        f"= {with_tolerances:g} mm",
    )


@rule(after="override_names_element")
def leads_have_room(layout: Layout) -> Iterator[Finding]:
    """The leads fit: in the wire recess, as wide as element and spacer; in front of it under the face, next
    to the gauge.
    """
    d, e, wire, count = layout.design, layout.design.element, lead(layout), leads(layout)
    if leads_that_fit(layout) < count:
        rows = -(-count // max(1, floor(d.array.pitch / wire + SAME)))
        yield wrong(
            "element.recess_depth",
            f"{count} leads of {wire:g} mm do not fit into the wire recess of {d.array.pitch:g} mm width",
            e.recess_depth,
            f"at least {wire * rows:g} mm, and a pitch of {wire:g} mm or more",
        )
    out, room = gauge_stands_out(layout), gauge_room(layout)
    if LEAST_GAP - SAME <= room:  # less than that breaks another rule
        yield from at_least(
            "element.pad_height",
            "the object would touch gauge and leads before the pad",
            e.pad_height,
            e.pad_height + out - room,
        )


def leads_that_fit(layout: Layout) -> int:
    """Number of leads that fit in the recess of one element."""
    depth, wire = layout.design.element.recess_depth, lead(layout)
    return floor(layout.design.array.pitch / wire + SAME) * floor(depth / wire + SAME)


def lead(layout: Layout) -> float:
    """Diameter of a lead over its insulation, mm."""
    return WIRES[layout.design.wiring.wire].outer


def gauge_stands_out(layout: Layout) -> float:
    """Height of gauge and leads over the faces that they lie on, mm."""
    gauge = layout.design.gauge
    return lead(layout) + (gauge.grid_height if layout.design.element.sides == "one" else 0.0)


def gauge_room(layout: Layout) -> float:
    """From these faces to the pads' plane, mm: a two-sided body's lower face is nearer to it."""
    return layout.design.element.pad_height + min(layout.body_bottom(p.hinge) for p in layout.elements)
