"""How the array is put together: its steps, in the mechanic's words, read off the placements."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import floor

from tactcad.parts import seating
from tactcad.parts.end_plate import head_bore
from tactcad.parts.fasteners import SPACER_TOLERANCE, Clamping, clamping, dowel_depth
from tactcad.parts.fasteners import STACK as STACK_TOLERANCE
from tactcad.parts.layout import Layout
from tactcad.parts.library.dowels import dowel_limits
from tactcad.parts.rules.bonding_rules import FITS as BONDING_FITS
from tactcad.parts.rules.rule import misfit

from .scene import Placement, Step

GAUGES = "Gauges"
FIRST_PLATE = "End plate and dowels"
STACK = "Stack"
OTHER_PLATE = "Other end plate"
COPLANAR = "Coplanar pads"
STOP_PLATE = "Stop plate"
CARRIER = "Carrier"
HOLD_DOWN = "Hold the stop plate down"

LEVEL = 0.01  # mm; chosen: 0.02 degrees over the smallest stack, what a lever indicator tells with ease
LEANING = 1 / 3  # of the head plate's play; chosen: the pins' own lean and places have the rest
ABREAST = 2  # rows that are stacked side by side


def first_on_first(stacked: Sequence[Placement]) -> list[Placement]:
    """Elements, blanks and spacers in the order in which they go on the dowels, which stand in the end plate
    at +y: two abreast, row one's part first."""
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
    ) -> Step:
        names = tuple(p.designator for p in placed.get(title, ()))
        return Step(title, names, explode, text, fan=fan, tools=tools, elements=elements)

    return (
        step(
            GAUGES, (0, 0, 0), _gauges(layout), ("micrometer or measuring microscope, 1 um",), elements=True
        ),
        step(
            FIRST_PLATE,
            (0, 0.6 * width, 0),
            _first_plate(layout, c, placed[FIRST_PLATE][0]),
            ("arbor press or vice with soft jaws",),
        ),
        step(STACK, (0, -way, 0), _stack(layout, placed[STACK]), fan=ABREAST, elements=True),
        step(OTHER_PLATE, (0, -way - width, 0), _other_plate(c, placed[OTHER_PLATE][0])),
        step(
            COPLANAR,
            (0, -way - 20.0 - 1.6 * width, 0),
            _coplanar(layout, c),
            flatness_tools(layout),
            elements=True,
        ),
        step(STOP_PLATE, (0, 0, 0.8 * width), _stop_plate(layout)),
        step(
            CARRIER,
            (0, 0, 1.4 * width),
            "Screw the carrier on both end plates, crosswise. Measure the pads' heights on the surface plate "
            "again: they must not have moved.",
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
        f"Bond a gauge on {face} in the bonding fixture, by the guide of scene bonding, and check it as that "
        "says; lay its leads in the wire recess towards the rear end."
        if bonded
        else f"Bond a gauge on {face}, its grid centred on the hinge within 0.1 mm, carrier trimmed to "
        f"{d.gauge.carrier_arm_side + d.gauge.carrier_body_side:g} mm; cure, coat, solder three "
        f"leads, and lay "
        "them in the wire recess towards the rear end."
    )
    return (
        f"Hold and lift an element by its rear body only, never by its arm: the hinge is {thinnest:g} mm "
        "thick. Keep each apart from the others, rear body held, arm free. Measure and record the hinge "
        "thickness of every element, and mark its rear body with its number: equal elements differ in what "
        f"was measured. {how}"
    )


def _first_plate(layout: Layout, c: Clamping, plate: Placement) -> str:
    deep = dowel_depth(layout)
    out = round(c.dowel - deep, 9)
    return (
        f"Press the dowels square into {plate.designator} ({plate.part.name.lower()}) from the stack's side, "
        f"{deep:g} mm deep: {out:g} mm stand out. Lay the plate on its outer face, dowels up, the edge with "
        "the carrier's threads away from you. It stays so until the stack is closed."
    )


def _stack(layout: Layout, stacked: Sequence[Placement]) -> str:
    arms = {place.designator: f" (arm {place.arm:g})" for place in layout.elements}
    rows = []
    for row, sign in ((1, 1.0), (2, -1.0)):
        own = [p for p in stacked if p.rotation[0][0] * sign > 0]
        side = "right (+x)" if sign > 0 else "left (-x)"
        order = ", ".join(p.designator + arms.get(p.designator, "") for p in own)
        rows.append(f"Row {row}, on the {side}: {order}.")
    return (
        "Slide the parts on the dowels in this order, the first one on first, pads towards you and arms to "
        f"the middle. {' '.join(rows)} Nothing is tight yet. Pressed together by hand, elements and spacers "
        f"are {layout.stack:g} mm long within {STACK_TOLERANCE:g}, and both rows alike within "
        f"{rows_alike(layout):g} mm, or the head plate leans on its dowels: measure both. Where they are "
        f"not, measure the spacers: each is {layout.design.array.pitch:g} mm less what the elements' sheet "
        f"measures, +-{SPACER_TOLERANCE:g}, as their sheet says; where only the rows differ, exchange "
        "spacers between them."
    )


def rows_alike(layout: Layout) -> float:
    """By how much the two rows' stacks may differ in length, mm, whole hundredths.

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
        f"Slide {plate.designator} ({plate.part.name.lower()}) on the dowels, {sunk}its edge with the "
        "carrier's threads over the other plate's."
    )


def _coplanar(layout: Layout, c: Clamping) -> str:
    d = layout.design
    tolerance = d.tolerance.pad_height
    tight = "the nuts of the tie rods, the one at the other end held," if c.rod else "the clamping screws"
    gap = (
        f"Check the gap between the rows with feelers, {2 * layout.pad_inner:g} mm nominal: the dowels set "
        "it, force nothing between the pads. "
        if len(d.array.row_arms) == ABREAST
        else ""
    )
    same = (
        "; in the calibration set-up the heights at which the force gauge first reads 0.01 N show the same "
        "to a micrometre"
    )
    return (
        "Turn the stack over and set its pads down on a surface plate (grade 1 or better). Press the rear "
        "bodies down with a bar of rubber so that every pad stands on the plate, then tighten "
        f"{tight} crosswise, in three rounds: a third, two thirds, the whole torque. Before the last round "
        "tap the head end plate until its upper edge is as high over the surface plate as the other's, at "
        f"both ends within {LEVEL:g} mm. {gap}"
        f"No pad may let a {2 * tolerance * 1e3:g} um feeler pass. Then turn the array on its back and read "
        f"each pad with a lever indicator against the surface plate: all within {2 * tolerance * 1e3:g} um"
        f"{same if d.calibration else ''}. Record them; loosen and repeat if one is off, and repeat it all "
        "whenever the clamping was loosened."
    )


def flatness_tools(layout: Layout) -> tuple[str, ...]:
    """What the pads are made coplanar with, and measured."""
    tolerance = layout.design.tolerance.pad_height
    feelers = f"feelers, {2 * tolerance * 1e3:g} um"
    if len(layout.design.array.row_arms) == ABREAST:
        feelers += f" and {2 * layout.pad_inner:g} mm"
    return "surface plate, grade 1 or better", "bar of rubber", feelers, "lever indicator, 1 um, on a stand"


def _stop_plate(layout: Layout) -> str:
    calibrated = (
        "An array that is still to be calibrated goes to that set-up without stop plate and set screws, its "
        "carrier on: the stops would close before the end of the travel. Afterwards take the carrier off "
        "again and read the pads' heights on the surface plate once more, as before: what has moved is made "
        "coplanar and calibrated anew. "
    )
    return (
        calibrated if layout.design.calibration else ""
    ) + "Wipe ledges and plate. Lay the stop plate on the ledges; both faces are ground, either lies down."


def _hold_down(layout: Layout) -> str:
    from tactcad.parts.stop_gap import seat  # numpy

    gaps = sorted(_gaps(layout), key=lambda pair: pair[0])
    tolerance = layout.design.stop.tolerance
    wider = floor(1e3 * (tolerance + seat(layout)) + 1e-6) / 1e3  # a micrometre is what the indicator shows
    return (
        f"Turn the set screws in, crosswise, {seating.words(layout)}, locked with a drop of thread lacquer. "
        "Read the pads' heights once more. Check each stop: push every pad with a plastic rod; it must give "
        f"way and come to a stop, with {', '.join(f'{gap:g} mm at arm {arm:g}' for arm, gap in gaps)} "
        f"(to {tolerance:g} mm less, or {wider:g} mm more, one plate lying on all "
        "ledges) on the lever indicator at the tip."
    )


def _gaps(layout: Layout) -> set[tuple[float, float]]:
    """Arm length and stop gap of every kind of element, mm."""
    from tactcad.parts.stop_gap import stop_gap  # numpy

    return {(p.arm, stop_gap(layout, p)) for p in layout.elements}
