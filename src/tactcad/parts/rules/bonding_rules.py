"""Rules on the fixture for bonding gauges: whether one can be made for the array's elements."""

from __future__ import annotations

from collections.abc import Iterator

from ..array.layout import LEAST_GAP, Layout
from ..array.leads import AHEAD_OF_LEADS
from ..bought.standard_parts import LEAST_PLAY
from ..language.finding import SAME, Finding
from ..rigs.bonding_fixture import EDGE, GUIDED, LEAST_TONGUE, ROOT, SILL, TONGUE, bonding_rigs
from ..rigs.stiffness import bonding_lines
from .rule import at_least, at_most, fits, too_much, wrong

TALLEST = 60.0  # clamp bar, mm; chosen: a taller one topples at its pins' ends
# The clamp alone bends an unbacked leaf to this share of its yield strength at most; chosen: a tenth, so that
# bonding leaves no visible zero offset.
BENT_BY_CLAMP = 0.1


@fits
def tongue_enters_slot(layout: Layout) -> Iterator[Finding]:
    for rig in bonding_rigs(layout.design):
        less = layout.design.tolerance.hinge_length + TONGUE + LEAST_PLAY
        if rig.tongue <= 0:
            yield wrong(
                "tolerance.hinge_length",
                "takes the whole slot: no tongue enters it",
                layout.design.tolerance.hinge_length,
                f"below {rig.hinge.l - TONGUE - LEAST_PLAY:g} mm",
            )
            return
        yield from at_least(
            "element.hinge_length",
            f"the tongue in its slot would be {rig.tongue:g} mm thick, too thin for wire-cutting",
            rig.hinge.l,
            round(LEAST_TONGUE + less, 6),
        )


@fits
def nest_clears_rear_body(layout: Layout) -> Iterator[Finding]:
    for rig in bonding_rigs(layout.design):
        e = layout.design.element
        lacking = rig.tongue / 2 + 2 * ROOT - rig.sill if rig.front_floor < rig.rest else 0.0
        yield from at_least(
            "element.seat_length",
            f"no room between slot and clamp edge for the nest's step, {SILL:g} mm before it",
            e.seat_length,
            e.seat_length + max(lacking, 0.0),
        )


@fits
def rear_body_takes_pins(layout: Layout) -> Iterator[Finding]:
    """Two pairs of pins at the element's sides, far enough apart to keep the clamp from turning."""
    for rig in bonding_rigs(layout.design):
        first, last = rig.pin_x
        short = 2 * rig.pin_d + EDGE - (last - first)
        e = layout.design.element
        yield from at_least(
            "element.rear_length",
            "the fixture's pins find no room along the element",
            e.rear_length,
            e.rear_length + max(short, 0.0),
        )


@fits
def clamp_balances_on_leaf(layout: Layout) -> Iterator[Finding]:
    """The clamp's weight acts over the tongue or behind it: else the element tips off its rest."""
    for rig in bonding_rigs(layout.design):
        g = layout.design.gauge
        if rig.pad_x[1] - rig.pad_x[0] < LEAST_GAP - SAME:
            yield wrong(
                "gauge.carrier_arm_side",
                "the clamp has no room next to the contact pad",
                g.carrier_arm_side,
                "a longer arm, or a carrier that ends further from the pad",
            )
            return
        least = -rig.pad_x[0] - 2 * max(0.0, rig.tongue / 2 - rig.tongue_radius)
        yield from at_least(
            "gauge.carrier_body_side",
            "the clamp's weight would act before the tongue and tip the element",
            g.carrier_body_side,
            least,
        )


@fits
def clamp_can_be_handled(layout: Layout) -> Iterator[Finding]:
    for rig in bonding_rigs(layout.design):
        pressure = rig.table.pressure
        yield from at_most(
            "bonding.pressure",
            f"its weight would be {rig.bar_height:g} mm high",
            pressure,
            (most := pressure * TALLEST / rig.bar_height),
            f"at most {most:.3g} MPa",
        )


@fits
def leaf_bears_clamp(layout: Layout) -> Iterator[Finding]:
    """The clamp's pressure ahead of the hinge bends a leaf that is not backed: 6 M/(b t^2), M = p w a^2/2."""
    d = layout.design
    for rig in bonding_rigs(layout.design):
        arm_side, t = -rig.pad_x[0], rig.hinge.t
        bent = rig.bar_pressure * rig.pad_width * arm_side**2 / 2
        stress = 6 * bent / (d.sheet.thickness * t * t)
        share = stress / d.material.yield_strength
        if share <= BENT_BY_CLAMP:
            continue
        what = f"the clamp bends the leaf to {share:.2g} of its yield strength where no tongue backs it"
        if rig.bar_height > GUIDED + SAME:
            legal = f"at most {rig.table.pressure * BENT_BY_CLAMP / share:.3g} MPa"
            yield wrong("bonding.pressure", what, rig.table.pressure, legal)
        else:  # no lighter bar runs on its pins: less of the gauge ahead of the hinge must do
            legal = f"at most {arm_side * (BENT_BY_CLAMP / share) ** 0.5:.3g} mm"
            yield wrong("gauge.carrier_arm_side", what, arm_side, legal)


@fits
def glue_lies_under_foil(layout: Layout) -> Iterator[Finding]:
    b = layout.design.bonding
    if b is not None:
        yield from at_most(
            "bonding.glue_thickness",
            "thicker than backing and adhesive together, gauge.grid_height",
            b.glue_thickness,
            layout.design.gauge.grid_height,
        )


@fits
def terminals_lie_in_recess(layout: Layout) -> Iterator[Finding]:
    """Solder terminals on the floor of the wire recess, behind its wall."""
    for rig in bonding_rigs(layout.design):
        room = layout.rear_end - layout.recess_start - AHEAD_OF_LEADS
        yield from at_most(
            "bonding.terminal_length", "longer than the wire recess", rig.table.terminal_length, room
        )
        yield from at_most(
            "bonding.terminal_width",
            "wider than the element",
            rig.terminal_width,
            layout.design.sheet.thickness,
        )


@fits
def tongue_stays_straight(layout: Layout) -> Iterator[Finding]:
    yield from too_much(layout, bonding_lines)


# What the bonding fixture asks of an array.
FITS = (
    tongue_enters_slot,
    nest_clears_rear_body,
    rear_body_takes_pins,
    clamp_balances_on_leaf,
    clamp_can_be_handled,
    leaf_bears_clamp,
    glue_lies_under_foil,
    terminals_lie_in_recess,
    tongue_stays_straight,
)
